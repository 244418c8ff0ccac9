// SPDX-License-Identifier: Apache-2.0
#include "tests/program/cut_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>

#include "kernel/program/check/canon.hpp"

namespace servogate::program::tests {
namespace {

constexpr double kTolerance = 2e-3;  ///< mm: numbers of programs have three decimals
constexpr double kDegree = 0.017453292519943295;

void add_arc(std::vector<Way>& ways, const Arc& arc, Position from, int line) {
  const int parts = static_cast<int>(std::ceil(std::abs(arc.sweep_deg) * 2.0));
  const double x = from[arc.axis1] - arc.center1, y = from[arc.axis2] - arc.center2;
  for (int n = 1; n <= parts; ++n) {
    Position to = n == parts ? arc.to : from;
    const double angle = arc.sweep_deg * n / parts * kDegree;
    if (n < parts) {
      to[arc.axis1] = arc.center1 + x * std::cos(angle) - y * std::sin(angle);
      to[arc.axis2] = arc.center2 + x * std::sin(angle) + y * std::cos(angle);
    }
    ways.push_back({from, to, Way::Kind::cut, line});
    from = to;
  }
}

}  // namespace

std::vector<Way> ways_of(const std::string& dialect, const MachineModel& machine,
                         const std::string& program) {
  std::vector<Way> ways;
  Interpreter run(dialect, machine, {}, "p.nc", program, {}, Position{});
  Position at{};
  const auto take = [&](const Command& command) {
    Way way{at, at, Way::Kind::cut, command.line};
    if (const auto* rapid = std::get_if<Rapid>(&command.what)) {
      way.to = rapid->to;
      way.kind = Way::Kind::rapid;
    } else if (const auto* line = std::get_if<Line>(&command.what)) {
      way.to = line->to;
    } else if (const auto* thread = std::get_if<Thread>(&command.what)) {
      way.to = thread->to;
      way.kind = Way::Kind::thread;
    } else if (const auto* arc = std::get_if<Arc>(&command.what)) {
      add_arc(ways, *arc, at, command.line);
      at = arc->to;
      return true;
    } else {
      return true;
    }
    ways.push_back(way);
    at = way.to;
    return true;
  };
  if (const auto error = run_dry(run, take, 1'000'000)) ADD_FAILURE() << error->str() << "\n" << program;
  if (!ways.empty()) ways.erase(ways.begin());
  return ways;
}

MachineModel machine_of(const std::string& letters, bool turns, double travel) {
  MachineModel machine;
  for (const char letter : letters) {
    MachineModel::Axis axis;
    axis.letter = std::string(1, letter);
    axis.diameter = turns && letter == 'X';
    axis.travel_min = -travel;
    axis.travel_max = travel;
    axis.rapid = 500.0;
    machine.axes.push_back(axis);
  }
  machine.kind = turns ? MachineModel::Kind::turning : MachineModel::Kind::milling;
  return machine;
}

std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

std::vector<Stroke> strokes(const std::vector<Way>& ways, std::size_t along, std::size_t out) {
  std::vector<Stroke> all;
  for (const Way& w : ways)
    all.push_back({w.from[along], w.from[out], w.to[along], w.to[out], w.kind != Way::Kind::rapid});
  return all;
}

Outline Outline::shifted(double along, double out) const {
  Outline moved = *this;
  for (auto& [a, r] : moved.points_) a += along, r += out;
  return moved;
}

double Outline::first() const { return std::min(points_.front().first, points_.back().first); }
double Outline::last() const { return std::max(points_.front().first, points_.back().first); }

double Outline::extreme(double a, double near, bool highest) const {
  double found = highest ? -1e9 : 1e9;
  const auto take = [&](double r) { found = highest ? std::max(found, r) : std::min(found, r); };
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const auto& p = points_[i - 1].first <= points_[i].first ? points_[i - 1] : points_[i];
    const auto& q = points_[i - 1].first <= points_[i].first ? points_[i] : points_[i - 1];
    if (a < p.first - near || a > q.first + near) continue;
    if (q.first - p.first < 2.0 * near) {
      take(p.second), take(q.second);
      continue;
    }
    for (const double place : {a - near, a, a + near})
      take(p.second + (q.second - p.second) * std::clamp((place - p.first) / (q.first - p.first), 0.0, 1.0));
  }
  return found;
}

Stock::Stock(double from, double to, const std::function<double(double)>& blank) : from_(from) {
  for (double a = from; a <= to; a += kGrid) heights_.push_back(blank(a));
}

double Stock::height(double a) const {
  const auto n = std::llround((a - from_) / kGrid);
  return heights_[static_cast<std::size_t>(
      std::clamp<long long>(n, 0, static_cast<long long>(heights_.size()) - 1))];
}

std::string Stock::take(const Stroke& s, const std::function<double(double)>& floor) {
  const double low = std::min(s.a0, s.a1), high = std::max(s.a0, s.a1);
  for (std::size_t n = 0; n < heights_.size(); ++n) {
    const double a = place(n);
    if (a < low - 1e-6 || a > high + 1e-6) continue;
    const bool upright = high - low < 1e-9;
    const double r = upright ? std::min(s.r0, s.r1) : s.r0 + (a - s.a0) / (s.a1 - s.a0) * (s.r1 - s.r0);
    const std::string place = " at " + digits(a) + ", " + digits(r);
    if (!s.cuts && r < heights_[n] - kTolerance) return "at rapid through material" + place;
    if (!s.cuts) continue;
    if (const double least = floor(a); least < 1e8 && r < least - kTolerance)
      return "a gouge" + place + ", under " + digits(least);
    heights_[n] = std::min(heights_[n], r);
  }
  return {};
}

std::string Holes::take(const Stroke& s) {
  const std::string place = " at " + digits(s.a1) + ", " + digits(s.r1);
  const double across = std::abs(s.a1 - s.a0);
  const auto bottom = [this](double a) {
    const auto found = bottoms_.find(std::llround(a * 1e4));
    return found == bottoms_.end() ? surface_ : found->second;
  };
  if (across > 1e-6) {
    if (std::min(s.r0, s.r1) < surface_ - kTolerance && across > relief_ + kTolerance)
      return "across below the surface" + place;
    return {};
  }
  if (s.r1 >= bottom(s.a1) - 1e-6) return {};
  if (!s.cuts) return "at rapid into material" + place;
  if (bottom(s.a1) - s.r1 > step_ + kTolerance) return "more than a step" + place;
  bottoms_[std::llround(s.a1 * 1e4)] = s.r1;
  return {};
}

std::map<double, double> Holes::bottoms() const {
  std::map<double, double> found;
  for (const auto& [place, depth] : bottoms_) found[static_cast<double>(place) / 1e4] = depth;
  return found;
}

}  // namespace servogate::program::tests
