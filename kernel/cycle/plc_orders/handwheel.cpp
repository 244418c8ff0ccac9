// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/plc_orders/handwheel.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/wheel_way.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {

using image::RequestKind;

namespace {

constexpr int kHandwheels = 2;

consteval image::Place of_machine(std::string_view name) {
  return image::field(image::kMachineFields, name, image::kMachineBase);
}
constexpr image::Place kCounters[kHandwheels] = {of_machine("handwheel1"), of_machine("handwheel2")};
constexpr image::Place kSteps[kHandwheels] = {of_machine("handwheel1_step"), of_machine("handwheel2_step")};
constexpr image::Place kSelection = image::field(image::kAxisFields, "handwheel");
constexpr image::Place kRefusal = image::field(image::kAxisFields, "handwheel_refusal");

}  // namespace

void Handwheel::read(const image::ProcessImage& image, int axis) noexcept {
  axis_ = axis;
  counts_ = 0;
  const auto wanted = static_cast<int>(image.packets.number(image::at(kSelection, image::axis_base(axis))));
  const int selected = wanted <= kHandwheels ? wanted : 0;
  const bool same = selected == selected_;
  changed_ = changed_ || !same;
  selected_ = selected;
  if (selected == 0) return;
  const auto wheel = static_cast<std::size_t>(selected - 1);
  step_ = image.packets.number(kSteps[wheel]);
  const auto counter =
      static_cast<std::uint32_t>(static_cast<std::int32_t>(image.packets.number(kCounters[wheel])));
  if (same) counts_ = static_cast<std::int32_t>(counter - counter_);  // round the end of the counter, too
  counter_ = counter;
}

/// The way of as many whole counts as the axis can follow.
double Handwheel::followed(const axis::Axis& axis) const noexcept {
  const double way = step_ * counts_;
  if (!std::isfinite(way) || way == 0.0) return way;  // the gate says what is wrong with it
  axis::MotionLimits limits = axis.config().limits;
  limits.velocity = std::min(limits.velocity, axis.jog_speed());
  const double room =
      axis::Ramp::stopping_distance({0.0, limits.velocity, 0.0}, limits) + limits.velocity * kLag;
  return image::wheel_way(way, step_, room, moves_ ? std::copysign(1.0, way) * axis.way_left() : 0.0);
}

bool Handwheel::next(image::Request& request, const axis::Axis& axis) noexcept {
  request = {};
  request.asker = image::Asker::plc;
  request.axis = static_cast<std::int8_t>(axis_);
  moves_ = moves_ && axis.increments();
  if (changed_) {
    changed_ = stopped_ = false;
    refusal_ = 0;
    request.kind = RequestKind::jog_stop;
    return moves_;
  }
  if (counts_ == 0) return false;
  if (stopped_) {
    refusal_ = static_cast<std::uint16_t>(Refusal::handwheel_stopped);
    return false;
  }
  // From another jog, or one that is being stopped, a short way would lead back.
  const bool jogs = axis.owner() == image::AxisOwner::manual && axis.moving() && !axis.increments();
  if (axis.plc_jog() != 0 || jogs) {
    refusal_ = static_cast<std::uint16_t>(Refusal::axis_moves);
    return false;
  }
  request.kind = RequestKind::jog_increment;
  request.value = followed(axis);
  return request.value != 0.0 || step_ == 0.0;
}

void Handwheel::answer(const image::Request& request, const image::Answer& answer) noexcept {
  if (request.kind == RequestKind::jog_stop) {
    moves_ = false;
    return;
  }
  refusal_ = answer.refusal;
  moves_ = moves_ || answer.refusal == 0;
}

void Handwheel::write(image::ProcessImage& image) const noexcept {
  image.packets.set_number(image::at(kRefusal, image::axis_base(axis_)), refusal_);
}

}  // namespace servogate::cycle
