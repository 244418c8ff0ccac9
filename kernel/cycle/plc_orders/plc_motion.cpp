// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/plc_orders/plc_motion.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::cycle {

using image::Request;
using image::RequestKind;

namespace {

constexpr double kResetTime = 1.5;  ///< seconds; a drive takes up to one to take its fault back
constexpr std::uint16_t kNoPower = static_cast<std::uint16_t>(Refusal::not_powered);

consteval image::Place place(std::string_view name) { return image::field(image::kMotionFields, name); }

constexpr RequestKind kRequests[] = {
    RequestKind::axis_stop,     RequestKind::axis_home,     RequestKind::move_absolute,
    RequestKind::move_relative, RequestKind::move_velocity, RequestKind::axis_stop,
    RequestKind::none,          RequestKind::axis_reset,    RequestKind::torque};

}  // namespace

void PlcMotion::read(const image::ProcessImage& image, int axis) noexcept {
  const std::uint32_t base = image::motion_base(axis);
  const auto number = [&](const image::Place& p) { return image.packets.number(image::at(p, base)); };
  axis_ = axis;
  wanted_.number = static_cast<std::int32_t>(number(place("mc_order_number")));
  const auto order = static_cast<int>(number(place("mc_order")));
  wanted_.order = order <= static_cast<int>(Order::torque) ? static_cast<Order>(order) : Order::none;
  wanted_.power = number(place("mc_power")) != 0.0;
  const auto direction = static_cast<int>(number(place("mc_direction")));
  wanted_.direction =
      direction <= static_cast<int>(Direction::current) ? static_cast<Direction>(direction) : Direction::none;
  wanted_.target = number(place("mc_target"));
  wanted_.velocity = number(place("mc_velocity"));
  wanted_.acceleration = number(place("mc_acceleration"));
}

void PlcMotion::fail(std::uint16_t error) noexcept {
  result_ = Result::error;
  error_ = error;
}

void PlcMotion::watch(const axis::Axis& axis, const Alarms& alarms, double seconds) noexcept {
  if (axis.setpoint().v != 0.0) turned_down_ = axis.setpoint().v < 0.0;
  // The alarm of an enable that was taken away in motion comes a cycle later.
  if (power_ && !power_permitted_ && power_refusal_ == kNoPower && alarms.stop && axis.moving())
    power_refusal_ = alarms.number;
  powered_ = powered_ || axis.motion_permitted();
  const bool withdrawn = powered_ && !axis.power_permitted();
  if (power_ && power_permitted_ && (withdrawn || !axis.power_requested())) {  // it fell by itself
    power_permitted_ = false;
    withdraw_ = axis.power_requested();
    power_refusal_ = alarms.stop ? alarms.number : kNoPower;
  }
  if (resetting()) {
    reset_s_ += seconds;
    if (!alarms.stop) {
      error_stop_ = false;
      error_ = 0;
      result_ = Result::done;
    } else if (reset_s_ >= kResetTime) {
      fail(alarms.number);
    }
  }
  const bool ended = result_ != Result::under_way && !lasting();
  if (active_ != Order::none && active_ != Order::reset && !ended) watch_order(axis, alarms);
}

void PlcMotion::watch_order(const axis::Axis& axis, const Alarms& alarms) noexcept {
  if (result_ == Result::aborted || result_ == Result::error) return;
  if (active_ == Order::stop) {
    if (axis.standstill()) result_ = Result::done;
    return;
  }
  if (active_ == Order::home) {
    const axis::Homing::State homing = axis.homing().state();
    if (homing == axis::Homing::State::done) result_ = Result::done;
    if (axis.homing().active() || homing == axis::Homing::State::done) return;
    if (homing == axis::Homing::State::idle && axis.motion_permitted()) {  // somebody stopped it
      result_ = Result::aborted;
      return;
    }
    fail(axis.homing().failure() != 0 ? axis.homing().failure() : alarms.number);
    error_stop_ = true;
    return;
  }
  if (!axis.motion_permitted()) {
    if (!power_) {  // the PLC took it away itself
      result_ = Result::aborted;
      return;
    }
    fail(alarms.number != 0 ? alarms.number : kNoPower);
    error_stop_ = true;
    return;
  }
  if (active_ == Order::torque) {
    result_ = !axis.torque_led() ? Result::aborted : axis.torque_reached() ? Result::done : Result::under_way;
    return;
  }
  if (active_ == Order::velocity) {
    const bool at_speed = std::abs(std::abs(axis.setpoint().v) - wanted_speed_) <= 1e-9 * wanted_speed_;
    result_ = at_speed ? Result::done : Result::under_way;
    if (axis.plc_moves()) return;
    if (axis.setpoint().x == target_)
      fail(static_cast<std::uint16_t>(Refusal::at_soft_limit));
    else
      result_ = Result::aborted;
    return;
  }
  if (axis.plc_moves()) return;
  if (axis.setpoint().x != target_)
    result_ = Result::aborted;
  else if (axis.in_position())
    result_ = Result::done;
}

