// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"

namespace servogate::canopen {

/// Objects that the shared vocabulary does not name.
namespace object {
inline constexpr std::uint16_t kVelocityDemand = 0x606B, kPositionWindowTime = 0x6068,
                               kVelocityWindow = 0x606D, kVelocityWindowTime = 0x606E,
                               kVelocityThreshold = 0x606F, kVelocityThresholdTime = 0x6070,
                               kEndVelocity = 0x6082, kProbeCounter = 0x60D5,  ///< 60D5h-60D8h
    kPositiveTorqueLimit = 0x60E0, kNegativeTorqueLimit = 0x60E1, kInterpolationSubMode = 0x60C0;
}  // namespace object

/// Where drives on the market differ from CiA 402-2. A drive to the standard has the defaults.
struct DriveQuirks {
  bool halt = true;  ///< bit 8 of the controlword acts
  std::int64_t fault_reset_level_ns =
      0;  ///< > 0: bit 7 resets a fault when it has been set for so long, by no edge
  std::int8_t homing_method_here = 37;  ///< number of method 37, under which it is known only
  bool homing_method_none = true;       ///< 6098h takes 0
  bool homing_method_list = true;       ///< false: 60E3h is empty
  /// The brake is never open without torque, whatever 60FEh says.
  bool brake_interlock = false;
  bool velocity_in_ip_record = false;      ///< 60C1h:02 is a velocity, and a record is complete with it
  std::int8_t interpolation_exponent = 1;  ///< the one that 60C2h:02 takes; 1: any
};

/// Values of the name plate that the defaults of the objects depend on.
struct DriveRatings {
  std::uint32_t counts_per_rev = 262'144;
  std::uint32_t rated_torque_mnm = 2'400;
  std::uint32_t rated_current_ma = 3'000;
  std::uint16_t peak_torque_permille = 3'000;
  std::uint32_t max_speed_rpm = 5'000;
  DriveQuirks quirks = {};
};

/// The rows 6000h-67FFh of a servo drive. Position unit: encoder count; velocity: counts/s; acceleration:
/// counts/s^2. Not real-time safe.
std::vector<ObjectSpec> drive_objects(const DriveRatings& ratings);

/// The variables behind those rows, by name, so that the cyclic path searches nothing.
struct DriveVariables {
  explicit DriveVariables(ObjectDictionary& od);
  std::int64_t &abort_connection_option, &error_code, &controlword, &statusword, &quick_stop_option,
      &shutdown_option, &disable_operation_option, &halt_option, &fault_reaction_option, &mode, &mode_display,
      &position_demand, &position_internal, &position_actual, &following_window, &following_timeout,
      &position_window, &position_window_time, &velocity_demand, &velocity_actual, &velocity_window,
      &velocity_window_time, &velocity_threshold, &velocity_threshold_time, &target_torque, &max_torque,
      &torque_demand, &torque_actual, &current_actual, &dc_link, &target_position, &home_offset, &limit_min,
      &limit_max, &max_profile_velocity, &max_motor_speed, &profile_velocity, &end_velocity,
      &profile_acceleration, &profile_deceleration, &quick_stop_deceleration, &torque_slope, &homing_method,
      &homing_speed_switch, &homing_speed_zero, &homing_acceleration, &position_offset, &velocity_offset,
      &torque_offset, &probe_function, &probe_status, &interpolation_time, &interpolation_exponent,
      &max_acceleration, &max_deceleration, &torque_limit_positive, &torque_limit_negative, &following_actual,
      &digital_inputs, &digital_outputs, &digital_output_mask, &target_velocity, &supported_modes, &vl_target,
      &vl_demand, &vl_actual, &vl_min, &vl_max, &vl_acceleration_speed, &vl_acceleration_time,
      &vl_deceleration_speed, &vl_deceleration_time, &vl_quick_stop_speed, &vl_quick_stop_time,
      &vl_setpoint_numerator, &vl_setpoint_denominator, &vl_dimension_numerator, &vl_dimension_denominator,
      &ip_record, &ip_buffer_size, &ip_buffer_organisation, &ip_buffer_position, &ip_buffer_clear;
};

}  // namespace servogate::canopen
