// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/bound/bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/path/rig/frechet.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {
namespace {

/// All elements of a random program as whole pieces.
std::vector<Piece> pieces_of(const RandomProgram& p) {
  std::vector<Piece> out;
  Vector at = p.start;
  for (const Element& e : p.elements) {
    const Shaped s = shape(p.config, at, e);
    EXPECT_EQ(s.flaw, Flaw::none);
    if (s.piece.length > 0) out.push_back(s.piece);
    at = e.to;
  }
  return out;
}

double distance(const Vector& a, const Vector& b) {
  double sum = 0;
  for (int i = 0; i < kMaxAxes; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Largest relative difference of the stated derivatives and those found by differences.
void expect_consistent(const Piece& p, int axes) {
  const double h = p.length * 1e-5;
  for (int k = 1; k < 8; ++k) {
    const double s = p.length * k / 8.0 + p.length * 0.013;
    const PathPoint at = evaluate(p, s, axes), lo = evaluate(p, s - h, axes), hi = evaluate(p, s + h, axes);
    const Vector x = position(p, s, axes);
    for (int i = 0; i < axes; ++i) ASSERT_NEAR(at.x[i], x[i], 1e-12);
    for (int i = 0; i < axes; ++i) {
      ASSERT_NEAR((hi.x[i] - lo.x[i]) / (2 * h), at.d1[i], 1e-5 * (1 + std::abs(at.d1[i])));
      ASSERT_NEAR((hi.d1[i] - lo.d1[i]) / (2 * h), at.d2[i], 1e-5 * (1 / p.length + std::abs(at.d2[i])));
      ASSERT_NEAR((hi.d2[i] - lo.d2[i]) / (2 * h), at.d3[i],
                  1e-4 * (1 / (p.length * p.length) + std::abs(at.d3[i])));
    }
  }
}

TEST(Geometry, derivatives_of_lines_arcs_and_blends_agree_with_differences) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const RandomProgram p = random_program(seed, {8, true, false});
    const std::vector<Piece> pieces = pieces_of(p);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      expect_consistent(pieces[k], p.config.axis_count);
      if (k == 0) continue;
      if (const auto b = blend(pieces[k - 1], pieces[k], p.tolerance, p.config.axis_count))
        expect_consistent(b->piece, p.config.axis_count);
    }
  }
}

