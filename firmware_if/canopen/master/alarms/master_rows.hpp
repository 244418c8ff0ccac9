// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::canopen {

/// Alarms of buses and their nodes: 2004 to 2025.
inline constexpr image::AlarmRow kMasterRows[] = {
    {image::alarm::kPdoMissing,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"drive.pdo_missing", "node {3}: {1} cycles without process data{6}, allowed fewer than {2}",
      "узел {3}: {1} тактов без данных процесса{6}, допустимо менее {2}"},
     "Check supply and bus cable of the node, then bus load and termination. If another process simulates "
     "the drive, the computer stalled: use a longer cycle_time or more loss_cycles.",
     "Проверьте питание и кабель шины узла, затем загрузку шины и согласование линии. Если привод имитирует "
     "другой процесс: компьютер не успел; увеличьте cycle_time или loss_cycles.",
     image::AlarmMark::of_part},
    {image::alarm::kNodeLost,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"bus.node_lost", "node {3}: no heartbeat for {1} ms, allowed {2} ms",
      "узел {3}: нет контрольного сообщения {1} мс, допустимо {2} мс"},
     "Check supply and bus cable of the node.",
     "Проверьте питание и кабель шины узла.",
     image::AlarmMark::of_part},
    {image::alarm::kEmergencyMessage,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"bus.emergency", "node {3}: emergency message, error {5}, register {1}",
      "узел {3}: аварийное сообщение EMCY, ошибка {5}, регистр {1}"},
     "See the manual of the device for the error code.",
     "Найдите код ошибки в руководстве устройства."},
    {image::alarm::kBusOff,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"bus.off", "bus {3}: bus off", "шина {3}: отключена контроллером (bus off)"},
     "Check termination, short circuit and bit rate of every node.",
     "Проверьте согласование, короткое замыкание и скорость всех узлов.",
     image::AlarmMark::of_part},
    {image::alarm::kBusErrorPassive,
     image::Reaction::warn,
     image::ResetCondition::by_itself,
     {"bus.error_passive", "bus {3}: error passive", "шина {3}: пассивное состояние из-за ошибок"},
     "Check termination and shielding before it goes bus off.",
     "Проверьте согласование и экраны, пока шина не отключилась."},
    {image::alarm::kForeignFrame,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::reset,
     {"bus.foreign_frame", "bus {3}: another master sends {8}", "шина {3}: другой ведущий передаёт {8}"},
     "A bus has one master. Find the other one and end it. As long as it sends, the alarm returns after each "
     "reset.",
     "Ведущий на шине может быть только один. Найдите другого и завершите его. Пока он передаёт, авария "
     "возвращается после каждого сброса."},
    {image::alarm::kBootFailed,
     image::Reaction::stop_at_block_end,
     image::ResetCondition::reset,
     {"bus.boot_failed", "node {3}: {6}", "узел {3}: {6}"},
     "Compare the device with its file in devices/; the boot step says what was expected.",
     "Сравните устройство с его файлом в devices/; шаг указывает, что ожидалось."},
    {image::alarm::kBusSendOverflow,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"bus.send_overflow", "bus {3}: {1} frames could not be sent", "шина {3}: не отправлено кадров: {1}"},
     "Lower the bus load: longer cycle, second segment, shorter mapping.",
     "Снизьте загрузку шины: больший такт, второй сегмент, меньше отображаемых объектов."},
    {image::alarm::kBusDown,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"bus.down", "bus {3}: its interface is down, or its bus server is gone",
      "шина {3}: интерфейс выключен или сервер исчез"},
     "Bring the interface up: ip link set NAME up; start the server again, then the control.",
     "Включите интерфейс: ip link set ИМЯ up; запустите сервер снова, затем управление.",
     image::AlarmMark::of_part},
    {image::alarm::kNodeRestarted,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"bus.node_restarted", "node {3}: has restarted by itself", "узел {3}: перезапустился сам"},
     "Check the supply of the device and its watchdog, and that no second device on the bus has its "
     "node-ID; an axis has to be homed again.",
     "Проверьте питание устройства и его сторожевой таймер и нет ли на шине второго устройства с его "
     "номером узла; ось нужно снова вывести в ноль.",
     image::AlarmMark::of_part},
    {image::alarm::kNodeLeft,
     image::Reaction::stop_on_path,
     image::ResetCondition::cause_gone,
     {"bus.node_left", "node {3}: left Operational without a command; its NMT state is {1}",
      "узел {3}: вышел из состояния Operational без команды, состояние NMT: {1}"},
     "Look for a second master on the bus; the manual of the device says what else makes it leave "
     "Operational.",
     "Проверьте, нет ли на шине второго ведущего; причину выхода ищите в руководстве устройства.",
     image::AlarmMark::of_part},
    {image::alarm::kPdoShort,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"bus.pdo_short", "node {3}: process data{6} come with {1} bytes instead of {2} and are not used",
      "узел {3}: данные процесса{6} приходят длиной {1} байт вместо {2} и не используются"},
     "Compare the mapping of the node (1A00h and following) with its file in devices/.",
     "Сравните отображение узла (1A00h и далее) с его файлом в devices/."},
    {image::alarm::kErrorHistory,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"bus.error_history",
      "node {3}: its error history ({8}) contains {5}, for which no emergency message arrived",
      "узел {3}: в его истории ошибок ({8}) есть {5}, сообщения о которой не было"},
     "It may be the cause of what the node has reported; see its manual for the error code.",
     "Это может быть причиной того, о чём узел сообщил; код ошибки — в руководстве устройства."},
    {image::alarm::kNotInterpolating,
     image::Reaction::stop_axes,
     image::ResetCondition::reset,
     {"bus.not_interpolating",
      "node {3}: in interpolated position mode the drive has not begun to interpolate for {1} ms (bit 12 of "
      "the "
      "statusword was awaited for {2} ms); {4}",
      "узел {3}: в режиме интерполяции привод не начал её за {1} мс (бит 12 слова состояния ожидался {2} "
      "мс); "
      "{4}"},
     "Compare the record 60C1h, the period 60C2h and the buffer 60C4h with the manual of the drive, and with "
     "ip_record, interpolation_base and ip_buffer of its device file.",
     "Сравните запись 60C1h, период 60C2h и буфер 60C4h с руководством привода и с ip_record, "
     "interpolation_base и ip_buffer его файла устройства."},
    {image::alarm::kReportsLost,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"bus.reports_lost",
      "bus {3}: {1} messages of nodes (emergency messages and others) arrived faster than they could be "
      "processed and are not shown",
      "шина {3}: сообщения узлов (аварийные и другие) пришли быстрее, чем их можно принять; не показано: "
      "{1}"},
     "Look at the node named in the neighbouring alarms; an inhibit time (1015h) keeps it from flooding the "
     "bus.",
     "Проверьте узел, названный соседними авариями; время запрета (1015h) ограничит поток сообщений."},
    {image::alarm::kForeignRequest,
     image::Reaction::warn,
     image::ResetCondition::reset,
     {"bus.foreign_request", "bus {3}: somebody else sends {8}", "шина {3}: кто-то другой передаёт {8}"},
     "A tool on this bus asks the same nodes as the control, and their answers get mixed up. Read through "
     "the "
     "control (servogate sdo, od), or end the tool.",
     "Программа на этой шине опрашивает те же узлы, что и управление, и ответы перемешиваются. Читайте через "
     "управление (servogate sdo, od) или завершите эту программу."},
    {image::alarm::kLeadLost,
     image::Reaction::stop_and_power_off,
     image::ResetCondition::reset,
     {"bus.lead_lost",
      "bus {3}: this control stood still for {2} s, and another one leads the bus now: it sends {8}. This "
      "control sends nothing any more",
      "шина {3}: управление стояло {2} с, и теперь шину ведёт другое: оно передаёт {8}. Это управление "
      "больше "
      "ничего не передаёт"},
     "End this control. To lead the bus again, end the other one first, then start this one.",
     "Завершите это управление. Чтобы снова вести шину, сначала завершите другое, затем запустите это."},
};

}  // namespace servogate::canopen
