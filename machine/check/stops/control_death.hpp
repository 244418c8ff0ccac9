// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "machine/load.hpp"

/// What becomes of a hanging axis when the control dies: SYNC, process data and heartbeat end together, the
/// target of its drive stands still where it was.
namespace servogate::machine {

/// Times in s from the last cycle of the control, kNoLimit: never.
struct ControlDeath {
  /// What the drive's reaction leaves of its torque. Source: CiA 402-2, 6007h, 605Ah, 605Eh.
  enum class Reaction : std::uint8_t {
    holds,       ///< it stops, or stands, and keeps its torque
    ramps_down,  ///< it stops under torque, which then goes
    lets_go,     ///< torque goes at once
  };
  /// What closes the brake.
  enum class Brake : std::uint8_t {
    drive,    ///< the drive, with its power stage (`brake_interlock`)
    station,  ///< the I/O module that it hangs on, which misses the control's heartbeat
    relay,    ///< the relay that watches safety.control_alive
    nobody,   ///< its output stays as the control left it
  };
  double notices = kNoLimit;  ///< heartbeat, guarding or the deadline of an RPDO
  Reaction on_silence = Reaction::holds;
  /// The drive's own following error at max_velocity (6065h, 6066h), where it is before that: with its target
  /// at rest the error grows by the speed. 0 where the file does not say it.
  double follows = kNoLimit;
  bool following_known = true;
  Reaction on_following = Reaction::holds;

  Brake brake = Brake::nobody;
  double brake_closed = kNoLimit;  ///< at the latest; with Brake::drive: after the torque has gone
  double falls_for = 0.0;          ///< without torque and brake, kNoLimit: until something stops it
  double falls = 0.0;     ///< in free fall, from max_velocity downwards if it is in motion, mm; 0 for a
                          ///< rotary axis: not known
  bool by_order = false;  ///< no brake is as late as that: it is what takes the torque too early

  /// The reaction that lets it fall for longest.
  Reaction worst = Reaction::holds;
};

/// nullopt: the axis has no brake, or nothing is known of its drive.
std::optional<ControlDeath> control_death(const LoadResult& loaded, const AxisConfig& axis);

/// As halves of a sentence in both languages: what happens to the drive, what to its brake, and how far the
/// axis falls.
struct ControlDeathWords {
  std::string drive, brake, fall;
};
ControlDeathWords words_of(const ControlDeath& death, const AxisConfig& axis);

}  // namespace servogate::machine
