// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<DeviceKind>() {
  static constexpr std::string_view kNames[] = {"servo",           "stepper",  "spindle",
                                                "modbus_io",       "gpio",     "canopen_io",
                                                "canopen_encoder", "inverter", "pendant"};
  return kNames;
}

template <>
const Section& section_of<PdoConfig>() {
  using C = PdoConfig;
  static const Key keys[] = {
      key<&C::number>("number", {.min = 1, .max = 4, .required = true},
                      "number of the PDO, with its predefined identifier",
                      "номер PDO с предопределённым идентификатором"),
      key<&C::transmission>(
          "transmission", {.min = 0, .max = 255},
          "transmission type of CiA 301: 1-240 every n-th SYNC, 0 at SYNC on event, 254 or 255 "
          "on event; TPDO 252 or 253 when the control asks for it (remote frame)",
          "тип передачи по CiA 301: 1-240 каждый n-й SYNC, 0 по SYNC при событии, 254 или 255 "
          "по событию; TPDO 252 или 253 по запросу управления (удалённый кадр)"),
      key<&C::inhibit>("inhibit", {.unit = Unit::second, .min = 0, .max = 6.5535},
                       "inhibit time of an event-driven PDO", "время запрета повторной передачи по событию"),
      key<&C::event>(
          "event", {.unit = Unit::second, .min = 0, .max = 65.535},
          "TPDO on event: sent at least this often; TPDO 252 or 253: asked for this often; RPDO: "
          "deadline",
          "TPDO по событию: передаётся не реже; TPDO 252 или 253: запрашивается с этим периодом; RPDO: "
          "предельный срок"),
      key<&C::object_texts>("objects", {.required = true},
                            "mapped objects, \"index:subindex/bits\": \"6040:00/16\"",
                            "отображаемые объекты, \"индекс:субиндекс/биты\": \"6040:00/16\""),
  };
  static const Section section{"a process data object and its mapping",
                               "объект данных процесса и его отображение", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<MotorConfig>() {
  using C = MotorConfig;
  static const Key keys[] = {
      key<&C::max_speed>("max_speed", {.unit = Unit::rpm, .min = 0, .max = 200000},
                         "greatest speed; 0: not stated", "наибольшая частота вращения; 0: не указана"),
      key<&C::rated_torque>("rated_torque", {.unit = Unit::newton_metre, .min = 0, .max = 10000},
                            "rated torque", "номинальный момент"),
      key<&C::peak_torque>("peak_torque", {.unit = Unit::newton_metre, .min = 0, .max = 10000}, "peak torque",
                           "пиковый момент"),
      key<&C::inertia>("inertia", {.unit = Unit::kg_m2, .min = 0, .max = 100},
                       "moment of inertia of the rotor", "момент инерции ротора"),
      key<&C::counts_per_rev>("counts_per_rev", {.unit = Unit::counts, .min = 0, .max = 4294967296.0},
                              "counts per turn that the drive reports; 0: set by the machine file",
                              "дискрет на оборот, выдаваемых приводом; 0: задаёт файл станка"),
      key<&C::brake_output>(
          "brake_output", {},
          "the drive has an output for a holding brake; brake.drive_output of an axis needs it",
          "у привода есть выход удерживающего тормоза; нужен для brake.drive_output оси"),
  };
  static const Section section{"motor and drive", "двигатель и привод", keys, &default_object<C>};
  return section;
}

template <>
std::span<const std::string_view> choices_of<ConnectionLoss>() {
  static constexpr std::string_view kNames[] = {"none", "fault", "disable_voltage", "quick_stop"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<FaultResetBy>() {
  static constexpr std::string_view kNames[] = {"edge", "level"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<PositionMode>() {
  static constexpr std::string_view kNames[] = {"csp", "ip", "pp"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<SpeedMode>() {
  static constexpr std::string_view kNames[] = {"csv", "pv", "vl"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<TorqueMode>() {
  static constexpr std::string_view kNames[] = {"cst", "tq"};
  return kNames;
}

template <>
const Section& section_of<BehaviourConfig>() {
  using C = BehaviourConfig;
  static const Key keys[] = {
      key<&C::velocity_unit>("velocity_unit", {.min = 0, .max = 1e9, .above_min = true},
                             "one unit of 60FFh and 606Ch in counts/s",
                             "единица 60FFh и 606Ch в дискретах/с"),
      key<&C::velocity_in_rpm>("velocity_in_rpm", {}, "60FFh and 606Ch are in rpm", "60FFh и 606Ch в об/мин"),
      key<&C::acceleration_unit>("acceleration_unit", {.min = 0, .max = 1e9, .above_min = true},
                                 "one unit of 609Ah in counts/s2", "единица 609Ah в дискретах/с2"),
      key<&C::torque_unit>("torque_unit", {.min = 0, .max = 1000, .above_min = true},
                           "one unit of 6071h and 6077h in per mille of the rated torque",
                           "единица 6071h и 6077h в тысячных номинального момента"),
      key<&C::modes>("modes", {}, "modes that 6502h must have: pp, vl, pv, tq, hm, ip, csp, csv, cst",
                     "режимы, которые должны быть в 6502h: pp, vl, pv, tq, hm, ip, csp, csv, cst"),
      key<&C::check_modes>("check_modes", {}, "false: the drive has no 6502h", "false: у привода нет 6502h"),
      key<&C::position_mode>(
          "position_mode", {},
          "mode of the drive for a position command; ip needs 60C1:01/32 in an RPDO; with pp the "
          "drive forms the motion to each set-point by itself: for auxiliary axes only",
          "режим привода для задания положения; для ip нужен 60C1:01/32 в RPDO; при pp привод сам "
          "строит движение к каждому заданию: только для вспомогательных осей"),
      key<&C::ip_buffer>(
          "ip_buffer", {},
          "position_mode ip: the drive has 60C4h; the control closes its buffer (60C4h:06) until the "
          "drive interpolates",
          "position_mode ip: у привода есть 60C4h; управление держит его буфер закрытым (60C4h:06), "
          "пока привод не начнёт интерполяцию"),
      key<&C::ip_record>(
          "ip_record", {},
          "position_mode ip: what 60C1h:01, :02 ... take: position, velocity; each is to be mapped",
          "position_mode ip: что принимают 60C1h:01, :02 ...: position, velocity; каждый "
          "должен быть отображён"),
      key<&C::speed_mode>("speed_mode", {},
                          "mode of the drive for a speed command; in vl the unit of 6042h and 6044h is 1 rpm "
                          "of the motor, times "
                          "604Bh and 604Ch where `objects` has them",
                          "режим привода для задания скорости; в vl единица 6042h и 6044h — 1 об/мин "
                          "двигателя, умноженный на "
                          "604Bh и 604Ch, если они есть в `objects`"),
      key<&C::torque_mode>(
          "torque_mode", {},
          "mode of the drive for a torque command (torque_max of an axis): cyclic (cst) or profile "
          "torque (tq)",
          "режим привода для задания момента (torque_max оси): циклический (cst) или профильный "
          "(tq)"),
      key<&C::fault_reset>("fault_reset", {},
                           "a fault is reset by the edge or the level of controlword bit 7",
                           "ошибка сбрасывается фронтом или уровнем бита 7 управляющего слова"),
      key<&C::fault_reset_hold>("fault_reset_hold", {.unit = Unit::second, .min = 0.001, .max = 10},
                                "how long bit 7 stays set", "сколько бит 7 остаётся установленным"),
      key<&C::transition_timeout>("transition_timeout", {.unit = Unit::second, .min = 0.01, .max = 60},
                                  "a transition not followed this long counts as refused",
                                  "переход, не выполненный за это время, считается отклонённым"),
      key<&C::halt>("halt", {},
                    "the halt bit (6040h bit 8) stops a homing of the drive; false: its quick stop does, "
                    "which takes the power",
                    "бит останова (6040h, бит 8) останавливает выход в ноль силами привода; false: его "
                    "быстрый останов, снимающий питание"),
      key<&C::homing_methods>(
          "homing_methods", {},
          "methods of 6098h that the drive has, by their numbers in CiA 402-2; empty: not said",
          "методы 6098h, которые есть у привода, по номерам CiA 402-2; пусто: не сказано"),
      key<&C::homing_method_here>("homing_method_here", {.min = -128, .max = 127},
                                  "the drive's own number of method 37, the present position is home",
                                  "номер, под которым у привода метод 37 (ноль в текущем положении)"),
      key<&C::homing_method_none>("homing_method_none", {},
                                  "6098h takes 0, no homing; it is written where the control homes by itself "
                                  "and `modes` has hm",
                                  "6098h принимает 0, нет выхода в ноль; записывается, если ось ведёт в ноль "
                                  "управление и в `modes` есть hm"),
      key<&C::homing_method_list>("homing_method_list", {},
                                  "the method is looked for in 60E3h, where the drive has it",
                                  "метод ищется в 60E3h, если этот объект есть у привода"),
      key<&C::handover_counts>("handover_counts", {.unit = Unit::counts, .min = 0, .max = 4294967296.0},
                               "target against actual position at Operation enabled; 0: a quarter of a turn",
                               "отличие задания от положения при включении; 0: четверть оборота"),
      key<&C::brake_bit>("brake_bit", {.min = -1, .max = 31},
                         "bit of 60FEh:01 that works the brake; -1: none",
                         "бит 60FEh:01, управляющий тормозом; -1: нет"),
      key<&C::brake_bit_releases>("brake_bit_releases", {}, "1 in that bit releases the brake",
                                  "1 в этом бите отпускает тормоз"),
      key<&C::brake_interlock>(
          "brake_interlock", {},
          "the drive closes its brake by itself with its power stage, whatever 60FEh says: before the torque "
          "goes where it brakes first, else at once; false: the brake stays as the control left it",
          "привод сам зажимает тормоз вместе с силовой частью, что бы ни было в 60FEh: после торможения — до "
          "снятия момента, иначе сразу; false: тормоз остаётся, каким его оставила система"),
      key<&C::fixed_pdo_map>("fixed_pdo_map", {}, "the PDO map cannot be written, only compared",
                             "отображение PDO нельзя записать, только сравнить"),
      key<&C::sdo_only>(
          "sdo_only", {},
          "the drive has no process data: everything goes over SDO; needs position_mode pp, "
          "speed_mode pv or vl, and no rpdo and tpdo",
          "у привода нет данных процесса: всё идёт по SDO; нужны position_mode pp, speed_mode pv или "
          "vl, без rpdo и tpdo"),
      key<&C::interpolation_period>("interpolation_period", {}, "the drive has 60C2h",
                                    "у привода есть 60C2h"),
      key<&C::interpolation_base>("interpolation_base", {.min = -9, .max = 0}, "exponent of 60C2h:02",
                                  "показатель степени 60C2h:02"),
      key<&C::command_delay>("command_delay", {.min = 0, .max = 8},
                             "cycles from a target's SYNC to the actual value that follows it",
                             "циклов от SYNC задания до положения, которое ему отвечает"),
      key<&C::cycle_period>("cycle_period", {}, "1006h is to be written", "нужно записывать 1006h"),
      key<&C::heartbeat_consumer>("heartbeat_consumer", {}, "the drive has 1016h", "у привода есть 1016h"),
      key<&C::guard_time>("guard_time", {.unit = Unit::second, .min = 0, .max = 60},
                          "period of node guarding, for a drive without heartbeat (100Ch); 0: heartbeat",
                          "период опроса узла для привода без heartbeat (100Ch); 0: heartbeat"),
      key<&C::life_time_factor>("life_time_factor", {.min = 2, .max = 255},
                                "guard times of silence until either side counts as lost (100Dh)",
                                "число периодов опроса без ответа до потери связи (100Dh)"),
      key<&C::connection_loss>(
          "connection_loss", {},
          "what the drive does when its master falls silent (6007h); none: nothing, and of an "
          "I/O module that it has no 6206h, 6207h, 6443h and 6444h: its outputs then go where "
          "the module lets them, after the deadline (`event`) that each rpdo needs",
          "что делает привод, когда ведущий замолчал (6007h); none: ничего, а у модуля "
          "ввода-вывода нет 6206h, 6207h, 6443h и 6444h: выходы ведёт сам модуль по истечении "
          "срока (`event`), который нужен каждому rpdo"),
  };
  static const Section section{"where the drive differs from CiA 402", "отличия привода от CiA 402", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<DeviceError>() {
  using C = DeviceError;
  static const Key keys[] = {
      key<&C::code>("code", {.min = 0, .max = 65535, .required = true}, "error code of 603Fh and EMCY",
                    "код ошибки 603Fh и EMCY"),
      key<&C::english>("english", {.required = true}, "English text", "английский текст"),
      key<&C::russian>("russian", {.required = true}, "Russian text", "русский текст"),
  };
  static const Section section{"an error code in words", "код ошибки словами", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<ModbusMap>() {
  using C = ModbusMap;
  static constexpr Rule kCount{.min = 0, .max = 2000};
  static constexpr Rule kAddress{.min = 0, .max = 65535};
  static const Key keys[] = {
      key<&C::di_count>("di_count", kCount, "digital inputs", "дискретных входов"),
      key<&C::dq_count>("dq_count", kCount, "digital outputs", "дискретных выходов"),
      key<&C::ai_count>("ai_count", kCount, "analog inputs", "аналоговых входов"),
      key<&C::aq_count>("aq_count", kCount, "analog outputs", "аналоговых выходов"),
      key<&C::di_address>("di_address", kAddress, "address of the first digital input",
                          "адрес первого дискретного входа"),
      key<&C::dq_address>("dq_address", kAddress, "address of the first coil",
                          "адрес первого дискретного выхода"),
      key<&C::ai_address>("ai_address", kAddress, "address of the first input register",
                          "адрес первого входного регистра"),
      key<&C::aq_address>("aq_address", kAddress, "address of the first holding register",
                          "адрес первого регистра хранения"),
      key<&C::di_as_registers>(
          "di_as_registers", {},
          "digital inputs are bits of input registers (function 4), input 0 is bit 0 at di_address",
          "дискретные входы — биты входных регистров (функция 4), вход 0 — бит 0 по di_address"),
  };
  static const Section section{"channels and register addresses of a Modbus station",
                               "каналы и адреса регистров станции Modbus", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<GpioConfig>() {
  using C = GpioConfig;
  static const Key keys[] = {
      key<&C::lines>("lines", {.min = 1, .max = 4096},
                     "lines of the chip; the channel numbers of the machine file are below this",
                     "линий у микросхемы; номера каналов в файле станка меньше этого числа"),
  };
  static const Section section{"lines of a GPIO chip", "линии микросхемы GPIO", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<EncoderConfig>() {
  using C = EncoderConfig;
  static const Key keys[] = {
      key<&C::counts_per_rev>("counts_per_rev", {.unit = Unit::counts, .min = 0, .max = 4294967295.0},
                              "counts per turn, compared with 6501h at boot; 0: not checked",
                              "дискрет на оборот, сравниваются с 6501h при запуске; 0: не проверяется"),
      key<&C::revolutions>("revolutions", {.min = 0, .max = 65535},
                           "turns that it distinguishes, compared with 6502h at boot; 0: not checked",
                           "различаемых оборотов, сравниваются с 6502h при запуске; 0: не проверяется"),
  };
  static const Section section{"resolution of an encoder", "разрешение датчика положения", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<DeviceConfig>() {
  using C = DeviceConfig;
  static const Key keys[] = {
      key<&C::schema>("schema", {.min = 1, .max = 1, .required = true}, "version of this format",
                      "версия формата"),
      key<&C::name>("name", {.required = true}, "name of the device", "название устройства"),
      key<&C::kind>("kind", {.required = true}, "what it is", "что это"),
      key<&C::manufacturer>("manufacturer", {}, "who makes it", "изготовитель"),
      key<&C::description>("description", {}, "what it is for", "назначение"),
      key<&C::vendor_id>("vendor_id", {.min = 0, .max = 4294967295.0}, "1018h:01, 0: not checked",
                         "1018h:01, 0: не проверяется"),
      key<&C::product_code>("product_code", {.min = 0, .max = 4294967295.0}, "1018h:02, 0: not checked",
                            "1018h:02, 0: не проверяется"),
      key<&C::revision>("revision", {.min = 0, .max = 4294967295.0}, "1018h:03, 0: not checked",
                        "1018h:03, 0: не проверяется"),
      key<&C::motor>("motor", {}, "motor and drive", "двигатель и привод"),
      key<&C::rpdos>("rpdo", {}, "process data to the device", "данные процесса к устройству"),
      key<&C::tpdos>("tpdo", {}, "process data from the device", "данные процесса от устройства"),
      key<&C::objects>("objects", {}, "objects written at boot: \"6065:00/32\" = value; 8, 16 or 32 bits",
                       "объекты, записываемые при запуске: \"6065:00/32\" = значение; 8, 16 или 32 бита"),
      key<&C::write_only>("write_only", {},
                          "of `objects`, also of a node's: those that cannot be read back, \"60C4:06\"",
                          "из `objects`, в том числе узла: те, что нельзя прочитать обратно, \"60C4:06\""),
      key<&C::behaviour>("behaviour", {}, "where it differs from CiA 402", "отличия от CiA 402"),
      key<&C::errors>("error", {}, "error codes in words", "коды ошибок словами"),
      key<&C::modbus>("modbus", {}, "channels of a Modbus station", "каналы станции Modbus"),
      key<&C::gpio>("gpio", {}, "lines of a GPIO chip", "линии микросхемы GPIO"),
      key<&C::encoder>("encoder", {}, "resolution of an encoder", "разрешение датчика положения"),
      key<&C::inverter>("inverter", {}, "registers of an inverter", "регистры преобразователя"),
      key<&C::pendant>("pendant", {}, "reports and display of a pendant", "отчёты и дисплей пульта"),
  };
  static const Section section{"device file", "файл устройства", keys, &default_object<C>};
  return section;
}

}  // namespace servogate::machine
