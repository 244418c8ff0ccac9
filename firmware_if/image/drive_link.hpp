// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::image {

/// The states of CiA 402-2, "Statusword"; a supplier that is no CiA 402 drive maps its own onto them.
enum class DriveState : std::uint8_t {
  offline,  ///< no communication yet, or lost
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// Operating modes the kernel asks of a drive (CiA 402 object 6060h: csp 8, csv 9, cst 10, homing 6).
enum class DriveMode : std::uint8_t { none, csp, csv, cst, homing };

/// How far a drive is with a homing that it does by itself (DriveMode::homing).
enum class DriveHoming : std::uint8_t {
  idle,  ///< none was begun since the mode was asked for
  running,
  interrupted,  ///< the drive stands and has neither found its home nor reported an error
  attained,
  failed,  ///< the drive reports a homing error
};

/// What the latch of a drive watches (CiA 402 60B8h).
enum class LatchSource : std::uint8_t { zero_mark, probe_1, probe_2 };

/// Kernel to drive, written every cycle in the axes phase; a supplier sends it in the same cycle. Counts are
/// drive counts after scale, direction and compensation.
struct DriveCommand {
  bool power = false;                 ///< wish: reach and hold Operation enabled
  bool quick_stop = false;            ///< the drive's own quick stop (controlword bit 2 low)
  bool reset_fault = false;           ///< level; the supplier makes the edge the drive wants
  bool brake_release = false;         ///< brake output of the drive, where it has one
  std::uint32_t digital_outputs = 0;  ///< 60FEh:01 but for the bit of the brake
  DriveMode mode = DriveMode::none;   ///< homing: the drive begins as soon as it is in this mode, and leads
  bool halt =
      false;  ///< stops a motion that the drive leads: its halt bit, or its quick stop where it has none
  LatchSource latch_source = LatchSource::zero_mark;
  bool latch_arm = false;       ///< level: TRUE arms one capture, FALSE disarms
  bool latch_negative = false;  ///< capture on the negative edge
  std::int64_t position_counts = 0;
  double velocity_counts_s = 0.0;
  double torque_permille = 0.0;
};

/// Which transition of the CiA 402 state machine a drive does not follow, for the message that says why.
struct DriveRefusal {
  DriveState from = DriveState::offline;
  DriveState wanted = DriveState::offline;
  std::int32_t waited_ms = 0;  ///< 0: nothing is refused
};

/// Drive to kernel, latched at SYNC k and read in cycle k + 1.
struct DriveFeedback {
  bool online = false;  ///< configured, heartbeat and PDOs alive
  DriveState state = DriveState::offline;
  DriveMode mode = DriveMode::none;
  std::uint16_t statusword = 0;
  std::uint16_t error_code = 0;  ///< 603Fh or the last EMCY
  std::int64_t position_counts = 0;
  double velocity_counts_s = 0.0;
  double torque_permille = 0.0;
  bool torque_known = false;         ///< the drive's process data hold its torque
  std::uint8_t restarts = 0;         ///< changes when the device restarts by itself: it may count from anew
  std::uint32_t digital_inputs = 0;  ///< 60FDh
  std::int64_t latch_counts = 0;     ///< position of the last capture
  std::uint32_t latch_sequence = 0;  ///< increases by one with every capture
  DriveHoming homing = DriveHoming::idle;
  std::int64_t home_counts = 0;  ///< attained: where home is, in the counts of position_counts
  std::uint32_t missed = 0;      ///< consecutive cycles without a fresh process data object
  DriveRefusal refusal;
};

}  // namespace servogate::image
