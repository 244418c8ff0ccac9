// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::plc {

/// Alarms of a PLC program that was stopped.
inline constexpr image::AlarmRow kLogicRows[] = {
    {image::alarm::kPlcBudget,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::reset,
     {"plc.budget", "the PLC program did not finish within its cycle and was stopped: {6}",
      "программа ПЛК не завершилась за такт и остановлена: {6}"},
     "Look for a loop that does not end; without the PLC program nothing is enabled.",
     "Найдите цикл, который не заканчивается; без программы ПЛК нет разрешений.",
     image::AlarmMark::fails_control},
    {image::alarm::kPlcFault,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::reset,
     {"plc.fault", "the PLC program was stopped by a fault: {6}",
      "программа ПЛК остановлена из-за ошибки: {6}"},
     "Correct the PLC program; without it nothing is enabled.",
     "Исправьте программу ПЛК; без неё нет разрешений.",
     image::AlarmMark::fails_control},
};

}  // namespace servogate::plc
