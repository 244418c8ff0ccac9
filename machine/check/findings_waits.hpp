// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Texts of what takes longer than somebody waits for it.
namespace servogate::machine::finding {

inline constexpr text::Entry kHomingTooSlow{
    "machine.homing_too_slow",
    "{0}: home.slow {1} cannot home the axis within home.timeout {2}: {3} at that speed take {4} (the way of "
    "a "
    "stop from home.fast, and one turn of the motor where a zero mark is sought); set home.slow to {5} or "
    "more, "
    "or a longer home.timeout",
    "{0}: с home.slow {1} ось не выйдет в ноль за home.timeout {2}: {3} на этой скорости занимают {4} (путь "
    "останова с home.fast и один оборот двигателя, если ищется нулевая метка); задайте home.slow от {5} или "
    "увеличьте home.timeout"};
inline constexpr text::Entry kHomingTooFar{
    "machine.homing_too_far",
    "{0}: homing from the far end of the travel takes {1}, and home.timeout ends it after {2}: raise "
    "home.fast, "
    "or set a longer home.timeout",
    "{0}: выход в ноль с дальнего конца хода занимает {1}, а home.timeout прерывает его через {2}: увеличьте "
    "home.fast или home.timeout"};
inline constexpr text::Entry kReleaseTooLong{
    "machine.release_too_long",
    "{0}: brake.release_delay {1} is not below the transition_timeout {2} of device file \"{3}\": the drive "
    "is "
    "enabled only when its brake is open, and would be given up before; set a transition_timeout above {1} "
    "there",
    "{0}: brake.release_delay {1} не меньше transition_timeout {2} файла устройства «{3}»: привод разрешает "
    "работу, лишь когда тормоз отпущен, а ожидание кончится раньше; задайте там transition_timeout больше "
    "{1}"};
inline constexpr text::Entry kSpindleTooSlow{
    "machine.spindle_too_slow",
    "spindle {0}: {1} rpm at {2} rpm/s take {3}, and plc.handshake_timeout stops the program when M3 or S is "
    "not acknowledged within {4}: raise `acceleration`, or set a longer handshake_timeout",
    "шпиндель {0}: разгон до {1} об/мин при {2} об/мин за секунду занимает {3}, а plc.handshake_timeout "
    "останавливает программу, если M3 или S не подтверждены за {4}: увеличьте `acceleration` или "
    "handshake_timeout"};
inline constexpr text::Entry kPeriodTooShort{
    "machine.period_too_short",
    "station \"{0}\": period {1} cannot be kept: one round of line \"{2}\" takes {3} at {4} bit/s, and data "
    "older "
    "than {5} ({6} periods) count as stale; set period = \"{7}\" or more, or a faster `baud`",
    "станция «{0}»: период {1} не выдержать: один круг линии «{2}» занимает {3} при {4} бит/с, а данные "
    "старше "
    "{5} (периодов: {6}) считаются устаревшими; задайте period = \"{7}\" или больше либо увеличьте `baud`"};

}  // namespace servogate::machine::finding
