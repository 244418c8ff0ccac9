// SPDX-License-Identifier: Apache-2.0
// Courses that end before their end, because no law inside of the limits was found for what comes next.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "kernel/path/law/course_planning.hpp"
#include "kernel/path/track/publisher.hpp"
#include "tests/path/rig/driven_path.hpp"

namespace servogate::path::test {
namespace {

/// A line in blocks at a feed that is kept, and a circle where the judge lets no window be driven: it is
/// planned at twice the limits of the axes.
RandomProgram without_a_law() {
  RandomProgram p;
  p.config = mill();
  p.config.reserve = -1.0;
  p.tolerance = 0.01;
  for (int k = 1; k <= 600; ++k) p.elements.push_back(line_to(0.3 * k, 0, 0, 60));
  for (int k = 1; k <= 400; ++k)
    p.elements.push_back(line_to(180 + 6 * std::sin(k * 0.05), 6 - 6 * std::cos(k * 0.05), 0, 300));
  const double a = 22.0;
  p.elements.push_back(
      arc_to(180 + 6 * std::sin(a), 6 - 6 * std::cos(a), 180, 6, (a - 20.0) / std::numbers::pi * 180.0, 300));
  p.elements.push_back(line_to(150, 0, 0, 300));
  for (std::size_t n = 0; n < p.elements.size(); ++n)
    p.elements[n].tag.line = static_cast<std::int32_t>(n) + 1;
  return p;
}

TEST(BrokenCourse, without_a_law_for_what_comes_next_rests_says_where_and_goes_on) {
  RandomProgram p = without_a_law();
  for (int k = 0; k < 3; ++k) p.elements[600 + static_cast<std::size_t>(k)].feed = 250;
  p.elements.insert(p.elements.begin() + 800, p.elements[799]);  // moves nothing
  std::vector<std::vector<Vector>> ways;
  for (const std::size_t portion : {std::size_t{1}, std::size_t{7}, p.elements.size()}) {
    DrivenPath m(p.config);
    std::optional<Tag> rest;
    const auto ask = [&] {
      if (const auto tag = m.planner.take_unasked_rest()) rest = tag;
    };
    for (std::size_t n = 0; n < p.elements.size(); ++n) {
      ASSERT_TRUE(m.planner.add(p.elements[n]));
      if (n % portion == 0) m.planner.work();
      ask();
    }
    m.planner.finish();
    m.planner.work();
    ask();
    ASSERT_TRUE(rest.has_value()) << "which block it rests in";
    EXPECT_GT(rest->line, 300);
    m.trip.ended = m.until(FollowerState::idle);
    EXPECT_EQ(verdict(m.trip, p), "");
    EXPECT_EQ(m.last.starved, 0u) << "it is not late planning";
    std::vector<Vector>& way = ways.emplace_back();
    for (const Sample& s : m.trip.samples) way.push_back(s.position);
  }
  EXPECT_EQ(ways[0], ways[1]) << "when the elements came does not matter";
  EXPECT_EQ(ways[0], ways[2]);
}

TEST(BrokenCourse, without_a_law_comes_to_its_rest_however_it_is_held_before) {
  const RandomProgram p = without_a_law();
  int held = 0;
  for (int at = 100; at < 4400; at += 311) {
    DrivenPath m(p.config);
    for (const Element& e : p.elements) ASSERT_TRUE(m.planner.add(e));
    m.planner.finish();
    m.follower.set_override(at % 2 == 0 ? 1.0 : 0.7);
    int k = 0;
    m.trip.ended = m.until([&](const Sample& s) {
      ++k;
      if (k == at || k == at + 900) m.follower.hold();
      if (k == at + 700 || k == at + 2000) m.follower.resume();
      held += s.state == FollowerState::held ? 1 : 0;
      return k > 10 && s.state == FollowerState::idle;
    });
    EXPECT_EQ(verdict(m.trip, p), "") << at;
  }
  EXPECT_GT(held, 1000);
}

TEST(BrokenCourse, without_a_law_from_its_start_is_driven_from_rest_to_rest_and_then_as_a_course) {
  RandomProgram p = without_a_law();
  p.elements.erase(p.elements.begin(), p.elements.begin() + 600);
  p.start = {180, 0, 0};
  Track track(p.config);
  Planner planner(p.config, track);
  Follower follower(p.config, track);
  follower.set_position(p.start);
  planner.restart(p.start);
  Trip trip;
  trip.samples.emplace_back();
  trip.samples.back().position = p.start;
  for (const Element& e : p.elements) ASSERT_TRUE(planner.add(e));
  planner.finish();
  for (int k = 0; k < 20000 && !trip.ended; ++k) {
    planner.work();
    trip.samples.push_back(follower.step(track.visible()));
    trip.ended = k > 10 && trip.samples.back().state == FollowerState::idle;
  }
  EXPECT_EQ(verdict(trip, p), "");
}

/// What of the trip is slower than the feed or at rest from the place `x` on, s.
double slow_behind(const Trip& trip, double x, double feed) {
  double seconds = 0.0;
  for (const Sample& s : trip.samples)
    if (s.position[0] > x && s.feed < 0.9 * feed) seconds += 0.001;
  return seconds;
}

TEST(BrokenCourse, is_a_course_again_behind_the_elements_that_find_no_law) {
  RandomProgram p = without_a_law();
  p.config.reserve = -1.3;  // it is found here and there
  p.elements.resize(680);   // a fifth of the circle, in blocks
  const Vector from = p.elements.back().to;
  for (int k = 1; k <= 900; ++k)
    p.elements.push_back(line_to(from[0] + 0.3 * k, from[1] + 0.1 * std::sin(k * 0.01), 0, 60));
  DrivenPath m(p.config);
  for (const Element& e : p.elements) {
    ASSERT_TRUE(m.planner.add(e));
    m.planner.work();
  }
  m.planner.finish();
  ASSERT_TRUE(m.planner.take_unasked_rest().has_value());
  m.trip.ended = m.until(FollowerState::idle);
  EXPECT_EQ(verdict(m.trip, p), "");
  int rests = 0;
  for (const Sample& sample : m.trip.samples)
    rests += sample.feed == 0.0 && sample.position[0] > 1 && sample.position[0] < 190 ? 1 : 0;
  EXPECT_GE(rests, 1);
  EXPECT_LT(slow_behind(m.trip, from[0] + 60, 60), 0.5) << "all but the way down to the end";
}

TEST(BrokenCourse, that_finds_no_law_from_its_start_on_rests_behind_each_element_and_is_exactly_on_its_path) {
  constexpr int kBlocks = 256;  // 1 + 2 + 4 + ... and one more
  RandomProgram p = without_a_law();
  p.config.reserve = -4.0;
  p.elements.clear();
  const auto y = [](int k) { return 0.5 * std::sin(0.05 * k); };
  for (int k = 1; k <= kBlocks; ++k) p.elements.push_back(line_to(0.3 * k, y(k), 0, 60));
  DrivenPath m(p.config);
  for (const Element& e : p.elements) ASSERT_TRUE(m.planner.add(e));
  m.planner.finish();
  m.planner.work();
  ASSERT_TRUE(m.planner.take_unasked_rest().has_value());
  ASSERT_TRUE(m.until(FollowerState::idle));
  int exact = 0, rests = 0;
  for (const Sample& s : m.trip.samples) {
    const int k = std::min(static_cast<int>(s.position[0] / 0.3), kBlocks - 1);
    const double z = s.position[0] / 0.3 - k;
    exact += std::abs(s.position[1] - (y(k) + z * (y(k + 1) - y(k)))) < 1e-9 ? 1 : 0;
    rests += s.feed == 0.0 ? 1 : 0;
  }
  EXPECT_GT(rests, kBlocks / 2);
  EXPECT_GT(exact, 9 * static_cast<int>(m.trip.samples.size()) / 10);
}

/// Hands a course on up to its 60th stop, and says that there is no law behind it. Some knots are known
/// that lie further on than that stop leads to, so that a hold may.
class Breaking final : public CourseSink {
 public:
  explicit Breaking(Publisher& to) : to_(to) {}
  void begin_course() override { to_.begin_course(); }
  void put(const Piece& piece) override {
    if (!broken_) to_.put(piece);
  }
  void put(const Knot& knot) override {
    if (broken_) return;
    to_.put(knot);
    knots_.push_back(knot);
  }
  void put(const StopHint& stop) override {
    if (broken_) return;
    to_.put(stop);
    stop_ = stop;
  }
  void extend(const CourseExtent& extent) override {
    if (broken_) return;
    CourseExtent known = extent;
    broken_ = known.broken = extent.stops >= 60;
    known.complete = false;
    const RateChange way{1.0, 0.0, 0.0, stop_.seconds, stop_.power};
    known.rest = knots_[static_cast<std::size_t>(stop_.knot) + 2].t.plus(way.at(stop_.seconds).passed);
    to_.extend(known);
  }

