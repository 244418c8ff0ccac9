// SPDX-License-Identifier: Apache-2.0
// Prints shape and law over one clock, work by work: times, aims, and what planning costs. With the name of a
// file it also draws the times as a picture (SVG).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "bench/path/works.hpp"
#include "kernel/path/law/pipeline.hpp"
#include "kernel/path/shape/gather.hpp"

namespace {

using namespace servogate;
using namespace servogate::bench;

/// Time of this program on its core, so that others on the computer do not count.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

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
    return s;
  }
  void put(const path::Leg& leg) override { pipeline_.add(leg); }
  void rest(bool /*confirm*/) override { pipeline_.end(); }
  void cruise(const path::Leg& leg, double speed) override { pipeline_.cruise(leg, speed); }
  void begin(const path::Vector& before_last, const path::Vector& last) override {
    knots_.assign(2, {});
    knots_[0].control = before_last;
    knots_[1].control = last;
  }
  void put(const path::Knot& knot) override { knots_.push_back(knot); }
  void rest() override { take_run(); }
  void cruise(const path::Cruise& cruise) override;
  void work() {
    while (pipeline_.work()) {
    }
  }
  const path::Pipeline::Counts& counts() const { return pipeline_.counts(); }
  double looking = 0.0;  ///< s that looking at the set-points took

  double seconds() const { return seconds_; }
  /// Largest share of any limit.
  double reached() const { return reached_; }

 private:
  void take_run();
  void take(const path::Vector& x);
  template <class At>
  void sample(double seconds, const At& at);

  std::vector<path::Knot> knots_;  // of the run, the two before it first
  path::Vector last_[4] = {};
  double seconds_ = 0.0, next_ = 0.001, reached_ = 0.0;  // next_: sample, from the begin of what is sampled
  path::Config config_;
  path::Pipeline pipeline_;
};

void Reader::take(const path::Vector& x) {
  std::rotate(std::begin(last_), std::begin(last_) + 1, std::end(last_));
  last_[3] = x;
  for (std::size_t i = 0; i < static_cast<std::size_t>(config_.axis_count); ++i) {
    const path::AxisLimits& limits = config_.limits[i];
    reached_ = std::max(
        {reached_, std::abs(last_[3][i] - last_[2][i]) * 1e3 / limits.velocity,
         std::abs(last_[3][i] - 2 * last_[2][i] + last_[1][i]) * 1e6 / limits.acceleration,
         std::abs(last_[3][i] - 3 * last_[2][i] + 3 * last_[1][i] - last_[0][i]) * 1e9 / limits.jerk});
  }
}

template <class At>
void Reader::sample(double seconds, const At& at) {
  const double begin = now();
  for (; next_ < seconds; next_ += 0.001) take(at(next_));
  next_ -= seconds;
  seconds_ += seconds;
  looking += now() - begin;
}

void Reader::take_run() {
  std::size_t m = 3;
  const path::LawTime begin = knots_[2].t;
  sample(knots_.back().t.since(begin), [&](double t) {
    while (m + 1 < knots_.size() && knots_[m].t.since(begin) < t) ++m;
    const path::Knot* four[4] = {&knots_[m - 3], &knots_[m - 2], &knots_[m - 1], &knots_[m]};
    return path::Stretch(four).position(t - knots_[m - 1].t.since(begin), config_.axis_count);
  });
}

void Reader::cruise(const path::Cruise& cruise) {
  take_run();
  sample(cruise.seconds, [&](double t) {
    return path::position(cruise.piece, t / cruise.seconds * cruise.piece.length, config_.axis_count);
  });
}

/// Times of one work, s.
struct Times {
  std::string name;
  double aim, course, optimum;
};

constexpr double kLeft = 240, kWidth = 560, kRow = 22, kMost = 1.3;  // of a picture

/// Bars from 1, the optimum, on: how much longer the course takes; a stroke at the aim.
void draw(const std::string& file, const std::vector<Times>& works) {
  const auto place = [](double share) {
    return kLeft + kWidth * (std::min(share, kMost) - 0.9) / (kMost - 0.9);
  };
  std::ofstream out(file);
  const double height = 50 + kRow * static_cast<double>(works.size());
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kLeft + kWidth + 80 << ' ' << height
      << "\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#333\">\n<rect width=\"100%\" "
         "height=\"100%\" "
         "fill=\"white\"/>\n<text x=\""
      << kLeft << "\" y=\"14\">time over the best that is found: course (blue), aim (red)</text>\n";
  for (double share = 1.0; share <= kMost + 1e-9; share += 0.1)
    out << "<path d=\"M" << place(share) << " 26V" << height - 8 << "\" stroke=\"#ddd\"/><text x=\""
        << place(share) << "\" y=\"24\" text-anchor=\"middle\">" << std::round(share * 10) / 10
        << "</text>\n";
  double y = 32;
  for (const Times& w : works) {
    const double share = w.course / w.optimum;
    out << "<text x=\"" << kLeft - 8 << "\" y=\"" << y + 10 << "\" text-anchor=\"end\">" << w.name
        << "</text>\n<rect x=\"" << place(0.9) << "\" y=\"" << y << "\" width=\"" << place(share) - place(0.9)
        << "\" height=\"11\" fill=\"#1f6fb4\"/><text x=\"" << place(share) + 4 << "\" y=\"" << y + 10 << "\">"
        << w.course << " s</text>\n<path d=\"M" << place(w.aim / w.optimum) << ' ' << y - 2
        << "v15\" stroke=\"#c22\" stroke-width=\"2\"/>\n";
    y += kRow;
  }
  out << "</svg>\n";
}

