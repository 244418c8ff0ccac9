// SPDX-License-Identifier: Apache-2.0
// `servogate bench tune`: new gains by the measured response of the present ones.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bench/drive/measurement/loop_response.hpp"
#include "bench/drive/measurement/relay.hpp"
#include "bench/drive/response/step_figures.hpp"
#include "bench/drive/tuning/loop_tuning.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/gains_file.hpp"
#include "gateway/command/bench/response_json.hpp"
#include "gateway/command/bench/run_page.hpp"
#include "gateway/command/bench/run_record.hpp"
#include "gateway/command/bench/session.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

using bench::LoopGains;
using nlohmann::json;

const text::Entry kNone{
    "bench.tune-none",
    "no gains within ten times the present ones keep {0} degrees; see {1}/response/report.html",
    "ни при каких коэффициентах в пределах десятикратных нет запаса {0} градусов; см. "
    "{1}/response/report.html"};
const text::Entry kNoPosition{
    "bench.tune-no-position",
    "no position gain from 1/s on goes without overshoot on the velocity loop with {0} N m s/rad, whose "
    "response is "
    "valid from {1} to {2} Hz; a greater --phase-margin asks for a softer velocity loop, and more "
    "--amplitude "
    "widens the range; see {3}/response/report.html",
    "ни при каком коэффициенте положения от 1/с нет работы без перерегулирования на контуре скорости с {0} "
    "Н·м·с/рад, "
    "характеристика которого достоверна от {1} до {2} Гц; больший --phase-margin даст более мягкий контур "
    "скорости, больший --amplitude расширит диапазон; см. {3}/response/report.html"};
const text::Entry kGains{"bench.tune-gains",
                         "{0}: velocity {1} N m s/rad, integral {2} 1/s, position {3} 1/s",
                         "{0}: скорость {1} Н·м·с/рад, интеграл {2} 1/с, положение {3} 1/с"};
const text::Entry kLoop{"bench.tune-loop", "{0}: crossover {1} Hz, phase margin {2} deg, gain margin {3} dB",
                        "{0}: частота среза {1} Гц, запас по фазе {2} град, по усилению {3} дБ"};
const text::Entry kStep{"bench.tune-step", "{0}: rise {1} ms, overshoot {2} %, ITAE {3}",
                        "{0}: нарастание {1} мс, перерегулирование {2} %, ITAE {3}"};
const text::Entry kNotch{"bench.tune-notch",
                         "a notch at {0} Hz that leaves {1} % would allow a velocity gain of {2} N m s/rad",
                         "режекторный фильтр на {0} Гц, оставляющий {1} %, допустил бы усиление скорости {2} "
                         "Н·м·с/рад"};
const text::Entry kNotchUsed{
    "bench.tune-notch-used",
    "with a notch at {0} Hz that leaves {1} %, which allows a velocity gain of {2} N m s/rad",
    "с режекторным фильтром на {0} Гц, оставляющим {1} %: он допускает усиление скорости {2} "
    "Н·м·с/рад"};
const text::Entry kApplyIt{"bench.tune-apply",
                           "nothing was written; --apply writes these gains and proves them",
                           "ничего не записано; --apply запишет эти коэффициенты и проверит их"};
const text::Entry kKeptGains{
    "bench.tune-kept",
    "the gains are written; `servogate od {0} {1} --restore {2}/before.dcf` "
    "takes them back",
    "коэффициенты записаны; прежние вернёт `servogate od {0} {1} --restore {2}/before.dcf`"};
const text::Entry kTakenBack{"bench.tune-back", "the gains before are in force again: {0}",
                             "снова действуют прежние коэффициенты: {0}"};
const text::Entry kNotBack{
    "bench.tune-not-back",
    "the gains before could not be written back: `servogate od {0} {1} --restore {2}/before.dcf`",
    "прежние коэффициенты не записались: `servogate od {0} {1} --restore {2}/before.dcf`"};

/// A step must not become worse by more than its scatter.
constexpr double kWorse = 1.1;
/// A step may overshoot by so much more than it was promised.
constexpr double kOvershootRoom = 0.15;
constexpr double kStep_s = 0.25, kBefore_s = 0.15;

