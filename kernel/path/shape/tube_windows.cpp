// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/tube_windows.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr std::size_t kWindow = 256, kFirstWindow = 64, kOverlap = 32;
constexpr double kSame = 1e-9;                         // mm: vertices closer than that are one
constexpr double kSlideFrom = 0.9, kMostSlide = 0.02;  // of the tolerance; mm
constexpr double kTurn = 0.3, kMostTurns = 64.0;  // rad of an arc between two sites; parts of an interval
constexpr double kMostNarrowed = 0.3;             // of a radius, by what the curve may bulge between sites

}  // namespace

void TubeWindows::clear(double step) {
  settings_.step = step;
  counts_ = {};
  done_ = false;
  from_ = leg_ = 0;
  made_ = 0;
  blend_.clear();
}

bool TubeWindows::work(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
                       Kept<Vector>& controls) {
  return !done_ && window(run, places, complete, start, controls);
}

bool TubeWindows::window(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
                         Kept<Vector>& controls) {
  if (places.end() < 2) return false;
  const std::size_t known = places.end() - 1, size = std::min(kWindow, kFirstWindow << std::min(made_, 8));
  std::size_t to = from_ + size;
  if (known < to + kOverlap + 1 && !complete) return false;
  const bool last = complete && known < to + kOverlap;
  if (last) to = known;
  guess(run, places, complete, start, controls, to);
  leg_ = run.leg_at(places[from_], leg_);
  const std::size_t intervals = to - from_;
  sites(run, places, from_ == 0 ? 2 : from_, last ? to - 1 : to);
  TubeSolution solution = solve(run, places, intervals, last);
  if (solution.released > 0 && !settings_.first)
    solution = solve_on_path(run, places, intervals, last, solution);
  ++made_;
  ++counts_.windows;
  counts_.steps += solution.steps;
  counts_.knot_steps += solution.steps * static_cast<std::int64_t>(intervals);
  std::vector<Vector>& c = guess_;
  blend_ = guess_;
  for (std::size_t i = 0; i < c.size(); ++i)
    for (int a = 0; a < problem_.axes; ++a)
      c[i][axis_[a]] =
          problem_.controls[i * static_cast<std::size_t>(problem_.axes) + static_cast<std::size_t>(a)];
  if (solution.released > 0) count_outside(run, places);
  const std::size_t commit = last ? c.size() : intervals - kOverlap + 3;
  for (std::size_t i = controls.end() - from_; i < commit; ++i) controls.push_back(c[i]);
  if (last) {
    done_ = true;
    return true;
  }
  // Behind what is committed the solution goes over into the guess.
  for (std::size_t i = commit; i < c.size(); ++i) {
    const double f = std::min(1.0, static_cast<double>(i - commit + 1) / (kOverlap - 2)),
                 s = f * f * (3.0 - 2.0 * f);
    for (int a = 0; a < settings_.axes; ++a) blend_[i][a] = c[i][a] + s * (blend_[i][a] - c[i][a]);
  }
  blend_.erase(blend_.begin(), blend_.begin() + static_cast<std::ptrdiff_t>(intervals - kOverlap));
  from_ = to - kOverlap;
  return true;
}

TubeSolution TubeWindows::solve(const Run& run, const Kept<double>& places, std::size_t intervals,
                                bool last) {
  if (!settings_.first) narrow(run, places);
  pack(intervals, 3, last ? 3 : 0);
  limits_of_jerk(run, places, intervals);
  return tube_.solve(problem_);
}

/// From a start on the programmed path; the better one of both stays.
TubeSolution TubeWindows::solve_on_path(const Run& run, const Kept<double>& places, std::size_t intervals,
                                        bool last, const TubeSolution& before) {
  const std::vector<Vector> guess = guess_;
  const TubeProblem found = problem_;
  const std::array<int, kMaxAxes> axis = axis_;
  std::size_t leg = leg_;
  for (std::size_t i = 3; i < (last ? intervals : intervals + 3); ++i) {
    const double u = places[std::min(from_ + i - 1, places.end() - 1)];
    leg = run.leg_at(u, leg);
    guess_[i] = run.at(u, leg);
  }
  TubeSolution solution = solve(run, places, intervals, last);
  solution.steps += before.steps;
  if (solution.released < before.released) return solution;
  problem_ = found;
  axis_ = axis;
  guess_ = guess;
  solution.released = before.released;
  return solution;
}

