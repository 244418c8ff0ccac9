// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/fenix/fenix.hpp"

namespace servogate::program::fenix {
namespace {

/// Table 6 and appendix 1 (specification 6, 22). G2 turns from +Z towards +X, against ISO 6983: the guide's
/// view has X pointing down (specification 7).
constexpr auto rules() {
  std::array<GRule, 148> out{};
  std::size_t n = 0;
  const auto add = [&](GRule rule) { out[n++] = rule; };
  add({.number = 0, .group = '1', .function = Function::rapid});
  add({.number = 1, .group = '1', .function = Function::line, .at_power_on = true, .take = take_line});
  add({.number = 2, .group = '1', .function = Function::arc_ccw, .then = Function::line, .take = take_arc});
  add({.number = 3, .group = '1', .function = Function::arc_cw, .then = Function::line, .take = take_arc});
  add({.number = 4, .group = '1', .function = Function::own, .motion = dwell});
  add({.number = 9, .group = '2', .function = Function::exact_once});
  add({.number = 15, .group = '1', .function = Function::own, .motion = turn_spindle, .take = as_motion});
  add({.number = 30,
       .group = '1',
       .function = Function::own,
       .motion = home,
       .take = as_motion,
       .names_axes = true});
  add({.number = 31, .group = '1', .function = Function::own, .motion = thread_passes});
  add({.number = 32, .group = '1', .function = Function::own, .motion = thread_once});
  for (const std::uint16_t cycle : {70, 71, 72, 73, 74, 75, 77, 78})
    add({.number = cycle, .group = 't', .function = Function::own, .motion = turning});
  add({.number = 26, .group = '5', .function = Function::radius, .one_shot_with_motion = true});
  add({.number = 27,
       .group = '5',
       .function = Function::diameter,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 45, .group = '3', .function = Function::nothing, .take = corrector_on});
  add({.number = 46, .group = '3', .function = Function::nothing, .take = corrector_off});
  add({.number = 50, .group = '4', .function = Function::work_offset});
  for (std::uint16_t i = 1; i <= 4; ++i)
    add({.number = static_cast<std::uint16_t>(53 + i),
         .group = '4',
         .function = Function::work_offset,
         .value = static_cast<std::int16_t>(i)});
  for (std::uint16_t i = 5; i <= 99; ++i)
    add({.number = static_cast<std::uint16_t>(500 + i),
         .group = '4',
         .function = Function::work_offset,
         .value = static_cast<std::int16_t>(i)});
  add({.number = 67, .group = '6', .function = Function::nothing, .take = break_chips});
  add({.number = 68, .group = '6', .function = Function::nothing, .take = keep_chips});
  for (const std::uint16_t cycle : {81, 810, 811, 812, 820, 821, 822, 823, 824, 825, 826})
    add({.number = cycle, .group = 'c', .function = Function::own, .motion = holes});
  add({.number = 851, .group = 'c', .function = Function::own, .motion = profile_corners});
  add({.number = 852, .group = 'c', .function = Function::own, .motion = profile_contour});
  for (const std::uint16_t cycle : {853, 855})
    add({.number = cycle, .group = 'c', .function = Function::own, .motion = profile});
  add({.number = 90, .group = '7', .function = Function::absolute, .one_shot_with_motion = true});
  add({.number = 91,
       .group = '7',
       .function = Function::incremental,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 94,
       .group = '8',
       .function = Function::feed_minute,
       .one_shot_with_motion = true,
       .take = feed_per_minute});
  add({.number = 95,
       .group = '8',
       .function = Function::feed_revolution,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 96,
       .group = '9',
       .function = Function::surface_speed,
       .one_shot_with_motion = true,
       .take = cutting_speed});
  add({.number = 97,
       .group = '9',
       .function = Function::revolutions,
       .at_power_on = true,
       .one_shot_with_motion = true});
  return std::pair{out, n};
}
constexpr auto kG = rules();
constexpr GRule kCycleCall = {.number = 0, .group = 'c', .function = Function::own, .motion = call_cycle};

/// Specification 16; when they act in their block is its reading (specification 24, 25).
constexpr MRule kM[] = {
    {0, true, MAction::stop},
    {2, true, MAction::end_rewind},
    {3, false, MAction::spindle_cw},
    {4, false, MAction::spindle_ccw},
    {5, true, MAction::spindle_stop},
    {8, false},
    {9, true},
    {10, false, MAction::spindle_reverse},
    {17, true, MAction::subprogram_end},
    {19, true, MAction::spindle_orient},
    {20, true, MAction::repeat_end},
    {30, true, MAction::end_rewind},
    {38, false},
    {39, false},
    {40, false},
    {41, false},
    {42, false},
    {43, false},
};

/// Rows and columns of appendix 1.
enum class Kind { free, motion, dwell, exact, home, thread, turning, hole, mode, feed_minute, cutting };

Kind kind_of(int g) {
  if (g <= 3 || g == 15) return Kind::motion;
  if (g == 4) return Kind::dwell;
  if (g == 9) return Kind::exact;
  if (g == 30) return Kind::home;
  if (g == 31 || g == 32) return Kind::thread;
  if (g >= 70 && g <= 78) return Kind::turning;
  if (g == 81 || g >= 800) return Kind::hole;
  if (g == 94) return Kind::feed_minute;
  if (g == 96) return Kind::cutting;
  return g == 26 || g == 27 || (g >= 90 && g <= 97) ? Kind::mode : Kind::free;
}

/// Words of two groups that may not stand in one block; a turning cycle takes G0 or G1 (specification 18).
bool exclude(Kind one, Kind other) {
  switch (one) {
    case Kind::home:
      return other != Kind::free;
    case Kind::thread:
      return other == Kind::feed_minute || other == Kind::cutting || other == Kind::exact ||
             other == Kind::turning || other == Kind::hole;
    case Kind::dwell:
      return other == Kind::exact || other == Kind::turning || other == Kind::hole;
    case Kind::exact:
      return other == Kind::turning || other == Kind::hole;
    case Kind::motion:
      return other == Kind::hole;
    case Kind::turning:
      return other == Kind::hole;
    default:
      return false;
  }
}

bool conflict(int g1, int g2) {
  const Kind one = kind_of(g1), other = kind_of(g2);
  return exclude(one, other) || exclude(other, one);
}

/// Values of the guide's machine parameters that programs go by.
constexpr VariableRule kVariables[] = {{"P404", clearance}, {"P2622", deviation}};

constexpr double kCoordinate = 2147483647;  ///< in a dwell it counts ms; lengths have their own limit

constexpr std::array<LetterRule, 128> letters() {
  std::array<LetterRule, 128> rules{};
  const auto at = [&](char c) -> LetterRule& { return rules[static_cast<std::size_t>(c)]; };
  const auto statement = [&](char c, const WordRule& rule) {
    at(c) = {.meaning = Meaning::statement, .rule = &rule};
  };
  for (const char c : {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'})
    at(c) = {.meaning = Meaning::axis, .min = -kCoordinate, .max = kCoordinate, .bare = true};
  at('N') = {.meaning = Meaning::number, .max = 99999999};
  at(':') = at('N');
  at('G') = {.meaning = Meaning::g, .max = 999};
  at('M') = {.meaning = Meaning::m, .max = 999};
  for (const char c : {'I', 'J', 'K'})
    at(c) = {.meaning = Meaning::centre_of,
             .min = -kCoordinate,
             .max = kCoordinate,
             .axis = static_cast<char>('X' + c - 'I')};
  at('E') = {.meaning = Meaning::amount, .max = 2147483000};
  at('F') = {.meaning = Meaning::feed, .min = 0.0001, .max = 99999999};
  at('S') = {.meaning = Meaning::speed, .max = 99999999};
  at('T') = {.meaning = Meaning::tool, .max = 255};
  at('D') = {.meaning = Meaning::corrector, .min = 1, .max = 4};
  statement('R', kAssignR);
  statement('$', kAssignVariable);
  statement('~', kJump);
  statement('L', kCall);
  statement('H', kRepeat);
  statement('@', kCycleHeader);
  statement('#', kCycleEnd);
  return rules;
}

/// The guide's numbers (specification 23).
constexpr OwnError kErrors[] = {
    {Fault::feed_missing,
     {"P703, 124", "no feed: program F in the unit that is in force (G94, G95)",
      "нет подачи: задайте F в действующих единицах (G94, G95)"}},
    {Fault::spindle_stands,
     {"P824, 124", "the feed is per revolution, and the spindle stands: S and M3 or M4 first",
      "подача на оборот, а шпиндель стоит: сначала S и M3 или M4"}},
    {Fault::not_congruent,
     {"P706, 151", "the radius of the arc is {0} at the start and {1} at the end",
      "радиус дуги в начале {0}, в конце {1}"}},
};

const Dialect kDialect = {
    .name = "fenix",
    .lexis = {.comment_pair = '/',
              .skip = 0,
              .tape = '%',
              .starts_at_tape = true,
              .bracket = Bracket::argument,
              .decimal_comma = true,
              .bare_block_number = true},
    .terms =
        {.prefix = "N or :", .prefix_russian = "N или :", .repeat = "H", .repeat_end = "M20", .field = {}},
    .expressions = expressions(),
    .parameters = parameters(),
    .arc_centre = ArcCentre::from_start_any,
    .plane = Function::plane_31,
    .corner = Function::continuous,
    .tool_change = ToolChange::at_once,
    .feed_by_unit = true,
    .standing_is_error = true,
    .max_block_characters = 255,
    .max_label_characters = 0,
    .max_block_number_digits = 8,
    .max_m_words = 1,
    .max_repeat_depth = 16,
    .max_call_depth = 16,
    .letters = letters(),
    .g = std::span(kG.first).first(kG.second),
    .other_g = &kCycleCall,
    .m = kM,
    .variables = kVariables,
    .errors = kErrors,
    .conflict = conflict,
    .value = value_in_place_of_number,
    .mark = mark,
    .judge = judge,
    .system = system_value,
    .corrector = [](int tool, int number) { return 10 * tool + number; },
};

}  // namespace

const Dialect& dialect() { return kDialect; }

}  // namespace servogate::program::fenix
