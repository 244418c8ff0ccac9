// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What is wrong with electronic gears.
namespace servogate::machine::finding {

inline constexpr text::Entry kGearMaster{
    "machine.gear_master", "`master`: \"{0}\" is none of the axes and spindles of the machine ({1})",
    "`master`: «{0}» — не ось и не шпиндель станка ({1})"};
inline constexpr text::Entry kGearItself{"machine.gear_itself", "{0} would follow itself",
                                         "{0} следовала бы за самой собой"};
inline constexpr text::Entry kGearRing{
    "machine.gear_ring", "{0} would follow itself by way of {1}: gears may form a chain, not a ring",
    "{0} следовала бы за самой собой через {1}: редукторы могут идти цепочкой, но не по кругу"};
inline constexpr text::Entry kGearRatio{
    "machine.gear_ratio",
    "`ratio`: [{0}, {1}] is no ratio of a gear: neither number is 0, the second is above 0, and their "
    "quotient is at most {2} either way",
    "`ratio`: [{0}, {1}] не может быть передаточным отношением: числа не равны 0, второе больше 0, а частное "
    "не больше {2} в любую сторону"};
inline constexpr text::Entry kGearEncoder{
    "machine.gear_encoder",
    "`master`: the angle of spindle {0} is not known: it needs a drive with an encoder (`drive`, "
    "counts_per_rev)",
    "`master`: угол шпинделя {0} неизвестен: ему нужен привод с датчиком (`drive`, counts_per_rev)"};
inline constexpr text::Entry kGearSteps{
    "machine.gear_steps",
    "`source`: {0} has no encoder (`board.feedback` = \"steps\"), its steps are its set-point: "
    "source = \"setpoint\"",
    "`source`: у оси {0} нет датчика (`board.feedback` = \"steps\"), её шаги и есть задание: нужно "
    "source = \"setpoint\""};
inline constexpr text::Entry kGearCoupled{
    "machine.gear_coupled",
    "`master`: spindle {0} follows another one itself (`coupling`), and its set-point is not known: "
    "source = \"measured\"",
    "`master`: шпиндель {0} сам следует за другим (`coupling`), и его задание неизвестно: нужно "
    "source = \"measured\""};
inline constexpr text::Entry kGearOwnSpindle{
    "machine.gear_own_spindle",
    "{0} and spindle {1} are one drive (`axis` of the spindle): the axis cannot follow its own spindle",
    "у оси {0} и шпинделя {1} один привод (`axis` шпинделя): ось не может следовать за своим шпинделем"};
inline constexpr text::Entry kGearPhaseAlone{"machine.gear_phase",
                                             "`phase` does nothing without in_phase = true",
                                             "`phase` без in_phase = true ни на что не влияет"};
inline constexpr text::Entry kGearSame{
    "machine.gear_same",
    "this is the same gear as number {1} of {0}: the PLC tells them apart by number only",
    "это тот же редуктор, что и {1}-й у оси {0}: ПЛК различает их только по номеру"};
inline constexpr text::Entry kGearMany{"machine.gear_many", "{0} has {1} gears: at most {2} are possible",
                                       "у оси {0} редукторов: {1}, возможно не больше {2}"};
inline constexpr text::Entry kGearWindow{
    "machine.gear_window",
    "{0}: `window` {1} is below in_position_window {2}: the axis itself is not held more exactly",
    "{0}: `window` {1} меньше in_position_window {2}: точнее ось не удерживается"};

}  // namespace servogate::machine::finding
