// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Texts of what is wrong with a pendant, in its device file and in the machine file.
namespace servogate::machine::finding {

inline constexpr text::Entry kNoPendantTable{"machine.pendant_no_table",
                                             "a pendant needs the table [pendant] with its reports",
                                             "пульту нужна таблица [pendant] с его отчётами"};
inline constexpr text::Entry kPendantText{"machine.pendant_text", "`{0}`: \"{1}\" has not the form {2}",
                                          "`{0}`: «{1}» не имеет вида {2}"};
inline constexpr text::Entry kPendantPlace{"machine.pendant_place",
                                           "`{0}`: byte {1} is behind the end of a report of {2} bytes",
                                           "`{0}`: байт {1} — за концом отчёта из {2} байтов"};
inline constexpr text::Entry kPendantMany{"machine.pendant_many",
                                          "a pendant has at most {0} buttons and {1} axes",
                                          "у пульта не более {0} кнопок и {1} осей"};
inline constexpr text::Entry kPendantBit{
    "machine.pendant_bit", "button \"{0}\": {1} is no code of it; bits are 0 to 15, key codes 1 to 255",
    "кнопка «{0}»: {1} не может быть её кодом; биты — от 0 до 15, коды клавиш — от 1 до 255"};
inline constexpr text::Entry kPendantRow{"machine.pendant_row",
                                         "the display shows a row behind the {0} axes of `axes`",
                                         "дисплей показывает строку за {0} осями из `axes`"};
inline constexpr text::Entry kPendantTwice{
    "machine.pendant_twice", "two pendants are called \"{0}\"; messages could not tell them apart",
    "два пульта названы «{0}»; в сообщениях их не различить"};
inline constexpr text::Entry kPendantUrl{
    "machine.pendant_url", "`url`: \"{0}\" is none of mock:NAME, hid:any, hid:SERIAL, hid:/dev/hidraw0",
    "`url`: «{0}» — не mock:ИМЯ, hid:any, hid:СЕРИЙНЫЙ_НОМЕР, hid:/dev/hidraw0"};
inline constexpr text::Entry kPendantAxis{"machine.pendant_axis",
                                          "pendant \"{0}\": {1} is no axis that programs move; there are {2}",
                                          "пульт «{0}»: {1} — не ось, которой движут программы; есть {2}"};
inline constexpr text::Entry kPendantButton{"machine.pendant_button",
                                            "`dead_man`: \"{0}\" has no button \"{1}\"; it has {2}",
                                            "`dead_man`: у «{0}» нет кнопки «{1}»; есть {2}"};
inline constexpr text::Entry kPendantNobody{
    "machine.pendant_nobody",
    "pendant \"{0}\" selects {1}, but may move none of these axes of the machine: {2}",
    "пульт «{0}» выбирает {1}, но ни одну из этих осей станка двигать не может: {2}"};

}  // namespace servogate::machine::finding
