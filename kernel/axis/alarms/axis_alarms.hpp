// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/alarm_numbers.hpp"

/// Numbers of the alarms that this room raises; their texts stand in alarms/axis_rows.hpp.
namespace servogate::axis::alarm {

using image::AlarmNumber;

inline constexpr AlarmNumber kFollowingError = 1001;
inline constexpr AlarmNumber kSoftLimitPlus = 1002;
inline constexpr AlarmNumber kSoftLimitMinus = 1003;
inline constexpr AlarmNumber kHardLimitPlus = 1004;
inline constexpr AlarmNumber kHardLimitMinus = 1005;
inline constexpr AlarmNumber kBothLimits = 1006;
inline constexpr AlarmNumber kEncoderJump = 1007;
inline constexpr AlarmNumber kInPositionTimeout = 1008;
inline constexpr AlarmNumber kPowerLostInMotion = 1009;
inline constexpr AlarmNumber kEnableWithdrawn = 1010;
inline constexpr AlarmNumber kBrakeNoTorque = 1011;
inline constexpr AlarmNumber kBrakeSlips = 1012;
inline constexpr AlarmNumber kSetpointStep = 1013;
inline constexpr AlarmNumber kOffPath = 1015;
inline constexpr AlarmNumber kPlaceUnknown = 1016;
inline constexpr AlarmNumber kFollowingErrorHigh = 1017;
inline constexpr AlarmNumber kTorqueTooFast = 1018;
inline constexpr AlarmNumber kTorqueModeRefused = 1019;

inline constexpr AlarmNumber kHomingSwitchNotFound = 1101;
inline constexpr AlarmNumber kHomingSwitchNotReleased = 1102;
inline constexpr AlarmNumber kHomingIndexNotFound = 1103;
inline constexpr AlarmNumber kHomingTimeout = 1104;
inline constexpr AlarmNumber kHomingLimitAgain = 1105;
inline constexpr AlarmNumber kHomingNoReference = 1106;
inline constexpr AlarmNumber kHomingInterrupted = 1107;  ///< detail1: image::JogEnd, why; none: by its drive
inline constexpr AlarmNumber kHomingIndexNearEdge = 1108;
inline constexpr AlarmNumber kHomingDriveFailed = 1109;
inline constexpr AlarmNumber kHomingModeRefused = 1110;
inline constexpr AlarmNumber kHomingNoEdge = 1111;

inline constexpr AlarmNumber kSpindleNotAtSpeed = 1201;
inline constexpr AlarmNumber kSpindleOrientTimeout = 1202;
inline constexpr AlarmNumber kSpindleDriveFault = 1203;
inline constexpr AlarmNumber kSpindleNoEncoder = 1204;
inline constexpr AlarmNumber kSpindleNoReverse = 1205;
inline constexpr AlarmNumber kSpindleOutputLost = 1206;
inline constexpr AlarmNumber kSpindleDriveLost = 1207;
inline constexpr AlarmNumber kSpindleNotReady = 1208;
inline constexpr AlarmNumber kSpindleGear = 1209;
inline constexpr AlarmNumber kSpindleSyncLost = 1210;
inline constexpr AlarmNumber kSpindleNotSynchronous = 1211;
inline constexpr AlarmNumber kSpindleCoupled = 1212;
inline constexpr AlarmNumber kSpindleNoAxis = 1213;
inline constexpr AlarmNumber kSpindleIsAxis = 1214;

inline constexpr AlarmNumber kGearWindow = 1301;
inline constexpr AlarmNumber kGearTooFast = 1302;
inline constexpr AlarmNumber kGearMasterLost = 1303;
inline constexpr AlarmNumber kGearDisengaged = 1304;
inline constexpr AlarmNumber kGearNotInStep = 1305;

inline constexpr AlarmNumber kDriveFault = 2001;
inline constexpr AlarmNumber kDriveRefuses = 2002;
inline constexpr AlarmNumber kDriveOffline = 2003;
using image::alarm::kPdoMissing;  ///< whose row is that of the bus

}  // namespace servogate::axis::alarm

namespace servogate::axis {

/// The axis has lost its drive: AxisConfig::loss_reaction says what follows. real-time safe.
constexpr bool is_drive_loss(image::AlarmNumber number) noexcept {
  return number == alarm::kDriveOffline || number == alarm::kPdoMissing;
}

/// Why a gear was disengaged that nobody asked to be: detail1 of alarm::kGearDisengaged. detail2 of the
/// alarms of gears is the master: the place of an axis, or -1 minus that of a spindle.
enum class GearEnd : std::uint8_t {
  feed,   ///< the PLC took the feed enable of the follower away
  power,  ///< the follower lost its power or its enable
  alarm,  ///< an alarm stopped the follower
};

/// Something an axis or spindle found wrong in this cycle; the executive makes an alarm record of it.
struct Event {
  image::AlarmNumber number = 0;
  double limit = 0.0;    ///< what was allowed, in the unit of the alarm table
  double value = 0.0;    ///< what was met
  double detail1 = 0.0;  ///< further figures that the table names (following error: velocity ...)
  double detail2 = 0.0;  ///< ... (following error: torque in per mille of the rated one, NaN: not known)
};

/// Bounded list of the events of one cycle. real-time safe.
class Events {
 public:
  static constexpr int kCapacity = 8;
  /// Adds an event; drops it when the list is full (the first ones matter).
  void add(const Event& e) noexcept {
    if (count_ < kCapacity) items_[count_++] = e;
  }
  void clear() noexcept { count_ = 0; }
  const Event* begin() const noexcept { return items_; }
  const Event* end() const noexcept { return items_ + count_; }
  int size() const noexcept { return count_; }
  bool empty() const noexcept { return count_ == 0; }

 private:
  Event items_[kCapacity];
  int count_ = 0;
};

}  // namespace servogate::axis
