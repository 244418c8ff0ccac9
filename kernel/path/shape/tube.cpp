// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/tube.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/path/shape/band.hpp"

namespace servogate::path {
namespace {

constexpr double kCentring = 0.02;     // weight of squared offsets, which keeps arcs near the programmed path
constexpr double kSquareShare = 0.05;  // of the square beside the eighth power
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kDifference[4] = {-1.0, 3.0, -3.0, 1.0};

// Barrier: first weight as a share of objective by sites, factor, last weight, decrement whose step is the
// last.
constexpr double kFirst = 0.05, kFactor = 0.12, kGap = 0.3;
constexpr double kDecrement = 0.15, kClockDecrement = 0.5, kDecrementOutside = 0.003;
constexpr int kRounds = 40, kSteps = 12, kStepsOutside = 4, kPatience = 14;

/// The sum of logarithms, most of it as products.
class LogSum {
 public:
  void add(double factor) {
    product_ *= factor;
    if (product_ < 1e-100 || product_ > 1e100) {
      sum_ += std::log(product_);
      product_ = 1.0;
    }
  }
  double value() const { return sum_ + std::log(product_); }

 private:
  double product_ = 1.0, sum_ = 0.0;
};

template <int A>
class SolverOf final : public Tube::Solver {
 public:
  TubeSolution solve(TubeProblem& problem) override;

 private:
  using Point = std::array<double, A>;
  struct Place {
    std::size_t interval;
    std::array<double, 4> weight;
    double scale, pull;
    double limit;  // square of the offset that is allowed now
    double slide;  // what the scale has more along a direction, 0: all directions alike
  };

  void take(const TubeProblem& problem);
  void look();  // at `controls_`
  void look_along();
  double objective(double t) const;
  double cost(double t, double mu) const;
  void derive(double mu);
  void derive_jerk();
  void derive_site(std::size_t k, double mu);
  template <class Block, std::size_t... Axis>
  void derive_axes(const Place& s, const Block& block, std::index_sequence<Axis...> /*axes*/) {
    (derive_axis<Axis>(s, block), ...);
  }
  /// By axis `Own` of each control: its row of all controls, which a column takes from its own place on. All
  /// lengths are known to the compiler.
  template <std::size_t Own, class Block>
  void derive_axis(const Place& s, const Block& block) {
    std::array<double, 4 * A> row;
    for (std::size_t b = 0; b < A; ++b) {
      const double by = block(Own, b);
      for (std::size_t r = 0; r < 4; ++r) row[r * A + b] = s.weight[r] * by;
    }
    auto* columns = &hessian_[s.interval * A];
    add<Own>(s.weight[0], row, columns);
    add<A + Own>(s.weight[1], row, columns);
    add<2 * A + Own>(s.weight[2], row, columns);
    add<3 * A + Own>(s.weight[3], row, columns);
  }
  template <std::size_t Own>
  static void add(double weight, const std::array<double, 4 * A>& row,
                  typename Band<4 * A>::Column* columns) {
    for (std::size_t i = Own; i < 4 * A; ++i) columns[Own][i - Own] += weight * row[i];
  }
  /// Distance to offset.
  void scale(std::size_t k, Point& e) const;
  double direction();
  void centre(double mu, double decrement, int most);
  bool shrink(double& before, double& after);
  bool release_outer(bool all);
  double offset2(std::size_t k) const {
    double sum = 0.0;
    for (int a = 0; a < A; ++a) sum += offset_[k][a] * offset_[k][a];
    return sum;
  }

