// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {
namespace {

/// All samples of a program whose elements are followed by marks where `marked` says how many.
std::vector<Sample> drive(const RandomProgram& p, int (*marked)(std::size_t)) {
  Track track(p.config);
  Planner planner(p.config, track);
  Follower follower(p.config, track);
  follower.set_position(p.start);
  planner.restart(p.start);
  for (std::size_t k = 0; k < p.elements.size(); ++k) {
    planner.add(p.elements[k]);
    for (int n = marked(k); n > 0; --n) planner.add_mark();
  }
  planner.finish();
  std::vector<Sample> out;
  for (int k = 0; k < 400000; ++k) {
    planner.work();
    follower.release_stop();
    out.push_back(follower.step(track.visible()));
    if (out.back().state == FollowerState::idle) break;
  }
  return out;
}

int none(std::size_t /*k*/) { return 0; }
int some(std::size_t k) { return k % 3 == 0 ? 1 : k % 7 == 0 ? 2 : 0; }
int each(std::size_t /*k*/) { return 1; }

TEST(Mark, is_counted_once_each_and_leaves_the_path_as_it_is) {
  for (std::uint64_t seed = 1; seed <= 36; ++seed) {
    RandomProgram p = random_program(seed, {8, true, true});
    if (seed % 2) p.elements.push_back(p.elements.back());  // of no length
    const std::vector<Sample> with = drive(p, some), without = drive(p, none);
    ASSERT_EQ(with.size(), without.size());
    std::uint32_t added = 0, passed = 0;
    for (std::size_t k = 0; k < p.elements.size(); ++k) added += static_cast<std::uint32_t>(some(k));
    for (std::size_t k = 0; k < with.size(); ++k) {
      passed += with[k].passed;
      ASSERT_EQ(with[k].position, without[k].position) << seed;
      ASSERT_EQ(without[k].passed, 0u);
    }
    ASSERT_EQ(passed, added) << seed;
  }
}

TEST(Mark, is_passed_at_its_corner_to_a_fraction_of_a_cycle) {
  RandomProgram p;
  p.config = mill();
  double x = 0, y = 0, heading = 0;
  for (int k = 0; k < 800; ++k) {
    heading += k > 200 ? 1e-4 : k % 40 == 0 ? 1.2 : 0.01;
    const double length = k <= 200 ? 0.8 : 0.04;  // several in a cycle, too
    p.elements.push_back(line_to(x += length * std::cos(heading), y += length * std::sin(heading), 0, 150));
  }
  const std::vector<Sample> samples = drive(p, each);
  std::size_t element = 0, together = 0;
  Vector before{};
  for (const Sample& s : samples) {
    element += s.passed;
    if (s.passed > 0 && s.feed > 0.0) {
      const Vector& corner = p.elements[element - 1].to;
      double off = 0.0;
      for (int i = 0; i < 2; ++i) {
        const double there = before[i] + s.passed_at * (s.position[i] - before[i]);
        off += (there - corner[i]) * (there - corner[i]);
      }
      // The tolerance, and what a cycle's speeding up makes of a straight line in time.
      ASSERT_LT(std::sqrt(off), 0.0105) << element;
      together += s.passed > 1 ? 1 : 0;
    }
    before = s.position;
  }
  EXPECT_EQ(element, p.elements.size());
  EXPECT_GT(together, 10u);
}

TEST(Mark, of_a_path_that_is_given_up_is_not_passed) {
  const Config config = mill();
  Track track(config);
  Planner planner(config, track);
  Follower follower(config, track);
  planner.restart({});
  for (int k = 1; k <= 20; ++k) {
    planner.add(line_to(10.0 * k, 0, 0, 100));
    planner.add_mark();
  }
  planner.finish();
  std::uint32_t passed = 0;
  Sample s;
  const auto step = [&] {
    planner.work();
    s = follower.step(track.visible());
    passed += s.passed;
  };
  while (s.position[0] < 35) step();
  EXPECT_EQ(passed, 3u);
  follower.stop();
  while (s.state != FollowerState::stopped) step();
  const std::uint32_t by_then = passed;
  EXPECT_LT(by_then, 6u);
  planner.restart(s.position);
  planner.add(line_to(0, 0, 0, 100));
  planner.add_mark();
  planner.finish();
  do step();
  while (s.state != FollowerState::idle);
  EXPECT_EQ(passed, by_then + 1);
}

}  // namespace
}  // namespace servogate::path::test