/// Machine position for a place of one turn, in the direction that was asked for. An endless rotary axis has
/// it once in every turn; the one that counts lies less than a turn from where the axis would come to rest if
/// it stopped now, so that a motion under way neither passes it nor turns back.
double PlcMotion::directed(const axis::Axis& axis) const noexcept {
  constexpr double kTurn = 360.0, kSame = 1e-6;
  const axis::AxisConfig& config = axis.config();
  if (wanted_.direction == Direction::none || !config.rotary || config.travel_limited) return wanted_.target;
  const axis::MotionState& now = axis.setpoint();
  const double acceleration = wanted_.acceleration > 0.0
                                  ? std::min(wanted_.acceleration, config.limits.acceleration)
                                  : config.limits.acceleration;
  const double jerk = config.limits.jerk;
  // Speed once the acceleration present has been taken away, and the way to rest from it.
  const double v = now.v + now.a * std::abs(now.a) / (2.0 * jerk);
  const double stop = now.x + v * (std::abs(v) / (2.0 * acceleration) + acceleration / (2.0 * jerk));
  double ahead = std::fmod(wanted_.target - stop, kTurn);
  if (ahead < -kSame) ahead += kTurn;
  if (ahead > kTurn - kSame) ahead -= kTurn;
  const bool down = wanted_.direction == Direction::negative ||
                    (wanted_.direction == Direction::current && turned_down_) ||
                    (wanted_.direction == Direction::shortest && ahead > kTurn / 2.0);
  if (down && ahead > kSame) ahead -= kTurn;
  // Whole turns from the target, so that the place itself is not rounded.
  return wanted_.target + kTurn * std::round((stop + ahead - wanted_.target) / kTurn);
}

bool PlcMotion::next(Request& request, const axis::Axis& axis) noexcept {
  request = {};
  request.asker = image::Asker::plc;
  request.axis = static_cast<std::int8_t>(axis_);
  // An axis in motion first comes to rest by the alarm of the enable that it has lost.
  const bool withdraws = withdraw_ && !axis.moving();
  if (wanted_.power != power_ || withdraws) {
    request.kind = RequestKind::axis_power;
    request.value = wanted_.power && !withdraws ? 1.0 : 0.0;
    return true;
  }
  if (wanted_.number == taken_) return false;
  request.kind = kRequests[static_cast<std::size_t>(wanted_.order)];
  if (request.kind == RequestKind::none) {
    taken_ = wanted_.number;
    refusal_ = 0;
    stopping_ = false;
    if (active_ == Order::stop) {
      active_ = Order::none;
      active_number_ = 0;
    }
    return false;
  }
  request.value = wanted_.order == Order::absolute ? directed(axis) : wanted_.target;
  request.velocity = wanted_.velocity;
  request.acceleration = wanted_.acceleration;
  return true;
}

void PlcMotion::answer(const Request& request, const image::Answer& answer, const axis::Axis& axis) noexcept {
  if (request.kind == RequestKind::axis_power) {
    power_ = wanted_.power;
    powered_ = false;
    if (withdraw_) {
      withdraw_ = false;
      if (power_ && request.value == 0.0) return;
    }
    power_refusal_ = answer.refusal;
    power_permitted_ = power_ && answer.refusal == 0;
    return;
  }
  taken_ = wanted_.number;
  refusal_ = answer.refusal;
  if (refusal_ == 0) begin(axis);
}

void PlcMotion::begin(const axis::Axis& axis) noexcept {
  active_ = wanted_.order;
  active_number_ = active_ == Order::none ? 0 : wanted_.number;
  result_ = Result::under_way;
  stopping_ = active_ == Order::stop;
  reset_s_ = 0.0;
  target_ = axis.plc_goal();
  wanted_speed_ = wanted_.velocity;
}

PlcMotion::State PlcMotion::state(const axis::Axis& axis) const noexcept {
  if (error_stop_) return State::error_stop;
  if (!axis.motion_permitted()) return State::disabled;
  if (stopping_) return State::stopping;
  if (axis.homing().active()) return State::homing;
  if (axis.torque_led()) return State::continuous_motion;
  if (axis.plc_moves()) return active_ == Order::velocity ? State::continuous_motion : State::discrete_motion;
  return axis.moving() ? State::discrete_motion : State::standstill;
}

void PlcMotion::write(image::ProcessImage& image, const axis::Axis& axis) const noexcept {
  const std::uint32_t base = image::motion_base(axis_);
  const auto put = [&](const image::Place& p, double value) {
    image.packets.set_number(image::at(p, base), value);
  };
  put(place("mc_taken"), taken_);
  put(place("mc_active"), active_number_);
  put(place("mc_refusal"), refusal_);
  put(place("mc_error"), error_);
  put(place("mc_state"), static_cast<double>(state(axis)));
  put(place("mc_result"), static_cast<double>(result_));
  put(place("mc_powered"), axis.motion_permitted() ? 1.0 : 0.0);
  put(place("mc_power_refusal"), power_refusal_);
  put(place("mc_torque"), axis.torque_percent());
  put(place("mc_position"), axis.actual());
}

}  // namespace servogate::cycle