/// Released sites whose places on curve and path are too far from the other one, whatever the pairing.
void TubeWindows::count_outside(const Run& run, const Kept<double>& places) {
  constexpr int kPlaces = 16;  // of an interval
  for (std::size_t n = 0; n < sites_.size(); ++n) {
    if (!(problem_.sites[n].limit > 1.0)) continue;
    const Site& s = sites_[n];
    const auto k = static_cast<std::size_t>(s.interval);
    const auto distance = [&](const Vector& p, const Vector& q) {
      double sum = 0.0;
      for (int a = 0; a < settings_.axes; ++a) sum += (p[a] - q[a]) * (p[a] - q[a]);
      return std::sqrt(sum);
    };
    const auto to_chord = [&](const Vector& p, const Vector& from, const Vector& to) {
      double along = 0.0, square = 1e-30;
      for (int a = 0; a < settings_.axes; ++a) {
        along += (p[a] - from[a]) * (to[a] - from[a]);
        square += (to[a] - from[a]) * (to[a] - from[a]);
      }
      Vector foot = from;
      for (int a = 0; a < settings_.axes; ++a)
        foot[a] += std::clamp(along / square, 0.0, 1.0) * (to[a] - from[a]);
      return distance(p, foot);
    };
    const auto curve = [&](std::size_t interval, double share) {
      const auto w = spline_weights(share);
      Vector x{};
      for (int a = 0; a < settings_.axes; ++a)
        for (std::size_t q = 0; q < 4; ++q) x[a] += w[q] * guess_[interval + q][a];
      return x;
    };
    const Vector x = curve(k, s.share);
    const double u = site_places_[n], reach = 4.0 * s.pull + places[from_ + k + 1] - places[from_ + k];
    const double near = run.downhill(x, u, reach, site_legs_[n]);
    const double there = distance(x, run.at(near, site_legs_[n]));
    double back = distance(x, s.at);
    for (std::size_t i = k > 0 ? k - 1 : k; i < std::min(k + 2, guess_.size() - 3); ++i)
      for (int q = 0; q < kPlaces; ++q)
        back = std::min(back,
                        to_chord(s.at, curve(i, q / double{kPlaces}), curve(i, (q + 1) / double{kPlaces})));
    if (std::max(there, back) > s.radius / settings_.share) ++counts_.outside;
    ++counts_.released;
  }
}

void TubeWindows::guess(const Run& run, const Kept<double>& places, bool complete, const Kept<Vector>& start,
                        const Kept<Vector>& controls, std::size_t to) {
  const std::size_t last = places.end() - 1;
  guess_.clear();
  std::size_t leg = leg_;
  for (std::size_t i = from_; i < to + 3; ++i) {
    const std::size_t k = i - from_;
    if (i < controls.end()) {
      guess_.push_back(controls[i]);
    } else if (k < blend_.size()) {
      guess_.push_back(blend_[k]);
    } else if (i < 3 || (complete && i >= last)) {
      guess_.push_back(
          at_end(run, i < 3, static_cast<double>(i) - (i < 3 ? 1.0 : static_cast<double>(last + 1))));
    } else if (!settings_.first) {
      guess_.push_back(start[i]);
    } else {
      leg = run.leg_at(places[i - 1], leg);
      guess_.push_back(run.at(places[i - 1], leg));
    }
  }
}

/// Controls at the begin or the end of a run: all alike at rest, else in even steps along the leg, `n` from
/// the one at the very end.
Vector TubeWindows::at_end(const Run& run, bool begin, double n) const {
  const Leg& leg = run.leg(begin ? run.first() : run.end() - 1);
  const double s = begin ? 0.0 : leg.piece.length, speed = begin ? run.begin_speed() : run.end_speed();
  if (speed == 0.0) return position(leg.piece, s, settings_.axes);
  const double spacing = settings_.step * speed;
  return spline_control(leg.piece, s + n * spacing, spacing, settings_.axes);
}

