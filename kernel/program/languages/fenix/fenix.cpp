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
  add({.number = 1, .group = '1', .function = Function::line, .at_power_on = true});
  add({.number = 2, .group = '1', .function = Function::arc_ccw, .then = Function::line});
  add({.number = 3, .group = '1', .function = Function::arc_cw, .then = Function::line});
  add({.number = 4, .group = '1', .function = Function::own, .motion = dwell});
  add({.number = 9, .group = '2', .function = Function::exact_once});
  for (const std::uint16_t later : {15, 30, 31, 32, 70, 71, 72, 73, 74, 75, 77, 78})
    add({.number = later, .group = '1', .function = Function::later});
  add({.number = 26, .group = '5', .function = Function::radius, .one_shot_with_motion = true});
  add({.number = 27,
       .group = '5',
       .function = Function::diameter,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 45, .group = '3', .function = Function::nothing});
  add({.number = 46, .group = '3', .function = Function::later});
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
  add({.number = 67, .group = '6', .function = Function::later});
  add({.number = 68, .group = '6', .function = Function::nothing});
  for (const std::uint16_t later : {81, 810, 811, 812, 820, 821, 822, 823, 824, 825, 826, 851, 852, 853, 855})
    add({.number = later, .group = 'c', .function = Function::later});
  add({.number = 90, .group = '7', .function = Function::absolute, .one_shot_with_motion = true});
  add({.number = 91,
       .group = '7',
       .function = Function::incremental,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 94, .group = '8', .function = Function::feed_minute, .one_shot_with_motion = true});
  add({.number = 95,
       .group = '8',
       .function = Function::feed_revolution,
       .at_power_on = true,
       .one_shot_with_motion = true});
  add({.number = 96, .group = '9', .function = Function::later});
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
    {2, true, MAction::end},
    {3, false, MAction::spindle_cw},
    {4, false, MAction::spindle_ccw},
    {5, true, MAction::spindle_stop},
    {8, false},
    {9, true},
    {10, false, MAction::later},
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

constexpr double kCoordinate = 2147483647;  ///< in a dwell it counts ms; lengths have their own limit

constexpr std::array<LetterRule, 128> letters() {
  std::array<LetterRule, 128> rules{};
  const auto at = [&](char c) -> LetterRule& { return rules[static_cast<std::size_t>(c)]; };
  const auto statement = [&](char c, const WordRule& rule) {
    at(c) = {.meaning = Meaning::statement, .rule = &rule};
  };
  for (const char c : {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'})
    at(c) = {.meaning = Meaning::axis, .min = -kCoordinate, .max = kCoordinate};
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
     {"P703, 124", "no feed: F was never programmed", "нет подачи: F ещё не задавалась"}},
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
    .variables = {},
    .errors = kErrors,
    .conflict = [](int, int) { return false; },
    .value = value_in_place_of_number,
    .mark = mark,
    .judge = judge,
    .system = system_value,
    .corrector = [](int tool, int number) { return 10 * tool + number; },
};

}  // namespace

const Dialect& dialect() { return kDialect; }

}  // namespace servogate::program::fenix
