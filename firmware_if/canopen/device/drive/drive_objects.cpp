// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/drive/drive_objects.hpp"

#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/device/drive/homing.hpp"
#include "firmware_if/canopen/device/drive/interpolation_buffer.hpp"

namespace servogate::canopen {
namespace {

using enum DataType;
using enum Access;
constexpr Mappable kNo = Mappable::no, kT = Mappable::tpdo, kR = Mappable::rpdo, kB = Mappable::both;

constexpr std::uint32_t kSupportedModes =
    supported_bit(OperationMode::profile_position) | supported_bit(OperationMode::velocity) |
    supported_bit(OperationMode::interpolated_position) | supported_bit(OperationMode::profile_velocity) |
    supported_bit(OperationMode::profile_torque) | supported_bit(OperationMode::homing) |
    supported_bit(OperationMode::cyclic_sync_position) | supported_bit(OperationMode::cyclic_sync_velocity) |
    supported_bit(OperationMode::cyclic_sync_torque);

// Values that depend on the ratings are filled in below.
constexpr ObjectSpec kRows[] = {
    {0x6007, 0, integer16, rw, kNo, 1, 0, 3},
    {0x603F, 0, unsigned16, ro, kT},
    {0x6040, 0, unsigned16, rw, kB},
    {0x6041, 0, unsigned16, ro, kT},
    {0x6042, 0, integer16, rw, kR},
    {0x6043, 0, integer16, ro, kT},
    {0x6044, 0, integer16, ro, kT},
    {0x6046, 0, unsigned8, constant, kNo, 2},
    {0x6046, 1, unsigned32, rw},
    {0x6046, 2, unsigned32, rw},
    {0x6048, 0, unsigned8, constant, kNo, 2},
    {0x6048, 1, unsigned32, rw, kNo, 0, 1},
    {0x6048, 2, unsigned16, rw, kNo, 1},
    {0x6049, 0, unsigned8, constant, kNo, 2},
    {0x6049, 1, unsigned32, rw, kNo, 0, 1},
    {0x6049, 2, unsigned16, rw, kNo, 1},
    {0x604A, 0, unsigned8, constant, kNo, 2},
    {0x604A, 1, unsigned32, rw, kNo, 0, 1},
    {0x604A, 2, unsigned16, rw, kNo, 1},
    {0x604B, 0, unsigned8, constant, kNo, 2},
    {0x604B, 1, integer16, rw, kNo, 1},
    {0x604B, 2, integer16, rw, kNo, 1},
    {0x604C, 0, unsigned8, constant, kNo, 2},
    {0x604C, 1, integer32, rw, kNo, 1},
    {0x604C, 2, integer32, rw, kNo, 1},
    {0x605A, 0, integer16, rw, kNo, 2, 0, 8},
    {0x605B, 0, integer16, rw, kNo, 0, 0, 1},
    {0x605C, 0, integer16, rw, kNo, 1, 0, 1},
    {0x605D, 0, integer16, rw, kNo, 1, 1, 4},
    {0x605E, 0, integer16, rw, kNo, 2, 0, 4},
    {0x6060, 0, integer8, rw, kB},
    {0x6061, 0, integer8, ro, kT},
    {0x6062, 0, integer32, ro, kT},
    {0x6063, 0, integer32, ro, kT},
    {0x6064, 0, integer32, ro, kT},
    {0x6065, 0, unsigned32, rw},
    {0x6066, 0, unsigned16, rw, kNo, 10},
    {0x6067, 0, unsigned32, rw},
    {0x6068, 0, unsigned16, rw, kNo, 5},
    {0x606B, 0, integer32, ro, kT},
    {0x606C, 0, integer32, ro, kT},
    {0x606D, 0, unsigned16, rw, kNo, 5000},
    {0x606E, 0, unsigned16, rw, kNo, 5},
    {0x606F, 0, unsigned16, rw, kNo, 5000},
    {0x6070, 0, unsigned16, rw, kNo, 5},
    {0x6071, 0, integer16, rw, kR},
    {0x6072, 0, unsigned16, rw, kR},
    {0x6074, 0, integer16, ro, kT},
    {0x6075, 0, unsigned32, rw},
    {0x6076, 0, unsigned32, rw},
    {0x6077, 0, integer16, ro, kT},
    {0x6078, 0, integer16, ro, kT},
    {0x6079, 0, unsigned32, ro, kT},
    {0x607A, 0, integer32, rw, kB},
    {0x607C, 0, integer32, rw},
    {0x607D, 0, unsigned8, constant, kNo, 2},
    {0x607D, 1, integer32, rw, kNo, -2147483648LL},
    {0x607D, 2, integer32, rw, kNo, 2147483647LL},
    {0x607E, 0, unsigned8, rw, kNo, 0, 0, 0},
    {0x607F, 0, unsigned32, rw, kR},
    {0x6080, 0, unsigned32, rw},
    {0x6081, 0, unsigned32, rw, kR},
    {0x6082, 0, unsigned32, rw, kR},
    {0x6083, 0, unsigned32, rw, kR, 0, 1},
    {0x6084, 0, unsigned32, rw, kR, 0, 1},
    {0x6085, 0, unsigned32, rw, kNo, 0, 1},
    {0x6086, 0, integer16, rw, kNo, 0, 0, 0},
    {0x6087, 0, unsigned32, rw, kNo, 1'000'000, 1},
    {0x608F, 0, unsigned8, constant, kNo, 2},
    {0x608F, 1, unsigned32, ro},
    {0x608F, 2, unsigned32, ro, kNo, 1},
    {0x6091, 0, unsigned8, constant, kNo, 2},
    {0x6091, 1, unsigned32, ro, kNo, 1},
    {0x6091, 2, unsigned32, ro, kNo, 1},
    {0x6092, 0, unsigned8, constant, kNo, 2},
    {0x6092, 1, unsigned32, ro},
    {0x6092, 2, unsigned32, ro, kNo, 1},
    {0x6098, 0, integer8, rw},
    {0x6099, 0, unsigned8, constant, kNo, 2},
    {0x6099, 1, unsigned32, rw, kNo, 0, 1},
    {0x6099, 2, unsigned32, rw, kNo, 0, 1},
    {0x609A, 0, unsigned32, rw, kNo, 0, 1},
    {0x60B0, 0, integer32, rw, kR},
    {0x60B1, 0, integer32, rw, kR},
    {0x60B2, 0, integer16, rw, kR},
    {0x60B8, 0, unsigned16, rw, kR},
    {0x60B9, 0, unsigned16, ro, kT},
    {0x60BA, 0, integer32, ro, kT},
    {0x60BB, 0, integer32, ro, kT},
    {0x60BC, 0, integer32, ro, kT},
    {0x60BD, 0, integer32, ro, kT},
    {0x60C0, 0, integer16, rw, kNo, 0, 0, 0},
    {0x60C1, 0, unsigned8, constant, kNo, 1},
    {0x60C1, 1, integer32, rw, kR},
    {0x60C2, 0, unsigned8, constant, kNo, 2},
    {0x60C2, 1, unsigned8, rw, kNo, 1, 0, 255},
    {0x60C2, 2, integer8, rw, kNo, -3, -6, 0},
    {0x60C4, 0, unsigned8, constant, kNo, 6},
    {0x60C4, 1, unsigned32, ro, kNo, InterpolationBuffer::kMost},
    {0x60C4, 2, unsigned32, rw, kNo, 1, 1, InterpolationBuffer::kMost},
    {0x60C4, 3, unsigned8, rw, kNo, 0, 0, 1},
    {0x60C4, 4, unsigned16, ro},
    {0x60C4, 5, unsigned8, wo, kNo, 4, 4, 4},
    {0x60C4, 6, unsigned8, wo, kNo, 1, 0, 1},
    {0x60C5, 0, unsigned32, rw, kNo, 0, 1},
    {0x60C6, 0, unsigned32, rw, kNo, 0, 1},
    {0x60D5, 0, unsigned16, ro, kT},
    {0x60D6, 0, unsigned16, ro, kT},
    {0x60D7, 0, unsigned16, ro, kT},
    {0x60D8, 0, unsigned16, ro, kT},
    {0x60E0, 0, unsigned16, rw, kR},
    {0x60E1, 0, unsigned16, rw, kR},
    {0x60F4, 0, integer32, ro, kT},
    {0x60FD, 0, unsigned32, ro, kT},
    {0x60FE, 0, unsigned8, constant, kNo, 2},
    {0x60FE, 1, unsigned32, rw, kR},
    {0x60FE, 2, unsigned32, rw, kNo, 0},
    {0x60FF, 0, integer32, rw, kR},
    {0x6502, 0, unsigned32, ro, kNo, kSupportedModes},
};

}  // namespace

std::vector<ObjectSpec> drive_objects(const DriveRatings& r) {
  std::vector<ObjectSpec> rows(std::begin(kRows), std::end(kRows));
  const auto set = [&rows](std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    for (ObjectSpec& s : rows)
      if (s.index == index && s.subindex == subindex) s.value = value;
  };
  const std::int64_t turn = r.counts_per_rev;
  const std::int64_t top = turn * r.max_speed_rpm / 60;
  set(object::kFollowingErrorWindow, 0, turn / 4);
  set(object::kPositionWindow, 0, turn / 1000 + 1);
  set(object::kMaxTorque, 0, r.peak_torque_permille);
  set(0x6075, 0, r.rated_current_ma);
  set(0x6076, 0, r.rated_torque_mnm);
  set(object::kVlMinMax, 2, r.max_speed_rpm);
  set(object::kVlAcceleration, 1, 600);  // rpm in a second: 10 turns/s^2 as 6083h
  set(object::kVlDeceleration, 1, 600);
  set(object::kVlQuickStop, 1, 6000);  // as 6085h
  set(object::kMaxProfileVelocity, 0, top);
  set(object::kMaxMotorSpeed, 0, r.max_speed_rpm);
  set(object::kProfileVelocity, 0, turn);
  set(object::kProfileAcceleration, 0, 10 * turn);
  set(object::kProfileDeceleration, 0, 10 * turn);
  set(object::kQuickStopDeceleration, 0, 100 * turn);
  set(object::kPositionEncoderResolution, 1, turn);
  set(object::kFeedConstant, 1, turn);
  set(object::kHomingSpeeds, 1, turn);
  set(object::kHomingSpeeds, 2, turn / 10 + 1);
  set(object::kHomingAcceleration, 0, 10 * turn);
  set(object::kMaxAcceleration, 0, 10'000 * turn > 0xFFFFFFFFLL ? 0xFFFFFFFFLL : 10'000 * turn);
  set(object::kMaxDeceleration, 0, 10'000 * turn > 0xFFFFFFFFLL ? 0xFFFFFFFFLL : 10'000 * turn);
  set(object::kPositiveTorqueLimit, 0, r.peak_torque_permille);
  set(object::kNegativeTorqueLimit, 0, r.peak_torque_permille);
  const DriveQuirks& q = r.quirks;
  std::uint8_t count = 0;
  for (const int method : supported_homing_methods())
    if (q.homing_method_list)
      rows.push_back({object::kSupportedHomingMethods, ++count, unsigned16, ro, kNo,
                      method == 37 ? q.homing_method_here : method});
  if (q.velocity_in_ip_record) {
    set(object::kInterpolationData, 0, 2);
    rows.push_back({object::kInterpolationData, 2, integer32, rw, kR});
  }
  if (q.interpolation_exponent < 1) set(object::kInterpolationTimePeriod, 2, q.interpolation_exponent);
  rows.push_back({object::kSupportedHomingMethods, 0, unsigned8, constant, kNo, count});
  return rows;
}

DriveVariables::DriveVariables(ObjectDictionary& od)
    : abort_connection_option(od.variable(object::kAbortConnectionOption)),
      error_code(od.variable(object::kErrorCode)),
      controlword(od.variable(object::kControlword)),
      statusword(od.variable(object::kStatusword)),
      quick_stop_option(od.variable(object::kQuickStopOption)),
      shutdown_option(od.variable(object::kShutdownOption)),
      disable_operation_option(od.variable(object::kDisableOperationOption)),
      halt_option(od.variable(object::kHaltOption)),
      fault_reaction_option(od.variable(object::kFaultReactionOption)),
      mode(od.variable(object::kModesOfOperation)),
      mode_display(od.variable(object::kModesOfOperationDisplay)),
      position_demand(od.variable(object::kPositionDemand)),
      position_internal(od.variable(object::kPositionActualInternal)),
      position_actual(od.variable(object::kPositionActual)),
      following_window(od.variable(object::kFollowingErrorWindow)),
      following_timeout(od.variable(object::kFollowingErrorTimeOut)),
      position_window(od.variable(object::kPositionWindow)),
      position_window_time(od.variable(object::kPositionWindowTime)),
      velocity_demand(od.variable(object::kVelocityDemand)),
      velocity_actual(od.variable(object::kVelocityActual)),
      velocity_window(od.variable(object::kVelocityWindow)),
      velocity_window_time(od.variable(object::kVelocityWindowTime)),
      velocity_threshold(od.variable(object::kVelocityThreshold)),
      velocity_threshold_time(od.variable(object::kVelocityThresholdTime)),
      target_torque(od.variable(object::kTargetTorque)),
      max_torque(od.variable(object::kMaxTorque)),
      torque_demand(od.variable(object::kTorqueDemand)),
      torque_actual(od.variable(object::kTorqueActual)),
      current_actual(od.variable(object::kCurrentActual)),
      dc_link(od.variable(object::kDcLinkVoltage)),
      target_position(od.variable(object::kTargetPosition)),
      home_offset(od.variable(object::kHomeOffset)),
      limit_min(od.variable(object::kSoftwarePositionLimit, 1)),
      limit_max(od.variable(object::kSoftwarePositionLimit, 2)),
      max_profile_velocity(od.variable(object::kMaxProfileVelocity)),
      max_motor_speed(od.variable(object::kMaxMotorSpeed)),
      profile_velocity(od.variable(object::kProfileVelocity)),
      end_velocity(od.variable(object::kEndVelocity)),
      profile_acceleration(od.variable(object::kProfileAcceleration)),
      profile_deceleration(od.variable(object::kProfileDeceleration)),
      quick_stop_deceleration(od.variable(object::kQuickStopDeceleration)),
      torque_slope(od.variable(object::kTorqueSlope)),
      homing_method(od.variable(object::kHomingMethod)),
      homing_speed_switch(od.variable(object::kHomingSpeeds, 1)),
      homing_speed_zero(od.variable(object::kHomingSpeeds, 2)),
      homing_acceleration(od.variable(object::kHomingAcceleration)),
      position_offset(od.variable(object::kPositionOffset)),
      velocity_offset(od.variable(object::kVelocityOffset)),
      torque_offset(od.variable(object::kTorqueOffset)),
      probe_function(od.variable(object::kTouchProbeFunction)),
      probe_status(od.variable(object::kTouchProbeStatus)),
      interpolation_time(od.variable(object::kInterpolationTimePeriod, 1)),
      interpolation_exponent(od.variable(object::kInterpolationTimePeriod, 2)),
      max_acceleration(od.variable(object::kMaxAcceleration)),
      max_deceleration(od.variable(object::kMaxDeceleration)),
      torque_limit_positive(od.variable(object::kPositiveTorqueLimit)),
      torque_limit_negative(od.variable(object::kNegativeTorqueLimit)),
      following_actual(od.variable(object::kFollowingErrorActual)),
      digital_inputs(od.variable(object::kDigitalInputs)),
      digital_outputs(od.variable(object::kDigitalOutputs, 1)),
      digital_output_mask(od.variable(object::kDigitalOutputs, 2)),
      target_velocity(od.variable(object::kTargetVelocity)),
      supported_modes(od.variable(object::kSupportedDriveModes)),
      vl_target(od.variable(object::kVlTargetVelocity)),
      vl_demand(od.variable(object::kVlVelocityDemand)),
      vl_actual(od.variable(object::kVlVelocityActual)),
      vl_min(od.variable(object::kVlMinMax, 1)),
      vl_max(od.variable(object::kVlMinMax, 2)),
      vl_acceleration_speed(od.variable(object::kVlAcceleration, 1)),
      vl_acceleration_time(od.variable(object::kVlAcceleration, 2)),
      vl_deceleration_speed(od.variable(object::kVlDeceleration, 1)),
      vl_deceleration_time(od.variable(object::kVlDeceleration, 2)),
      vl_quick_stop_speed(od.variable(object::kVlQuickStop, 1)),
      vl_quick_stop_time(od.variable(object::kVlQuickStop, 2)),
      vl_setpoint_numerator(od.variable(object::kVlSetpointFactor, 1)),
      vl_setpoint_denominator(od.variable(object::kVlSetpointFactor, 2)),
      vl_dimension_numerator(od.variable(object::kVlDimensionFactor, 1)),
      vl_dimension_denominator(od.variable(object::kVlDimensionFactor, 2)),
      ip_record(od.variable(object::kInterpolationData, 1)),
      ip_buffer_size(od.variable(object::kInterpolationBuffer, 2)),
      ip_buffer_organisation(od.variable(object::kInterpolationBuffer, 3)),
      ip_buffer_position(od.variable(object::kInterpolationBuffer, 4)),
      ip_buffer_clear(od.variable(object::kInterpolationBuffer, 6)) {}

}  // namespace servogate::canopen
