// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/identify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/drive/excitation/signal.hpp"
#include "bench/drive/measurement/at_rest.hpp"

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSettle_s = 0.2;
/// Share of the friction that holds coupling faces together while torque swings about it.
constexpr double kOfFriction = 0.22;
constexpr int kTrials = 2;
constexpr double kMisfit = 0.12;

double acceleration_of(const IdentifyPlan& plan) { return plan.fast_rad_s / 0.25; }

std::vector<double> speeds_of(const IdentifyPlan& plan) {
  std::vector<double> out;
  const int n = std::max(2, plan.speeds);
  for (int i = 0; i < n; ++i)
    out.push_back(plan.slow_rad_s *
                  std::pow(plan.fast_rad_s / plan.slow_rad_s, static_cast<double>(i) / (n - 1)));
  return out;
}

/// At the two slowest speeds that make a turn in time, a little more than one is made: cogging needs it.
double hold_of(const IdentifyPlan& plan, double speed, int& turns) {
  const double turn = 1.02 * kTurn / speed;
  if (turns == 2 || turn > plan.turn_s) return plan.hold_s;
  ++turns;
  return std::max(plan.hold_s, turn);
}

double response_time(const IdentifyPlan& plan, double period) {
  return static_cast<double>(plan.block) * (plan.blocks + 1) * period;
}

struct EvenSpan {
  double speed = 0.0;
  std::size_t from = 0, to = 0;  ///< samples of the guard
};

struct Arrays {
  std::vector<double> angle, torque;
};
Arrays arrays_of(const Guard& guard, const EvenSpan& span) {
  Arrays a;
  for (std::size_t i = span.from; i < span.to; ++i) {
    a.angle.push_back(guard.samples()[i].position_rad);
    a.torque.push_back(guard.samples()[i].torque_nm);
  }
  return a;
}

bool run_even_speeds(Guard& guard, const IdentifyPlan& plan, std::vector<EvenSpan>& spans) {
  int turns[2] = {0, 0};
  for (const double speed : speeds_of(plan))
    for (const int side : {0, 1}) {
      const double signed_speed = side == 0 ? speed : -speed;
      if (!guard.run_at(signed_speed, acceleration_of(plan), kSettle_s)) return false;
      EvenSpan span{signed_speed, guard.samples().size(), 0};
      if (!guard.run_at(signed_speed, acceleration_of(plan), hold_of(plan, speed, turns[side]))) return false;
      span.to = guard.samples().size();
      spans.push_back(span);
    }
  return guard.run_at(0.0, acceleration_of(plan), 0.05);
}

bool makes_a_turn(const Arrays& a) {
  return a.angle.size() >= 16 && std::abs(a.angle.back() - a.angle.front()) > kTurn;
}

/// From the slowest runs that make a turn, four speeds in both directions.
std::optional<Cogging> rough_cogging(Guard& guard, const std::vector<EvenSpan>& spans) {
  constexpr std::size_t kRuns = 8;
  std::vector<Arrays> arrays;
  for (const EvenSpan& span : spans) {
    Arrays a = arrays_of(guard, span);
    if (arrays.size() < kRuns && makes_a_turn(a)) arrays.push_back(std::move(a));
  }
  std::vector<EvenRun> runs;
  for (const Arrays& a : arrays) runs.push_back({a.angle, a.torque, guard.period_s()});
  std::optional<Cogging> found;
  guard.meanwhile([&] { found = find_cogging(runs); });
  return found;
}

/// Where cogging is measured. Far below the antiresonance the torque shows nearly all of it, but there the
/// load may chatter on friction that falls with the speed. Above the resonance the load stands against the
/// motor, and most of it goes into the motor's inertia. Both together are not misled by either.
std::vector<double> cogging_speeds(const IdentifyPlan& plan, const Identified& found) {
  constexpr double kRigidHz[] = {10.0, 25.0, 60.0};
  constexpr double kOfAntiresonance[] = {0.14, 0.2}, kOfResonance[] = {1.2, 1.5, 1.8};
  std::vector<double> hz;
  if (const auto& c = found.masses.coupling) {
    for (const double share : kOfAntiresonance) hz.push_back(share * c->antiresonance_hz);
    for (const double share : kOfResonance) hz.push_back(share * c->resonance_hz);
  } else {
    hz.assign(std::begin(kRigidHz), std::end(kRigidHz));
  }
  std::vector<double> speeds;
  for (const double f : hz) {
    const double speed = std::max(plan.slow_rad_s, f * kTurn / found.cogging->periods);
    if (speed <= plan.fast_rad_s && (speeds.empty() || speed > speeds.back())) speeds.push_back(speed);
  }
  return speeds;
}

