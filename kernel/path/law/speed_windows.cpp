// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/speed_windows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/axes/transformation.hpp"
#include "kernel/path/law/judge.hpp"

namespace servogate::path {
namespace {

constexpr double kSlow = 0.04;  // b behind what is known: a fifth of the clock's speed
constexpr std::size_t kLeastWindow = 256, kFirstWindow = 64, kMargin = 20;
constexpr double kFeedShare = 0.9999;  // the feed is no limit of an axis and needs no reserve
constexpr double kLargestExcess = 1.0005;
constexpr double kFirst = 0.3, kFirstNear = 0.03;  // weights of the barrier to begin with
// How near to the optimum. The law of a first pass is only a clock, and a smoother one is the better clock.
constexpr double kGap = 0.01, kClockGap = 0.15;
constexpr int kRepairs = 6;
constexpr std::size_t kGlide = 24;
constexpr std::size_t kRest = 4;    // of the overlap: fewer knots behind a window belong to it
constexpr std::size_t kAhead = 48;  // knots behind a window that its slow end knows of
constexpr std::size_t kNear = 16,
                      kMean = 5;  // knots to each side: least of levels, and their mean, twice
constexpr double kLevelShare = 0.7;

}  // namespace

void SpeedWindows::clear(double step) {
  settings_.step = step;
  counts_ = {};
  done_ = false;
  from_ = leg_ = open_ = 0;
  made_ = 0;
  reckoned_ = -1;
  rest_.clear();
}

bool SpeedWindows::work(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
                        bool complete, Kept<double>& beta) {
  return !done_ && counts_.failed == 0 && window(run, places, controls, complete, beta);
}

/// Knots in which the fastest leg of the window comes to a stop.
std::size_t SpeedWindows::overlap(const Run& run, const Kept<double>& places, std::size_t to) const {
  double most = 0.0;
  for (std::size_t n = run.leg_at(places[from_], leg_); n < run.end() && run.leg(n).begin <= places[to];
       ++n) {
    double a = std::numeric_limits<double>::infinity(), j = a;
    for (std::size_t i = 0; i < static_cast<std::size_t>(settings_.axes); ++i) {
      if (!moves(run.leg(n), i)) continue;
      a = std::min(a, (*run.leg(n).limits)[i].acceleration);
      j = std::min(j, (*run.leg(n).limits)[i].jerk);
    }
    most = std::max(most, fastest(run.leg(n), settings_.axes) / a + a / j);
  }
  return static_cast<std::size_t>(most / settings_.step) + kMargin;
}

bool SpeedWindows::window(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
                          bool complete, Kept<double>& beta) {
  if (controls.end() < 4) return false;
  const std::size_t known = controls.end() - 3;  // intervals
  const std::size_t begun = kFirstWindow << std::min(made_, 8), near = from_ + std::min(kLeastWindow, begun);
  if (!complete && known < near + 1) return false;
  if (reckoned_ != made_) over_ = overlap(run, places, std::min(near, known));
  reckoned_ = made_;
  const std::size_t over = over_;
  const std::size_t size = std::min(std::max(4 * over, kLeastWindow), over + begun);
  std::size_t to = from_ + size;
  if (!complete && known < to + std::max(over / kRest, kAhead) + 1) return false;
  const bool last = complete && known < to + over / kRest;
  if (last) to = known;
  leg_ = run.leg_at(places[from_], leg_);
  const std::size_t ahead = std::min(known, to + kAhead);
  bounds(run, places, ahead, complete ? known : places.end() - 1);
  pack(controls, ahead);
  const std::size_t count = to - from_ + 2, commit = last ? count : to - from_ - over + 2;
  guess(count, to - from_);
  flies_in_ = from_ == 0 && run.begin_speed() > 0.0;
  flies_out_ = last && run.end_speed() > 0.0;
  problem_.first = kFirst;
  if (!(from_ == 0 && last && settings_.judged && near_clock())) {
    if (flies_in_) fly(false, kSlow);
    if (flies_out_) fly(true, kSlow);
  }
  problem_.fixed_head = from_ > 0 || run.begin_speed() > 0.0 ? 2 : 0;
  problem_.fixed_tail = last && run.end_speed() == 0.0 ? 0 : 2;
  solve(last, commit);
  if (counts_.failed > 0) return true;  // what is final before it stays
  ++made_;
  ++counts_.windows;
  counts_.steps += law_.steps();
  counts_.knot_steps += law_.steps() * static_cast<std::int64_t>(to - from_);
  for (std::size_t i = beta.end() - from_; i < commit; ++i) beta.push_back(problem_.beta[i]);
  done_ = last;
  rest_.assign(problem_.beta.begin() + static_cast<std::ptrdiff_t>(commit - 2), problem_.beta.end());
  if (last) return true;
  from_ = to - over;
  open_ = beta.end() - 2;
  return true;
}

const std::array<AxisLimits, kMaxAxes>* SpeedWindows::merged(const Run& run, std::size_t first,
                                                             std::size_t end) {
  const auto* one = run.leg(first).limits;
  bool same = true;
  for (std::size_t n = first; n < end; ++n) same = same && run.leg(n).limits == one;
  if (same) return one;
  std::array<AxisLimits, kMaxAxes> least = *one;
  for (std::size_t n = first; n < end; ++n) {
    for (std::size_t i = 0; i < kMaxAxes; ++i) {
      const AxisLimits& other = (*run.leg(n).limits)[i];
      least[i].velocity = std::min(least[i].velocity, other.velocity);
      least[i].acceleration = std::min(least[i].acceleration, other.acceleration);
      least[i].jerk = std::min(least[i].jerk, other.jerk);
    }
  }
  merged_.push_back(least);
  return &merged_.back();
}

/// At a knot the least of all legs holds that touch the intervals beside it.
void SpeedWindows::bounds(const Run& run, const Kept<double>& places, std::size_t to, std::size_t last) {
  bounds_.clear();
  merged_.clear();
  std::size_t leg = leg_;
  for (std::size_t k = from_; k <= to; ++k) {
    const double u = places[k], before = k > 0 ? places[k - 1] : 0.0, behind = places[std::min(k + 1, last)];
    leg = run.leg_at(u, leg);
    std::size_t first = leg, end = leg + 1;
    while (first > run.first() && run.leg(first).begin > before) --first;
    while (end < run.end() && run.leg(end).begin < behind) ++end;
    KnotBound bound;
    bound.feed = std::numeric_limits<double>::infinity();
    const Vector x = run.at(u, leg);
    for (std::size_t n = first; n < end; ++n) {
      bound.feed = std::min(bound.feed, kFeedShare * feed_at(run.leg(n), x, u));
      if (n > first) bound.feed = std::min(bound.feed, kFeedShare * run.leg(n).corner);
    }
    bound.limits = merged(run, first, end);
    bounds_.push_back(bound);
  }
}

/// The axes that move in this window.
void SpeedWindows::pack(const Kept<Vector>& controls, std::size_t to) {
  on_axes_.clear();
  const bool same = settings_.transformation == &identity();
  for (std::size_t i = from_; i < to + 3; ++i)
    on_axes_.push_back(same ? controls[i] : to_axes(*settings_.transformation, controls[i], settings_.axes));
  problem_.axes = 0;
  for (int a = 0; a < settings_.axes; ++a) {
    bool moves = problem_.axes == 0 && a + 1 == settings_.axes;
    for (std::size_t i = 1; i < on_axes_.size() && !moves; ++i) moves = on_axes_[i][a] != on_axes_[0][a];
    if (moves) problem_.axis[static_cast<std::size_t>(problem_.axes++)] = a;
  }
  controls_.clear();
  for (const Vector& control : on_axes_)
    for (std::size_t a = 0; a < static_cast<std::size_t>(problem_.axes); ++a)
      controls_.push_back(control[static_cast<std::size_t>(problem_.axis[a])]);
  problem_.step = settings_.step;
  problem_.controls = controls_;
  problem_.bounds = bounds_;
  problem_.share = 1.0 - settings_.reserve;
  problem_.gap = settings_.judged ? kGap : kClockGap;
}

/// What the window before had behind its committed end, and slowly on: a fifth
/// of the clock's speed, or less where a constant speed must be lower.
void SpeedWindows::guess(std::size_t count, std::size_t intervals) {
  law_.prepare(problem_);
  law_.flat_levels(levels_, slopes_, static_cast<int>(intervals));
  const std::size_t n = levels_.size();
  for (double& level : levels_) level = std::min(kSlow, kLevelShare * level);
  const auto around = [&](std::size_t i, std::size_t width, auto&& take) {
    const std::size_t from = i < width ? 0 : i - width, to = std::min(n - 1, i + width);
    for (std::size_t k = from; k <= to; ++k) take(levels_[k]);
    return static_cast<double>(to - from + 1);
  };
  calm_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    calm_[i] = kSlow;
    around(i, kNear, [&](double level) { calm_[i] = std::min(calm_[i], level); });
  }
  for (std::size_t i = 1; i < n; ++i) calm_[i] = std::min(calm_[i], calm_[i - 1] + slopes_[i]);
  for (std::size_t i = n - 1; i-- > 0;) calm_[i] = std::min(calm_[i], calm_[i + 1] + slopes_[i]);
  for (int pass = 0; pass < 2; ++pass) {
    levels_ = calm_;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0.0;
      const double all = around(i, kMean, [&](double level) { sum += level; });
      calm_[i] = sum / all;
    }
  }
  problem_.beta.resize(count);
  const std::size_t kept = std::min(rest_.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    const double own = calm_[std::min(i, n - 1)];
    if (i < kept) {
      problem_.beta[i] = rest_[i];
    } else if (kept == 0) {
      problem_.beta[i] = own;
    } else {
      const double z = std::min(1.0, static_cast<double>(i - kept + 1) / kGlide);
      const double glide = rest_[kept - 1] + z * z * (3.0 - 2.0 * z) * (own - rest_[kept - 1]);
      problem_.beta[i] = std::min(glide, problem_.beta[i - 1] + slopes_[std::min(i, n - 1)]);
    }
  }
}