  TubeProblem* problem_ = nullptr;
  std::size_t count_ = 0, intervals_ = 0;
  std::vector<double> controls_, gradient_, step_;
  std::vector<double> scale_;             // 1 / jerk
  std::vector<double> jerk_, jerk_step_;  // third differences, and those of the step
  std::vector<Place> places_;
  std::vector<Point> target_, offset_, offset_step_, along_;
  Band<4 * A> hessian_;
  bool flat_ = false;
  int steps_ = 0;
};

template <int A>
void SolverOf<A>::take(const TubeProblem& p) {
  count_ = p.count();
  intervals_ = count_ - 3;
  flat_ = p.flat;
  controls_ = p.controls;
  scale_.resize(intervals_ * A);
  for (std::size_t i = 0; i < scale_.size(); ++i) scale_[i] = 1.0 / p.jerk[i];
  places_.resize(p.sites.size());
  target_.resize(p.sites.size());
  along_.resize(p.sites.size());
  for (std::size_t k = 0; k < p.sites.size(); ++k) {
    const Site& s = p.sites[k];
    places_[k] = {static_cast<std::size_t>(s.interval),
                  spline_weights(s.share),
                  1.0 / s.radius,
                  kCentring * (s.radius / s.pull) * (s.radius / s.pull),
                  s.limit,
                  s.slide > 0.0 ? 1.0 / s.slide - 1.0 / s.radius : 0.0};
    for (int a = 0; a < A; ++a) {
      target_[k][a] = s.at[a];
      along_[k][a] = s.along[a];
    }
  }
  jerk_.resize(intervals_ * A);
  jerk_step_.resize(intervals_ * A);
  offset_.resize(places_.size());
  offset_step_.resize(places_.size());
  step_.assign((count_ + 4) * A, 0.0);
}

template <int A>
void SolverOf<A>::scale(std::size_t k, Point& e) const {
  const Place& s = places_[k];
  double more = 0.0;
  if (s.slide != 0.0) {
    for (int a = 0; a < A; ++a) more += e[a] * along_[k][a];
    more *= s.slide;
  }
  for (int a = 0; a < A; ++a) e[a] = e[a] * s.scale + more * along_[k][a];
}

template <int A>
void SolverOf<A>::look() {
  for (std::size_t i = 0; i < intervals_ * A; ++i) {
    const double* c = &controls_[i];
    jerk_[i] = (c[3 * A] - c[0] + 3.0 * (c[A] - c[2 * A])) * scale_[i];
  }
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Place& s = places_[k];
    const double* c = &controls_[s.interval * A];
    for (int a = 0; a < A; ++a)
      offset_[k][a] = s.weight[0] * c[a] + s.weight[1] * c[A + a] + s.weight[2] * c[2 * A + a] +
                      s.weight[3] * c[3 * A + a] - target_[k][a];
    scale(k, offset_[k]);
  }
}

template <int A>
void SolverOf<A>::look_along() {
  for (std::size_t i = 0; i < intervals_ * A; ++i) {
    const double* c = &step_[i];
    jerk_step_[i] = (c[3 * A] - c[0] + 3.0 * (c[A] - c[2 * A])) * scale_[i];
  }
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Place& s = places_[k];
    const double* c = &step_[s.interval * A];
    for (int a = 0; a < A; ++a)
      offset_step_[k][a] = s.weight[0] * c[a] + s.weight[1] * c[A + a] + s.weight[2] * c[2 * A + a] +
                           s.weight[3] * c[3 * A + a];
    scale(k, offset_step_[k]);
  }
}

template <int A>
double SolverOf<A>::objective(double t) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < intervals_ * A; ++i) {
    const double e = jerk_[i] + t * jerk_step_[i], z = e * e;
    sum += flat_ ? z * (kSquareShare + z * z * z) : z;
  }
  return sum;
}

/// Objective and barrier at `t` along the step.
template <int A>
double SolverOf<A>::cost(double t, double mu) const {
  double pull = 0.0;
  LogSum logs;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    double o2 = 0.0;
    for (int a = 0; a < A; ++a) {
      const double o = offset_[k][a] + t * offset_step_[k][a];
      o2 += o * o;
    }
    const double room = places_[k].limit - o2;
    if (!(room > 0.0)) return kInfinite;
    pull += places_[k].pull * o2;
    logs.add(room);
  }
  return objective(t) + pull - mu * logs.value();
}

template <int A>
void SolverOf<A>::derive_jerk() {
  for (std::size_t i = 0; i < intervals_; ++i) {
    for (int a = 0; a < A; ++a) {
      const double e = jerk_[i * A + a], z = e * e, s = scale_[i * A + a];
      double first = 2.0 * e, second = 2.0;
      if (flat_) {
        const double p = z * z * z;
        first = 2.0 * kSquareShare * e + 8.0 * p * e;
        second = 2.0 * kSquareShare + 56.0 * p;
      }
      first *= s;
      second *= s * s;
      for (int q = 0; q < 4; ++q) {
        const std::size_t row = (i + static_cast<std::size_t>(q)) * A + static_cast<std::size_t>(a);
        gradient_[row] += kDifference[q] * first;
        for (int r = q; r < 4; ++r) hessian_[row][(r - q) * A] += second * kDifference[q] * kDifference[r];
      }
    }
  }
}

template <int A>
void SolverOf<A>::derive_site(std::size_t k, double mu) {
  const Place& s = places_[k];
  // Derivatives by the distance: what the scale does to them it does twice.
  Point o = offset_[k];
  const double room = s.limit - offset2(k);
  scale(k, o);
  const double first = 2.0 * mu / room + 2.0 * s.pull, outer = 4.0 * mu / (room * room);
  const double same = first * s.scale * s.scale, more = first * s.slide * (s.slide + 2.0 * s.scale);
  const auto block = [&](std::size_t a, std::size_t b) {
    return outer * o[a] * o[b] + more * along_[k][a] * along_[k][b] + (a == b ? same : 0.0);
  };
  for (std::size_t a = 0; a < A; ++a)
    for (std::size_t q = 0; q < 4; ++q) gradient_[(s.interval + q) * A + a] += first * o[a] * s.weight[q];
  derive_axes(s, block, std::make_index_sequence<A>());
}

template <int A>
void SolverOf<A>::derive(double mu) {
  gradient_.assign(count_ * A, 0.0);
  hessian_.reset(count_ * A);
  derive_jerk();
  for (std::size_t k = 0; k < places_.size(); ++k) derive_site(k, mu);
}

