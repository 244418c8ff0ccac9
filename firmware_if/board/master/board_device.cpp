// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/board_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/board/master/board_alarms.hpp"

namespace servogate::board {

namespace {

/// A board that has never been there is missed after this time.
constexpr image::Nanoseconds kNeverThere = image::kSecond;
constexpr int kMostAnswers = 8;  ///< taken in one cycle; more wait for the next

std::int16_t to_wire(double raw) noexcept {
  return static_cast<std::int16_t>(std::lround(std::clamp(raw, -double{kFullScale}, double{kFullScale})));
}

std::vector<image::PointRule> rules(const BoardConfig& config) {
  std::vector<image::PointRule> list;
  for (const BoardPoint& p : config.points) list.push_back(p.rule);
  return list;
}

}  // namespace

Configuration configuration(const BoardConfig& config) {
  Configuration c;
  c.period_us = config.period_us;
  c.watchdog_us = config.watchdog_us;
  c.channels = config.channels;
  for (const BoardPoint& p : config.points) {
    if (p.kind == PointKind::input && p.edges) c.edge_mask |= 1u << p.number;
    if (p.kind == PointKind::output && p.rule.loss != 0.0) c.safe_outputs |= 1u << p.number;
    if (p.kind == PointKind::analog_output) c.safe_analog[p.number] = to_wire(p.rule.loss);
  }
  return c;
}

Needs needs(const BoardConfig& config) {
  Needs n;
  const auto at_least = [](std::uint8_t& count, std::size_t number) {
    count = std::max(count, static_cast<std::uint8_t>(number + 1));
  };
  for (const BoardPoint& p : config.points) switch (p.kind) {
      case PointKind::input:
        at_least(n.inputs, p.number);
        break;
      case PointKind::output:
        at_least(n.outputs, p.number);
        break;
      case PointKind::analog_input:
        at_least(n.analog_inputs, p.number);
        break;
      case PointKind::analog_output:
        at_least(n.analog_outputs, p.number);
        break;
    }
  for (const AxisLinkConfig& a : config.axes)
    if (a.encoder) n.encoders = static_cast<std::uint8_t>(n.encoders | 1u << a.channel);
  n.step_rate = config.step_rate;
  return n;
}

BoardDevice::BoardDevice(const BoardConfig& config, std::unique_ptr<Port> port)
    : points_(config.points),
      stage_(rules(config), config.source, {{0, kNeverThere}}),
      port_(std::move(port)),
      session_(configuration(config), needs(config)),
      source_(config.source) {
  for (const AxisLinkConfig& a : config.axes) axes_.emplace_back(a);
  point_of_input_.fill(-1);
  for (std::size_t n = 0; n < points_.size(); ++n)
    if (points_[n].kind == PointKind::input) point_of_input_[points_[n].number] = static_cast<int>(n);
}

BoardDevice::~BoardDevice() {
  if (session_.state() != SessionState::running) return;
  port_->write({buffer_.data(), put({Kind::leave, 0}, buffer_)});
}

void BoardDevice::receive(image::ProcessImage& image, image::Notices& notices) noexcept {
  for (int n = 0; n < kMostAnswers; ++n) {
    const std::size_t size = port_->read(buffer_);
    if (size == 0) break;
    if (session_.take({buffer_.data(), size}, image.now.t_ns)) take_edges(image);
  }
  const bool refused = session_.state() == SessionState::refused;
  if (refused && !refused_) notices.add(refused_alarm(session_, source_));
  refused_ = refused;
  const bool fresh = session_.take_fresh();
  const bool sound = session_.state() == SessionState::running && (session_.status().flags & kTripped) == 0;
  if (sound && fresh)
    take_points(image);
  else if (!sound)
    stage_.lost(0);
  stage_.settle(image);
  for (AxisLink& axis : axes_) axis.receive(session_, fresh, image.axes[axis.config().axis].drive);
}

void BoardDevice::take_points(image::ProcessImage& image) noexcept {
  const Status& s = session_.status();
  for (std::size_t n = 0; n < points_.size(); ++n) {
    const BoardPoint& p = points_[n];
    if (p.kind == PointKind::input) stage_.take(n, (s.inputs >> p.number & 1u) != 0 ? 1.0 : 0.0);
    if (p.kind == PointKind::analog_input) stage_.take(n, s.analog[p.number]);
  }
  stage_.fresh(0, image.now.t_ns);
}

/// Each status has its own: none is passed over when two come in one cycle.
void BoardDevice::take_edges(image::ProcessImage& image) noexcept {
  const Status& s = session_.status();
  if (lost_of_session_ != session_.sessions()) lost_edges_ = 0;
  lost_of_session_ = session_.sessions();
  if (const auto lost = static_cast<std::uint16_t>(s.lost_edges - lost_edges_); lost > 0) {
    image.edges.note_lost(lost);
    stage_.fault();
  }
  lost_edges_ = s.lost_edges;
  for (std::size_t n = 0; n < s.edge_count; ++n) {
    const InputEdge& e = s.edges[n];
    const int point = e.input < kInputs ? point_of_input_[e.input] : -1;
    if (point < 0) continue;
    const image::PointRule& rule = stage_.rule(static_cast<std::size_t>(point));
    image.edges.add({rule.place, e.level != rule.inverted, session_.machine_time(e.t_us)});
  }
}

void BoardDevice::send(image::ProcessImage& image) noexcept {
  Command command;
  for (std::size_t n = 0; n < points_.size(); ++n) {
    const BoardPoint& p = points_[n];
    if (p.kind == PointKind::output && stage_.level(n, image.packets)) command.outputs |= 1u << p.number;
    if (p.kind == PointKind::analog_output) command.analog[p.number] = to_wire(stage_.raw(n, image.packets));
  }
  for (AxisLink& axis : axes_)
    axis.send(image.axes[axis.config().axis].drive_command, image.now.period_s(), command);
  const std::size_t size = session_.next(command, image.now.t_ns, buffer_);
  if (size > 0 && !port_->write({buffer_.data(), size})) stage_.fault();
}

}  // namespace servogate::board
