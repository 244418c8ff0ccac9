// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/drive_link.hpp"

namespace servogate::axis {

/// Torque of an axis, in per cent of the rated torque of its motor (6076h), + towards rising positions.
struct TorqueData {
  double max = 0.0;   ///< largest magnitude; 0: the axis is not led by torque
  double ramp = 0.0;  ///< greatest change, per cent in a second
};

/// Leads a drive by torque. Its set-point is ramped; above half of the speed limit the torque gives way in
/// proportion, down to nothing at the limit, and never pushes against the motion. A drive that is faster all
/// the same, or that does not show the mode, is a failure; the torque is then 0 from that cycle on.
/// Everything is real-time safe.
class TorqueControl {
 public:
  enum class Failure : std::uint8_t {
    none,
    too_fast,  ///< faster than the limit and a fifth more
    no_mode,   ///< the drive has not shown its torque mode in time, or has left it
    no_return  ///< it does not show its position mode again
  };
  struct Inputs {
    double dt = 0.0;
    image::DriveMode shown = image::DriveMode::none;
    double velocity = 0.0;  ///< measured, units of the axis
    double slack = 0.0;     ///< measured speed that still is standstill
    bool permitted = true;  ///< FALSE: no torque, until it is TRUE again
  };

  void configure(const TorqueData& data) noexcept {
    *this = TorqueControl{};
    data_ = data;
  }
  /// Begins, or goes on with another wish: torque, ramp (0: the greatest), speed limit (above 0).
  void begin(double torque, double ramp, double velocity_limit) noexcept;
  /// Down to 0 in the ramp, then back into position mode.
  void end() noexcept;
  /// Without a ramp.
  void leave() noexcept;
  /// The drive has let go of the axis.
  void drop() noexcept { state_ = State::off; }

  Failure step(const Inputs& in) noexcept;

  /// From begin() until the drive is in position mode again: the set-point follows the axis.
  bool leads() const noexcept { return state_ != State::off; }
  /// The drive is to be in its torque mode.
  bool wants_mode() const noexcept { return leads() && state_ != State::returning; }
  /// What the drive is to be given.
  double command() const noexcept { return wants_mode() ? command_ : 0.0; }
  double wanted() const noexcept { return wanted_; }
  /// The set-point has arrived at what was wanted.
  bool arrived() const noexcept { return state_ == State::active && command_ == wanted_; }
  double velocity_limit() const noexcept { return velocity_limit_; }

 private:
  enum class State : std::uint8_t { off, entering, active, ending, returning };
  Failure enter(const Inputs& in) noexcept;
  Failure come_back(const Inputs& in) noexcept;
  void ramp(const Inputs& in) noexcept;

  TorqueData data_;
  State state_ = State::off;
  double wanted_ = 0.0, ramp_ = 0.0, velocity_limit_ = 0.0;
  double command_ = 0.0;
  double waited_s_ = 0.0;
};

}  // namespace servogate::axis
