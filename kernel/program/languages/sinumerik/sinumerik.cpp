// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

#include <algorithm>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

namespace servogate::program::sinumerik {
namespace {

/// Groups by their first letter: motion, other motion, plane, offset, corner, exact, dimension, unit, feed,
/// radius compensation, speed.
constexpr GRule kG[] = {
    {.number = 0, .group = 'm', .function = Function::rapid},
    {.number = 1, .group = 'm', .function = Function::line, .at_power_on = true},
    {.number = 2, .group = 'm', .function = Function::arc_cw},
    {.number = 3, .group = 'm', .function = Function::arc_ccw},
    {.number = 33, .group = 'm', .function = Function::later},
    {.number = 34, .group = 'm', .function = Function::later},
    {.number = 35, .group = 'm', .function = Function::later},
    {.number = 331, .group = 'm', .function = Function::later},
    {.number = 332, .group = 'm', .function = Function::later},
    {.number = 4, .group = 'o', .function = Function::own, .motion = dwell},
    {.number = 63, .group = 'o', .function = Function::later},
    {.number = 74, .group = 'o', .function = Function::later},
    {.number = 75, .group = 'o', .function = Function::later},
    {.number = 9, .group = 'e', .function = Function::exact_once},
    {.number = 17, .group = 'p', .function = Function::plane_12, .at_power_on = true},
    {.number = 18, .group = 'p', .function = Function::plane_31},
    {.number = 19, .group = 'p', .function = Function::plane_23},
    {.number = 25, .group = 'l', .function = Function::later},
    {.number = 26, .group = 'l', .function = Function::later},
    {.number = 40, .group = 'r', .function = Function::nothing},
    {.number = 41, .group = 'r', .function = Function::later},
    {.number = 42, .group = 'r', .function = Function::later},
    {.number = 53, .group = 's', .function = Function::later},
    {.number = 153, .group = 's', .function = Function::later},
    {.number = 500, .group = 'w', .function = Function::work_offset},
    {.number = 54, .group = 'w', .function = Function::work_offset, .at_power_on = true, .value = 1},
    {.number = 55, .group = 'w', .function = Function::work_offset, .value = 2},
    {.number = 56, .group = 'w', .function = Function::work_offset, .value = 3},
    {.number = 57, .group = 'w', .function = Function::work_offset, .value = 4},
    {.number = 58, .group = 'w', .function = Function::work_offset, .value = 5},
    {.number = 59, .group = 'w', .function = Function::work_offset, .value = 6},
    {.number = 60, .group = 'c', .function = Function::exact, .at_power_on = true},
    {.number = 64, .group = 'c', .function = Function::continuous},
    {.number = 70, .group = 'u', .function = Function::inch, .take = lengths_only},
    {.number = 71, .group = 'u', .function = Function::metric, .at_power_on = true},
    {.number = 700, .group = 'u', .function = Function::inch, .take = with_feeds},
    {.number = 710, .group = 'u', .function = Function::metric},
    {.number = 90, .group = 'd', .function = Function::absolute, .at_power_on = true},
    {.number = 91, .group = 'd', .function = Function::incremental},
    {.number = 93, .group = 'f', .function = Function::feed_inverse},
    {.number = 94, .group = 'f', .function = Function::feed_minute, .at_power_on = true, .take = new_feed},
    {.number = 95, .group = 'f', .function = Function::feed_revolution, .take = new_feed},
    {.number = 96, .group = 'v', .function = Function::later},
    {.number = 97, .group = 'v', .function = Function::revolutions, .at_power_on = true},
    {.number = 110, .group = 'o', .function = Function::later},
    {.number = 111, .group = 'o', .function = Function::later},
    {.number = 112, .group = 'o', .function = Function::later},
    {.number = 147, .group = 'o', .function = Function::later},
    {.number = 148, .group = 'o', .function = Function::later},
    {.number = 247, .group = 'o', .function = Function::later},
    {.number = 248, .group = 'o', .function = Function::later},
    {.number = 290, .group = 'i', .function = Function::nothing},
    {.number = 291, .group = 'i', .function = Function::own, .motion = to_iso},
    {.number = 347, .group = 'o', .function = Function::later},
    {.number = 348, .group = 'o', .function = Function::later},
    {.number = 450, .group = 'k', .function = Function::nothing},
    {.number = 451, .group = 'k', .function = Function::later},
    {.number = 601, .group = 'x', .function = Function::nothing, .take = fine_stop},
    {.number = 602, .group = 'x', .function = Function::nothing, .take = coarse_stop},
    {.number = 603, .group = 'x', .function = Function::later},
};

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
    {30, true, MAction::end_rewind},
};

constexpr double kCoordinate = 99999.999;

constexpr std::array<LetterRule, 128> letters() {
  std::array<LetterRule, 128> rules{};
  const auto at = [&](char c) -> LetterRule& { return rules[static_cast<std::size_t>(c)]; };
  for (const char c : {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'})
    at(c) = {.meaning = Meaning::axis, .min = -kCoordinate, .max = kCoordinate};
  at('N') = {.meaning = Meaning::number, .max = 99999999};
  at(':') = at('N');
  at('G') = {.meaning = Meaning::g, .max = 999};
  at('M') = {.meaning = Meaning::m, .max = 9999};
  at('H') = {.meaning = Meaning::h, .max = 9999};
  for (const char c : {'I', 'J', 'K'})
    at(c) = {.meaning = Meaning::centre_of,
             .min = -kCoordinate,
             .max = kCoordinate,
             .axis = static_cast<char>('X' + c - 'I')};
  at('P') = {.meaning = Meaning::count, .min = 1, .max = 9999};
  at('F') = {.meaning = Meaning::feed, .max = 999999.999};
  at('S') = {.meaning = Meaning::speed, .max = 99999.999};
  at('T') = {.meaning = Meaning::tool, .max = 32000};
  at('D') = {.meaning = Meaning::corrector, .max = 9};
  at('R') = {.meaning = Meaning::statement, .rule = &kAssignR};
  at('L') = {.meaning = Meaning::statement, .rule = &kCallByNumber};
  at('$') = {.meaning = Meaning::statement, .rule = &kSystemVariable};
  return rules;
}

/// G291 among the words of power-on: programs begin in the ISO dialect.
const Dialect& begins(const MachineModel& machine) {
  const auto& words = machine.power_on;
  return std::find(words.begin(), words.end(), "G291") == words.end() ? dialect() : iso::dialect(machine);
}

const Dialect kDialect = {
    .name = "sinumerik-808d",
    .lexis = {.skip_levels = true,
              .label = LabelForm::colon,
              .tape = '%',
              .bracket = Bracket::argument,
              .named_words = true},
    .terms =
        {.prefix = "/ N LABEL:", .prefix_russian = "/ N МЕТКА:", .repeat = {}, .repeat_end = {}, .field = {}},
    .expressions = expressions(),
    .parameters = parameters(),
    .arc_centre = ArcCentre::from_start_any,
    .centre_as_diameter = false,
    .end_returns = true,
    .origins_exist = true,
    .subprogram_end_ends = true,
    .max_block_characters = 512,
    .max_label_characters = 32,
    .max_block_number_digits = 8,
    .max_m_words = 5,
    .max_repeat_depth = 0,
    .max_call_depth = 8,
    .virtual_axes = "uvw",
    .letters = letters(),
    .g = kG,
    .m = kM,
    .words = words(),
    .variables = iso::settings(),
    .conflict = [](int, int) { return false; },
    .value = value_in_place_of_number,
    .judge = judge,
    .system = iso::system_value,
    .corrector = [](int tool, int number) { return 10 * tool + number; },
    .begins = begins,
    .speaks = iso::speaks,
};

}  // namespace

const Dialect& dialect() { return kDialect; }

}  // namespace servogate::program::sinumerik