TEST(Geometry, an_arc_ends_exactly_in_its_end_point_and_keeps_its_radius) {
  const Config config = mill();
  const Element e = arc_to(10, 10, 10, 0, -90, 50);  // from (0, 0), clockwise quarter
  const Shaped s = shape(config, {}, e);
  ASSERT_EQ(s.flaw, Flaw::none);
  EXPECT_NEAR(s.piece.length, 10 * std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(position(s.piece, s.piece.length, 3), e.to);
  const Vector middle = position(s.piece, 0.5 * s.piece.length, 3);
  EXPECT_NEAR(middle[0], 10 - 10 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(middle[1], 10 * std::sqrt(0.5), 1e-12);
}

TEST(Geometry, a_helix_of_several_turns_climbs_evenly) {
  const Config config = mill();
  Element e = arc_to(0, 0, 5, 0, 720, 50);
  e.to[2] = 8;
  const Shaped s = shape(config, {}, e);
  ASSERT_EQ(s.flaw, Flaw::none);
  EXPECT_NEAR(s.piece.length, std::hypot(20 * std::numbers::pi, 8.0), 1e-9);
  const Vector quarter = position(s.piece, s.piece.length / 4, 3);  // half a turn
  EXPECT_NEAR(quarter[0], 10, 1e-9);
  EXPECT_NEAR(quarter[2], 2, 1e-9);
}

TEST(Geometry, a_rounding_error_of_the_radius_is_spread_along_the_arc) {
  const Config config = mill();
  Element e = arc_to(10.008, 10, 10.0, 0, -90, 50);
  e.to[0] = 10.0;
  e.to[1] = 10.008;
  const Shaped s = shape(config, {}, e);
  ASSERT_EQ(s.flaw, Flaw::none);
  EXPECT_EQ(position(s.piece, s.piece.length, 3), e.to);
  const Vector middle = position(s.piece, 0.5 * s.piece.length, 3);
  EXPECT_NEAR(std::hypot(middle[0] - 10, middle[1]), 10.004, 1e-9);
}

TEST(Geometry, elements_that_cannot_be_driven_are_named) {
  const Config config = mill();
  EXPECT_EQ(shape(config, {}, line_to(NAN, 0, 0, 50)).flaw, Flaw::not_finite);
  EXPECT_EQ(shape(config, {}, line_to(1e9, 0, 0, 50)).flaw, Flaw::not_finite);
  EXPECT_EQ(shape(config, {}, line_to(1, 0, 0, 0)).flaw, Flaw::no_feed);
  EXPECT_EQ(shape(config, {}, arc_to(10, 10, 10.1, 0, -90, 50)).flaw, Flaw::radius);
  EXPECT_EQ(shape(config, {}, arc_to(0, 0, 0, 0, 360, 50)).flaw, Flaw::no_radius);
  EXPECT_EQ(shape(config, {}, arc_to(10, 10, 10, 0, -80, 50)).flaw, Flaw::sweep);
  Element e = arc_to(10, 10, 10, 0, -90, 50);
  e.axis2 = 0;
  EXPECT_EQ(shape(config, {}, e).flaw, Flaw::wrong_plane);
  e.axis2 = 7;
  EXPECT_EQ(shape(config, {}, e).flaw, Flaw::wrong_plane);
}

TEST(Geometry, a_part_runs_along_its_whole) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const RandomProgram p = random_program(seed, {4, true, false});
    for (const Piece& whole : pieces_of(p)) {
      const double from = 0.3 * whole.length, length = 0.5 * whole.length;
      const Piece piece = part(whole, from, length);
      for (double share : {0.0, 0.2, 0.9, 1.0}) {
        const PathPoint a = evaluate(piece, share * length, p.config.axis_count);
        const PathPoint b = evaluate(whole, from + share * length, p.config.axis_count);
        ASSERT_LT(distance(a.x, b.x), 1e-11);
        ASSERT_LT(distance(a.d2, b.d2), 1e-9 * (1 + norm(b.d2, 9)));
      }
    }
  }
}

TEST(Blend, joins_with_continuous_curvature_within_the_tolerance_and_half_of_each_neighbour) {
  int blends = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const RandomProgram p = random_program(seed, {6, true, false});
    const int n = p.config.axis_count;
    const std::vector<Piece> pieces = pieces_of(p);
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      const Piece &a = pieces[k - 1], &b = pieces[k];
      const auto found = blend(a, b, p.tolerance, n);
      if (!found) continue;
      ++blends;
      const Piece& q = found->piece;
      ASSERT_LE(found->trim, 0.5 * std::min(a.length, b.length) * (1 + 1e-12));
      const PathPoint q0 = evaluate(q, 0, n), q1 = evaluate(q, q.length, n);
      const PathPoint a1 = evaluate(a, a.length - found->trim, n), b0 = evaluate(b, found->trim, n);
      ASSERT_LT(distance(q0.x, a1.x), 1e-11);
      ASSERT_LT(distance(q1.x, b0.x), 1e-11);
      ASSERT_LT(distance(q0.d1, a1.d1), 1e-8 * (1 + norm(a1.d1, n)));
      ASSERT_LT(distance(q1.d1, b0.d1), 1e-8 * (1 + norm(b0.d1, n)));
      ASSERT_LT(distance(q0.d2, a1.d2) * q.length, 1e-7 * (1 + norm(a1.d1, n)));
      ASSERT_LT(distance(q1.d2, b0.d2) * q.length, 1e-7 * (1 + norm(b0.d1, n)));
      Polyline blended, programmed;
      for (int i = 0; i <= 60; ++i) {
        blended.push_back(position(q, q.length * i / 60, n));
        const double s = found->trim * i / 30;
        programmed.push_back(i < 30 ? position(a, a.length - found->trim + s, n)
                                    : position(b, s - found->trim, n));
      }
      ASSERT_TRUE(frechet_within(blended, programmed, p.tolerance * 1.001, n)) << seed;
    }
  }
  EXPECT_GT(blends, 2000);
}

