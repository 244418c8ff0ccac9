// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/402/drive_control.hpp"
#include "firmware_if/canopen/402/homing_watch.hpp"
#include "firmware_if/canopen/402/set_point_handshake.hpp"
#include "firmware_if/canopen/402/touch_probe.hpp"
#include "firmware_if/canopen/master/pdo/node_link.hpp"

namespace servogate::canopen {

/// One CiA 402 drive behind a CAN node: turns image::DriveCommand into objects and objects into
/// image::DriveFeedback. An object that is mapped travels by PDO, any other by SDO; of a drive that only
/// answers SDO controlword, target, statusword and actual value go round by turns. All but the constructor is
/// real-time safe.
class DriveLink final : public NodeLink {
 public:
  DriveLink(const NodeConfig& node, const SegmentConfig& segment);

  ProcessData& process_data() noexcept override { return data_; }
  void restart() noexcept override;
  bool update() noexcept override;
  PdoWatch::Overdue overdue() const noexcept override;
  /// Cycles (of a PDO on every n-th SYNC: PDOs) that the actual values are behind.
  std::uint32_t missed() const noexcept;
  void on_emcy(std::uint16_t error_code) noexcept override;
  void fill(image::DriveFeedback& feedback) const noexcept;

  /// Puts the command into the RPDOs. `blocked` lets a drive that has been lost ramp down by itself instead
  /// of obeying the command; it stays off until power has been withdrawn once.
  void apply(image::Nanoseconds now, const image::DriveCommand& command, bool blocked) noexcept;

  void start_access(image::Nanoseconds now, SdoClient& sdo) noexcept override;
  bool finish_access(const SdoClient& sdo) noexcept override;
  bool access_running() const noexcept override { return access_ != Access::none; }

  std::uint16_t statusword() const noexcept override { return statusword_; }
  /// 603Fh or the last emergency message.
  std::uint16_t error_code() const noexcept { return error_code_; }
  bool in_fault() const noexcept {
    return control_.state() == image::DriveState::fault ||
           control_.state() == image::DriveState::fault_reaction_active;
  }
  const image::DriveRefusal& refusal() const noexcept { return control_.refusal(); }
  /// Distance of command and held target while the hand-over waits at Operation enabled, otherwise 0.
  std::int64_t handover_difference() const noexcept { return handover_difference_; }
  /// So long, in ms, a drive in interpolated position mode has been asked to interpolate and does not show
  /// it, once that is longer than a transition may take; otherwise 0.
  std::int32_t interpolation_waited_ms() const noexcept { return interpolation_waited_ms_; }

 private:
  enum class Access : std::uint8_t {
    none,
    write_control,
    write_target,
    read_status,
    read_actual,
    write_buffer,
    write_mode,
    read_mode,
    write_probe,
    read_probe_status,
    read_probe_value,
    read_error_code
  };

  void take_position() noexcept;
  void take_velocity() noexcept;
  void follow_state() noexcept;
  void take_probe_by_pdo() noexcept;
  bool mode_ready() const noexcept { return mode_shown_ == static_cast<std::int8_t>(mode_wanted_); }
  OperationMode mode_of(image::DriveMode mode) const noexcept;
  void show_mode(std::int8_t shown) noexcept;
  void follow_halt(const image::DriveCommand& command) noexcept;
  std::int64_t target_position(const image::DriveCommand& command) noexcept;
  void set_targets(const image::DriveCommand& command, std::int64_t target) noexcept;
  std::uint16_t mode_bits(image::Nanoseconds now, std::int64_t target) noexcept;
  void follow_interpolation() noexcept;
  void watch_interpolation(image::Nanoseconds now) noexcept;
  bool interpolating() const noexcept;
  Access next_access(image::Nanoseconds now) noexcept;
  Access next_in_round() noexcept;
  Access next_object(image::Nanoseconds now) const noexcept;
  PdoField field_of(Access access) const noexcept;
  void start_field(Access access, SdoClient& sdo) noexcept;
  void take_field(Access access, const SdoClient& sdo) noexcept;
  bool take_result(Access access, const SdoClient& sdo) noexcept;

  DriveProfile profile_;
  DriveTarget target_;
  image::Nanoseconds cycle_ns_;
  PdoWatch watch_;
  std::int64_t handover_counts_;
  ProcessData data_;
  struct {
    PdoField controlword, target_position, target_velocity, target_torque, mode, probe_function,
        velocity_offset, ip_velocity, vl_velocity, digital_outputs;
  } out_;
  struct {
    PdoField statusword, position, velocity, torque, inputs, error_code, mode, probe_status;
  } in_;

  DriveControl control_;
  TouchProbe probe_;
  HomingWatch homing_;
  SetPointHandshake set_points_;

  std::uint16_t statusword_ = 0;
  bool status_known_ = false;
  bool position_known_ = false;
  std::int64_t position_counts_ = 0;
  std::int64_t last_position_counts_ = 0;
  std::int64_t cycles_since_position_ = 0;
  double velocity_counts_s_ = 0.0;
  double speed_unit_ = 1.0;  ///< of the object that `velocity` is
  image::DriveState last_state_ = image::DriveState::offline;
  std::uint16_t error_code_ = 0;
  bool error_code_wanted_ = false;

  OperationMode mode_wanted_ = OperationMode::none;
  OperationMode mode_written_ = OperationMode::none;
  std::int8_t mode_shown_ = 0;
  image::DriveMode mode_meant_ = image::DriveMode::none;  ///< by mode_shown_
  image::Nanoseconds mode_read_ns_ = 0;
  bool mode_refused_ = false;

  std::uint16_t probe_function_written_ = 0;
  bool probe_function_known_ = false;
  bool probe_refused_ = false;

  bool stopping_ = false;  ///< a drive without halt bit: its quick stop is under way
  bool following_ = false;
  std::int64_t held_target_ = 0;
  std::int64_t handover_difference_ = 0;
  Access access_ = Access::none;
  std::uint32_t access_value_ = 0;  ///< what a running write carries

  std::optional<image::Nanoseconds> interpolation_asked_ns_;  ///< since then
  std::int32_t interpolation_waited_ms_ = 0;

  /// 60C4h:06 as it is to be and as the drive has it.
  bool buffer_open_wanted_ = false, buffer_open_ = false, buffer_refused_ = false;

  // Of a drive that only answers SDO.
  std::int64_t answer_cycles_ = 0;  ///< wait for an answer, then the node is lost
  std::int64_t waited_ = 0;         ///< cycles without an answer
  std::int64_t actual_age_ = 0;
  std::uint8_t turn_ = 0;
  std::optional<std::uint32_t> control_written_, target_written_;
};

}  // namespace servogate::canopen
