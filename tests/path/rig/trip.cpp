// SPDX-License-Identifier: Apache-2.0
#include "tests/path/rig/trip.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path::test {
namespace {

/// The loop of a cycle around planner and follower.
class Rig {
 public:
  Rig(const RandomProgram& program, std::uint64_t seed)
      : program_(program),
        track_(program.config),
        planner_(program.config, track_),
        follower_(program.config, track_),
        random_(seed) {
    first_.position = to_axes(program.config, program.start);
    follower_.set_position(first_.position);
    planner_.restart(program.start);
  }

  bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(random_) < p; }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }

  void feed_planner(std::size_t elements) {
    while (!finished_ && elements-- > 0 && planner_.wants_more()) {
      if (next_ == program_.elements.size()) {
        planner_.finish();
        finished_ = true;
      } else if (!planner_.add(program_.elements[next_++])) {
        flawed_ = true;
      }
      planner_.work();
    }
    planner_.work();
  }

  Sample step(const Record& r) {
    if (r.hold)
      follower_.hold();
    else
      follower_.resume();
    follower_.set_override(r.override_ratio);
    follower_.set_spindle(r.turns);
    if (r.release) follower_.release_stop();
    return follower_.step(r.visible);
  }

  void disturb(const Scenario& s, Record& r) {
    if (s.overrides && chance(0.01))
      r.override_ratio = chance(0.1) ? 0.0 : chance(0.2) ? 1.0 : uniform(0.02, 1.5);
    if (s.holds && chance(r.hold ? 0.02 : 0.005)) r.hold = !r.hold;
    if (s.spindle) turn(r);
    const std::uint64_t there = track_.visible();
    r.visible = s.late && !chance(0.2) ? std::min(there, r.visible + (chance(0.05) ? 1 : 0)) : there;
  }

  void turn(Record& r) {
    constexpr double kRamp = 0.02, kMost = 1.2 * Scenario::kTurns;
    if (chance(0.004)) wanted_turns_ = chance(0.1) ? 0.0 : uniform(0.05 * kMost, kMost);
    r.turns = r.turns < 0.0 ? wanted_turns_ : r.turns + std::clamp(wanted_turns_ - r.turns, -kRamp, kRamp);
  }

  Trip go(const Scenario& s, int most_cycles) {
    Trip out;
    out.samples.push_back(first_);
    Record r;
    for (int cycle = 0; cycle < most_cycles && !out.ended; ++cycle) {
      const bool disturbed = cycle < s.disturbed;
      if (!disturbed || !s.starving)
        feed_planner(1000000);
      else if (chance(0.01))
        feed_planner(static_cast<std::size_t>(uniform(1, 4)));
      if (disturbed)
        disturb(s, r);
      else
        r = {track_.visible(), 1.0, s.spindle ? Scenario::kTurns : -1.0, false, r.release};
      out.samples.push_back(step(r));
      out.record.push_back(r);
      r.release = out.samples.back().state == FollowerState::at_stop && (!disturbed || chance(0.2));
      out.ended =
          finished_ && r.visible == track_.visible() && out.samples.back().state == FollowerState::idle;
    }
    out.ended = out.ended && !flawed_;
    return out;
  }

  Trip again(const std::vector<Record>& record) {
    Trip out;
    out.samples.push_back(first_);
    for (const Record& r : record) {
      while (track_.visible() < r.visible && !finished_) {
        if (next_ == program_.elements.size()) {
          planner_.finish();
          finished_ = true;
        } else {
          planner_.add(program_.elements[next_++]);
        }
        planner_.work();
      }
      planner_.work();
      out.samples.push_back(step(r));
      out.record.push_back(r);
    }
    out.ended = out.samples.back().state == FollowerState::idle;
    return out;
  }

 private:
  const RandomProgram& program_;
  Track track_;
  Planner planner_;
  Follower follower_;
  std::mt19937_64 random_;
  double wanted_turns_ = Scenario::kTurns;
  Sample first_;
  std::size_t next_ = 0;
  bool finished_ = false, flawed_ = false;
};

}  // namespace

Trip run(const RandomProgram& program, const Scenario& scenario, int most_cycles) {
  return Rig(program, scenario.seed).go(scenario, most_cycles);
}

Trip replay(const RandomProgram& program, const std::vector<Record>& record) {
  return Rig(program, 0).again(record);
}

double Worst::most() const { return std::max({velocity, acceleration, jerk}); }

Worst worst(const Trip& run, const Config& config) {
  Worst out;
  const double t = config.period_s;
  // Rest before the first and behind the last set-point belongs to the motion.
  const auto at = [&](std::ptrdiff_t k, int axis) {
    k = std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(run.samples.size()) - 1);
    return run.samples[static_cast<std::size_t>(k)].position[axis];
  };
  for (int i = 0; i < config.axis_count; ++i) {
    const AxisLimits& l = config.limits[i];
    double x0 = at(0, i), x1 = x0, x2 = x0;
    for (std::ptrdiff_t k = 1; k < static_cast<std::ptrdiff_t>(run.samples.size()) + 3; ++k) {
      const double x3 = at(k, i);
      out.velocity = std::max(out.velocity, std::abs(x3 - x2) / t / l.velocity);
      out.acceleration = std::max(out.acceleration, std::abs(x3 - 2 * x2 + x1) / (t * t) / l.acceleration);
      out.jerk = std::max(out.jerk, std::abs(x3 - 3 * x2 + 3 * x1 - x0) / (t * t * t) / l.jerk);
      x0 = x1;
      x1 = x2;
      x2 = x3;
    }
  }
  return out;
}

Polyline points(const Trip& run) {
  Polyline out;
  for (const Sample& s : run.samples)
    if (out.empty() || s.position != out.back()) out.push_back(s.position);
  if (out.size() == 1) out.push_back(out.back());
  return out;
}

std::string verdict(const Trip& run, const RandomProgram& program, Worst* reached) {
  const Config& config = program.config;
  if (!run.ended) return "does not end";
  char text[160];
  const Vector& end = program.elements.back().to;
  for (int i = 0; i < config.axis_count; ++i) {
    const double off = std::abs(run.samples.back().position[i] - end[i]);
    if (!(off <= 1e-6)) {
      std::snprintf(text, sizeof text, "axis %d ends %.3g mm off", i, off);
      return text;
    }
  }
  const Worst w = worst(run, config);
  if (reached != nullptr) *reached = w;
  if (!(w.most() <= 1.001)) {
    std::snprintf(text, sizeof text, "limits: v %.5f a %.5f j %.5f", w.velocity, w.acceleration, w.jerk);
    return text;
  }
  const Polyline programmed = programmed_path(program.start, program.elements, config.axis_count);
  if (!frechet_within(points(run), programmed, program.tolerance, config.axis_count))
    return "leaves the tolerance";
  return {};
}

}  // namespace servogate::path::test
