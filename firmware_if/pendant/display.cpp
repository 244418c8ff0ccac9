// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/display.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::pendant {

namespace {

constexpr std::uint8_t kStepMode = 0x01, kReset = 0x40, kWork = 0x80;

void word(std::vector<std::uint8_t>& out, double value) {
  const auto whole =
      static_cast<unsigned>(std::isfinite(value) ? std::clamp(std::abs(value), 0.0, 65535.0) : 0.0);
  out.push_back(static_cast<std::uint8_t>(whole & 0xFF));
  out.push_back(static_cast<std::uint8_t>(whole >> 8));
}

/// To the micrometre, as a machinist reads it; more than the display can hold stays at its end.
void place(std::vector<std::uint8_t>& out, double value) {
  const double micrometres =
      std::isfinite(value) ? std::round(std::min(std::abs(value), 65535.0) * 1000.0) : 0.0;
  const auto all = static_cast<std::uint64_t>(micrometres);
  const bool minus = value < 0.0 && all != 0;
  word(out, static_cast<double>(all / 1000));
  word(out, static_cast<double>((all % 1000 * 10) | (minus ? 0x8000u : 0u)));
}

}  // namespace

std::vector<std::vector<std::uint8_t>> show(const Layout& layout, const Shown& shown) {
  std::vector<std::vector<std::uint8_t>> out;
  if (layout.display_bytes <= 0) return out;
  const auto axis_of = [&](std::uint8_t row) -> std::size_t {
    const int axis = shown.selected >= 0 ? shown.selected / 3 * 3 + row : row;
    return static_cast<std::size_t>(axis < static_cast<int>(layout.axes.size()) ? axis : row);
  };
  std::vector<std::uint8_t> bytes;
  for (const Field& field : layout.display) {
    switch (field.kind) {
      case FieldKind::constant:
        bytes.push_back(field.value);
        break;
      case FieldKind::work:
        place(bytes, shown.work[axis_of(field.value)]);
        break;
      case FieldKind::machine:
        place(bytes, shown.machine[axis_of(field.value)]);
        break;
      case FieldKind::shown:
        place(bytes, (shown.machine_coordinates ? shown.machine : shown.work)[axis_of(field.value)]);
        break;
      case FieldKind::feed:
        word(bytes, std::round(shown.feed_mm_min));
        break;
      case FieldKind::spindle:
        word(bytes, std::round(shown.spindle_rpm));
        break;
      case FieldKind::feed_override:
        word(bytes, std::round(shown.feed_override));
        break;
      case FieldKind::spindle_override:
        word(bytes, std::round(shown.spindle_override));
        break;
      case FieldKind::step_mark: {
        const int mark = shown.step >= 0 ? layout.steps[static_cast<std::size_t>(shown.step)].mark : -1;
        bytes.push_back(static_cast<std::uint8_t>(std::max(mark, 0)));
        break;
      }
      case FieldKind::flags:
        bytes.push_back(static_cast<std::uint8_t>(kStepMode | (shown.reset ? kReset : 0) |
                                                  (shown.machine_coordinates ? 0 : kWork)));
        break;
    }
  }
  const auto size = static_cast<std::size_t>(layout.display_bytes);
  for (std::size_t i = 0; i < bytes.size(); i += size) {
    std::vector<std::uint8_t> report{static_cast<std::uint8_t>(layout.display_number)};
    report.resize(size + 1, 0);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(i), std::min(size, bytes.size() - i),
                report.begin() + 1);
    out.push_back(std::move(report));
  }
  return out;
}

}  // namespace servogate::pendant
