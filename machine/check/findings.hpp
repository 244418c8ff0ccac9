// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Texts of everything that the checks of a whole machine can find.
namespace servogate::machine::finding {

// Names
inline constexpr text::Entry kNodeFile{"machine.node_file", "\"{0}\" cannot be read: {1}",
                                       "не удалось прочитать «{0}»: {1}"};
inline constexpr text::Entry kProgramVersion{
    "machine.program_version", "{0}: a program needs program_version, which 1F56h shows once it runs",
    "{0}: для программы нужен program_version, который после запуска показывает 1F56h"};
inline constexpr text::Entry kConfigurationDate{
    "machine.configuration_date", "\"{0}\" is no date from 1984 on; written as \"2026-11-22 14:30:00\"",
    "«{0}» не дата с 1984 года; пишется \"2026-11-22 14:30:00\""};
inline constexpr text::Entry kNoConfiguration{"machine.no_configuration",
                                              "{0} acts with `configuration` only",
                                              "{0} действует только вместе с `configuration`"};
inline constexpr text::Entry kEmptyConfiguration{
    "machine.empty_configuration", "\"{0}\" has no value that differs from its default and may be written",
    "в «{0}» нет значений, отличных от исходных и доступных для записи"};
inline constexpr text::Entry kBadName{
    "machine.bad_name",
    "\"{0}\" is no name: letters A-Z a-z, digits and _ are allowed, not beginning with a digit",
    "«{0}» не годится как имя: допустимы буквы A-Z a-z, цифры и _, первой не может быть цифра"};
inline constexpr text::Entry kBadLetter{"machine.bad_letter",
                                        "axis letter \"{0}\": one of A to Z is expected",
                                        "буква оси «{0}»: ожидалась одна из A ... Z"};
inline constexpr text::Entry kLetterTaken{
    "machine.letter_taken",
    "axis letter \"{0}\" is no axis in programs of \"{1}\": there an axis is one of {2}",
    "буква оси «{0}»: в программах «{1}» она не обозначает ось; осью может быть одна из {2}"};
inline constexpr text::Entry kEstopShared{
    "machine.estop_shared", "estop \"{0}\" is {1} already; the emergency-stop chain has an input of its own",
    "estop «{0}» — уже {1}; у цепи аварийного останова свой вход"};
inline constexpr text::Entry kTwice{"machine.twice", "{0} \"{1}\" is already declared in line {2}",
                                    "{0} «{1}»: повторяет описание из строки {2}"};
inline constexpr text::Entry kBadChannel{"machine.bad_channel",
                                         "channel \"{0}\": expected di, dq, ai or aq with a number, like di3",
                                         "канал «{0}»: ожидалось di, dq, ai или aq с номером, например di3"};
inline constexpr text::Entry kChannelOutside{"machine.channel_outside", "channel \"{0}\": {1} has {2}",
                                             "канал «{0}»: {1}: есть {2}"};
inline constexpr text::Entry kReservedChannel{
    "machine.reserved_channel", "channel \"{0}\": bits 4 to 15 of 60FDh are reserved by CiA 402",
    "канал «{0}»: биты 4 ... 15 объекта 60FDh зарезервированы в CiA 402"};
inline constexpr text::Entry kPointNotMapped{
    "machine.point_not_mapped",
    "channel \"{0}\": {1} is in no {2} of device file \"{3}\"; add it, or take a device file that has it",
    "канал «{0}»: {1} нет ни в одном {2} файла устройства «{3}»; добавьте его или выберите другой файл"};
inline constexpr text::Entry kNoSuchChannel{"machine.no_such_channel",
                                            "channel \"{0}\": a {1} has no such channel",
                                            "канал «{0}»: у устройства вида {1} такого канала нет"};
inline constexpr text::Entry kStationNodeTwice{"machine.station_node_twice",
                                               "node \"{0}\" already has its points in station \"{1}\"",
                                               "сигналы узла «{0}» уже описаны в станции «{1}»"};
inline constexpr text::Entry kNodeNoStation{
    "machine.node_no_station",
    "node \"{0}\" is an I/O module, but no station of kind canopen names it: it will not be started",
    "узел «{0}» — модуль ввода-вывода, но ни одна станция вида canopen его не называет: он не будет запущен"};
inline constexpr text::Entry kLossRange{"machine.loss_range",
                                        "\"{0}\": loss {1} is no value of the channel: {2}",
                                        "«{0}»: loss {1} не значение канала: {2}"};
inline constexpr text::Entry kZeroScale{"machine.zero_scale", "\"{0}\": scale 0 makes every value the same",
                                        "«{0}»: scale 0 делает все значения одинаковыми"};
inline constexpr text::Entry kPointNoAxis{
    "machine.point_no_axis",
    "node \"{0}\" is the drive of no axis and no spindle: nothing reads or writes its points",
    "узел «{0}» не является приводом ни оси, ни шпинделя: его точки никто не читает и не пишет"};
inline constexpr text::Entry kBrakeBit{
    "machine.brake_bit", "channel \"{0}\": bit {1} of 60FEh:01 works the brake (device file \"{2}\")",
    "канал «{0}»: бит {1} объекта 60FEh:01 управляет тормозом (файл устройства «{2}»)"};
inline constexpr text::Entry kMaskedOutput{
    "machine.masked_output", "channel \"{0}\": the mask 60FEh:02 of device file \"{2}\" leaves out bit {1}",
    "канал «{0}»: маска 60FEh:02 файла устройства «{2}» не содержит бит {1}"};
inline constexpr text::Entry kDebounceKind{"machine.debounce_kind",
                                           "`debounce`: channel \"{0}\" is no digital input",
                                           "`debounce`: канал «{0}» не является дискретным входом"};
inline constexpr text::Entry kStationUrl{
    "machine.station_url",
    "`url` of a Modbus station is a key of its line now: [[line]] with name = \"{1}\" and url = \"{0}\", and "
    "line = \"{1}\" here",
    "`url` станции Modbus теперь задаётся у её линии: [[line]] с name = \"{1}\" и url = \"{0}\", а здесь "
    "line = \"{1}\""};
inline constexpr text::Entry kNoLine{"machine.no_line", "no [[line]] has the name \"{0}\"",
                                     "нет [[line]] с именем «{0}»"};
inline constexpr text::Entry kUnitTwice{"machine.unit_twice",
                                        "unit {0} of line \"{1}\" is that of station \"{2}\" already",
                                        "адрес {0} на линии «{1}» уже занят станцией «{2}»"};
inline constexpr text::Entry kOneDevice{
    "machine.one_device",
    "line \"{0}\" is on the same device as line \"{1}\" in line {2} of the file: units on one wire share "
    "one [[line]]",
    "линия «{0}» — на том же устройстве, что и линия «{1}» в строке {2} файла: станции одного провода — на "
    "одной [[line]]"};
inline constexpr text::Entry kHysteresisKind{"machine.hysteresis_kind",
                                             "`hysteresis`: channel \"{0}\" is no analog input",
                                             "`hysteresis`: канал «{0}» не является аналоговым входом"};
inline constexpr text::Entry kAnalogOnGpio{"machine.analog_on_gpio",
                                           "channel \"{0}\": a {1} station has digital channels only; a gpio "
                                           "station counts encoders, too: ai with `b_line`",
                                           "канал «{0}»: у станции вида {1} только дискретные каналы; "
                                           "станция gpio ещё считает датчики: ai с `b_line`"};
// References
inline constexpr text::Entry kNoSuch{"machine.no_such", "`{0}`: there is no {1} \"{2}\"{3}",
                                     "«{0}»: {1} «{2}» не существует{3}"};
inline constexpr text::Entry kWrongPoint{"machine.wrong_point", "`{0}`: \"{1}\" is {2}, expected {3}",
                                         "«{0}»: «{1}» — {2}, ожидался {3}"};
inline constexpr text::Entry kNoFile{"machine.no_file", "`{0}`: file \"{1}\" does not exist",
                                     "«{0}»: файла «{1}» нет"};
inline constexpr text::Entry kUnreadableFile{"machine.unreadable_file",
                                             "`{0}`: file \"{1}\" cannot be read: {2}",
                                             "«{0}»: файл «{1}» не читается: {2}"};
inline constexpr text::Entry kNoDevice{"machine.no_device",
                                       "device file \"{0}.toml\" is not found; looked in {1}",
                                       "файл устройства «{0}.toml» не найден; просмотрены: {1}"};
inline constexpr text::Entry kDeviceBroken{"machine.device_broken", "device file {0} has errors",
                                           "в файле устройства {0} есть ошибки"};
inline constexpr text::Entry kWrongDevice{"machine.wrong_device",
                                          "device \"{0}\" is a {1}, {2} is expected here",
                                          "устройство «{0}» — {1}, здесь ожидалось: {2}"};
inline constexpr text::Entry kOneWire{
    "machine.one_wire",
    "bus \"{0}\" is the same wire as bus \"{1}\" in line {2}: each bus needs one of its own",
    "шина «{0}» — тот же провод, что и шина «{1}» в строке {2}: каждой нужен свой"};
inline constexpr text::Entry kNodeTwice{"machine.node_used_twice", "drive \"{0}\" already belongs to {1}",
                                        "привод «{0}» уже принадлежит: {1}"};
inline constexpr text::Entry kPerhapsReal{
    "machine.perhaps_real",
    "bus \"{0}\": behind {1} there may be real devices, so `simulated` cannot hold for it",
    "шина «{0}»: за {1} могут быть настоящие устройства, `simulated` к ней неприменимо"};
// Places
inline constexpr text::Entry kOverlap{"machine.overlap", "{0} of \"{1}\" overlaps {2} of \"{3}\" (line {4})",
                                      "{0} сигнала «{1}» перекрывает {2} сигнала «{3}» (строка {4})"};
inline constexpr text::Entry kInterface{
    "machine.interface_area", "{0} of \"{1}\" lies in the interface of packet K: {2} is {3}",
    "{0} сигнала «{1}» лежит в области обмена пакета K: {2} занимает {3}"};
inline constexpr text::Entry kInterfaceReserved{
    "machine.interface_area", "{0} of \"{1}\" lies in bytes {2} to {3} of packet K, which the control keeps",
    "{0} сигнала «{1}» лежит в байтах {2}-{3} пакета K, занятых системой"};
inline constexpr text::Entry kOutside{"machine.outside_packet",
                                      "{0} of \"{1}\" is outside its packet of {2} bytes",
                                      "{0} сигнала «{1}» вне своего пакета из {2} байт"};
inline constexpr text::Entry kPointPacket{"machine.point_packet",
                                          "{0} of \"{1}\": a signal lies in packet A (SA...)",
                                          "{0} сигнала «{1}»: сигнал лежит в пакете A (SA...)"};
inline constexpr text::Entry kPointFormat{"machine.point_format", "{0} of \"{1}\": {2} needs {3}",
                                          "{0} сигнала «{1}»: {2}: здесь ожидается {3}"};
inline constexpr text::Entry kInputWriter{"machine.writer", "\"{0}\" is an input; its writer cannot be {1}",
                                          "«{0}» — вход; писать его не может {1}"};
inline constexpr text::Entry kOutputWriter{"machine.writer",
                                           "\"{0}\" is an output; its writer is nc, plc or program",
                                           "«{0}» — выход; пишет его nc, plc или program"};
inline constexpr text::Entry kFreeWriter{
    "machine.writer", "\"{0}\" is a free symbol; nothing reads it in, so its writer cannot be input",
    "«{0}» — свободный символ; его ничто не вводит, поэтому input невозможен"};

}  // namespace servogate::machine::finding
