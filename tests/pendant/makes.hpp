// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <string>

#include "firmware_if/pendant/layout.hpp"

namespace servogate::pendant::test {

inline void bindings(Layout& layout, std::initializer_list<const char*> lines) {
  for (const char* line : lines) {
    const auto binding = parse_binding(line, layout);
    if (!binding) throw std::invalid_argument(line);
    bind(layout, *binding);
  }
}

/// Keys by code, selectors for axis and step, a wheel of differences, a display: as XHC WHB04B-6.
inline Layout with_selectors() {
  Layout l;
  l.name = "with selectors";
  l.report_number = 4;
  l.report_bytes = 8;
  l.keys = {2, 3};
  l.step = 4;
  l.axis = 5;
  l.axis_off = 6;
  l.wheel = 6;
  l.wheel_kind = WheelKind::delta;
  for (const char* b : {"0x01 reset", "0x02 stop", "0x03 start", "0x04 feed_plus", "0x08 home", "0x0C fn",
                        "0x0D probe", "0x10 macro"})
    l.buttons.push_back(parse_button(b).value());
  for (const char* a : {"0x11 X", "0x12 Y", "0x13 Z", "0x14 A"}) l.axes.push_back(parse_axis(a).value());
  for (const char* s : {"0x0D 0.001", "0x0E 0.01", "0x0F 0.1", "0x10 1"})
    l.steps.push_back(parse_step(s).value());
  bindings(l, {"reset: reset", "stop: stop", "start: start_hold", "feed_plus: override_by +10", "home: home",
               "fn: shift", "macro: coordinates", "fn + macro: mdi M8", "fn + home: zero"});
  l.display_number = 6;
  l.display_bytes = 7;
  for (const char* f : {"0xFE", "0xFD", "0x0C", "flags", "shown 1", "shown 2", "shown 3", "feed", "spindle"})
    l.display.push_back(parse_field(f).value());
  return l;
}

/// Buttons as bits, a wheel that counts round, a spring-loaded ring, no selectors: as Contour ShuttleXpress.
inline Layout with_ring() {
  Layout l;
  l.name = "with ring";
  l.report_bytes = 5;
  l.bits = 3;
  l.ring = 0;
  l.ring_from = 3;
  l.wheel = 1;
  l.wheel_kind = WheelKind::counter;
  for (const char* b : {"4 b1", "5 b2", "6 b3", "7 b4", "8 b5"}) l.buttons.push_back(parse_button(b).value());
  for (const char* a : {"0 X", "0 Y", "0 Z"}) l.axes.push_back(parse_axis(a).value());
  for (const char* s : {"0.01", "0.1"}) l.steps.push_back(parse_step(s).value());
  bindings(l, {"b1: hold_axis X", "b2: hold_axis Y", "b3: hold_axis Z", "b4: next_step", "b5: hold"});
  return l;
}

}  // namespace servogate::pendant::test
