// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/forecast.hpp"

namespace servogate::channel {

namespace {

/// The path goes on under it, as in Feeder::accept().
bool passes(const program::Command& command) {
  if (const auto* write = std::get_if<program::WritePlace>(&command.what)) return !write->synchronous;
  if (const auto* tool = std::get_if<program::Tool>(&command.what)) return tool->activate;
  return false;
}

}  // namespace

Forecast::Forecast(Depth depth, const path::Config& config, AxisMap axes, const program::Position& start)
    : config_(config),
      elements_(config, std::move(axes), SpindleAt::halfway),
      at_(elements_.path_position(start)) {
  if (depth == Depth::timed) time_.emplace(config, at_);
}

std::optional<text::Finding> Forecast::take(const program::Command& command) {
  if (is_motion(command)) {
    const path::Element element = elements_.element(command, at_);
    if (time_ && !time_->add(element)) return cannot_drive(time_->last_flaw());
    if (!time_)
      if (const path::Flaw flaw = path::shape(config_, at_, element).flaw; flaw != path::Flaw::none)
        return cannot_drive(flaw);
    at_ = element.to;
    return std::nullopt;
  }
  if (auto finding = not_driven(command)) return finding;
  if (const auto* spindle = std::get_if<program::Spindle>(&command.what)) elements_.take(*spindle);
  if (time_ && !passes(command)) time_->rest();
  return std::nullopt;
}

double Forecast::motion_seconds() {
  if (!time_) return 0.0;
  time_->rest();
  return time_->seconds();
}

}  // namespace servogate::channel