/// The clock of the last pass is the time of a law, so that the one that is looked for is near it where the
/// whole run is in the window. False: a share of its speed breaks a limit.
bool SpeedWindows::near_clock() {
  constexpr double kShares[] = {0.85, 0.6};
  trial_.swap(problem_.beta);
  for (const double share : kShares) {
    problem_.beta.assign(trial_.size(), share);
    if (flies_in_) fly(false, share);
    if (flies_out_) fly(true, share);
    if (law_.worst(problem_.beta) < 1.0) {
      problem_.first = kFirstNear;
      return true;
    }
  }
  trial_.swap(problem_.beta);
  return false;
}

/// The clock's own speed at the begin or the end of a run, and a way from it to the slow guess with a share
/// of acceleration and jerk, as far as the window reaches.
void SpeedWindows::fly(bool end, double slow) {
  constexpr double kShare = 0.4, kSteepest = 1.5,
                   kMostBent = 6.0;  // of the step that goes with z^2 (3 - 2 z)
  const std::size_t n = problem_.beta.size(), axes = static_cast<std::size_t>(problem_.axes);
  const std::size_t at = end ? controls_.size() / axes - 2 : 1;  // the control at the knot
  double seconds = 0.0;                                          // of the clock
  for (std::size_t a = 0; a < axes; ++a) {
    const double v =
        std::abs(controls_[(at + 1) * axes + a] - controls_[(at - 1) * axes + a]) / (2.0 * settings_.step);
    const AxisLimits& limits = (*bounds_[end ? n - 2 : 0].limits)[static_cast<std::size_t>(problem_.axis[a])];
    seconds = std::max({seconds, kSteepest * v / (2.0 * kShare * limits.acceleration),
                        std::sqrt(kMostBent * v / (2.0 * kShare * limits.jerk))});
  }
  const double count = std::max(4.0, std::min(seconds / settings_.step, static_cast<double>(n)));
  for (std::size_t i = 0; i < n; ++i) {
    const double z = i < 2 ? 0.0 : (static_cast<double>(i) - 1.0) / count;
    if (z >= 1.0) break;
    double& beta = problem_.beta[end ? n - 1 - i : i];
    beta = std::max(beta, 1.0 - (1.0 - slow) * z * z * (3.0 - 2.0 * z));
  }
}

