// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/io/io_link.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::canopen {
namespace {

std::uint64_t raw_of(double value, const IoPoint& p, std::uint8_t bits) noexcept {
  const double raw = (value - p.shift) / p.scale;
  if (!std::isfinite(raw)) return 0;
  const double limit = std::ldexp(1.0, bits - 1);
  return static_cast<std::uint64_t>(std::llround(std::clamp(raw, -limit, limit - 1.0)));
}

}  // namespace

IoLink::IoLink(const NodeConfig& node, const SegmentConfig& segment)
    : source_(static_cast<std::size_t>(node.target_index)),
      watch_(node.profile.tpdo, segment.cycle_ns, max_missed_pdo(node, segment)),
      data_(node.profile, segment.cycle_ns) {
  for (const IoPoint& p : node.io.points) {
    Terminal terminal{p, find_field(p.input ? node.profile.tpdo : node.profile.rpdo, p.index, p.subindex)};
    if (p.bit >= 0) {
      terminal.field.offset = static_cast<std::uint8_t>(terminal.field.offset + p.bit);
      terminal.field.bits = 1;
    }
    (p.input ? inputs_ : outputs_).push_back(terminal);
  }
  restart();
}

void IoLink::restart() noexcept {
  data_.clear();
  watch_.restart();
}

bool IoLink::update() noexcept {
  const bool on_time = watch_.step(data_);
  data_.end_of_cycle();
  return on_time;
}

void IoLink::fill(image::ProcessImage& image, bool online) noexcept {
  for (const Terminal& t : inputs_) {
    const IoPoint& p = t.point;
    if (!online) {
      if (!p.hold) image.packets.set_number(p.place, p.bit >= 0 ? (p.loss != 0.0 ? 1.0 : 0.0) : p.loss);
    } else if (p.bit >= 0) {
      image.packets.set_bit(p.place, (data_.raw(t.field) != 0) != p.inverted);
    } else {
      image.packets.set_number(p.place, static_cast<double>(data_.number(t.field)) * p.scale + p.shift);
    }
  }
  image::IoSource& source = image.sources[source_];
  if (online) {
    source.quality = image::Quality::good;
    source.updated_ns = image.now.t_ns;
  } else if (source.quality != image::Quality::never) {
    if (source.quality == image::Quality::good) ++source.errors;
    source.quality = image::Quality::bad;
  }
}

void IoLink::apply(const image::Packets& packets, bool online) noexcept {
  for (const Terminal& t : outputs_) {
    const IoPoint& p = t.point;
    if (!online && p.hold) continue;
    if (p.bit >= 0)
      data_.set(t.field, (online ? packets.bit(p.place) != p.inverted : p.loss != 0.0) ? 1 : 0);
    else
      data_.set(t.field, online ? raw_of(packets.number(p.place), p, t.field.bits)
                                : static_cast<std::uint64_t>(std::llround(p.loss)));
  }
}

}  // namespace servogate::canopen
