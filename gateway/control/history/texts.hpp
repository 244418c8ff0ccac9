// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// The sentences of the history.
namespace servogate::gateway::history::says {

using text::Entry;

inline constexpr Entry kUp{"history.up", "the control of {0} is up (servogate {1})",
                           "управление станком {0} работает (servogate {1})"};
inline constexpr Entry kDown{"history.down", "the control of {0} has ended",
                             "управление станком {0} завершено"};
inline constexpr Entry kAlarm{"history.alarm", "alarm {0}: {1}", "авария {0}: {1}"};
inline constexpr Entry kWarning{"history.warning", "warning {0}: {1}", "предупреждение {0}: {1}"};
inline constexpr Entry kCleared{"history.cleared", "no longer: {0} {1}", "снято: {0} {1}"};
inline constexpr Entry kMissed{"history.missed", "{0} more alarms came and went at once",
                               "ещё аварий, снятых сразу: {0}"};
inline constexpr Entry kDrivesOn{"history.drives-on", "the drives are on", "приводы включены"};
inline constexpr Entry kDrivesOff{"history.drives-off", "the drives are off", "приводы выключены"};
inline constexpr Entry kHomed{"history.homed", "{0} has its reference", "{0}: нулевая точка найдена"};
inline constexpr Entry kNotHomed{"history.not-homed", "{0} has lost its reference",
                                 "{0}: нулевая точка потеряна"};
inline constexpr Entry kStarted{"history.started", "{0} was started", "запущено: {0}"};
inline constexpr Entry kTyped{"history.typed", "a typed block was started: {0}",
                              "запущен введённый кадр: {0}"};
inline constexpr Entry kHeld{"history.held", "the program is held in line {0}",
                             "программа приостановлена в строке {0}"};
inline constexpr Entry kGoesOn{"history.goes-on", "the program goes on in line {0}",
                               "программа продолжена со строки {0}"};
inline constexpr Entry kEnded{"history.ended", "the program has ended", "программа завершена"};
inline constexpr Entry kStopped{"history.stopped", "the program was stopped in line {0}",
                                "программа остановлена в строке {0}"};
inline constexpr Entry kStoppedByAlarm{"history.stopped-by-alarm", "an alarm stopped the program in line {0}",
                                       "программа остановлена аварией в строке {0}"};
inline constexpr Entry kAsked{"history.asked", "{0}: {1}", "{0}: {1}"};
inline constexpr Entry kRefused{"history.refused", "{0}: {1}: refused: {2}", "{0}: {1}: отказано: {2}"};

}  // namespace servogate::gateway::history::says
