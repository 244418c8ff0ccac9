// SPDX-License-Identifier: Apache-2.0
// Prints how far the time of today is from the best one on a smooth path within the tolerance, work by work.
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <string>

#include "bench/path/optimum/course.hpp"
#include "kernel/path/planner.hpp"

namespace {

using namespace servogate;
using namespace servogate::bench;

struct Work {
  std::string name;
  path::Config config;
  Program program;
  const char* known;
};

constexpr double kTolerance = 0.01;

void row(const Work& work) {
  const double today = path::estimate(work.config, {}, work.program).seconds;
  const Limits limits = limits_of(work.config);
  const double feed = work.program.front().feed, length = length_of(work.program);
  const double step = std::clamp(length / 100'000.0, 0.01, 0.05);
  const Course course = course_of(smoothest(programmed(work.program, step), kTolerance), feed);
  const Optimum smooth = fastest(course, limits, true), bound = fastest(course, limits, false);
  std::printf("%-34s %8.3f %8.3f%s %8.3f %8.3f %7.0f %%   %s\n", work.name.c_str(), today, smooth.seconds,
              smooth.converged && bound.converged ? " " : "?", bound.seconds, length / feed,
              100.0 * (today / smooth.seconds - 1.0), work.known);
  std::fflush(stdout);
}

}  // namespace

int main() {
  const double full = 2.0 * std::numbers::pi;
  std::printf("%-34s %8s %8s  %8s %8s %9s   known elsewhere\n", "seconds", "today", "smooth", "no jerk",
              "feed", "over");
  row({"mill: circle R20, one arc", mill(), circle(20, 6000), "8.96 with, 1.39-1.47 without jerk limit"});
  row({"mill: circle R20, 1000 blocks", mill(), polygon(20, 1000, full / 1000, 6000),
       "16.21 with, 1.39-1.47 without jerk limit"});
  row({"mill: 100 mm in 1000 blocks", mill(), collinear(1000, 0.1, 6000), "ideal 1.200"});
  row({"fast: 5000 x 0.1 mm on R200", fast(), polygon(200, 5000, 0.1 / 200, 30000),
       "5.2 (one block a cycle)"});
  row({"mill: 5000 x 0.1 mm on R200", mill(), polygon(200, 5000, 0.1 / 200, 30000), "ideal 1.67"});
  row({"mill: zigzag 1000 x 0.1 mm", mill(), zigzag(1000, 0.1, 6000),
       "17.0 without jerk limit; its swing alone takes 35.0"});
  row({"mill: random walk, 20 000 blocks", mill(), random_walk(20000, 6000), "71.3 without jerk limit"});
  for (const bool quick : {false, true}) {
    const std::string on = quick ? "fast: " : "mill: ";
    const path::Config config = quick ? fast() : mill();
    row({on + "surface in rows", config, surface_rows(6000), ""});
    row({on + "trochoidal slot", config, trochoids(6000), ""});
    row({on + "engraving", config, engraving(6000), ""});
    row({on + "thread helix", config, thread_helix(6000), ""});
    row({on + "impeller blade", config, impeller(6000), ""});
  }
}
