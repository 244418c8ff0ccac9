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

inline constexpr text::Entry kPendantSame{
    "machine.pendant_same",
    "pendants \"{0}\" and \"{1}\" may be the same device: each count would be jogged twice. Tell them apart "
    "by "
    "hid:SERIAL",
    "пульты «{0}» и «{1}» могут быть одним устройством: каждый импульс двигал бы дважды. Различите их через "
    "hid:СЕРИЙНЫЙ_НОМЕР"};
inline constexpr text::Entry kPendantDeadManActs{
    "machine.pendant_dead_man_acts",
    "`dead_man`: button \"{0}\" means `{1}`, too, which gripping it would ask for. Take the meaning away: "
    "buttons = [\"{0}: nothing\"]",
    "`dead_man`: кнопка «{0}» означает ещё и `{1}`, и нажатие вызывало бы это. Уберите назначение: "
    "buttons = [\"{0}: nothing\"]"};
inline constexpr text::Entry kPendantDeadManLoss{
    "machine.pendant_dead_man_loss",
    "`dead_man_point`: \"{0}\" would stay TRUE while its station is lost. It needs `loss = 0`, and no `hold`",
    "`dead_man_point`: «{0}» оставался бы TRUE при потере станции. Нужны `loss = 0` и отсутствие `hold`"};
inline constexpr text::Entry kPendantProcesses{
    "machine.pendant_processes",
    "pendant \"{0}\" may move axes of several processes, so its start, hold and blocks would be those of "
    "process "
    "{1} only: name the axes of one process in `axes`",
    "пульт «{0}» двигает оси нескольких процессов, а его пуск, пауза и кадры относились бы только к процессу "
    "{1}: назовите в `axes` оси одного процесса"};
inline constexpr text::Entry kPendantTwiceHere{
    "machine.pendant_twice_here", "`{0}`: \"{1}\" stands there twice", "`{0}`: «{1}» встречается дважды"};
inline constexpr text::Entry kPendantShared{"machine.pendant_shared", "`{0}` and `{1}` are the same byte {2}",
                                            "`{0}` и `{1}` — один и тот же байт {2}"};
inline constexpr text::Entry kPendantLacks{"machine.pendant_lacks", "`{0}` is of no effect without `{1}`",
                                           "`{0}` не действует без `{1}`"};
inline constexpr text::Entry kPendantRing{
    "machine.pendant_ring", "`ring_from` is {0}, but the ring counts to {1} (`ring_range`) only",
    "`ring_from` равно {0}, но кольцо считает лишь до {1} (`ring_range`)"};

inline constexpr text::Entry kPathWheelSource{
    "machine.path_wheel_source",
    "`source`: \"{0}\" is none of handwheel1, handwheel2 and the pendants of the machine ({1})",
    "`source`: «{0}» — не handwheel1, не handwheel2 и не пульт станка ({1})"};
inline constexpr text::Entry kPathWheelProcess{"machine.path_wheel_process",
                                               "`process`: {0} is beyond the {1} processes of the machine",
                                               "`process`: {0} больше числа процессов станка ({1})"};
inline constexpr text::Entry kPathWheelTwice{
    "machine.path_wheel_twice", "process {0} has two handwheels for its path; it can follow one",
    "у процесса {0} два маховичка движения по контуру; он может следовать одному"};
inline constexpr text::Entry kPathWheelShared{
    "machine.path_wheel_shared", "\"{0}\" would drive two processes at once: give each its own wheel",
    "«{0}» вёл бы сразу два процесса: дайте каждому свой маховичок"};
inline constexpr text::Entry kPathWheelNone{"machine.path_wheel_none",
                                            "pendant \"{0}\" has no wheel (its device file: `wheel`)",
                                            "у пульта «{0}» нет маховичка (файл устройства: `wheel`)"};
inline constexpr text::Entry kPathWheelHealthy{
    "machine.path_wheel_healthy",
    "`healthy` is of no effect: the control itself knows whether pendant \"{0}\" is plugged in",
    "`healthy` не действует: подключён ли пульт «{0}», управление знает само"};
inline constexpr text::Entry kPathWheelLoss{
    "machine.path_wheel_loss",
    "`healthy`: \"{0}\" would stay TRUE while its station is lost. It needs `loss = 0`, and no `hold`",
    "`healthy`: «{0}» оставался бы TRUE при потере станции. Нужны `loss = 0` и отсутствие `hold`"};
inline constexpr text::Entry kPathWheelButton{
    "machine.path_wheel_button",
    "`buttons`: `path_wheel` chooses the wheel of this pendant, and no [[path_wheel]] has source = \"{0}\"",
    "`buttons`: `path_wheel` выбирает маховичок этого пульта, но ни в одной [[path_wheel]] нет source = "
    "«{0}»"};

}  // namespace servogate::machine::finding