void TubeWindows::site(const Run& run, std::size_t leg, double u, std::size_t interval, double share) {
  Site s;
  s.interval = static_cast<std::int32_t>(interval - from_);
  s.share = share;
  s.at = run.at(u, leg);
  s.radius = settings_.share * run.radius(u, leg);
  if (u <= run.leg(leg).begin && leg > run.first())
    s.radius = std::min(s.radius, settings_.share * run.leg(leg - 1).tolerance);
  s.pull = run.leg(leg).tolerance;
  if (s.radius < kSlideFrom * s.pull) slide(run.leg(leg), u, s);
  sites_.push_back(s);
  site_legs_.push_back(leg);
  site_places_.push_back(u);
}

/// In a tube that is narrower than the tolerance a place may be ahead or behind.
void TubeWindows::slide(const Leg& leg, double u, Site& s) const {
  const Vector d1 = evaluate(leg.piece, std::clamp(u - leg.begin, 0.0, leg.piece.length), settings_.axes).d1;
  const double length = norm(d1, settings_.axes);
  for (int a = 0; a < settings_.axes; ++a) s.along[a] = d1[a] / length;
  s.slide = std::max(s.radius, std::min(settings_.share * s.pull, kMostSlide));
}

/// Sites between `from` and `to` of an arc that turns much in an interval; true: there are some.
bool TubeWindows::inside_arc(const Run& run, std::size_t leg, double from, double to, std::size_t k,
                             double u0, double u1) {
  const Piece& piece = run.leg(leg).piece;
  if (piece.shape != Piece::Shape::arc) return false;
  const double turn = std::abs(piece.omega) * (to - from);
  const int parts = static_cast<int>(std::min(kMostTurns, std::ceil(turn / kTurn)));
  for (int i = 1; i < parts; ++i) {
    const double u = from + (to - from) * i / parts;
    site(run, leg, u, k, (u - u0) / (u1 - u0));
  }
  return parts > 1;
}

/// At each knot, each vertex, and in the middle of an interval without a vertex near it.
void TubeWindows::sites(const Run& run, const Kept<double>& places, std::size_t first, std::size_t end) {
  sites_.clear();
  site_legs_.clear();
  site_places_.clear();
  std::size_t leg = run.leg_at(places[first], leg_);
  for (std::size_t k = first; k < end; ++k) {
    const double u0 = places[k], u1 = places[k + 1];
    leg = run.leg_at(u0, leg);
    site(run, leg, u0, k, 0.0);
    bool near_middle = inside_arc(run, leg, u0, std::min(u1, run.leg(leg).end()), k, u0, u1);
    double at = u0;
    for (std::size_t n = leg + 1; n < run.end() && run.leg(n).begin < u1; ++n) {
      const double u = run.leg(n).begin;
      if (u < at + kSame) continue;
      at = u;
      const double share = (u - u0) / (u1 - u0);
      near_middle = near_middle || std::abs(share - 0.5) < 0.2;
      site(run, n, u, k, share);
      near_middle = inside_arc(run, n, u, std::min(u1, run.leg(n).end()), k, u0, u1) || near_middle;
    }
    if (near_middle) continue;
    const double u = 0.5 * (u0 + u1);
    site(run, run.leg_at(u, leg), u, k, 0.5);
  }
}

/// Between sites the curve may bulge: by the square of their spacing and its second derivative, less that of
/// the programmed path, and across it.
void TubeWindows::narrow(const Run& run, const Kept<double>& places) {
  const auto along = [&](std::size_t n) { return sites_[n].interval + sites_[n].share; };
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    Site& s = sites_[i];
    double gap = 0.5;
    if (i > 0) gap = std::max(gap, along(i) - along(i - 1));
    if (i + 1 < sites_.size()) gap = std::max(gap, along(i + 1) - along(i));
    gap = std::min(gap, 1.0);
    const bool inside = i > 0 && i + 1 < sites_.size() && site_legs_[i - 1] == site_legs_[i] &&
                        site_legs_[i + 1] == site_legs_[i];
    double most = bulge(run, places, i, site_legs_[i], inside);
    if (i > 0 && site_legs_[i - 1] != site_legs_[i])  // which the curve comes along before a vertex
      most = std::max(most, bulge(run, places, i, site_legs_[i - 1], false));
    const double share = 1.0 - std::min(kMostNarrowed, gap * gap / 8.0 * most / s.radius);
    s.limit = share * share;
  }
}

