// SPDX-License-Identifier: Apache-2.0
#include "tests/path/rig/course.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace servogate::path::test {
namespace {

class Collector final : public RunSink, public KnotSink {
 public:
  Collector(const Config& config, double reserve) {
    Pipeline::Settings settings;
    settings.axes = config.axis_count;
    settings.reserve = reserve;
    pipeline = std::make_unique<Pipeline>(settings, *this);
  }
  void put(const Leg& leg) override { pipeline->add(leg); }
  void rest(bool /*confirm*/) override { pipeline->end(); }
  void cruise(const Leg& leg, double speed) override { pipeline->cruise(leg, speed); }
  void work() {
    while (pipeline->work()) {
    }
  }
  void begin(const Vector& before_last, const Vector& last) override {
    course.runs.emplace_back();
    course.runs.back().before = {before_last, last};
  }
  void put(const Knot& knot) override { course.runs.back().knots.push_back(knot); }
  void rest() override {}
  void cruise(const Cruise& cruise) override { course.runs.back().cruise = cruise; }

  std::unique_ptr<Pipeline> pipeline;
  Course course;
};

double time_of(const Knot& knot) { return static_cast<double>(knot.t.ns) * 1e-9 + knot.t.fraction * 1e-9; }

/// Quintic through 0 and 1 with these ends, by Hermite's basis.
double between(double s, double v0, double a0, double v1, double a1) {
  const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
  return v0 * (s - 6 * s3 + 8 * s4 - 3 * s5) + a0 * (0.5 * s2 - 1.5 * s3 + 1.5 * s4 - 0.5 * s5) +
         (10 * s3 - 15 * s4 + 6 * s5) + v1 * (-4 * s3 + 7 * s4 - 3 * s5) + a1 * (0.5 * s3 - s4 + 0.5 * s5);
}

/// De Boor's algorithm on evenly spaced knots.
double spline(double c0, double c1, double c2, double c3, double f) {
  const auto mix = [](double p, double q, double share) { return p + share * (q - p); };
  const double d1 = mix(c0, c1, (f + 2) / 3), d2 = mix(c1, c2, (f + 1) / 3), d3 = mix(c2, c3, f / 3);
  const double e2 = mix(d1, d2, (f + 1) / 2), e3 = mix(d2, d3, f / 2);
  return mix(e2, e3, f);
}

Vector at(const Stage& stage, std::size_t m, double t, int axes) {
  const std::vector<Knot>& run = stage.knots;
  const Knot &from = run[m - 1], &to = run[m];
  const double length = time_of(to) - time_of(from), s = (t - time_of(from)) / length;
  const double f =
      between(s, from.w * length, from.a * length * length, to.w * length, to.a * length * length);
  const auto control = [&](std::size_t back) -> const Vector& {
    return m >= back ? run[m - back].control : stage.before[2 + m - back];
  };
  Vector x{};
  for (int i = 0; i < axes; ++i) x[i] = spline(control(3)[i], control(2)[i], control(1)[i], control(0)[i], f);
  return x;
}

void fail(std::string& text, const char* what, double value) {
  char line[120];
  std::snprintf(line, sizeof line, "%s %.6g; ", what, value);
  text += line;
}

}  // namespace

double Stage::seconds() const { return time_of(knots.back()) + (cruise ? cruise->seconds : 0.0); }

double Course::seconds() const {
  double sum = 0.0;
  for (const Stage& stage : runs) sum += stage.seconds();
  return sum;
}

Course plan(const RandomProgram& program, int portion, double reserve) {
  Collector collector(program.config, reserve);
  Gather gather(program.config, collector);
  gather.restart(program.start);
  int added = 0;
  for (const Element& e : program.elements) {
    if (!gather.add(e)) std::printf("element %d: flaw %d\n", added, static_cast<int>(gather.last_flaw()));
    if (++added % portion != 0) continue;
    collector.work();
    collector.course.most_kept = std::max(collector.course.most_kept, collector.pipeline->kept());
  }
  gather.finish();
  collector.work();
  collector.course.counts = collector.pipeline->counts();
  return collector.course;
}

Polyline sampled(const Course& course, const Vector& start, int axes, double period) {
  Polyline out(4, start);
  double next = period;  // from the begin of the stage
  for (const Stage& stage : course.runs) {
    const double end = stage.seconds(), knots_end = time_of(stage.knots.back());
    std::size_t m = 1;
    for (; next < end; next += period) {
      if (next <= knots_end) {
        while (time_of(stage.knots[m]) < next) ++m;
        out.push_back(at(stage, m, next, axes));
      } else {
        const Cruise& cruise = *stage.cruise;
        out.push_back(
            position(cruise.piece, (next - knots_end) / cruise.seconds * cruise.piece.length, axes));
      }
    }
    next -= end;
    if (stage.cruise) continue;
    next = period;
    out.insert(out.end(), 4, at(stage, stage.knots.size() - 1, end, axes));
  }
  return out;
}

Reached reached(const Polyline& x, const Config& config, double period) {
  Reached most;
  for (std::size_t k = 3; k < x.size(); ++k) {
    for (int i = 0; i < config.axis_count; ++i) {
      const double v = (x[k][i] - x[k - 1][i]) / period;
      const double a = (x[k][i] - 2 * x[k - 1][i] + x[k - 2][i]) / (period * period);
      const double j =
          (x[k][i] - 3 * x[k - 1][i] + 3 * x[k - 2][i] - x[k - 3][i]) / (period * period * period);
      const AxisLimits& limits = config.limits[static_cast<std::size_t>(i)];
      most.velocity = std::max(most.velocity, std::abs(v) / limits.velocity);
      most.acceleration = std::max(most.acceleration, std::abs(a) / limits.acceleration);
      most.jerk = std::max(most.jerk, std::abs(j) / limits.jerk);
    }
  }
  return most;
}

std::string verdict(const Course& course, const RandomProgram& program, Reached* most) {
  std::string text;
  const int axes = program.config.axis_count;
  const Polyline path = programmed_path(program.start, program.elements, axes);
  Polyline fine;
  for (const double period : {0.001, 0.00037}) {
    fine = sampled(course, program.start, axes, period);
    const Reached r = reached(fine, program.config, period);
    if (!(r.velocity <= 1.001)) fail(text, "velocity", r.velocity);
    if (!(r.acceleration <= 1.001)) fail(text, "acceleration", r.acceleration);
    if (!(r.jerk <= 1.001)) fail(text, "jerk", r.jerk);
    if (most != nullptr)
      *most = {std::max(most->velocity, r.velocity), std::max(most->acceleration, r.acceleration),
               std::max(most->jerk, r.jerk)};
  }
  double end = 0.0;
  for (int i = 0; i < axes; ++i) end = std::max(end, std::abs(fine.back()[i] - path.back()[i]));
  if (!(end <= 1e-6)) fail(text, "end point off by", end);
  // The way between two samples bulges by an eighth of acceleration times period squared.
  if (!frechet_within(fine, path, program.tolerance + 5e-5, axes))
    fail(text, "leaves the tolerance", program.tolerance);
  if (course.counts.outside > 0) fail(text, "places outside", static_cast<double>(course.counts.outside));
  if (course.counts.failed > 0)
    fail(text, "windows without a law", static_cast<double>(course.counts.failed));
  return text;
}

}  // namespace servogate::path::test
