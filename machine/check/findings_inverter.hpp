// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Findings about inverters on Modbus and their spindles.
namespace servogate::machine::finding {

inline constexpr text::Entry kInverterStation{
    "machine.inverter_station",
    "spindle {0}: `inverter` names a station of kind modbus whose device is an inverter; '{1}' is none",
    "шпиндель {0}: `inverter` — имя станции вида modbus с устройством-преобразователем; «{1}» не такая"};
inline constexpr text::Entry kInverterTwice{"machine.inverter_twice",
                                            "inverter '{0}' already turns spindle {1}",
                                            "преобразователь «{0}» уже вращает шпиндель {1}"};
inline constexpr text::Entry kInverterIdle{
    "machine.inverter_idle",
    "station '{0}' is an inverter, and no [[spindle]] has inverter = \"{0}\": nobody would stop it",
    "станция «{0}» — преобразователь, и ни у одного [[spindle]] нет inverter = \"{0}\": его никто не "
    "остановит"};
inline constexpr text::Entry kInverterMotor{
    "machine.inverter_motor",
    "spindle {0}: `{1}` is needed with `inverter`, as it stands on the nameplate of the motor",
    "шпиндель {0}: при `inverter` нужен `{1}`, с таблички двигателя"};
inline constexpr text::Entry kInverterFrequency{
    "machine.inverter_frequency",
    "spindle {0}: {1} rpm are {2} Hz, which does not fit into its register: at most {3} Hz",
    "шпиндель {0}: {1} об/мин — это {2} Гц, в регистр столько не помещается: не более {3} Гц"};
inline constexpr text::Entry kInverterOnly{"machine.inverter_only",
                                           "spindle {0}: `{1}` belongs to a spindle with `inverter`",
                                           "шпиндель {0}: «{1}» бывает только вместе с `inverter`"};
inline constexpr text::Entry kInverterNoEncoder{
    "machine.inverter_no_encoder",
    "spindle {0}: `{1}` needs a drive with an encoder; an inverter tells its frequency only",
    "шпиндель {0}: для «{1}» нужен привод с датчиком; преобразователь сообщает только частоту"};
inline constexpr text::Entry kInverterSerial{
    "machine.inverter_serial",
    "station '{0}': the requests of a Huanyang inverter go over a serial line (rtu:) only; '{1}' is {2}",
    "станция «{0}»: запросы преобразователя Huanyang идут только по последовательной линии (rtu:); «{1}» — "
    "это {2}"};
inline constexpr text::Entry kInverterKey{"machine.inverter_key", "`inverter.{0}`: {1}",
                                          "`inverter.{0}`: {1}"};
inline constexpr text::Entry kNoInverter{"machine.no_inverter",
                                         "a device of kind inverter needs [inverter] with its registers",
                                         "устройству вида inverter нужна таблица [inverter] с регистрами"};

}  // namespace servogate::machine::finding
