// SPDX-License-Identifier: Apache-2.0
// The G words of table 1-2 to 1-4 and 2-3 of the manual (specification 2) as one table of functions.
#include <vector>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program::sinumerik::iso {
namespace {

enum System : std::size_t { turning_a, turning_b, turning_c, milling, systems };
constexpr int kNo = -1;

using Numbers = std::array<int, systems>;  ///< of one function in each table
using Motion = void (*)(Execution&, const BlockWords&);
using Take = void (*)(Execution&, BlockWords&, const Word&);

constexpr Numbers all(int n) { return {n, n, n, n}; }
constexpr Numbers turn(int a, int b, int c) { return {a, b, c, kNo}; }
constexpr Numbers turn(int n) { return {n, n, n, kNo}; }
constexpr Numbers mill(int n) { return {kNo, kNo, kNo, n}; }
constexpr int point(int number, int digit) { return kPointInG * digit + number; }

constexpr unsigned kTurns = 1u << turning_a | 1u << turning_b | 1u << turning_c, kMills = 1u << milling;

struct Row {
  int group;  ///< of turning; milling only tells its own where they meet
  Numbers numbers;
  Function function = Function::nothing;
  Motion motion = nullptr;
  Take take = nullptr;
  unsigned at_power_on = 0;  ///< bit of each system
  std::int16_t value = 0;
};

constexpr int kMotion = 1, kDimension = 3, kFeed = 5, kUnit = 6, kRadius = 7, kLength = 8, kHoles = 10,
              kReturn = 11, kMacro = 12, kOffset = 14, kExact = 15, kPlane = 16, kPolar = 17, kOnce = 18,
              kScale = 19, kPolygon = 20, kFace = 21, kMirror = 22, kSpeed = 23, kRotation = 24, kMode = 25;

constexpr Row kRows[] = {
    {kMotion, all(0), Function::rapid, nullptr, plain_motion, kTurns | kMills},
    {kMotion, all(1), Function::line, nullptr, plain_motion},
    {kMotion, all(2), Function::arc_cw, nullptr, plain_motion},
    {kMotion, all(3), Function::arc_ccw, nullptr, plain_motion},
    {kMotion, turn(32, 33, 33), Function::thread, nullptr, thread_constant},
    {kMotion, turn(34), Function::thread, nullptr, thread_variable},
    {kMotion, turn(90, 77, 20), Function::nothing, nullptr, begin_longitudinal},
    {kMotion, turn(92, 78, 21), Function::nothing, nullptr, begin_thread_cycle},
    {kMotion, turn(94, 79, 24), Function::nothing, nullptr, begin_facing},
    {kSpeed, all(96), Function::surface_speed},
    {kSpeed, all(97), Function::revolutions, nullptr, nullptr, kTurns | kMills},
    {kDimension, {kNo, 90, 90, 90}, Function::absolute, nullptr, nullptr, kTurns | kMills},
    {kDimension, {kNo, 91, 91, 91}, Function::incremental},
    {kRotation, turn(68), Function::own, rotate_turned},
    {kRotation, mill(68), Function::own, rotate},
    {kRotation, all(69), Function::own, rotate_off},
    {kFeed, {98, 94, 94, 94}, Function::feed_minute, nullptr, another_feed, kTurns | kMills},
    {kFeed, {99, 95, 95, 95}, Function::feed_revolution, nullptr, another_feed},
    {kFeed, mill(93), Function::feed_inverse, nullptr, another_feed},
    {kUnit, {20, 20, 70, 20}, Function::inch, nullptr, lengths_only},
    {kUnit, {21, 21, 71, 21}, Function::metric, nullptr, nullptr, kTurns | kMills},
    {kRadius, all(40), Function::compensation_off, nullptr, nose_off, kTurns | kMills},
    {kRadius, all(41), Function::compensation_left, nullptr, nose_on},
    {kRadius, all(42), Function::compensation_right, nullptr, nose_on},
    {kLength, mill(43), Function::nothing, nullptr, length_plus},
    {kLength, mill(44), Function::nothing, nullptr, length_minus},
    {kLength, mill(49), Function::nothing, nullptr, length_off, kMills},
    {kHoles, all(80), Function::nothing, nullptr, end_hole},
    {kHoles, mill(73), Function::nothing, nullptr, begin_hole},
    {kHoles, mill(74), Function::nothing, nullptr, begin_hole},
    {kHoles, mill(76), Function::nothing, nullptr, begin_hole},
    {kHoles, mill(81), Function::nothing, nullptr, begin_hole},
    {kHoles, mill(82), Function::nothing, nullptr, begin_hole},
    {kHoles, all(83), Function::nothing, nullptr, begin_hole},
    {kHoles, all(84), Function::nothing, nullptr, begin_hole},
    {kHoles, all(85), Function::nothing, nullptr, begin_hole},
    {kHoles, mill(86), Function::nothing, nullptr, begin_hole},
    {kHoles, all(87), Function::nothing, nullptr, begin_hole},
    {kHoles, turn(88), Function::nothing, nullptr, begin_hole},
    {kHoles, all(89), Function::nothing, nullptr, begin_hole},
    {kReturn, {kNo, 98, 98, 98}, Function::nothing, nullptr, to_initial, kTurns | kMills},
    {kReturn, {kNo, 99, 99, 99}, Function::nothing, nullptr, to_level},
    {kMacro, all(66), Function::own, modal_macro},
    {kMacro, all(67), Function::nothing, nullptr, macro_off, kTurns | kMills},
    {kOffset, all(54), Function::work_offset, nullptr, settable, kMills, 1},
    {kOffset, all(55), Function::work_offset, nullptr, settable, 0, 2},
    {kOffset, all(56), Function::work_offset, nullptr, settable, 0, 3},
    {kOffset, all(57), Function::work_offset, nullptr, settable, 0, 4},
    {kOffset, all(58), Function::work_offset, nullptr, settable, 0, 5},
    {kOffset, all(59), Function::work_offset, nullptr, settable, 0, 6},
    {kExact, mill(61), Function::exact, nullptr, path_mode},
    {kExact, mill(63), Function::continuous, nullptr, tapping_mode},
    {kExact, mill(64), Function::continuous, nullptr, path_mode, kMills},
    {kPlane, all(17), Function::plane_12, nullptr, nullptr, kMills},
    {kPlane, all(18), Function::plane_31, nullptr, nullptr, kTurns},
    {kPlane, all(19), Function::plane_23},
    {kPolar, mill(15), Function::nothing, nullptr, polar_off, kMills},
    {kPolar, mill(16), Function::nothing, nullptr, polar_on},
    {kScale, mill(50), Function::own, scale_off},
    {kScale, mill(51), Function::own, scale},
    {kMirror, mill(point(50, 1)), Function::own, mirror_off},
    {kMirror, mill(point(51, 1)), Function::own, mirror},
    {kPolygon, turn(point(50, 2)), Function::own, polygon_off},
    {kPolygon, turn(point(51, 2)), Function::own, polygon},
    {kFace, turn(point(12, 1)), Function::own, polar_interpolation},
    {kFace, turn(point(13, 1)), Function::own, polar_interpolation_off},
    {kOnce, all(4), Function::own, dwell},
    {kOnce, all(5), Function::own, fast_call},
    {kOnce, all(point(5, 1)), Function::own, ignored},
    {kOnce, all(point(7, 1)), Function::own, cylinder},
    {kOnce, mill(8), Function::own, look_ahead},
    {kOnce, mill(9), Function::exact_once},
    {kOnce, all(10), Function::own, write_data},
    {kOnce, mill(11), Function::own, ignored},
    {kOnce, all(27), Function::own, reference_check},
    {kOnce, all(28), Function::own, reference_return},
    {kOnce, all(30), Function::own, reference_other},
    {kOnce, all(point(30, 1)), Function::own, reference_floating},
    {kOnce, all(31), Function::own, measure},
    {kOnce, all(52), Function::own, local},
    {kOnce, all(53), Function::own, machine_coordinates},
    {kOnce, all(60), Function::own, one_sided},
    {kOnce, all(65), Function::own, call_macro},
    {kOnce, turn(70, 70, 72), Function::own, finish},
    {kOnce, turn(71, 71, 73), Function::own, rough_along},
    {kOnce, turn(72, 72, 74), Function::own, rough_across},
    {kOnce, turn(73, 73, 75), Function::own, repeat_pattern},
    {kOnce, turn(74, 74, 76), Function::own, groove_along},
    {kOnce, turn(75, 75, 77), Function::own, groove_across},
    {kOnce, turn(76, 76, 78), Function::own, thread_passes},
    {kOnce, {50, 92, 92, 92}, Function::own, preset},
    {kOnce, {point(50, 3), point(92, 1), point(92, 1), point(92, 1)}, Function::own, preset_off},
    {kOnce, mill(point(72, 1)), Function::own, copy_turned},
    {kOnce, mill(point(72, 2)), Function::own, copy_shifted},
    {kMode, all(290), Function::own, to_siemens},
    {kMode, all(291), Function::nothing},
};

std::vector<GRule> g_words(System system) {
  std::vector<GRule> rules;
  for (const Row& row : kRows)
    if (row.numbers[system] != kNo)
      rules.push_back({.number = static_cast<std::uint16_t>(row.numbers[system]),
                       .group = static_cast<char>('A' + row.group),
                       .function = row.function,
                       .at_power_on = (row.at_power_on >> system & 1u) != 0,
                       .value = row.value,
                       .motion = row.motion,
                       .take = row.take});
  return rules;
}

/// Whether they act before or behind the motion is the machine builder's (specification 12.2).
constexpr MRule kM[] = {
    {0, true, MAction::stop},
    {1, true, MAction::optional_stop},
    {2, true, MAction::end_rewind},
    {3, false, MAction::spindle_cw},
    {4, false, MAction::spindle_ccw},
    {5, true, MAction::spindle_stop},
    {6, true, MAction::tool_change},
    {8, false},
    {9, true},
    {17, true, MAction::subprogram_end},
    {19, true, MAction::spindle_orient},
    {29, false},
    {30, true, MAction::end_rewind},
    {98, true},
    {99, true},
};

constexpr double kCoordinate = 99'999'999;

std::array<LetterRule, 128> letters(System system) {
  std::array<LetterRule, 128> rules{};
  const auto rule = [&](char c) -> LetterRule& { return rules[static_cast<std::size_t>(c)]; };
  const auto number = [&](char c, Meaning meaning) {
    rule(c) = {.meaning = meaning, .min = -kCoordinate, .max = kCoordinate};
  };
  for (const char c : {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'}) {
    number(c, Meaning::axis);
    rule(c).other = true;
  }
  if (system == turning_a) {
    constexpr std::string_view kIncrements = "UVWH", kOf = "XYZC";
    for (std::size_t i = 0; i < kIncrements.size(); ++i) {
      number(kIncrements[i], Meaning::axis);
      rule(kIncrements[i]).other = true;
      rule(kIncrements[i]).axis = kOf[i];
    }
  } else {
    number('H', Meaning::amount);
  }
  rule('N') = {.meaning = Meaning::number, .max = 99999999};
  rule(':') = rule('N');
  rule('G') = {.meaning = Meaning::g, .max = 9999};
  rule('M') = {.meaning = Meaning::m, .max = 99999999};
  for (const char c : {'I', 'J', 'K'}) {
    number(c, Meaning::centre_of);
    rule(c).axis = static_cast<char>('X' + c - 'I');
    rule(c).many = true;
  }
  number('R', Meaning::radius);
  number('P', Meaning::count);
  number('Q', Meaning::angle);
  for (const char c : {'L', 'E', 'D', 'O'}) number(c, Meaning::amount);
  rule('F') = {.meaning = Meaning::feed, .max = kCoordinate};
  rule('S') = {.meaning = Meaning::speed, .max = 99999.999};
  rule('T') = {.meaning = Meaning::tool, .max = 99999999};
  rule(',') = {.meaning = Meaning::statement, .rule = &kComma};
  return rules;
}

constexpr OwnError kErrors[] = {
    {Fault::unknown_word, {"P202, 12080", "the language has no word {0}{1}", "в языке нет слова {0}{1}"}},
    {Fault::g_unknown, {"P211, 12470", "the language has no G{0}", "в языке нет G{0}"}},
    {Fault::skip_level,
     {"P114, 14060", "the skip level {0} is none: there are 0 to 9",
      "уровня пропуска {0} нет: есть уровни от 0 до 9"}},
    {Fault::not_congruent,
     {"P706, 14040",
      "the end of the arc does not lie on it: the radius is {0} at the start and {1} at the end",
      "конец дуги лежит не на ней: радиус в начале {0}, в конце {1}"}},
    {Fault::corner_place,
     {"P865", "a chamfer or rounding stands between two motions in the plane",
      "фаска или скругление стоит между двумя перемещениями в плоскости"}},
    {Fault::program_missing, {"P507", "the program {0} is not there", "программы {0} нет"}},
};

/// `values`: expressions stand in place of numbers.
Dialect made(System system, bool values) {
  static const std::vector<GRule> tables[systems] = {g_words(turning_a), g_words(turning_b),
                                                     g_words(turning_c), g_words(milling)};
  const bool turns = system != milling;
  return {
      .name = "sinumerik-808d",
      .lexis = {.skip_levels = true,
                .label =
                    LabelForm::colon,  // a program goes over to the Siemens mode, whose jumps look for them
                .tape = '%',
                .named_words = true,
                .skip_anywhere = true,
                .point_in_g = true},
      .terms = {.prefix = "/ N", .prefix_russian = "/ N", .repeat = {}, .repeat_end = {}, .field = {}},
      .expressions = expressions(),
      .parameters = parameters(),
      .arc_centre = ArcCentre::from_start_any,
      .centre_as_diameter = false,
      .plane = turns ? Function::plane_31 : Function::plane_12,
      .corner = Function::continuous,
      .tool_change = turns ? ToolChange::at_once : ToolChange::by_function,
      .end_returns = true,
      .origins_exist = true,
      .longest_spike = 2.0,
      .max_block_characters = 512,
      .max_label_characters = 32,
      .max_block_number_digits = 8,
      .max_m_words = 5,
      .max_repeat_depth = 0,
      .max_call_depth = 16,
      .virtual_axes = "uvw",
      .letters = letters(system),
      .g = tables[system],
      .m = kM,
      .variables = settings(),
      .errors = kErrors,
      .conflict = [](int, int) { return false; },
      .value = values ? value_of_macro : no_value_of_macro,
      .judge = judge,
      .thread = thread,
      .system = system_value,
      .last_mode_counts = true,
      .side_changes = true,
      .arrange = arrange,
      .speaks = speaks,
  };
}

const Dialect& of(System system, bool values) {
  static const std::array<std::array<Dialect, systems>, 2> kDialects = [] {
    std::array<std::array<Dialect, systems>, 2> all{};
    for (std::size_t with = 0; with < 2; ++with)
      for (std::size_t s = 0; s < systems; ++s) all[with][s] = made(static_cast<System>(s), with == 1);
    return all;
  }();
  return kDialects[values ? 1 : 0][system];
}

}  // namespace

const Dialect& dialect(const MachineModel& machine) {
  const double mask = machine.variable("MD20734", 0.0);
  const bool values = mask >= 0.0 && mask < 1e9 && (static_cast<unsigned>(mask) >> 3 & 1u) != 0;
  if (!machine.turns()) return of(milling, values);
  const double system = machine.variable("MD10881", 1.0);
  return of(system == 0.0 ? turning_b : system == 2.0 ? turning_c : turning_a, values);
}

bool is_iso(const Dialect& language) { return language.arrange == arrange; }

}  // namespace servogate::program::sinumerik::iso
