// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/nc110.hpp"

#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/codes/own_form.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"
#include "kernel/program/languages/nc110/profile/profile_words.hpp"
#include "kernel/program/languages/nc110/values/expressions.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

namespace servogate::program::nc110 {
namespace {

/// Tables 2.2 (G words and groups) and 2.5; power-on states as printed, a machine file says its own.
constexpr GRule kG[] = {
    {0, 'a', Function::rapid, true},
    {1, 'a', Function::line},
    {2, 'a', Function::arc_cw},
    {3, 'a', Function::arc_ccw},
    {4, 'i', Function::dwell},
    {6, 'a', Function::spline},
    {9, 'i', Function::exact_once},
    {17, 'b', Function::plane_12, true},
    {18, 'b', Function::plane_31},
    {19, 'b', Function::plane_23},
    {20, 'd', Function::profile_off, true},
    {21, 'd', Function::profile_on},
    {27, 'c', Function::corner_limited, true},
    {28, 'c', Function::continuous},
    {29, 'c', Function::exact},
    {33, 'a', Function::thread},
    {34, 'a', Function::thread},
    {35, 'n', Function::spindle_mark},
    {40, 'e', Function::compensation_off, true},
    {41, 'e', Function::compensation_left},
    {42, 'e', Function::compensation_right},
    {70, 'f', Function::inch},
    {71, 'f', Function::metric, true},
    {.number = 72, .group = 'j', .function = Function::own, .motion = probe_point},
    {.number = 73, .group = 'j', .function = Function::own, .motion = probe_hole},
    {.number = 74, .group = 'j', .function = Function::own, .motion = probe_deviation},
    {79, 'k', Function::machine_zero},
    {80, 'g', Function::cycle_off, true},
    {81, 'g', Function::cycle},
    {82, 'g', Function::cycle},
    {83, 'g', Function::cycle},
    {84, 'g', Function::cycle},
    {85, 'g', Function::cycle},
    {86, 'g', Function::cycle},
    {89, 'g', Function::cycle},
    {90, 'h', Function::absolute, true},
    {91, 'h', Function::incremental},
    {93, 'l', Function::feed_inverse},
    {94, 'l', Function::feed_minute},
    {95, 'l', Function::feed_revolution, true},
    {96, 'm', Function::surface_speed, true},
    {97, 'm', Function::revolutions},
};

/// Table 2.3: class of each M function and what the control itself does.
constexpr MRule kM[] = {
    {0, true, MAction::stop},
    {1, true, MAction::optional_stop},
    {2, true, MAction::end},
    {3, false, MAction::spindle_cw},
    {4, false, MAction::spindle_ccw},
    {5, true, MAction::spindle_stop},
    {6, true, MAction::tool_change},
    {7, false},
    {8, false},
    {9, true},
    {10, false, MAction::none, true},
    {11, false},
    {12, false, MAction::none, true},
    {13, false, MAction::spindle_cw},
    {14, false, MAction::spindle_ccw},
    {19, false, MAction::spindle_orient},
    {30, true, MAction::end_rewind},
    {40, true},
    {41, false},
    {42, false},
    {43, false},
    {44, false},
    {45, false},
    {60, true},
};

constexpr CodeRule kCodes[] = {
    {"RPT", "n", code::rpt},
    {"ERP", "", code::erp},
    {"CLS", "f", code::cls},
    {"EPP", "ll", code::epp},
    {"BNC", "l", code::bnc},
    {"BGT", "ccl", code::branch},
    {"BLT", "ccl", code::branch},
    {"BEQ", "ccl", code::branch},
    {"BNE", "ccl", code::branch},
    {"BGE", "ccl", code::branch},
    {"BLE", "ccl", code::branch},
    {"UAO", "n?a*", code::uao, false},
    {"UOT", "nv+", code::uot, false},
    {"UIO", "v+", code::uio, false},
    {"MIR", "?a*", code::mir, false},
    {"URT", "x", code::urt, false},
    {"SCF", "?xa*", code::scf, false},
    {"RQO", "nv+", code::rqo, false},
    {"DPI", "aa", code::dpi, false},
    {"DLO", "p+", code::dlo, false},
    {"DIS", "i+", code::dis},
    {"DLY", "x", code::dly},
    {"WAI", "w", code::wai, false},
    {"DSA", "npp", code::dsa, false},
    {"ASC", "n", code::asc, false},
    {"DSC", "n", code::dsc, false},
    {"RQU", "nnk+", code::rqu, false},
    {"RQP", "nnk+", code::rqp, false},
    {"DPT", "xxx", code::dpt},
    {"BSP", "aan", code::bsp, false},
    {"ESP", "", code::esp},
    {"UCG", "npp?.*", code::graphics},
    {"CLG", "", code::graphics},
    {"DCG", "", code::graphics},
    {"EXE", "n.", code::exe, false},
    {"REL", "", code::rel, false},
    {"SND", "n", code::snd, false},
    {"TOF", "n", code::tof},
    {"DTL", "v+", code::dtl, false},
    {"UAV", "n?.*", code::uav, false},
    {"CTL", "?.", code::ctl, false},
    {"OPN", "n.?.", code::record_file, false},
    {"DER", "n.+", code::der, false},
    {"RED", "nn?n", code::record_file, false},
    {"WRT", "nn?n", code::record_file, false},
    {"CLO", "?n", code::record_file, false},
    {"CRE", "n.n", code::record_file, false},
    {"CAN", ".", code::record_file, false},
    {"INP", "?.*", code::keyboard},
    {"SCR", "?.*", code::screen},
    {"DEF", "?.*", code::screen},
    {"OUT", "?.*", code::screen},
};

constexpr VariableRule kVariables[] = {
    {"TMR", variable::tmr},
    {"UOV", variable::uov},
    {"ERF", variable::erf},
    {"MCD", variable::mcd},
    {"USB", variable::usb},
    {"USO", variable::uso},
    {"UVR", variable::uvr},
    {"TIM", variable::tim, true},
    {"TOT", variable::tot, true},
    {"RMS", variable::rms},
    {"RTA", variable::rta},
    {"RTO", variable::rto},
    {"UGF", variable::ugf},
    {"RMN", variable::rmn, true},
    {"ERR", variable::err},
    {"DAW", variable::daw, true},
    // Variables of the language that this version does not execute.
    {"JOG", nullptr},
    {"URL", nullptr},
    {"UCV", nullptr},
    {"RAP", nullptr},
    {"UAS", nullptr},
    {"UEP", nullptr},
    {"VOL", nullptr},
    {"MBR", nullptr},
};

constexpr double kCoordinate = 99999.9999;

constexpr WordRule kElement = {
    .name = "p, l, c", .when = When::for_motion, .read = read_element, .motion = element};
constexpr WordRule kCorner = {
    .name = "r, b", .when = When::for_motion, .read = read_corner, .motion = corner};
constexpr WordRule kResult = {.name = "E", .meaning = Meaning::amount, .read = read_result};
constexpr WordRule kTool = {.name = "T", .meaning = Meaning::tool, .read = read_tool};

constexpr std::array<LetterRule, 128> letters() {
  std::array<LetterRule, 128> rules{};
  const auto at = [&](char c) -> LetterRule& { return rules[static_cast<std::size_t>(c)]; };
  for (const char c : {'A', 'B', 'C', 'D', 'P', 'Q', 'U', 'V', 'W', 'X', 'Y', 'Z'})
    at(c) = {Meaning::axis, ParameterKind::real, -kCoordinate, kCoordinate};
  at('N') = {Meaning::number, ParameterKind::none, 0, 9999};
  at('G') = {Meaning::g, ParameterKind::whole, 0, 99};
  at('M') = {Meaning::m, ParameterKind::whole, 0, 99};
  at('H') = {Meaning::h, ParameterKind::whole, 0, 99};
  at('I') = {Meaning::centre_1, ParameterKind::real, -kCoordinate, kCoordinate};
  at('J') = {Meaning::centre_2, ParameterKind::real, -kCoordinate, kCoordinate};
  at('K') = {Meaning::pitch, ParameterKind::real, -kCoordinate, kCoordinate};
  at('R') = {Meaning::radius, ParameterKind::real, -kCoordinate, kCoordinate, true};
  at('F') = {Meaning::feed, ParameterKind::real, 0.01, 99999.99};
  at('t') = {Meaning::block_time, ParameterKind::real, 0.001, 99999.999};
  at('S') = {Meaning::speed, ParameterKind::any, 0, 99999.99};
  at('T') = {.meaning = Meaning::tool, .parameters = ParameterKind::whole, .max = 9999, .rule = &kTool};
  at('u') = {Meaning::factor_1, ParameterKind::real, -kCoordinate, kCoordinate};
  at('v') = {Meaning::factor_2, ParameterKind::real, -kCoordinate, kCoordinate};
  at('w') = {Meaning::factor_3, ParameterKind::real, -kCoordinate, kCoordinate};
  for (const char c : {'p', 'l', 'c', '-'}) at(c) = {.meaning = Meaning::statement, .rule = &kElement};
  at('E') = {.meaning = Meaning::amount, .max = 9999, .rule = &kResult};
  for (const char c : {'r', 'b'}) at(c) = {.meaning = Meaning::statement, .rule = &kCorner};
  return rules;
}

const Dialect kDialect = {
    .name = "nc110",
    .lexis = {.label = LabelForm::quoted,
              .request_sync = '#',
              .cancel_sync = '&',
              .tape = '%',
              .bracket = Bracket::own_form,
              .equals_is_own_form = true,
              .bare_is_zero = true,
              .g_first = true,
              .comment_behind_words = false},
    .terms = {.prefix = "/ \"LABEL\" N # or &",
              .prefix_russian = "/ \"МЕТКА\" N # или &",
              .repeat = "RPT",
              .repeat_end = "ERP",
              .field = "DLO"},
    .expressions = expressions(),
    .parameters = parameters(),
    .max_block_characters = 128,
    .max_label_characters = 6,
    .max_block_number_digits = 4,
    .max_m_words = 4,
    .max_repeat_depth = 3,
    .max_call_depth = 2,
    .virtual_axes = "UVW",
    .index_variable = "INDEX_",
    .sign_is_direction = true,
    .letters = letters(),
    .g = kG,
    .m = kM,
    .variables = kVariables,
    .conflict = conflict,
    .value = parameter_for_number,
    .mark = mark,
    .own_form = own_form,
    .own_form_waits = own_form_waits,
    .judge = judge,
    .profile = profile,
    .cycle = cycle,
    .dwell = dwell,
    .corner_word = corner_word,
    .across = across,
    .spline = spline,
    .thread = thread,
    .system = own_value,
};

}  // namespace

const Dialect& dialect() { return kDialect; }

std::span<const CodeRule> codes() { return kCodes; }

}  // namespace servogate::program::nc110
