// SPDX-License-Identifier: Apache-2.0
// Shape and law over one clock: whole programs against known answers, judged on what is published.
#include "tests/path/rig/course.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kPi = std::numbers::pi;

RandomProgram program(std::vector<Element> elements) {
  RandomProgram p;
  p.config = mill();
  p.elements = std::move(elements);
  p.tolerance = 0.01;
  return p;
}

RandomProgram collinear(int blocks, double step) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i) e.push_back(line_to(step * i, 0, 0, 100));
  return program(e);
}

RandomProgram polygon(int blocks) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i) {
    const double a = 2 * kPi * i / blocks;
    e.push_back(line_to(20 - 20 * std::cos(a), 20 * std::sin(a), 0, 100));
  }
  return program(e);
}

RandomProgram zigzag(int blocks) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i) e.push_back(line_to(0.1 * ((i + 1) / 2), 0.1 * (i / 2), 0, 100));
  return program(e);
}

/// Short lines round and round.
RandomProgram around(int blocks) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i)
    e.push_back(line_to(60 - 60 * std::cos(i / 150.0), 60 * std::sin(i / 150.0), 0.01 * i, 100));
  return program(e);
}

TEST(Course, of_a_straight_line_in_a_thousand_blocks_takes_what_one_block_takes) {
  const RandomProgram p = collinear(1000, 0.1);
  const Course c = plan(p);
  EXPECT_EQ(verdict(c, p), "");
  EXPECT_GE(c.seconds(), 1.2);  // by hand, 100 mm / 100 mm/s + 0.1 s + 0.1 s
  EXPECT_LE(c.seconds(), 1.21);
}

TEST(Course, of_a_circle_takes_the_same_as_an_arc_and_as_a_thousand_blocks) {
  const RandomProgram blocks = polygon(1000), arc = program({arc_to(0, 0, 20, 0, 360, 100)});
  const Course a = plan(blocks), b = plan(arc);
  EXPECT_EQ(verdict(a, blocks), "");
  EXPECT_EQ(verdict(b, arc), "");
  EXPECT_LE(a.seconds(), 1.47);  // 1.457 if the jerk along the path alone counted
  EXPECT_LE(b.seconds(), 1.47);
  EXPECT_GE(b.seconds(), 1.457);
}

TEST(Course, of_a_zigzag_swings_at_the_limit_of_jerk) {
  const RandomProgram p = zigzag(200);
  const Course c = plan(p);
  EXPECT_EQ(verdict(c, p), "");
  // Swing less twice the tolerance is sqrt(2) J h^3 / 12: 35 ms a block.
  EXPECT_GE(c.seconds(), 200 * 0.035);
  EXPECT_LE(c.seconds(), 200 * 0.0365);
}

TEST(Course, of_a_bored_circle_stays_within_one_and_a_half_micrometres) {
  RandomProgram p = program({line_to(20, 0, 0, 50), arc_to(20, 0, 0, 0, 360, 50), line_to(0, 0, 0, 50)});
  for (Element& e : p.elements) e.transition.tolerance = 0.1;
  p.tolerance = 0.1;
  const Course c = plan(p);
  EXPECT_EQ(verdict(c, p), "");
  double most = 0.0;
  for (const Vector& x : sampled(c, p.start, 3, 0.001))
    if (x[0] < 14.0 && std::hypot(x[0], x[1]) > 15.0)
      most = std::max(most, std::abs(std::hypot(x[0], x[1]) - 20.0));
  EXPECT_LE(most, 0.0015);
}

/// A helix between two lines; whole turns about (0, 0), radius 20, `rise` a turn.
RandomProgram helix(double tolerance, double rise) {
  Element turns = arc_to(20, 0, 0, 0, 720, 80);
  turns.to[2] = 2 * rise;
  Element out = line_to(100, 0, 2 * rise, 80);
  RandomProgram p = program({line_to(20, 0, 0, 80), turns, out});
  for (Element& e : p.elements) e.transition.tolerance = tolerance;
  p.tolerance = tolerance;
  return p;
}

