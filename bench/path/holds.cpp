// SPDX-License-Identifier: Apache-2.0
// Prints how soon a hold stops the motion over one clock, and what finding the stop costs planner and cycle.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <random>
#include <vector>

#include "bench/path/works.hpp"
#include "kernel/path/law/pipeline.hpp"
#include "kernel/path/law/rate_motion.hpp"
#include "kernel/path/shape/gather.hpp"

namespace {

using namespace servogate;
using namespace servogate::bench;

/// A program that is one run.
class OneRun final : public path::RunSink, public path::KnotSink, public path::CourseView {
 public:
  OneRun(const path::Config& config, const Program& program, double reserve)
      : pipeline_(settings(config, reserve), *this) {
    path::Gather gather(config, *this);
    gather.restart({});
    for (const path::Element& e : program) gather.add(e);
    gather.finish();
    while (pipeline_.work()) {
    }
  }
  static path::Pipeline::Settings settings(const path::Config& config, double reserve) {
    path::Pipeline::Settings s;
    s.axes = config.axis_count;
    s.reserve = reserve;
    return s;
  }
  void put(const path::Leg& leg) override { pipeline_.add(leg); }
  void rest(bool /*confirm*/) override { pipeline_.end(); }
  void cruise(const path::Leg& leg, double /*speed*/) override {
    pipeline_.add(leg);
  }  // as one run with the rest
  void begin(const path::Vector& /*before_last*/, const path::Vector& /*last*/) override {}
  void put(const path::Knot& knot) override { knots_.push_back(knot); }
  void rest() override {}
  void cruise(const path::Cruise& /*cruise*/) override {}
  void move(const path::Move& /*move*/) override {}
  const path::Knot* knot(std::int64_t n) const noexcept override {
    if (n < 0) return &knots_.front();  // from rest
    return n <= end() ? &knots_[static_cast<std::size_t>(n)] : nullptr;
  }
  std::int64_t end() const noexcept override { return static_cast<std::int64_t>(knots_.size()) - 1; }
  path::StopHint stop_near(std::int64_t n) const noexcept override {
    return stops.empty() ? path::StopHint{}
                         : stops[std::min(stops.size() - 1, static_cast<std::size_t>((n + 3) / 4))];
  }
  std::vector<path::StopHint> stops;  // each fourth knot
  double seconds() const { return knots_.back().t.since(knots_.front().t); }

 private:
  path::Pipeline pipeline_;
  std::vector<path::Knot> knots_;
};

/// Processor time, us.
double now() { return 1e6 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Holds {
  std::vector<double> stops;
  double search = 0.0, worst = 0.0;  // us
  int searched = 0, late = 0;
};

/// One hold at a random cycle.
void hold(const OneRun& run, const path::RateLimits& limits, int at, Holds& out) {
  path::RateMotion motion(limits);
  const auto step = [&](double target) { return motion.step(run, target, 0.001); };
  for (int n = 0; n < at; ++n) step(1.0);
  int cycles = 0;
  bool on = true;
  for (; on && !motion.changing() && motion.rate() != 0.0; ++cycles) {
    const double begin = now();
    on = step(0.0);
    const double took = now() - begin;
    out.search += took;
    out.worst = std::max(out.worst, took);
    ++out.searched;
  }
  // Settled, and begins in the knot of the next known stop.
  bool late = false;
  for (; on && motion.rate() == 1.0; ++cycles, late = true) on = step(0.0);
  out.late += late ? 1 : 0;
  for (; on && motion.changing(); ++cycles) on = step(0.0);
  if (on) out.stops.push_back(0.001 * cycles);
}

void row(const char* name, const path::Config& config, const Program& program, double reserve) {
  OneRun run(config, program, reserve);
  path::RateLimits limits;
  limits.axes = config.axis_count;
  limits.limits = config.limits;
  const double begin = now();
  for (std::int64_t k = 0; k < run.end(); k += 4)
    run.stops.push_back(
        path::find_stop(run, k, run.stops.empty() ? path::StopHint{} : run.stops.back(), limits));
  const double hint_cost = (now() - begin) / static_cast<double>(run.end());
  Holds holds;
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> cycle(20, static_cast<int>(run.seconds() * 1000) - 60);
  for (int n = 0; n < 300; ++n) hold(run, limits, cycle(random), holds);
  std::sort(holds.stops.begin(), holds.stops.end());
  const auto share = [&](double s) {
    return holds.stops[static_cast<std::size_t>(s * static_cast<double>(holds.stops.size() - 1))];
  };
  std::printf("%-30s %4.0f %% %7.3f %7.3f %7.3f %5d %8.1f %8.1f %8.0f\n", name, 100.0 * reserve, share(0.5),
              share(0.9), share(1.0), holds.late, hint_cost, holds.search / holds.searched, holds.worst);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::printf(
      "300 holds from full rate, each settled in its first cycle; seconds to standstill, how many began in "
      "the "
      "knot of the next known stop (16 ms at most)\n");
  std::printf("%-30s %6s %7s %7s %7s %5s %8s %8s %8s\n", "", "reserve", "p50", "p90", "max", "late",
              "us/knot", "us/cycle", "worst us");
  const double full = 2.0 * std::numbers::pi;
  for (const double reserve : {0.01, 0.03}) {
    row("mill: circle R20, 1000 blocks", mill(), polygon(20, 1000, full / 1000, 6000), reserve);
    row("mill: 5000 x 0.1 mm on R200", mill(), polygon(200, 5000, 0.1 / 200, 30000), reserve);
    row("mill: thread helix", mill(), thread_helix(6000), reserve);
    row("mill: random walk, 3000", mill(), random_walk(3000, 6000), reserve);
    row("mill: surface in rows", mill(), surface_rows(6000), reserve);
  }
}
