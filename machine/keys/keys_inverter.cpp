// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<InverterProtocol>() {
  static constexpr std::string_view kNames[] = {"modbus", "huanyang"};
  return kNames;
}

template <>
const Section& section_of<InverterRequired>() {
  using C = InverterRequired;
  static constexpr Rule kWord{.min = 0, .max = 65535};
  static const Key keys[] = {
      key<&C::address>("address", {.min = 0, .max = 65535, .required = true}, "address of the register",
                       "адрес регистра"),
      key<&C::low>("low", kWord, "smallest value that is right", "наименьшее верное значение"),
      key<&C::high>("high", kWord, "largest value that is right", "наибольшее верное значение"),
      key<&C::english>("english", {.required = true}, "what it is and how it is set, in English",
                       "что это и как задать, по-английски"),
      key<&C::russian>("russian", {.required = true}, "the same in Russian", "то же по-русски"),
  };
  static const Section section{"a register without whose value nothing turns",
                               "регистр, без верного значения которого ничто не вращается", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<InverterMap>() {
  using C = InverterMap;
  static constexpr Rule kWord{.min = 0, .max = 65535};
  static constexpr Rule kPerhaps{.min = -1, .max = 65535};
  static constexpr Rule kHertz{.unit = Unit::hertz, .min = 0, .max = 1000, .above_min = true};
  static const Key keys[] = {
      key<&C::protocol>("protocol", {}, "huanyang: requests of its own in frames of Modbus RTU",
                        "huanyang: собственные запросы в кадрах Modbus RTU"),
      key<&C::read_function>("read_function", {.min = 3, .max = 4},
                             "3 or 4, with which its registers are read",
                             "функция чтения регистров, 3 или 4"),
      key<&C::write_function>("write_function", {.min = 6, .max = 16},
                              "6 or 16, with which its registers are written",
                              "функция записи регистров, 6 или 16"),
      key<&C::command>("command", {.min = 0, .max = 65535, .required = true},
                       "address of the command: run and stop", "адрес команды: пуск и останов"),
      key<&C::forward>("forward", kWord, "command that turns forward", "команда вращения вперёд"),
      key<&C::reverse>("reverse", kPerhaps, "command that turns backward; -1: it cannot",
                       "команда вращения назад; -1: не умеет"),
      key<&C::stop>("stop", kWord, "command that ramps down and stops", "команда останова по темпу"),
      key<&C::frequency>("frequency", {.min = 0, .max = 65535, .required = true},
                         "address of the frequency that is wanted", "адрес задания частоты"),
      key<&C::frequency_unit>("frequency_unit", kHertz, "frequency of a 1 in it", "частота на единицу кода"),
      key<&C::reset>("reset", kPerhaps, "value that clears a trip; -1: it cannot be cleared over the line",
                     "значение сброса аварии; -1: по линии не сбрасывается"),
      key<&C::reset_address>("reset_address", kPerhaps,
                             "address for it, otherwise 0; -1: it is a value of the command",
                             "адрес сброса, в остальное время там 0; -1: это значение команды"),
      key<&C::status>("status", kPerhaps,
                      "address of the status; huanyang: 3, the answer to the command; -1: none",
                      "адрес состояния; huanyang: 3, ответ на команду; -1: нет"),
      key<&C::running>("running", kWord, "[bits, value] of the status while the motor is fed",
                       "[биты, значение] состояния, пока на двигатель подаётся питание"),
      key<&C::at_speed>("at_speed", kWord, "[bits, value] at the wanted frequency",
                        "[биты, значение] при заданной частоте"),
      key<&C::reversed>("reversed", kWord, "[bits, value] while it turns backward",
                        "[биты, значение] при вращении назад"),
      key<&C::tripped>("tripped", kWord, "[bits, value] while it has tripped; without: the trip code says so",
                       "[биты, значение] при аварии; без этого её показывает код аварии"),
      key<&C::ready>("ready", kWord, "[bits, value] while it would run", "[биты, значение] готовности"),
      key<&C::output>("output", {.min = 0, .max = 65535, .required = true}, "address of the output frequency",
                      "адрес выходной частоты"),
      key<&C::output_unit>("output_unit", kHertz, "frequency of a 1 in it", "частота на единицу кода"),
      key<&C::fault>("fault", kPerhaps, "address of the trip code, 0: no trip; -1: none",
                     "адрес кода аварии, 0: нет аварии; -1: нет такого регистра"),
      key<&C::fault_mask>("fault_mask", {.min = 1, .max = 65535}, "bits of the trip code",
                          "биты кода аварии"),
      key<&C::read_together>(
          "read_together", {},
          "status, output and trip code are read in one request where 16 registers hold them",
          "состояние, выход и код аварии читаются одним запросом, если умещаются в 16 "
          "регистрах"),
      key<&C::silence_fault>("silence_fault", kWord,
                             "trip code of the simulated one when nobody asks it any more; 0: it just stops",
                             "код аварии имитатора, когда его перестают опрашивать; 0: просто "
                             "останавливается"),
      key<&C::required>("required", {}, "registers that must be right",
                        "регистры, которые должны быть верны"),
  };
  static const Section section{"an inverter: its registers as its manual has them",
                               "преобразователь: регистры по его руководству", keys, &default_object<C>};
  return section;
}

}  // namespace servogate::machine
