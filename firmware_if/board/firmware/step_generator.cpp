// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/firmware/step_generator.hpp"

namespace servogate::board {

std::uint32_t StepGenerator::largest_rate(const Setting& setting) noexcept {
  return setting.tick_hz / (2 * setting.level_ticks);
}

StepGenerator::Fixed StepGenerator::per_tick(std::int64_t steps_per_second) const noexcept {
  return steps_per_second * kOne / static_cast<std::int64_t>(setting_.tick_hz);
}

void StepGenerator::configure(const Setting& setting) noexcept {
  *this = StepGenerator{};
  setting_ = setting;
  most_ = per_tick(largest_rate(setting));
  // steps/s2 to steps a tick and tick; at least the smallest there is, so that it ends.
  brake_ = per_tick(setting.stop_rate) / static_cast<Fixed>(setting.tick_hz);
  if (setting.stop_rate != 0 && brake_ == 0) brake_ = 1;
}

bool StepGenerator::follow(std::int32_t target, std::int32_t rate) noexcept {
  const Fixed whole = position_ >> 32, fraction = position_ - whole * kOne;
  // Positions run over: only their difference has a meaning.
  const auto way = static_cast<std::int32_t>(static_cast<std::uint32_t>(target) -
                                             static_cast<std::uint32_t>(whole & 0xFFFFFFFF));
  const Fixed wanted = (way * kOne - fraction) / static_cast<Fixed>(setting_.period_ticks);
  const auto bounded = [this](Fixed r) { return r > most_ ? most_ : r < -most_ ? -most_ : r; };
  rate_ = bounded(wanted);
  next_rate_ = bounded(per_tick(rate));
  left_ = more_ = setting_.period_ticks;
  return rate_ == wanted;
}

StepPins StepGenerator::drop() noexcept {
  left_ = more_ = 0;
  rate_ = next_rate_ = 0;
  // What was not put out yet is forgotten: the next target is met from here.
  position_ = static_cast<Fixed>(static_cast<std::int32_t>(out_)) * kOne;
  pins_.step = false;
  return pins_;
}

StepPins StepGenerator::tick() noexcept {
  if (left_ > 0) {
    position_ += rate_;
    if (--left_ == 0) rate_ = next_rate_;
  } else if (more_ > 0) {
    --more_;
    position_ += rate_;
  } else {
    if (brake_ == 0 || (rate_ < brake_ && rate_ > -brake_)) {
      rate_ = 0;
    } else {
      rate_ += rate_ > 0 ? -brake_ : brake_;
    }
    position_ += rate_;
  }
  if (wait_ > 0) {
    --wait_;
    return pins_;
  }
  if (pins_.step) {
    pins_.step = false;
    wait_ = setting_.level_ticks - 1;
    return pins_;
  }
  const auto due =
      static_cast<std::int32_t>(static_cast<std::uint32_t>((position_ + kOne / 2) >> 32 & 0xFFFFFFFF) - out_);
  if (due == 0) return pins_;
  const bool forward = due > 0;
  if (forward != pins_.forward) {
    pins_.forward = forward;
    wait_ = setting_.level_ticks - 1;
    return pins_;
  }
  pins_.step = true;
  wait_ = setting_.level_ticks - 1;
  out_ += forward ? 1u : ~0u;
  return pins_;
}

}  // namespace servogate::board
