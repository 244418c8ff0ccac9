// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/plc_orders/gear_order.hpp"

#include "firmware_if/image/interface_map.hpp"

namespace servogate::cycle {

namespace {
constexpr image::Place kGear = image::field(image::kAxisFields, "gear");
}  // namespace

void GearOrder::read(const image::ProcessImage& image, int axis) noexcept {
  axis_ = axis;
  wish_ = static_cast<std::uint8_t>(image.packets.number(image::at(kGear, image::axis_base(axis))));
}

bool GearOrder::next(image::Request& request, bool on, bool geared) noexcept {
  if (wish_ == asked_) return false;
  request = {};
  request.kind = image::RequestKind::gear;
  request.asker = image::Asker::plc;
  request.axis = static_cast<std::int8_t>(axis_);
  if (geared) return on;  // it is disengaged first, and comes to rest
  if (wish_ == 0) {
    asked_ = 0;
    answer_ = {};
    return false;
  }
  request.value = wish_;
  return true;
}

void GearOrder::answer(const image::Request& request, const image::Answer& answer) noexcept {
  if (request.value == 0.0) return;
  asked_ = static_cast<std::uint8_t>(request.value);
  answer_ = answer;
}

}  // namespace servogate::cycle
