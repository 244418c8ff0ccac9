// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {

/// What the PLC asks of one auxiliary axis through the places of image::kMotionFields, as requests to the
/// gate, and what it hears of them. The states are those of PLCopen, function blocks for motion control,
/// part 1.
///
/// In each cycle, after the axis has read and before it is commanded, all real-time safe:
///     motion.read(image);
///     motion.watch(axis, alarms, seconds);
///     for (Request r; motion.next(r, axis);) motion.answer(r, handle(r), axis);
///     motion.write(image, axis);
class PlcMotion {
 public:
  /// Values of mc_state.
  enum class State : std::uint8_t {
    no_axis,
    disabled,
    standstill,
    homing,
    discrete_motion,
    continuous_motion,
    stopping,
    error_stop
  };
  /// What the alarms say.
  struct Alarms {
    bool stop = false;              ///< one of them stops motion
    image::AlarmNumber number = 0;  ///< the first one
  };

  /// What the PLC has written in this scan.
  void read(const image::ProcessImage& image, int axis) noexcept;
  /// Follows the order in force to its end.
  void watch(const axis::Axis& axis, const Alarms& alarms, double seconds) noexcept;
  /// The next thing that the PLC asks for: at most power and one order in a cycle.
  bool next(image::Request& request, const axis::Axis& axis) noexcept;
  /// The gate's decision, carried out already.
  void answer(const image::Request& request, const image::Answer& answer, const axis::Axis& axis) noexcept;
  void write(image::ProcessImage& image, const axis::Axis& axis) const noexcept;

  /// For the gate: a stop is in force, an error waits for its reset.
  bool stopping() const noexcept { return stopping_; }
  bool error_stop() const noexcept { return error_stop_; }
  /// The alarms of the axis are to be reset in this cycle: a drive needs a moment to take its fault back.
  bool resetting() const noexcept { return active_ == Order::reset && result_ == Result::under_way; }

 private:
  enum class Order : std::uint8_t {
    none,
    home,
    absolute,
    relative,
    velocity,
    stop,
    end_of_stop,
    reset,
    torque
  };
  enum class Result : std::uint8_t { under_way, done, aborted, error };

  State state(const axis::Axis& axis) const noexcept;
  void fail(std::uint16_t error) noexcept;
  void watch_order(const axis::Axis& axis, const Alarms& alarms) noexcept;
  void begin(const axis::Axis& axis) noexcept;
  /// It lasts until another order takes over, whatever has been reached.
  bool lasting() const noexcept { return active_ == Order::velocity || active_ == Order::torque; }
  double directed(const axis::Axis& axis) const noexcept;

  /// Values of mc_direction.
  enum class Direction : std::uint8_t { none, positive, shortest, negative, current };

  struct Wanted {
    std::int32_t number = 0;
    Order order = Order::none;
    bool power = false;
    Direction direction = Direction::none;
    double target = 0.0, velocity = 0.0, acceleration = 0.0;
  };
  int axis_ = 0;
  Wanted wanted_;
  bool power_ = false;  ///< as asked for last
  bool power_permitted_ = false;
  bool powered_ = false;   ///< the power asked for has come
  bool withdraw_ = false;  ///< what fell must not come back by itself
  std::uint16_t power_refusal_ = 0;
  std::int32_t taken_ = 0, active_number_ = 0;
  std::uint16_t refusal_ = 0, error_ = 0;
  Order active_ = Order::none;
  Result result_ = Result::under_way;
  double target_ = 0.0, wanted_speed_ = 0.0;  ///< of the order in force
  double reset_s_ = 0.0;
  bool turned_down_ = false;  ///< the way the axis turned last
  bool stopping_ = false;
  bool error_stop_ = false;
};

}  // namespace servogate::cycle
