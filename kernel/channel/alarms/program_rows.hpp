// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::channel {

/// Alarms of programs and channels: 4000.
inline constexpr image::AlarmRow kProgramRows[] = {
    {image::alarm::kProgramError,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.error", "program error in {9}", "ошибка программы, {9}"},
     "Correct the program at that place, load it again, reset.",
     "Исправьте программу в этом месте, загрузите её снова, выполните сброс."},
    {image::alarm::kUnknownM,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.unknown_m", "{9}: the PLC does not know M{1}", "{9}: ПЛК не знает функцию M{1}"},
     "Correct the program, or add this function to the PLC program.",
     "Исправьте программу или добавьте функцию в ПЛК."},
    {image::alarm::kMAckTimeout,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.m_timeout", "{9}: M{1} not acknowledged within {2} s", "{9}: нет подтверждения M{1} за {2} с"},
     "Find out in the PLC program what the function waits for. The acknowledge must follow the strobe and be "
     "taken back when the strobe falls.",
     "Посмотрите в ПЛК, чего ожидает функция; подтверждение даётся после строба и снимается вместе с ним."},
    {image::alarm::kSAckTimeout,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.s_timeout", "{9}: S{1} not acknowledged within {2} s", "{9}: нет подтверждения S{1} за {2} с"},
     "Find out in the PLC program what the spindle waits for. The acknowledge must follow the strobe and be "
     "taken back when the strobe falls.",
     "Посмотрите в ПЛК, чего ожидает шпиндель; подтверждение даётся после строба и снимается вместе с ним."},
    {image::alarm::kTAckTimeout,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.t_timeout", "{9}: T{1} not acknowledged within {2} s", "{9}: нет подтверждения T{1} за {2} с"},
     "Find out in the PLC program what the tool change waits for. The acknowledge must follow the strobe and "
     "be taken back when the strobe falls.",
     "Посмотрите в ПЛК, чего ожидает смена инструмента; подтверждение даётся после строба и снимается вместе "
     "с ним."},
    {image::alarm::kHAckTimeout,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.h_timeout", "{9}: H{1} not acknowledged within {2} s", "{9}: нет подтверждения H{1} за {2} с"},
     "Find out in the PLC program what the function waits for. The acknowledge must follow the strobe and be "
     "taken back when the strobe falls.",
     "Посмотрите в ПЛК, чего ожидает функция; подтверждение даётся после строба и снимается вместе с ним."},
    {image::alarm::kStarved,
     image::Reaction::warn,
     image::ResetCondition::by_itself,
     {"program.starved", "{9}: planning was too slow, so the motion was slowed down ({1} cycles so far)",
      "{9}: планирование опоздало, движение замедлено (всего тактов: {1})"},
     "Reduce the load on the computer, or use fewer and longer blocks.",
     "Разгрузите компьютер или используйте более длинные кадры."},
    {image::alarm::kWriteRefused,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"program.write_refused", "{9}: the program may not write {8} or {1} does not fit there",
      "{9}: программе нельзя писать в {8}, или значение {1} не помещается"},
     "Inputs and places of the PLC cannot be written by a program.",
     "Входы и ячейки ПЛК не могут записываться программой."},
    {image::alarm::kProgramWarning,
     image::Reaction::warn,
     image::ResetCondition::by_itself,
     {"program.warning", "{9}: the machine cannot do this as programmed",
      "{9}: станок не может выполнить это так, как запрограммировано"},
     "The message with file, line and column says what happens instead; `servogate check` lists all such "
     "places before the program runs.",
     "Что выполняется вместо этого, сказано в сообщении с файлом, строкой и столбцом; `servogate check` "
     "перечисляет все такие места заранее."},
};

}  // namespace servogate::channel
