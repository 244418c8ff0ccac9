// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/points/debounce.hpp"

#include <cmath>

namespace servogate::gateway {

Debounce::Debounce(const machine::MachineConfig& machine) {
  for (const machine::StationConfig& station : machine.stations)
    for (const machine::PointConfig& p : station.points)
      if (p.channel == machine::ChannelKind::di && p.debounce > 0.0)
        points_.push_back({p.place, static_cast<image::Nanoseconds>(std::llround(p.debounce * 1e9))});
}

void Debounce::Before::receive(image::ProcessImage& image) noexcept {
  for (const Point& p : points_)
    if (p.started) image.packets.set_bit(p.place, p.raw);
}

void Debounce::After::receive(image::ProcessImage& image) noexcept {
  for (Point& p : points_) {
    const bool raw = image.packets.bit(p.place);
    if (!p.started) {
      p.started = true;
      p.raw = p.shown = raw;
    }
    if (raw != p.raw) {
      p.raw = raw;
      p.changed_ns = image.now.t_ns;
    }
    if (image.now.t_ns - p.changed_ns >= p.time_ns) p.shown = p.raw;
    image.packets.set_bit(p.place, p.shown);
  }
}

}  // namespace servogate::gateway
