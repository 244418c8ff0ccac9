// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/objects.hpp"

#include <algorithm>
#include <iterator>

namespace servogate::canopen {
namespace {

using namespace object;
constexpr ObjectInfo kObjects[] = {
    {kDeviceType, "Device type", 32, false},
    {kErrorRegister, "Error register", 8, false},
    {kPredefinedErrorField, "Pre-defined error field", 0, false},
    {kCobIdSync, "COB-ID SYNC message", 32, false},
    {kCommunicationCyclePeriod, "Communication cycle period", 32, false},
    {kSynchronousWindowLength, "Synchronous window length", 32, false},
    {kDeviceName, "Manufacturer device name", 0, false},
    {kHardwareVersion, "Manufacturer hardware version", 0, false},
    {kSoftwareVersion, "Manufacturer software version", 0, false},
    {kGuardTime, "Guard time", 16, false},
    {kLifeTimeFactor, "Life time factor", 8, false},
    {kStoreParameters, "Store parameters", 0, false},
    {kRestoreParameters, "Restore default parameters", 0, false},
    {kCobIdTime, "COB-ID TIME", 32, false},
    {kCobIdEmcy, "COB-ID EMCY", 32, false},
    {kInhibitTimeEmcy, "Inhibit time EMCY", 16, false},
    {kConsumerHeartbeatTime, "Consumer heartbeat time", 0, false},
    {kProducerHeartbeatTime, "Producer heartbeat time", 16, false},
    {kIdentity, "Identity object", 0, false},
    {kSyncCounterOverflow, "Synchronous counter overflow value", 8, false},
    {kVerifyConfiguration, "Verify configuration", 0, false},
    {kErrorBehaviour, "Error behaviour", 0, false},
    {kSdoServerParameter, "SDO server parameter", 0, false},
    {kRpdoParameter, "RPDO communication parameter", 0, false},
    {kRpdoMapping, "RPDO mapping parameter", 0, false},
    {kTpdoParameter, "TPDO communication parameter", 0, false},
    {kTpdoMapping, "TPDO mapping parameter", 0, false},
    {kProgramData, "Program data", 0, false},
    {kProgramControl, "Program control", 0, false},
    {kProgramIdentification, "Program software identification", 0, false},
    {kFlashStatus, "Flash status identification", 0, false},
    {kAbortConnectionOption, "Abort connection option code", 16, true},
    {kErrorCode, "Error code", 16, false},
    {kControlword, "Controlword", 16, false},
    {kStatusword, "Statusword", 16, false},
    {kVlTargetVelocity, "vl target velocity", 16, true},
    {kVlVelocityDemand, "vl velocity demand", 16, true},
    {kVlVelocityActual, "vl velocity actual value", 16, true},
    {kVlMinMax, "vl velocity min max amount", 0, false},
    {kVlAcceleration, "vl velocity acceleration", 0, false},
    {kVlDeceleration, "vl velocity deceleration", 0, false},
    {kVlQuickStop, "vl velocity quick stop", 0, false},
    {kVlSetpointFactor, "vl set-point factor", 0, false},
    {kVlDimensionFactor, "vl dimension factor", 0, false},
    {kQuickStopOption, "Quick stop option code", 16, true},
    {kShutdownOption, "Shutdown option code", 16, true},
    {kDisableOperationOption, "Disable operation option code", 16, true},
    {kHaltOption, "Halt option code", 16, true},
    {kFaultReactionOption, "Fault reaction option code", 16, true},
    {kModesOfOperation, "Modes of operation", 8, true},
    {kModesOfOperationDisplay, "Modes of operation display", 8, true},
    {kPositionDemand, "Position demand value", 32, true},
    {kPositionActualInternal, "Position actual internal value", 32, true},
    {kPositionActual, "Position actual value", 32, true},
    {kFollowingErrorWindow, "Following error window", 32, false},
    {kFollowingErrorTimeOut, "Following error time out", 16, false},
    {kPositionWindow, "Position window", 32, false},
    {kVelocityActual, "Velocity actual value", 32, true},
    {kTargetTorque, "Target torque", 16, true},
    {kMaxTorque, "Max torque", 16, false},
    {kTorqueDemand, "Torque demand", 16, true},
    {kTorqueActual, "Torque actual value", 16, true},
    {kCurrentActual, "Current actual value", 16, true},
    {kDcLinkVoltage, "DC link circuit voltage", 32, false},
    {kTargetPosition, "Target position", 32, true},
    {kHomeOffset, "Home offset", 32, true},
    {kSoftwarePositionLimit, "Software position limit", 0, false},
    {kPolarity, "Polarity", 8, false},
    {kMaxProfileVelocity, "Max profile velocity", 32, false},
    {kMaxMotorSpeed, "Max motor speed", 32, false},
    {kProfileVelocity, "Profile velocity", 32, false},
    {kProfileAcceleration, "Profile acceleration", 32, false},
    {kProfileDeceleration, "Profile deceleration", 32, false},
    {kQuickStopDeceleration, "Quick stop deceleration", 32, false},
    {kTorqueSlope, "Torque slope", 32, false},
    {kTorqueProfileType, "Torque profile type", 16, true},
    {kPositionEncoderResolution, "Position encoder resolution", 0, false},
    {kGearRatio, "Gear ratio", 0, false},
    {kFeedConstant, "Feed constant", 0, false},
    {kHomingMethod, "Homing method", 8, true},
    {kHomingSpeeds, "Homing speeds", 0, false},
    {kHomingAcceleration, "Homing acceleration", 32, false},
    {kPositionOffset, "Position offset", 32, true},
    {kVelocityOffset, "Velocity offset", 32, true},
    {kTorqueOffset, "Torque offset", 16, true},
    {kTouchProbeFunction, "Touch probe function", 16, false},
    {kTouchProbeStatus, "Touch probe status", 16, false},
    {kTouchProbe1Positive, "Touch probe 1 positive edge", 32, true},
    {kTouchProbe1Negative, "Touch probe 1 negative edge", 32, true},
    {kTouchProbe2Positive, "Touch probe 2 positive edge", 32, true},
    {kTouchProbe2Negative, "Touch probe 2 negative edge", 32, true},
    {kInterpolationData, "Interpolation data record", 0, false},
    {kInterpolationTimePeriod, "Interpolation time period", 0, false},
    {kMaxAcceleration, "Max acceleration", 32, false},
    {kMaxDeceleration, "Max deceleration", 32, false},
    {kSupportedHomingMethods, "Supported homing methods", 0, false},
    {kFollowingErrorActual, "Following error actual value", 32, true},
    {0x60F9, "Velocity control parameter set", 0, false},
    {0x60FB, "Position control parameter set", 0, false},
    {kDigitalInputs, "Digital inputs", 32, false},
    {kDigitalOutputs, "Digital outputs", 0, false},
    {kTargetVelocity, "Target velocity", 32, true},
    {kSupportedDriveModes, "Supported drive modes", 32, false},
};

// PDO n is described at the index of PDO 1 plus n - 1, n up to 512.
std::uint16_t first_of_family(std::uint16_t index) noexcept {
  for (const std::uint16_t base : {kRpdoParameter, kRpdoMapping, kTpdoParameter, kTpdoMapping})
    if (index >= base && index < base + 0x200) return base;
  return index;
}

}  // namespace

std::span<const ObjectInfo> standard_objects() noexcept { return kObjects; }

const ObjectInfo* find_object(std::uint16_t index) noexcept {
  const auto row = std::ranges::lower_bound(kObjects, first_of_family(index), {}, &ObjectInfo::index);
  return row != std::end(kObjects) && row->index == first_of_family(index) ? row : nullptr;
}

std::string_view object_name(std::uint16_t index) noexcept {
  const ObjectInfo* info = find_object(index);
  return info ? info->name : std::string_view{};
}

}  // namespace servogate::canopen
