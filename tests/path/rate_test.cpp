// SPDX-License-Identifier: Apache-2.0
// The branch of a law over one clock: holds, overrides below 100 % and the way back, at any time.
#include "kernel/path/law/rate_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/counting/allocations.hpp"
#include "tests/path/rig/course.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

class View final : public CourseView {
 public:
  explicit View(const std::vector<Knot>& knots) : knots_(knots) {}
  const Knot* knot(std::int64_t n) const noexcept override {
    if (n < 0) return &knots_.front();  // from rest
    return n < static_cast<std::int64_t>(knots_.size()) ? &knots_[static_cast<std::size_t>(n)] : nullptr;
  }
  std::int64_t end() const noexcept override { return static_cast<std::int64_t>(knots_.size()) - 1; }
  StopHint stop_near(std::int64_t n) const noexcept override {
    return stops.empty() ? StopHint{}
                         : stops[std::min(stops.size() - 1, static_cast<std::size_t>((n + 3) / 4))];
  }
  std::vector<StopHint> stops;  ///< each fourth knot

 private:
  const std::vector<Knot>& knots_;
};

RandomProgram walk(int blocks, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> turn(0.0, 0.15);
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  double x = 0, y = 0, z = 0, heading = 0;
  for (int i = 0; i < blocks; ++i) {
    heading += turn(random);
    x += 0.3 * std::cos(heading), y += 0.3 * std::sin(heading), z += 0.02 * turn(random);
    p.elements.push_back(line_to(x, y, z, 100));
  }
  return p;
}

/// Straight strokes with sharp corners.
RandomProgram strokes() {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  double x = 0;
  for (int letter = 0; letter < 8; ++letter, x += 5)
    for (const auto& [dx, dy] : {std::pair{1.0, 1.2},
                                 {2.0, 3.0},
                                 {2.0, 0.0},
                                 {2.6, 0.0},
                                 {2.6, 3.0},
                                 {4.0, 1.5},
                                 {2.7, 1.4},
                                 {5.0, 0.0}})
      p.elements.push_back(line_to(x + dx, dy, 0, 60));
  return p;
}

/// At the limit of acceleration all the way.
RandomProgram helix() {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  for (int i = 1; i <= 900; ++i)
    p.elements.push_back(line_to(6 - 6 * std::cos(i / 60.0), 6 * std::sin(i / 60.0), 0.004 * i, 100));
  return p;
}

struct Driven {
  explicit Driven(const RandomProgram& program) : p(program), course(plan(p)), view(course.runs[0].knots) {
    limits.axes = p.config.axis_count;
    limits.limits = p.config.limits;
    StopHint hint;
    for (std::int64_t k = 0; k < view.end(); k += 4)
      view.stops.push_back(hint = find_stop(view, k, hint, limits));
  }
  RandomProgram p;
  Course course;
  View view;
  RateLimits limits;
};

TEST(RateChange, ends_where_it_says_and_its_derivatives_are_those_of_its_rate) {
  for (const auto& [r0, r1] :
       {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.0, 0.7}, {0.3, 0.9}, {0.0, -1.0}, {-1.0, 0.0}}) {
    for (const int power : {2, 3}) {
      const RateChange c{r0, 0.2, r1, 0.5, power};
      EXPECT_NEAR(c.at(0).rate, r0, 1e-12);
      EXPECT_NEAR(c.at(0.5).rate, r1, 1e-12);
      EXPECT_NEAR(c.at(0).slope, 0.2, 1e-12);
      EXPECT_NEAR(c.at(0.5).slope, 0.0, 1e-12);
      for (double t = 0.05; t < 0.48; t += 0.05) {
        const double h = 1e-5;
        EXPECT_NEAR(c.at(t).slope, (c.at(t + h).rate - c.at(t - h).rate) / (2 * h), 1e-5);
        EXPECT_NEAR(c.at(t).bend, (c.at(t + h).slope - c.at(t - h).slope) / (2 * h), 1e-3);
        EXPECT_NEAR(c.at(t).rate, (c.at(t + h).passed - c.at(t - h).passed) / (2 * h), 1e-6);
      }
    }
  }
}