TEST(Course, of_arcs_helices_and_lines_is_exact_away_from_their_ends_whatever_the_tolerance) {
  for (const double tolerance : {0.01, 0.1, 0.5})
    for (const double rise : {0.0, 5.0}) {
      const RandomProgram p = helix(tolerance, rise);
      const Course c = plan(p);
      EXPECT_EQ(verdict(c, p), "");
      const double away = 1 + 41 * tolerance;  // from an end, where the tolerance is not used any more
      double angle = 0.0, most = 0.0, on_line = 0.0;
      int looked = 0;
      Vector before{};
      for (const Vector& x : sampled(c, p.start, 3, 0.001)) {
        const double radius = std::hypot(x[0], x[1]);
        if (radius > 15.0) {
          const double turn =
              std::atan2(x[1] * before[0] - x[0] * before[1], x[0] * before[0] + x[1] * before[1]);
          angle = std::hypot(before[0], before[1]) > 15.0 ? angle + turn : std::atan2(x[1], x[0]);
        }
        before = x;
        if (radius > 15.0 && 20 * angle > away && 20 * (4 * kPi - angle) > away) {
          ++looked;
          most = std::max(most, std::hypot(radius - 20.0, x[2] - rise * angle / (2 * kPi)));
        }
        if (x[0] > 20.0 + away && x[0] < 100.0 - away) on_line = std::max(on_line, std::abs(x[1]));
      }
      EXPECT_GT(looked, 1000);
      EXPECT_LE(most, 0.0015) << tolerance << ' ' << rise;
      EXPECT_LE(on_line, 0.0015) << tolerance << ' ' << rise;
    }
}

TEST(Course, does_not_depend_on_when_elements_come) {
  RandomProgram p = zigzag(150);
  const RandomProgram line = collinear(300, 0.3);
  for (Element e : line.elements) {
    for (int i = 0; i < 3; ++i) e.to[i] += zigzag(150).elements.back().to[i];
    p.elements.push_back(e);
  }
  const Course all = plan(p);
  EXPECT_EQ(verdict(all, p), "");
  for (const int portion : {1, 7, 100}) {
    const Course some = plan(p, portion);
    ASSERT_EQ(some.runs.size(), all.runs.size());
    ASSERT_EQ(some.runs[0].knots.size(), all.runs[0].knots.size());
    for (std::size_t k = 0; k < all.runs[0].knots.size(); ++k) {
      ASSERT_EQ(some.runs[0].knots[k].t.ns, all.runs[0].knots[k].t.ns) << k;
      ASSERT_EQ(some.runs[0].knots[k].control, all.runs[0].knots[k].control) << k;
      ASSERT_EQ(some.runs[0].knots[k].w, all.runs[0].knots[k].w) << k;
    }
  }
}

/// Takes knots of one run.
class Taker final : public KnotSink {
 public:
  void begin(const Vector& before_last, const Vector& last) override { stage.before = {before_last, last}; }
  void put(const Knot& knot) override { stage.knots.push_back(knot); }
  void rest() override { ++rests; }
  void cruise(const Cruise&) override {}
  Stage stage;
  int rests = 0;
};

TEST(Course, is_planned_by_no_more_than_a_window_a_call_even_where_all_of_it_is_known_at_once) {
  const RandomProgram p = around(3000);
  const Course all = plan(p, 5);
  Taker taker;
  Pipeline::Settings settings;
  Pipeline pipeline(settings, taker);
  Vector at{};
  for (const Element& e : p.elements) {
    Leg leg;
    leg.piece = shape(p.config, at, e).piece;
    leg.feed = e.feed;
    leg.limits = &p.config.limits;
    leg.tolerance = 0.01;
    pipeline.add(leg);
    at = e.to;
  }
  pipeline.end();
  std::size_t most = 0, calls = 0, before = 0;
  std::int64_t windows = 0;
  for (; pipeline.work(); ++calls) {
    most = std::max(most, taker.stage.knots.size() - std::exchange(before, taker.stage.knots.size()));
    ASSERT_LE(pipeline.counts().windows - std::exchange(windows, pipeline.counts().windows), 1);
  }
  EXPECT_EQ(taker.rests, 1);
  EXPECT_GT(taker.stage.knots.size(), 3000u);
  EXPECT_LE(most, 800u);                                 // of the longest window of the law, less its overlap
  EXPECT_GE(calls, 4 * taker.stage.knots.size() / 300);  // two curves and two laws
  ASSERT_EQ(all.runs.size(), 1u);
  EXPECT_NEAR(taker.stage.seconds(), all.seconds(), 0.01);  // Gather leaves some of the tolerance
}

