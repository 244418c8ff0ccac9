// SPDX-License-Identifier: Apache-2.0
// `servogate bench run`: a test signal, and how the drive followed it.
#include <nlohmann/json.hpp>

#include "bench/drive/excitation/signal.hpp"
#include "bench/drive/response/step_figures.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/session.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::OperationMode;
using canopen::supported_bit;
using nlohmann::json;

const text::Entry kNoSignal{"bench.no-signal",
                            "this signal cannot be sampled every {0} ms: check its frequencies and times",
                            "такой сигнал нельзя задать с шагом {0} мс: проверьте частоты и времена"};

json figures_of(bench::SignalKind kind, bench::Loop loop, const std::vector<double>& wanted,
                const std::vector<double>& actual, double unit, double period) {
  const bench::FollowingFigures follow = bench::following_figures(wanted, actual, period);
  json out = {{"greatest_error", follow.greatest / unit},
              {"rms_error", follow.root_mean_square / unit},
              {"error_at_end", follow.at_end / unit},
              {"itae", follow.itae / unit}};
  if (kind != bench::SignalKind::step || loop == bench::Loop::torque || actual.empty()) return out;
  const auto step = bench::step_figures(actual, period, actual.front(), wanted.back());
  if (!step) return out;
  out["step"] = {
      {"dead_s", optional_number(step->dead_s)},      {"rise_s", optional_number(step->rise_s)},
      {"overshoot_percent", 100.0 * step->overshoot}, {"settling_s", optional_number(step->settling_s)},
      {"steady_error", step->steady_error / unit},    {"itae", step->itae / unit}};
  return out;
}

bool run_work(BenchWork& work) {
  const BenchOptions& o = work.options;
  bench::Guard& guard = work.guard;
  json& meta = work.meta;
  bench::Signal s;
  bench::signal_named(o.signal, s.kind);
  const bench::Loop loop = loop_named(o.loop);
  const double unit = loop == bench::Loop::torque ? 1.0 : kTurnRad;
  s.amplitude = o.amplitude * unit;
  s.duration_s = o.duration_s;
  s.speed = o.move_speed * unit;
  s.acceleration = o.acceleration * unit;
  s.jerk = o.jerk * unit;
  s.from_hz = o.from_hz;
  s.to_hz = o.to_hz;
  s.period = static_cast<std::size_t>(o.period);
  s.periods = o.periods;
  std::vector<double> wanted = bench::samples(s, guard.period_s());
  if (wanted.empty()) {
    complain(kNoSignal, {text::number(guard.period_s() * 1e3)});
    return false;
  }
  for (double& v : wanted) v += o.offset * unit;
  if (!guard.accepts(loop, wanted) || !guard.enable(loop)) return false;
  guard.stage(o.signal);
  std::vector<double> actual;
  for (const double v : wanted) {
    if (!guard.step(loop, v)) return false;
    actual.push_back(loop == bench::Loop::position   ? guard.answer().position_rad
                     : loop == bench::Loop::velocity ? guard.speed_rad_s()
                                                     : guard.answer().torque_nm);
  }
  meta["signal"] = {{"kind", o.signal}, {"loop", o.loop}, {"amplitude", o.amplitude}, {"offset", o.offset}};
  meta["figures"] = figures_of(s.kind, loop, wanted, actual, unit, guard.period_s());
  if (!o.json) print_line(meta["figures"].dump(1));
  return true;
}

}  // namespace

bench::Loop loop_named(const std::string& word) {
  return word == "position" ? bench::Loop::position
         : word == "torque" ? bench::Loop::torque
                            : bench::Loop::velocity;
}

DriveUse use_of_loop(bench::Loop loop) {
  DriveUse use;
  use.modes = supported_bit(loop == bench::Loop::position ? OperationMode::cyclic_sync_position
                            : loop == bench::Loop::torque ? OperationMode::cyclic_sync_torque
                                                          : OperationMode::cyclic_sync_velocity);
  return use;
}

int bench_run(const BenchOptions& options) {
  return on_drive("bench run", options, use_of_loop(loop_named(options.loop)), run_work);
}

}  // namespace servogate::gateway::command
