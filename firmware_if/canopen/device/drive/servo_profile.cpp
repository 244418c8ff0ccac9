// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/drive/servo_profile.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/statusword.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;

constexpr std::uint16_t kUnderVoltage = 0x3220, kFollowingError = 0x8611, kOverSpeed = 0x8400,
                        kSafeTorqueOff = 0xFF01;
constexpr std::int64_t kWindowOff = 0xFFFF'FFFF;
constexpr image::Nanoseconds kLongestPdoCycle = 100 * image::kMillisecond;
constexpr double kDcLinkMillivolts = 320'000.0;

// Bit of the error register for an error code. Source: CiA 301, 7.5.2.2 and the groups of 7.2.7.1.
constexpr std::uint8_t register_bit(std::uint16_t code) noexcept {
  switch (code >> 12) {
    case 0x0:
    case 0x1:
    case 0x9:  // generic and external errors have no bit but that of all
      return 0;
    case 0x2:
      return error_register::kCurrent;
    case 0x3:
      return error_register::kVoltage;
    case 0x4:
      return error_register::kTemperature;
    case 0xF:
      return error_register::kManufacturer;
    case 0x8:
      return code < 0x8300 ? error_register::kCommunication : error_register::kDeviceProfile;
    default:
      return error_register::kDeviceProfile;
  }
}

}  // namespace

ServoProfile::ServoProfile(ObjectDictionary& dictionary, const ServoProfileSettings& settings)
    : dictionary_(dictionary),
      settings_(settings),
      v_(dictionary),
      h_(static_cast<double>(settings.servo_period) * 1e-9),
      probe_(dictionary),
      target_position_slot_(dictionary.find(object::kTargetPosition, 0)),
      controlword_slot_(dictionary.find(object::kControlword, 0)),
      ip_record_slot_(
          dictionary.find(object::kInterpolationData, settings.quirks.velocity_in_ip_record ? 2 : 1)) {
  power_.set_fault_reset_level(settings.quirks.fault_reset_level_ns);
  power_.set_brake(settings.brake_release, settings.brake_engage);
  interpolation_period_changed();
}

void ServoProfile::power_on(std::int64_t encoder, std::int64_t position) noexcept {
  servo_.position = encoder;
  origin_ = encoder - position;
  on_reset();
}

void ServoProfile::on_reset() noexcept {
  power_.reset();
  probe_.reset();
  homing_.cancel();
  mode_ = OperationMode::none;
  active_error_ = 0;
  homing_attained_ = homing_error_ = false;
  forget_set_points();
  set_point_acknowledged_ = start_bit_ = false;
  new_target_ = false;
  buffer_ = {};
  buffer_configured(2);
  interpolation_period_changed();
  hold_actual();
}

// A controlword or target of yesterday must not act after the next power-on.
void ServoProfile::on_store() noexcept {
  for (const std::uint16_t command :
       {object::kControlword, object::kVlTargetVelocity, object::kTargetTorque, object::kTargetPosition,
        object::kPositionOffset, object::kVelocityOffset, object::kTorqueOffset, object::kTouchProbeFunction,
        object::kInterpolationData, object::kTargetVelocity})
    dictionary_.forget({command, command});
}

// A state that no PDO shows is one that its master never learns of.
void ServoProfile::on_sync(image::Nanoseconds now) noexcept {
  if (sync_at_ > 0) power_.set_pdo_cycle(std::clamp(now - sync_at_, image::kMillisecond, kLongestPdoCycle));
  sync_at_ = now;
}

AbortCode ServoProfile::before_write(ObjectDictionary::Slot slot, std::int64_t value) noexcept {
  const ObjectSpec& s = dictionary_.spec(slot);
  switch (s.index) {
    case object::kModesOfOperation:
      if (value == 0) return AbortCode::none;
      return value > 0 && (v_.supported_modes & supported_bit(static_cast<OperationMode>(value)))
                 ? AbortCode::none
                 : AbortCode::value_invalid;
    case object::kHomingMethod:
      return homing_method_taken(value);
    case object::kInterpolationTimePeriod: {
      const std::int8_t only = settings_.quirks.interpolation_exponent;
      return s.subindex == 2 && only < 1 && value != only ? AbortCode::value_invalid : AbortCode::none;
    }
    case object::kInterpolationData:
      return buffer_.takes_more() ? AbortCode::none : AbortCode::device_state;
    case object::kInterpolationBuffer:
      // It cannot be rearranged while the axis lives on it.
      return s.subindex <= 3 && mode_ == OperationMode::interpolated_position && interpolating()
                 ? AbortCode::device_state
                 : AbortCode::none;
    case object::kVlSetpointFactor:
    case object::kVlDimensionFactor:
      return value == 0 ? AbortCode::value_invalid : AbortCode::none;
    case object::kSoftwarePositionLimit:
      if (s.subindex == 1 && value > v_.limit_max) return AbortCode::maximum_below_minimum;
      return s.subindex == 2 && value < v_.limit_min ? AbortCode::maximum_below_minimum : AbortCode::none;
    default:
      return AbortCode::none;
  }
}

