// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/402/mode.hpp"

namespace servogate::canopen {

/// One process data object as the machine wants it. Source: CiA 301, 7.5.2.35-38.
struct PdoWanted {
  PdoMapping mapping;  ///< count 0: this PDO is not used and gets disabled
  /// 1-240: every n-th SYNC; 0: at SYNC on event; 254/255: on event; TPDO 252/253: when it is asked for.
  std::uint8_t transmission_type = 1;
  std::uint16_t inhibit_100us = 0;  ///< TPDO on event: least distance between two, in 100 µs
  /// TPDO on event: sent at least this often; TPDO 252/253: the master asks this often; RPDO: deadline (0:
  /// none).
  std::uint16_t event_ms = 0;

  bool used() const noexcept { return mapping.count != 0; }
  /// Sent with every n-th SYNC.
  constexpr bool cyclic() const noexcept { return transmission_type >= 1 && transmission_type <= 240; }
  /// A TPDO that comes when a remote frame asks for it.
  constexpr bool remote() const noexcept { return transmission_type == 252 || transmission_type == 253; }
};

/// A value that a drive wants written over SDO at boot, before its PDOs, and read back.
struct SdoSetting {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 4;  ///< 1, 2 or 4
  std::uint32_t value = 0;
  bool read_back = true;  ///< false for write-only and self-clearing objects
};

/// A manufacturer's own error code (603Fh or EMCY) in words.
struct ErrorText {
  std::uint16_t code = 0;
  std::string english;
  std::string russian;  ///< empty: the English text is shown
};

/// How a drive wants its fault reset (6040h bit 7).
enum class FaultReset : std::uint8_t {
  edge,   ///< CiA 402: on the rising edge
  level,  ///< the drive looks at the level; the bit stays set as long as the command asks and the fault
          ///< stands
};

/// Everything that is particular to one make of drive, or of I/O module: a file of devices/ as data, never
/// code. Filled by the gateway before the cycle starts and not changed afterwards. The defaults fit a drive
/// that keeps to CiA 402.
struct DriveProfile {
  std::string name;  ///< name of the device file
  std::string manufacturer;
  std::string description;

  // Identity, checked at boot; nullopt: any value is accepted.
  std::optional<std::uint32_t> device_type = 0x192;  ///< compared with 1000h under `device_type_mask`
  std::uint32_t device_type_mask = 0xFFFF;           ///< low word: number of the device profile (402 = 192h)
  std::optional<std::uint32_t> vendor_id;            ///< 1018h:01
  std::optional<std::uint32_t> product_code;         ///< 1018h:02
  std::optional<std::uint32_t> revision;             ///< 1018h:03

  // Units of the drive's objects.
  std::int64_t counts_per_rev = 65536;  ///< of 607Ah and 6064h, per turn of the motor
  double velocity_unit_counts_s =
      1.0;  ///< one unit of 60FFh and 606Ch in counts/s (rpm: counts_per_rev / 60)
  /// One unit of 6042h and 6044h in counts/s: a turn of the motor a minute, times 604Bh, times 604Ch, by
  /// CiA 402-2.
  double vl_unit_counts_s = 65536 / 60.0;
  double acceleration_unit_counts_s2 = 1.0;  ///< one unit of 609Ah in counts/s2
  double torque_unit_permille = 1.0;         ///< one unit of 6071h and 6077h in per mille of the rated torque

  // Modes.
  std::uint32_t modes =
      supported_bit(OperationMode::cyclic_sync_position);  ///< needed of 6502h, checked at boot
  bool check_modes = true;                                 ///< false: the drive has no 6502h
  /// For DriveMode::csp: csp; ip of a drive without csp, whose record 60C1h:01 is mapped instead of 607Ah; or
  /// pp, where the drive forms the motion to each set-point by itself: for auxiliary axes.
  OperationMode position_mode = OperationMode::cyclic_sync_position;
  std::uint8_t ip_position_entry = 1;  ///< sub-index of 60C1h that takes the position
  std::uint8_t ip_velocity_entry = 0;  ///< the same for its velocity; 0: the record has none
  bool ip_buffer = false;              ///< has 60C4h: closed and cleared by :06 until the drive interpolates
  OperationMode velocity_mode = OperationMode::cyclic_sync_velocity;  ///< for DriveMode::csv: csv, pv or vl
  OperationMode torque_mode = OperationMode::cyclic_sync_torque;      ///< for DriveMode::cst: cst or tq

