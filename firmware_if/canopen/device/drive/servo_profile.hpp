// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/device/drive/drive_objects.hpp"
#include "firmware_if/canopen/device/drive/homing.hpp"
#include "firmware_if/canopen/device/drive/interpolation_buffer.hpp"
#include "firmware_if/canopen/device/drive/motion_profile.hpp"
#include "firmware_if/canopen/device/drive/power_state.hpp"
#include "firmware_if/canopen/device/drive/probe_latch.hpp"
#include "firmware_if/canopen/device/drive/servo.hpp"
#include "firmware_if/canopen/device/node/slave.hpp"

namespace servogate::canopen {

/// How a drive is built.
struct ServoProfileSettings {
  image::Nanoseconds servo_period = 250'000;
  std::int64_t counts_per_rev = 262'144;
  image::Nanoseconds brake_release = 0, brake_engage = 0;  ///< 0: no holding brake
  DriveQuirks quirks = {};
  bool limit_switches_stop = true;  ///< the drive itself stops at its limit inputs, outside of homing
};

/// A CiA 402 servo drive between object dictionary and servo loops: state machine, modes pp, vl, pv, tq,
/// hm, ip, csp, csv and cst, halt and stop ramps, touch probe, supervision. One tick() a servo period turns
/// what the servo measures into what it shall do. No knowledge of CAN. real-time safe but for the
/// constructor.
class ServoProfile final : public DeviceProfile {
 public:
  ServoProfile(ObjectDictionary& dictionary, const ServoProfileSettings& settings);
  /// Where errors are told; to be called before the first tick.
  void connect(EmcyProducer& emcy) noexcept { emcy_ = &emcy; }
  /// Power-on: the encoder shows `encoder`, which the drive calls `position`.
  void power_on(std::int64_t encoder, std::int64_t position) noexcept;

  /// One servo period.
  const ServoCommand& tick(const ServoState& servo, const DriveInputs& inputs) noexcept;

  /// An error of the drive: EMCY, 603Fh, fault reaction. `coast`: the power stage must go off at once.
  void fault(std::uint16_t error_code, bool coast, std::uint32_t detail = 0) noexcept;
  /// While true a fault cannot be reset.
  void hold_fault(bool cause_present) noexcept { fault_cause_ = cause_present; }
  image::DriveState state() const noexcept { return power_.state(); }
  std::uint16_t statusword() const noexcept;
  std::uint16_t error_code() const noexcept { return static_cast<std::uint16_t>(v_.error_code); }
  /// Position of 6064h before it is cut to 32 bits.
  std::int64_t position() const noexcept { return servo_.position - origin_; }

  /// For whoever leaves out ticks that would change nothing: all that tick() goes by and changes here but for
  /// the time inside of the window. The rest of it are objects from 6000h on.
  std::span<const std::byte> inner_state() const noexcept {
    const auto* const first = reinterpret_cast<const std::byte*>(&power_);
    return {first, reinterpret_cast<const std::byte*>(this + 1)};
  }
  /// A target that came again while the axis rests there asks for nothing.
  void drop_target_that_is_met() noexcept;
  std::optional<double> time_in_window() const noexcept { return window_time_; }
  /// A tick went by since `before`, and did nothing else with that time than to count it.
  bool only_counts_window(std::optional<double> before) const noexcept {
    return mode_ == OperationMode::profile_velocity && before && window_time_ &&
           *window_time_ == *before + h_;
  }
  void count_window() noexcept { *window_time_ += h_; }

  AbortCode before_write(ObjectDictionary::Slot slot, std::int64_t value) noexcept override;
  void after_write(ObjectDictionary::Slot slot) noexcept override;
  void refresh() noexcept override;
  void on_abort_connection(std::uint16_t error_code) noexcept override;
  void on_store() noexcept override;
  void on_sync(image::Nanoseconds now) noexcept override;
  void on_reset() noexcept override;
  bool store_node(NodeId, std::uint32_t bit_s) noexcept override { return bit_s == 0; }

 private:
  bool brake_released() const noexcept;
  void decide() noexcept;
  void state_changed(image::DriveState before) noexcept;
  void supervise() noexcept;
  void select_mode() noexcept;
  void generate() noexcept;
  void run_mode() noexcept;
  void hold_actual() noexcept;
  void command_position() noexcept {
    command_.loop = ServoCommand::Loop::position;
    command_.position = demand_.position;
    command_.velocity = demand_.velocity;
    command_.acceleration = demand_.acceleration;
    command_.torque = 0.0;
  }
  void stop_motion(StopKind kind, double slow_down) noexcept;
  double slow_down() const noexcept;
  double quick_stop_ramp() const noexcept;
  bool stopped_by_limit_switch(double direction) const noexcept {
    if (!settings_.limit_switches_stop) return false;
    return (direction > 0.0 && inputs_.on(DriveInput::positive_limit)) ||
           (direction < 0.0 && inputs_.on(DriveInput::negative_limit));
  }
  bool halted() const noexcept { return settings_.quirks.halt && (v_.controlword & controlword::kHalt); }
  AbortCode homing_method_taken(std::int64_t value) const noexcept;

