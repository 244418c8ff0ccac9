// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/values/expression.hpp"
#include "kernel/program/values/parameters.hpp"

namespace servogate::program {

class Execution;
class Source;
struct MachineModel;
struct Block;
struct BlockText;
struct BlockWords;
struct Value;
struct Word;

/// What a letter in front of a number means. The same letter means different things in different languages.
enum class Meaning : std::uint8_t {
  unknown,  ///< not a letter of this language
  later,    ///< a letter of this language whose function is not executed in this version
  number,   ///< block number
  g,
  m,
  h,
  axis,
  centre_1,   ///< centre of an arc along the abscissa of the plane
  centre_2,   ///< ... along its ordinate
  centre_of,  ///< ... along the axis that LetterRule::axis names
  pitch,
  radius,
  feed,
  block_time,
  speed,
  tool,
  corrector,
  count,      ///< how often: a word of its own that a call takes
  angle,      ///< of a rotation
  amount,     ///< a number that a function of the block takes
  factor_1,   ///< share of the tool's radius that is added to the coordinate of the machine's first axis ...
  factor_2,   ///< ... its second ...
  factor_3,   ///< ... and its third one
  statement,  ///< more than a number: its WordRule reads and executes it
};

/// Which parameters may stand for a number of a word.
enum class ParameterKind : std::uint8_t { none, whole, real, any };

/// When a statement acts in its block.
enum class When : std::uint8_t {
  in_order,    ///< where it stands among the words: those behind it see what it has done
  for_motion,  ///< in place of the block's motion; takes its axis words
  at_the_end,  ///< behind all else of the block, in the order written
};

/// A word that is more than a letter and a number: an assignment, a jump, a call, a frame, or an address of
/// several letters.
struct WordRule {
  std::string_view name;
  Meaning meaning = Meaning::statement;
  When when = When::in_order;
  /// Reads what stands behind the name; null: = and an expression.
  void (*read)(BlockText&, Word&) = nullptr;
  /// Executes a statement; null: not executed in this version.
  void (*run)(Execution&, const Word&) = nullptr;
  void (*motion)(Execution&, const BlockWords&) = nullptr;  ///< the same of When::for_motion
  char axis = 0;                                            ///< of Meaning::centre_of
};

/// One letter of a language: its meaning, its range, the parameters it takes.
struct LetterRule {
  Meaning meaning = Meaning::unknown;
  ParameterKind parameters = ParameterKind::none;
  double min = 0.0;
  double max = 0.0;
  bool twice = false;  ///< may stand in a block a second time
  bool bare = false;   ///< may stand without a number
  bool many = false;   ///< may stand any number of times; the language judges it
  bool other = false;  ///< of Meaning::axis: may name no axis of the machine; the language judges it
  char axis = 0;       ///< of Meaning::centre_of; of Meaning::axis: increments of that axis
  const WordRule* rule = nullptr;  ///< of Meaning::statement
};

/// What a G word does in this version, whatever its number is.
enum class Function : std::uint8_t {
  later,    ///< a G word of the language that is not executed in this version
  nothing,  ///< cancels a function that cannot be active in this version
  own,      ///< what GRule::motion does, in place of the block's motion
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
  diameter,           ///< words of a diameter axis count as diameters ...
  diameter_absolute,  ///< ... or only those of absolute dimensions ...
  radius,             ///< ... or none
  machine_zero,
  work_offset,  ///< GRule::value: number of the origin
  dwell,
  exact_once,
  spindle_mark,  ///< the block's motion begins at the zero mark of the spindle
  feed_inverse,
  feed_minute,
  feed_revolution,
  surface_speed,
  revolutions,
  cycle,
  compensation_off,
  compensation_left,  ///< the tool's centre runs left of the path, seen in its direction
  compensation_right,
  profile_off,
  profile_on,  ///< blocks name geometric elements
  thread,      ///< motion by the turns of the spindle
  spline,      ///< a curve through points
  cycle_off,
};
inline constexpr std::size_t kFunctions = static_cast<std::size_t>(Function::cycle_off) + 1;

/// G words with a point have numbers of their own: 1000 times the digit behind it and the number, G07.1 is
/// 1007.
std::string g_name(int number);
inline constexpr int kPointInG = 1000;

/// One G word: `group` is a letter of the manual's table, two words of a group exclude one another.
struct GRule {
  std::uint16_t number;
  char group;
  Function function;
  bool at_power_on = false;
  bool one_shot_with_motion =
      false;  ///< modal in a block without motion; in one with motion the former mode returns
  Function then = Function::nothing;  ///< mode in force behind the block; nothing: this one
  std::int16_t value = 0;
  void (*motion)(Execution&, const BlockWords&) = nullptr;  ///< of Function::own
  /// Behind the mode that it sets, with the arguments that only such a word takes; null: nothing.
  void (*take)(Execution&, BlockWords&, const Word&) = nullptr;
  bool names_axes = false;  ///< the values of axis words beside it do not count and may be missing
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
  spindle_reverse,  ///< stops it and turns it the other way; nothing where it stands
  tool_change,
  subprogram_end,  ///< not handed to the PLC
  repeat_end,      ///< not handed to the PLC
  own,             ///< what the machine builder made of it; not handed to the PLC
  later,           ///< an M word of the language that is not executed in this version
};
struct MRule {
  std::uint16_t code;
  bool after_motion;
  MAction action = MAction::none;
  bool in_profile = false;  ///< allowed in the first motion block of a continuous profile
};

/// A variable of the control that a program assigns. `set` null: not executed in this version.
struct VariableRule {
  std::string_view name;
  void (*set)(Execution&, double value, int index, int column);
  bool indexed = false;  ///< `index` is the number behind the name, -1: it has none
};

/// What a round bracket opens: a block of the language's own form where it stands first in it, a comment
/// anywhere, arguments of a G word or an expression in the place of a number.
enum class Bracket : std::uint8_t { own_form, comment, argument };

/// How a label stands in front of a block.
enum class LabelForm : std::uint8_t { none, quoted, colon };

/// The characters with which a language marks things; 0: it has no such mark.
struct Lexis {
  char comment = ';';        ///< from here to the end of the line
  char comment_pair = 0;     ///< the same where it stands twice
  char skip = '/';           ///< block that an operator's switch leaves out
  bool skip_levels = false;  ///< a digit behind it is a switch of its own
  LabelForm label = LabelForm::none;
  char request_sync = 0;
  char cancel_sync = 0;
  char tape = 0;                ///< a line that begins with it is no block
  bool starts_at_tape = false;  ///< ... and the main program stands behind it
  Bracket bracket = Bracket::comment;
  bool equals_is_own_form = false;  ///< a block with = outside of quotes is one of the language's own form
  bool named_words = false;         ///< two letters or more are a name, small letters as capitals
  bool decimal_comma = false;
  bool bare_block_number = false;    ///< N without digits
  bool bare_is_zero = false;         ///< a letter without a value counts as 0, where 0 is possible
  bool g_first = false;              ///< G words stand before coordinates
  bool tool_with_corrector = false;  ///< T3.12
  bool comment_behind_words = true;  ///< the old control knows it, too
  bool skip_anywhere = false;        ///< the rest of the block behind a skip mark is left out
  bool point_in_g = false;           ///< G07.1, see g_name()
};

/// How the centre of an arc is given.
enum class ArcCentre : std::uint8_t {
  as_dimensions,   ///< absolute with absolute dimensions, from the start with incremental ones; both words
  from_start,      ///< always from the start of the arc; both words
  from_start_any,  ///< the same, a word that is missing is 0
};

/// When the lengths of a tool come into force.
enum class ToolChange : std::uint8_t {
  by_function,  ///< with the M function of MAction::tool_change
  at_once,      ///< with T or the corrector's word
};

/// What a line means for those before and behind it.
struct LineMark {
  enum class Kind : std::uint8_t { none, repeat, end_of_repeat, definition } kind = Kind::none;
  std::int32_t number = 0;  ///< of a definition
};

/// What reading alone judges of a block (Dialect::judge).
struct Judgement {
  const Execution& run;
  const Source& source;
  std::uint32_t line;
  /// To be told the names of programs that it calls.
  void (*calls)(void* where, std::string_view name);
  void* where;
};

/// What the old control had a number of its own for: the message of `fault` with both, id "P703, 124".
struct OwnError {
  Fault fault;
  text::Entry entry;
};

/// The language's own words for what shared messages speak of.
struct Terms {
  std::string_view prefix, prefix_russian;  ///< what a block begins with, in its order
  std::string_view repeat, repeat_end;
  std::string_view field;  ///< what sets the working field
};

/// A part-program language as data plus its exceptions (the functions behind the pointers).
struct Dialect {
  std::string_view name;
  Lexis lexis;
  Terms terms = {};
  Expressions expressions;
  ParameterSet parameters;
  ArcCentre arc_centre = ArcCentre::as_dimensions;
  bool centre_as_diameter = true;  ///< the centre's word along a diameter axis counts as its coordinates do
  Function plane = Function::plane_12;         ///< at power-on, where no G word says another
  Function corner = Function::corner_limited;  ///< at power-on, where no G word says another
  ToolChange tool_change = ToolChange::by_function;
  bool end_returns = false;          ///< the end of the program returns from a subprogram
  bool origins_exist = false;        ///< all of them, 0 where the table has no row
  bool feed_by_unit = false;         ///< F counts only in the unit (G94, G95) in which it was written
  bool standing_is_error = false;    ///< a feed per revolution while the spindle stands; otherwise a warning
  bool subprogram_end_ends = false;  ///< the end of a subprogram ends the main program
  /// Of an outer corner of a compensated contour, in radii of the tool: a sharper one is gone round on an
  /// arc.
  double longest_spike = 100.0;
  std::size_t max_block_characters;
  std::size_t max_label_characters;
  std::size_t max_block_number_digits;
  int max_m_words;
  int max_repeat_depth;
  int max_call_depth;
  std::string_view virtual_axes = {};    ///< letters of virtual axes, where the machine has no such axis
  std::string_view index_variable = {};  ///< and a letter: variable with the positions in a turn of that axis
  bool sign_is_direction = false;  ///< of an absolute angle on a rotary axis without ends, below 360 degrees
  std::array<LetterRule, 128> letters;
  std::span<const GRule> g;
  const GRule* other_g = nullptr;  ///< G words of other numbers; null: there are none
  std::span<const MRule> m;
  std::span<const WordRule> words = {};  ///< named words
  std::span<const VariableRule> variables;
  std::span<const OwnError> errors = {};
  bool (*conflict)(int g1, int g2);  ///< may not stand in one block (two of one group do not have to be told)
  /// A number that is not written in digits, at the text's place; false: none stands there. Null: no such.
  bool (*value)(BlockText&, Value&) = nullptr;
  /// What a line means for those before and behind it; `pos`: behind the skip mark and a quoted label.
  LineMark (*mark)(std::string_view line, std::size_t pos) = nullptr;
  /// Executes a block of the language's own form, and says whether it has to wait for the motion before it.
  void (*own_form)(Execution&) = nullptr;
  bool (*own_form_waits)(const Block&) = nullptr;
  /// Throws what reading alone can say against a block that has been taken apart.
  void (*judge)(const Judgement&, const Block&) = nullptr;
  /// Throws for words that may not stand in a motion block of a running profile; null: all may.
  void (*profile)(const Execution&, const BlockWords&) = nullptr;
  /// Runs a block that defines a canned cycle or stands inside of one, in place of its motion; null: no
  /// cycles.
  void (*cycle)(Execution&, const BlockWords&) = nullptr;
  void (*dwell)(Execution&, const Word&) = nullptr;  ///< of Function::dwell, after the motion
  /// True for a line that holds what stands between two elements of a contour; null: the language has none.
  bool (*corner_word)(std::string_view line, std::size_t first) = nullptr;
  /// Runs a block with axes only while blocks name geometric elements (Function::profile_on).
  void (*across)(Execution&, const BlockWords&) = nullptr;
  /// Runs a motion block while a curve is open, and one of Function::spline.
  void (*spline)(Execution&, const BlockWords&) = nullptr;
  /// Runs a block of Function::thread.
  void (*thread)(Execution&, const BlockWords&) = nullptr;
  double (*system)(const Execution&, int number, int column) = nullptr;  ///< a value of the control
  int (*corrector)(int tool, int number) = nullptr;  ///< row of the table; null: the number itself
  /// Of two modes of a group the last one of the block counts.
  bool last_mode_counts = false;
  bool side_changes =
      false;  ///< of the radius compensation, without an end between; its end leads to the path
  /// Looks at what a block asks for before anything of it is executed: numbers by the modes in force,
  /// functions that last over several blocks.
  void (*arrange)(Execution&, BlockWords&) = nullptr;
  /// The language with which programs begin on a machine; null: this one.
  const Dialect& (*begins)(const MachineModel&) = nullptr;
  /// The language of the lines behind this one; null: the same. `first`: it is the first line of a
  /// subprogram.
  const Dialect* (*speaks)(const MachineModel&, std::string_view line, bool first) = nullptr;

  const GRule* find_g(int number) const noexcept;
  const MRule* find_m(int code) const noexcept;
  const WordRule* find_word(std::string_view word) const noexcept;
  const VariableRule* find_variable(std::string_view variable) const noexcept;
  /// The message as this language has it: with the old control's number, where it had one.
  const text::Entry* own(const text::Entry* entry) const noexcept;
  /// The named word that has a meaning, null: none.
  const WordRule* word_of(Meaning meaning) const noexcept;
  /// The letter that has a meaning, 0: none.
  char letter_of(Meaning meaning) const noexcept;
};

}  // namespace servogate::program
