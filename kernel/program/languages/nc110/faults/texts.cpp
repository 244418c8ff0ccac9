// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/faults/texts.hpp"

#include <iterator>

namespace servogate::program::nc110 {
namespace {

constexpr text::Entry kMessages[] = {
    {"P111", "{0} after the closing bracket: a three-letter code stands alone in its block",
     "{0} после закрывающей скобки: трёхбуквенный код стоит в кадре один"},
    {"P401", "{0} is no place: SA, SK or SYVAR, an index, and .BL .BY .IN .LI .RE .LR or .nCH",
     "{0} не место памяти: SA, SK или SYVAR, номер и .BL .BY .IN .LI .RE .LR или .nCH"},
    {"P405", "{0} takes a number, not a text", "{0} принимает число, а не текст"},
    {"P406", "{0} takes a text in quotes", "{0} принимает текст в кавычках"},
    {"P408", "a text can be compared with a text only", "текст сравнивается только с текстом"},
    {"P505", "RPT {0}: the count must be a whole number from 0 to {1}",
     "RPT {0}: число повторов — целое от 0 до {1}"},
    {"P508", "{0} is no program name: at most {1} capitals and digits, a letter first",
     "{0} не имя программы: не более {1} прописных букв и цифр, первая — буква"},
    {"P510", "EPP while another EPP runs", "EPP во время выполнения другого EPP"},
    {"P511", "EPP: the label {0} stands after {1}", "EPP: метка {0} стоит после {1}"},
    {"P512", "the jump to {0} leaves the part that EPP runs",
     "переход на {0} выводит из участка, который выполняет EPP"},
    {"P601", "the language has no three-letter code {0}{1}", "в языке нет трёхбуквенного кода {0}{1}"},
    {"P602", "{0}: operand {1} is missing ({2})", "{0}: нет операнда {1} ({2})"},
    {"P603", "{0}: an operand too many", "{0}: лишний операнд"},
    {"P604", "{0}: the letter of an axis is expected", "{0}: ожидается буква оси"},
    {"P605", "{0}: the axis {1} stands twice", "{0}: ось {1} названа дважды"},
    {"P606", "{0}: {1} axes, at most {2} are allowed", "{0}: осей {1}, допускается не более {2}"},
    {"P608", "the text has {0} characters, at most {1} are shown",
     "в тексте {0} символов, показывается не более {1}"},
    {"P611", "{0}: the origin must be a whole number from 0 to {1}, not {2}",
     "{0}: номер начала — целое от 0 до {1}, а не {2}"},
    {"P616", "{0} inside of a continuous profile: end it with G00 or G29 first",
     "{0} внутри непрерывного профиля: сначала завершите его G00 или G29"},
    {"P621", "{0}: a dwell of {1} s is outside of 0 to {2} s",
     "{0}: выдержка {1} с вне пределов от 0 до {2} с"},
    {"P622", "WAI needs a place of SA, SK or SYVAR, one of = > < # and a value",
     "WAI требует место SA, SK или SYVAR, один из знаков = > < # и значение"},
    {"P623", "WAI takes places of the formats BL, BY and IN, not {0}",
     "WAI принимает места форматов BL, BY и IN, а не {0}"},
    {"P624", "a bit can only be waited for with =", "бит можно ждать только со знаком ="},
    {"P626", "DLO needs two values for an axis", "DLO требует двух значений для оси"},
    {"P719", "G{0} while the cycle {1} is active: end it with G80 first",
     "G{0} при активном цикле {1}: сначала завершите его G80"},
    {"P720", "{0} in the block that defines a cycle: only the axis of the cycle stands there",
     "{0} в кадре задания цикла: там стоит только ось цикла"},
    {"P721", "G{0} needs the depth of one axis", "G{0} требует глубины по одной оси"},
    {"P722", "{0} without a place: a hole needs another axis than that of the cycle",
     "{0} без места: для отверстия нужна ось, кроме оси цикла"},
    {"P723", "G83 needs I, the first step", "G83 требует I — первого шага"},
    {"P801",
     "{0} in a motion block of a continuous profile (G27, G28): put it into a G00 block or a block of its "
     "own",
     "{0} в кадре движения непрерывного профиля (G27, G28): поставьте в кадр G00 или в отдельный кадр"},
    {"P804", "{0} is no tool: T, the number, a point and the number of the corrector",
     "{0} не инструмент: T, номер, точка и номер корректора"},
    {"P806", "TMR counts revolutions with G95, but no spindle speed is programmed",
     "TMR при G95 считается в оборотах, но скорость шпинделя не задана"},
    {"P807", "TMR counts revolutions with G95, G96 gives no fixed speed",
     "TMR при G95 считается в оборотах, G96 не даёт постоянной скорости"},
    {"P816", "{0} dwells for TMR, and TMR is 0: there is no dwell",
     "{0} выдерживает время TMR, а TMR равно 0: выдержки не будет"},
};
static_assert(std::size(kMessages) == static_cast<std::size_t>(Wrong::dwell_zero) + 1);

}  // namespace

std::span<const text::Entry> messages() { return kMessages; }

const text::Entry& entry(Wrong wrong) { return kMessages[static_cast<std::size_t>(wrong)]; }

}  // namespace servogate::program::nc110
