// SPDX-License-Identifier: Apache-2.0
// Prints shape and law over one clock beside today's law, work by work: times, aims, and what planning costs.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "bench/path/works.hpp"
#include "kernel/path/law/pipeline.hpp"
#include "kernel/path/planner.hpp"
#include "kernel/path/shape/gather.hpp"

namespace {

using namespace servogate;
using namespace servogate::bench;

struct Work {
  std::string name;
  path::Config config;
  Program program;
  double aim;      ///< s, 0: 1.04 times the joint optimum
  double optimum;  ///< s, the best that is found for shape and law together, 0: not known
};

/// Takes knots as they are published, and looks at the set-points each millisecond.
class Reader final : public path::RunSink, public path::KnotSink {
 public:
  explicit Reader(const path::Config& config) : config_(config), pipeline_(settings(config), *this) {}

  static path::Pipeline::Settings settings(const path::Config& config) {
    path::Pipeline::Settings s;
    s.axes = config.axis_count;
    s.rotary = config.rotary;
    return s;
  }
  void put(const path::Leg& leg) override { pipeline_.add(leg); }
  void rest(bool /*confirm*/) override { pipeline_.end(); }
  void put(const path::Knot& knot) override { knots.push_back(knot); }
  void rest() override {}
  void work() { pipeline_.work(); }
  const path::Pipeline::Counts& counts() const { return pipeline_.counts(); }

  double seconds() const { return knots.empty() ? 0.0 : knots.back().t.since(knots.front().t); }
  /// Largest share of any limit.
  double reached() const;

  std::vector<path::Knot> knots;

 private:
  path::Config config_;
  path::Pipeline pipeline_;
};

double Reader::reached() const {
  double most = 0.0;
  path::Vector x[4];
  std::fill(std::begin(x), std::end(x), knots.front().control);
  std::size_t m = 1;
  for (std::int64_t n = 1; static_cast<double>(n) * 0.001 < seconds(); ++n) {
    const double t = static_cast<double>(n) * 0.001;
    while (knots[m].t.since(knots.front().t) < t) ++m;
    const path::Knot* four[4];
    for (std::size_t q = 0; q < 4; ++q) four[q] = &knots[m + q < 3 ? 0 : m + q - 3];
    std::rotate(std::begin(x), std::begin(x) + 1, std::end(x));
    x[3] = path::Stretch(four).position(t - knots[m - 1].t.since(knots.front().t), config_.axis_count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(config_.axis_count); ++i) {
      const path::AxisLimits& limits = config_.limits[i];
      most = std::max({most, std::abs(x[3][i] - x[2][i]) * 1e3 / limits.velocity,
                       std::abs(x[3][i] - 2 * x[2][i] + x[1][i]) * 1e6 / limits.acceleration,
                       std::abs(x[3][i] - 3 * x[2][i] + 3 * x[1][i] - x[0][i]) * 1e9 / limits.jerk});
    }
  }
  return most;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void row(const Work& work) {
  const double today = path::estimate(work.config, {}, work.program).seconds;
  Reader reader(work.config);
  path::Gather gather(work.config, reader);
  gather.restart({});
  const double begin = now();
  int n = 0;
  for (const path::Element& e : work.program) {
    gather.add(e);
    if (++n % 50 == 0) reader.work();
  }
  gather.finish();
  const double cost = now() - begin;
  const path::Pipeline::Counts& counts = reader.counts();
  const double seconds = reader.seconds(), aim = work.aim > 0.0 ? work.aim : 1.04 * work.optimum;
  const auto blocks = static_cast<double>(work.program.size()), knots = static_cast<double>(counts.knots);
  std::printf("%-30s %8.3f %8.3f%s %8.3f %8.3f  %8.4f %9.0f %7.1f %8.0f  %lld / %lld / %lld\n",
              work.name.c_str(), aim, seconds, aim > 0.0 && seconds > aim ? "!" : " ", today, work.optimum,
              reader.reached(), blocks / cost, cost / knots * 1e6, seconds / cost,
              static_cast<long long>(counts.released), static_cast<long long>(counts.outside),
              static_cast<long long>(counts.failed));
  std::fflush(stdout);
}

}  // namespace

int main() {
  const double full = 2.0 * std::numbers::pi;
  std::printf("%-30s %8s %8s  %8s %8s  %8s %9s %7s %8s  %s\n", "seconds", "aim", "new", "today", "optimum",
              "limits", "blocks/s", "us/knot", "x real", "released / outside / no law");
  row({"mill: circle R20, one arc", mill(), circle(20, 6000), 1.47, 1.461});
  row({"mill: circle R20, 1000 blocks", mill(), polygon(20, 1000, full / 1000, 6000), 1.47, 1.461});
  row({"mill: 100 mm in 1000 blocks", mill(), collinear(1000, 0.1, 6000), 1.21, 1.200});
  row({"mill: 100 mm in one block", mill(), collinear(1, 100, 6000), 1.21, 1.200});
  row({"fast: 5000 x 0.1 mm on R200", fast(), polygon(200, 5000, 0.1 / 200, 30000), 1.21, 1.191});
  row({"mill: 5000 x 0.1 mm on R200", mill(), polygon(200, 5000, 0.1 / 200, 30000), 1.65, 1.614});
  row({"mill: zigzag 1000 x 0.1 mm", mill(), zigzag(1000, 0.1, 6000), 36.5, 35.30});
  row({"mill: random walk, 20 000", mill(), random_walk(20000, 6000), 105.0, 97.3});
  row({"mill: surface in rows", mill(), surface_rows(6000), 0, 17.60});
  row({"fast: surface in rows", fast(), surface_rows(6000), 0, 10.29});
  row({"mill: trochoidal slot", mill(), trochoids(6000), 0, 14.03});
  row({"fast: trochoidal slot", fast(), trochoids(6000), 0, 8.21});
  row({"mill: engraving", mill(), engraving(6000), 0, 54.22});
  row({"fast: engraving", fast(), engraving(6000), 0, 31.70});
  row({"mill: thread helix", mill(), thread_helix(6000), 0, 6.290});
  row({"fast: thread helix", fast(), thread_helix(6000), 0, 4.616});
  row({"mill: impeller blade", mill(), impeller(6000), 0, 8.73});
  row({"fast: impeller blade", fast(), impeller(6000), 0, 7.51});
  row({"mill: pocket, 40 long lines", mill(), pocket(6000), 0, 0});
}