AbortCode ServoProfile::homing_method_taken(std::int64_t value) const noexcept {
  const DriveQuirks& q = settings_.quirks;
  bool known = value == 0 && q.homing_method_none;
  for (const int m : supported_homing_methods())
    known = known || (m == 37 ? q.homing_method_here : m) == value;
  return known ? AbortCode::none : AbortCode::value_invalid;
}

void ServoProfile::after_write(ObjectDictionary::Slot slot) noexcept {
  if (slot == controlword_slot_) return;
  if (slot == ip_record_slot_) {
    buffer_.push(v_.ip_record);
    return;
  }
  if (slot == target_position_slot_) {
    new_target_ = true;
    return;
  }
  const ObjectSpec& spec = dictionary_.spec(slot);
  if (spec.index == object::kInterpolationTimePeriod) interpolation_period_changed();
  if (spec.index == object::kInterpolationBuffer) buffer_configured(spec.subindex);
}

void ServoProfile::interpolation_period_changed() noexcept {
  const double seconds = static_cast<double>(v_.interpolation_time) *
                         std::pow(10.0, static_cast<double>(v_.interpolation_exponent));
  segment_ticks_ = std::max(1, static_cast<int>(std::lround(seconds / h_)));
}

// The mask gives bit 0 of 60FEh:01, "set brake", to whoever leads the drive. Source: CiA 402-2, "Object
// 60FEh: Digital outputs".
inline bool ServoProfile::brake_released() const noexcept {
  const bool by_bus = v_.digital_output_mask & 1;
  const bool own = power_.brake_released() || (by_bus && !settings_.quirks.brake_interlock);
  return own && !(by_bus && v_.digital_outputs & 1);
}

void ServoProfile::decide() noexcept {
  PowerInputs in;
  in.controlword = static_cast<std::uint16_t>(v_.controlword);
  in.options = {static_cast<std::int16_t>(v_.quick_stop_option),
                static_cast<std::int16_t>(v_.shutdown_option),
                static_cast<std::int16_t>(v_.disable_operation_option),
                static_cast<std::int16_t>(v_.fault_reaction_option)};
  in.main_voltage = inputs_.main_voltage;
  in.torque_allowed = inputs_.torque_allowed;
  in.standstill = at_rest_;
  in.fault_cause = fault_cause_;
  in.hold_state = inputs_.hold_state;
  const DriveState before = power_.state();
  const bool was_energised = power_.energised();
  power_.tick(in, settings_.servo_period);
  if (power_.energised() && !was_energised) hold_actual();
  if (power_.state() != before) state_changed(before);
}

void ServoProfile::state_changed(DriveState before) noexcept {
  if (before == DriveState::fault && active_error_ != 0) {
    if (emcy_) emcy_->clear(active_error_);
    active_error_ = 0;
    v_.error_code = 0;
  }
  if (power_.state() == DriveState::operation_enabled) {
    // A set-point given before belongs to the past; the mode begins where the shaft is.
    if (before != DriveState::quick_stop_active) hold_actual();
    start_bit_ = v_.controlword & controlword::kModeSpecific4;
    forget_set_points();
    new_target_ = false;
  }
}

void ServoProfile::fault(std::uint16_t error_code, bool coast, std::uint32_t detail) noexcept {
  if (in_fault() || active_error_ != 0) return;
  active_error_ = error_code;
  v_.error_code = error_code;
  power_.fault(coast);
  if (emcy_) emcy_->raise(error_code, register_bit(error_code), detail);
}

