// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "firmware_if/board/master/axis_link.hpp"
#include "firmware_if/board/master/port.hpp"
#include "firmware_if/board/master/session.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/points/point_stage.hpp"

namespace servogate::board {

enum class PointKind : std::uint8_t { input, output, analog_input, analog_output };

/// A point of the machine on a line of the board.
struct BoardPoint {
  PointKind kind = PointKind::input;
  std::size_t number = 0;  ///< of its kind, from 0
  image::PointRule rule;
  bool edges = false;  ///< input: its edges are told with the board's times
};

struct BoardConfig {
  std::uint32_t period_us = 1000;
  std::uint32_t watchdog_us = 20'000;
  std::vector<BoardPoint> points;
  std::vector<AxisLinkConfig> axes;
  std::array<ChannelSetting, kChannels> channels{};
  std::uint32_t step_rate = 0;  ///< steps/s of the fastest axis
  int source = -1;              ///< index in image.sources; -1: none
};

/// The configuration that a board gets for this: channels, edges, and outputs at their values of loss.
Configuration configuration(const BoardConfig& config);
/// And what it has to have.
Needs needs(const BoardConfig& config);

/// A board as a device of the cycle: one command at the end of each cycle, whose answer is read at the begin
/// of the next one. Its inputs are of the time at which it took the command; edges have their own. A board
/// that is silent for longer than half of its watchdog, has tripped, or is not the one that the machine file
/// wants gives its inputs their values of loss, its source is bad, and its axes are offline or in fault.
class BoardDevice final : public image::CycleDevice {
 public:
  /// Not real-time safe.
  BoardDevice(const BoardConfig& config, std::unique_ptr<Port> port);
  /// Tells the board that the control ends, where the port still takes it. Not real-time safe.
  ~BoardDevice() override;

  /// real-time safe.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// real-time safe.
  void send(image::ProcessImage& image) noexcept override;

  /// real-time safe.
  const Session& session() const noexcept { return session_; }

 private:
  void take_points(image::ProcessImage& image) noexcept;
  void take_edges(image::ProcessImage& image) noexcept;

  std::vector<BoardPoint> points_;
  image::PointStage stage_;  ///< the same points
  std::vector<AxisLink> axes_;
  std::unique_ptr<Port> port_;
  Session session_;
  std::array<int, kInputs> point_of_input_{};  ///< for edges; -1: none
  int source_;
  bool refused_ = false;  ///< and it has been told
  std::uint16_t lost_edges_ = 0;
  std::uint32_t lost_of_session_ = 0;
  std::array<std::uint8_t, kMostBytes> buffer_{};
};

}  // namespace servogate::board