/// Second difference of the guess near a site, less that of a leg of the programmed path; `across`: without
/// its part along it.
double TubeWindows::bulge(const Run& run, const Kept<double>& places, std::size_t i, std::size_t number,
                          bool across) const {
  const auto k = static_cast<std::size_t>(sites_[i].interval);
  const Leg& leg = run.leg(number);
  const double s = std::clamp(site_places_[i] - leg.begin, 0.0, leg.piece.length);
  const double du = places[from_ + k + 1] - places[from_ + k];
  const PathPoint p = evaluate(leg.piece, s, settings_.axes);
  double most = 0.0;
  for (std::size_t j = k; j < k + 2; ++j) {
    double square = 0.0, along = 0.0, unit = 0.0;
    for (int a = 0; a < settings_.axes; ++a) {
      const double d = guess_[j][a] - 2.0 * guess_[j + 1][a] + guess_[j + 2][a] - p.d2[a] * du * du;
      square += d * d;
      along += d * p.d1[a];
      unit += p.d1[a] * p.d1[a];
    }
    if (across) square -= along * along / unit;
    most = std::max(most, square);
  }
  return std::sqrt(most);
}

/// The problem of the axes that move in this window.
void TubeWindows::pack(std::size_t intervals, std::size_t head, std::size_t tail) {
  int axes = 0;
  for (int a = 0; a < settings_.axes; ++a) {
    const double still = guess_[0][a];
    const bool moves =
        std::any_of(guess_.begin(), guess_.end(), [&](const Vector& c) { return c[a] != still; }) ||
        std::any_of(sites_.begin(), sites_.end(), [&](const Site& s) { return s.at[a] != still; });
    if (moves || (axes == 0 && a + 1 == settings_.axes)) axis_[axes++] = a;
  }
  problem_.axes = axes;
  problem_.first = head;
  problem_.last = intervals + 2 - tail;
  problem_.flat = !settings_.first;
  problem_.controls.clear();
  for (const Vector& c : guess_)
    for (int a = 0; a < axes; ++a) problem_.controls.push_back(c[axis_[a]]);
  problem_.sites = sites_;
  for (Site& s : problem_.sites) {
    const Vector at = s.at, along = s.along;
    double offset = 0.0, ahead = 0.0;
    const auto w = spline_weights(s.share);
    for (int a = 0; a < axes; ++a) {
      const auto i = static_cast<std::size_t>(s.interval);
      s.at[a] = at[axis_[a]];
      s.along[a] = along[axis_[a]];
      double x = -s.at[a];
      for (std::size_t q = 0; q < 4; ++q) x += w[q] * guess_[i + q][axis_[a]];
      offset += x * x;
      ahead += x * s.along[a];
    }
    offset /= s.radius * s.radius;
    if (s.slide > 0.0) offset += ahead * ahead * (1.0 / (s.slide * s.slide) - 1.0 / (s.radius * s.radius));
    // Nothing can move a site of committed controls.
    if (from_ > 0 && s.interval == 0 && s.share == 0.0) s.limit = std::max(s.limit, 1.001 * offset);
  }
}

void TubeWindows::limits_of_jerk(const Run& run, const Kept<double>& places, std::size_t intervals) {
  const double cube = settings_.step * settings_.step * settings_.step;
  problem_.jerk.clear();
  std::size_t leg = leg_;
  for (std::size_t k = 0; k < intervals; ++k) {
    leg = run.leg_at(0.5 * (places[from_ + k] + places[from_ + k + 1]), leg);
    const auto& limits = *run.leg(leg).limits;
    for (int a = 0; a < problem_.axes; ++a)
      problem_.jerk.push_back(limits[static_cast<std::size_t>(axis_[a])].jerk * cube);
  }
}

}  // namespace servogate::path