std::string before_words() { return text::both("before", "до"); }
std::string expected_words() { return text::both("expected", "ожидается"); }
std::string after_words() { return text::both("after", "после"); }

void say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  print_line(text::render(entry, arguments, text::user_language()));
}

/// What one set of gains does, measured.
struct Measured {
  std::optional<bench::FrequencyResponse> plant;  ///< speed by torque
  double most_crossover_hz = 0.0;                 ///< up to which it is known; 0: as far as it goes
  std::vector<double> step;                       ///< share of the step, from its beginning on
  std::optional<bench::StepFigures> figures;
};

json gains_json(const LoopGains& g) {
  json out{{"velocity_gain", g.velocity_gain},
           {"velocity_integral", g.velocity_integral},
           {"position_gain", g.position_gain}};
  if (g.notch_hz > 0.0) out["notch"] = {{"hz", g.notch_hz}, {"left_percent", 100.0 * g.notch_depth}};
  return out;
}

json step_json(const bench::StepFigures& f) {
  return {{"rise_s", optional_number(f.rise_s)},
          {"settling_s", optional_number(f.settling_s)},
          {"overshoot_percent", 100.0 * f.overshoot},
          {"itae", f.itae}};
}

json margins_json(const bench::Margins& m) {
  return {{"crossover_hz", optional_number(m.crossover_hz)},
          {"phase_margin_deg", optional_number(m.phase_margin_deg)},
          {"gain_margin_db", optional_number(m.gain_margin_db)}};
}

std::string words(const std::optional<double>& value, double times = 1.0) {
  return value ? text::number(*value * times, 2) : "?";
}

class Tuner {
 public:
  Tuner(const BenchOptions& options, const GainsFile& file, BenchPlan& plan, ToolBus& bus)
      : o_(options), file_(file), plan_(plan), bus_(bus), node_(static_cast<canopen::NodeId>(options.node)) {}

  int run() {
    auto standing = read_gains(bus_, node_, file_);
    if (!standing) return kAlarm;
    standing_ = std::move(*standing);
    if (!save_dcf("before.dcf")) return kInfrastructure;
    if (const int code = measure("response", "step", before_); code != kDone) return code;
    if (const int code = propose(); code != kDone) return code;
    if (!o_.apply) {
      if (!o_.json) say(kApplyIt, {});
      return finish(kDone);
    }
    return apply();
  }

 private:
  BenchOptions part(const std::string& name) const {
    BenchOptions o = o_;
    o.out = o_.out + "/" + name;
    o.part = true;
    return o;
  }

  /// The response and a step with the gains that the drive has now.
  int measure(const std::string& response, const std::string& step, Measured& out) {
    const int code = run_on_bus(bus_, "bench tune response", part(response), plan_, [&](BenchWork& work) {
      return o_.relay_nm > 0.0 ? take_relay(work, out) : take_response(work, out);
    });
    if (code != kDone) return code;
    return run_on_bus(bus_, "bench tune step", part(step), plan_,
                      [&](BenchWork& work) { return take_step(work, out); });
  }

  bool take_response(BenchWork& work, Measured& out) {
    bench::LoopResponsePlan plan;
    plan.excitation = o_.amplitude * kTurnRad;
    plan.offset = o_.offset * kTurnRad;
    plan.from_hz = o_.from_hz;
    plan.to_hz = o_.to_hz;
    plan.block = static_cast<std::size_t>(o_.period);
    plan.blocks = o_.periods;
    const auto wanted = bench::loop_excitation(plan, work.guard.period_s());
    if (wanted.empty() || !work.guard.accepts(bench::Loop::velocity, wanted) ||
        !work.guard.enable(bench::Loop::velocity))
      return false;
    auto found = bench::take_loop_response(work.guard, plan);
    if (found) {
      put_loop_response(*found, "velocity", work.meta);
      out.plant = std::move(found->plant);
    }
    work.why = text::both("response of the loop", "характеристика контура");
    return out.plant.has_value();
  }

