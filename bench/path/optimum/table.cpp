// SPDX-License-Identifier: Apache-2.0
// Prints how far the law of today is from the best one on the path of today, work by work.
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

double total(const Shaped& shaped, const Limits& limits, bool with_jerk, bool& sure) {
  double sum = 0.0;
  for (const Course& course : shaped.courses) {
    const Optimum found = fastest(course, limits, with_jerk);
    sum += found.seconds;
    sure = sure && found.converged;
  }
  return sum;
}

constexpr double kTolerance = 0.01;

path::Config by_spans(path::Config config) {
  config.law = path::Law::spans;
  return config;
}

void row(const Work& work) {
  const double today = path::estimate(by_spans(work.config), {}, work.program).seconds;
  const Shaped shaped = shape_of(work.config, work.program);
  const Limits limits = limits_of(work.config);
  const double feed = work.program.front().feed;
  bool sure = true;
  const double law = total(shaped, limits, true, sure), bound = total(shaped, limits, false, sure);
  const double step = std::clamp(shaped.length / 100'000.0, 0.01, 0.05);
  const Optimum smooth =
      fastest(course_of(smoothest(programmed(work.program, step), kTolerance), feed), limits, true);
  sure = sure && smooth.converged;
  std::printf("%-34s %8.3f %8.3f %8.3f%s %8.3f %8.3f %5.0f %% %5.0f %%   %s\n", work.name.c_str(), today, law,
              smooth.seconds, sure ? " " : "?", bound, shaped.length / feed, 100.0 * (today / law - 1.0),
              100.0 * (law / smooth.seconds - 1.0), work.known);
  std::fflush(stdout);
}

}  // namespace

int main() {
  const double full = 2.0 * std::numbers::pi;
  std::printf("%-34s %8s %8s %8s  %8s %8s %7s %7s   known elsewhere\n", "seconds", "today", "best law",
              "smooth", "no jerk", "feed", "law", "path");
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
