// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "kernel/path/law/rate_motion.hpp"
#include "tests/path/rig/course.hpp"
#include "tests/path/rig/published_course.hpp"

namespace servogate::path::test {
namespace {
RandomProgram program(const std::vector<Element>& elements, const Config& config = mill()) {
  RandomProgram p;
  p.config = config;
  p.tolerance = 0.01;
  p.elements = elements;
  return p;
}
std::vector<Element> circle(double r, double feed) {
  return {arc_to(2.0 * r, 0, r, 0, 180, feed), arc_to(0, 0, r, 0, 180, feed)};
}
Config slow_mill() {
  Config c = mill();
  for (int i = 0; i < 3; ++i) c.limits[i] = {500.0, 200.0, 2000.0};
  return c;
}
Config fast() {
  Config c = mill();
  for (int i = 0; i < 3; ++i) c.limits[i] = {500.0, 5000.0, 50000.0};
  return c;
}
std::vector<Element> wide_arc(double radius) {
  std::vector<Element> out;
  const int blocks = static_cast<int>(radius * 4.0);
  for (int i = 1; i <= blocks; ++i) {
    const double angle = i * 0.3 / radius;
    out.push_back(line_to(radius - radius * std::cos(angle), radius * std::sin(angle), 0, 500));
  }
  return out;
}
std::vector<Element> walk(int blocks, unsigned seed, double sigma) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> turn(0.0, sigma);
  std::vector<Element> e;
  double x = 0, y = 0, z = 0, heading = 0;
  for (int i = 0; i < blocks; ++i) {
    heading += turn(random);
    x += 0.3 * std::cos(heading), y += 0.3 * std::sin(heading), z += 0.02 * turn(random);
    e.push_back(line_to(x, y, z, 100));
  }
  return e;
}
std::vector<Element> rows() {
  std::vector<Element> e;
  for (int n = 0; n < 8; ++n) {
    e.push_back(line_to(n % 2 ? 0 : 40, n * 2, 0, 100));
    e.push_back(line_to(n % 2 ? 0 : 40, n * 2 + 2, 0, 100));
  }
  return e;
}
std::vector<Element> helix() {
  std::vector<Element> e;
  for (int i = 1; i <= 900; ++i)
    e.push_back(line_to(6 - 6 * std::cos(i / 60.0), 6 * std::sin(i / 60.0), 0.004 * i, 100));
  return e;
}
double best_at_once(const PublishedCourse& c, const RateMotion& m, double most) {
  for (double s = RateChange::kShortest; s < std::min(most, 6.0); s *= 1.03)
    for (int p : {2, 3}) {
      Verification v;
      v.begin({1.0, 0.0, 0.0, s, p}, m.time(), m.knot());
      int places = 1 << 20;
      if (v.go(c, c.limits, places) == Fit::fits) return s;
    }
  return most;
}
void probe(const char* name, const RandomProgram& p) {
  const PublishedCourse c(p);
  if (!c.whole()) { std::printf("%s: not whole\n", name); return; }
  RateMotion m(c.limits);
  int n = 0, cycles = 0, worst_begin = 0, worst_late = 0, worst_begin_at = 0, late_at = 0, worst_settle = 0;
  long sum_begin = 0;
  double worst_way = 0;
  int late_more = 0, worst_hold = 0, late_hold = 0, late_begin = 0, h17 = 0;
  for (; m.step(c, 1.0, 0.001); ++cycles) {
    if (cycles < 20 || cycles % 3) continue;
    ++n;
    RateMotion h = m;
    const double place = m.point(c).place;
    int k = 0, begin = 0, settle = 0;
    for (; k < 10000; ++k) {
      const bool on = h.step(c, 0.0, 0.001);
      if (!settle && h.changing()) settle = k + 1;
      if (!begin && h.rate() != 1.0) begin = k + 1;
      if (h.at_rest() || !on) break;
    }
    const double way = h.point(c).place - place;
    const int best = static_cast<int>(std::ceil(best_at_once(c, m, k * 0.001) * 1000));
    sum_begin += begin;
    worst_settle = std::max(worst_settle, settle);
    h17 += begin > 17;
    worst_hold = std::max(worst_hold, k);
    if (begin > worst_begin) worst_begin = begin, worst_begin_at = cycles;
    worst_way = std::max(worst_way, way);
    if (k - best > 20) ++late_more;
    if (k - best > worst_late) worst_late = k - best, late_at = cycles, late_hold = k, late_begin = begin;
  }
  std::printf("%-22s n %5d begin mean %5.1f max %4d (cycle %d) >17: %d settle %d; hold max %4d, beyond best at once max %4d (cycle %d, hold %d, begin %d), >20: %d\n", name, n,
              1.0 * sum_begin / std::max(1, n), worst_begin, worst_begin_at, h17, worst_settle, worst_hold, worst_late, late_at, late_hold, late_begin, late_more);
  std::fflush(stdout);
}
TEST(ZzProbe, all) {
  for (double r : {10.0, 20.0, 40.0, 60.0, 200.0}) {
    char t[40];
    std::snprintf(t, sizeof t, "arc R%g F6000", r);
    probe(t, program(circle(r, 100)));
    std::snprintf(t, sizeof t, "arc R%g F30000", r);
    probe(t, program(circle(r, 500)));
  }
  probe("arc R20 F30000 fast", program(circle(20, 500), fast()));
  probe("lines 0,30", program({line_to(200, 0, 0, 100), line_to(260, 0, 0, 40), line_to(260, 30, 0, 100), line_to(0, 30, 0, 100)}));
  probe("lines 60,6", program({line_to(200, 0, 0, 100), line_to(260, 0, 0, 40), line_to(320, 6, 0, 100), line_to(0, 6, 0, 100)}));
  probe("rows", program(rows()));
  probe("rows fast", program(rows(), fast()));
  probe("walk .15", program(walk(400, 2, 0.15)));
  probe("walk .5", program(walk(400, 2, 0.5)));
  probe("helix", program(helix()));
  probe("wide arc 200 slow", program(wide_arc(200), slow_mill()));
  probe("wide arc 60 slow", program(wide_arc(60), slow_mill()));
}
// overrides: waits from constant or changing rates
void waits(const char* name, const RandomProgram& p, bool changing) {
  const PublishedCourse c(p);
  if (!c.whole()) return;
  std::mt19937_64 random(7);
  RateMotion m(c.limits);
  int worst_up = 0, worst_down = 0, over_up = 0, over_down = 0, n = 0;
  double up_from = 0, up_to = 0;
  std::vector<RateMotion> at;
  while (m.step(c, 1.0, 0.001)) if (random() % 40 == 0) at.push_back(m);
  const double rates[] = {1.0, 0.0, 0.3, 0.5, 0.7, 0.9, 0.97, 0.1};
  for (RateMotion& start : at) {
    for (int q = 0; q < 6; ++q) {
      RateMotion h = start;
      const double first = rates[1 + random() % 7], then = rates[random() % 8];
      if (first == then) continue;
      int k = 0;
      bool on = true;
      const int lead = changing ? 1 + static_cast<int>(random() % 400) : 100000;
      for (; k < lead && on; ++k) {
        on = h.step(c, first, 0.001);
        if (!changing && !h.changing() && std::abs(h.rate() - first) < 1e-9) break;
      }
      if (!on && h.rate() > 0) continue;
      const double from = h.wanted();
      int w = 0;
      for (; w < 4000; ++w) {
        on = h.step(c, then, 0.001);
        if (!on && h.rate() > 0) break;
        if (h.wanted() == then) break;
      }
      if (!on && h.rate() > 0) continue;
      ++n;
      if (then > from) {
        if (w > worst_up) worst_up = w, up_from = from, up_to = then;
        over_up += w > 160;
      } else {
        worst_down = std::max(worst_down, w);
        over_down += w > 160;
      }
    }
  }
  std::printf("%-22s %s n %d: up max %d (%g to %g), >160: %d; down max %d, >160: %d\n", name, changing ? "changing" : "constant", n, worst_up, up_from, up_to, over_up, worst_down, over_down);
  std::fflush(stdout);
}
TEST(ZzProbe, waits) {
  for (bool changing : {false, true}) {
    waits("arc R20 F6000", program(circle(20, 100)), changing);
    waits("arc R10 F30000", program(circle(10, 500)), changing);
    waits("arc R60 F30000", program(circle(60, 500)), changing);
    waits("rows", program(rows()), changing);
    waits("walk .15", program(walk(400, 2, 0.15)), changing);
    waits("walk .5", program(walk(400, 2, 0.5)), changing);
    waits("helix", program(helix()), changing);
    waits("wide arc 60 slow", program(wide_arc(60), slow_mill()), changing);
    waits("wide arc 200 slow", program(wide_arc(200), slow_mill()), changing);
    waits("wide arc 400 slow", program(wide_arc(400), slow_mill()), changing);
  }
}
}  // namespace
}  // namespace servogate::path::test
