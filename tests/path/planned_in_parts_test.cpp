// SPDX-License-Identifier: Apache-2.0
// A rest is planned window by window: what follows waits for it, and nothing of what is published depends on
// how much was planned in a call.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/path/planner.hpp"
#include "tests/path/rig/random_program.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

/// Short lines round and round, `n` of them from `start`, 0.4 mm each.
void go_round(std::vector<Element>& to, const Vector& start, int n) {
  for (int i = 1; i <= n; ++i)
    to.push_back(
        line_to(start[0] + 12 - 12 * std::cos(i / 30.0), start[1] + 12 * std::sin(i / 30.0), 0, 100));
}

/// Courses, some of them with long lines in them, between rapids and single lines.
std::vector<Element> mixed(std::mt19937_64& random) {
  std::vector<Element> e;
  Vector at{};
  for (int part = 0; part < 6; ++part) {
    go_round(e, at, 20 + static_cast<int>(random() % 200));
    at = e.back().to;
    if (random() % 2 == 0) e.push_back(line_to(at[0] + 90, at[1] + 0.5, 0, 80));
    if (random() % 3 == 0) e.back().transition.continuation = Continuation::exact_stop;
    at = e.back().to;
    Element rapid = line_to(at[0] + 5, at[1] - 3, 0, 100);
    rapid.kind = Element::Kind::rapid;
    if (random() % 2 == 0) e.push_back(rapid);
    at = e.back().to;
  }
  return e;
}

struct Machine {
  Machine() { planner.restart({}); }
  Config config = [] {
    Config c = mill();
    c.piece_capacity = 8192;
    return c;
  }();
  Track track{config};
  Planner planner{config, track};
};

/// The program with an event and a mark now and then; `work` is called behind each element.
template <class Work>
void plan(Machine& m, const std::vector<Element>& elements, const Work& work) {
  for (std::size_t n = 0; n < elements.size(); ++n) {
    ASSERT_TRUE(m.planner.add(elements[n]));
    if (n % 70 == 69) m.planner.add_event(static_cast<std::uint32_t>(n), {});
    if (n % 50 == 49) m.planner.add_mark();
    ASSERT_EQ(m.planner.position(), elements[n].to);
    work();
  }
  m.planner.finish();
  while (m.planner.work_a_little()) {
  }
  EXPECT_FALSE(m.planner.ends());
  EXPECT_FALSE(m.planner.waits()) << "the track has no room";
}

void expect_same(const Track& a, const Track& b) {
  ASSERT_EQ(a.entries.written(), b.entries.written());
  ASSERT_EQ(a.pieces.written(), b.pieces.written());
  ASSERT_EQ(a.knots.written(), b.knots.written());
  ASSERT_EQ(a.stops.written(), b.stops.written());
  for (std::uint64_t n = 0; n < a.knots.written(); ++n) {
    ASSERT_EQ(a.knots[n].t.ns, b.knots[n].t.ns) << n;
    ASSERT_EQ(a.knots[n].w, b.knots[n].w) << n;
    ASSERT_EQ(a.knots[n].place, b.knots[n].place) << n;
    ASSERT_EQ(a.knots[n].control, b.knots[n].control) << n;
  }
  for (std::uint64_t n = 0; n < a.stops.written(); ++n) {
    ASSERT_EQ(a.stops[n].knot, b.stops[n].knot) << n;
    ASSERT_EQ(a.stops[n].seconds, b.stops[n].seconds) << n;
  }
  for (std::uint64_t n = 0; n < a.pieces.written(); ++n) ASSERT_EQ(a.pieces[n].c0, b.pieces[n].c0) << n;
  for (std::uint64_t n = 0; n < a.entries.written(); ++n) {
    const Entry &x = a.entries[n], &y = b.entries[n];
    ASSERT_EQ(x.kind, y.kind) << n;
    ASSERT_EQ(x.event, y.event) << n;
    ASSERT_EQ(x.at, y.at) << n;
    ASSERT_EQ(x.tag.marks, y.tag.marks) << n;
    ASSERT_EQ(x.planned, y.planned) << n;
    ASSERT_EQ(x.extent.knots, y.extent.knots) << n;
    ASSERT_EQ(x.extent.seconds, y.extent.seconds) << n;
    ASSERT_EQ(x.span.first_piece, y.span.first_piece) << n;
    ASSERT_EQ(x.span.time, y.span.time) << n;
  }
}

TEST(PlannedInParts, is_published_as_if_it_were_planned_at_once) {
  const std::uint64_t seed = servogate::test::property_seed();
  for (std::uint64_t n = 0; n < 2; ++n) {
    std::mt19937_64 random(seed + n);
    const std::vector<Element> elements = mixed(random);
    Machine at_once, now_and_then, behind_all;
    plan(at_once, elements, [&] { at_once.planner.work(); });
    int waited = 0;
    plan(now_and_then, elements, [&] {
      for (auto calls = random() % 3; calls > 0; --calls) now_and_then.planner.work_a_little();
      waited += now_and_then.planner.ends() ? 1 : 0;
    });
    plan(behind_all, elements, [] {});
    EXPECT_GT(waited, 0) << "nothing was planned in parts";
    SCOPED_TRACE(seed + n);
    expect_same(at_once.track, now_and_then.track);
    expect_same(at_once.track, behind_all.track);
  }
}

TEST(PlannedInParts, of_a_rest_is_a_second_of_motion_a_call_at_most) {
  Machine m;
  std::vector<Element> elements;
  go_round(elements, {}, 3000);
  for (const Element& e : elements) ASSERT_TRUE(m.planner.add(e));
  m.planner.finish();
  EXPECT_TRUE(m.planner.ends());
  EXPECT_FALSE(m.planner.wants_more()) << "what is added now only waits";
  EXPECT_TRUE(m.planner.waits());
  double most = 0.0;
  for (double before = 0.0; m.planner.ends(); before = m.planner.planned()) {
    ASSERT_TRUE(m.planner.work_a_little());
    most = std::max(most, m.planner.planned() - before);
  }
  EXPECT_GT(m.planner.planned(), 10.0);
  EXPECT_LE(most, 3.0);
}

TEST(PlannedInParts, of_a_rest_is_forgotten_with_what_waits_behind_it_when_the_path_begins_anew) {
  Machine m;
  std::vector<Element> elements;
  go_round(elements, {}, 300);
  for (const Element& e : elements) ASSERT_TRUE(m.planner.add(e));
  m.planner.add_event(1, {});
  ASSERT_TRUE(m.planner.add(line_to(500, 0, 0, 100)));
  EXPECT_TRUE(m.planner.ends());
  m.planner.restart({1, 2, 3});
  EXPECT_FALSE(m.planner.ends());
  m.planner.finish();
  m.planner.work();
  for (std::uint64_t n = 0; n < m.track.entries.written(); ++n)
    EXPECT_NE(m.track.entries[n].kind, Entry::Kind::event);
  EXPECT_EQ(m.planner.position(), (Vector{1, 2, 3}));
}

}  // namespace
}  // namespace servogate::path::test
