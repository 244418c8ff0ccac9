// SPDX-License-Identifier: Apache-2.0
// Draws docs/pictures/tolerance.svg, jerk.svg and reserve.svg: what the planner and the follower of the
// product do with a machine of these limits. bench_path_pictures FOLDER
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "bench/path/works.hpp"
#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"

namespace {

using namespace servogate;
using namespace servogate::bench;

struct Point {
  double x, y;
};
struct Curve {
  std::string name;
  std::vector<Point> points;
};

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", v);
  return text;
}

constexpr const char* kColours[] = {"#1f6fb2", "#c0392b", "#2e8b57", "#7d5ba6"};
constexpr double kWidth = 360, kHeight = 250, kLeft = 58, kRight = 12, kTop = 14, kBottom = 40;

/// One diagram of curves within given bounds.
class Panel {
 public:
  Panel(double at, Point low, Point high, std::string x, std::string y)
      : at_(at), low_(low), high_(high), x_(std::move(x)), y_(std::move(y)) {}
  void draw(std::ostream& out, const std::vector<Curve>& curves, double legend_x, double legend_y) const {
    const double right = at_ + kWidth - kRight, bottom = kHeight - kBottom, left = at_ + kLeft;
    out << "<rect x=\"" << left << "\" y=\"" << kTop << "\" width=\"" << right - left << "\" height=\""
        << bottom - kTop << "\" fill=\"none\" stroke=\"#999\"/>\n";
    for (int n = 0; n <= 4; ++n) {
      const double x = low_.x + (high_.x - low_.x) * n / 4, y = low_.y + (high_.y - low_.y) * n / 4;
      text(out, place(x), bottom + 15, number(x), "middle");
      text(out, left - 5, height(y) + 4, number(y), "end");
    }
    text(out, 0.5 * (left + right), kHeight - 6, x_, "middle");
    out << "<text transform=\"translate(" << at_ + 13 << ',' << 0.5 * (kTop + bottom)
        << ") rotate(-90)\" text-anchor=\"middle\">" << y_ << "</text>\n";
    std::size_t n = 0;
    for (const Curve& c : curves) {
      const char* colour = c.name.empty() ? "#999" : kColours[n % std::size(kColours)];
      out << "<polyline fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"1.5\" points=\"";
      for (const Point& p : c.points)
        if (p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y)
          out << number(place(p.x)) << ',' << number(height(p.y)) << ' ';
      out << "\"/>\n";
      if (c.name.empty()) continue;
      const double y = kTop + legend_y + 15.0 * static_cast<double>(n++);
      out << "<path d=\"M" << left + legend_x << ' ' << y << "h16\" stroke=\"" << colour
          << "\" stroke-width=\"2\"/>\n";
      text(out, left + legend_x + 21, y + 4, c.name, "start");
    }
  }

 private:
  double place(double x) const {
    return at_ + kLeft + (x - low_.x) / (high_.x - low_.x) * (kWidth - kLeft - kRight);
  }
  double height(double y) const {
    return kHeight - kBottom - (y - low_.y) / (high_.y - low_.y) * (kHeight - kTop - kBottom);
  }
  static void text(std::ostream& out, double x, double y, const std::string& words, const char* anchor) {
    out << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" text-anchor=\"" << anchor << "\">"
        << words << "</text>\n";
  }
  double at_;
  Point low_, high_;
  std::string x_, y_;
};

class Picture {
 public:
  explicit Picture(const std::string& file) : out_(file) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << 2 * kWidth << ' ' << kHeight
         << "\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#333\">\n<rect width=\"" << 2 * kWidth
         << "\" height=\"" << kHeight << "\" fill=\"white\"/>\n";
  }
  ~Picture() { out_ << "</svg>\n"; }
  std::ostream& out() { return out_; }

 private:
  std::ofstream out_;
};

