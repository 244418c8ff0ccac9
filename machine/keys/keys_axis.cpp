// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<AxisType>() {
  static constexpr std::string_view kNames[] = {"linear", "rotary"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<Direction>() {
  static constexpr std::string_view kNames[] = {"plus", "minus"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<HomingMethod>() {
  static constexpr std::string_view kNames[] = {"switch_and_index", "switch", "index", "drive",
                                                "absolute",         "none"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<BoardOutput>() {
  static constexpr std::string_view kNames[] = {"step", "analog", "pwm"};
  return kNames;
}
template <>
std::span<const std::string_view> choices_of<BoardFeedback>() {
  static constexpr std::string_view kNames[] = {"encoder", "steps"};
  return kNames;
}

template <>
const Section& section_of<HomingConfig>() {
  using C = HomingConfig;
  static const Key keys[] = {
      key<&C::method>("method", {}, "how the axis finds its zero; none: zero where it is switched on",
                      "способ выхода в ноль; none: ноль там, где ось включена"),
      key<&C::direction>("direction", {}, "direction of the search for the switch",
                         "направление поиска датчика нуля"),
      key<&C::switch_point>("switch", {.refers = Refers::digital_input}, "input point of the home switch",
                            "входной сигнал датчика нуля"),
      key<&C::fast>("fast", {.unit = Unit::axis_velocity, .min = 0, .max = kFastest},
                    "speed of the search for the switch", "скорость поиска датчика нуля"),
      key<&C::slow>("slow", {.unit = Unit::axis_velocity, .min = 0, .max = kFastest},
                    "speed of leaving the switch and of the search for the index",
                    "скорость съезда с датчика и поиска нулевой метки"),
      key<&C::index_direction>(
          "index_direction", {},
          "the edge of the switch is crossed slowly and the index sought in this direction",
          "направление медленного прохода края датчика и поиска нулевой метки"),
      key<&C::index_max_travel>("index_max_travel",
                                {.unit = Unit::axis_length, .min = 0, .max = kLongest, .computed = true},
                                "the search for the index gives up after this; one and a half motor turns",
                                "предел пути поиска нулевой метки; полтора оборота двигателя"),
      key<&C::drive_method>("drive_method", {.min = -128, .max = 127},
                            "method drive: number of the method by CiA 402-2 (6098h); fast, slow and "
                            "acceleration go to the drive (6099h, 609Ah)",
                            "способ drive: номер метода по CiA 402-2 (6098h); fast, slow и acceleration "
                            "передаются приводу (6099h, 609Ah)"),
      key<&C::acceleration>("acceleration",
                            {.unit = Unit::axis_acceleration, .min = 0, .max = kSteepest, .computed = true},
                            "method drive: acceleration of the drive's homing; that of the axis",
                            "способ drive: ускорение при выходе в ноль; ускорение оси"),
      key<&C::position>("position", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                        "machine coordinate of the index (of the switch edge without one)",
                        "машинная координата нулевой метки (без метки: края датчика)"),
      key<&C::max_travel>("max_travel",
                          {.unit = Unit::axis_length, .min = 0, .max = kLongest, .computed = true},
                          "the search for the switch gives up after this; 1.2 times the travel",
                          "предел пути поиска датчика; 1,2 хода оси"),
      key<&C::final_move>("final_move", {}, "drive to final_position after referencing",
                          "перейти в final_position после выхода в ноль"),
      key<&C::final_position>("final_position",
                              {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                              "where the axis goes after referencing, machine coordinates",
                              "куда ось идёт после выхода в ноль, машинные координаты"),
      key<&C::timeout>("timeout", {.unit = Unit::second, .min = 1, .max = 3600},
                       "time for the whole of homing", "время на весь выход в ноль"),
      key<&C::order>("order", {.min = 1, .max = 16}, "axes of the same order home together, lower ones first",
                     "оси с равным номером выходят в ноль вместе, меньшие номера раньше"),
  };
  static const Section section{"homing of the axis", "выход оси в ноль", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<BrakeConfig>() {
  using C = BrakeConfig;
  static const Key keys[] = {
      key<&C::point>("point", {.refers = Refers::digital_output}, "output point of the brake, 1 = open",
                     "выходной сигнал тормоза, 1 = отпущен"),
      key<&C::drive_output>("drive_output", {}, "the brake hangs on the drive's own brake output",
                            "тормоз подключён к собственному выходу привода"),
      key<&C::release_delay>("release_delay", {.unit = Unit::second, .min = 0, .max = 10},
                             "time from the output to an open brake; no motion before",
                             "время от сигнала до отпускания тормоза; до него движения нет"),
      key<&C::torque_delay>("torque_delay", {.unit = Unit::second, .min = 0, .max = 10},
                            "time from Operation enabled until the drive surely holds the load",
                            "время от включения привода до надёжного удержания груза"),
      key<&C::slip_window>("slip_window", {.unit = Unit::axis_length, .min = 0, .max = 100},
                           "movement permitted while the brake opens or closes",
                           "допустимое смещение при отпускании и зажатии тормоза"),
      key<&C::engage_delay>("engage_delay", {.unit = Unit::second, .min = 0, .max = 10},
                            "time from the output to a closed brake; the drive holds that long",
                            "время от сигнала до зажатия тормоза; привод удерживает ось до его конца"),
      key<&C::relay_delay>(
          "relay_delay", {.unit = Unit::second, .min = 0, .max = 60},
          "time from the last change of safety.control_alive until the relay that watches it "
          "takes the voltage from the brake; 0: no relay does",
          "время от последнего изменения safety.control_alive до снятия напряжения с тормоза "
          "реле, которое за ним следит; 0: такого реле нет"),
  };
  static const Section section{"holding brake of the axis", "удерживающий тормоз оси", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<BoardChannelConfig>() {
  using C = BoardChannelConfig;
  static const Key keys[] = {
      key<&C::station>("station", {.required = true}, "station of kind board", "станция вида board"),
      key<&C::channel>("channel", {.min = 0, .max = 3},
                       "channel of the board: its set-point outputs, encoder, enable and fault lines",
                       "канал платы: его выходы задания, датчик, линии разрешения и аварии"),
      key<&C::output>(
          "output", {},
          "what the amplifier takes: step and direction, +-10 V, or PWM; analog and pwm are a speed, "
          "and the control closes the position loop",
          "что принимает усилитель: шаг и направление, ±10 В или ШИМ; analog и pwm задают скорость, "
          "контур положения замыкает управление"),
      key<&C::feedback>("feedback", {},
                        "where the position comes from: the encoder of the channel, or the steps put out",
                        "откуда берётся положение: датчик канала или выданные шаги"),
      key<&C::steps_per_rev>("steps_per_rev", {.min = 0, .max = kMostCounts, .computed = true},
                             "step: steps per turn of the motor; counts_per_rev with feedback steps",
                             "step: шагов на оборот двигателя; при feedback steps — counts_per_rev"),
      key<&C::step_time>("step_time", {.unit = Unit::second, .min = 0, .max = 0.0002},
                         "step: shortest time of a step level, high and low",
                         "step: наименьшая длительность уровня шага, высокого и низкого"),
      key<&C::full_speed>("full_speed", {.unit = Unit::rpm, .min = 0, .max = 1e6},
                          "analog, pwm: speed of the motor at the full set-point (10 V, 100 per cent)",
                          "analog, pwm: скорость двигателя при полном задании (10 В, 100 процентов)"),
      key<&C::position_gain>(
          "position_gain", {.unit = Unit::per_s, .min = 0, .max = 1000},
          "analog, pwm: gain of the position loop: speed for each unit of following error",
          "analog, pwm: коэффициент контура положения: скорость на единицу рассогласования"),
      key<&C::offset>("offset", {.unit = Unit::percent, .min = -10, .max = 10},
                      "analog, pwm: added to the set-point, against the drift of the amplifier",
                      "analog, pwm: добавка к заданию против дрейфа усилителя"),
      key<&C::reversed>("reversed", {}, "a positive set-point lowers the counts",
                        "положительное задание уменьшает счёт"),
      key<&C::fault_low>("fault_low", {}, "the fault line of the amplifier reports at level 0",
                         "линия аварии усилителя срабатывает уровнем 0"),
  };
  static const Section section{"amplifier of the axis on a USB board", "усилитель оси на плате USB", keys,
                               &default_object<C>};
  return section;
}

namespace {
std::span<const Key> axis_keys() {
  using C = AxisConfig;
  static const Key keys[] = {
      key<&C::letter>("letter", {.required = true}, "axis letter, A to Z", "буква оси, от A до Z"),
      key<&C::name>("name", {}, "name for people", "название для людей"),
      key<&C::type>("type", {}, "kind of axis; it chooses mm or degrees for every key below",
                    "вид оси; определяет мм или градусы для всех ключей ниже"),
      key<&C::diameter>("diameter", {}, "programs and displays show the diameter; this file holds radii",
                        "программа и индикация показывают диаметр; в этом файле радиусы"),
      key<&C::auxiliary>(
          "auxiliary", {},
          "moved by the MC_ blocks of the PLC alone (magazine, chuck); stands behind the axes of the "
          "programs",
          "ось перемещает только ПЛК блоками MC_ (магазин, патрон); стоит после осей программ"),
      key<&C::drive>("drive", {.refers = Refers::node},
                     "the drive as \"bus.node\"; an axis on a board has [axis.board] instead",
                     "привод в виде \"шина.узел\"; у оси на плате вместо него [axis.board]"),
      key<&C::process>("process", {.min = 1, .max = image::kMaxProcesses},
                       "process whose programs move the axis, at most control.processes; at standstill "
                       "`servogate assign` gives it to another one",
                       "процесс, программы которого перемещают ось, не больше control.processes; в покое "
                       "`servogate assign` передаёт её другому"),
      key<&C::lead>("lead", {.unit = Unit::axis_lead, .min = 0.001, .max = 1e5, .required = true},
                    "travel per turn of the screw", "перемещение на оборот винта"),
      key<&C::gear>("gear", {.min = 1, .max = 1e6}, "exact gear ratio, motor turns : screw turns",
                    "точное передаточное отношение, обороты двигателя : обороты винта"),
      key<&C::counts_per_rev>("counts_per_rev",
                              {.unit = Unit::counts, .min = 1, .max = kMostCounts, .required = true},
                              "drive counts per turn of the motor", "дискрет привода на оборот двигателя"),
      key<&C::direction>("direction", {}, "minus: rising counts are falling coordinates",
                         "minus: растущий счёт означает убывающую координату"),
      key<&C::max_velocity>(
          "max_velocity", {.unit = Unit::axis_velocity, .min = kSlowest, .max = kFastest, .required = true},
          "limit of velocity, also of rapids", "предел скорости, он же скорость ускоренного хода"),
      key<&C::max_acceleration>(
          "max_acceleration",
          {.unit = Unit::axis_acceleration, .min = kSlowest, .max = kSteepest, .required = true},
          "limit of acceleration", "предел ускорения"),
      key<&C::max_jerk>("max_jerk",
                        {.unit = Unit::axis_jerk, .min = kSlowest, .max = kHardest, .required = true},
                        "limit of jerk", "предел рывка"),
      key<&C::thread_retract>(
          "thread_retract", {.unit = Unit::axis_length, .min = -100, .max = 100},
          "so far it goes, with its sign, when a thread is left: the spindle is lost, or the "
          "motion is stopped",
          "на столько, со своим знаком, она отходит при прерывании резьбы: потерян "
          "шпиндель или движение остановлено"),
      key<&C::travel_min>(
          "travel_min", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest, .required = true},
          "lower software limit, machine coordinates; a rotary axis with both limits 0 is endless",
          "нижний программный предел, машинные координаты; круговая ось с нулевыми пределами бесконечна"),
      key<&C::travel_max>("travel_max",
                          {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest, .required = true},
                          "upper software limit", "верхний программный предел"),
      key<&C::following_error_warn>("following_error_warn",
                                    {.unit = Unit::axis_length, .min = 0, .max = kLongest},
                                    "following error that raises warning 1017, at standstill; 0: none",
                                    "рассогласование, вызывающее предупреждение 1017, в покое; 0: нет"),
      key<&C::following_error_stop>(
          "following_error_stop",
          {.unit = Unit::axis_length, .min = 0, .max = kLongest, .above_min = true, .required = true},
          "following error that stops the machine, at standstill",
          "рассогласование, останавливающее станок, в покое"),
      key<&C::following_error_velocity>("following_error_velocity",
                                        {.unit = Unit::second, .min = 0, .max = 10},
                                        "following error allowed in addition per unit of speed",
                                        "добавка к допустимому рассогласованию на единицу скорости"),
      key<&C::in_position_window>("in_position_window",
                                  {.unit = Unit::axis_length, .min = 0, .max = kLongest, .above_min = true},
                                  "window of the exact stop", "окно точного позиционирования"),
      key<&C::in_position_window_coarse>(
          "in_position_window_coarse",
          {.unit = Unit::axis_length, .min = 0, .max = kLongest, .computed = true},
          "window of the coarse exact stop (G602); four times in_position_window",
          "окно грубого точного останова (G602); четырёхкратное in_position_window"),
      key<&C::in_position_time>("in_position_time", {.unit = Unit::second, .min = 0, .max = 10},
                                "time inside the window", "время нахождения в окне"),
      key<&C::in_position_timeout>(
          "in_position_timeout", {.unit = Unit::second, .min = 0, .max = 60},
          "alarm when not in position this long after the set-point stopped; 0: none",
          "авария, если ось не в позиции столько времени после остановки задания; 0: нет"),
      key<&C::jog_velocity>(
          "jog_velocity", {.unit = Unit::axis_velocity, .min = 0, .max = kFastest, .computed = true},
          "speed of jogging; a tenth of max_velocity", "скорость ручного хода; десятая часть max_velocity"),
      key<&C::jog_velocity_not_homed>(
          "jog_velocity_not_homed",
          {.unit = Unit::axis_velocity, .min = 0, .max = kFastest, .computed = true},
          "speed before homing and off a hard limit; a hundredth of max_velocity",
          "скорость до выхода в ноль и при съезде с аварийного концевика; сотая часть max_velocity"),
      key<&C::limit_plus>("limit_plus", {.refers = Refers::digital_input},
                          "input point of the positive limit switch, 1 = on it",
                          "входной сигнал концевого выключателя «плюс», 1 = сработал"),
      key<&C::limit_minus>("limit_minus", {.refers = Refers::digital_input},
                           "input point of the negative limit switch, 1 = on it",
                           "входной сигнал концевого выключателя «минус», 1 = сработал"),
      key<&C::hard_limit_plus>("hard_limit_plus",
                               {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                               "machine coordinate at which the positive switch works",
                               "машинная координата срабатывания концевика «плюс»"),
      key<&C::hard_limit_minus>("hard_limit_minus",
                                {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                                "machine coordinate at which the negative switch works",
                                "машинная координата срабатывания концевика «минус»"),
      key<&C::mechanical_end_plus>(
          "mechanical_end_plus", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
          "machine coordinate at which the axis runs into its end, behind the positive switch: the room of a "
          "stop that begins on the switch",
          "машинная координата механического упора за концевиком «плюс»: путь для торможения от концевика"),
      key<&C::mechanical_end_minus>("mechanical_end_minus",
                                    {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                                    "the same behind the negative switch", "то же за концевиком «минус»"),
      key<&C::backlash>("backlash", {.unit = Unit::axis_length, .min = 0, .max = 10},
                        "backlash, taken up when moving in minus direction",
                        "люфт, выбирается при движении в минус"),
      key<&C::pitch_table>("pitch_table", {},
                           "pitch error: [machine coordinate, error] with rising coordinates",
                           "погрешность шага: [машинная координата, погрешность], координаты по возрастанию"),
      key<&C::vertical>("vertical", {}, "the axis falls without power; needs a brake",
                        "ось падает без питания; нужен тормоз"),
      key<&C::torque_max>(
          "torque_max", {.unit = Unit::percent, .min = 0, .max = 1000},
          "largest torque of MC_TorqueControl, of the motor's rated one (6076h); auxiliary axes "
          "only; 0: not led by torque",
          "наибольший момент MC_TorqueControl от номинального момента двигателя (6076h); только "
          "для вспомогательных осей; 0: моментом не управляется"),
      key<&C::torque_ramp>("torque_ramp", {.min = 0, .max = 100000, .computed = true},
                           "greatest change of that torque, per cent a second; torque_max in a second",
                           "наибольшее изменение этого момента, процентов в секунду; torque_max за секунду"),
      key<&C::home>("home", {}, "homing", "выход в ноль"),
      key<&C::brake>("brake", {}, "holding brake", "удерживающий тормоз"),
      key<&C::board>("board", {}, "amplifier on a USB board", "усилитель на плате USB"),
  };
  return keys;
}
}  // namespace

template <>
const Section& section_of<AxisConfig>() {
  static const Section section{"an axis, in the order of positions in traces and programs",
                               "ось; порядок осей тот же, что в трассах и программах", axis_keys(),
                               &default_object<AxisConfig>, true};
  return section;
}

template <>
const Section& section_of<GearConfig>() {
  using C = GearConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name for people", "название для людей"),
      key<&C::max_speed>(
          "max_speed", {.unit = Unit::rpm, .min = 0, .max = 200000, .above_min = true, .required = true},
          "fastest speed of the spindle in this gear", "наибольшая частота вращения шпинделя на ступени"),
      key<&C::gear>("gear", {.min = 1, .max = 1e6, .required = true},
                    "exact gear ratio, motor turns : spindle turns",
                    "точное передаточное отношение, обороты двигателя : обороты шпинделя"),
      key<&C::output>(
          "output", {.refers = Refers::digital_output},
          "output point that engages it and stays on; a gear that a spring engages has none",
          "выход, который включает ступень и остаётся включённым; у ступени, включаемой пружиной, его нет"),
      key<&C::confirm>("confirm", {.refers = Refers::digital_input},
                       "input point: TRUE while it is engaged; without it gear_change_time is waited",
                       "вход: TRUE, пока ступень включена; без него выжидается gear_change_time"),
  };
  static const Section section{"a gear range of the spindle", "ступень редуктора шпинделя", keys,
                               &default_object<C>};
  return section;
}

template <>
std::span<const std::string_view> choices_of<Coupling>() {
  static constexpr std::string_view kNames[] = {"none", "setpoint", "measured"};
  return kNames;
}

template <>
std::span<const std::string_view> choices_of<ThreadMaster>() {
  static constexpr std::string_view kNames[] = {"measured", "setpoint"};
  return kNames;
}

template <>
const Section& section_of<SpindleConfig>() {
  using C = SpindleConfig;
  static const Key keys[] = {
      key<&C::name>("name", {}, "name for people", "название для людей"),
      key<&C::drive>("drive", {.refers = Refers::node},
                     "the drive as \"bus.node\"; or `inverter`, or `speed_output`",
                     "привод в виде \"шина.узел\"; или `inverter`, или `speed_output`"),
      key<&C::inverter>("inverter", {}, "the station of an inverter on a Modbus line, by name",
                        "имя станции преобразователя на линии Modbus"),
      key<&C::rated_speed>("rated_speed", {.unit = Unit::rpm, .min = 0, .max = 200000},
                           "with `inverter`: speed of the motor at rated_frequency, as on its nameplate",
                           "при `inverter`: частота вращения двигателя при rated_frequency, с его таблички"),
      key<&C::rated_frequency>("rated_frequency", {.unit = Unit::hertz, .min = 0, .max = 3000},
                               "with `inverter`: frequency of the motor, as on its nameplate",
                               "при `inverter`: частота питания двигателя, с его таблички"),
      key<&C::loss_reaction>(
          "loss_reaction", {},
          "with `inverter`: what its loss makes the machine do: the axes stop together on the path, or more "
          "severely; the spindle is told to stop in any case",
          "при `inverter`: что делает станок при его потере: оси останавливаются вместе на траектории или "
          "строже; шпиндель останавливается в любом случае"),
      key<&C::process>("process", {.min = 1, .max = image::kMaxProcesses},
                       "process whose S, M3, M4, M5 and M19 it obeys, at most control.processes",
                       "процесс, функциям S, M3, M4, M5 и M19 которого подчиняется шпиндель, не больше "
                       "control.processes"),
      key<&C::speed_output>(
          "speed_output", {.refers = Refers::analog_output},
          "analog output point of an inverter; its value is the speed in rpm, without sign",
          "аналоговый выход к преобразователю; его значение — частота вращения в об/мин, без знака"),
      key<&C::cw_output>(
          "cw_output", {.refers = Refers::digital_output},
          "output point of the relay for clockwise (M03); without relays the speed alone turns it",
          "выход реле вращения по часовой стрелке (M03); без реле вращением управляет одна скорость"),
      key<&C::ccw_output>("ccw_output", {.refers = Refers::digital_output},
                          "output point of the relay for counter-clockwise (M04); without it M04 is an alarm",
                          "выход реле вращения против часовой стрелки (M04); без него M04 — авария"),
      key<&C::min_speed>("min_speed", {.unit = Unit::rpm, .min = 0, .max = 200000}, "slowest speed",
                         "наименьшая частота вращения"),
      key<&C::max_speed>("max_speed",
                         {.unit = Unit::rpm, .min = 0, .max = 200000, .above_min = true, .required = true},
                         "fastest speed", "наибольшая частота вращения"),
      key<&C::acceleration>("acceleration",
                            {.unit = Unit::rpm_per_s, .min = 0, .max = 1e6, .above_min = true},
                            "ramp of the speed", "темп разгона"),
      key<&C::gear>("gear", {.min = 1, .max = 1e6}, "exact gear ratio, motor turns : spindle turns",
                    "точное передаточное отношение, обороты двигателя : обороты шпинделя"),
      key<&C::gears>(
          "gears", {},
          "gear ranges, slow ones first, instead of `gear`; an order to turn engages the slowest that "
          "reaches the speed, or the one that the PLC wants (S.gear_wish)",
          "ступени редуктора, медленные первыми, вместо `gear`; приказ вращаться включает самую медленную "
          "из достаточных или ту, что нужна ПЛК (S.gear_wish)"),
      key<&C::gear_change_speed>("gear_change_speed", {.unit = Unit::rpm, .min = 0, .max = 1000},
                                 "the spindle turns so slowly while its gear changes; 0: it stands",
                                 "частота вращения шпинделя при смене ступени; 0: он стоит"),
      key<&C::gear_change_time>("gear_change_time", {.unit = Unit::second, .min = 0, .max = 60},
                                "from the outputs to an engaged gear, where no input confirms it",
                                "от выходов до включённой ступени, если вход её не подтверждает"),
      key<&C::gear_change_timeout>("gear_change_timeout", {.unit = Unit::second, .min = 0.1, .max = 60},
                                   "to the confirmation of a gear, then an alarm",
                                   "до подтверждения ступени, затем авария"),
      key<&C::counts_per_rev>("counts_per_rev", {.unit = Unit::counts, .min = 0, .max = kMostCounts},
                              "encoder counts per turn of the spindle; 0: no encoder",
                              "дискрет датчика на оборот шпинделя; 0: датчика нет"),
      key<&C::encoder_delay>("encoder_delay", {.unit = Unit::second, .min = 0, .max = 0.2},
                             "by so much its counts are older than those of drives latched at SYNC; threads "
                             "and taps reckon with it",
                             "на столько её отсчёты старше отсчётов приводов, защёлкнутых по SYNC; "
                             "учитывается при нарезании резьбы"),
      key<&C::direction>("direction", {}, "minus: clockwise is falling counts",
                         "minus: по часовой стрелке счёт убывает"),
      key<&C::at_speed_window>("at_speed_window", {.unit = Unit::percent, .min = 0.1, .max = 50},
                               "deviation within which the spindle is at speed",
                               "отклонение, при котором частота считается достигнутой"),
      key<&C::at_speed_timeout>("at_speed_timeout", {.unit = Unit::second, .min = 0, .max = 600},
                                "alarm when not at speed this long after the ramp; 0: none",
                                "авария, если частота не достигнута за это время после разгона; 0: нет"),
      key<&C::orient_angle>("orient_angle", {.min = 0, .max = 360}, "angle of the oriented stop in degrees",
                            "угол ориентированного останова в градусах"),
      key<&C::orient_speed>("orient_speed", {.unit = Unit::rpm, .min = 0, .max = 10000},
                            "speed of the oriented stop", "частота вращения при ориентации"),
      key<&C::thread_master>(
          "thread_master", {},
          "by what angle threads go: as it is measured, or by its set-point, to which the spindle is then "
          "held by its position",
          "по какому углу нарезается резьба: по измеренному или по заданному, по которому тогда ведётся и "
          "шпиндель"),
      key<&C::coupling>(
          "coupling", {},
          "of the second spindle of a process: by what angle it follows the first one when a program couples "
          "them (G51.2): its set-point, to which the first one is then held, or as it is measured",
          "у второго шпинделя процесса: за каким углом первого он следует, когда программа их связывает "
          "(G51.2): за заданным, по которому тогда ведётся и первый, или за измеренным"),
      key<&C::coupling_window>(
          "coupling_window", {.min = 0.01, .max = 90},
          "so far, in degrees, a coupled spindle may be off the angle it is led to; further off it is alarm "
          "1210",
          "на столько градусов связанный шпиндель может отстоять от заданного угла; дальше — авария 1210"),
      key<&C::axis>(
          "axis", {},
          "letter of the rotary axis that it becomes, which has the same `drive`; of the first spindle of a "
          "process",
          "буква поворотной оси, в которую он переходит; у неё тот же `drive`; у первого шпинделя процесса"),
      key<&C::axis_m>("axis_m", {.min = 31, .max = 999},
                      "M functions of programs: the spindle becomes the axis : it is a spindle again",
                      "функции M программ: шпиндель становится осью : снова шпиндель"),
  };
  static const Section section{"a spindle", "шпиндель", keys, &default_object<C>};
  return section;
}

}  // namespace servogate::machine