  /// One frequency, by a relay; the plant is taken for an inertia, and no loop is promised beyond that
  /// frequency.
  bool take_relay(BenchWork& work, Measured& out) {
    bench::RelayPlan plan;
    plan.speed_rad_s = o_.offset * kTurnRad;
    plan.torque_nm = o_.relay_nm;
    if (!work.guard.accepts(bench::Loop::velocity, bench::relay_course(plan, work.guard.period_s())) ||
        !work.guard.accepts(bench::Loop::torque, std::vector<double>{o_.relay_nm}) ||
        !work.guard.enable(bench::Loop::velocity))
      return false;
    const auto found = bench::take_relay(work.guard, plan);
    work.why = text::both("oscillation of the relay", "колебания реле");
    if (!found) return false;
    work.meta["figures"] = {{"hz", found->hz},
                            {"inertia_kg_m2", found->inertia_kg_m2},
                            {"dead_time_s", found->dead_time_s},
                            {"swing_rev_s", found->swing_rad_s / kTurnRad}};
    meta_["relay"] = work.meta["figures"];
    out.plant = bench::relay_model(*found, o_.from_hz, o_.to_hz);
    out.most_crossover_hz = found->hz;
    return true;
  }

  /// From one even speed to another, so that friction has no part in it.
  bool take_step(BenchWork& work, Measured& out) {
    bench::Guard& guard = work.guard;
    const double h = guard.period_s(), low = o_.offset * kTurnRad, high = low + o_.step_rev_s * kTurnRad;
    const double ramp = std::abs(low) / (std::abs(low) / kStep_s + 1.0);
    std::vector<double> course(static_cast<std::size_t>((ramp + kBefore_s) / h), low);
    course.insert(course.end(), static_cast<std::size_t>(kStep_s / h), high);
    if (!guard.accepts(bench::Loop::velocity, course) || !guard.enable(bench::Loop::velocity) ||
        !guard.run_at(low, std::abs(low) / kStep_s + 1.0, kBefore_s))
      return false;
    guard.stage("step");
    period_s_ = h;
    std::vector<double> speed;
    for (double t = 0.0; t < kStep_s; t += h) {
      if (!guard.step(bench::Loop::velocity, high)) return false;
      speed.push_back((guard.speed_rad_s() - low) / (high - low));
    }
    // Two cycles are the bus's, and half of one is the slope's.
    constexpr std::ptrdiff_t kBus = 2;
    out.step.assign(speed.begin() + std::min<std::ptrdiff_t>(kBus, std::ssize(speed)), speed.end());
    out.figures = bench::step_figures(out.step, h, 0.0, 1.0, 0.05);
    if (out.figures) work.meta["figures"] = step_json(*out.figures);
    work.why = text::both("step", "скачок");
    return out.figures.has_value();
  }

  /// The open loop of gains on the plant as it was measured with them.
  bench::FrequencyResponse loop_with(const Measured& measured, const LoopGains& gains) const {
    return bench::velocity_loop(*measured.plant, gains, o_.inner_delay_ms * 1e-3);
  }