/// Even speeds in both directions, for the harmonic that was found.
bool run_for_cogging(Guard& guard, const IdentifyPlan& plan, const std::vector<double>& speeds,
                     std::vector<EvenSpan>& spans) {
  constexpr double kHold_s = 1.2;
  guard.stage("cogging");
  for (const double speed : speeds)
    for (const double side : {1.0, -1.0}) {
      if (!guard.run_at(side * speed, acceleration_of(plan), kSettle_s)) return false;
      EvenSpan span{side * speed, guard.samples().size(), 0};
      if (!guard.run_at(side * speed, acceleration_of(plan), kHold_s)) return false;
      span.to = guard.samples().size();
      spans.push_back(span);
    }
  return guard.run_at(0.0, acceleration_of(plan), 0.05);
}

std::optional<Cogging> sized_cogging(Guard& guard, const std::vector<EvenSpan>& spans,
                                     const Identified& found) {
  std::vector<Arrays> arrays;
  for (const EvenSpan& span : spans) arrays.push_back(arrays_of(guard, span));
  std::vector<EvenRun> runs;
  for (const Arrays& a : arrays) runs.push_back({a.angle, a.torque, guard.period_s()});
  std::optional<Cogging> sized;
  guard.meanwhile([&] { sized = size_cogging(runs, found.masses, found.friction, found.cogging->periods); });
  return sized;
}

std::vector<FrictionPoint> friction_points(const Guard& guard, const std::vector<EvenSpan>& spans,
                                           const std::optional<Cogging>& cogging) {
  std::vector<FrictionPoint> points;
  for (const EvenSpan& span : spans) {
    const Arrays a = arrays_of(guard, span);
    const auto n = static_cast<double>(a.torque.size());
    if (n < 10.0) continue;
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < a.torque.size(); ++i) {
      const double t = a.torque[i] - (cogging ? cogging->at(a.angle[i]) : 0.0);
      sum += t;
      squares += t * t;
    }
    const double mean = sum / n, variance = std::max(1e-18, squares / n - mean * mean);
    // The speed that was, not the one that was asked for.
    const double speed = (a.angle.back() - a.angle.front()) / ((n - 1.0) * guard.period_s());
    points.push_back({speed, mean, std::sqrt(variance / n)});
  }
  return points;
}

/// Inertia to a few ten per cent, enough for a slow loop: torque while it accelerated less friction.
double rough_inertia(const Guard& guard, const IdentifyPlan& plan, const std::vector<EvenSpan>& spans,
                     const FrictionCurve& friction) {
  double sum = 0.0;
  int count = 0;
  const auto& s = guard.samples();
  const auto lag = static_cast<std::size_t>(std::ceil(0.01 / guard.period_s()));
  const double least = 0.3 * acceleration_of(plan);
  for (std::size_t i = lag; i < spans.back().to; ++i) {
    const double ask =
        (s[i].set_point - s[i - lag].set_point) / (static_cast<double>(lag) * guard.period_s());
    if (i + lag >= s.size() || s[i].loop != Loop::velocity || std::abs(ask) < least) continue;
    const double speed =
        (s[i + lag].position_rad - s[i].position_rad) / (static_cast<double>(lag) * guard.period_s());
    const double before =
        (s[i].position_rad - s[i - lag].position_rad) / (static_cast<double>(lag) * guard.period_s());
    const double acceleration = (speed - before) / (static_cast<double>(lag) * guard.period_s());
    if (std::abs(acceleration) < least || speed * before <= 0.0) continue;
    sum += (s[i].torque_nm - friction.at(0.5 * (speed + before))) / acceleration;
    ++count;
  }
  return count > 0 ? std::abs(sum / count) : 0.0;
}