TEST(Course, of_a_long_program_keeps_no_more_than_its_windows) {
  const std::size_t some = plan(around(3000), 5).most_kept, many = plan(around(6000), 5).most_kept;
  EXPECT_LE(many, some + some / 5);
}

std::uint64_t cases() {
  const char* given = std::getenv("SERVOGATE_PROPERTY_CASES");
  return given == nullptr ? 20 : std::max(1, std::atoi(given) / 100);
}

TEST(Course, of_random_programs_keeps_every_limit_the_tolerance_and_the_end_point) {
  const std::uint64_t base = servogate::test::property_seed();
  Reached most;
  double seconds = 0.0;
  std::int64_t released = 0, repaired = 0;
  int wrong = 0;
  for (std::uint64_t seed = base; seed < base + cases() && wrong < 10; ++seed) {
    const RandomProgram p = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    const Course c = plan(p);
    const std::string text = verdict(c, p, &most);
    if (!text.empty()) {
      ADD_FAILURE() << "seed " << seed << ": " << text << "(" << p.elements.size() << " elements)";
      ++wrong;
    }
    seconds += c.seconds();
    released += c.counts.released;
    repaired += c.counts.repaired;
  }
  std::printf(
      "%.0f s of motion, largest share of a limit: v %.5f a %.5f j %.5f; %lld places released, %lld windows "
      "repaired\n",
      seconds, most.velocity, most.acceleration, most.jerk, static_cast<long long>(released),
      static_cast<long long>(repaired));
}

TEST(Course, of_programs_that_once_went_wrong_is_right) {
  // Windows that began outside, a course beyond a limit between the places looked at, tubes that hold an axis
  // back along the path, and axes that changed places when a window was solved twice.
  for (const std::uint64_t seed : {141u, 1186u, 1317u, 1616u, 3594u, 5440u, 8294u, 50291u}) {
    const RandomProgram p = random_program(seed, {2 + static_cast<int>(seed % 11), true, true});
    EXPECT_EQ(verdict(plan(p), p), "") << seed;
  }
  // A small arc between two sites, of which only the legs beside it were looked at.
  for (const std::uint64_t seed : {std::uint64_t{11000000864}}) {
    RandomProgram p = random_program(seed, {120, false, false});
    for (Element& e : p.elements) e.feed = std::max(e.feed, 60.0);
    EXPECT_EQ(verdict(plan(p), p), "") << seed;
  }
}

TEST(Course, does_not_rest_in_a_sharp_turn_that_is_no_way_back) {
  RandomProgram p = program({line_to(10, 0, 0, 50), line_to(0, 0.4, 0, 50), line_to(10, 0.4, 0, 50)});
  const Course c = plan(p);  // 177.7 and 177.7 degrees
  EXPECT_EQ(verdict(c, p), "");
  EXPECT_EQ(c.runs.size(), 1u);
}

TEST(Course, rests_where_the_program_does) {
  RandomProgram p = program({line_to(10, 0, 0, 50), line_to(10, 10, 0, 50), line_to(0, 10, 0, 50)});
  p.elements[1].transition.continuation = Continuation::exact_stop;
  p.elements.push_back(line_to(0, 0, 0, 50));
  p.elements.back().kind = Element::Kind::rapid;
  const Course c = plan(p);
  EXPECT_EQ(verdict(c, p), "");
  EXPECT_EQ(c.counts.runs, 3);
}