  int propose() {
    bench::TuningWish wish;
    wish.phase_margin_deg = o_.phase_margin_deg;
    wish.most_crossover_hz = before_.most_crossover_hz;
    const bench::FrequencyResponse open = loop_with(before_, standing_.gains);
    tuning_ = bench::tune(open, standing_.gains, wish);
    meta_["gains"]["before"] = gains_json(standing_.gains);
    const bench::Margins now = bench::margins(open);
    meta_["before"] = {{"loop", margins_json(now)}, {"step", step_json(*before_.figures)}};
    propose_notch(open, wish);
    if (!tuning_) {
      complain(kNone, {text::number(o_.phase_margin_deg), o_.out});
      return finish(kAlarm);
    }
    if (file_.has(&LoopGains::position_gain) && !(tuning_->gains.position_gain > 0.0)) {
      complain(kNoPosition, {text::number(tuning_->gains.velocity_gain, 6),
                             text::number(open.valid_from_hz, 1), text::number(open.valid_to_hz, 1), o_.out});
      tuning_.reset();
      return finish(kAlarm);
    }
    if (!file_.has(&LoopGains::velocity_integral))
      tuning_->gains.velocity_integral = standing_.gains.velocity_integral;
    if (!file_.has(&LoopGains::position_gain)) tuning_->gains.position_gain = standing_.gains.position_gain;
    // What the drive cannot be given is not promised.
    if (!file_.has(&LoopGains::velocity_integral) || !file_.has(&LoopGains::position_gain))
      if (auto again = bench::expect(open, standing_.gains, tuning_->gains)) tuning_ = std::move(again);
    expected_ = bench::step_of(tuning_->closed, period_s_, kStep_s);
    const auto figures = bench::step_figures(expected_, period_s_, 0.0, 1.0, 0.05);
    meta_["gains"]["proposed"] = gains_json(tuning_->gains);
    meta_["expected"] = {{"loop", margins_json(tuning_->velocity)},
                         {"position_loop", margins_json(tuning_->position)},
                         {"bandwidth_hz", tuning_->velocity_bandwidth_hz},
                         {"sensitivity_db", tuning_->sensitivity_db}};
    if (figures) meta_["expected"]["step"] = step_json(*figures);
    tell_gains(before_words(), standing_.gains, now, before_.figures);
    tell_gains(expected_words(), tuning_->gains, tuning_->velocity, figures);
    return kDone;
  }

  /// A notch that makes the loop a fifth stiffer: the drive gets it where the file names its objects.
  void propose_notch(const bench::FrequencyResponse& open, const bench::TuningWish& wish) {
    const auto notch = bench::notch_for(open);
    auto with = notch ? bench::tune(open, standing_.gains, wish, &*notch) : std::nullopt;
    if (!with || (tuning_ && with->gains.velocity_gain < 1.2 * tuning_->gains.velocity_gain)) return;
    const bool used = file_.has_notch();
    meta_["notch"] = {{"hz", notch->hz},
                      {"left_percent", 100.0 * notch->damping},
                      {"used", used},
                      {"gains", gains_json(with->gains)},
                      {"loop", margins_json(with->velocity)}};
    if (!o_.json)
      say(used ? kNotchUsed : kNotch, {text::number(notch->hz, 1), text::number(100.0 * notch->damping, 0),
                                       text::number(with->gains.velocity_gain, 6)});
    if (used) tuning_ = std::move(with);
  }

  int apply() {
    LoopGains wanted = tuning_->gains;
    std::string why = text::both("one was refused", "один не принят");
    int code = write_gains(bus_, node_, file_, standing_, wanted) ? kDone : kAlarm;
    if (code == kDone) {
      meta_["gains"]["written"] = gains_json(wanted);
      written_ = wanted;
      code = measure("response-after", "step-after", after_);
      why = text::both("the drive was stopped", "привод был остановлен");
    }
    if (code == kDone) {
      const bench::Margins now = bench::margins(loop_with(after_, wanted));
      meta_["after"] = {{"loop", margins_json(now)}, {"step", step_json(*after_.figures)}};
      tell_gains(after_words(), wanted, now, after_.figures);
      if (worse(why)) code = kAlarm;
    }
    meta_["kept"] = code == kDone;
    if (code != kDone) return take_back(code, why);
    if (!save_dcf("tuned.dcf")) {
      meta_["kept"] = false;
      return take_back(kInfrastructure, text::both("tuned.dcf was not written", "tuned.dcf не записан"));
    }
    if (!o_.json) say(kKeptGains, {o_.bus, std::to_string(o_.node), o_.out});
    return finish(kDone);
  }

  bool worse(std::string& why) const {
    const auto promised = bench::step_figures(expected_, period_s_, 0.0, 1.0, 0.05);
    if (promised && after_.figures->overshoot > promised->overshoot + kOvershootRoom) {
      why = text::both("the step overshoots more than was promised", "перерегулирование больше обещанного");
      return true;
    }
    if (after_.figures->itae <= kWorse * before_.figures->itae) return false;
    why = text::both("the step is worse than before", "скачок хуже прежнего");
    return true;
  }

