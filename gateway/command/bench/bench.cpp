// SPDX-License-Identifier: Apache-2.0
// `servogate bench run` and `bench identify`: one drive on the table.
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "bench/drive/excitation/signal.hpp"
#include "bench/drive/measurement/identify.hpp"
#include "bench/drive/response/step_figures.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bus_drive.hpp"
#include "gateway/command/bench/run_record.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kBadTravel{"bench.travel",
                             "--travel {0}: expected FROM..TO in revolutions with 0 between, as -5..50",
                             "--travel {0}: нужно ОТ..ДО в оборотах, с нулём между ними, например -5..50"};
const text::Entry kNoSignal{"bench.no-signal",
                            "this signal cannot be sampled every {0} ms: check its frequencies and times",
                            "такой сигнал нельзя задать с шагом {0} мс: проверьте частоты и времена"};
const text::Entry kEndedBy{"bench.ended-by", "the run has ended: {0}", "прогон завершён: {0}"};
const text::Entry kNotFound{"bench.not-found", "the measurement does not show the {0}; see {1}/report.html",
                            "измерение не показывает: {0}; см. {1}/report.html"};
const text::Entry kStage{"bench.stage", "{0} s: {1}", "{0} с: {1}"};
const text::Entry kKept{"bench.kept", "kept in {0}", "сохранено в {0}"};
const text::Entry kStillOn{"bench.still-on",
                           "the drive does not show that it is without torque: switch it off by hand",
                           "привод не подтверждает снятие момента: отключите его вручную"};

constexpr double kTurn = 2.0 * std::numbers::pi;

bool read_number(std::string_view word, double& value) {
  const auto [at, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && at == word.data() + word.size() && std::isfinite(value);
}

std::optional<bench::Envelope> envelope_of(const BenchOptions& o) {
  bench::Envelope e;
  const std::size_t dots = o.travel.find("..");
  double from = 0.0, to = 0.0;
  if (dots == std::string::npos || !read_number(std::string_view(o.travel).substr(0, dots), from) ||
      !read_number(std::string_view(o.travel).substr(dots + 2), to) || from > 0.0 || to < 0.0) {
    complain(kBadTravel, {o.travel});
    return std::nullopt;
  }
  e.travel_min_rad = from * kTurn;
  e.travel_max_rad = to * kTurn;
  e.speed_rad_s = o.speed_rev_s * kTurn;
  e.torque_nm = o.torque_nm;
  e.time_s = o.time_s;
  e.following_rad = o.following_rev * kTurn;
  return e;
}

json optional_number(const std::optional<std::int64_t>& v) { return v ? json(*v) : json(nullptr); }
json optional_number(const std::optional<double>& v) { return v ? json(*v) : json(nullptr); }

json meta_of(const char* command, const BenchOptions& o, const BusDrive& drive) {
  const DriveFacts& f = drive.facts();
  return {{"schema", 1},
          {"command", command},
          {"bus", o.bus},
          {"node", o.node},
          {"drive",
           {{"name", f.name},
            {"vendor", optional_number(f.vendor)},
            {"product", optional_number(f.product)},
            {"revision", optional_number(f.revision)},
            {"serial", optional_number(f.serial)},
            {"dc_link_mv", optional_number(f.dc_link_mv)},
            {"counts_per_rev", f.counts_per_rev},
            {"rated_torque_nm", f.rated_torque_nm}}},
          {"envelope",
           {{"travel_rev", o.travel},
            {"speed_rev_s", o.speed_rev_s},
            {"torque_nm", o.torque_nm},
            {"time_s", o.time_s},
            {"following_rev", o.following_rev}}},
          {"cycle_us", o.cycle_us}};
}

/// A run on an open drive: what it does between power and no power. False: it came to no result.
using Work = bool (*)(const BenchOptions&, bench::Guard&, json&, std::string& why);

int finish(const BenchOptions& o, bench::Guard& guard, const BusDrive& drive, json& meta, bool found,
           const std::string& why) {
  const bool off = guard.release();
  meta["trip"] = trip_name(guard.trip());
  meta["late_cycles"] = drive.late_cycles();
  meta["off"] = off;
  if (!write_run(o.out, guard, meta)) return kInfrastructure;
  if (o.json) print_exact(meta.dump(1, ' ', false, json::error_handler_t::replace));
  if (!off) complain(kStillOn, {});
  if (guard.trip() != bench::Trip::none) {
    complain(kEndedBy, {trip_words(guard)});
    return kAlarm;
  }
  if (!found) {
    complain(kNotFound, {why, o.out});
    return kAlarm;
  }
  if (!o.json) print_line(text::render(kKept, std::vector<std::string>{o.out}, text::user_language()));
  return off ? kDone : kAlarm;
}

int on_drive(const char* command, const BenchOptions& o, Work work) {
  const auto envelope = envelope_of(o);
  if (!envelope) return kWrongUse;
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(o.bus, holder, code)) return code;
  if (holder) return refuse_held(*holder, o.bus, "`bench`");
  const auto bus = ToolBus::open(o, code);
  if (bus == nullptr) return code;
  if (code = may_move(*bus, text::both("the bench", "стенд"), o); code != kDone) return bus->finish(code);
  if (!make_run_directory(o.out)) return bus->finish(kInfrastructure);
  {
    const auto drive = BusDrive::open(*bus, o, o.out + "/bus.log", code);
    if (drive == nullptr) return bus->finish(code);
    json meta = meta_of(command, o, *drive);
    bench::Guard guard(*drive, *envelope);
    guard.watch = [](const bench::Guard& g) {
      tell(text::render(
          kStage,
          std::vector<std::string>{text::number(static_cast<double>(g.samples().size()) * g.period_s(), 3),
                                   g.stages().back()},
          text::user_language()));
    };
    std::string why;
    const bool found = work(o, guard, meta, why);
    code = finish(o, guard, *drive, meta, found, why);
  }
  return bus->finish(code);
}