 private:
  Publisher& to_;
  bool broken_ = false;
  std::vector<Knot> knots_;
  StopHint stop_;
};

TEST(BrokenCourse, that_is_broken_rests_in_one_place_however_it_is_held_and_what_is_behind_follows) {
  std::vector<Vector> rests;
  for (int held = 0; held < 3000; held += held < 1200 ? 400 : 61) {
    const Config config = mill();
    Track track(config);
    Publisher publisher(track);
    Breaking breaking(publisher);
    CoursePlanning course(config, breaking);
    Gather gather(config, course);
    Follower follower(config, track);
    Entry marker;
    marker.kind = Entry::Kind::restart;
    publisher.put(marker);
    gather.restart({});
    for (int k = 1; k <= 1200; ++k) gather.add(line_to(k * 0.3, 3 * std::sin(k * 0.05), 0, 100));
    gather.finish();
    while (course.work()) {
    }
    marker.kind = Entry::Kind::event;
    marker.event = 7;
    publisher.put(marker);
    Trip trip;
    trip.samples.emplace_back();
    Sample last;
    for (int k = 0; k < 12000 && last.state != FollowerState::at_event; ++k) {
      if (k == held) follower.hold();
      if (k == held + 1500) follower.resume();
      publisher.work();
      trip.samples.push_back(last = follower.step(track.visible()));
    }
    EXPECT_EQ(last.state, FollowerState::at_event) << held;
    EXPECT_EQ(last.event, 7u);
    EXPECT_TRUE(follower.at_rest());
    EXPECT_EQ(last.starved, 0u) << "it is not late planning";
    EXPECT_GT(last.position[0], 100.0);
    EXPECT_LT(last.position[0], 300.0);
    EXPECT_NEAR(last.position[1], 3 * std::sin(last.position[0] / 6), 0.02);
    EXPECT_LE(worst(trip, config).most(), 1.001);
    rests.push_back(last.position);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(last.position[i], rests[0][i], 1e-9) << held;
    follower.release_event();
    publisher.work();
    EXPECT_EQ(follower.step(track.visible()).state, FollowerState::idle);
  }
}

}  // namespace
}  // namespace servogate::path::test
