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
  std::vector<double> cycles;  // us
  int late = 0, places = 0;
};

/// One hold at a random cycle.
void hold(const OneRun& run, const path::RateLimits& limits, int at, Holds& out) {
  path::RateMotion motion(limits);
  for (int n = 0; n < at; ++n) motion.step(run, 1.0, 0.001);
  int cycles = 0;
  bool on = true, late = false;
  for (; on && !motion.at_rest(); ++cycles) {
    late |= cycles > 0 && motion.rate() == 1.0;  // settled, and begins in the knot of the next known stop
    const double begin = now();
    on = motion.step(run, 0.0, 0.001);
    out.cycles.push_back(now() - begin);
    out.places = std::max(out.places, motion.places());
  }
  out.late += late ? 1 : 0;
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
  const auto share = [](std::vector<double>& of, double s) {
    const auto at = of.begin() + static_cast<std::ptrdiff_t>(s * static_cast<double>(of.size() - 1));
    std::nth_element(of.begin(), at, of.end());
    return *at;
  };
  std::printf("%-30s %4.0f %% %7.3f %7.3f %7.3f %5d %8.1f %8.0f %8.0f %8.0f %7d\n", name, 100.0 * reserve,
              share(holds.stops, 0.5), share(holds.stops, 0.9), share(holds.stops, 1.0), holds.late,
              hint_cost, share(holds.cycles, 0.5), share(holds.cycles, 0.99), share(holds.cycles, 1.0),
              holds.places);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::printf(
      "300 holds from full rate, each settled in its first cycle: seconds to standstill; how many began in "
      "the "
      "knot of the next known stop, or behind a slow place; what a known stop costs the planner, and what a "
      "cycle costs until the motion stands, and how many places it looks at, at most\n");
  std::printf("%-30s %6s %7s %7s %7s %5s %8s %8s %8s %8s %7s\n", "", "reserve", "p50", "p90", "max", "late",
              "us/knot", "p50 us", "p99 us", "max us", "places");
  const double full = 2.0 * std::numbers::pi;
  for (const double reserve : {0.01, 0.03}) {
    row("mill: circle R20, 1000 blocks", mill(), polygon(20, 1000, full / 1000, 6000), reserve);
    row("mill: 5000 x 0.1 mm on R200", mill(), polygon(200, 5000, 0.1 / 200, 30000), reserve);
    row("mill: thread helix", mill(), thread_helix(6000), reserve);
    row("mill: random walk, 3000", mill(), random_walk(3000, 6000), reserve);
    row("mill: surface in rows", mill(), surface_rows(6000), reserve);
  }
}