TEST(Course, of_long_lines_cruises_in_their_middle_at_no_cost) {
  RandomProgram p = program({line_to(80, 0, 0, 50), line_to(80, 90, 0, 50), line_to(-500, 91, 3, 50)});
  const Course c = plan(p);
  EXPECT_EQ(verdict(c, p), "");
  ASSERT_EQ(c.runs.size(), 4u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(c.runs[k].cruise.has_value());
  double cruised = 0.0;
  for (const Stage& stage : c.runs) cruised += stage.cruise ? stage.cruise->seconds : 0.0;
  EXPECT_GE(cruised, 0.85 * c.seconds());
  // Length by feed, the time to speed up and to stop, and what the two corners cost.
  EXPECT_LE(c.seconds(), (80 + 90 + 580.01) / 50 + 0.15 + 2 * 0.2);
  for (const int portion : {1, 2}) {
    const Course some = plan(p, portion);
    ASSERT_EQ(some.runs.size(), c.runs.size());
    for (std::size_t k = 0; k < c.runs.size(); ++k) EXPECT_EQ(some.runs[k].seconds(), c.runs[k].seconds());
  }
}

TEST(Course, keeps_limits_and_tolerances_that_change_along_the_path) {
  // A circle in chords: three axes alike, then an axis that is slower, then a smaller tolerance.
  Config config = mill();
  std::array<AxisLimits, kMaxAxes> slow = config.limits;
  slow[1] = {40, 200, 2000};
  Taker taker;
  Pipeline::Settings settings;
  settings.axes = 3;
  Pipeline pipeline(settings, taker);
  constexpr int kBlocks = 600;
  Vector at{};
  Polyline path{at};
  for (int i = 1; i <= kBlocks; ++i) {
    const Element e = line_to(30 - 30 * std::cos(i / 100.0), 30 * std::sin(i / 100.0), 0, 100);
    Leg leg;
    leg.piece = shape(config, at, e).piece;
    leg.feed = e.feed;
    leg.limits = i > 200 && i <= 400 ? &slow : &config.limits;
    leg.tolerance = i > 500 ? 0.002 : 0.01;
    pipeline.add(leg);
    while (i % 10 == 0 && pipeline.work()) {
    }
    path.push_back(at = e.to);
  }
  pipeline.end();
  while (pipeline.work()) {
  }
  EXPECT_EQ(pipeline.counts().failed, 0);
  EXPECT_EQ(pipeline.counts().outside, 0);
  Course course;
  course.runs.push_back(taker.stage);
  const Polyline points = sampled(course, {}, 3, 0.001);
  Polyline fine;
  double slowest = HUGE_VAL;
  for (std::size_t k = 4; k + 8 < points.size(); ++k) {
    // The place on the circle says which limits hold; a chord is 0.01 rad.
    const double angle = std::atan2(points[k][1], 30 - points[k][0]),
                 turn = angle < 0 ? angle + 2 * kPi : angle;
    const bool middle = turn > 2.02 && turn < 3.98;
    const AxisLimits limits = middle ? slow[1] : config.limits[1];
    const double y0 = points[k - 3][1], y1 = points[k - 2][1], y2 = points[k - 1][1], y3 = points[k][1];
    EXPECT_LE(std::abs(y3 - y2) * 1e3, 1.001 * limits.velocity) << k;
    EXPECT_LE(std::abs(y3 - 2 * y2 + y1) * 1e6, 1.001 * limits.acceleration) << k;
    EXPECT_LE(std::abs(y3 - 3 * y2 + 3 * y1 - y0) * 1e9, 1.001 * limits.jerk) << k;
    if (middle) slowest = std::min(slowest, std::hypot(points[k][0] - points[k - 1][0], y3 - y2) * 1e3);
    if (turn > 5.03 && turn < 5.98) fine.push_back(points[k]);
  }
  EXPECT_LT(slowest, 45.0);
  // Chords of a circle: the smaller tolerance is seen as a distance from the circle, with their own sagitta.
  for (const Vector& x : fine) EXPECT_NEAR(std::hypot(x[0] - 30, x[1]), 30.0 - 0.00019, 0.0021 + 0.00019);
  EXPECT_TRUE(frechet_within(points, path, 0.01, 3));
}

}  // namespace
}  // namespace servogate::path::test