TEST(Rate, at_full_rate_gives_the_course_itself_and_never_allocates) {
  Driven d(walk(150, 1));
  d.view.stops.clear();
  RateMotion motion(d.limits);
  const Polyline points = sampled(d.course, {}, 3, 0.001);
  std::size_t n = 4;
  const auto before = servogate::counting::allocations();
  while (motion.step(d.view, 1.0, 0.001)) {
    const Vector x = motion.point(d.view).x;
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(x[i], points[n][i], 1e-9) << n;
    ++n;
  }
  EXPECT_EQ(servogate::counting::allocations(), before);
}

/// A circle that is driven at the limit of acceleration wherever it is, near the limit of velocity.
RandomProgram wide_circle() {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  for (int i = 1; i <= 2500; ++i)
    p.elements.push_back(line_to(200 - 200 * std::cos(i / 2000.0), 200 * std::sin(i / 2000.0), 0, 500));
  return p;
}

std::vector<Driven> hard_paths() {
  std::vector<Driven> all;
  for (const RandomProgram& p : {walk(400, 2), helix(), wide_circle()}) all.emplace_back(p);
  return all;
}

/// Cycles from a wish until it is on its way.
int waits(RateMotion& motion, const Driven& d, double wish) {
  for (int cycle = 0; cycle < 10000; ++cycle) {
    if (!motion.step(d.view, wish, 0.001) || motion.wanted() == wish) return cycle;
    EXPECT_LE(motion.places(), RateMotion::kMostPlaces + 64);
  }
  return 10000;
}

TEST(Rate, a_hold_or_a_lower_override_from_full_rate_is_settled_in_the_next_cycle_on_any_path) {
  std::mt19937_64 random(3);
  for (const Driven& d : hard_paths()) {
    const int last = static_cast<int>(d.course.seconds() * 1000) - 100;
    for (int q = 0; q < 60; ++q) {
      const double wish = q % 3 == 0 ? 0.0 : 0.1 * static_cast<double>(q % 10);
      RateMotion motion(d.limits);
      const int at = std::uniform_int_distribution<int>(50, last)(random);
      for (int n = 0; n < at; ++n) motion.step(d.view, 1.0, 0.001);
      ASSERT_FALSE(motion.changing());
      motion.step(d.view, wish, 0.001);
      EXPECT_TRUE(motion.changing()) << wish << " at " << at;
      // What was settled and not begun begins soon, or in its knot.
      const auto speed = [&] {
        const Vector v = motion.point(d.view).v;
        return std::hypot(v[0], v[1], v[2]);
      };
      int cycles = 0;
      for (double before = speed(), now; motion.rate() == 1.0 && motion.step(d.view, wish, 0.001);
           before = now) {
        now = speed();
        cycles += now < before ? 0 : 1;
      }
      EXPECT_LE(cycles, 17) << wish << " at " << at;
    }
  }
}

/// The shortest stop of one piece that could begin in this cycle, by looking at all lengths, s; kLongest if
/// there is none.
double shortest_stop_now(const Driven& d, const RateMotion& motion) {
  for (double seconds = RateChange::kShortest; seconds < RateChange::kLongest; seconds *= 1.03)
    for (const int power : {2, 3}) {
      int places = 1 << 20;
      Verification way;
      way.begin({1.0, 0.0, 0.0, seconds, power}, motion.time(), motion.knot());
      if (way.go(d.view, d.limits, places) == Fit::fits) return seconds;
    }
  return RateChange::kLongest;
}