/// Holds a speed by torque, softly: far below what is measured.
class SoftSpeedLoop {
 public:
  SoftSpeedLoop(double inertia, double bandwidth_rad_s, double most_nm, double period)
      : gain_(inertia * bandwidth_rad_s),
        integral_gain_(0.25 * gain_ * bandwidth_rad_s),
        most_(most_nm),
        period_(period) {}
  void begin(double torque, double speed) {
    integral_ = torque;
    filtered_ = speed;
  }
  double torque(double wanted, double speed) {
    filtered_ += (1.0 - std::exp(-50.0 * period_)) * (speed - filtered_);
    const double error = wanted - filtered_;
    integral_ = std::clamp(integral_ + integral_gain_ * error * period_, -most_, most_);
    return std::clamp(integral_ + gain_ * error, -most_, most_);
  }

 private:
  double gain_, integral_gain_, most_, period_, integral_ = 0.0, filtered_ = 0.0;
};

struct Response {
  Masses masses;
  FrequencyResponse response;
  std::optional<double> command_delay_s;
  double excitation_nm = 0.0;
};

struct ResponseCourse {
  const std::vector<double>&reference, &command, &angle, &torque, &net;
};

/// nullopt: no masses explain it.
std::optional<Response> response_of_course(const IdentifyPlan& plan, double period, const ResponseCourse& c) {
  const std::vector<double> speed = slope(c.angle, period);
  // The first block is for what was before it to die away; speed i is of sample i + 1.
  const auto cut = [&](const std::vector<double>& v, std::size_t shift) {
    return std::span(v).subspan(plan.block + shift, plan.block * static_cast<std::size_t>(plan.blocks));
  };
  SpectrumSettings settings;
  settings.period_s = period;
  settings.block = plan.block;
  Response r;
  r.response = frequency_response(cut(c.reference, 1), cut(c.net, 1), cut(speed, 0), settings);
  for (ResponseLine& line : r.response.lines) line.value /= slope_gain(line.hz, period);
  r.command_delay_s =
      delay_of(frequency_response(cut(c.reference, 1), cut(c.command, 1), cut(c.torque, 1), settings));
  const auto masses = fit_masses(r.response);
  if (!masses) return std::nullopt;
  r.masses = *masses;
  return r;
}

struct ResponseTry {
  double bias_rad_s = 0.0, excitation_nm = 0.0;
};

bool take_response(Guard& guard, const IdentifyPlan& plan, double inertia, const ResponseTry& how,
                   const Identified& out, std::optional<Response>& result) {
  const double bias = how.bias_rad_s;
  Signal signal;
  signal.kind = SignalKind::multisine;
  signal.from_hz = plan.from_hz;
  signal.to_hz = std::min(plan.to_hz, 0.4 / guard.period_s());
  signal.period = plan.block;
  signal.amplitude = how.excitation_nm;
  const std::vector<double> once = samples(signal, guard.period_s());
  if (once.empty()) return true;
  if (!guard.run_at(bias, acceleration_of(plan), kSettle_s)) return false;

  SoftSpeedLoop loop(inertia, 4.0, 0.9 * guard.envelope().torque_nm, guard.period_s());
  loop.begin(out.friction.at(bias), bias);
  const std::size_t n = plan.block * static_cast<std::size_t>(plan.blocks + 1);
  const std::size_t first = guard.samples().size();
  std::vector<double> reference, command;
  for (std::size_t i = 0; i < n + 2; ++i) {
    reference.push_back(once[i % once.size()]);
    const double torque = loop.torque(bias, guard.speed_rad_s()) + reference.back();
    command.push_back(std::clamp(torque, -guard.envelope().torque_nm, guard.envelope().torque_nm));
    if (!guard.step(Loop::torque, command.back())) return false;
  }
  std::vector<double> angle, torque, net;
  for (std::size_t i = first; i < guard.samples().size(); ++i) {
    angle.push_back(guard.samples()[i].position_rad);
    torque.push_back(guard.samples()[i].torque_nm);
    net.push_back(torque.back() - (out.cogging ? out.cogging->at(angle.back()) : 0.0));
  }
  if (!guard.run_at(0.0, acceleration_of(plan), 0.05)) return false;
  return guard.meanwhile([&] {
    result = response_of_course(plan, guard.period_s(), {reference, command, angle, torque, net});
    if (result) result->excitation_nm = how.excitation_nm;
  });
}