json of_response(const bench::Identified& f) {
  json rows = json::array();
  for (const bench::ResponseLine& line : f.response.lines)
    rows.push_back({{"hz", line.hz},
                    {"db", 20.0 * std::log10(std::abs(line.value))},
                    {"deg", std::arg(line.value) * 360.0 / kTurn},
                    {"coherence", line.coherence},
                    {"model_db", 20.0 * std::log10(std::abs(bench::response_of(f.masses, line.hz)))}});
  return rows;
}

void put_identified(const bench::Identified& f, json& meta) {
  meta["friction"] = {
      {"coulomb_nm", f.friction.coulomb_nm},       {"viscous_nm_s_rad", f.friction.viscous_nm_s},
      {"stribeck_nm", f.friction.stribeck_nm},     {"stribeck_speed_rad_s", f.friction.stribeck_speed_rad_s},
      {"breakaway_nm", f.friction.breakaway_nm()}, {"load_nm", f.friction.load_nm},
      {"residual_nm", f.friction.residual_nm}};
  for (const bench::FrictionPoint& p : f.friction_points)
    meta["friction_points"].push_back({{"speed_rev_s", p.speed_rad_s / kTurn}, {"torque_nm", p.torque_nm}});
  meta["inertia_kg_m2"] = f.masses.inertia_kg_m2;
  if (const auto& c = f.masses.coupling)
    meta["coupling"] = {
        {"motor_inertia_kg_m2", c->motor_inertia_kg_m2}, {"load_inertia_kg_m2", c->load_inertia_kg_m2},
        {"stiffness_nm_rad", c->stiffness_nm_rad},       {"damping_nm_s_rad", c->damping_nm_s},
        {"antiresonance_hz", c->antiresonance_hz},       {"resonance_hz", c->resonance_hz}};
  if (f.cogging)
    meta["cogging"] = {{"amplitude_nm", f.cogging->amplitude_nm}, {"periods", f.cogging->periods}};
  if (f.lost_motion)
    meta["lost_motion"] = {{"backlash_rad", f.lost_motion->backlash_rad},
                           {"stiffness_nm_rad", f.lost_motion->stiffness_nm_rad},
                           {"deviation_rad", f.lost_motion->deviation_rad}};
  meta["command_delay_ms"] = f.command_delay_s ? json(*f.command_delay_s * 1e3) : json(nullptr);
  meta["misfit"] = f.masses.misfit;
  meta["valid_hz"] = {f.response.valid_from_hz, f.response.valid_to_hz};
  meta["response"] = of_response(f);
}

void say_identified(const bench::Identified& f) {
  print_formatted("inertia                 %.4g kg m2\n", f.masses.inertia_kg_m2);
  print_formatted("friction                %.4g N m Coulomb, %.4g N m s/rad viscous, %.4g N m breakaway\n",
                  f.friction.coulomb_nm, f.friction.viscous_nm_s, f.friction.breakaway_nm());
  if (f.cogging)
    print_formatted("cogging                 %.4g N m, %d periods in a turn\n", f.cogging->amplitude_nm,
                    f.cogging->periods);
  if (const auto& c = f.masses.coupling)
    print_formatted(
        "resonance               %.1f Hz, antiresonance %.1f Hz; load %.4g kg m2 behind %.4g N m/rad\n",
        c->resonance_hz, c->antiresonance_hz, c->load_inertia_kg_m2, c->stiffness_nm_rad);
  if (f.lost_motion) print_formatted("backlash                %.4g rad\n", f.lost_motion->backlash_rad);
  if (f.command_delay_s) print_formatted("command to measurement  %.2f ms\n", *f.command_delay_s * 1e3);
  print_formatted("response valid from     %.1f to %.1f Hz, misfit %.1f %%\n", f.response.valid_from_hz,
                  f.response.valid_to_hz, 100.0 * f.masses.misfit);
}

bool identify_work(const BenchOptions& o, bench::Guard& guard, json& meta, std::string& why) {
  bench::IdentifyPlan plan;
  plan.slow_rad_s = o.slowest_rev_s * kTurn;
  plan.fast_rad_s = 0.8 * guard.envelope().speed_rad_s;
  plan.bias_rad_s = 0.5 * plan.fast_rad_s;
  plan.torque_nm = o.excitation_nm;
  plan.from_hz = o.from_hz;
  plan.to_hz = o.to_hz;
  plan.lost_motion = !o.no_lost_motion;
  // Nothing gets power that does not fit.
  const bench::Reach reach = bench::reach_of(plan, guard.period_s());
  if (!guard.accepts_travel(reach.from_rad, reach.to_rad) || !guard.enable(bench::Loop::velocity))
    return false;
  const auto found = bench::identify(guard, plan, why);
  if (!found) return false;
  put_identified(*found, meta);
  if (!o.json) say_identified(*found);
  return true;
}

bench::Loop loop_of(const BenchOptions& o) {
  return o.loop == "position" ? bench::Loop::position
         : o.loop == "torque" ? bench::Loop::torque
                              : bench::Loop::velocity;
}

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

bool run_work(const BenchOptions& o, bench::Guard& guard, json& meta, std::string& why) {
  bench::Signal s;
  bench::signal_named(o.signal, s.kind);
  const bench::Loop loop = loop_of(o);
  const double unit = loop == bench::Loop::torque ? 1.0 : kTurn;
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
    why = "signal";
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

int bench_run(const BenchOptions& options) { return on_drive("bench run", options, run_work); }
int bench_identify(const BenchOptions& options) { return on_drive("bench identify", options, identify_work); }

}  // namespace servogate::gateway::command