  // Process data, index 0 = PDO 1.
  std::array<PdoWanted, 4> rpdo{};
  std::array<PdoWanted, 4> tpdo{};
  bool pdo_map_fixed = false;  ///< the map cannot be written: it is read and compared
  /// It has no process data, or none that can be used: rpdo and tpdo are empty, everything goes over SDO.
  /// Position mode pp, velocity mode pv or vl.
  bool sdo_only = false;

  // Timing of the communication.
  std::optional<std::int8_t> interpolation_base =
      -3;                                 ///< exponent of 60C2h:02; nullopt: the drive has no 60C2h
  std::uint8_t command_delay_cycles = 1;  ///< cycles from a target's SYNC to the actual value that follows it
  bool has_cycle_period = false;          ///< 1006h is to be written

  // If the computer dies: see stops_by_itself().
  bool has_heartbeat_consumer = true;  ///< 1016h
  /// Period of node guarding in ms (100Ch) for a drive that has no heartbeat; 0: it has one. The drive
  /// watches the control by life guarding then: guard time times life time factor (100Dh).
  std::uint16_t guard_time_ms = 0;
  std::uint8_t life_time_factor = 3;
  std::optional<std::int16_t> abort_connection_option =
      1;  ///< 6007h of CiA 402: 1 fault, 2 disable voltage, 3 quick stop

  // Behaviour.
  FaultReset fault_reset = FaultReset::edge;
  std::int32_t fault_reset_hold_ms = 20;      ///< how long bit 7 stays set
  std::int32_t transition_timeout_ms = 2000;  ///< a state transition not followed for so long is a refusal
  bool halt = true;                  ///< bit 8 of the controlword stops a motion that the drive leads;
                                     ///< false: its quick stop has to, which takes the power
  std::int64_t handover_counts = 0;  ///< at Operation enabled the target may differ from the preset by so
                                     ///< much; 0: a quarter of counts_per_rev
  /// Bit of 60FEh:01 that works the holding brake, -1: none; 60FEh:01 must be mapped. Boot writes the engaged
  /// value first; a drive that needs the mask 60FEh:02 gets it by `settings`, after that.
  std::int8_t brake_bit = -1;
  bool brake_bit_releases =
      true;  ///< 1 in that bit releases the brake; FALSE for bit 0 of CiA 402, "set brake"

  /// Numbers of 6098h that differ from CiA 402-2: method 37 (the present position is home) is 35 in drives
  /// made to its first edition.
  std::int8_t homing_method_here = 37;
  bool homing_method_none = true;  ///< 6098h takes 0, "no homing": written where the drive is not to home
  bool homing_method_list = true;  ///< false: its 60E3h cannot be trusted, the method is not looked for there

  std::vector<SdoSetting> settings;
  std::vector<ErrorText> error_texts;
};

/// Whether the drive notices by itself that its control has died: heartbeat consumer 1016h or life guarding
/// with a reaction 6007h, or a deadline of an RPDO.
bool stops_by_itself(const DriveProfile& profile) noexcept;
/// The same without the reaction, of a device whose reaction is no 6007h: an I/O module has its error modes.
bool notices_silence(const DriveProfile& profile) noexcept;

/// PDO maps for a position axis: RPDO1 6040h 607Ah, TPDO1 6041h 6064h; everything else (mode, touch probe,
/// error code) goes over SDO, which three drives at 1 Mbit/s and 1 ms leave room for. Fills rpdo, tpdo and
/// modes. Not real-time safe.
void use_short_position_map(DriveProfile& profile);
/// As above with 6060h in RPDO1, RPDO2 60B8h, TPDO2 60B9h 60BAh and TPDO3 60FDh 6077h 603Fh: for longer
/// cycles.
void use_full_position_map(DriveProfile& profile);
/// PDO maps for a spindle: RPDO1 6040h 60FFh, TPDO1 6041h 6064h, TPDO2 606Ch 6077h every 10th SYNC; csv or pv
/// as in velocity_mode.
void use_velocity_map(DriveProfile& profile);

}  // namespace servogate::canopen