/// Newton's step; its decrement.
template <int A>
double SolverOf<A>::direction() {
  const std::size_t first = problem_->first * A, end = (problem_->last + 1) * A;
  std::fill(step_.begin(), step_.end(), 0.0);
  for (std::size_t i = first; i < end; ++i) step_[i] = -gradient_[i];
  hessian_.solve(first, end, step_);
  double decrement = 0.0;
  for (std::size_t i = first; i < end; ++i) decrement -= gradient_[i] * step_[i];
  return decrement;
}

template <int A>
void SolverOf<A>::centre(double mu, double decrement, int most) {
  std::fill(jerk_step_.begin(), jerk_step_.end(), 0.0);
  std::fill(offset_step_.begin(), offset_step_.end(), Point{});
  double now = cost(0.0, mu);
  for (int q = 0; q < most; ++q) {
    derive(mu);
    ++steps_;
    const double d = direction();
    const bool last = !(d > decrement * mu * static_cast<double>(places_.size()));
    look_along();
    double t = 1.0, there = kInfinite;
    for (; t > 1e-6; t *= 0.5)
      if ((there = cost(t, mu)) < now - 1e-4 * t * d) break;
    if (!(there < now)) return;
    for (std::size_t i = problem_->first * A; i < (problem_->last + 1) * A; ++i) controls_[i] += t * step_[i];
    look();
    if (last) return;
    now = there;
  }
}

/// Radii that are wider than asked for come closer to the curve. True while some are left; `before` and
/// `after` are the widest.
template <int A>
bool SolverOf<A>::shrink(double& before, double& after) {
  bool out = false;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    double& now = places_[k].limit;
    const double asked = problem_->sites[k].limit;
    if (!(now > asked)) continue;
    before = std::max(before, now / asked);
    const double o2 = offset2(k);
    now = o2 < 0.998 * asked ? asked : std::max(asked, std::min(now, 1.02 * o2 + 0.005));
    after = std::max(after, now / asked);
    out = out || now > asked;
  }
  return out;
}

/// What is still wide stays so: at once where it is inside of the radius, else only if `all`.
template <int A>
bool SolverOf<A>::release_outer(bool all) {
  for (std::size_t k = 0; k < places_.size() && !all; ++k)
    if (places_[k].limit > problem_->sites[k].limit && places_[k].limit > 1.0) return false;
  for (std::size_t k = 0; k < places_.size(); ++k)
    problem_->sites[k].limit = std::max(problem_->sites[k].limit, places_[k].limit);
  return true;
}

template <int A>
TubeSolution SolverOf<A>::solve(TubeProblem& problem) {
  problem_ = &problem;
  take(problem);
  look();
  steps_ = 0;
  bool out = false;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const double o2 = offset2(k), asked = problem.sites[k].limit;
    if (!(o2 > 0.9999 * asked)) continue;
    places_[k].limit = std::max(asked * 1.0001, 1.1 * o2 + 0.02);
    out = true;
  }
  const auto sites = static_cast<double>(std::max<std::size_t>(places_.size(), 1));
  const auto now = [&] { return std::max(objective(0.0), 1e-12); };
  std::fill(jerk_step_.begin(), jerk_step_.end(), 0.0);
  double mu = kFirst * now() / sites;
  for (int round = 0; round < kRounds; ++round) {
    const double decrement = out ? kDecrementOutside : flat_ ? kDecrement : kClockDecrement;
    centre(mu, decrement, out ? kStepsOutside : kSteps);
    std::fill(jerk_step_.begin(), jerk_step_.end(), 0.0);
    const bool was_out = out;
    double before = 0.0, after = 0.0;
    out = shrink(before, after);
    if (out && round > 8 && release_outer(round > kPatience)) out = false;
    if (out) {
      if (after > 1.0 + 0.5 * (before - 1.0)) mu *= 8.0;
      continue;
    }
    if (was_out) {
      mu = std::min(mu, kFirst * now() / sites);
      continue;
    }
    if (mu * sites < kGap * now() || mu < 1e-16) break;
    mu *= kFactor;
  }
  problem.controls = controls_;
  TubeSolution solution;
  solution.steps = steps_;
  for (const Site& s : problem.sites) solution.released += s.limit > 1.0 ? 1 : 0;
  solution.inside = !out && solution.released == 0;
  return solution;
}

template <int A>
std::unique_ptr<Tube::Solver> make(int axes) {
  if (axes == A) return std::make_unique<SolverOf<A>>();
  if constexpr (A < kMaxAxes)
    return make<A + 1>(axes);
  else
    return nullptr;
}

}  // namespace

Tube::Tube() = default;
Tube::~Tube() = default;

TubeSolution Tube::solve(TubeProblem& problem) {
  auto& solver = by_axes_[static_cast<std::size_t>(problem.axes - 1)];
  if (!solver) solver = make<1>(problem.axes);
  return solver->solve(problem);
}

}  // namespace servogate::path
