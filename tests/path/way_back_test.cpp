// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {
namespace {

/// Corners, short lines of a curve and arcs, each block with a line number of its own.
std::vector<Element> long_program(int blocks) {
  std::vector<Element> out;
  double x = 0, y = 0, heading = 0;
  for (int k = 0; k < blocks; ++k) {
    heading += k % 100 < 50 ? (k % 2 ? 1.0 : -1.0) : 0.01;
    out.push_back(line_to(x += 0.2 * std::cos(heading), y += 0.2 * std::sin(heading), 0, 200));
    out.back().tag.line = k + 1;
  }
  return out;
}

struct Machine {
  explicit Machine(const Config& c) : track(c), planner(c, track), follower(c, track) { planner.restart({}); }
  Sample step(const std::vector<Element>& program) {
    for (; next < program.size() && planner.wants_more(); planner.work()) planner.add(program[next++]);
    planner.work();
    return follower.step(track.visible());
  }
  Track track;
  Planner planner;
  Follower follower;
  std::size_t next = 0;
};

bool same(const Piece& a, const Piece& b) {
  return a.tag == b.tag && a.length == b.length &&
         position(a, 0.4 * a.length, 3) == position(b, 0.4 * b.length, 3);
}

TEST(WayBack, is_whole_over_the_last_thousand_blocks_and_never_overwritten) {
  const std::vector<Element> program = long_program(6000);
  Config config = mill();
  Config vast = config;
  vast.piece_capacity = 40000;
  Track all(vast);  // of which nothing is ever given back
  Planner reference(vast, all);
  reference.restart({});
  for (const Element& e : program) reference.add(e);
  reference.work();

  config.piece_capacity = 1024;
  Machine m(config);
  std::size_t looked = 0;
  for (int cycle = 0; cycle < 200000 && m.next < program.size(); ++cycle) {
    const Sample s = m.step(program);
    const Behind behind = m.follower.behind();
    if (cycle % 500 != 0) continue;
    std::set<int> blocks;
    for (std::uint64_t n = behind.begin; n < behind.end; ++n) {
      ASSERT_TRUE(same(m.track.pieces[n], all.pieces[n])) << "piece " << n << " cycle " << cycle;
      blocks.insert(m.track.pieces[n].tag.line);
      ++looked;
    }
    ASSERT_GE(static_cast<int>(blocks.size()), std::min(1000, s.tag.line - 1));
  }
  EXPECT_GT(looked, 100000u);
}

TEST(WayBack, ends_where_the_path_was_begun) {
  const std::vector<Element> program = long_program(6000);
  Machine m(mill());
  EXPECT_EQ(m.follower.behind().begin, m.follower.behind().end);
  Sample s;
  for (int cycle = 0; cycle < 20000 && s.tag.line < 50; ++cycle) s = m.step(program);
  EXPECT_GE(m.follower.behind().end, 49u);
  m.follower.stop();
  for (int cycle = 0; cycle < 20000 && s.state != FollowerState::stopped; ++cycle) s = m.step(program);
  EXPECT_EQ(m.follower.behind().begin, m.follower.behind().end) << "of a path that was given up";
  const Vector there = s.position;
  m.planner.restart(there);
  Behind behind;
  for (int cycle = 0; cycle < 20000 && behind.end < behind.begin + 20; ++cycle) {
    m.step(program);
    behind = m.follower.behind();
  }
  EXPECT_GE(behind.end, behind.begin + 20);
  EXPECT_EQ(position(m.track.pieces[behind.begin], 0.0, 3), there);
}

}  // namespace
}  // namespace servogate::path::test
