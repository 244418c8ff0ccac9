// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

namespace servogate::channel::texts {

inline constexpr text::Entry kTapOpen{
    "channel.tap-open",
    "behind a tap come the spindle reversed and the way back along the same line, until it stands where it "
    "began; here it is something else",
    "за резьбонарезанием метчиком следуют реверс шпинделя и возврат по той же прямой, до начальной точки; "
    "здесь — другое"};
inline constexpr text::Entry kTapLegs{
    "channel.tap-legs",
    "the tap goes in and back more than {0} times: break chips less often, or leave the hole between passes",
    "метчик входит и возвращается больше {0} раз: реже ломайте стружку или выводите метчик из отверстия"};
inline constexpr text::Entry kTapCoupled{
    "channel.tap-coupled",
    "a tap reverses the first spindle and the second one follows it: end the coupling before the tap (G50.2)",
    "метчик реверсирует первый шпиндель, а второй следует за ним: перед нарезанием завершите связь (G50.2)"};
inline constexpr text::Entry kTapTooFast{"channel.tap-too-fast",
                                         "the tap leaves its hole at {1} mm/min with its spindle at {2} rpm, "
                                         "{0} goes at most at {3} mm/min: a lower speed for the way out",
                                         "метчик выходит из отверстия на {1} мм/мин при {2} об/мин шпинделя, "
                                         "{0} движется не быстрее {3} мм/мин: снизьте частоту на выход"};
inline constexpr text::Entry kTapLeavesTravel{
    "channel.tap-leaves-travel",
    "the tap may go {1} mm beyond its depth with its spindle (tap_overshoot): {0} would be at {2}, its "
    "travel "
    "ends at {3}",
    "метчик может пройти за глубину на {1} мм вслед за шпинделем (tap_overshoot): {0} окажется в {2}, ход "
    "кончается в {3}"};
inline constexpr text::Entry kNoSuchProcess{
    "channel.no-such-process", "there is no process {0}: this machine has {1} ([control] processes)",
    "процесса {0} нет: у этого станка их {1} ([control] processes)"};
inline constexpr text::Entry kProcessNotStarted{
    "channel.process-not-started",
    "process {0} does not start '{1}': `servogate start --process {0}` says what its start lacks",
    "процесс {0} не пускает «{1}»: чего недостаёт для пуска, говорит `servogate start --process {0}`"};
inline constexpr text::Entry kProgramNotFound{
    "channel.program-not-found", "there is no program '{1}' for process {0} in the folder of this program",
    "программы «{1}» для процесса {0} в папке этой программы нет"};
inline constexpr text::Entry kForeignAxis{
    "channel.foreign-axis", "{0} belongs to another process: its programs move it",
    "ось {0} принадлежит другому процессу: её перемещают его программы"};
inline constexpr text::Entry kCannotDrive{"channel.cannot-drive", "this element cannot be driven: {0}",
                                          "этот элемент нельзя отработать: {0}"};

inline constexpr text::Entry kRestsInside{
    "channel.rests-inside",
    "the path comes to rest inside this block, and goes on in short moves: no speed was found that keeps all "
    "limits of the axes through the blocks that follow; a greater tolerance of the contour, or blocks "
    "without "
    "steps and folds smaller than it, are driven without this rest",
    "контур останавливается внутри этого кадра и продолжается короткими перемещениями: для следующих кадров "
    "не "
    "найдена скорость, при которой соблюдены все пределы осей; без этой остановки помогает больший допуск "
    "контура "
    "или кадры без ступенек и петель меньше него"};

/// Why the path room cannot drive an element, index = path::Flaw.
inline constexpr text::Entry kFlaws[] = {
    {"channel.flaw-none", "nothing is wrong", "ошибки нет"},
    {"channel.flaw-not-finite", "a coordinate or feed is no number, or larger than any machine",
     "координата или подача не число либо больше любого станка"},
    {"channel.flaw-no-feed", "no feed: program F (and S with feed per revolution) first",
     "нет подачи: сначала задайте F (а при подаче на оборот и S)"},
    {"channel.flaw-plane", "the axes of the plane are not two different linear axes",
     "оси плоскости — не две разные линейные оси"},
    {"channel.flaw-no-radius", "the radius of the arc is below 0.000001 mm",
     "радиус дуги меньше 0,000001 мм"},
    {"channel.flaw-radius", "the radius of the arc differs between start and end by more than 0.01 mm",
     "радиус дуги различается в начале и конце более чем на 0,01 мм"},
    {"channel.flaw-sweep", "the angle does not lead to the end point", "угол не приводит в конечную точку"},
};

}  // namespace servogate::channel::texts
