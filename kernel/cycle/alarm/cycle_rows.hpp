// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::cycle {

/// Alarms that the cycle raises by itself: of sources of points (3000), of the PLC as it sees it (5000), of
/// real time and system (6000).
inline constexpr image::AlarmRow kCycleRows[] = {
    {image::alarm::kSourceStale,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"io.stale", "{3}: does not answer, its data are {1} ms old", "{3}: не отвечает, возраст данных {1} мс"},
     "Check supply and connection of the station.",
     "Проверьте питание и связь со станцией."},
    {image::alarm::kSourceBad,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"io.bad", "{3}: lost, its last good data are {1} ms old",
      "{3}: потеряна, последние верные данные {1} мс назад"},
     "See to its supply and its cable. Of a Modbus station, compare address, rate, parity and registers with "
     "the machine "
     "file; of a GPIO chip, see whether `gpiodetect` still lists it. A chip that has gone is taken again "
     "with the next start "
     "of the control.",
     "Проверьте питание и кабель. У станции Modbus сравните адрес, скорость, чётность и регистры с файлом "
     "станка; у "
     "микросхемы GPIO посмотрите, есть ли она ещё в `gpiodetect`. Пропавшая микросхема берётся снова при "
     "следующем запуске "
     "управления."},
    {image::alarm::kExternalAlarm,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"plc.external", "alarm {1} of the machine", "авария станка {1}"},
     "See the machine builder's list.",
     "Смотрите перечень изготовителя станка."},
    {image::alarm::kPlcHeld,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::cause_gone,
     {"plc.held", "the PLC is or was held for single scans: nothing can be switched on before a reset",
      "ПЛК удерживается или удерживался для отдельных сканов: до сброса ничего нельзя включить"},
     "End `servogate plc step`, then reset and switch the drives on again.",
     "Завершите `servogate plc step`, затем выполните сброс и снова включите приводы.",
     image::AlarmMark::fails_control},
    {image::alarm::kPlcWatchdog,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::reset,
     {"plc.watchdog", "a scan of the PLC took {1} ms, allowed {2} ms",
      "скан ПЛК длился {1} мс, допустимо {2} мс"},
     "`servogate plc watch --times` shows what takes the time; shorten it, or raise [plc] watchdog.",
     "Что занимает время, показывает `servogate plc watch --times`; сократите это или увеличьте [plc] "
     "watchdog.",
     image::AlarmMark::fails_control},
    {image::alarm::kEmergencyStop,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::cause_gone,
     {"system.emergency_stop", "emergency stop", "аварийный останов"},
     "Remove the danger, unlock the button, reset, then switch the drives on again.",
     "Устраните опасность, отпустите кнопку, выполните сброс и снова включите приводы."},
    {image::alarm::kOverrunLimit,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"system.overruns", "a cycle began {1} ms late, allowed {2} ms; what took the time: {6}",
      "такт начался с опозданием {1} мс, допустимо {2} мс; время ушло на: {6}"},
     "Use an isolated processor ([realtime] cpu) or a longer cycle; the report holds the times of each "
     "phase.",
     "Выделите процессор ([realtime] cpu) или увеличьте такт; времена фаз есть в отчёте.",
     image::AlarmMark::fails_control},
    {image::alarm::kOperatorQuickStop,
     image::Reaction::quick_stop,
     image::ResetCondition::reset,
     {"system.quick_stop", "quick stop by the operator", "быстрый останов оператором"},
     "Reset, then switch the drives on again.",
     "Выполните сброс и снова включите приводы."},
    {image::alarm::kGuardForced,
     image::Reaction::warn,
     image::ResetCondition::by_itself,
     {"system.guard_forced",
      "a place that guards motion or energy is forced: a protection of the machine may be out of action",
      "принудительно удерживается место, которое защищает от движения или включения: защита станка может не "
      "действовать"},
     "`servogate plc force` shows what is forced and by whom; `servogate plc force --release` releases it.",
     "Что и кем удерживается, показывает `servogate plc force`; `servogate plc force --release` "
     "освобождает."},
    {image::alarm::kStateFellBack,
     image::Reaction::warn,
     image::ResetCondition::reset,
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
    {image::alarm::kRecordBroken,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"system.record_broken", "this run is no longer being recorded: the disk is full or too slow",
      "запись этого прогона больше не ведётся: диск полон или слишком медленный"},
     "The machine keeps running; what was recorded so far can be replayed. Free some disk space and restart "
     "the control.",
     "Станок работает дальше; записанное до этого можно повторить. Освободите место и запустите управление "
     "заново."},
};

}  // namespace servogate::cycle
