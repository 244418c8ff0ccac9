// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/report.hpp"

#include <algorithm>

namespace servogate::pendant {

namespace {

std::size_t at(int place) { return static_cast<std::size_t>(place); }

}  // namespace

bool ReportReader::read_keys(std::span<const std::uint8_t> report, Reading& out) const noexcept {
  const auto& buttons = layout_->buttons;
  for (const int place : layout_->keys) {
    const std::uint8_t code = report[at(place)];
    if (code == 0) continue;
    const auto found =
        std::find_if(buttons.begin(), buttons.end(), [code](const Button& b) { return b.code == code; });
    if (found == buttons.end()) return false;
    out.buttons |= 1u << (found - buttons.begin());
  }
  if (layout_->bits < 0) return true;
  const unsigned word = report[at(layout_->bits)] | static_cast<unsigned>(report[at(layout_->bits + 1)]) << 8;
  for (std::size_t b = 0; b < buttons.size(); ++b)
    if ((word >> buttons[b].code & 1u) != 0) out.buttons |= 1u << b;
  return true;
}

std::optional<Reading> ReportReader::read(std::span<const std::uint8_t> report) noexcept {
  const Layout& l = *layout_;
  if (report.size() != at(l.report_bytes)) return std::nullopt;
  if (l.report_number != 0 && report[0] != l.report_number) return std::nullopt;
  Reading out;
  const auto none = [](const auto& positions) {
    return std::none_of(positions.begin(), positions.end(), [](const auto& p) { return p.code == 0; });
  };
  out.asleep = l.axis >= 0 && l.step >= 0 && report[at(l.axis)] == 0 && report[at(l.step)] == 0 &&
               l.axis_off != 0 && none(l.axes) && none(l.steps);
  if (out.asleep) return out;
  if (!read_keys(report, out)) return std::nullopt;
  if (l.axis >= 0)
    for (std::size_t a = 0; a < l.axes.size(); ++a)
      if (l.axes[a].code == report[at(l.axis)]) out.axis = static_cast<int>(a);
  if (l.step >= 0)
    for (std::size_t s = 0; s < l.steps.size(); ++s)
      if (l.steps[s].code == report[at(l.step)]) out.step = static_cast<int>(s);
  if (l.ring >= 0) {
    out.ring = static_cast<std::int8_t>(report[at(l.ring)]);
    if (std::abs(out.ring) > l.ring_range) return std::nullopt;
  }
  if (l.wheel < 0) return out;
  const std::uint8_t wheel = report[at(l.wheel)];
  if (l.wheel_kind == WheelKind::delta) out.counts = static_cast<std::int8_t>(wheel);
  if (l.wheel_kind == WheelKind::counter) {
    if (counter_) out.counts = static_cast<std::int8_t>(static_cast<std::uint8_t>(wheel - *counter_));
    counter_ = wheel;
  }
  return out;
}

ReportWriter::Bytes ReportWriter::write(const Reading& reading) noexcept {
  const Layout& l = *layout_;
  Bytes out;
  out.size = at(l.report_bytes);
  const auto put = [&out](int place, int value) {
    if (place >= 0) out.bytes[at(place)] = static_cast<std::uint8_t>(value);
  };
  if (l.report_number != 0) put(0, l.report_number);
  std::size_t key = 0;
  unsigned word = 0;
  for (std::size_t b = 0; b < l.buttons.size(); ++b) {
    if ((reading.buttons >> b & 1u) == 0) continue;
    if (key < l.keys.size()) put(l.keys[key++], l.buttons[b].code);
    if (l.bits >= 0) word |= 1u << l.buttons[b].code;
  }
  if (l.bits >= 0) {
    put(l.bits, static_cast<int>(word & 0xFF));
    put(l.bits + 1, static_cast<int>(word >> 8 & 0xFF));
  }
  put(l.axis, reading.axis >= 0 ? l.axes[at(reading.axis)].code : l.axis_off);
  if (reading.step >= 0) put(l.step, l.steps[at(reading.step)].code);
  put(l.ring, reading.ring);
  counter_ = static_cast<std::uint8_t>(counter_ + reading.counts);
  if (l.wheel_kind == WheelKind::delta) put(l.wheel, reading.counts);
  if (l.wheel_kind == WheelKind::counter) put(l.wheel, counter_);
  return out;
}

}  // namespace servogate::pendant
