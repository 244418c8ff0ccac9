// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/master/segment.hpp"

namespace servogate::canopen::testing {

inline constexpr std::int64_t kCountsPerRev = 262'144;

/// Drives on one wire of 1 Mbit/s at 1 ms, run in virtual time.
struct Machine {
  explicit Machine(
      int axes, void (*map)(DriveProfile&) = use_short_position_map,
      image::Nanoseconds cycle_ns = image::kMillisecond, void (*setup)(NodeSetup&) = [](NodeSetup&) {},
      std::size_t program_memory = 0)
      : bus(wire.add_endpoint("master")) {
    config.cycle_ns = cycle_ns;
    for (int i = 0; i < axes; ++i) {
      NodeConfig node;
      node.node = static_cast<NodeId>(i + 1);
      node.target_index = i;
      node.profile.counts_per_rev = kCountsPerRev;
      map(node.profile);
      setup(node.setup);
      config.nodes.push_back(node);
      mock::SimulatedDriveConfig drive;
      drive.node_id = node.node;
      drive.plant.counts_per_rev = kCountsPerRev;
      drive.plant.start_rev = 0.3 + 0.1 * i;
      drive.plant.zero_mark_counts = 10'000;
      drive.program_memory = program_memory;
      drives.push_back(std::make_unique<mock::SimulatedDrive>(drive));
      wire.attach(*drives.back());
    }
    segment = std::make_unique<Segment>(bus, config);
    image->now.period_ns = cycle_ns;
  }

  void step() {
    wire.advance_to(image->now.t_ns);
    segment->open_cycle(*image);
    segment->receive(*image);
    if (control) control(*image);
    segment->send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    BusEvent e;
    while (segment->events().pop(e)) events.push_back(e);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  template <class Condition>
  bool run_until(Condition condition, int limit = 5000) {
    for (int i = 0; i < limit && !condition(); ++i) step();
    return condition();
  }
  bool all(image::DriveState state) const {
    for (std::size_t i = 0; i < drives.size(); ++i)
      if (image->axes[i].drive.state != state) return false;
    return true;
  }
  bool enable() {
    control = [](image::ProcessImage& im) {
      for (auto& axis : im.axes) {
        axis.drive_command.power = true;
        axis.drive_command.mode = image::DriveMode::csp;
        if (axis.drive.state != image::DriveState::operation_enabled)
          axis.drive_command.position_counts = axis.drive.position_counts;
      }
    };
    return run_until([this] { return all(image::DriveState::operation_enabled); });
  }
  int count(BusEventKind kind) const {
    int n = 0;
    for (const BusEvent& e : events) n += e.kind == kind;
    return n;
  }
  std::string story() const {
    std::string all_events;
    for (const BusEvent& e : events)
      all_events += std::to_string(e.t_ns / 1'000'000) + " ms node " + std::to_string(e.node) + ": " +
                    describe(e, "drive", nullptr, text::Language::english) + "\n";
    return all_events;
  }

  mock::CanSegment wire;
  image::CanBus& bus;
  SegmentConfig config;
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives;
  std::unique_ptr<Segment> segment;
  std::unique_ptr<image::ProcessImage> image = std::make_unique<image::ProcessImage>();
  std::function<void(image::ProcessImage&)> control;
  std::vector<BusEvent> events;
};

}  // namespace servogate::canopen::testing
