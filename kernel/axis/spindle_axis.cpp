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

/// Where the axis stood, or was to stand, is where it goes on: what it sags without power is not its place.
void Spindle::let_go(Axis& axis) noexcept {
  if (use_ == Use::axis) place_ = axis.setpoint().x;
  axis.let_go();
  use_ = Use::leaving;
}

/// The change does not come to its end: a spindle at rest.
void Spindle::give_up_axis(Axis& axis) noexcept {
  wants_axis_ = false;
  if (lent()) {
    axis.stop();
    return let_go(axis);
  }
  order(SpindleMode::stop, 0.0);
  use_ = Use::spindle;
}

/// Whatever told it otherwise (a stop, a fault, a reaction) has the last word. A fault, an emergency
/// stop and what its axis loses are told by themselves.
bool Spindle::failed_on_its_way() noexcept {
  using image::DriveState;
  const double patience = config_.orient_timeout + kDrivePatience;
  const bool told_otherwise = use_ == Use::orienting && mode_ != SpindleMode::orient;
  const bool fault = drive_.online &&
                     (drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active);
  if (!told_otherwise && drive_.online && !fault && changing_s_ <= patience) return false;
  const bool known = reaction_ >= image::Reaction::stop_and_power_off || (fault && !reset_pending_) ||
                     (lent() && !drive_.online);
  if (!known) events_.add({alarm::kSpindleNoAxis, patience, changing_s_});
  return true;
}

void Spindle::share(Axis& axis, double dt) noexcept {
  const bool on_its_way = use_ >= Use::orienting && use_ <= Use::placing;
  changing_s_ = on_its_way ? changing_s_ + dt : 0.0;
  if (on_its_way && (!wants_axis_ || failed_on_its_way())) return give_up_axis(axis);
  // The counts from the mark on are gone with the drive, and the axis says so.
  if (use_ == Use::axis && !drive_.online) return give_up_axis(axis);
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
      // Without its feed it has stopped on its way.
      if (!axis.moving()) use_ = axis.setpoint().x == place_ ? Use::axis : Use::powering;
      break;
    case Use::axis:
      // Whoever moves it comes to his end first.
      if (wants_axis_ || axis.owner() != image::AxisOwner::none || !axis.standstill()) break;
      let_go(axis);
      break;
    case Use::leaving:
      if (axis.power_state() != PowerSequence::State::off || !off) break;
      axis.sleep(place_);
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
