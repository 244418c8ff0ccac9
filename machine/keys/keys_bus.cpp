// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {
constexpr double kLargestSignal = 1e12;  ///< of an analog point, whatever its unit
}  // namespace

template <>
std::span<const std::string_view> choices_of<StationKind>() {
  static constexpr std::string_view kNames[] = {"modbus", "gpio", "drive", "canopen", "board"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<image::Writer>() {
  static constexpr std::string_view kNames[] = {"nc", "plc", "input", "program"};
  return kNames;
}

template <>
std::span<const std::string_view> choices_of<LineParity>() {
  static constexpr std::string_view kNames[] = {"none", "even", "odd"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<PointBias>() {
  static constexpr std::string_view kNames[] = {"as_is", "off", "up", "down"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<LossReaction>() {
  static constexpr std::string_view kNames[] = {"stop_on_path", "stop_axes", "stop_and_power_off",
                                                "quick_stop", "power_off"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<ProgramWhen>() {
  static constexpr std::string_view kNames[] = {"other_version", "never"};
  return kNames;
}

template <>
const Section& section_of<NodeConfig>() {
  using C = NodeConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name; others refer to the node as \"bus.name\"",
                    "имя; на узел ссылаются как \"шина.имя\""),
      key<&C::id>("id", {.min = 1, .max = 126, .required = true}, "CANopen node-ID; 127 is the control's own",
                  "номер узла CANopen (Node-ID); 127 занят самим управлением"),
      key<&C::device>("device", {.required = true, .refers = Refers::device}, "device file, without .toml",
                      "файл устройства, без .toml"),
      key<&C::heartbeat>("heartbeat", {.unit = Unit::second, .min = 0.001, .max = 60},
                         "period of the node's heartbeat, not below the cycle time; the control's own is the "
                         "shortest of its bus",
                         "период heartbeat узла, не короче цикла; у управления — самый короткий на его шине"),
      key<&C::loss_cycles>("loss_cycles", {.min = 1, .max = 1000},
                           "cycles without process data until the node counts as lost",
                           "число циклов без данных процесса, после которого узел считается потерянным"),
      key<&C::boot_timeout>("boot_timeout", {.unit = Unit::second, .min = 0, .max = 600},
                            "wait for the boot-up message and for Operational; 0: 2 s",
                            "ожидание сообщения о загрузке и состояния Operational; 0: 2 с"),
      key<&C::boot_attempts>("boot_attempts", {.min = 0, .max = 1000},
                             "attempts to boot a silent node before that is an alarm; 0: 3",
                             "число попыток загрузки молчащего узла до аварии; 0: 3"),
      key<&C::sdo_timeout>("sdo_timeout", {.unit = Unit::second, .min = 0, .max = 60},
                           "wait for each answer of an SDO transfer; 0: 200 ms",
                           "ожидание каждого ответа на обмен SDO; 0: 200 мс"),
      key<&C::sdo_retries>("sdo_retries", {.min = 0, .max = 100},
                           "repetitions of an SDO transfer that got no answer",
                           "число повторов обмена SDO, оставшегося без ответа"),
      key<&C::software_version>("software_version", {}, "100Ah at boot, to the letter; empty: any",
                                "100Ah при запуске, буква в букву; пусто: любая"),
      key<&C::loss_reaction>(
          "loss_reaction", {},
          "what the loss of this node makes the machine do: the other axes stop together on "
          "the path, or more severely",
          "что делает станок при потере этого узла: остальные оси останавливаются вместе на "
          "траектории или строже"),
      key<&C::program>("program", {},
                       "program file for the device (1F50h), from this file's folder; needs "
                       "program_version",
                       "файл программы устройства (1F50h), от папки этого файла; нужен program_version"),
      key<&C::program_version>("program_version", {.min = -1, .max = 4294967295.0},
                               "1F56h that the right program shows; -1: not checked",
                               "1F56h нужной программы; -1: не проверяется"),
      key<&C::program_number>("program_number", {.min = 1, .max = 254},
                              "sub-index of 1F50h, 1F51h, 1F56h and 1F57h",
                              "субиндекс 1F50h, 1F51h, 1F56h и 1F57h"),
      key<&C::program_when>(
          "program_when", {},
          "when the program is written: where 1F56h tells another version, or never: then the "
          "node is refused",
          "когда записывать программу: если 1F56h показывает другую версию, или никогда: тогда "
          "узел отклоняется"),
      key<&C::program_timeout>("program_timeout", {.unit = Unit::second, .min = 1, .max = 3600},
                               "for clearing and for writing the flash (1F57h)",
                               "на стирание и на запись памяти (1F57h)"),
      key<&C::configuration>("configuration", {},
                             "DCF from this file's folder: its values are written at boot, before the PDOs",
                             "файл DCF от папки этого файла: значения записываются при запуске до PDO"),
      key<&C::configuration_date>(
          "configuration_date", {},
          "date of the configuration, \"2026-11-22 14:30:00\": it is written only where "
          "1020h tells another one; empty: at every boot",
          "дата конфигурации, \"2026-11-22 14:30:00\": записывается, только если 1020h "
          "показывает другую; пусто: при каждом запуске"),
      key<&C::configuration_store>("configuration_store", {},
                                   "the device is told to store what was written (1010h:01), 1020h with it",
                                   "устройству приказывают сохранить записанное (1010h:01) вместе с 1020h"),
      key<&C::unsupervised>("unsupervised", {},
                            "the drive may run although it would not notice that the control has died",
                            "привод может работать, хотя не заметит гибели управления"),
      key<&C::silent_status>(
          "silent_status", {},
          "the drive may send its statusword on event only (transmission 0, 254 or 255 without `event`): "
          "that it "
          "has fallen silent is then seen by its heartbeat only",
          "привод может передавать слово состояния только по событию (тип 0, 254 или 255 без `event`): его "
          "молчание тогда видно только по heartbeat"),
      key<&C::objects>(
          "objects", {}, "objects written at boot after the device file's own: \"6065:00/32\" = value",
          "объекты, записываемые при запуске после объектов файла устройства: \"6065:00/32\" = значение"),
  };
  static const Section section{"a node of the bus", "узел шины", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<BusConfig>() {
  using C = BusConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name of the segment", "имя сегмента"),
      key<&C::url>(
          "url", {.required = true},
          "transport: mock:NAME, socketcan:IF, socketcand:HOST:PORT/NAME, socketcand:unix:PATH/NAME, "
          "lockstep:HOST:PORT/NAME, udp:GROUP:PORT, gsusb:SERIAL, slcan:PATH",
          "транспорт: mock:ИМЯ, socketcan:IF, socketcand:ХОСТ:ПОРТ/ИМЯ, socketcand:unix:ПУТЬ/ИМЯ, "
          "lockstep:ХОСТ:ПОРТ/ИМЯ, udp:ГРУППА:ПОРТ, gsusb:СЕРИЙНЫЙ, slcan:ПУТЬ"),
      key<&C::bit_rate>("bit_rate", {.unit = Unit::bit_per_s, .min = 10000, .max = 1000000, .required = true},
                        "bit rate of the segment", "скорость сегмента"),
      key<&C::simulated>(
          "simulated", {},
          "every device on it is simulated (in other processes); refused where a real bus may be behind it",
          "все устройства на ней имитированы (в других процессах); отказ, если за ней может быть "
          "настоящая шина"),
      key<&C::sync_counter>("sync_counter", {}, "SYNC carries a counter from 1 to 240 (1019h)",
                            "SYNC со счётчиком от 1 до 240 (1019h)"),
      key<&C::sync_window>("sync_window", {.unit = Unit::second, .min = 0, .max = 1},
                           "synchronous window of the nodes (1007h); 0: none",
                           "окно синхронных PDO узлов (1007h); 0: нет"),
      key<&C::time_period>("time_period", {.unit = Unit::second, .min = 0, .max = 3600},
                           "period of the TIME message; 0: none", "период сообщения TIME; 0: нет"),
      key<&C::nodes>("node", {}, "nodes", "узлы"),
  };
  static const Section section{"a CAN segment", "сегмент CAN", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<PointConfig>() {
  using C = PointConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "symbol of the signal", "символьное имя сигнала"),
      key<&C::channel_text>(
          "channel", {.required = true},
          "channel of the station: di0, dq0 (digital), ai0, aq0 (analog); i = input, q = output",
          "канал станции: di0, dq0 (дискретные), ai0, aq0 (аналоговые); i = вход, q = выход"),
      key<&C::place>("place", {.required = true}, "place in packet A: SA16, analog as a word: SA16.IN",
                     "место в пакете A: SA16, аналоговый сигнал словом: SA16.IN"),
      key<&C::inverted>("inverted", {}, "the wire's 1 is 0 in packet A", "1 на проводе есть 0 в пакете A"),
      key<&C::loss>("loss", {.min = -kLargestSignal, .max = kLargestSignal},
                    "value while the station is lost: in packet A for an input, on the wire for an output",
                    "значение при потере станции: для входа в пакете A, для выхода на проводе"),
      key<&C::writer>("writer", {.computed = true}, "who writes it; input for inputs, plc for outputs",
                      "кто пишет; input для входов, plc для выходов"),
      key<&C::hold>("hold", {}, "keep the last value while the station is lost, instead of `loss`",
                    "при потере станции сохранять последнее значение вместо `loss`"),
      key<&C::scale>("scale", {.min = -kLargestSignal, .max = kLargestSignal},
                     "analog: value in packet A = raw * scale + shift",
                     "аналоговый: значение в пакете A = код * scale + shift"),
      key<&C::shift>("shift", {.min = -kLargestSignal, .max = kLargestSignal}, "see scale", "см. scale"),
      key<&C::debounce>("debounce", {.unit = Unit::second, .min = 0, .max = 1}, "time a change must last",
                        "время, которое изменение должно продержаться"),
      key<&C::hysteresis>("hysteresis", {.min = 0, .max = kLargestSignal},
                          "analog input: a change smaller than this is not shown, in the unit of packet A",
                          "аналоговый вход: меньшее изменение не показывается, в единицах пакета A"),
      key<&C::bias>(
          "bias", {},
          "gpio input: the resistor of its line inside the chip; as_is: as the board's firmware left it",
          "вход gpio: резистор линии внутри микросхемы; as_is: как его оставила прошивка платы"),
      key<&C::edges>(
          "edges", {},
          "gpio, board, di: its edges are taken with their times; homing then meets the edge of its switch "
          "between two cycles",
          "gpio, board, di: фронты берутся с их временем; тогда при выходе в ноль фронт выключателя "
          "определяется между циклами"),
      key<&C::b_line>(
          "b_line", {.min = -1, .max = 4095},
          "gpio, ai: counts of a handwheel or encoder of two tracks: track A is the line of `channel`, "
          "track B this one; four counts a period; -1: none",
          "gpio, ai: отсчёты маховичка или датчика с двумя дорожками: дорожка A — линия `channel`, "
          "дорожка B — эта; четыре отсчёта на период; -1: нет"),
      key<&C::comment>("comment", {}, "meaning for people", "пояснение для людей"),
  };
  static const Section section{"a wire of the machine", "сигнал станка", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<LineConfig>() {
  using C = LineConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name of the line", "имя линии"),
      key<&C::url>("url", {.required = true}, "what carries the line: mock:NAME, tcp:HOST:PORT, rtu:/dev/...",
                   "чем передаётся линия: mock:ИМЯ, tcp:ХОСТ:ПОРТ, rtu:/dev/..."),
      key<&C::baud>("baud", {.unit = Unit::bit_per_s, .min = 1200, .max = 4000000},
                    "rate of a serial line; a mock line takes the same time for its characters",
                    "скорость последовательной линии; имитатор тратит на символы столько же времени"),
      key<&C::parity>("parity", {}, "rtu: even is the standard's; many devices are delivered with none",
                      "rtu: even — по стандарту; многие устройства поставляются с none"),
      key<&C::stop_bits>("stop_bits", {.min = 0, .max = 2},
                         "rtu: stop bits; 0: as the standard says, 1 with parity and 2 without",
                         "rtu: стоповые биты; 0: по стандарту, 1 с чётностью и 2 без неё"),
      key<&C::timeout>("timeout", {.unit = Unit::second, .min = 0.001, .max = 60},
                       "an answer later than this is lost", "ответ позже этого времени считается потерянным"),
  };
  static const Section section{"a Modbus line: one wire or one TCP peer with its units",
                               "линия Modbus: один провод или один узел TCP со своими станциями", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<StationConfig>() {
  using C = StationConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name of the station", "имя станции"),
      key<&C::kind>("kind", {.required = true}, "what carries the signals", "чем передаются сигналы"),
      key<&C::line>("line", {}, "modbus: the line that it is on, by name", "modbus: имя линии станции"),
      key<&C::url>("url", {}, "gpio: the chip: mock:NAME, chip:LABEL; board: mock:NAME, usb:SERIAL, usb:any",
                   "gpio: микросхема: mock:ИМЯ, chip:МЕТКА; board: mock:ИМЯ, usb:СЕРИЙНЫЙ, usb:any"),
      key<&C::node>("node", {.refers = Refers::node}, "kinds drive and canopen: the node as \"bus.node\"",
                    "виды drive и canopen: узел в виде \"шина.узел\""),
      key<&C::device>("device", {.refers = Refers::device}, "device file, without .toml",
                      "файл устройства, без .toml"),
      key<&C::unit>("unit", {.min = 1, .max = 247},
                    "Modbus unit identifier; 0 is for all units at once, and nobody answers it",
                    "адрес устройства Modbus; 0 — для всех сразу, на него никто не отвечает"),
      key<&C::period>("period", {.unit = Unit::second, .min = 0.001, .max = 10}, "time between polls, modbus",
                      "период опроса, modbus"),
      key<&C::watchdog>("watchdog", {.unit = Unit::second, .min = 0.002, .max = 1},
                        "board: without a command for this time it drops its outputs and enables",
                        "board: без команды в течение этого времени плата снимает выходы и разрешения"),
      key<&C::points>("points", {}, "the signals", "сигналы"),
  };
  static const MovedKey moved[] = {{"timeout", "`timeout` of its [[line]]", "`timeout` в её [[line]]"}};
  static const Section section{
      "a source of signals", "источник сигналов", keys, &default_object<C>, false, moved};
  return section;
}

template <>
const Section& section_of<SymbolConfig>() {
  using C = SymbolConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "symbol", "символьное имя"),
      key<&C::place>("place", {.required = true}, "place: SA200, SK8.RE", "адрес: SA200, SK8.RE"),
      key<&C::writer>("writer", {}, "who writes it", "кто пишет"),
      key<&C::comment>("comment", {}, "meaning for people", "пояснение для людей"),
  };
  static const Section section{"a free place with a name", "именованный свободный адрес", keys,
                               &default_object<C>};
  return section;
}

}  // namespace servogate::machine