// 6007h. Source: CiA 402-2, "Object 6007h: Abort connection option code".
void ServoProfile::on_abort_connection(std::uint16_t error_code) noexcept {
  const bool moving = power_.energised();
  switch (v_.abort_connection_option) {
    case 1:
      if (!moving && error_code == 0) return;  // nothing is lost when nothing moves
      if (active_error_ == 0 && power_.state() != DriveState::fault) {
        active_error_ = error_code ? error_code : std::uint16_t{0x8100};
        v_.error_code = active_error_;
        if (emcy_) emcy_->raise(active_error_, register_bit(active_error_));
        power_.fault(false);
      }
      return;
    case 2:
      v_.controlword = controlword::kCommandDisableVoltage;
      return;
    case 3:
      if (moving) v_.controlword = controlword::kCommandQuickStop;
      return;
    default:
      return;
  }
}

// Bit 13 comes with the end of 6066h, not with the first tick outside of 6065h, and stays until the fault is
// reset. Source: CiA 402-2, "Object 6066h: Following error time out".
inline void ServoProfile::supervise() noexcept {
  if (!in_fault()) following_exceeded_ = false;
  if (!power_.energised()) {
    following_time_ = 0.0;
    return;
  }
  if (!inputs_.torque_allowed) fault(kSafeTorqueOff, true);
  if (!inputs_.main_voltage) fault(kUnderVoltage, true);
  if (std::abs(servo_.velocity) > 1.2 * max_speed()) fault(kOverSpeed, true);
  if (command_.loop != ServoCommand::Loop::position || v_.following_window == kWindowOff) return;
  const double error = std::abs(following_error_);
  if (error <= static_cast<double>(v_.following_window)) {
    following_time_ = 0.0;
    return;
  }
  following_time_ += h_;
  if (following_time_ * 1e3 <= static_cast<double>(v_.following_timeout)) return;
  following_exceeded_ = true;
  fault(kFollowingError, false);
}

void ServoProfile::hold_actual() noexcept {
  demand_ = {static_cast<double>(servo_.position), 0.0, 0.0};
  cyclic_target_ = demand_.position;
  ticks_left_ = 0;
  previous_segment_velocity_ = 0.0;
  torque_demand_ = 0.0;
}

inline void ServoProfile::generate() noexcept {
  internal_limit_ = false;
  const bool turns = std::abs(servo_.velocity) > static_cast<double>(v_.velocity_threshold);
  threshold_time_ = turns ? threshold_time_ + h_ : 0.0;
  const StopKind stop = power_.stop();
  if (stop == StopKind::none) at_rest_ = false;
  if (!power_.energised()) {
    command_.loop = ServoCommand::Loop::off;
    demand_ = {static_cast<double>(servo_.position), servo_.velocity, 0.0};
    at_rest_ = true;
  } else if (stop != StopKind::none) {
    stop_motion(stop, slow_down());
  } else if (!power_.following()) {
    command_position();
  } else if (halted() && mode_ != OperationMode::none) {
    halt_homing();
    stop_motion(static_cast<StopKind>(std::min<std::int64_t>(v_.halt_option, 3)), slow_down());
  } else {
    run_mode();
  }
}

const ServoCommand& ServoProfile::tick(const ServoState& servo, const DriveInputs& inputs) noexcept {
  servo_ = servo;
  inputs_ = inputs;
  if (probe_.enabled()) probe_.tick(inputs_, servo_, origin_);
  supervise();
  if (!power_.goes_on(static_cast<std::uint16_t>(v_.controlword))) decide();
  select_mode();
  generate();
  following_error_ = command_.position - static_cast<double>(servo_.position);
  command_.brake_released = brake_released();
  const auto most = static_cast<double>(v_.max_torque);
  command_.torque_limit_positive = std::min(most, static_cast<double>(v_.torque_limit_positive));
  command_.torque_limit_negative = std::min(most, static_cast<double>(v_.torque_limit_negative));
  return command_;
}

double ServoProfile::slow_down() const noexcept {
  if (mode_ == OperationMode::velocity) return vl_ramp(v_.vl_deceleration_speed, v_.vl_deceleration_time);
  return static_cast<double>(mode_ == OperationMode::homing ? v_.homing_acceleration
                                                            : v_.profile_deceleration);
}

double ServoProfile::quick_stop_ramp() const noexcept {
  if (mode_ == OperationMode::velocity) return vl_ramp(v_.vl_quick_stop_speed, v_.vl_quick_stop_time);
  return static_cast<double>(v_.quick_stop_deceleration);
}

