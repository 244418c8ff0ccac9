// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/402/controlword.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// How a motion is brought to rest. Source: CiA 402-2, option codes 605Ah-605Eh.
enum class StopKind : std::uint8_t {
  none,
  slow_down_ramp,   ///< 6084h
  quick_stop_ramp,  ///< 6085h
  torque_limit,     ///< with all the torque there is (current or voltage limit)
};

/// Option codes 605Ah, 605Bh, 605Ch, 605Eh as they stand now.
struct OptionCodes {
  std::int16_t quick_stop = 2, shutdown = 0, disable_operation = 1, fault_reaction = 2;
};

/// What the state machine decides on in one tick.
struct PowerInputs {
  std::uint16_t controlword = 0;
  OptionCodes options;
  bool main_voltage = true;    ///< the DC link is charged
  bool torque_allowed = true;  ///< safe torque off is not requested
  bool standstill = true;      ///< the stop in force has come to its end
  bool fault_cause = false;    ///< what raised the fault is still there: no reset
  bool hold_state = false;     ///< frozen in its state (fault injection)
};

/// The power drive state machine with all transitions 0-16, option codes and holding brake. Source: CiA
/// 402-2, "Finite state automaton". real-time safe.
class PowerState {
 public:
  /// Times of the holding brake; 0: there is none.
  void set_brake(image::Nanoseconds release, image::Nanoseconds engage) noexcept {
    release_ns_ = release;
    engage_ns_ = engage;
  }
  /// A drive without the edge: bit 7 resets a fault after so long; 0: by its rising edge.
  void set_fault_reset_level(image::Nanoseconds needed) noexcept { reset_needed_ns_ = needed; }
  /// Time between two SYNC: Quick stop active lasts longer, so that it is seen from standstill, too.
  void set_pdo_cycle(image::Nanoseconds time) noexcept { pdo_cycle_ns_ = time; }
  /// Power-on or reset: transition 0 and, with the next tick, 1.
  void reset() noexcept;
  void tick(const PowerInputs& in, image::Nanoseconds step) noexcept;
  /// Transition 13 with the next tick. `coast`: the power stage is switched off at once, whatever 605Eh says.
  void fault(bool coast) noexcept;

  image::DriveState state() const noexcept { return state_; }
  /// The servo has current.
  bool energised() const noexcept { return energised_; }
  /// Set-points of the mode act: Operation enabled and no stop under way.
  bool following() const noexcept {
    return state_ == image::DriveState::operation_enabled && stop_ == StopKind::none && !engaging_;
  }
  /// The stop under way; its end is reported back as PowerInputs::standstill.
  StopKind stop() const noexcept { return stop_; }
  bool brake_released() const noexcept { return brake_released_; }
  /// Operation enabled goes on: a tick with this controlword would change nothing.
  bool goes_on(std::uint16_t controlword) const noexcept {
    return following() && brake_released_ && !fault_requested_ && energised_ &&
           reset_level_ == ((controlword & controlword::kFaultReset) != 0) &&
           decode_command(controlword) == ControlCommand::enable_operation;
  }
  std::uint32_t transitions() const noexcept { return transitions_; }

 private:
  void enter(image::DriveState state) noexcept;
  void disable(image::DriveState state) noexcept;
  void stop_then(StopKind kind, image::DriveState state) noexcept;
  void idle(const PowerInputs& in, ControlCommand command) noexcept;
  void enabled(const PowerInputs& in, ControlCommand command) noexcept;
  void quick_stopping(const PowerInputs& in, ControlCommand command) noexcept;
  void react_to_fault(const PowerInputs& in) noexcept;
  void energise(image::Nanoseconds step) noexcept;
  void finish_stop(const PowerInputs& in) noexcept;

  image::DriveState state_ = image::DriveState::not_ready_to_switch_on;
  image::DriveState after_stop_ = image::DriveState::switched_on;
  StopKind stop_ = StopKind::none;
  bool energised_ = false, brake_released_ = false, enabling_ = false, engaging_ = false;
  bool fault_requested_ = false, coast_ = false, reset_level_ = true;
  image::Nanoseconds release_ns_ = 0, engage_ns_ = 0, brake_left_ = 0;
  image::Nanoseconds reset_needed_ns_ = 0, reset_held_ns_ = 0;
  image::Nanoseconds step_ = 0;
  image::Nanoseconds pdo_cycle_ns_ = image::kMillisecond, quick_stop_left_ = 0;
  std::uint32_t transitions_ = 0;
};

}  // namespace servogate::canopen
