// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::cycle {

/// Alarms of inputs and outputs: 3000.
inline constexpr AlarmRow kPointRows[] = {
    {alarm::kSourceStale,
     image::Reaction::stop_on_path,
     ResetCondition::cause_gone,
     {"io.stale", "{3}: does not answer, its data are {1} ms old", "{3}: не отвечает, возраст данных {1} мс"},
     "Check supply and connection of the station.",
     "Проверьте питание и связь со станцией."},
    {alarm::kSourceBad,
     image::Reaction::stop_on_path,
     ResetCondition::cause_gone,
     {"io.bad", "{3}: answers with errors, its last good data are {1} ms old",
      "{3}: отвечает с ошибками, последние верные данные {1} мс назад"},
     "Check the addresses of the station in the machine file.",
     "Проверьте адреса станции в файле станка."},
};

}  // namespace servogate::cycle
