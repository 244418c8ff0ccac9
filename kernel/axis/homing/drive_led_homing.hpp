// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/drive_link.hpp"
#include "kernel/axis/config/axis_config.hpp"

namespace servogate::axis {

/// What a homing that the drive does sees of its axis in one cycle.
struct DriveLedInputs {
  double dt = 0.001;
  image::DriveMode mode = image::DriveMode::none;  ///< that the drive shows
  image::DriveHoming homing = image::DriveHoming::idle;
  bool standing = true;
  bool into_limit = false;  ///< it moves, and towards a limit switch that is on
};

/// Order of a homing by the drive's own method (CiA 402-2, "Homing mode"): the drive is put into homing mode,
/// which starts it, and watched; it leads and the axis' set-point follows. Whatever ends it, the drive is at
/// rest and back in csp before the axis leads again. All members are real-time safe.
class DriveLedHoming {
 public:
  enum class Phase : std::uint8_t {
    off,
    asking,     ///< for homing mode
    running,    ///< the drive homes
    halting,    ///< broken off: the drive is to stop
    returning,  ///< at rest: back to csp
  };
  enum class Outcome : std::uint8_t { none, attained, interrupted, failed, mode_refused, limit };
  static constexpr double kModePatience = 2.0;  ///< s for a change of mode
  static constexpr double kHaltPatience = 1.0;  ///< s for the halt, then the drive's quick stop

  void start() noexcept;
  void step(const HomingData& data, const DriveLedInputs& in) noexcept;
  /// Breaks off: halts the drive. Nothing while it does not lead.
  void stop() noexcept;
  /// The drive does not hold the axis any more: there is nothing left to stop.
  void drop() noexcept { phase_ = Phase::off; }

  bool leads() const noexcept { return phase_ != Phase::off; }
  Phase phase() const noexcept { return phase_; }
  /// Why it ended or is being halted; `attained` may be used once it does not lead any more.
  Outcome outcome() const noexcept { return outcome_; }
  bool wants_homing_mode() const noexcept { return leads() && phase_ != Phase::returning; }
  bool wants_halt() const noexcept { return phase_ == Phase::halting; }
  bool wants_quick_stop() const noexcept { return wants_halt() && in_phase_s_ > kHaltPatience; }

 private:
  void enter(Phase phase) noexcept;
  void break_off(Outcome outcome) noexcept;
  void watch(const HomingData& data, const DriveLedInputs& in) noexcept;

  Phase phase_ = Phase::off;
  Outcome outcome_ = Outcome::none;
  double in_phase_s_ = 0.0;
  double limit_s_ = 0.0;  ///< so long it has moved into a limit switch
  double rest_s_ = 0.0;   ///< so long it has stood while it is halted
};

}  // namespace servogate::axis
