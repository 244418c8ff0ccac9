// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A make of pendant as data. What fills these values is its device file; its text forms are read here.
/// Nothing in this header is real-time safe (strings) unless it says so.
namespace servogate::pendant {

inline constexpr int kMostButtons = 32;  ///< of one pendant, bits of Reading::buttons
inline constexpr int kMostAxes = 6;      ///< of its axis selector or its display

/// What a button, or a chord of two, asks for. Directions and amounts: Binding::value.
enum class Action : std::uint8_t {
  nothing,
  shift,        ///< changes what other buttons mean while it is held, in their chords
  stop,         ///< controlled stop, the program ends
  hold,         ///< feed hold
  start_hold,   ///< starts the program, holds the one that runs, resumes the one that is held
  reset,        ///< resets alarms and drives
  power,        ///< drives on, or off while they are on
  home,         ///< all axes in the machine's order
  zero,         ///< the selected axis reads 0 in the origin in force
  override_by,  ///< changes the feed override by `value` per cent
  next_step,    ///< the next step of the wheel, behind the last one the first
  coordinates,  ///< shows machine coordinates instead of work coordinates, and back
  select,       ///< selects axis `axis`
  hold_axis,    ///< selects axis `axis` while it is held: a dead-man
  mdi,          ///< executes the block `text`
  path_wheel,   ///< the wheel drives the program along its path from now on, and no more
};

/// A button has its number in Layout::buttons.
struct Binding {
  int button = -1;
  int with = -1;  ///< this one is held, too; -1: none
  Action action = Action::nothing;
  double value = 0.0;
  char axis = 0;     ///< letter
  std::string text;  ///< of mdi
};

struct Button {
  std::string name;
  std::uint8_t code = 0;  ///< key code, or number of its bit
};

/// A position of the axis selector; letter 0: off.
struct AxisCode {
  char letter = 0;
  std::uint8_t code = 0;
};

/// A step of the wheel, and the position of its selector where the pendant has one.
struct Step {
  double length = 0.0;  ///< mm or degrees a count
  int code = -1;        ///< -1: next_step leads to it
  int mark = -1;        ///< what the display is told, -1: nothing
};

/// What stands in the display's bytes, one after the other.
enum class FieldKind : std::uint8_t {
  constant,          ///< one byte, `value`
  work,              ///< row `value` from 0, in work coordinates; four bytes
  machine,           ///< the same in machine coordinates
  shown,             ///< the same in those that are shown
  feed,              ///< mm/min; two bytes
  spindle,           ///< rpm; two bytes
  feed_override,     ///< per cent; two bytes
  spindle_override,  ///< per cent; two bytes
  step_mark,         ///< Step::mark; one byte
  flags,             ///< bits 0 and 1: 1, step; bit 6: reset; bit 7: work coordinates; one byte
};
struct Field {
  FieldKind kind = FieldKind::constant;
  std::uint8_t value = 0;
};

enum class WheelKind : std::uint8_t {
  none,
  delta,    ///< signed counts since the last report
  counter,  ///< a byte that runs round
};

/// Places are bytes of the report from 0, its number among them where it has one; -1: there is none.
struct Layout {
  std::string name;  ///< for people
  std::uint16_t usb_vendor = 0, usb_product = 0;
  int report_number = 0;     ///< first byte of each report, 0: reports have no number
  int report_bytes = 0;      ///< with the number
  std::vector<int> keys;     ///< bytes with the code of a pressed button each, 0: none
  int bits = -1;             ///< first of two bytes with a bit for each button, low byte first
  int axis = -1, step = -1;  ///< selectors
  int wheel = -1, ring = -1;
  WheelKind wheel_kind = WheelKind::none;
  int ring_range = 7;  ///< the spring-loaded ring counts from -range to range
  int ring_from = 1;   ///< from there on it jogs
  std::vector<Button> buttons;
  std::vector<AxisCode> axes;  ///< X Y Z A B C in rows of the display, without off
  int axis_off = 0;            ///< code of off
  std::vector<Step> steps;
  std::vector<Binding> bindings;

  int display_number = 0;  ///< of the feature report that the display takes
  int display_bytes = 0;   ///< of one, without its number; 0: the pendant has no display
  std::vector<Field> display;

  /// Index of the button with this name, -1: none.
  int button(std::string_view named) const;
  /// Index of the axis with this letter, -1: none.
  int axis_index(char letter) const;
};

/// "0x0C fn": a code (0x.. or decimal) and a name. nullopt: not of that form.
std::optional<Button> parse_button(std::string_view text);
/// "0x11 X", "0x06 off".
std::optional<AxisCode> parse_axis(std::string_view text);
/// "0.001", "0x0D 0.001" (code and length), "0.001 = 1" (length and mark of the display).
std::optional<Step> parse_step(std::string_view text);
/// "0xFE", "work 1", "machine 2", "shown 3", "feed", "spindle", "feed_override", "spindle_override",
/// "step_mark", "flags"; rows from 1.
std::optional<Field> parse_field(std::string_view text);
/// "reset: reset", "fn + macro10: mdi M8", "feed_plus: override_by +10", "b5: hold_axis X". nullopt: not of
/// that form, or a button that `layout` does not have.
std::optional<Binding> parse_binding(std::string_view text, const Layout& layout);

/// Words of the actions, for people, in the order of Action.
std::string_view action_words();
/// The word of one.
std::string_view action_word(Action action);

/// Gives a chord its new meaning, instead of the one that it has.
void bind(Layout& layout, const Binding& binding);

}  // namespace servogate::pendant
