// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace servogate::program {

class Execution;
struct BlockWords;
struct Operands;

/// What a letter in front of a number means. The same letter means different things in different languages.
enum class Meaning : std::uint8_t {
  unknown,  ///< not a letter of this language
  later,    ///< a letter of this language whose function is not executed in this version
  number,   ///< block number
  g,
  m,
  h,
  axis,
  centre_1,
  centre_2,
  pitch,
  radius,
  feed,
  block_time,
  speed,
  tool,
};

/// Which parameters may stand for a number of a word.
enum class ParameterKind : std::uint8_t { none, whole, real, any };

/// One letter of a language: its meaning, its range, the parameters it takes.
struct LetterRule {
  Meaning meaning = Meaning::unknown;
  ParameterKind parameters = ParameterKind::none;
  double min = 0.0;
  double max = 0.0;
  bool twice = false;  ///< may stand in a block a second time
};

/// What a G word does in this version, whatever its number is.
enum class Function : std::uint8_t {
  later,    ///< a G word of the language that is not executed in this version
  nothing,  ///< cancels a function that cannot be active in this version
  rapid,
  line,
  arc_cw,
  arc_ccw,
  plane_12,
  plane_31,
  plane_23,
  corner_limited,
  continuous,
  exact,
  inch,
  metric,
  absolute,
  incremental,
  machine_zero,
  dwell,
  exact_once,
  feed_inverse,
  feed_minute,
  feed_revolution,
  surface_speed,
  revolutions,
  cycle,
  cycle_off,
};

/// One G word: `group` is a letter of the manual's table, two words of a group exclude one another.
struct GRule {
  std::uint8_t number;
  char group;
  Function function;
  bool at_power_on = false;
  bool one_shot_with_motion =
      false;  ///< modal in a block without motion; in one with motion the former mode returns
};

/// What the control itself does with an M word, beside handing it to the PLC.
enum class MAction : std::uint8_t {
  none,
  stop,
  optional_stop,
  end,
  end_rewind,
  spindle_cw,
  spindle_ccw,
  spindle_stop,
  spindle_orient,
  tool_change,
};
struct MRule {
  std::uint8_t code;
  bool after_motion;
  MAction action = MAction::none;
  bool in_profile = false;  ///< allowed in the first motion block of a continuous profile
};

/// A three-letter code. `operands` is its signature, one character an operand: n number, x value, a axis, v
/// axis with a value, p axis with two values, l label, c comparison side, i display item, w wait condition, f
/// program name; + after it: one or more, * : any number; everything after ? may be missing. `run` null: not
/// executed in this version.
struct CodeRule {
  std::string_view name;
  std::string_view operands;
  void (*run)(Execution&, const Operands&);
  bool needs_motion_end = false;  ///< read only after the motion before it, as if written with #
};

/// A variable of the control that a program assigns. `set` null: not executed in this version.
struct VariableRule {
  std::string_view name;
  void (*set)(Execution&, double value, int column);
  bool indexed = false;
};

/// What a round bracket at the start of a body opens, or anywhere in it.
enum class Bracket : std::uint8_t { code, comment };

/// The characters with which a language marks things; 0: it has no such mark.
struct Lexis {
  char comment = ';';  ///< from here to the end of the line
  char skip = '/';     ///< block that an operator's switch leaves out
  char label_quote = '"';
  char request_sync = '#';
  char cancel_sync = '&';
  char tape = '%';  ///< a line that begins with it is no block
  Bracket bracket = Bracket::code;
};

/// From where I and J of an arc count.
enum class ArcCentre : std::uint8_t {
  as_dimensions,  ///< absolute with G90, from the start with G91
  from_start,     ///< always from the start of the arc
};

/// A part-program language as data plus its exceptions (the functions behind `run`, `set` and `conflict`).
struct Dialect {
  std::string_view name;
  Lexis lexis;
  ArcCentre arc_centre = ArcCentre::as_dimensions;
  std::size_t max_block_characters;
  std::size_t max_label_characters;
  std::size_t max_block_number_digits;
  int max_m_words;
  int max_repeat_depth;
  int max_repeat_count;
  int max_call_depth;
  std::size_t max_program_name;
  std::size_t max_message_characters;
  std::array<LetterRule, 128> letters;
  std::span<const GRule> g;
  std::span<const MRule> m;
  std::span<const CodeRule> codes;
  std::span<const VariableRule> variables;
  /// Runs a block that defines a canned cycle or stands inside of one, in place of its motion; null: no
  /// cycles.
  void (*cycle)(Execution&, const BlockWords&) = nullptr;
  bool (*conflict)(int g1, int g2);  ///< may not stand in one block (two of one group do not have to be told)

  const GRule* find_g(int number) const noexcept;
  const MRule* find_m(int code) const noexcept;
  const CodeRule* find_code(std::string_view code) const noexcept;
  const VariableRule* find_variable(std::string_view variable) const noexcept;
};

/// The dialect of a name, nullptr when this build does not read it.
const Dialect* find_dialect(std::string_view name);
/// All dialects of this build.
std::span<const Dialect* const> all_dialects();

}  // namespace servogate::program
