// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware_if/canopen/301/pdo_mapping.hpp"

namespace servogate::canopen {

/// Object indices by their names in CiA 301 and CiA 402-2.
namespace object {
// CiA 301
inline constexpr std::uint16_t kDeviceType = 0x1000, kErrorRegister = 0x1001, kPredefinedErrorField = 0x1003,
                               kCobIdSync = 0x1005, kCommunicationCyclePeriod = 0x1006,
                               kSynchronousWindowLength = 0x1007, kDeviceName = 0x1008,
                               kHardwareVersion = 0x1009, kSoftwareVersion = 0x100A, kGuardTime = 0x100C,
                               kLifeTimeFactor = 0x100D, kStoreParameters = 0x1010,
                               kRestoreParameters = 0x1011, kCobIdTime = 0x1012, kCobIdEmcy = 0x1014,
                               kInhibitTimeEmcy = 0x1015, kConsumerHeartbeatTime = 0x1016,
                               kProducerHeartbeatTime = 0x1017, kIdentity = 0x1018,
                               kSyncCounterOverflow = 0x1019, kErrorBehaviour = 0x1029,
                               kVerifyConfiguration = 0x1020, kProgramData = 0x1F50, kProgramControl = 0x1F51,
                               kRequestNmt = 0x1F82, kProgramIdentification = 0x1F56, kFlashStatus = 0x1F57,
                               kSdoServerParameter = 0x1200, kRpdoParameter = 0x1400, kRpdoMapping = 0x1600,
                               kTpdoParameter = 0x1800, kTpdoMapping = 0x1A00;
// CiA 402-2
inline constexpr std::uint16_t kAbortConnectionOption = 0x6007, kErrorCode = 0x603F, kControlword = 0x6040,
                               kStatusword = 0x6041, kQuickStopOption = 0x605A, kShutdownOption = 0x605B,
                               kDisableOperationOption = 0x605C, kHaltOption = 0x605D,
                               kFaultReactionOption = 0x605E, kVlTargetVelocity = 0x6042,
                               kVlVelocityDemand = 0x6043, kVlVelocityActual = 0x6044, kVlMinMax = 0x6046,
                               kVlAcceleration = 0x6048, kVlDeceleration = 0x6049, kVlQuickStop = 0x604A,
                               kVlSetpointFactor = 0x604B, kVlDimensionFactor = 0x604C,
                               kModesOfOperation = 0x6060, kModesOfOperationDisplay = 0x6061,
                               kPositionDemand = 0x6062, kPositionActualInternal = 0x6063,
                               kPositionActual = 0x6064, kFollowingErrorWindow = 0x6065,
                               kFollowingErrorTimeOut = 0x6066, kPositionWindow = 0x6067,
                               kVelocityActual = 0x606C, kTargetTorque = 0x6071, kMaxTorque = 0x6072,
                               kTorqueDemand = 0x6074, kTorqueActual = 0x6077, kCurrentActual = 0x6078,
                               kDcLinkVoltage = 0x6079, kTargetPosition = 0x607A, kHomeOffset = 0x607C,
                               kSoftwarePositionLimit = 0x607D, kPolarity = 0x607E,
                               kMaxProfileVelocity = 0x607F, kMaxMotorSpeed = 0x6080,
                               kProfileVelocity = 0x6081, kProfileAcceleration = 0x6083,
                               kProfileDeceleration = 0x6084, kQuickStopDeceleration = 0x6085,
                               kTorqueSlope = 0x6087, kTorqueProfileType = 0x6088,
                               kPositionEncoderResolution = 0x608F, kGearRatio = 0x6091,
                               kFeedConstant = 0x6092, kHomingMethod = 0x6098, kHomingSpeeds = 0x6099,
                               kHomingAcceleration = 0x609A, kPositionOffset = 0x60B0,
                               kVelocityOffset = 0x60B1, kTorqueOffset = 0x60B2, kTouchProbeFunction = 0x60B8,
                               kTouchProbeStatus = 0x60B9, kTouchProbe1Positive = 0x60BA,
                               kTouchProbe1Negative = 0x60BB, kTouchProbe2Positive = 0x60BC,
                               kTouchProbe2Negative = 0x60BD, kInterpolationData = 0x60C1,
                               kInterpolationTimePeriod = 0x60C2, kMaxAcceleration = 0x60C5,
                               kInterpolationBuffer = 0x60C4, kMaxDeceleration = 0x60C6,
                               kSupportedHomingMethods = 0x60E3, kFollowingErrorActual = 0x60F4,
                               kDigitalInputs = 0x60FD, kDigitalOutputs = 0x60FE, kTargetVelocity = 0x60FF,
                               kSupportedDriveModes = 0x6502;
}  // namespace object

/// Bits of the touch probe function 60B8h and status 60B9h (probe 1; probe 2 is the same, eight bits up).
/// Source: CiA 402-2, "Touch probe functionality".
namespace touch_probe {
inline constexpr std::uint16_t kEnable = 1u << 0, kContinuous = 1u << 1,
                               kZeroImpulse = 1u << 2,  ///< 0: the input
    kSamplePositive = 1u << 4, kSampleNegative = 1u << 5;
inline constexpr std::uint16_t kStatusEnabled = 1u << 0, kStatusPositiveStored = 1u << 1,
                               kStatusNegativeStored = 1u << 2;
inline constexpr int kProbe2Shift = 8;
}  // namespace touch_probe

/// 60C4h: its sub-index "buffer clear": 0 clears the buffer and closes it, 1 opens it. Write-only.
inline constexpr std::uint8_t kBufferClear = 6;

/// Bits of the digital inputs 60FDh. Source: CiA 402-2, "Object 60FDh".
namespace digital_input {
inline constexpr std::uint32_t kNegativeLimit = 1u << 0, kPositiveLimit = 1u << 1, kHomeSwitch = 1u << 2,
                               kInterlock = 1u << 3;
}

/// What a standard object is: name as in the standard, length in bits (0: a string or record), signed or not.
struct ObjectInfo {
  std::uint16_t index = 0;
  std::string_view name;
  std::uint8_t bits = 0;
  bool is_signed = false;
};
/// The objects above that have a row, in rising order. real-time safe.
std::span<const ObjectInfo> standard_objects() noexcept;
/// Row of an object, nullptr when it has none. PDO parameters 1400h+n, 1600h+n ... share one row. real-time
/// safe.
const ObjectInfo* find_object(std::uint16_t index) noexcept;
/// Its name; empty when unknown. real-time safe.
std::string_view object_name(std::uint16_t index) noexcept;

}  // namespace servogate::canopen
