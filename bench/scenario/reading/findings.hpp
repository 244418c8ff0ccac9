// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What can be wrong with a scenario file.
namespace servogate::scenario::finding {

inline constexpr text::Entry kSchema{"scenario.schema", "schema {0} is not known here: it is 1",
                                     "schema {0} здесь не известна: это 1"};
inline constexpr text::Entry kNotTime{"scenario.not_time",
                                      "`{0}`: \"{1}\" is no time; expected a form like \"200 ms\" or \"3 s\"",
                                      "«{0}»: «{1}» не время; ожидался вид \"200 ms\" или \"3 s\""};
inline constexpr text::Entry kOneOf{"scenario.one_of", "{0} has {1}: exactly one of them is expected",
                                    "{0}: есть {1}; должно быть ровно одно из них"};
inline constexpr text::Entry kNoneOf{"scenario.none_of", "{0} has none of {1}", "{0}: нет ничего из {1}"};
inline constexpr text::Entry kNoParameter{"scenario.no_parameter",
                                          "\"${0}\" is no parameter of this case; it has {1}",
                                          "«${0}» не параметр этого варианта; в нём есть {1}"};
inline constexpr text::Entry kUnknownFault{"scenario.unknown_fault",
                                           "there is no fault \"{0}\"; there are {1}",
                                           "неисправности «{0}» нет; есть {1}"};
inline constexpr text::Entry kNoFaultParameter{"scenario.fault_parameter", "the fault \"{0}\" takes no `{1}`",
                                               "неисправность «{0}» не принимает `{1}`"};
inline constexpr text::Entry kFaultValue{"scenario.fault_value", "`{0}` of a fault is {1}, not \"{2}\"",
                                         "`{0}` неисправности: {1}, а не «{2}»"};
inline constexpr text::Entry kNeedsTime{"scenario.needs_time",
                                        "`never` stands with `always` or `until`: over which time?",
                                        "`never` пишется с `always` или `until`: в течение какого времени?"};
inline constexpr text::Entry kNotRange{"scenario.not_range", "`{0}` is a list of two: [smallest, largest]",
                                       "`{0}` — список из двух: [наименьшее, наибольшее]"};
inline constexpr text::Entry kBelongs{"scenario.belongs", "`{0}` belongs to `{1}`",
                                      "`{0}` относится к `{1}`"};
inline constexpr text::Entry kInclude{"scenario.include", "\"{0}\" cannot be read: {1}",
                                      "«{0}» не читается: {1}"};
inline constexpr text::Entry kDeepInclude{"scenario.deep_include",
                                          "files include one another more than {0} deep",
                                          "файлы включают друг друга глубже {0}"};
inline constexpr text::Entry kNoSteps{"scenario.no_steps", "it has no [[step]]: nothing would be tested",
                                      "нет ни одного [[step]]: проверять нечего"};
inline constexpr text::Entry kNoExpectation{"scenario.no_expectation",
                                            "no step expects anything: it could not fail",
                                            "ни один шаг ничего не ожидает: сценарий не может не пройти"};
inline constexpr text::Entry kSameName{"scenario.same_name", "two scenarios of this file are called \"{0}\"",
                                       "два сценария этого файла называются «{0}»"};
inline constexpr text::Entry kUnknownWord{"scenario.unknown_word", "`do` knows no word \"{0}\"; it knows {1}",
                                          "`do` не знает слова «{0}»; известны {1}"};
inline constexpr text::Entry kUnknownSignal{
    "scenario.unknown_signal",
    "\"{0}\" is no signal of this machine: no point, symbol, place, PLC variable, nor a quantity of an axis, "
    "spindle or process",
    "«{0}» не сигнал этого станка: не точка, не символ, не место, не переменная ПЛК и не величина оси, "
    "шпинделя или процесса"};
inline constexpr text::Entry kNotOfSignal{"scenario.not_of_signal",
                                          "{0} is {1}; \"{2}\" is nothing of the kind",
                                          "{0}: {1}; «{2}» к этому не подходит"};
inline constexpr text::Entry kUnknownAxis{"scenario.unknown_axis",
                                          "the machine has no axis \"{0}\"; it has {1}",
                                          "у станка нет оси «{0}»; есть {1}"};
inline constexpr text::Entry kReference{"scenario.reference", "\"{0}\": {1}", "«{0}»: {1}"};
inline constexpr text::Entry kImpossible{"scenario.impossible", "{0}", "{0}"};

}  // namespace servogate::scenario::finding
