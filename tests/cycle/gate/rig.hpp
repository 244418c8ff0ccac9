// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle::test {

/// Two axes with ideal drives in a machine where everything is permitted; each test takes something away.
class GateRig : public ::testing::Test {
 protected:
  GateRig() {
    image_.axis_count = 2;
    image_.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
    for (int i = 0; i < 2; ++i) {
      axis::AxisConfig c;
      c.homing.method = axis::HomingMethod::absolute;
      axes_[static_cast<std::size_t>(i)].configure(c, i);
      set(i, "enable", true);
      set(i, "feed_enable", true);
      axes_[static_cast<std::size_t>(i)].set_reference(0);
      axes_[static_cast<std::size_t>(i)].request_power(true);
    }
    run(20);
    context_.image = &image_;
    context_.axes = axes_;
    context_.program_loaded = true;
  }
  void set(int axis, std::string_view name, bool value) {
    for (const auto& f : image::kAxisFields)
      if (f.name == name)
        image_.packets.set_bit(
            {image::Packet::k, image::Format::bl, (image::axis_base(axis) + f.byte) * 8 + f.bit, 1}, value);
  }
  void run(int cycles) {
    while (cycles-- > 0) {
      image_.now.t_ns += image_.now.period_ns;
      for (std::size_t i = 0; i < 2; ++i) {
        image::AxisImage& a = image_.axes[i];
        a.drive.online = true;
        a.drive.state =
            a.drive_command.power ? image::DriveState::operation_enabled : image::DriveState::switched_on;
        a.drive.position_counts = a.drive_command.position_counts;
        axes_[i].read(image_);
        axes_[i].command(image_);
      }
    }
  }
  Refusal ask(image::RequestKind kind, int axis = -1, double value = 0.0,
              image::Asker asker = image::Asker::command_line) {
    image::Request r;
    r.id = 4711;
    r.kind = kind;
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    r.asker = asker;
    answer_ = decide(r, context_);
    EXPECT_EQ(answer_.id, 4711u);
    return static_cast<Refusal>(answer_.refusal);
  }
  Refusal ask_place(image::RequestKind kind, const image::Place& p,
                    image::Asker asker = image::Asker::command_line) {
    image::Request r;
    r.kind = kind;
    r.asker = asker;
    r.packet = static_cast<std::uint8_t>(p.packet), r.format = static_cast<std::uint8_t>(p.format);
    r.index = p.index, r.length = p.length;
    answer_ = decide(r, context_);
    return static_cast<Refusal>(answer_.refusal);
  }
  std::string english() const { return render(answer_, {"X", "Y"}, text::Language::english); }
  std::string russian() const { return render(answer_, {"X", "Y"}, text::Language::russian); }
  void not_homed(int axis) {
    axis::AxisConfig c = axes_[static_cast<std::size_t>(axis)].config();
    c.homing.method = axis::HomingMethod::switch_and_index;
    axes_[static_cast<std::size_t>(axis)].configure(c, axis);
    axes_[static_cast<std::size_t>(axis)].request_power(true);
    run(20);
  }

  image::ProcessImage image_;
  std::array<axis::Axis, 2> axes_;
  GateContext context_;
  image::Answer answer_;
};

}  // namespace servogate::cycle::test
