// SPDX-License-Identifier: Apache-2.0
// A spindle that becomes a rotary axis, and a spindle again: both have one drive.
#include <algorithm>
#include <cmath>

#include "kernel/axis/axis.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::axis {
namespace {

constexpr double kDrivePatience = 10.0;  // s, for the drive to go off and come on in another mode

}  // namespace

/// The oriented stop is that of the axis' place: from the mark on, its counts are those of the spindle.
void Spindle::begin_axis(const Axis& axis) noexcept {
  const AxisConfig& a = axis.config();
  place_ = axis.setpoint().x;
  const double way = a.count_direction * scale_.direction * (place_ - a.homing.position);
  order(SpindleMode::orient, 0.0);
  orient_deg_ = way - 360.0 * std::floor(way / 360.0);
  use_ = Use::orienting;
  changing_s_ = 0.0;
}

/// At the place, or a whole number of turns beside it: those count to the mark.
void Spindle::hand_over(Axis& axis) noexcept {
  const AxisConfig& a = axis.config();
  const std::int64_t mark = scale_.reference_counts, turn = config_.counts_numerator;
  const double at = a.homing.position + a.count_direction * 360.0 *
                                            static_cast<double>(drive_.position_counts - mark) /
                                            static_cast<double>(turn);
  const auto turns = static_cast<std::int64_t>(std::llround((place_ - at) / 360.0));
  axis.wake(mark - a.count_direction * turns * turn);
  use_ = Use::powering;
}

/// The change does not come to its end: a spindle at rest.
void Spindle::give_up_axis(Axis& axis) noexcept {
  wants_axis_ = false;
  if (lent()) {
    axis.stop();
    axis.let_go();
    use_ = Use::leaving;
    return;
  }
  order(SpindleMode::stop, 0.0);
  use_ = Use::spindle;
}

void Spindle::share(Axis& axis, double dt) noexcept {
  const double patience = config_.orient_timeout + kDrivePatience;
  const bool on_its_way = use_ >= Use::orienting && use_ <= Use::placing;
  changing_s_ = on_its_way ? changing_s_ + dt : 0.0;
  if (on_its_way && changing_s_ > patience) {
    events_.add({alarm::kSpindleNoAxis, patience, patience});
    return give_up_axis(axis);
  }
  // Whatever told it otherwise (a stop, a fault, a reaction) has the last word.
  const bool told = use_ == Use::orienting && mode_ != SpindleMode::orient;
  if ((on_its_way && !wants_axis_) || told) return give_up_axis(axis);
  const bool off = !drive_.online || drive_.state != image::DriveState::operation_enabled;
  switch (use_) {
    case Use::spindle:
      if (wants_axis_ && axis.asleep()) begin_axis(axis);
      break;
    case Use::orienting:
      if (!oriented_) break;
      order(SpindleMode::stop, 0.0);
      use_ = Use::freeing;
      break;
    case Use::freeing:
      if (drive_.online && off && zero_speed_ && marked_) hand_over(axis);
      break;
    case Use::powering:
      // It goes to where the program knows it to stand.
      if (!axis.motion_permitted() || !axis.feed_enabled()) break;
      if (axis.setpoint().x == place_ || axis.move_to(place_, axis.config().slow_velocity))
        use_ = Use::placing;
      break;
    case Use::placing:
      if (!axis.moving() && axis.setpoint().x == place_) use_ = Use::axis;
      break;
    case Use::axis:
      // Whoever moves it comes to his end first.
      if (wants_axis_ || axis.owner() != image::AxisOwner::none || !axis.standstill()) break;
      axis.let_go();
      use_ = Use::leaving;
      break;
    case Use::leaving:
      if (axis.power_state() != PowerSequence::State::off || !off) break;
      axis.sleep();
      order(SpindleMode::stop, 0.0);
      use_ = Use::spindle;
      break;
  }
}

/// The axis that sleeps sees where the drive stands, and no power of its own.
void Spindle::show_drive(image::ProcessImage& image) const noexcept {
  if (config_.axis < 0) return;
  const image::DriveFeedback& from = image.spindles[static_cast<std::size_t>(index_)].drive;
  image.axes[static_cast<std::size_t>(config_.axis)].drive = from;
}

}  // namespace servogate::axis