TEST(Blend, uses_the_tolerance_where_the_neighbours_are_long) {
  const Config config = mill();
  const Piece a = shape(config, {}, line_to(10, 0, 0, 50)).piece;
  const Piece b = shape(config, {10, 0, 0}, line_to(10, 10, 0, 50)).piece;
  const auto found = blend(a, b, 0.01, 3);
  ASSERT_TRUE(found);
  const Vector middle = position(found->piece, 0.5 * found->piece.length, 3);
  const double off = std::hypot(middle[0] - 10, middle[1]);
  EXPECT_LE(off, 0.01);
  EXPECT_GE(off, 0.009);
}

TEST(Blend, refuses_to_turn_back_and_to_work_without_tolerance) {
  const Config config = mill();
  const Piece a = shape(config, {}, line_to(10, 0, 0, 50)).piece;
  EXPECT_FALSE(blend(a, shape(config, {10, 0, 0}, line_to(0, 0, 0, 50)).piece, 0.01, 3));
  EXPECT_FALSE(blend(a, shape(config, {10, 0, 0}, line_to(0, 0.5, 0, 50)).piece, 0.01, 3));
  EXPECT_FALSE(blend(a, shape(config, {10, 0, 0}, line_to(10, 10, 0, 50)).piece, 0.0, 3));
}

TEST(Box, whatever_the_parameter_does_inside_keeps_every_axis_inside_its_limits) {
  std::mt19937_64 random(42);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double closest = 0.0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const RandomProgram p = random_program(seed, {5, true, false});
    const int n = p.config.axis_count;
    std::vector<Piece> all = pieces_of(p);
    for (std::size_t k = 1, lines = all.size(); k < lines; ++k)
      if (const auto b = blend(all[k - 1], all[k], p.tolerance, n)) all.push_back(b->piece);
    for (const Piece& piece : all) {
      const Box b = box(p.config, piece, uniform(0, 1) < 0.5 ? 1e300 : uniform(1, 500));
      ASSERT_GT(b.velocity, 0.0);
      ASSERT_GT(b.acceleration, 0.0);
      ASSERT_GT(b.jerk, 0.0);
      for (int k = 0; k < 40; ++k) {
        const PathPoint at = evaluate(piece, uniform(0, piece.length), n);
        const double v = b.velocity * (k % 2 ? 1.0 : uniform(0, 1));
        const double a = b.acceleration * (k % 3 ? (k % 3 == 1 ? 1 : -1) : uniform(-1, 1));
        const double j = b.jerk * (k % 4 ? (k % 4 == 1 ? 1 : -1) : uniform(-1, 1));
        for (int i = 0; i < n; ++i) {
          const AxisLimits& l = p.config.limits[i];
          const double share =
              std::max({std::abs(at.d1[i] * v) / l.velocity,
                        std::abs(at.d2[i] * v * v + at.d1[i] * a) / l.acceleration,
                        std::abs(at.d3[i] * v * v * v + 3 * at.d2[i] * v * a + at.d1[i] * j) / l.jerk});
          ASSERT_LE(share, 1.0 + 1e-9) << "seed " << seed;
          closest = std::max(closest, share);
        }
      }
    }
  }
  EXPECT_GT(closest, 0.99) << "the boxes are not needlessly small";
}

TEST(Box, gives_a_straight_line_everything_its_slowest_axis_has) {
  Config config = mill();
  config.limits[1] = {100, 500, 2000};
  const Box b = box(config, shape(config, {}, line_to(3, 4, 0, 50)).piece, 1e300);
  EXPECT_NEAR(b.velocity, 125, 1e-9);
  EXPECT_NEAR(b.acceleration, 625, 1e-9);
  EXPECT_NEAR(b.jerk, 2500, 1e-9);
}

}  // namespace
}  // namespace servogate::path::test
