// SPDX-License-Identifier: Apache-2.0
// `servogate bench run`: a test signal, and how the drive followed it.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/drive/excitation/signal.hpp"
#include "bench/drive/response/step_figures.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/run_record.hpp"
#include "gateway/command/bench/seats.hpp"
#include "gateway/command/bench/session.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::OperationMode;
using canopen::supported_bit;
using nlohmann::json;

const text::Entry kNoSignal{"bench.no-signal",
                            "this signal cannot be sampled every {0} ms: check its frequencies and times",
                            "такой сигнал нельзя задать с шагом {0} мс: проверьте частоты и времена"};

const text::Entry kTwice{"bench.twice", "node {0} is named twice", "узел {0} назван дважды"};

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

bench::Signal signal_of(const BenchOptions& o) {
  bench::Signal s;
  bench::signal_named(o.signal, s.kind);
  const double unit = loop_named(o.loop) == bench::Loop::torque ? 1.0 : kTurnRad;
  s.amplitude = o.amplitude * unit;
  s.duration_s = o.duration_s;
  s.speed = o.move_speed * unit;
  s.acceleration = o.acceleration * unit;
  s.jerk = o.jerk * unit;
  s.from_hz = o.from_hz;
  s.to_hz = o.to_hz;
  s.phase_rad = o.phase_deg * kTurnRad / 360.0;
  s.period = static_cast<std::size_t>(o.period);
  s.periods = o.periods;
  return s;
}

/// The whole signal, inside of the envelope; empty: it is not, or cannot be sampled, which has been said.
std::vector<double> accepted_signal(const BenchOptions& o, bench::Guard& guard) {
  const bench::Loop loop = loop_named(o.loop);
  std::vector<double> wanted = bench::samples(signal_of(o), guard.period_s());
  if (wanted.empty()) complain(kNoSignal, {text::number(guard.period_s() * 1e3)});
  // A position begins where the drive stands.
  const double first =
      loop == bench::Loop::position && o.phase_deg != 0.0 && !wanted.empty() ? wanted.front() : 0.0;
  for (double& v : wanted) v += o.offset * (loop == bench::Loop::torque ? 1.0 : kTurnRad) - first;
  if (!wanted.empty() && !accepts_signal(guard, o, loop, wanted)) wanted.clear();
  return wanted;
}

/// Gives it to the drive, which stands until `begins`; figures in `meta`.
bool give_signal(const BenchOptions& o, bench::Guard& guard, const std::vector<double>& wanted, json& meta,
                 const std::function<bool()>& begins) {
  const bench::Loop loop = loop_named(o.loop);
  if (wanted.empty() || !guard.enable(loop)) return false;
  const double here = loop == bench::Loop::position ? guard.answer().position_rad : 0.0;
  while (!begins())
    if (!guard.step(loop, here)) return false;
  guard.stage(o.signal);
  std::vector<double> actual;
  for (const double v : wanted) {
    if (!guard.step(loop, v)) return false;
    actual.push_back(loop == bench::Loop::position   ? guard.answer().position_rad
                     : loop == bench::Loop::velocity ? guard.speed_rad_s()
                                                     : guard.answer().torque_nm);
  }
  meta["signal"] = {{"kind", o.signal}, {"loop", o.loop}, {"amplitude", o.amplitude}, {"offset", o.offset}};
  meta["figures"] = figures_of(signal_of(o).kind, loop, wanted, actual,
                               loop == bench::Loop::torque ? 1.0 : kTurnRad, guard.period_s());
  return true;
}

bool run_work(BenchWork& work) {
  const BenchOptions& o = work.options;
  const auto at_once = [] { return true; };
  if (!give_signal(o, work.guard, accepted_signal(o, work.guard), work.meta, at_once)) return false;
  if (!o.json) print_line(work.meta["figures"].dump(1));
  return true;
}

/// One drive of several.
struct OneOfSeveral {
  BenchOptions options;
  json meta;
  std::unique_ptr<bench::Guard> guard;
  std::vector<double> wanted;
  bool found = false, off = true;
};

