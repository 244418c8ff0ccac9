// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/402/controlword.hpp"
#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// What the control wants of the drive's state machine.
enum class PowerWish : std::uint8_t { off, on, quick_stop };

/// The master's side of the CiA 402 state machine: looks at the statusword and says the next controlword, one
/// transition at a time: Shutdown, Switch on, Enable operation; the way down is Shutdown, Disable voltage.
/// Knows nothing of CAN. Source: CiA 402-2, "State transitions and control". All members are real-time safe.
///
/// A fault is left only by reset_fault: one pulse of bit 7 for each rise of that wish. A wish that is already
/// TRUE when the fault comes counts for nothing.
class DriveControl {
 public:
  struct Timing {
    FaultReset fault_reset = FaultReset::edge;
    image::Nanoseconds reset_hold_ns = 20 * image::kMillisecond;
    image::Nanoseconds transition_timeout_ns = 2 * image::kSecond;
  };
  struct Wish {
    PowerWish power = PowerWish::off;
    bool reset_fault = false;
    bool mode_ready = true;  ///< FALSE holds Switched on until the wanted mode of operation is in force
    bool start_homing = false;
    bool halt = false;  ///< bit 8 in Operation enabled
  };

  DriveControl() = default;
  explicit DriveControl(const Timing& timing) noexcept : timing_(timing) {}

  /// Communication begins anew: nothing is known of the drive.
  void restart() noexcept;
  /// Takes a fresh statusword. A pattern outside CiA 402's table leaves the state as it was.
  void on_statusword(std::uint16_t word) noexcept;
  /// The controlword to send now.
  std::uint16_t step(image::Nanoseconds now, const Wish& wish) noexcept;

  image::DriveState state() const noexcept { return state_; }
  /// The transition the drive has not followed for the time-out; waited_ms is 0 while there is none.
  const image::DriveRefusal& refusal() const noexcept { return refusal_; }

 private:
  std::uint16_t command(image::Nanoseconds now, const Wish& wish, image::DriveState& wanted) noexcept;
  std::uint16_t command_in_fault(image::Nanoseconds now, const Wish& wish,
                                 image::DriveState& wanted) noexcept;
  void watch(image::Nanoseconds now, image::DriveState wanted) noexcept;

  Timing timing_;
  image::DriveState state_ = image::DriveState::offline;
  image::DriveState watched_from_ = image::DriveState::offline;
  image::DriveState watched_wanted_ = image::DriveState::offline;
  image::Nanoseconds watched_since_ns_ = 0;
  bool reset_used_ = true;  ///< this rise of reset_fault has had its pulse
  bool resetting_ = false;  ///< a pulse has been sent in this fault
  image::Nanoseconds reset_until_ns_ = 0;
  image::DriveRefusal refusal_;
};

}  // namespace servogate::canopen
