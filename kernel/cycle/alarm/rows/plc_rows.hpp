// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::cycle {

/// Alarms of the PLC: 5000.
inline constexpr AlarmRow kPlcRows[] = {
    {alarm::kExternalAlarm,
     image::Reaction::stop_on_path,
     ResetCondition::cause_gone,
     {"plc.external", "alarm {1} of the machine", "авария станка {1}"},
     "See the machine builder's list.",
     "Смотрите перечень изготовителя станка."},
    {alarm::kPlcBudget,
     image::Reaction::stop_and_power_off,
     ResetCondition::reset,
     {"plc.budget", "the PLC program did not finish within its cycle and was stopped: {6}",
      "программа ПЛК не завершилась за такт и остановлена: {6}"},
     "Look for a loop that does not end; without the PLC program nothing is enabled.",
     "Найдите цикл, который не заканчивается; без программы ПЛК нет разрешений."},
    {alarm::kPlcFault,
     image::Reaction::stop_and_power_off,
     ResetCondition::reset,
     {"plc.fault", "the PLC program was stopped by a fault: {6}",
      "программа ПЛК остановлена из-за ошибки: {6}"},
     "Correct the PLC program; without it nothing is enabled.",
     "Исправьте программу ПЛК; без неё нет разрешений."},
    {alarm::kPlcHeld,
     image::Reaction::stop_and_power_off,
     ResetCondition::cause_gone,
     {"plc.held", "the PLC is or was held for single scans: nothing can be switched on before a reset",
      "ПЛК удерживается или удерживался для отдельных сканов: до сброса ничего нельзя включить"},
     "End `servogate plc step`, then reset and switch the drives on again.",
     "Завершите `servogate plc step`, затем выполните сброс и снова включите приводы."},
    {alarm::kPlcWatchdog,
     image::Reaction::stop_and_power_off,
     ResetCondition::reset,
     {"plc.watchdog", "a scan of the PLC took {1} ms, allowed {2} ms",
      "скан ПЛК длился {1} мс, допустимо {2} мс"},
     "`servogate plc watch --times` shows what takes the time; shorten it, or raise [plc] watchdog.",
     "Что занимает время, показывает `servogate plc watch --times`; сократите это или увеличьте [plc] "
     "watchdog."},
};

}  // namespace servogate::cycle