TEST(Rate, a_hold_rests_much_sooner_than_by_the_shortest_stop_of_one_piece_that_could_begin_in_its_cycle) {
  constexpr int kLater = 20;
  double taken = 0.0, shortest = 0.0;
  int holds = 0, later = 0, most_places = 0;
  for (const Driven& d : hard_paths()) {
    RateMotion motion(d.limits);
    for (int cycle = 0; motion.step(d.view, 1.0, 0.001); ++cycle) {
      if (cycle < 20 || cycle % 11 != 0) continue;
      RateMotion held = motion;
      int cycles = 0;
      for (; !held.at_rest() && cycles < 10000 && held.step(d.view, 0.0, 0.001); ++cycles)
        most_places = std::max(most_places, held.places());
      const double best = 1000.0 * shortest_stop_now(d, motion);
      taken += cycles;
      shortest += best;
      later += cycles > best + kLater ? 1 : 0;
      ++holds;
    }
  }
  std::printf(
      "%d holds, %.1f cycles on average, by the shortest stops of one piece %.1f; %d of them %d cycles "
      "later\n",
      holds, taken / holds, shortest / holds, later, kLater);
  EXPECT_LE(taken, 0.6 * shortest);
  EXPECT_LE(later, holds / 50);
  EXPECT_LE(most_places, RateMotion::kMostPlaces + 64);
}

TEST(Rate, a_hold_during_a_change_is_on_its_way_within_a_hundred_and_sixty_cycles) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  int longest = 0;
  for (const Driven& d : hard_paths()) {
    const int last = static_cast<int>(d.course.seconds() * 1000) - 600;
    for (int q = 0; q < 60; ++q) {
      RateMotion motion(d.limits);
      const int at = std::uniform_int_distribution<int>(50, last)(random);
      for (int n = 0; n < at; ++n) motion.step(d.view, 1.0, 0.001);
      for (const double before : {0.0, 0.3, 1.0, 0.6}) {
        const auto cycles = static_cast<int>(random() % 200);
        for (int n = 0; n < cycles; ++n) motion.step(d.view, before, 0.001);
        if (q % 4 == static_cast<int>(10.0 * before) % 4) break;
      }
      longest = std::max(longest, waits(motion, d, 0.0));
    }
  }
  EXPECT_LE(longest, 160) << "seed " << seed;
  std::printf("the longest one waited %d cycles\n", longest);
}

TEST(Rate, keeps_all_limits_through_random_holds_overrides_and_ways_back) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  const std::vector<double> targets = {0.0, 0.0, 1.0, 1.0, 1.0, 0.7, 0.3, 1.5, 1.2, -1.0, -0.5};
  Reached most;
  int changes = 0, most_places = 0;
  for (int n = 0; n < 3; ++n) {
    const auto walked = static_cast<unsigned>(seed % 1000000);
    const Driven d(n == 0 ? walk(300, walked) : n == 1 ? strokes() : helix());
    RateMotion motion(d.limits);
    Polyline points(4, Vector{});
    double target = 1.0;
    int until = 0, cycle = 0;
    bool on = true;
    for (; on && cycle < 60000; ++cycle) {
      if (cycle == until) {
        target = cycle < 6000 ? targets[random() % targets.size()] : 1.0;
        until = cycle + static_cast<int>(20 + random() % 980);
      }
      const bool was = motion.changing();
      on = motion.step(d.view, target, 0.001) || motion.rate() < 0.0;
      changes += !was && motion.changing() ? 1 : 0;
      most_places = std::max(most_places, motion.places());
      points.push_back(motion.point(d.view).x);
    }
    EXPECT_FALSE(on) << "did not end";
    for (int q = 0; q < 4; ++q) points.push_back(motion.point(d.view).x);
    const Reached r = reached(points, d.p.config, 0.001);
    most = {std::max(most.velocity, r.velocity), std::max(most.acceleration, r.acceleration),
            std::max(most.jerk, r.jerk)};
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(points.back()[i], d.p.elements.back().to[i], 1e-6);
  }
  EXPECT_LE(most.velocity, 1.001);
  EXPECT_LE(most.acceleration, 1.001);
  EXPECT_LE(most.jerk, 1.001);
  EXPECT_LE(most_places, RateMotion::kMostPlaces + 64);
  std::printf("%d changes, largest share of a limit: v %.5f a %.5f j %.5f; at most %d places in a cycle\n",
              changes, most.velocity, most.acceleration, most.jerk, most_places);
}

}  // namespace
}  // namespace servogate::path::test
