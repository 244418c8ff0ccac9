// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/even_time.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/law/judge.hpp"
#include "kernel/path/law/knot.hpp"
#include "kernel/path/shape/tube.hpp"

namespace servogate::path {
namespace {

constexpr double kPull = 0.9;        // of a point's distance from the programmed path is kept
constexpr double kLeastWay = 0.004;  // mm: how far along the path its place is looked for, at least
constexpr std::size_t kFewest = 8;   // intervals of a run

}  // namespace

void EvenTime::clear(double step) { *this = EvenTime(axes_, step); }

/// To the interval of time t; false: it is not known yet.
bool EvenTime::advance(const Kept<double>& beta, double t, std::size_t known) {
  if (ends_ == 0.0) ends_ = interval_time({&beta[0], 3}, 0, old_step_);
  while (at_ + 1 < known && t > ends_) {
    begins_ = ends_;
    ++at_;
    ends_ += interval_time({&beta[at_], 3}, 0, old_step_);
  }
  return t <= ends_;
}

bool EvenTime::work(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
                    const Kept<double>& beta, bool complete, std::size_t open, Kept<double>& new_places,
                    Kept<Vector>& new_controls) {
  if (done_ || beta.end() < 3) return false;
  if (old_step_ == 0.0) old_step_ = step_;
  const std::size_t known = beta.end() - 2, first_known = complete ? open : known;  // intervals
  const std::size_t before = next_;
  for (; first_known > 0 && advance(beta, static_cast<double>(next_) * step_, first_known); ++next_)
    take(run, places, controls, beta, static_cast<double>(next_) * step_, new_places, new_controls);
  if (!complete) return next_ > before;
  double all = begins_;
  for (std::size_t k = at_; k < known; ++k) all += interval_time({&beta[k], 3}, 0, old_step_);
  const double exact = all / step_, fewest = static_cast<double>(kFewest);
  const double count = std::max(fewest, next_ == 0 ? std::ceil(exact) : std::round(exact));
  if (next_ == 0) step_ = all / count;
  const double first = static_cast<double>(next_) - 1.0, off = all - count * step_;
  for (; static_cast<double>(next_) <= count; ++next_) {
    const auto k = static_cast<double>(next_);
    const double z = (k - first) / (count - first),
                 t = std::min(k * step_ + off * z * z * (3.0 - 2.0 * z), all);
    advance(beta, t, known);
    take(run, places, controls, beta, t, new_places, new_controls);
  }
  // The rest at the end: the last point, and its controls.
  new_places.back() = run.length();
  while (new_controls.end() < new_places.end() + 2) new_controls.push_back(run.at(run.length(), leg_));
  return done_ = true;
}

void EvenTime::take(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
                    const Kept<double>& beta, double t, Kept<double>& new_places,
                    Kept<Vector>& new_controls) {
  const double* q = &beta[at_];
  const double i1 = 1.0 / old_step_, seconds = ends_ - begins_;
  const Quintic tau =
      Quintic::between(seconds, std::sqrt(0.5 * (q[0] + q[1])) * i1, 0.5 * (q[1] - q[0]) * i1 * i1,
                       std::sqrt(0.5 * (q[1] + q[2])) * i1, 0.5 * (q[2] - q[1]) * i1 * i1);
  const double f = std::clamp(tau.at(std::clamp((t - begins_) / seconds, 0.0, 1.0)), 0.0, 1.0);
  const auto w = spline_weights(f);
  Vector x{};
  for (int a = 0; a < axes_; ++a) {
    // By differences, so that an axis that rests does so to the last digit, and is left out of the problems.
    const double c = controls[at_][a];
    x[a] = c + w[1] * (controls[at_ + 1][a] - c) + w[2] * (controls[at_ + 2][a] - c) +
           w[3] * (controls[at_ + 3][a] - c);
  }
  const double way = places[at_ + 1] - places[at_], guess = places[at_] + f * way;
  leg_ = run.leg_at(guess, leg_);
  double place = next_ == 0 ? 0.0 : run.downhill(x, guess, std::max(kLeastWay, 0.5 * way), leg_);
  if (next_ > 0) place = std::max(place, new_places.back());
  put(run, x, std::min(place, run.length()), new_places, new_controls);
}

/// A knot: the control before it is known now, so that the curve goes through the points.
void EvenTime::put(const Run& run, const Vector& x, double place, Kept<double>& new_places,
                   Kept<Vector>& new_controls) {
  leg_ = run.leg_at(place, leg_);
  const Vector p = run.at(place, leg_);
  Vector y = p;
  for (int a = 0; a < axes_; ++a) y[a] += kPull * (x[a] - p[a]);
  if (next_ == 0) {
    new_controls.push_back(y);
    last_ = y;
  }
  if (next_ > 0) {
    Vector c = last_;
    for (int a = 0; a < axes_; ++a) c[a] -= (y[a] - 2.0 * last_[a] + before_[a]) / 6.0;
    new_controls.push_back(c);
  }
  before_ = last_;
  last_ = y;
  new_places.push_back(place);
}

}  // namespace servogate::path
