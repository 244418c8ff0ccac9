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

Forecast::Forecast(Depth depth, const path::Config& config, AxisMap axes, const program::Position& start,
                   std::uint32_t own)
    : config_(config),
      axes_(std::move(axes)),
      elements_(config, axes_, SpindleAt::halfway),
      at_(elements_.path_position(start)),
      stands_(start) {
  elements_.own(own);
  if (depth == Depth::timed) time_.emplace(config, at_);
  if (depth == Depth::surveyed) survey_.emplace(config, at_);
}

std::optional<text::Finding> Forecast::take(const program::Command& command) {
  switch (tap_.take(command, elements_, at_)) {
    case TapCommands::Taken::wrong:
      if (const program::Position* to = destination(command)) at_ = elements_.path_position(*to);
      return tap_.flaw();
    case TapCommands::Taken::yes:
      return std::nullopt;
    case TapCommands::Taken::complete:
      return tap();
    case TapCommands::Taken::no:
      break;
  }
  if (is_motion(command)) return drive(elements_.element(command, at_), command);
  if (const auto* spindle = std::get_if<program::Spindle>(&command.what)) elements_.take(*spindle);
  if (const auto* dwell = std::get_if<program::Dwell>(&command.what)) elements_.rested(dwell->seconds);
  if (!passes(command)) rest();
  return std::nullopt;
}

std::optional<text::Finding> Forecast::drive(path::Element element, const program::Command& command) {
  element.tag.line = command.line;
  element.tag.file = command.file;
  const path::Flaw flaw = add(element);
  if (flaw == path::Flaw::none) elements_.driven(element, at_);
  at_ = element.to;
  if (flaw == path::Flaw::none) return std::nullopt;
  begin_anew();
  return cannot_drive(flaw);
}

std::optional<text::Finding> Forecast::tap() {
  const std::vector<TapCommands::Leg> legs = tap_.legs();
  tap_.clear();
  std::optional<text::Finding> found = undrivable_tap(config_, axes_, at_, legs);
  rest();
  for (const TapCommands::Leg& leg : legs) {
    std::optional<text::Finding> flaw = drive(leg.element, leg.command);
    if (!found) found = std::move(flaw);
  }
  rest();
  return found;
}

int Forecast::foreign_axis(const program::Command& command) {
  const int axis = elements_.foreign_axis(command, stands_);
  if (axis >= 0 && destination(command) != nullptr)
    stands_[static_cast<std::size_t>(axis)] = (*destination(command))[static_cast<std::size_t>(axis)];
  return axis;
}

path::Flaw Forecast::add(const path::Element& element) {
  if (time_) return time_->add(element) ? path::Flaw::none : time_->last_flaw();
  if (survey_) return survey_->add(element) ? path::Flaw::none : survey_->last_flaw();
  return path::shape(config_, at_, element).flaw;
}

void Forecast::rest() {
  if (time_) time_->rest();
  if (survey_) survey_->rest();
}

double Forecast::motion_seconds() {
  rest();
  return before_s_ + (time_ ? time_->seconds() : survey_ ? survey_->seconds() : 0.0);
}

void Forecast::begin_anew() {
  before_s_ = motion_seconds();
  if (time_) time_.emplace(config_, at_);
  if (survey_) survey_.emplace(config_, at_);
}

}  // namespace servogate::channel
