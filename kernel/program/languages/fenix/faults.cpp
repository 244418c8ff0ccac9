// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/fenix/faults.hpp"

#include <iterator>

namespace servogate::program::fenix {
namespace {

constexpr text::Entry kMessages[] = {
    {"P760, 150", "{0}: both ends of the line and its angle are given; give one axis and the angle",
     "{0}: заданы оба конца прямой и угол; задайте одну ось и угол"},
    {"P761", "{0}: an angle goes with one axis of the plane", "{0}: угол задаётся с одной осью плоскости"},
    {"P762", "{0}: under this angle the line never reaches the end of {1}",
     "{0}: под этим углом прямая не приходит к концу по {1}"},
    {"P763, 156", "the angle of the arc is {0}; it is above 0 and at most {1} degrees",
     "угол дуги {0}; он больше 0 и не больше {1} градусов"},
    {"P764, 153", "both axes of the thread move by {0}: the main one moves farther than the other",
     "обе оси резьбы проходят {0}: главная проходит больше другой"},
    {"P765, 153", "S{0} is too fast for this thread: at most {1} rpm",
     "S{0} слишком много для этой резьбы: не больше {1} об/мин"},
    {"P766, 153", "a thread has its lead as F in its own block", "шаг резьбы задаётся словом F в её кадре"},
    {"P767, 154", "G96: the limits {0} and {1} are not 0 or more, the least one first",
     "G96: пределы {0} и {1} не от 0, меньший первым"},
    {"P768", "G96: a least speed of {0} rpm is not kept by this version; leave it out",
     "G96: наименьшую частоту {0} об/мин эта версия не выдерживает; опустите её"},
    {"P769", "{0}: the argument P{1} is missing", "{0}: нет аргумента P{1}"},
    {"P770", "{0}: P{1} is {2}; it is above 0", "{0}: P{1} равен {2}; он больше 0"},
    {"P771", "{0} has {1} arguments at most", "{0}: аргументов не больше {1}"},
    {"P772", "{0}: the step of {1} does not lead to the end", "{0}: шаг {1} не ведёт к концу"},
    {"P773", "{0}: more than {1} passes", "{0}: больше {1} проходов"},
    {"P774", "{0} needs {1}", "{0} требует {1}"},
    {"P775", "{0} has no contour: give one by G852 before it",
     "{0}: контура нет; задайте его перед этим функцией G852"},
    {"P776", "{0}: P{1} is {2}; it is 0 or more", "{0}: P{1} равен {2}; он не меньше 0"},
    {"P777", "{0}: P{1} is {2}; it is {3}", "{0}: P{1} равен {2}; он {3}"},
    {"P778", "{0}: under the angle P{1} of {2} degrees the side never reaches its end",
     "{0}: под углом P{1} в {2} градусов сторона не приходит к концу"},
    {"P779", "{0}: P{1} is {2} degrees; it is from {3} to {4}",
     "{0}: P{1} равен {2} градусов; он от {3} до {4}"},
    {"P780", "{0} turns a spindle that stands oriented: write M19 in a block before it",
     "{0} поворачивает ориентированный шпиндель: задайте M19 в кадре перед ним"},
    {"P781", "{0}: the speed of the turn is missing: write S in rpm",
     "{0}: нет скорости поворота: задайте S в об/мин"},
    {"P782", "the subprogram L{0} does not end: write M17 behind it, in front of {1}",
     "подпрограмма L{0} не кончается: задайте M17 за ней, перед {1}"},
};
static_assert(std::size(kMessages) == static_cast<std::size_t>(Wrong::subprogram_open) + 1);

}  // namespace

std::span<const text::Entry> messages() { return kMessages; }

const text::Entry& entry(Wrong wrong) { return kMessages[static_cast<std::size_t>(wrong)]; }

}  // namespace servogate::program::fenix
