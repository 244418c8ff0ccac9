// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/device/drive/servo.hpp"

namespace servogate::canopen {

/// Inputs of a drive in the order of DriveInputs::active.
enum class DriveInput : std::uint8_t { negative_limit, positive_limit, home, probe_1, probe_2 };
inline constexpr std::size_t kDriveInputs = 5;

/// Levels of the drive's inputs in one tick. Where an input has changed, edge_position is the encoder
/// position at which it did; the electronics latch it.
struct DriveInputs {
  std::array<bool, kDriveInputs> active{};
  std::array<std::int64_t, kDriveInputs> edge_position{};
  bool interlock = false;     ///< bit 3 of 60FDh
  std::uint16_t general = 0;  ///< bits 16-31 of 60FDh
  bool main_voltage = true;
  bool torque_allowed = true;  ///< no safe torque off
  bool hold_state = false;     ///< the state machine is stuck (fault injection)
  bool on(DriveInput input) const noexcept { return active[static_cast<std::size_t>(input)]; }
  std::int64_t edge(DriveInput input) const noexcept {
    return edge_position[static_cast<std::size_t>(input)];
  }
};

/// Methods that HomingSequence knows: 1-14, 17-30, 33-35, 37. Source: CiA 402-2, "Homing mode".
std::span<const int> supported_homing_methods() noexcept;

/// One homing, from start to rest: which speed to run at, and where home is. A method is a row of a table:
/// which signal, which way to search for it, in which direction and to which level its edge is crossed, and
/// whether the zero mark after it counts. real-time safe.
class HomingSequence {
 public:
  enum class State : std::uint8_t { idle, running, done, failed };

  /// False: the method is not supported.
  bool start(int method, const DriveInputs& inputs, const ServoState& servo) noexcept;
  /// Leaves the sequence (homing start bit taken away, mode change).
  void cancel() noexcept { state_ = State::idle; }
  /// Speed wanted now, signed counts/s. `standstill`: the shaft rests.
  double tick(const DriveInputs& inputs, const ServoState& servo, double switch_speed, double zero_speed,
              bool standstill) noexcept;
  State state() const noexcept { return state_; }
  /// Home position in encoder counts; valid in State::done.
  std::int64_t home() const noexcept { return home_; }

  struct Method {
    std::int8_t number;
    DriveInput signal;
    std::int8_t search;  ///< direction of the search for the signal
    std::int8_t cross;   ///< direction in which the edge is crossed
    bool to_active;      ///< level after the edge
    bool index;          ///< the next zero mark in direction `cross` is home
    bool only_index;
  };

 private:
  enum class Stage : std::uint8_t { search, back_out, cross, index, settle };
  double search(const DriveInputs& inputs, double speed) noexcept;
  double cross(const DriveInputs& inputs, const ServoState& servo, double speed) noexcept;
  double found(std::int64_t position) noexcept;
  bool against_limit(const DriveInputs& inputs, int direction) const noexcept;
  double fail() noexcept;

  State state_ = State::idle;
  Stage stage_ = Stage::search;
  Method method_{};
  int direction_ = 1;
  bool reversed_ = false;
  bool armed_ = false;  ///< the level before the edge was seen while moving in the right direction
  std::int64_t home_ = 0;
};

}  // namespace servogate::canopen
