// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <chrono>
#include <random>
#include <tuple>

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
std::vector<Element> cam(double R0, double feed, int blocks) {
  std::vector<Element> e;
  for (int k = 1; k <= blocks; ++k) {
    const double t = k * M_PI / 1000;
    const double rr = R0 * (1 + .3 * std::sin(5 * t) + .08 * std::sin(17 * t));
    e.push_back(line_to(rr * std::cos(t) - R0, rr * std::sin(t), 3 * std::sin(7 * t), feed));
  }
  return e;
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
void probe(const char* name, const RandomProgram& p, int every) {
  const PublishedCourse c(p);
  if (!c.whole()) { std::printf("%s: not whole\n", name); return; }
  RateMotion m(c.limits);
  int cycles = 0, n = 0, most = 0, begins = 0, late = 0, places = 0, worst_begin = 0;
  double sum = 0, way = 0, us = 0, worst_us = 0, most_way = 0;
  long looks = 0, steps = 0;
  for (; m.step(c, 1.0, 0.001); ++cycles) {
    if (cycles < 20 || cycles % every) continue;
    ++n;
    RateMotion h = m;
    const double from = m.point(c).place;
    int k = 0, begin = 0;
    for (; k < 10000; ++k) {
      const auto t0 = std::chrono::steady_clock::now();
      const bool on = h.step(c, 0.0, 0.001);
      const double u = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count() * 1e6;
      us += u; worst_us = std::max(worst_us, u); ++steps; looks += h.places();
      places = std::max(places, h.places());
      if (!begin && h.rate() != 1.0) begin = k + 1;
      if (h.at_rest() || !on) break;
    }
    sum += k; most = std::max(most, k); way += h.point(c).place - from; most_way = std::max(most_way, h.point(c).place - from);
    begins += begin; worst_begin = std::max(worst_begin, begin); late += begin > 16;
  }
  std::printf("%-10s n %d mean %.0f most %d; way %.1f most %.1f; begin %.1f most %d, >16: %d; places %ld most %d; us %.1f most %.0f\n", name, n, sum / n, most, way / n, most_way, 1.0 * begins / n, worst_begin, late, looks / steps, places, us / steps, worst_us);
  std::fflush(stdout);
}
TEST(ZzFam, all) {
  probe("cam0", program(cam(60, 200, 2000)), 37);
  probe("cam1", program(cam(30, 333, 2000)), 37);
  probe("rows", program(rows()), 37);
  probe("walk .15", program(walk(400, 2, 0.15)), 37);
}
}  // namespace
}  // namespace servogate::path::test
