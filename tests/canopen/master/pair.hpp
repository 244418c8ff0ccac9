// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/master/segment.hpp"

namespace servogate::canopen::testing {

inline constexpr std::int64_t kTurn = 262'144;

/// One drive with its quirks, and a master with what its device file says.
struct Pair {
  Pair(const DriveQuirks& quirks, const std::function<void(NodeConfig&)>& told,
       const std::function<void(mock::SimulatedDriveConfig&)>& built = {})
      : bus(wire.add_endpoint("master")) {
    NodeConfig node;
    node.node = 1;
    node.name = "x";
    node.profile.counts_per_rev = kTurn;
    use_short_position_map(node.profile);
    node.profile.transition_timeout_ms = 500;
    told(node);
    config.nodes.push_back(node);
    mock::SimulatedDriveConfig plate;
    plate.plant.counts_per_rev = kTurn;
    plate.plant.start_rev = 0.3;
    plate.quirks = quirks;
    if (built) built(plate);
    drive = std::make_unique<mock::SimulatedDrive>(plate);
    wire.attach(*drive);
    segment = std::make_unique<Segment>(bus, config);
    image->now.period_ns = config.cycle_ns;
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      wire.advance_to(image->now.t_ns);
      segment->open_cycle(*image);
      segment->receive(*image);
      if (feedback().state != image::DriveState::operation_enabled)
        command().position_counts = feedback().position_counts;
      if (control) control();
      segment->send(*image);
      if (watch) watch();
      ++image->now.number;
      image->now.t_ns += config.cycle_ns;
      BusEvent e;
      while (segment->events().pop(e))
        if (e.kind != BusEventKind::node_booted)
          story += describe(e, "x", nullptr, text::Language::english) + "\n";
    }
  }
  bool until(const std::function<bool()>& met, int cycles = 5000) {
    for (int i = 0; i < cycles && !met(); ++i) run(1);
    return met();
  }
  bool enable() {
    command().power = true;
    command().mode = image::DriveMode::csp;
    return until([this] { return feedback().state == image::DriveState::operation_enabled; });
  }
  image::DriveCommand& command() { return image->axes[0].drive_command; }
  const image::DriveFeedback& feedback() const { return image->axes[0].drive; }

  mock::CanSegment wire;
  image::CanBus& bus;
  SegmentConfig config;
  std::unique_ptr<mock::SimulatedDrive> drive;
  std::unique_ptr<Segment> segment;
  std::unique_ptr<image::ProcessImage> image = std::make_unique<image::ProcessImage>();
  std::function<void()> control, watch;
  std::string story;
};

}  // namespace servogate::canopen::testing
