// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/touch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace servogate::channel {

std::string to_text(const TouchOrder& o) {
  char text[160];
  std::snprintf(text, sizeof text, "%d %.17g %.17g %.17g %.17g %d", o.axis, o.by, o.fast, o.slow, o.back,
                static_cast<int>(o.times));
  return text;
}

std::optional<TouchOrder> touch_from(std::string_view text) {
  TouchOrder o;
  int times = 0, read = 0;
  const std::string line(text);
  if (std::sscanf(line.c_str(), "%d %lf %lf %lf %lf %d%n", &o.axis, &o.by, &o.fast, &o.slow, &o.back, &times,
                  &read) != 6 ||
      static_cast<std::size_t>(read) != line.size())
    return std::nullopt;
  o.times = times;
  const bool good = o.axis >= 0 && o.axis < image::kMaxAxes && std::isfinite(o.by) && o.by != 0.0 &&
                    o.fast > 0.0 && o.slow > 0.0 && o.back > 0.0 && o.times > 0;
  return good ? std::optional(o) : std::nullopt;
}

program::Command Touch::to(double place, double feed, bool measures) const {
  program::Position at = from_;
  at[static_cast<std::size_t>(order_.axis)] = place;
  program::Command command;
  command.line = 1;
  if (measures) {
    command.what = program::Probe{at, feed};
  } else {
    program::Line line;
    line.to = at;
    line.feed.value = feed;
    command.what = line;
  }
  return command;
}

std::optional<program::Command> Touch::next() {
  const double sign = order_.by > 0.0 ? 1.0 : -1.0, begin = from_[static_cast<std::size_t>(order_.axis)];
  if (!begun_) {
    begun_ = true;
    return to(begin + order_.by, order_.fast, true);
  }
  if (ended_) return std::nullopt;
  if (static_cast<std::int32_t>(places_.size()) == order_.times) {
    ended_ = true;
    return to(begin, order_.fast, false);
  }
  behind_ = !behind_;
  // Never outside of the way that was ordered.
  const auto within = [&](double place) {
    return std::clamp(place, std::min(begin, begin + order_.by), std::max(begin, begin + order_.by));
  };
  return behind_ ? to(within(last_ + sign * order_.back), order_.slow, true)
                 : to(within(last_ - sign * order_.back), order_.fast, false);
}

void Touch::touched(double at) {
  last_ = at;
  if (places_.empty() && !slow_) {
    slow_ = true;
    return;
  }
  places_.push_back(at);
}

}  // namespace servogate::channel
