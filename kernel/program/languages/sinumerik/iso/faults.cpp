// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/sinumerik/iso/faults.hpp"

#include <iterator>

namespace servogate::program::sinumerik::iso {
namespace {

constexpr text::Entry kMessages[] = {
    {"P840, 14800", "F{0}: a path needs a feed above 0", "F{0}: для пути нужна подача больше 0"},
    {"P841", "{0} needs the word {1} in its block", "{0} требует в кадре слова {1}"},
    {"P842", "{0}: {1} is {2}; it is {3}", "{0}: {1} равно {2}; допускается {3}"},
    {"P843", "P{0}: a program number has at most {1} digits", "P{0}: в номере программы не больше {1} цифр"},
    {"P844, 12722", "{0} and {1}: one macro or subprogram call stands in a block",
     "{0} и {1}: в кадре стоит один вызов макроса или подпрограммы"},
    {"P845", "{0} stands alone in its block", "{0} стоит в кадре один"},
    {"P846, 61816", "{0} is at {1}, its reference position is {2}",
     "{0} находится на {1}, её референтная точка — {2}"},
    {"P847", "{0} P{1}: there are the reference positions 2 to 4",
     "{0} P{1}: есть референтные точки от 2 до 4"},
    {"P848", "{0} while scaling or mirroring is in force: end it first (G50, G50.1)",
     "{0} при действующем масштабе или зеркале: сначала отмените их (G50, G50.1)"},
    {"P849", "{0} takes one time, X or P", "{0} принимает одно время, X или P"},
    {"P850", "{0} counts revolutions, and the spindle has no speed in rpm: write S before it",
     "{0} считает обороты, а у шпинделя нет скорости в об/мин: задайте перед этим S"},
    {"P851, 12726", "{0}: {1} and its parallel axis {2} cannot both be in the plane",
     "{0}: {1} и параллельная ей {2} не могут обе быть в плоскости"},
    {"P852, 12560", "{0}: the vector of I, J and K has no length", "{0}: вектор I, J, K нулевой"},
    {"P853", "the offset {0} is not in the tool table: create it first",
     "корректора {0} нет в таблице инструмента: сначала создайте его"},
    {"P854", "{0} P{1}: there are the offsets {2}", "{0} P{1}: есть смещения {2}"},
    {"P855", "{0}: no block N{1} stands in this program", "{0}: в этой программе нет кадра N{1}"},
    {"P856", "{0}: the block N{1} stands behind N{2}", "{0}: кадр N{1} стоит за N{2}"},
    {"P857", "{0}: {1} does not stand in a contour", "{0}: {1} не стоит в контуре"},
    {"P858", "{0}: the last motion of a contour has no chamfer or rounding",
     "{0}: последнее перемещение контура — без фаски и скругления"},
    {"P859", "{0}: the contour turns back along {1}", "{0}: контур поворачивает назад по {1}"},
    {"P860", "{0}: the thread has no run-out: set ZSFI26 above 0",
     "{0}: у резьбы нет сбега: задайте ZSFI26 больше 0"},
    {"P861", "{0}: the step of {1} does not lead to the end", "{0}: шаг {1} не ведёт к концу"},
    {"P862", "{0}: more than {1} passes", "{0}: больше {1} проходов"},
    {"P863", "{0}: a thread has its lead as F, above 0", "{0}: шаг резьбы задаётся словом F больше 0"},
    {"P864", "{0}: the lead falls to 0 before the end; K is above {1}",
     "{0}: шаг падает до 0 раньше конца; K больше {1}"},
    {"P865", "a chamfer or rounding stands between two motions in the plane",
     "фаска или скругление стоит между двумя перемещениями в плоскости"},
    {"P866", "under the angle {0} the line does not meet its end",
     "под углом {0} прямая не приходит к концу"},
    {"P867", "{0} is a word of the Siemens mode: write G290 in a block before it",
     "{0} — слово режима Siemens: задайте G290 в кадре перед ним"},
    {"P868", "{0} while {1} is active: end the radius compensation with G40 first",
     "{0} при действующей {1}: сначала завершите коррекцию радиуса G40"},
    {"P869", "{0} needs an axis in its block", "{0} требует оси в кадре"},
    {"P870", "{0}: {1} does not stand beside it", "{0}: рядом не стоит {1}"},
    {"P871", "{0}: the end of the cut is missing: write {1}", "{0}: нет конца реза: задайте {1}"},
    {"P872", "{0}: at most {1} of the words {2}", "{0}: слов {2} не больше {1}"},
    {"P873", "{0} = {1}: this version has {2} alone", "{0} = {1}: в этой версии есть только {2}"},
    {"P874, 14011", "{0} has no contour in a typed block", "{0}: во введённом кадре контура нет"},
    {"P875", "the program ends with its alarm {0}", "программа завершается своим сообщением {0}"},
    {"P876",
     "a circle outside of the selected plane does not go with {0}: select its plane with G17, G18 or G19",
     "окружность вне выбранной плоскости не сочетается с {0}: выберите её плоскость через G17, G18 или G19"},
    {"P877", "{0}: the axis {1} has no floating reference position: set FLOATING_{1} in the machine file",
     "{0}: у оси {1} нет плавающей референтной точки: задайте FLOATING_{1} в файле станка"},
    {"P878",
     "{0}: none of its axes has an overrun: set OVERRUN_ with the letter of an axis in the machine file",
     "{0}: ни у одной из осей нет перебега: задайте в файле станка OVERRUN_ с буквой оси"},
    {"P879", "{0} needs the angle R of its rotation; there is no second turret that it could switch to",
     "{0} требует угла поворота R; второй револьверной головки, на которую можно переключить, нет"},
    {"P880", "{0}: an expression in place of a number needs bit 3 of MD20734 in the machine file",
     "{0}: для выражения вместо числа в файле станка нужен бит 3 в MD20734"},
    {"P881", "{0}: {1} does not take the place of {2} in this version",
     "{0}: в этой версии {1} не занимает место {2}"},
    {"P882",
     "{0}: this version has the variables of macros and measurements alone, and programs only read them",
     "{0}: в этой версии есть только переменные макросов и измерений, и программы их только читают"},
    {"P883", "{0} does not stand beside the call of a subprogram",
     "{0} не стоит рядом с вызовом подпрограммы"},
    {"P884", "{0}: the way round of a rotary axis is not chosen in this version: write AC or IC",
     "{0}: направление поворотной оси в этой версии не выбирается: задайте AC или IC"},
    {"P885", "{0}: a rotation goes about the axis across the plane: select the plane and write RPL=",
     "{0}: поворот идёт вокруг оси, перпендикулярной плоскости: выберите плоскость и задайте RPL="},
    {"P886",
     "{0}: the tool stands at {1}{2} and the contour reaches {1}{3}: start the cycle beside the contour",
     "{0}: инструмент стоит на {1}{2}, а контур доходит до {1}{3}: начните цикл вне контура"},
    {"P887, 61101", "{0}: the bottom at {1}{3} does not lie behind R at {1}{2}: correct {1} and R",
     "{0}: дно на {1}{3} не лежит за плоскостью R на {1}{2}: исправьте {1} и R"},
    {"P888",
     "{0}: the machine has no second spindle that may follow the first one: set `coupling` of the second "
     "[[spindle]] in the machine file",
     "{0}: на станке нет второго шпинделя, который может следовать за первым: задайте `coupling` второго "
     "[[spindle]] в файле станка"},
    {"P889",
     "{0}: at {1} rpm and an override of 125 % the second spindle would turn at {2} rpm, its fastest speed "
     "is "
     "{3} rpm",
     "{0}: при {1} об/мин и коррекции 125 % второй шпиндель вращался бы с {2} об/мин, его наибольшая частота "
     "{3} об/мин"},
    {"P890", "{0}: a cutting speed (G96) needs a limit of the spindle: G50 S before it",
     "{0}: при скорости резания (G96) нужно ограничение частоты шпинделя: перед ним G50 S"},
};
static_assert(std::size(kMessages) == static_cast<std::size_t>(Wrong::polygon_limit) + 1);

}  // namespace

std::span<const text::Entry> messages() { return kMessages; }

const text::Entry& entry(Wrong wrong) { return kMessages[static_cast<std::size_t>(wrong)]; }

}  // namespace servogate::program::sinumerik::iso