// Brings the shaft to rest from whatever moves it, in position control so that it stays there.
void ServoProfile::stop_motion(StopKind kind, double slow_down) noexcept {
  if (command_.loop != ServoCommand::Loop::position)
    demand_ = {static_cast<double>(servo_.position), servo_.velocity, 0.0};
  // A halted positioning goes on afterwards, a stopped one does not.
  if (power_.stop() != StopKind::none) forget_set_points();
  if (kind == StopKind::torque_limit) {
    if (!standstill()) {
      command_.loop = ServoCommand::Loop::velocity;
      command_.velocity = command_.acceleration = command_.torque = 0.0;
      at_rest_ = false;
      return;
    }
    demand_.velocity = 0.0;
    demand_.acceleration = 0.0;
  } else {
    const double d = kind == StopKind::quick_stop_ramp ? quick_stop_ramp() : slow_down;
    ramp_to(0.0, d, d);
  }
  cyclic_target_ = demand_.position;
  ticks_left_ = 0;
  previous_segment_velocity_ = 0.0;
  command_position();
  at_rest_ = demand_.velocity == 0.0 && standstill();
}

std::uint16_t ServoProfile::statusword() const noexcept {
  using namespace statusword;
  auto word = static_cast<std::uint16_t>(encode_state(power_.state()) | kRemote);
  if (inputs_.main_voltage) word |= kVoltageEnabled;
  if (internal_limit_) word |= kInternalLimit;
  if (power_.state() == DriveState::operation_enabled) return static_cast<std::uint16_t>(word | mode_bits());
  if (power_.state() == DriveState::quick_stop_active && at_rest_) word |= kTargetReached;
  const bool positions =
      mode_ == OperationMode::profile_position || mode_ == OperationMode::cyclic_sync_position;
  if (in_fault() && positions && following_exceeded_) word |= kModeSpecific13;
  // Homing is still attained when the power is off.
  if (mode_ == OperationMode::homing && homing_attained_) word |= kModeSpecific12 | kTargetReached;
  return word;
}

void ServoProfile::refresh() noexcept {
  const auto cut = [](std::int64_t x) { return static_cast<std::int64_t>(static_cast<std::int32_t>(x)); };
  const std::int64_t actual = servo_.position - origin_;
  v_.statusword = statusword();
  v_.position_actual = v_.position_internal = cut(actual);
  v_.velocity_actual = static_cast<std::int64_t>(servo_.velocity);
  const bool controlled = command_.loop == ServoCommand::Loop::position;
  const std::int64_t demand =
      controlled ? static_cast<std::int64_t>(std::floor(command_.position + 0.5)) - origin_ : actual;
  v_.position_demand = cut(demand);
  v_.following_actual = cut(demand - actual);
  const double asked = power_.energised() ? command_.velocity : 0.0;
  v_.velocity_demand = static_cast<std::int64_t>(asked);
  if (asked == 0.0 && servo_.velocity == 0.0) {  // as most axes most of the time: nothing to convert
    v_.vl_demand = v_.vl_actual = 0;
  } else {
    const double unit = vl_unit();
    const auto speed = [unit](double counts_s) {
      return static_cast<std::int64_t>(std::clamp(std::round(counts_s / unit), -32768.0, 32767.0));
    };
    v_.vl_demand = speed(asked);
    v_.vl_actual = speed(servo_.velocity);
  }
  v_.ip_buffer_position = buffer_.count();
  v_.torque_actual = v_.current_actual = static_cast<std::int64_t>(servo_.torque);
  v_.torque_demand = static_cast<std::int64_t>(command_.loop == ServoCommand::Loop::torque ? command_.torque
                                                                                           : servo_.torque);
  v_.dc_link = inputs_.main_voltage ? static_cast<std::int64_t>(kDcLinkMillivolts) : 0;
  std::int64_t bits = static_cast<std::int64_t>(inputs_.general) << 16;
  for (std::size_t i = 0; i < 3; ++i) bits |= inputs_.active[i] ? std::int64_t{1} << i : 0;
  if (inputs_.interlock) bits |= std::int64_t{1} << 3;
  v_.digital_inputs = bits;
  v_.mode_display = static_cast<std::int64_t>(mode_);
}

}  // namespace servogate::canopen