Times row(const Work& work) {
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
  reader.work();
  const double cost = now() - begin - reader.looking;
  const path::Pipeline::Counts& counts = reader.counts();
  const double seconds = reader.seconds(), aim = work.aim > 0.0 ? work.aim : 1.04 * work.optimum;
  const auto blocks = static_cast<double>(work.program.size()), knots = static_cast<double>(counts.knots);
  std::printf("%-30s %8.3f %8.3f%s %8.3f  %8.4f %9.0f %7.1f %8.0f  %lld / %lld / %lld\n", work.name.c_str(),
              aim, seconds, aim > 0.0 && seconds > aim ? "!" : " ", work.optimum, reader.reached(),
              blocks / cost, cost / std::max(1.0, knots) * 1e6, seconds / cost,
              static_cast<long long>(counts.released), static_cast<long long>(counts.outside),
              static_cast<long long>(counts.failed));
  std::fflush(stdout);
  return {work.name, aim, seconds, work.optimum};
}

}  // namespace

int main(int argc, char** argv) {
  const double full = 2.0 * std::numbers::pi;
  std::printf("%-30s %8s %8s  %8s  %8s %9s %7s %8s  %s\n", "seconds", "aim", "course", "optimum", "limits",
              "blocks/s", "us/knot", "x real", "released / outside / no law");
  std::vector<Times> times;
  times.push_back(row({"mill: circle R20, one arc", mill(), circle(20, 6000), 1.47, 1.461}));
  times.push_back(
      row({"mill: circle R20, 1000 blocks", mill(), polygon(20, 1000, full / 1000, 6000), 1.47, 1.461}));
  times.push_back(row({"mill: 100 mm in 1000 blocks", mill(), collinear(1000, 0.1, 6000), 1.21, 1.200}));
  times.push_back(row({"mill: 100 mm in one block", mill(), collinear(1, 100, 6000), 1.21, 1.200}));
  times.push_back(
      row({"fast: 5000 x 0.1 mm on R200", fast(), polygon(200, 5000, 0.1 / 200, 30000), 1.21, 1.191}));
  times.push_back(
      row({"mill: 5000 x 0.1 mm on R200", mill(), polygon(200, 5000, 0.1 / 200, 30000), 1.65, 1.614}));
  times.push_back(row({"mill: zigzag 1000 x 0.1 mm", mill(), zigzag(1000, 0.1, 6000), 36.5, 35.30}));
  times.push_back(row({"mill: random walk, 20 000", mill(), random_walk(20000, 6000), 105.0, 97.3}));
  times.push_back(row({"mill: surface in rows", mill(), surface_rows(6000), 0, 17.60}));
  times.push_back(row({"fast: surface in rows", fast(), surface_rows(6000), 0, 10.29}));
  times.push_back(row({"mill: trochoidal slot", mill(), trochoids(6000), 0, 14.03}));
  times.push_back(row({"fast: trochoidal slot", fast(), trochoids(6000), 0, 8.21}));
  times.push_back(row({"mill: engraving", mill(), engraving(6000), 0, 54.22}));
  times.push_back(row({"fast: engraving", fast(), engraving(6000), 0, 31.70}));
  times.push_back(row({"mill: thread helix", mill(), thread_helix(6000), 0, 6.290}));
  times.push_back(row({"fast: thread helix", fast(), thread_helix(6000), 0, 4.616}));
  times.push_back(row({"mill: impeller blade", mill(), impeller(6000), 0, 8.73}));
  times.push_back(row({"fast: impeller blade", fast(), impeller(6000), 0, 7.51}));
  row({"mill: pocket, 40 lines, F6000", mill(), pocket(6000), 0, 0});
  row({"mill: pocket, 40 lines, F1500", mill(), pocket(1500), 0, 0});
  if (argc > 1) draw(argv[1], times);
}
