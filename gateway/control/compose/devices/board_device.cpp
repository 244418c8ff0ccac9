// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/board_device.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "drivers/board/usb_board.hpp"
#include "gateway/control/compose/points/point_rules.hpp"

namespace servogate::gateway {

namespace {

std::uint32_t microseconds(double seconds) { return static_cast<std::uint32_t>(std::llround(seconds * 1e6)); }

board::Output output_of(machine::BoardOutput output) {
  switch (output) {
    case machine::BoardOutput::step:
      return board::Output::step;
    case machine::BoardOutput::analog:
      return board::Output::analog;
    case machine::BoardOutput::pwm:
      break;
  }
  return board::Output::pwm;
}

board::PointKind kind_of(machine::ChannelKind channel) {
  switch (channel) {
    case machine::ChannelKind::di:
      return board::PointKind::input;
    case machine::ChannelKind::dq:
      return board::PointKind::output;
    case machine::ChannelKind::ai:
      return board::PointKind::analog_input;
    case machine::ChannelKind::aq:
      break;
  }
  return board::PointKind::analog_output;
}

/// Steps of a turn; position by steps counts in them.
std::int64_t steps_per_rev(const machine::AxisConfig& a) {
  return a.board.feedback == machine::BoardFeedback::steps ? a.counts_per_rev : a.board.steps_per_rev;
}

void add_axis(const machine::AxisConfig& a, std::size_t index, board::BoardConfig& config) {
  const machine::BoardChannelConfig& b = a.board;
  board::AxisLinkConfig link;
  link.axis = index;
  link.channel = static_cast<std::uint8_t>(b.channel);
  link.output = output_of(b.output);
  link.encoder = b.feedback == machine::BoardFeedback::encoder;
  link.reversed = b.reversed;
  const auto counts = static_cast<double>(a.counts_per_rev);
  // A quick stop does not spare the mechanics, but it keeps the motor in step.
  constexpr double kHarder = 1.5;
  link.quick_stop = kHarder * a.max_acceleration * a.counts_per_unit();
  board::ChannelSetting& setting = config.channels[link.channel];
  setting.output = link.output;
  setting.fault_is_low = b.fault_low;
  if (b.output == machine::BoardOutput::step) {
    const std::int64_t common = std::gcd(steps_per_rev(a), a.counts_per_rev);
    link.steps = steps_per_rev(a) / common;
    link.counts = a.counts_per_rev / common;
    const double fastest = a.max_velocity * a.counts_per_unit() * static_cast<double>(link.steps) /
                           static_cast<double>(link.counts);
    config.step_rate = std::max(config.step_rate, static_cast<std::uint32_t>(std::min(4e9, fastest)));
    setting.step_us = static_cast<std::uint8_t>(std::clamp<std::uint32_t>(microseconds(b.step_time), 1, 200));
    setting.stop_rate = static_cast<std::uint32_t>(
        std::min(4e9, link.quick_stop * static_cast<double>(link.steps) / static_cast<double>(link.counts)));
  } else {
    link.full_scale_counts_s = b.full_speed / 60.0 * counts;
    link.position_gain = b.position_gain;
    link.offset = b.offset / 100.0;
  }
  config.axes.push_back(link);
}

}  // namespace

board::BoardConfig board_config(const machine::MachineConfig& m, std::size_t station) {
  const machine::StationConfig& s = m.stations[station];
  board::BoardConfig config;
  config.period_us = static_cast<std::uint32_t>(m.cycle_ns() / image::kMicrosecond);
  config.watchdog_us = microseconds(s.watchdog);
  config.source = static_cast<int>(station);
  for (const machine::PointConfig& p : s.points)
    config.points.push_back({kind_of(p.channel), static_cast<std::size_t>(p.number), point_rule(p), p.edges});
  for (std::size_t i = 0; i < m.axes.size(); ++i)
    if (m.axes[i].board.station == s.name) add_axis(m.axes[i], i, config);
  return config;
}

std::unique_ptr<image::CycleDevice> open_mock_board(const DeviceRequest& request, drivers::Notice&) {
  return std::make_unique<board::BoardDevice>(
      board_config(request.loaded.machine, request.station),
      std::make_unique<mock::MockBoardPort>(*request.world.board(request.first().name)));
}

std::unique_ptr<image::CycleDevice> open_usb_board(const DeviceRequest& request, drivers::Notice& why) {
  auto port = board::UsbBoard::open(std::string(request.rest), why);
  if (port == nullptr) return nullptr;
  return std::make_unique<board::BoardDevice>(board_config(request.loaded.machine, request.station),
                                              std::move(port));
}

bool usb_board_available(const DeviceRequest& request, drivers::Notice& why) {
  return usb::open_libusb(board::board_kind(), std::string(request.rest), why) != nullptr;
}

}  // namespace servogate::gateway