  void cyclic_position() noexcept;
  void plan_cyclic_segment(double target) noexcept;
  void cyclic_velocity() noexcept;
  void cyclic_torque() noexcept;
  void profile_velocity() noexcept;
  void profile_torque() noexcept;
  void profile_position() noexcept;
  void take_set_points() noexcept;
  void start_set_point() noexcept;
  void forget_set_points() noexcept;
  SetPoint set_point_given() const noexcept;
  double target_of(const SetPoint& p) noexcept;
  double arrival_speed(double target) noexcept;
  void watch_window(bool inside) noexcept {
    if (!inside)
      window_time_.reset();
    else
      window_time_ = window_time_ ? *window_time_ + h_ : 0.0;
  }
  /// Inside of the window for as long as `window_ms` asks for; 0: as soon as it is inside.
  bool in_window(std::int64_t window_ms) const noexcept {
    return window_time_ && *window_time_ * 1e3 >= static_cast<double>(window_ms);
  }
  void position_to_target() noexcept;
  void go_on_behind_target() noexcept;
  void stop_at_limit_switch() noexcept;
  void homing() noexcept;
  void halt_homing() noexcept;
  void finish_homing() noexcept;

  void velocity_mode() noexcept;
  double vl_unit() const noexcept;
  double vl_ramp(std::int64_t delta_speed, std::int64_t delta_time) const noexcept;
  double vl_reference() noexcept;
  void interpolated_position() noexcept;
  bool interpolating() const noexcept;
  void buffer_configured(std::uint8_t subindex) noexcept;

  double target_from_object(std::int64_t object_value) noexcept;
  double limited_target(double target) noexcept;
  double within_limits(double target) const noexcept;
  double profile_speed() const noexcept;
  double acceleration_of(double asked) const noexcept;
  double deceleration_of(double asked) const noexcept;
  void ramp_to(double velocity, double acceleration, double deceleration) noexcept;
  double max_speed() const noexcept {
    return static_cast<double>(v_.max_motor_speed * settings_.counts_per_rev) / 60.0;
  }
  void interpolation_period_changed() noexcept;
  bool standstill() const noexcept {
    return std::abs(servo_.velocity) < 0.05 * static_cast<double>(settings_.counts_per_rev);
  }
  bool in_fault() const noexcept {
    return power_.state() == image::DriveState::fault ||
           power_.state() == image::DriveState::fault_reaction_active;
  }
  std::uint16_t mode_bits() const noexcept;

  ObjectDictionary& dictionary_;
  ServoProfileSettings settings_;
  DriveVariables v_;
  double h_;
  EmcyProducer* emcy_ = nullptr;
  /// How long the target (pp, pv) has been inside its window; nullopt: it is not.
  std::optional<double> window_time_;
  image::Nanoseconds sync_at_ = 0;
  PowerState power_;  ///< the first of inner_state()
  ProbeLatch probe_;
  HomingSequence homing_;
  OperationMode mode_ = OperationMode::none;

  ServoState servo_;
  DriveInputs inputs_;
  ServoCommand command_;
  std::int64_t origin_ = 0;  ///< encoder position of the drive's zero
  DriveSetpoint demand_;     ///< encoder counts
  double torque_demand_ = 0.0;
  std::uint16_t active_error_ = 0;
  bool fault_cause_ = false;
  bool internal_limit_ = false;
  bool at_rest_ = true;           ///< the stop under way has come to its end
  double following_error_ = 0.0;  ///< demand minus actual, both of the last tick
  double following_time_ = 0.0;
  bool following_exceeded_ = false;
  double threshold_time_ = 0.0;  ///< how long the speed (pv) has been above 606Fh

  // csp
  ObjectDictionary::Slot target_position_slot_, controlword_slot_, ip_record_slot_;
  bool new_target_ = false;
  int segment_ticks_ = 4, ticks_left_ = 0;
  double cyclic_target_ = 0.0;   ///< as commanded, unwrapped
  double segment_target_ = 0.0;  ///< where the segment under way ends
  double previous_segment_velocity_ = 0.0;
  // pp
  bool start_bit_ = false;
  bool set_point_active_ = false, set_point_waiting_ = false, set_point_acknowledged_ = false;
  SetPoint active_, waiting_;
  double active_target_ = 0.0;
  double passed_ = 0.0;  ///< the target was passed with 6082h: in this direction, 1 or -1
  // ip
  InterpolationBuffer buffer_;
  // hm
  bool homing_attained_ = false, homing_error_ = false;
};

}  // namespace servogate::canopen
