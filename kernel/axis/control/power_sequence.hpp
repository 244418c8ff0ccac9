// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "kernel/axis/config/axis_config.hpp"

namespace servogate::axis {

/// Order of drive power and holding brake.
/// On: power, Operation enabled, torque delay, brake opens, release delay, motion permitted.
/// Off, and with the reaction stop and power off: the axis has come to rest, brake closes, engage delay,
/// power goes. A drive that lets go by itself meanwhile, or in its quick stop: the brake closes at once.
/// The delays of the brake begin when its output has the command, BrakeData::command_time behind the cycle;
/// motion waits until the feedback shows the open brake, and the load settled on the drive.
/// Reaction power off: the brake closes at once; an axis with a brake keeps its torque (in the drive's quick
/// stop) for the engage delay, so that the load does not drop; one without loses power at once.
class PowerSequence {
 public:
  enum class State : std::uint8_t {
    off,
    powering,   ///< the drive is asked for Operation enabled
    torque,     ///< waiting until it surely holds
    releasing,  ///< brake opens
    ready,      ///< motion permitted
    stopping,   ///< wanted off: the axis ramps down first
    engaging,   ///< brake closes, torque still there
  };
  struct Inputs {
    bool wanted = false;      ///< power asked for and permitted
    bool at_rest = true;      ///< the set-point stands (feedback: during a quick stop)
    bool standing = true;     ///< by the feedback
    double feedback_s = 0.0;  ///< from a command to the feedback that shows it carried out
    image::DriveState drive = image::DriveState::offline;
    image::Reaction reaction = image::Reaction::none;
    double dt = 0.001;
  };
  struct Outputs {
    bool power = false;
    bool brake_release = false;
    bool quick_stop = false;
  };

  void configure(const BrakeData& brake) noexcept;
  /// One cycle. real-time safe.
  Outputs step(const Inputs& in) noexcept;
  State state() const noexcept { return state_; }
  /// The set-point counts: the drive holds the axis. The command follows the feedback otherwise. real-time
  /// safe.
  bool holding() const noexcept { return state_ >= State::torque && drive_on_ && !quick_; }
  /// The axis may be moved by its owner. real-time safe.
  bool motion_permitted() const noexcept { return state_ == State::ready && holding(); }
  /// In the last step the drive was found without its torque, of which nobody had told it. real-time safe.
  bool lost() const noexcept { return lost_; }

 private:
  bool has_brake() const noexcept { return brake_.output != BrakeOutput::none; }
  void enter(State s) noexcept;
  void drop(const Inputs& in) noexcept;
  bool open_and_settled(const Inputs& in) const noexcept;

  BrakeData brake_;
  State state_ = State::off;
  double in_state_s_ = 0.0;
  bool drive_on_ = false;
  bool quick_ = false;
  bool lost_ = false;
};

}  // namespace servogate::axis
