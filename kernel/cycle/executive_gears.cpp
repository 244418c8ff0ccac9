// SPDX-License-Identifier: Apache-2.0
// Electronic gears in the cycle: whose order it is, who comes first, and what everybody sees of them.
#include <algorithm>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/executive.hpp"

namespace servogate::cycle {

using image::GearState;

namespace {
constexpr image::Place kGearState = image::field(image::kAxisFields, "gear_state");
}  // namespace

/// An axis that leads has its set-point before those that follow it, whichever of their gears is engaged.
void Cycle::configure_gears() {
  gears_.resize(parts_.gears.size());
  for (std::size_t g = 0; g < gears_.size(); ++g) gears_[g].configure(parts_.gears[g], axes_);
  const auto placed = [this](int axis) {
    return std::find(masters_first_.begin(), masters_first_.end(), axis) != masters_first_.end();
  };
  const auto waits = [&](int axis) {
    return std::any_of(parts_.gears.begin(), parts_.gears.end(), [&](const axis::ElectronicGearConfig& g) {
      return g.follower == axis && g.master_axis >= 0 && !placed(g.master_axis);
    });
  };
  const auto count = static_cast<int>(axes_.size());
  for (int round = 0; round < count; ++round)
    for (int a = 0; a < count; ++a)
      if (!placed(a) && !waits(a)) masters_first_.push_back(static_cast<std::uint8_t>(a));
}

int Cycle::gears_of(int axis) const noexcept {
  return static_cast<int>(std::count_if(gears_.begin(), gears_.end(), [axis](const axis::ElectronicGear& g) {
    return g.config().follower == axis;
  }));
}

axis::ElectronicGear* Cycle::gear_of(int axis, double number) noexcept {
  double n = 0.0;
  for (axis::ElectronicGear& g : gears_)
    if (g.config().follower == axis && ++n == number) return &g;
  return nullptr;
}

void Cycle::follow_gear(GearOrder& order, axis::Axis& a) noexcept {
  const bool on = std::any_of(gears_.begin(), gears_.end(), [&a](const axis::ElectronicGear& g) {
    return g.on() && g.config().follower == a.index();
  });
  order.read(image_, a.index());
  if (gear_awaited(order, a)) return;
  if (image::Request request; order.next(request, on, a.geared())) order.answer(request, handle(request));
}

/// The PLC wants a gear whose master is there and cannot be followed yet.
bool Cycle::gear_awaited(const GearOrder& order, const axis::Axis& a) noexcept {
  if (a.geared() || order.wished() == 0 || order.wished() == order.number()) return false;
  const axis::ElectronicGear* gear = gear_of(a.index(), order.wished());
  return gear != nullptr && gear->master_awaited();
}

bool Cycle::engage_gear(const image::Request& request) noexcept {
  if (request.value == 0.0) {
    disengage_gears(request.axis);
    return true;
  }
  axis::ElectronicGear* gear = gear_of(request.axis, request.value);
  return gear != nullptr && gear->engage(geared_machine());
}

/// All of them where `axis` is -1.
void Cycle::disengage_gears(int axis) noexcept {
  for (axis::ElectronicGear& g : gears_)
    if (axis < 0 || g.config().follower == axis) g.disengage(geared_machine());
}

void Cycle::look_at_masters() noexcept {
  for (axis::ElectronicGear& g : gears_) g.look(geared_machine(), image_);
}

/// Axes, as bits, with a gear that is engaged: one that has lost its axis learns of it, too.
std::uint32_t Cycle::followers_now() const noexcept {
  std::uint32_t followers = 0;
  for (const axis::ElectronicGear& g : gears_)
    if (g.on()) followers |= 1u << g.config().follower;
  return followers;
}

/// Behind everything that may lead.
void Cycle::command_followers(std::uint32_t followers) noexcept {
  for (const std::uint8_t index : masters_first_) {
    if ((followers >> index & 1u) == 0) continue;
    for (axis::ElectronicGear& g : gears_)
      if (g.config().follower == index) g.step(geared_machine(), image_.now);
    axes_[index].command(image_);
  }
  if (followers != 0)
    for (const axis::Spindle& s : spindles_) s.pass_on(image_);
  if (!gears_.empty()) show_gears();
}

void Cycle::show_gears() noexcept {
  for (const axis::Axis& a : axes_) {
    const auto i = static_cast<std::size_t>(a.index());
    image::AxisGear& out = image_.axes[i].gear;
    out.number = gear_orders_[i].number();
    out.refusal = gear_orders_[i].answer().refusal;
    out.refused_value = gear_orders_[i].answer().value;
    out.refused_limit = gear_orders_[i].answer().limit;
    out.state = a.geared()                         ? GearState::disengaging
                : gear_awaited(gear_orders_[i], a) ? GearState::engaging
                : out.refusal != 0                 ? GearState::refused
                                                   : GearState::none;
    out.phase_error = 0.0;
    for (const axis::ElectronicGear& g : gears_) {
      if (!g.on() || g.config().follower != a.index()) continue;
      out.state = g.in_step() ? GearState::in_step : GearState::engaging;
      out.phase_error = g.phase_error();
    }
    image_.packets.set_number(image::at(kGearState, image::axis_base(a.index())),
                              static_cast<double>(out.state));
  }
}

}  // namespace servogate::cycle
