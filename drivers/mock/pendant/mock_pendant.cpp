// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/pendant/mock_pendant.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servogate::mock {

using drivers::PendantNews;

MockPendant::MockPendant(pendant::Layout layout) : layout_(std::move(layout)) {
  put({PendantNews::Kind::plugged, {}, "mock"});
  send();
}

std::vector<std::string> MockPendant::controls() const {
  std::vector<std::string> out;
  if (layout_.wheel >= 0) out.emplace_back("wheel");
  if (layout_.ring >= 0) out.emplace_back("ring");
  if (layout_.axis >= 0) out.emplace_back("axis");
  if (layout_.step >= 0) out.emplace_back("step");
  for (const pendant::Button& b : layout_.buttons) out.push_back(b.name);
  return out;
}

std::pair<double, double> MockPendant::range(std::string_view control) const {
  if (control == "wheel") return {-1e9, 1e9};
  if (control == "ring") return {-layout_.ring_range, layout_.ring_range};
  if (control == "axis") return {0.0, static_cast<double>(layout_.axes.size())};
  if (control == "step" && layout_.step >= 0) return {0.0, static_cast<double>(layout_.steps.size())};
  return {0.0, 1.0};
}

MockPendant::Played MockPendant::play(std::string_view control, double value) {
  const std::vector<std::string> known = controls();
  if (std::find(known.begin(), known.end(), control) == known.end()) return Played::no_such_control;
  const auto [least, most] = range(control);
  if (!(value >= least && value <= most) || value != std::floor(value)) return Played::out_of_range;
  const std::scoped_lock lock(mutex_);
  const auto number = static_cast<std::int64_t>(value);
  if (control == "wheel") {
    for (std::int64_t left = number - std::exchange(wheel_, number); left != 0; left -= reading_.counts) {
      reading_.counts = static_cast<int>(std::clamp<std::int64_t>(left, -127, 127));
      send();
    }
    reading_.counts = 0;
    return Played::done;
  }
  if (control == "ring")
    reading_.ring = static_cast<int>(number);
  else if (control == "axis")
    reading_.axis = static_cast<int>(number) - 1;
  else if (control == "step" && layout_.step >= 0)
    reading_.step = static_cast<int>(number) - 1;
  else if (const std::uint32_t bit = 1u << layout_.button(control); number != 0)
    reading_.buttons |= bit;
  else
    reading_.buttons &= ~bit;
  send();
  return Played::done;
}

void MockPendant::plug(bool in) {
  const std::scoped_lock lock(mutex_);
  if (in == plugged_) return;
  plugged_ = in;
  put({in ? PendantNews::Kind::plugged : PendantNews::Kind::unplugged, {}, "mock"});
  send();
}

void MockPendant::garble(bool on) {
  const std::scoped_lock lock(mutex_);
  garbled_ = on;
  send();
}

void MockPendant::stick(std::string_view button, bool level) {
  const std::scoped_lock lock(mutex_);
  const int b = layout_.button(button);
  if (b >= 0) (level ? stuck_on_ : stuck_off_) |= 1u << b;
  send();
}

void MockPendant::release(std::string_view button) {
  const std::scoped_lock lock(mutex_);
  const int b = layout_.button(button);
  if (b < 0) return;
  stuck_on_ &= ~(1u << b);
  stuck_off_ &= ~(1u << b);
  send();
}

void MockPendant::send() {
  if (!plugged_) return;
  pendant::Reading reading = reading_;
  reading.buttons = (reading.buttons | stuck_on_) & ~stuck_off_;
  PendantNews news;
  news.report = writer_.write(reading);
  if (garbled_)
    for (std::size_t n = layout_.report_number != 0 ? 1 : 0; n < news.report.size; ++n) {
      chance_ = chance_ * 1664525u + 1013904223u;  // Numerical Recipes
      news.report.bytes[n] = static_cast<std::uint8_t>(chance_ >> 24);
    }
  put(std::move(news));
}

void MockPendant::show(std::vector<std::vector<std::uint8_t>> reports) {
  const std::scoped_lock lock(mutex_);
  if (plugged_) shown_ = std::move(reports);
}

std::vector<std::vector<std::uint8_t>> MockPendant::shown() const {
  const std::scoped_lock lock(mutex_);
  return shown_;
}

}  // namespace servogate::mock