/// The actual positions of all of them, for `bench circle`.
std::string path_csv(const std::vector<OneOfSeveral>& all, double period) {
  std::string csv = "time_s";
  std::size_t rows = all.front().guard->samples().size();
  for (const OneOfSeveral& one : all) {
    csv += ",node" + std::to_string(one.options.node);
    rows = std::min(rows, one.guard->samples().size());
  }
  for (std::size_t n = 0; n < rows; ++n) {
    const bench::Guard& first = *all.front().guard;
    if (first.stages()[first.samples()[n].stage] != all.front().options.signal) continue;
    char cell[40];
    std::snprintf(cell, sizeof cell, "\n%.6f", static_cast<double>(n) * period);
    csv += cell;
    for (const OneOfSeveral& one : all) {
      std::snprintf(cell, sizeof cell, ",%.9g", one.guard->samples()[n].position_rad / kTurnRad);
      csv += cell;
    }
  }
  return csv + "\n";
}

int run_several_on(ToolBus& bus, const BenchOptions& options, BenchPlan& plan) {
  std::vector<OneOfSeveral> all;
  for (BenchOptions& one : each_drive(options)) {
    if (!make_run_directory(one.out)) return kInfrastructure;
    one.phase_deg = static_cast<double>(all.size()) * options.phase_deg;
    one.part = !all.empty();
    all.push_back({one, {}, nullptr, {}, false, true});
  }
  int code = kDone;
  const auto drives = BusDrive::open(bus, options, plan.use, options.out + "/bus.log", code);
  if (drives == nullptr) return code;
  code = kDone;
  DriveSeats seats(*drives);
  bool accepted = true;
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].guard = begin_guard(seats.seat(k), plan, drives->facts(k));
    all[k].wanted = accepted_signal(all[k].options, *all[k].guard);
    accepted = accepted && !all[k].wanted.empty();
  }
  watch_live(*all.front().guard);
  // Nothing gets power that does not fit into the envelope of its drive.
  if (accepted) {
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < all.size(); ++k)
      threads.emplace_back([&, k] {
        OneOfSeveral& one = all[k];
        one.found =
            give_signal(one.options, *one.guard, one.wanted, one.meta, [&] { return seats.may_begin(k); });
        if (!one.found) seats.end_all();
        one.off = one.guard->release();
        seats.leave(k);
      });
    for (std::thread& t : threads) t.join();
  }
  drives->leave();
  const std::string path = options.out + "/path.csv";
  if (const std::string why = report::write_file(path, path_csv(all, drives->period_s())); !why.empty()) {
    complain(kCannotWrite, {path, why});
    return kInfrastructure;
  }
  for (std::size_t k = all.size(); k-- > 0;) {
    OneOfSeveral& one = all[k];
    json meta = meta_of("bench run", one.options, *drives, k);
    if (one.meta.is_object()) meta.update(one.meta);
    BenchWork work{one.options, *one.guard, *drives, meta, {}, k};
    const int own = finish(work, one.found, plan.limits, one.off);
    if (own != kDone && (own != kStopped || code == kDone)) code = own;
    if (!options.json && one.found)
      print_line("node " + std::to_string(one.options.node) + " " + meta["figures"].dump(1));
  }
  return code;
}

int run_several(const BenchOptions& options) {
  auto plan = plan_of(options, use_of_loop(loop_named(options.loop)));
  if (!plan) return kWrongUse;
  std::vector<int> nodes = options.with;
  nodes.push_back(options.node);
  std::sort(nodes.begin(), nodes.end());
  if (const auto twice = std::adjacent_find(nodes.begin(), nodes.end()); twice != nodes.end()) {
    complain(kTwice, {std::to_string(*twice)});
    return kWrongUse;
  }
  int code = kDone;
  const auto bus = open_bench(options, code);
  return bus == nullptr ? code : bus->finish(run_several_on(*bus, options, *plan));
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
  if (!knows_least_load(options)) return kWrongUse;
  if (!options.with.empty()) return run_several(options);
  return on_drive("bench run", options, use_of_loop(loop_named(options.loop)), run_work);
}

}  // namespace servogate::gateway::command
