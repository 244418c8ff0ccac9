// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/canopen/master/segment.hpp"
#include "tests/canopen/fake_drive.hpp"

namespace servogate::canopen::testing {

/// A segment with its fake drives and the process image, one cycle a step.
struct SegmentRig {
  static NodeConfig axis_node(NodeId node, int axis) {
    NodeConfig config;
    config.node = node;
    config.name = "axis" + std::to_string(axis);
    config.target_index = axis;
    use_short_position_map(config.profile);
    return config;
  }

  explicit SegmentRig(int axes = 1) {
    for (int i = 0; i < axes; ++i) config.nodes.push_back(axis_node(static_cast<NodeId>(i + 1), i));
  }

  /// Builds the segment and plugs the drives in.
  void start() {
    for (const NodeConfig& node : config.nodes) network.add(node.node);
    segment = std::make_unique<Segment>(network, config);
    image->now.period_ns = config.cycle_ns;
  }

  void step() {
    segment->open_cycle(*image);
    segment->receive(*image);
    if (control) control(*image);
    segment->send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    network.transfer(image->now.t_ns);
    BusEvent e;
    while (segment->events().pop(e)) events.push_back(e);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  template <class Condition>
  bool run_until(Condition condition, int limit = 5000) {
    for (int i = 0; i < limit; ++i) {
      if (condition()) return true;
      step();
    }
    return condition();
  }
  bool boot() {
    return run_until([this] { return image->segments[0].operational; });
  }
  /// Powers all axes, targets following the actual positions until they are enabled.
  bool enable() {
    control = [](image::ProcessImage& im) {
      for (auto& axis : im.axes) {
        axis.drive_command.power = true;
        if (axis.drive.state != image::DriveState::operation_enabled)
          axis.drive_command.position_counts = axis.drive.position_counts;
      }
    };
    return run_until([this] {
      for (const NodeConfig& node : config.nodes)
        if (image->axes[static_cast<std::size_t>(node.target_index)].drive.state !=
            image::DriveState::operation_enabled)
          return false;
      return true;
    });
  }

  int count(BusEventKind kind) const {
    int n = 0;
    for (const BusEvent& e : events) n += e.kind == kind;
    return n;
  }
  const BusEvent* last(BusEventKind kind) const {
    const BusEvent* found = nullptr;
    for (const BusEvent& e : events)
      if (e.kind == kind) found = &e;
    return found;
  }
  std::string sentence(BusEventKind kind, text::Language language = text::Language::english) const {
    const BusEvent* e = last(kind);
    return e ? describe(*e, "X", nullptr, language) : std::string{};
  }
  image::DriveFeedback& drive(int axis = 0) { return image->axes[static_cast<std::size_t>(axis)].drive; }
  image::DriveCommand& command(int axis = 0) {
    return image->axes[static_cast<std::size_t>(axis)].drive_command;
  }
  FakeDrive& device(int axis = 0) { return *network.drives[static_cast<std::size_t>(axis)]; }

  FakeNetwork network;
  SegmentConfig config;
  std::unique_ptr<Segment> segment;
  std::unique_ptr<image::ProcessImage> image = std::make_unique<image::ProcessImage>();
  std::function<void(image::ProcessImage&)> control;
  std::vector<BusEvent> events;
};

}  // namespace servogate::canopen::testing
