// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/stop_plan.hpp"

#include <algorithm>

namespace servogate::path {

RateState StopPlan::at(double t) const noexcept {
  if (t >= seconds) {
    const RateState& end = at_[count_ + 1];
    return {0.0, 0.0, end.bend, end.passed};
  }
  const std::size_t n = std::min(count_, static_cast<std::size_t>(t / piece_));
  const RateState& from = at_[n];
  const double in = t - static_cast<double>(n) * piece_;
  const double bent = from.bend * in;
  return {from.rate + in * (from.slope + 0.5 * bent), from.slope + bent, from.bend,
          from.passed + in * (from.rate + in * (0.5 * from.slope + bent / 6.0))};
}

void StopPlan::begin(double rate, double slope, double piece) noexcept {
  r0 = rate;
  slope0 = slope;
  piece_ = piece;
  count_ = 0;
  seconds = 0.0;
  at_[0] = {rate, slope, 0.0, 0.0};
}

void StopPlan::add(double bend) noexcept {
  at_[count_].bend = bend;
  seconds = static_cast<double>(count_ + 1) * piece_;
  const RateState& from = at_[count_];
  const double in = piece_, bent = bend * in;
  at_[count_ + 1] = {from.rate + in * (from.slope + 0.5 * bent), from.slope + bent, 0.0,
                     from.passed + in * (from.rate + in * (0.5 * from.slope + bent / 6.0))};
  ++count_;
}

void StopPlan::close() noexcept {
  RateState& from = at_[count_];
  from.bend = 0.5 * from.slope * from.slope / from.rate;
  const double in = -2.0 * from.rate / from.slope;
  at_[count_ + 1] = {0.0, 0.0, from.bend, from.passed + in * from.rate / 3.0};
  seconds = static_cast<double>(count_) * piece_ + in;
}

}  // namespace servogate::path