void SpeedWindows::solve(bool last, std::size_t commit) {
  if (!(law_.worst(problem_.beta) < 1.0)) {
    ++counts_.slowed;
    // What is left is seen by the judge, if this is the last pass.
    law_.approach(problem_, law_.as_they_are());
  }
  law_.solve(problem_);
  // The way on behind what is committed is where the next window begins.
  if (settings_.judged)
    mend(last ? problem_.beta.size() - 2 : std::min(problem_.beta.size() - 2, commit - 2 + kGlide));
}

/// The course between the places that the law looks at: where it exceeds a
/// limit, that limit is tightened.
void SpeedWindows::mend(std::size_t commit) {
  const auto exceeds = [](const Excess& e) { return e.most() > 1.0; };
  for (int round = 0; round < kRepairs; ++round) {
    judge(problem_, commit, excess_);
    if (std::none_of(excess_.begin(), excess_.end(), exceeds)) return;
    ++counts_.repaired;
    tighten(1.5 + round);
    law_.solve(problem_);
  }
  judge(problem_, commit, excess_);
  if (std::any_of(excess_.begin(), excess_.end(), [](const Excess& e) { return e.most() > kLargestExcess; }))
    ++counts_.failed;
}

/// What an interval exceeds counts for its neighbours too.
void SpeedWindows::tighten(double share) {
  const auto more = [share](double e) { return e > 1.0 ? share * (e - 1.0) + 1.0005 : 1.0; };
  const auto raise = [](std::vector<double>& places, std::size_t first, std::size_t end, double by) {
    for (std::size_t k = first; k < std::min(end, places.size()); ++k) places[k] = std::max(places[k], by);
  };
  Tightness wanted = law_.as_they_are();
  for (std::size_t k = 0; k < excess_.size(); ++k) {
    const Excess& e = excess_[k];
    const std::size_t before = k > 0 ? k - 1 : 0;
    raise(wanted.cap, k, k + 2, more(e.velocity) * more(e.velocity));
    raise(wanted.acceleration, 2 * k, 2 * k + 3, more(e.acceleration));
    raise(wanted.jerk, before, k + 2, more(e.jerk));
  }
  law_.approach(problem_, wanted);
}

}  // namespace servogate::path