/// Cogging that passes at about the resonance shakes the load loose: then so fast that it passes beyond it.
double bias_beyond_resonance(const IdentifyPlan& plan, const Identified& out, const Masses& masses) {
  constexpr double kNear = 1.6, kBeyond = 1.9;
  if (!out.cogging || !masses.coupling) return plan.bias_rad_s;
  const double bias_at_it = kTurn * masses.coupling->resonance_hz / out.cogging->periods;
  if (plan.bias_rad_s > kNear * bias_at_it) return plan.bias_rad_s;
  return std::max(plan.bias_rad_s, std::min(plan.fast_rad_s, kBeyond * bias_at_it));
}

}  // namespace

Reach reach_of(const IdentifyPlan& plan, double period) {
  double furthest = 0.0;
  int turns = 0;
  for (const double speed : speeds_of(plan))
    furthest = std::max(furthest, speed * (kSettle_s + hold_of(plan, speed, turns) + 0.25));
  // A second one may be faster.
  const double response =
      (plan.bias_rad_s + plan.fast_rad_s) * (response_time(plan, period) + kSettle_s + 0.25);
  return {-0.3 * furthest, 1.2 * std::max(furthest, response)};
}

std::optional<Identified> identify(Guard& guard, const IdentifyPlan& plan, std::string& why) {
  Identified out;
  const Reach reach = reach_of(plan, guard.period_s());
  if (!guard.accepts_travel(reach.from_rad, reach.to_rad)) return std::nullopt;
  std::vector<EvenSpan> spans;
  guard.stage("friction");
  if (!run_even_speeds(guard, plan, spans)) return std::nullopt;
  out.cogging = rough_cogging(guard, spans);
  const auto friction = fit_friction(friction_points(guard, spans, out.cogging));
  why = "friction";
  if (!friction) return std::nullopt;
  out.friction = *friction;
  const double inertia = rough_inertia(guard, plan, spans, out.friction);
  why = "inertia";
  if (!(inertia > 0.0)) return std::nullopt;
  // Where torque swings more than friction presses, the load comes loose and the response is none of a linear
  // plant: again with less. With too little of it noise spoils the response; the better one counts.
  const double friction_there = std::abs(out.friction.at(plan.bias_rad_s) - out.friction.load_nm);
  ResponseTry how{plan.bias_rad_s, std::min(plan.torque_nm, kOfFriction * friction_there)};
  std::optional<Response> best;
  for (int trial = 0; trial < kTrials; ++trial) {
    guard.stage("response");
    std::optional<Response> response;
    if (!take_response(guard, plan, inertia, how, out, response)) return std::nullopt;
    if (response && (!best || response->masses.misfit < best->masses.misfit)) best = std::move(response);
    const double beyond = best ? bias_beyond_resonance(plan, out, best->masses) : how.bias_rad_s;
    if (best && best->masses.misfit <= kMisfit && beyond == how.bias_rad_s) break;
    if (beyond == how.bias_rad_s) how.excitation_nm *= 0.6;
    how.bias_rad_s = beyond;
  }
  why = "masses";
  if (!best) return std::nullopt;
  out.masses = best->masses;
  out.response = std::move(best->response);
  out.command_delay_s = best->command_delay_s;
  out.excitation_nm = best->excitation_nm;

  if (out.cogging) {
    std::vector<EvenSpan> even;
    if (!run_for_cogging(guard, plan, cogging_speeds(plan, out), even)) return std::nullopt;
    if (const auto sized = sized_cogging(guard, even, out)) out.cogging = sized;
    spans.insert(spans.end(), even.begin(), even.end());
  }
  out.friction_points = friction_points(guard, spans, out.cogging);
  if (const auto again = fit_friction(out.friction_points)) out.friction = *again;
  if (plan.lost_motion) {
    guard.stage("lost motion");
    AtRest at_rest;
    if (!look_at_rest(guard, {out.friction, out.cogging, out.masses}, at_rest)) return std::nullopt;
    out.lost_motion = fit_lost_motion(at_rest.presses);
    out.friction_points.insert(out.friction_points.end(), at_rest.breakaways.begin(),
                               at_rest.breakaways.end());
    if (const auto again = fit_friction(out.friction_points)) out.friction = *again;
  }
  why.clear();
  return out;
}

}  // namespace servogate::bench
