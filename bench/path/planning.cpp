// SPDX-License-Identifier: Apache-2.0
// Prints the times of known contours, blocks planned per second and the cost of a follower step.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "bench/path/works.hpp"
#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"

namespace {

using namespace servogate::path;
using namespace servogate::bench;

void row(const char* name, const Config& config, const Program& program, const char* known) {
  const Estimate e = estimate(config, {}, program);
  std::printf("%-52s %9.3f s   %s\n", name, e.seconds, known);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void planning_speed(const Config& config, const Program& program) {
  Track track(config);
  Planner planner(config, track);
  planner.restart({});
  const auto begin = std::chrono::steady_clock::now();
  std::uint64_t entry = 0;
  for (const Element& e : program) {
    planner.add(e);
    planner.work();
    // A reader that is always done.
    track.entries.free_below(entry = track.entries.written());
    track.pieces.free_below(track.pieces.written());
  }
  planner.finish();
  planner.work();
  const double t = seconds_since(begin);
  std::printf("planned: %.0f blocks/s (%zu blocks, %llu entries)\n", static_cast<double>(program.size()) / t,
              program.size(), static_cast<unsigned long long>(track.visible()));
  (void)entry;
}

void step_cost(const char* name, const Config& config, const Program& program, bool busy_override) {
  Track track(config);
  Planner planner(config, track);
  Follower follower(config, track);
  planner.restart({});
  std::vector<double> ns;
  std::size_t next = 0;
  bool finished = false;
  for (std::int64_t cycle = 0; cycle < 2'000'000; ++cycle) {
    while (!finished && planner.wants_more()) {
      if (next < program.size())
        planner.add(program[next++]);
      else
        planner.finish(), finished = true;
      planner.work();
    }
    planner.work();
    const auto begin = std::chrono::steady_clock::now();
    if (busy_override) follower.set_override(cycle % 2 == 0 ? 0.9 : 1.0);
    const Sample s = follower.step(track.visible());
    ns.push_back(seconds_since(begin) * 1e9);
    if (finished && s.state == FollowerState::idle) break;
  }
  std::sort(ns.begin(), ns.end());
  const auto at = [&](double share) {
    return ns[static_cast<std::size_t>(share * static_cast<double>(ns.size() - 1))];
  };
  std::printf("%-40s step: p50 %.0f ns, p99 %.0f ns, p99.9 %.0f ns (%zu cycles)\n", name, at(0.5), at(0.99),
              at(0.999), ns.size());
}

}  // namespace

int main() {
  const Config mill = servogate::bench::mill(), fast = servogate::bench::fast();
  const double full = 2.0 * std::numbers::pi;
  row("mill: circle R20, one arc, F6000", mill, circle(20, 6000), "ideal 1.457");
  row("mill: circle R20, 1000 blocks, F6000", mill, polygon(20, 1000, full / 1000, 6000), "ideal 1.457");
  row("mill: 100 mm, one block, F6000", mill, collinear(1, 100, 6000), "ideal 1.200");
  row("mill: 100 mm, 1000 blocks, F6000", mill, collinear(1000, 0.1, 6000), "ideal 1.200");
  row("mill: 100 mm, one block, F30000", mill, collinear(1, 100, 30000), "ideal 0.740");
  row("fast: 5000 x 0.1 mm on R200, F30000", fast, polygon(200, 5000, 0.1 / 200, 30000), "ideal 1.20");
  row("mill: zigzag 1000 x 0.1 mm, F6000", mill, zigzag(1000, 0.1, 6000), "17.0 without jerk limit");
  const Program walk = random_walk(20000, 6000);
  row("mill: random walk of 20 000 blocks, F6000", mill, walk, "60.9 is the optimum without jerk limit");
  planning_speed(mill, walk);
  planning_speed(mill, collinear(100000, 0.1, 6000));
  step_cost("random walk", mill, walk, false);
  step_cost("random walk, override changes each cycle", mill, walk, true);
  step_cost("arc, override changes each cycle", mill, circle(20, 600), true);
}
