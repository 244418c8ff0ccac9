// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include "firmware_if/canopen/301/emcy.hpp"

namespace servogate::canopen {
namespace {

struct Row {
  std::uint16_t code;
  text::Entry entry;
};

// In rising order. Groups (xx00h, x000h) from CiA 301, table "Emergency error code classes"; the others from
// CiA 402-1 / IEC 61800-7-201, table "Error codes".
constexpr Row kRows[] = {
    {0x0000, {"emcy-0000", "no error, or error reset", "ошибки нет или она сброшена"}},
    {0x1000, {"emcy-1000", "generic error", "общая ошибка"}},
    {0x2000, {"emcy-2000", "current", "ошибка по току"}},
    {0x2100, {"emcy-2100", "current on the device input side", "ток на входе устройства"}},
    {0x2110,
     {"emcy-2110", "short circuit or earth leakage, input side", "замыкание или утечка на землю на входе"}},
    {0x2120, {"emcy-2120", "earth leakage, input side", "утечка на землю на входе"}},
    {0x2130, {"emcy-2130", "short circuit, input side", "короткое замыкание на входе"}},
    {0x2200, {"emcy-2200", "current inside the device", "ток внутри устройства"}},
    {0x2220,
     {"emcy-2220", "continuous over-current inside the device", "длительный сверхток внутри устройства"}},
    {0x2230,
     {"emcy-2230", "short circuit or earth leakage inside the device",
      "замыкание или утечка на землю внутри устройства"}},
    {0x2240, {"emcy-2240", "earth leakage inside the device", "утечка на землю внутри устройства"}},
    {0x2250, {"emcy-2250", "short circuit inside the device", "короткое замыкание внутри устройства"}},
    {0x2300, {"emcy-2300", "current on the device output side", "ток на выходе устройства"}},
    {0x2310, {"emcy-2310", "continuous over-current, output side", "длительный сверхток на выходе"}},
    {0x2320,
     {"emcy-2320", "short circuit or earth leakage, output side", "замыкание или утечка на землю на выходе"}},
    {0x2330, {"emcy-2330", "earth leakage, output side", "утечка на землю на выходе"}},
    {0x2340, {"emcy-2340", "short circuit, output side", "короткое замыкание на выходе"}},
    {0x2350, {"emcy-2350", "load level I²t, thermal state", "перегрузка I²t, тепловое состояние"}},
    {0x3000, {"emcy-3000", "voltage", "ошибка по напряжению"}},
    {0x3100, {"emcy-3100", "mains voltage", "сетевое напряжение"}},
    {0x3110, {"emcy-3110", "mains over-voltage", "повышенное напряжение сети"}},
    {0x3120, {"emcy-3120", "mains under-voltage", "пониженное напряжение сети"}},
    {0x3130, {"emcy-3130", "phase failure", "обрыв фазы сети"}},
    {0x3134, {"emcy-3134", "phase sequence", "неверное чередование фаз"}},
    {0x3140, {"emcy-3140", "mains frequency", "частота сети вне допуска"}},
    {0x3200, {"emcy-3200", "voltage inside the device", "напряжение внутри устройства"}},
    {0x3210, {"emcy-3210", "DC link over-voltage", "повышенное напряжение звена постоянного тока"}},
    {0x3220, {"emcy-3220", "DC link under-voltage", "пониженное напряжение звена постоянного тока"}},
    {0x3230, {"emcy-3230", "load error", "ошибка нагрузки"}},
    {0x3300, {"emcy-3300", "output voltage", "выходное напряжение"}},
    {0x3310, {"emcy-3310", "output over-voltage", "повышенное выходное напряжение"}},
    {0x3320, {"emcy-3320", "armature circuit", "цепь якоря"}},
    {0x3330, {"emcy-3330", "field circuit", "цепь возбуждения"}},
    {0x4000, {"emcy-4000", "temperature", "ошибка по температуре"}},
    {0x4100, {"emcy-4100", "ambient temperature", "температура окружающей среды"}},
    {0x4110, {"emcy-4110", "excess ambient temperature", "слишком высокая температура окружающей среды"}},
    {0x4120, {"emcy-4120", "too low ambient temperature", "слишком низкая температура окружающей среды"}},
    {0x4200, {"emcy-4200", "device temperature", "температура устройства"}},
    {0x4210, {"emcy-4210", "excess device temperature", "перегрев устройства"}},
    {0x4220, {"emcy-4220", "too low device temperature", "слишком низкая температура устройства"}},
    {0x4300, {"emcy-4300", "drive temperature", "температура привода"}},
    {0x4310, {"emcy-4310", "excess drive (motor) temperature", "перегрев двигателя"}},
    {0x4320, {"emcy-4320", "too low drive (motor) temperature", "слишком низкая температура двигателя"}},
    {0x4400, {"emcy-4400", "supply temperature", "температура источника питания"}},
    {0x5000, {"emcy-5000", "device hardware", "аппаратная ошибка устройства"}},
    {0x5100, {"emcy-5100", "supply of the control section", "питание управляющей части"}},
    {0x5110,
     {"emcy-5110", "low supply voltage of the control section", "низкое напряжение управляющей части"}},
    {0x5120, {"emcy-5120", "supply of the intermediate circuit", "питание промежуточной цепи"}},
    {0x5200, {"emcy-5200", "control section hardware", "аппаратура управляющей части"}},
    {0x5210, {"emcy-5210", "measuring circuit", "измерительная цепь"}},
    {0x5220, {"emcy-5220", "computing circuit", "вычислительная цепь"}},
    {0x5300, {"emcy-5300", "operating unit", "пульт управления устройства"}},
    {0x5400, {"emcy-5400", "power section hardware", "силовая часть"}},
    {0x5410, {"emcy-5410", "output stages", "выходные каскады"}},
    {0x5420, {"emcy-5420", "chopper", "тормозной прерыватель"}},
    {0x5430, {"emcy-5430", "input stages", "входные каскады"}},
    {0x5440, {"emcy-5440", "contacts", "контакты"}},
    {0x5441,
     {"emcy-5441", "contact 1: enable or safety input", "контакт 1: вход разрешения или безопасности"}},
    {0x5450, {"emcy-5450", "fuses", "предохранители"}},
    {0x5500, {"emcy-5500", "data memory hardware", "аппаратура памяти данных"}},
    {0x5510, {"emcy-5510", "working memory (RAM)", "оперативная память"}},
    {0x5520, {"emcy-5520", "program memory (ROM)", "память программы"}},
    {0x5530, {"emcy-5530", "non-volatile data memory", "энергонезависимая память"}},
    {0x6000, {"emcy-6000", "device software", "программа устройства"}},
    {0x6010, {"emcy-6010", "software reset (watchdog)", "программный сброс (сторожевой таймер)"}},
    {0x6100, {"emcy-6100", "internal software", "внутренняя программа"}},
    {0x6200, {"emcy-6200", "user software", "программа пользователя"}},
    {0x6300, {"emcy-6300", "data record", "набор данных"}},
    {0x6310, {"emcy-6310", "loss of parameters", "потеря параметров"}},
    {0x6320, {"emcy-6320", "parameter error", "ошибка параметра"}},
    {0x7000, {"emcy-7000", "additional modules", "дополнительные модули"}},
    {0x7100, {"emcy-7100", "power module", "силовой модуль"}},
    {0x7110, {"emcy-7110", "brake chopper", "тормозной прерыватель"}},
    {0x7111, {"emcy-7111", "brake chopper failure", "отказ тормозного прерывателя"}},
    {0x7112, {"emcy-7112", "over-current of the brake chopper", "сверхток тормозного прерывателя"}},
    {0x7113, {"emcy-7113", "protective circuit of the brake chopper", "цепь защиты тормозного прерывателя"}},
    {0x7120, {"emcy-7120", "motor", "двигатель"}},
    {0x7121, {"emcy-7121", "motor blocked", "двигатель заблокирован"}},
    {0x7122, {"emcy-7122", "motor error or wrong commutation", "ошибка двигателя или коммутации"}},
    {0x7123, {"emcy-7123", "motor tilted", "опрокидывание двигателя"}},
    {0x7200, {"emcy-7200", "measuring module", "измерительный модуль"}},
    {0x7300, {"emcy-7300", "sensor", "датчик"}},
    {0x7301, {"emcy-7301", "tachometer fault", "неисправен тахогенератор"}},
    {0x7302, {"emcy-7302", "tachometer: wrong polarity", "тахогенератор: неверная полярность"}},
    {0x7303, {"emcy-7303", "resolver 1 fault", "неисправен резольвер 1"}},
    {0x7304, {"emcy-7304", "resolver 2 fault", "неисправен резольвер 2"}},
    {0x7305, {"emcy-7305", "incremental encoder 1 fault", "неисправен инкрементный датчик 1"}},
    {0x7306, {"emcy-7306", "incremental encoder 2 fault", "неисправен инкрементный датчик 2"}},
    {0x7307, {"emcy-7307", "incremental encoder 3 fault", "неисправен инкрементный датчик 3"}},
    {0x7310, {"emcy-7310", "speed", "ошибка скорости"}},
    {0x7320, {"emcy-7320", "position", "ошибка положения"}},
    {0x7400, {"emcy-7400", "computing module", "вычислительный модуль"}},
    {0x7500, {"emcy-7500", "communication module", "модуль связи"}},
    {0x7510, {"emcy-7510", "serial interface 1", "последовательный интерфейс 1"}},
    {0x7520, {"emcy-7520", "serial interface 2", "последовательный интерфейс 2"}},
    {0x7600, {"emcy-7600", "data storage", "накопитель данных"}},
    {0x8000, {"emcy-8000", "monitoring", "контроль"}},
    {0x8100, {"emcy-8100", "communication", "связь"}},
    {0x8110, {"emcy-8110", "CAN overrun (messages lost)", "переполнение CAN (сообщения потеряны)"}},
    {0x8120, {"emcy-8120", "CAN in error passive mode", "CAN в состоянии пассивной ошибки"}},
    {0x8130, {"emcy-8130", "life guard or heartbeat error", "ошибка контроля узла или heartbeat"}},
    {0x8140, {"emcy-8140", "recovered from bus off", "восстановление после отключения от шины (bus off)"}},
    {0x8150, {"emcy-8150", "CAN identifier collision", "столкновение идентификаторов CAN"}},
    {0x8200, {"emcy-8200", "protocol error", "ошибка протокола"}},
    {0x8210, {"emcy-8210", "PDO not processed: wrong length", "PDO не обработан: неверная длина"}},
    {0x8220, {"emcy-8220", "PDO length exceeded", "PDO длиннее, чем отображение"}},
    {0x8230,
     {"emcy-8230", "DAM multiplexed PDO: destination not available",
      "DAM MPDO: объект назначения недоступен"}},
    {0x8240, {"emcy-8240", "unexpected length of SYNC data", "неожиданная длина данных SYNC"}},
    {0x8250, {"emcy-8250", "RPDO timed out", "истекло время ожидания RPDO"}},
    {0x8300, {"emcy-8300", "torque control", "регулирование момента"}},
    {0x8311, {"emcy-8311", "excess torque", "превышение момента"}},
    {0x8312, {"emcy-8312", "difficult start-up", "затруднённый пуск"}},
    {0x8313, {"emcy-8313", "standstill torque", "момент при неподвижном двигателе"}},
    {0x8321, {"emcy-8321", "insufficient torque", "недостаточный момент"}},
    {0x8331, {"emcy-8331", "torque fault", "ошибка момента"}},
    {0x8400, {"emcy-8400", "velocity control", "регулирование скорости"}},
    {0x8500, {"emcy-8500", "position control", "регулирование положения"}},
    {0x8600, {"emcy-8600", "positioning", "позиционирование"}},
    {0x8611, {"emcy-8611", "following error", "ошибка рассогласования"}},
    {0x8612, {"emcy-8612", "reference limit", "предел задания"}},
    {0x8700, {"emcy-8700", "synchronisation", "синхронизация"}},
    {0x8800, {"emcy-8800", "winding control", "управление намоткой"}},
    {0x8900, {"emcy-8900", "process data monitoring", "контроль данных процесса"}},
    {0x8A00, {"emcy-8A00", "control", "управление"}},
    {0x9000, {"emcy-9000", "external error", "внешняя ошибка"}},
    {0xF000, {"emcy-F000", "additional functions", "дополнительные функции"}},
    {0xF001, {"emcy-F001", "deceleration", "торможение"}},
    {0xF002, {"emcy-F002", "sub-synchronous run", "подсинхронный ход"}},
    {0xF003, {"emcy-F003", "stroke operation", "ходовой режим"}},
    {0xF004, {"emcy-F004", "control of additional functions", "управление дополнительными функциями"}},
    {0xFF00,
     {"emcy-FF00", "device-specific error, see the drive's manual",
      "особая ошибка устройства, смотрите описание привода"}},
};
constexpr text::Entry kUnknown{"emcy-unknown", "error code not in CiA 301 or CiA 402-1",
                               "кода ошибки нет в CiA 301 и CiA 402-1"};

const text::Entry* find(std::uint16_t code) noexcept {
  const auto row = std::ranges::lower_bound(kRows, code, {}, &Row::code);
  return row != std::end(kRows) && row->code == code ? &row->entry : nullptr;
}

}  // namespace

const text::Entry& error_code_text(std::uint16_t code) noexcept {
  for (const unsigned mask : {0xFFFFu, 0xFFF0u, 0xFF00u, 0xF000u}) {
    const auto group = static_cast<std::uint16_t>(code & mask);
    if (group == 0 && code != 0) break;
    if (const text::Entry* entry = find(group)) return *entry;
  }
  return kUnknown;
}

}  // namespace servogate::canopen
