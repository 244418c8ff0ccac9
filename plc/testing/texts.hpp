// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Sentences of the test form.
namespace servogate::plc::testing::texts {

using text::Entry;

inline constexpr Entry kUnknownWord{"plc-test-word", "'{0}' is no word of a test{1}",
                                    "«{0}» не относится к словам теста{1}"};
inline constexpr Entry kOutside{"plc-test-outside", "'{0}' stands before the first 'test' or 'before'",
                                "«{0}» стоит до первого «test» или «before»"};
inline constexpr Entry kExpected{"plc-test-expected", "expected {0}", "ожидается {0}"};
inline constexpr Entry kTooMuch{"plc-test-too-much", "'{0}' is too much here", "«{0}» здесь лишнее"};
inline constexpr Entry kNoName{"plc-test-name", "a test needs a name", "тесту нужно имя"};
inline constexpr Entry kNoTest{"plc-test-none", "there is no test in this file",
                               "в этом файле нет ни одного теста"};
inline constexpr Entry kTime{"plc-test-time", "'{0}' is no time such as 200ms or 1.5s (at most 24h)",
                             "«{0}» не время вида 200ms или 1.5s (не больше 24h)"};
inline constexpr Entry kScans{"plc-test-scans", "{0} scans are not possible: 1 to {1}",
                              "число циклов {0} невозможно: от 1 до {1}"};
inline constexpr Entry kTolerance{"plc-test-tolerance",
                                  "'+-' stands behind 'NAME = VALUE' and before a number",
                                  "«+-» ставится после «ИМЯ = ЗНАЧЕНИЕ» и перед числом"};
inline constexpr Entry kNoVariable{"plc-test-variable", "there is no variable '{0}'{1}",
                                   "переменной «{0}» нет{1}"};
inline constexpr Entry kNoValue{"plc-test-value", "'{0}' is no value for '{1}' of type {2}",
                                "«{0}» не является значением для «{1}» типа {2}"};
inline constexpr Entry kNotBool{"plc-test-bool", "'{0}' is {1}; a value is needed to compare it with",
                                "«{0}» имеет тип {1}; нужно значение для сравнения"};
inline constexpr Entry kNotOrdered{"plc-test-order", "{0} can only be compared by = and <>",
                                   "{0} сравнивается только знаками = и <>"};
inline constexpr Entry kCannotHold{"plc-test-hold", "'{0}' cannot be held: the program does not use it",
                                   "«{0}» нельзя удерживать: программа её не использует"};
inline constexpr Entry kFailed{"plc-test-failed", "expected {0}, got {1} (scan {2}, after {3})",
                               "ожидалось {0}, получено {1} (цикл {2}, прошло {3})"};
inline constexpr Entry kTimedOut{"plc-test-until", "expected {0} within {4}, got {1} (scan {2}, after {3})",
                                 "ожидалось {0} за {4}, получено {1} (цикл {2}, прошло {3})"};
inline constexpr Entry kNoFault{"plc-test-no-fault",
                                "expected a fault of the PLC, got none (scan {0}, after {1})",
                                "ожидался сбой ПЛК, его нет (цикл {0}, прошло {1})"};
inline constexpr Entry kFaulted{"plc-test-fault", "the PLC stopped here: {0} (scan {1}, after {2})",
                                "здесь ПЛК остановился: {0} (цикл {1}, прошло {2})"};

}  // namespace servogate::plc::testing::texts
