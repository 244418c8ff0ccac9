// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/tube.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace servogate::path {
namespace {

/// A right-angled corner in `axes` axes, in even steps, with a site at each knot and in each middle.
TubeProblem corner(int axes, int half, double step, double radius) {
  TubeProblem p;
  p.axes = axes;
  const auto at = [&](double s) {
    Vector x{};
    x[0] = step * std::min(s, static_cast<double>(half));
    if (axes > 1) x[1] = step * std::max(0.0, s - half);
    return x;
  };
  const int intervals = 2 * half;
  for (int i = -1; i <= intervals + 1; ++i)
    for (int a = 0; a < axes; ++a)
      p.controls.push_back(at(std::min(std::max(i, 0), intervals))[static_cast<std::size_t>(a)]);
  p.jerk.assign(static_cast<std::size_t>(intervals * axes), 1e-3);
  for (int k = 2; k < intervals - 1; ++k)
    for (const double f : {0.0, 0.5}) {
      Site s;
      s.interval = k;
      s.share = f;
      s.at = at(k + f);
      s.radius = s.pull = radius;
      p.sites.push_back(s);
    }
  p.first = 3;
  p.last = static_cast<std::size_t>(intervals) - 1;
  return p;
}

double offset(const TubeProblem& p, const Site& s) {
  const auto w = spline_weights(s.share);
  double sum = 0.0;
  for (int a = 0; a < p.axes; ++a) {
    double x = -s.at[static_cast<std::size_t>(a)];
    for (int q = 0; q < 4; ++q)
      x += w[static_cast<std::size_t>(q)] *
           p.controls[static_cast<std::size_t>((s.interval + q) * p.axes + a)];
    sum += x * x;
  }
  return std::sqrt(sum);
}

double most_jerk(const TubeProblem& p) {
  double most = 0.0;
  const auto n = static_cast<std::size_t>(p.axes);
  for (std::size_t i = 0; i + 3 * n < p.controls.size(); ++i)
    most = std::max(most, std::abs(p.controls[i + 3 * n] - 3 * p.controls[i + 2 * n] + 3 * p.controls[i + n] -
                                   p.controls[i]));
  return most;
}

TEST(Tube, keeps_every_site_within_its_radius_in_any_number_of_axes) {
  Tube tube;
  for (int axes = 1; axes <= kMaxAxes; ++axes) {
    for (const bool flat : {false, true}) {
      TubeProblem p = corner(axes, 20, 0.02, 0.01);
      p.flat = flat;
      const TubeSolution found = tube.solve(p);
      EXPECT_TRUE(found.inside) << axes;
      for (const Site& s : p.sites) EXPECT_LT(offset(p, s), s.radius) << axes << " at " << s.interval;
    }
  }
}

TEST(Tube, rounds_a_corner_with_less_jerk_the_wider_it_is_and_flattens_its_peaks) {
  Tube tube;
  double before = HUGE_VAL;
  for (const double radius : {0.005, 0.01, 0.02, 0.04}) {
    TubeProblem square = corner(2, 20, 0.02, radius), flat = square;
    flat.flat = true;
    ASSERT_TRUE(tube.solve(square).inside);
    ASSERT_TRUE(tube.solve(flat).inside);
    EXPECT_LT(most_jerk(square), before);
    EXPECT_LT(most_jerk(flat), most_jerk(square));
    before = most_jerk(square);
  }
}

TEST(Tube, brings_in_a_start_that_lies_outside) {
  Tube tube;
  TubeProblem p = corner(3, 20, 0.02, 0.01);
  for (std::size_t i = 3 * 3; i < 3 * (p.last + 1); ++i)
    p.controls[i] += 0.03 * std::sin(0.7 * static_cast<double>(i));
  EXPECT_TRUE(tube.solve(p).inside);
  for (const Site& s : p.sites) EXPECT_LT(offset(p, s), s.radius);
}

TEST(Tube, says_which_site_no_curve_can_reach_and_keeps_the_others) {
  Tube tube;
  TubeProblem p = corner(2, 20, 0.02, 0.01);
  // Two places at once.
  Site other = p.sites[30];
  other.at[1] += 0.05;
  p.sites.push_back(other);
  const TubeSolution found = tube.solve(p);
  EXPECT_FALSE(found.inside);
  EXPECT_GE(found.released, 1);
  int beyond = 0;
  for (const Site& s : p.sites) {
    EXPECT_LE(offset(p, s), s.radius * std::sqrt(s.limit) * (1 + 1e-9));
    beyond += offset(p, s) > s.radius ? 1 : 0;
  }
  EXPECT_LE(beyond, found.released);
}

TEST(Tube, lets_a_place_slide_along_the_path_where_it_may) {
  Tube tube;
  TubeProblem p = corner(1, 20, 0.02, 0.001), q = p;
  for (std::size_t i = 3; i < p.controls.size() - 3; ++i) p.controls[i] = q.controls[i] += 0.003;
  for (Site& s : q.sites) {
    s.at[0] += 0.002 * std::sin(s.interval);
    s.along[0] = 1.0;
    s.slide = 0.01;
  }
  EXPECT_TRUE(tube.solve(p).inside);
  EXPECT_TRUE(tube.solve(q).inside);
  for (const Site& s : p.sites) EXPECT_LT(offset(p, s), 0.001);
  for (const Site& s : q.sites) EXPECT_LT(offset(q, s), 0.01);
}

TEST(Tube, gives_the_same_bytes_after_other_problems) {
  Tube used, fresh;
  TubeProblem other = corner(3, 30, 0.03, 0.005), first = corner(3, 20, 0.02, 0.01), second = first;
  used.solve(other);
  used.solve(first);
  fresh.solve(second);
  EXPECT_EQ(first.controls, second.controls);
}

}  // namespace
}  // namespace servogate::path
