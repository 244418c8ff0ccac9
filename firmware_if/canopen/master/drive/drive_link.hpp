// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/402/drive_control.hpp"
#include "firmware_if/canopen/402/homing_watch.hpp"
#include "firmware_if/canopen/402/touch_probe.hpp"
#include "firmware_if/canopen/master/node_link.hpp"
#include "firmware_if/canopen/master/segment_config.hpp"

namespace servogate::canopen {

/// One CiA 402 drive behind a CAN node: turns image::DriveCommand into objects and objects into
/// image::DriveFeedback. An object that is mapped travels by PDO, any other by SDO. All but the constructor
/// is real-time safe.
class DriveLink final : public NodeLink {
 public:
  DriveLink(const NodeConfig& node, const SegmentConfig& segment);

  ProcessData& process_data() noexcept override { return data_; }
  void restart() noexcept override;
  bool update() noexcept override;
  const PdoWatch& watch() const noexcept override { return watch_; }
  void on_emcy(std::uint16_t error_code) noexcept override;
  void fill(image::DriveFeedback& feedback) const noexcept;

  /// Puts the command into the RPDOs. `blocked` lets a drive that has been lost ramp down by itself instead
  /// of obeying the command; it stays off until power has been withdrawn once.
  void apply(image::Nanoseconds now, const image::DriveCommand& command, bool blocked) noexcept;

  void start_access(image::Nanoseconds now, SdoClient& sdo) noexcept override;
  bool finish_access(const SdoClient& sdo) noexcept override;
  bool access_running() const noexcept override { return access_ != Access::none; }

  std::uint16_t statusword() const noexcept override { return statusword_; }
  const image::DriveRefusal& refusal() const noexcept { return control_.refusal(); }
  /// Distance of command and held target while the hand-over waits at Operation enabled, otherwise 0.
  std::int64_t handover_difference() const noexcept { return handover_difference_; }

 private:
  enum class Access : std::uint8_t {
    none,
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
  void set_targets(const image::DriveCommand& command) noexcept;
  Access next_access(image::Nanoseconds now) const noexcept;
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

  std::uint16_t statusword_ = 0;
  bool status_known_ = false;
  bool position_known_ = false;
  std::int64_t position_counts_ = 0;
  std::int64_t last_position_counts_ = 0;
  std::int64_t cycles_since_position_ = 0;
  double velocity_counts_s_ = 0.0;
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
  std::uint16_t access_value_ = 0;  ///< what a running write carries
};

}  // namespace servogate::canopen
