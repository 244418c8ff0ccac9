// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::cycle {

/// Alarms of real time and system: 6000.
inline constexpr AlarmRow kSystemRows[] = {
    {alarm::kEmergencyStop,
     image::Reaction::stop_and_power_off,
     ResetCondition::cause_gone,
     {"system.emergency_stop", "emergency stop", "аварийный останов"},
     "Remove the danger, unlock the button, reset, then switch the drives on again.",
     "Устраните опасность, отпустите кнопку, выполните сброс и снова включите приводы."},
    {alarm::kOverrunLimit,
     image::Reaction::stop_on_path,
     ResetCondition::reset,
     {"system.overruns", "a cycle began {1} ms late, allowed {2} ms; what took the time: {6}",
      "такт начался с опозданием {1} мс, допустимо {2} мс; время ушло на: {6}"},
     "Use an isolated processor ([realtime] cpu) or a longer cycle; the report holds the times of each "
     "phase.",
     "Выделите процессор ([realtime] cpu) или увеличьте такт; времена фаз есть в отчёте."},
    {alarm::kOperatorQuickStop,
     image::Reaction::quick_stop,
     ResetCondition::reset,
     {"system.quick_stop", "quick stop by the operator", "быстрый останов оператором"},
     "Reset, then switch the drives on again.",
     "Выполните сброс и снова включите приводы."},
    {alarm::kRequestsLost,
     image::Reaction::warn,
     ResetCondition::by_itself,
     {"system.requests_lost", "{1} requests were lost: too many at once",
      "потеряно запросов: {1}, слишком много сразу"},
     "Send requests less often.",
     "Отправляйте запросы реже."},
    {alarm::kGuardForced,
     image::Reaction::warn,
     ResetCondition::by_itself,
     {"system.guard_forced",
      "a place that guards motion or energy is forced: a protection of the machine may be out of action",
      "принудительно удерживается место, которое защищает от движения или включения: защита станка может не "
      "действовать"},
     "`servogate plc force` shows what is forced and by whom; `servogate plc force --release` releases it.",
     "Что и кем удерживается, показывает `servogate plc force`; `servogate plc force --release` "
     "освобождает."},
    {alarm::kStateFellBack,
     image::Reaction::warn,
     ResetCondition::reset,
     {"system.state_fell_back",
      "the saved state of the machine was damaged: the previous copy is in use, or, without a whole copy of "
      "the "
      "gains, those of the machine file",
      "сохранённое состояние станка повреждено: используется предыдущая копия либо, если нет целой копии "
      "коэффициентов, коэффициенты файла станка"},
     "The messages at the start of the control name the file. Check origins, tools and references before "
     "anything moves.",
     "Файл назван в сообщениях при запуске управления. До движения проверьте начала отсчёта, инструмент и "
     "привязку осей."},
    {alarm::kRecordBroken,
     image::Reaction::warn,
     ResetCondition::reset,
     {"system.record_broken", "this run is no longer being recorded: the disk is full or too slow",
      "запись этого прогона больше не ведётся: диск полон или слишком медленный"},
     "The machine keeps running; what was recorded so far can be replayed. Free some disk space and restart "
     "the control.",
     "Станок работает дальше; записанное до этого можно повторить. Освободите место и запустите управление "
     "заново."},
};

}  // namespace servogate::cycle