/// Set-points of a program, each cycle; held from `hold` on, s.
std::vector<path::Sample> driven(const path::Config& config, const Program& program, double hold = 1e9) {
  path::Track track(config);
  path::Planner planner(config, track);
  path::Follower follower(config, track);
  planner.restart({});
  for (const path::Element& e : program) planner.add(e);
  planner.finish();
  std::vector<path::Sample> out;
  for (int n = 0; n < 100000; ++n) {
    if (n * config.period_s >= hold) follower.hold();
    planner.work();
    out.push_back(follower.step(track.visible()));
    const auto state = out.back().state;
    if (state == path::FollowerState::held || (n > 10 && state == path::FollowerState::idle)) break;
  }
  return out;
}

std::vector<Point> over_time(const std::vector<path::Sample>& samples, double (*value)(const path::Sample&)) {
  std::vector<Point> points;
  for (std::size_t n = 0; n < samples.size(); n += 4)
    points.push_back({0.001 * static_cast<double>(n), value(samples[n])});
  return points;
}

double feed(const path::Sample& s) { return s.feed; }
double along_x(const path::Sample& s) { return s.acceleration[0]; }

path::Element line(double x, double y, double mm_s, double tolerance) {
  path::Element e;
  e.to = {x, y, 0};
  e.feed = mm_s;
  e.transition.continuation = path::Continuation::continuous;
  e.transition.tolerance = tolerance;
  return e;
}

/// A right angle, near its corner.
void tolerance(const std::string& folder) {
  Picture picture(folder + "/tolerance.svg");
  std::vector<Curve> paths{{"", {{9.7, 0}, {10, 0}, {10, 0.3}}}}, speeds;
  for (const double d : {0.01, 0.05, 0.2}) {
    path::Config config = mill();
    const auto samples = driven(config, {line(10, 0, 50, d), line(10, 10, 50, d)});
    Curve c{number(d) + " mm", {}};
    for (const path::Sample& s : samples) c.points.push_back({s.position[0], s.position[1]});
    paths.push_back(c);
    speeds.push_back({number(d) + " mm", over_time(samples, feed)});
  }
  Panel(0, {9.6, -0.1}, {10.1, 0.4}, "X, mm", "Y, mm").draw(picture.out(), paths, 10, 14);
  Panel(kWidth, {0, 0}, {0.8, 60}, "s", "mm/s").draw(picture.out(), speeds, 150, 14);
}

/// 30 mm in blocks of 1 mm.
void jerk(const std::string& folder) {
  Picture picture(folder + "/jerk.svg");
  std::vector<Curve> speeds, accelerations;
  for (const double j : {3000.0, 10000.0, 50000.0}) {
    const auto samples = driven(machine(1000, j), collinear(30, 1, 6000));
    speeds.push_back({number(j) + " mm/s3", over_time(samples, feed)});
    accelerations.push_back({number(j) + " mm/s3", over_time(samples, along_x)});
  }
  Panel(0, {0, 0}, {1, 120}, "s", "mm/s").draw(picture.out(), speeds, 180, 14);
  Panel(kWidth, {0, -1200}, {1, 1200}, "s", "mm/s2").draw(picture.out(), accelerations, 180, 14);
}

/// A hold on a circle that needs all of the acceleration, and what the circle takes.
void reserve(const std::string& folder) {
  Picture picture(folder + "/reserve.svg");
  std::vector<Curve> holds, circles;
  for (const double share : {0.002, 0.01, 0.05, 0.2}) {
    path::Config config = mill();
    config.reserve = share;
    const Program circle = polygon(9.5, 1200, 0.01, 6000);
    const std::string name = number(100 * share) + " %";
    holds.push_back({name, over_time(driven(config, circle, 0.5), feed)});
    circles.push_back({name, over_time(driven(config, circle), feed)});
  }
  Panel(0, {0, 0}, {1.6, 120}, "s", "mm/s").draw(picture.out(), circles, 100, 60);
  Panel(kWidth, {0.4, 0}, {1.6, 120}, "s", "mm/s").draw(picture.out(), holds, 190, 14);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : ".";
  tolerance(folder);
  jerk(folder);
  reserve(folder);
  return std::ofstream(folder + "/reserve.svg", std::ios::app) ? 0 : 1;
}