  int take_back(int code, const std::string& why) {
    if (restore_gains(bus_, node_, file_, standing_)) {
      complain(kTakenBack, {why});
    } else {
      complain(kNotBack, {o_.bus, std::to_string(o_.node), o_.out});
    }
    return finish(code);
  }

  void tell_gains(const std::string& when, const LoopGains& g, const bench::Margins& m,
                  const std::optional<bench::StepFigures>& figures) const {
    if (o_.json) return;
    say(kGains, {when, text::number(g.velocity_gain, 6), text::number(g.velocity_integral, 2),
                 text::number(g.position_gain, 2)});
    say(kLoop, {when, words(m.crossover_hz), words(m.phase_margin_deg), words(m.gain_margin_db)});
    if (figures)
      say(kStep, {when, words(figures->rise_s, 1e3), text::number(100.0 * figures->overshoot, 1),
                  text::number(figures->itae, 8)});
  }

  bool save_dcf(const std::string& name) {
    const std::string path = o_.out + "/" + name;
    const std::string bytes = gains_dcf(bus_, node_, file_);
    const std::string why = bytes.empty() ? text::both("the gains cannot be read", "коэффициенты не читаются")
                                          : report::write_file(path, bytes);
    if (!why.empty()) complain(kCannotWrite, {path, why});
    return why.empty();
  }

  int finish(int code) {
    meta_["schema"] = 1;
    meta_["command"] = "bench tune";
    meta_["bus"] = o_.bus;
    meta_["node"] = o_.node;
    const auto course = [&](const std::vector<double>& y, const std::string& name) {
      std::vector<double> x;
      for (std::size_t i = 0; i < y.size(); ++i) x.push_back(static_cast<double>(i) * period_s_);
      Series s = course_of(x, y);
      s.name = text::in_language(name);
      return s;
    };
    Plot step{"Step of the velocity, share over s", {course(before_.step, before_words())}};
    Plot loop{"Open loop: gain in dB over Hz",
              {json_column(lines_json(loop_with(before_, standing_.gains)), "hz", "db")},
              true};
    loop.series.back().name = text::in_language(before_words());
    if (!expected_.empty()) step.series.push_back(course(expected_, expected_words()));
    if (after_.plant) {
      loop.series.push_back(json_column(lines_json(loop_with(after_, written_)), "hz", "db"));
      loop.series.back().name = text::in_language(after_words());
    }
    if (!after_.step.empty()) step.series.push_back(course(after_.step, after_words()));
    const std::pair<std::string, std::string> files[] = {
        {o_.out + "/meta.json", meta_.dump(1, ' ', false, json::error_handler_t::replace) + "\n"},
        {o_.out + "/report.html", plot_page("servogate bench tune", meta_, {step, loop})}};
    for (const auto& [path, content] : files)
      if (const std::string why = report::write_file(path, content); !why.empty()) {
        complain(kCannotWrite, {path, why});
        return kInfrastructure;
      }
    if (o_.json) print_exact(meta_.dump(1, ' ', false, json::error_handler_t::replace));
    return code;
  }

  const BenchOptions& o_;
  const GainsFile& file_;
  BenchPlan& plan_;
  ToolBus& bus_;
  canopen::NodeId node_;
  StandingGains standing_;  ///< what the drive had before
  LoopGains written_;
  Measured before_, after_;
  std::optional<bench::Tuning> tuning_;
  std::vector<double> expected_;
  double period_s_ = 1e-3;
  json meta_;
};

}  // namespace

int bench_tune(const BenchOptions& options) {
  const auto file = read_gains_file(options.gains);
  auto plan = plan_of(options, use_of_loop(bench::Loop::velocity));
  if (!file || !plan) return kWrongUse;
  int code = kDone;
  const auto bus = open_bench(options, code);
  if (bus == nullptr) return code;
  if (!make_run_directory(options.out)) return bus->finish(kInfrastructure);
  return bus->finish(Tuner(options, *file, *plan, *bus).run());
}

}  // namespace servogate::gateway::command
