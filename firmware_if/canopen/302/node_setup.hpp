// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace servogate::canopen {

/// 1020h: when the configuration of a node was made. Days since 1984-01-01 and milliseconds after midnight.
/// Source: CiA 302-3, "Verify configuration".
struct ConfigurationDate {
  std::uint32_t days = 0, milliseconds = 0;
};

/// Program of a node and what it says of itself once it runs. Source: CiA 302-3, "Program download".
struct NodeProgram {
  std::vector<std::uint8_t> image;   ///< for 1F50h; empty: the node is refused instead of programmed
  std::uint32_t identification = 0;  ///< 1F56h of the right program
  std::uint8_t number = 1;           ///< sub-index of 1F50h, 1F51h, 1F56h, 1F57h
};

/// Homing by the drive itself, in the drive's own units. Source: CiA 402-2, "Homing mode".
struct NodeHoming {
  std::int8_t method = 0;                          ///< 6098h; 0: the drive is not to home
  std::uint32_t speed_switch = 0, speed_zero = 0;  ///< 6099h
  std::uint32_t acceleration = 0;                  ///< 609Ah; 0: as it is
};

/// Change of speed of the velocity mode vl: so many units of 6042h in so many seconds.
struct VlRamp {
  std::uint32_t speed = 0;    ///< :01; 0: as it is
  std::uint16_t seconds = 1;  ///< :02
};
/// Velocity mode vl, in units of 6042h. Source: CiA 402-2, "Velocity mode".
struct NodeVl {
  std::uint32_t least = 0, most = 0;  ///< 6046h
  VlRamp ramp;                        ///< 6048h, 6049h, 604Ah
  /// 604Bh and 604Ch, numerator and denominator, as the unit of 6042h was computed from.
  std::int32_t set_point_factor[2] = {1, 1}, dimension_factor[2] = {1, 1};
};

/// Torque of the modes tq and cst. Source: CiA 402-2, "Profile torque mode".
struct NodeTorque {
  std::uint32_t slope = 0;  ///< 6087h, per mille of the rated torque in a second; 0: the drive has none (cst)
  std::uint32_t max_speed = 0;  ///< 6080h, rpm of the motor, where the drive has it
};

/// What one node, not its make, is to be before it may run. Everything may be left out.
struct NodeSetup {
  std::string software_version;  ///< 100Ah, compared to the letter
  std::optional<NodeProgram> program;
  std::vector<std::uint8_t> concise_dcf;  ///< as in 1F22h, written before the PDOs
  /// With it the concise DCF is written only where 1020h tells another date, which is written after it.
  std::optional<ConfigurationDate> configuration_date;
  bool store_configuration = false;  ///< what was written is stored by 1010h:01
  std::optional<NodeHoming> homing;
  std::optional<NodeVl> vl;
  std::optional<NodeTorque> torque;
  /// Ramp of a motion that the drive itself forms (profile velocity, profile position), in its own units:
  /// 6083h, 6084h; 0: as it is.
  std::uint32_t speed_ramp = 0;
  std::uint32_t profile_speed = 0;  ///< its greatest speed (profile position), 6081h; 0: as it is
  /// Deceleration of the drive's quick stop (6085h), in its own units; what device file or machine file write
  /// comes after it; 0: as it is.
  std::uint32_t quick_stop_ramp = 0;
  /// Of an encoder: counts per turn (6501h) and turns (6502h), compared. Source: CiA 406.
  std::optional<std::uint32_t> counts_per_rev, revolutions;
  std::int32_t boot_timeout_ms = 0;          ///< 0: the segment's
  std::int32_t boot_attempts = 0;            ///< 0: the segment's
  std::int32_t sdo_timeout_ms = 0;           ///< wait for each answer; 0: the segment's
  std::int32_t sdo_retries = -1;             ///< -1: the segment's
  std::int32_t program_timeout_ms = 60'000;  ///< of clearing and of writing the flash
};

}  // namespace servogate::canopen
