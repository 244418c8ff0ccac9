// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<ArcFeed>() {
  static constexpr std::string_view kNames[] = {"tool-centre", "contour", "inside"};
  return kNames;
}

template <>
std::span<const std::string_view> choices_of<ThreadSide>() {
  static constexpr std::string_view kNames[] = {"declared", "infeed"};
  return kNames;
}

template <>
std::span<const std::string_view> choices_of<ProbeLatch>() {
  static constexpr std::string_view kNames[] = {"edge", "drive-1", "drive-2"};
  return kNames;
}

template <>
std::span<const std::string_view> choices_of<MachineKind>() {
  static constexpr std::string_view kNames[] = {"by_axes", "turning", "milling"};
  return kNames;
}

template <>
const Section& section_of<ControlConfig>() {
  using C = ControlConfig;
  static const Key keys[] = {
      key<&C::cycle_time>("cycle_time", {.unit = Unit::second, .min = 0.00025, .max = kLongestCycle},
                          "period of the cycle", "период цикла"),
      key<&C::dialect>("dialect", {}, "language of the part programs", "язык управляющих программ"),
      key<&C::kind>(
          "machine", {},
          "for languages with words of their own for turning and milling; by_axes: turning where an "
          "axis is programmed in diameter",
          "для языков с отдельными словами для точения и фрезерования; by_axes: точение, если "
          "какая-то ось программируется в диаметре"),
      key<&C::power_on>("power_on", {}, "modal words in force after power-on",
                        "модальные функции после включения"),
      key<&C::variables>("variables", {},
                         "variables of the dialect after power-on, in its own units: ERF, MCD",
                         "переменные языка после включения, в его единицах: ERF, MCD"),
      key<&C::contour_tolerance>("contour_tolerance",
                                 {.unit = Unit::mm, .min = 0, .max = 10, .above_min = true},
                                 "greatest distance between set-points and programmed path",
                                 "наибольшее отклонение заданной траектории от программной"),
      key<&C::arc_feed>("arc_feed", {},
                        "what F is the speed of on an arc under radius compensation: the tool's centre, the "
                        "contour, or the contour on inside radii only",
                        "чья скорость F на дуге с коррекцией на радиус: центра инструмента, контура или "
                        "контура только на внутренних радиусах"),
      key<&C::path_reserve>(
          "path_reserve", {.unit = Unit::percent, .min = 0.2, .max = 20},
          "share of the axes' limits that motion through short blocks leaves for a hold: more of it stops "
          "sooner "
          "and takes a little longer",
          "доля пределов осей, которую движение по коротким кадрам оставляет на останов: чем она больше, тем "
          "быстрее останов и тем дольше обработка"),
      key<&C::thread_window>(
          "thread_window", {.unit = Unit::mm, .min = 0, .max = 10, .above_min = true},
          "a thread or tap that is further off the measured angle of its spindle is left, alarm 4103",
          "резьба, отошедшая от измеренного угла шпинделя дальше, прерывается, авария 4103"),
      key<&C::thread_hold_retracts>(
          "thread_hold_retracts", {},
          "a hold leaves a thread by `thread_retract` of the axes; otherwise the pass goes on to its end",
          "останов подачи прерывает резьбу с отводом осей по `thread_retract`; иначе проход завершается"),
      key<&C::thread_retract_side>(
          "thread_retract_side", {},
          "to which side an axis leaves a thread: by the sign of its `thread_retract`, or to where its last "
          "move "
          "of at least 0.2 mm came from, which suits outer and inner threads",
          "в какую сторону ось отходит от резьбы: по знаку `thread_retract` или туда, откуда пришла "
          "последним "
          "перемещением не короче 0,2 мм, что годится для наружной и внутренней резьбы"),
      key<&C::tap_overshoot>(
          "tap_overshoot", {.unit = Unit::mm, .min = 0, .max = 100, .above_min = true},
          "so far a tap may go beyond its depth with a spindle that turns round late; where it would rest "
          "beyond it, it is stopped beside the spindle, alarm 4109",
          "на столько метчик может пройти за глубину вслед за шпинделем, который реверсируется поздно; если "
          "он "
          "остановился бы дальше, ось останавливается отдельно от шпинделя, авария 4109"),
      key<&C::probe>(
          "probe", {.refers = Refers::digital_input},
          "input point of the probe, TRUE while it is deflected; with `edges` of the point a touch is "
          "known to the time of its edge, without it to a cycle",
          "вход щупа, TRUE, пока он отклонён; при `edges` точки касание известно с точностью "
          "времени фронта, без него — с точностью такта"),
      key<&C::probe_latch>("probe_latch", {},
                           "what tells where the probe touched: the edge of `probe`, or the touch probe of "
                           "the axes' drives, to "
                           "whose input 1 or 2 it is wired besides (60B8h); an axis that moves and has not "
                           "latched is alarm 4116",
                           "что сообщает положение касания: фронт `probe` или защёлка приводов осей, к входу "
                           "1 или 2 которых щуп "
                           "подключён дополнительно (60B8h); движущаяся ось без защёлки — авария 4116"),
      key<&C::tool_places>("tool_places", {.min = 0, .max = 9999},
                           "places of the magazine or turret, T takes 0 to this number; 0: any T",
                           "мест в магазине или револьверной головке, T — от 0 до этого числа; 0: любой T"),
      key<&C::processes>("processes", {.min = 1, .max = image::kMaxProcesses},
                         "part programs that run side by side",
                         "число параллельных процессов (управляющих программ)"),
      key<&C::k_size>("k_size", {.unit = Unit::bytes, .min = 1024, .max = image::kPacketKMaxSize},
                      "size of packet K", "размер пакета K"),
      key<&C::syvar_size>("syvar_size", {.unit = Unit::bytes, .min = 1, .max = image::kSyvarMaxSize},
                          "size of the SYVAR memory", "размер памяти SYVAR"),
  };
  static const Section section{"the control", "система управления", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<OwnCodeConfig>() {
  using C = OwnCodeConfig;
  static const Key keys[] = {
      key<&C::code>("code", {.required = true}, "the word: \"G50\", \"M77\"", "слово: \"G50\", \"M77\""),
      key<&C::program>("program", {.required = true, .refers = Refers::file}, "program that it calls",
                       "программа, которую оно вызывает"),
      key<&C::words>(
          "words", {},
          "words of its block, by letter, and the numbers of the parameters that take their values",
          "слова его кадра по буквам и номера параметров, которые принимают их значения"),
  };
  static const Section section{"a G or M word of the machine builder's own",
                               "собственное слово G или M станкостроителя", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<ModbusServerConfig>() {
  using C = ModbusServerConfig;
  static const Key keys[] = {
      key<&C::listen>("listen", {}, "address and port, \"127.0.0.1:1502\"; empty: no server",
                      "адрес и порт, \"127.0.0.1:1502\"; пусто: сервера нет"),
      key<&C::clients>("clients", {}, "addresses of other computers that are served; this one always is",
                       "адреса других компьютеров, которым он отвечает; этому — всегда"),
      key<&C::write>("write", {}, "bytes of packet K that may be written: \"SK200-SK231\"; none: read-only",
                     "байты пакета K, которые можно писать: \"SK200-SK231\"; нет: только чтение"),
  };
  static const Section section{"the Modbus TCP server for panels and SCADA",
                               "сервер Modbus TCP для панелей и SCADA", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<RunConfig>() {
  using C = RunConfig;
  static const Key keys[] = {
      key<&C::allow_start_now>("allow_start_now", {}, "`run --start-now` may start on real buses",
                               "разрешает `run --start-now` на настоящих шинах"),
      key<&C::start_point>("start_point", {.refers = Refers::digital_input},
                           "input point of the operator's start button, for buses that are no mock",
                           "вход кнопки «Пуск» оператора, для настоящих шин"),
      key<&C::socket>("socket", {.computed = true}, "control socket; $XDG_RUNTIME_DIR/servogate/NAME.sock",
                      "сокет управления; $XDG_RUNTIME_DIR/servogate/ИМЯ.sock"),
      key<&C::state>("state", {}, "state directory, seen from the machine file's folder",
                     "каталог состояния, относительно папки файла станка"),
  };
  static const Section section{"starting and control socket", "пуск и сокет управления", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<RealtimeConfig>() {
  using C = RealtimeConfig;
  static const Key keys[] = {
      key<&C::cpu>("cpu", {.min = -1, .max = 1023}, "processor of the cycle; -1: any",
                   "процессор цикла; -1: любой"),
      key<&C::priority>("priority", {.min = 1, .max = 98}, "SCHED_FIFO priority of the cycle",
                        "приоритет цикла SCHED_FIFO"),
  };
  static const Section section{"real-time thread", "поток реального времени", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<SafetyConfig>() {
  using C = SafetyConfig;
  static const Key keys[] = {
      key<&C::estop>("estop", {.refers = Refers::digital_input},
                     "input point of the emergency-stop chain, 1 = closed; never over Modbus; the PLC reads "
                     "it as `MC.estop_chain`",
                     "вход цепи аварийного останова, 1 = замкнута; никогда через Modbus; ПЛК читает его как "
                     "`MC.estop_chain`"),
      key<&C::control_alive>(
          "control_alive", {.refers = Refers::digital_output},
          "output point that the control toggles while it runs in time, for the safety relay",
          "выход, который управление переключает, пока успевает в такт, для реле безопасности"),
      key<&C::mock_inputs_guard_real_drives>(
          "mock_inputs_guard_real_drives", {},
          "mock inputs may stand for the emergency stop and the limit switches of drives on a real bus: "
          "a bench without a machine",
          "имитируемые входы могут заменять аварийный останов и концевики приводов на настоящей шине: "
          "стенд без станка"),
  };
  static const Section section{"signals of the safety circuit", "сигналы цепи безопасности", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<PlcConfig>() {
  using C = PlcConfig;
  static const Key keys[] = {
      key<&C::sources>("sources", {.refers = Refers::file},
                       "source files, seen from the machine file's folder",
                       "исходные файлы, относительно папки файла станка"),
      key<&C::handshake_timeout>("handshake_timeout",
                                 {.unit = Unit::second, .min = 0, .max = 3600, .above_min = true},
                                 "an M, S, T or H word not acknowledged within this is an alarm",
                                 "функция M, S, T или H без подтверждения за это время вызывает аварию"),
      key<&C::instruction_budget>("instruction_budget", {.min = 1000, .max = 1e9},
                                  "instructions of one scan with all its tasks; a scan that needs more is "
                                  "stopped: alarm 5002",
                                  "команд в одном скане со всеми задачами; скан, которому нужно больше, "
                                  "останавливается: авария 5002"),
      key<&C::watchdog>("watchdog", {.unit = Unit::second, .min = 0, .max = 10},
                        "longest time of a scan in real time, more is alarm 5005; 0: not watched",
                        "наибольшее время скана в реальном времени, больше — авария 5005; 0: без контроля"),
  };
  static const Section section{"the PLC", "ПЛК", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulatedSwitch>() {
  using C = SimulatedSwitch;
  static const Key keys[] = {
      key<&C::point>("point", {.required = true, .refers = Refers::digital_input},
                     "input point of a mock station", "вход имитируемой станции"),
      key<&C::axis>("axis", {.required = true, .refers = Refers::axis},
                    "axis whose simulated position it follows",
                    "ось, за имитируемым положением которой он следует"),
      key<&C::from>("from", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                    "the switch works from here, machine coordinates",
                    "начало зоны срабатывания, машинные координаты"),
      key<&C::to>("to", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                  "the switch works up to here", "конец зоны срабатывания"),
  };
  static const Section section{"a mock switch that follows an axis",
                               "имитируемый выключатель, следующий за осью", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulatedLoop>() {
  using C = SimulatedLoop;
  static const Key keys[] = {
      key<&C::output>("output", {.required = true, .refers = Refers::digital_output}, "output point",
                      "выход"),
      key<&C::input>("input", {.required = true, .refers = Refers::digital_input},
                     "input point of a mock station that follows it",
                     "вход имитируемой станции, который за ним следует"),
      key<&C::inverted>("inverted", {}, "the input is the opposite", "вход противоположен выходу"),
      key<&C::delay>("delay", {.unit = Unit::second, .min = 0, .max = 3600}, "time from output to input",
                     "время от выхода до входа"),
  };
  static const Section section{"a mock input that follows an output",
                               "имитируемый вход, следующий за выходом", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulatedIndexer>() {
  using C = SimulatedIndexer;
  static const Key keys[] = {
      key<&C::output>("output", {.required = true, .refers = Refers::digital_output},
                      "output point of the motor", "выход двигателя"),
      key<&C::inputs>("inputs", {.required = true, .refers = Refers::digital_input},
                      "position inputs of a mock station, in the order in which they come",
                      "входы позиций имитируемой станции в порядке их следования"),
      key<&C::step>("step", {.unit = Unit::second, .min = 0.01, .max = 60},
                    "time from one position to the next", "время от одной позиции до следующей"),
  };
  static const Section section{
      "a mock turret or magazine that turns while its motor runs",
      "имитируемая револьверная головка или магазин, вращается при включённом двигателе", keys,
      &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulatedDrive>() {
  using C = SimulatedDrive;
  static const Key keys[] = {
      key<&C::node>("node", {.required = true, .refers = Refers::node}, "the drive as \"bus.node\"",
                    "привод в виде \"шина.узел\""),
      key<&C::start>("start", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                     "position of the axis at power-on, machine coordinates",
                     "положение оси при включении, машинные координаты"),
      key<&C::zero_mark>("zero_mark", {.unit = Unit::counts, .min = -kMostCounts, .max = kMostCounts},
                         "counts from machine zero to the nearest zero mark in plus direction",
                         "дискрет от машинного нуля до ближайшей нулевой метки в направлении плюс"),
      key<&C::inertia>("inertia", {.unit = Unit::kg_m2, .min = 0, .max = 1000, .computed = true},
                       "moment of inertia of the load seen from the motor; the motor's own",
                       "момент инерции нагрузки, приведённый к двигателю; как у двигателя"),
      key<&C::friction_coulomb>("friction_coulomb", {.unit = Unit::newton_metre, .min = 0, .max = 1000},
                                "dry friction", "сухое трение"),
      key<&C::friction_viscous>("friction_viscous", {.unit = Unit::newton_metre_s_rad, .min = 0, .max = 1000},
                                "viscous friction", "вязкое трение"),
      key<&C::gravity_torque>("gravity_torque", {.unit = Unit::newton_metre, .min = -1000, .max = 1000},
                              "torque of the weight of a vertical axis", "момент от веса вертикальной оси"),
      key<&C::max_torque>("max_torque",
                          {.unit = Unit::newton_metre, .min = 0, .max = 10000, .computed = true},
                          "torque limit; the device file's peak torque",
                          "предел момента; пиковый момент из файла устройства"),
      key<&C::absolute_encoder>("absolute_encoder", {}, "the encoder keeps its count without power",
                                "датчик сохраняет счёт без питания"),
      key<&C::end_stop_min>("end_stop_min", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                            "rigid stop, machine coordinates", "жёсткий упор, машинные координаты"),
      key<&C::end_stop_max>("end_stop_max", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                            "rigid stop, machine coordinates", "жёсткий упор, машинные координаты"),
      key<&C::dip_torque>("dip_torque", {.unit = Unit::newton_metre, .min = 0, .max = 1000},
                          "load against the motion that comes and goes: a cut on a spindle",
                          "нагрузка против движения, которая появляется и исчезает: резание на шпинделе"),
      key<&C::dip_period>("dip_period", {.unit = Unit::second, .min = 0.01, .max = 3600},
                          "from the begin of one such load to the next",
                          "от начала одной такой нагрузки до следующей"),
      key<&C::dip_time>("dip_time", {.unit = Unit::second, .min = 0, .max = 3600}, "so long each one lasts",
                        "длительность каждой"),
      key<&C::encoder_noise>("encoder_noise", {.unit = Unit::counts, .min = 0, .max = 1e6},
                             "so far a reading of the encoder is off at most, either way",
                             "наибольшая погрешность отсчёта датчика в обе стороны"),
  };
  static const Section section{"the plant behind a simulated drive", "механика за имитируемым приводом", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulatedAmplifier>() {
  using C = SimulatedAmplifier;
  static const Key keys[] = {
      key<&C::axis>("axis", {.required = true, .refers = Refers::axis}, "axis with [axis.board]",
                    "ось с [axis.board]"),
      key<&C::start>("start", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                     "where the axis stands at power-on, from machine zero",
                     "положение оси при включении, от нуля станка"),
      key<&C::zero_mark>("zero_mark", {.min = -kMostCounts, .max = kMostCounts},
                         "counts from machine zero to the nearest zero mark in plus direction",
                         "отсчёты от нуля станка до ближайшей нулевой метки в плюс"),
      key<&C::pull_out_speed>("pull_out_speed", {.unit = Unit::rpm, .min = 0, .max = 1e6},
                              "step: beyond this speed steps are lost; 0: never",
                              "step: выше этой скорости шаги теряются; 0: никогда"),
      key<&C::lag>("lag", {.unit = Unit::second, .min = 0, .max = 1},
                   "analog, pwm: time constant of the speed loop",
                   "analog, pwm: постоянная времени контура скорости"),
      key<&C::drift>("drift", {.unit = Unit::percent, .min = -10, .max = 10},
                     "analog, pwm: speed at set-point 0, of the full speed",
                     "analog, pwm: скорость при задании 0, от полной"),
  };
  static const Section section{"amplifier and motor behind a channel of a mock board",
                               "усилитель и двигатель за каналом имитируемой платы", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<SimulationConfig>() {
  using C = SimulationConfig;
  static const Key keys[] = {
      key<&C::initial>("initial", {}, "values of mock inputs at start: point = value",
                       "начальные значения имитируемых входов: сигнал = значение"),
      key<&C::operator_closes>(
          "operator_closes", {.refers = Refers::digital_input},
          "mock inputs that the operator of `run` sets to 1: the emergency-stop chain",
          "имитируемые входы, которые устанавливает оператор `run`: цепь аварийного останова"),
      key<&C::switches>("switch", {}, "switches that follow axes", "выключатели, следующие за осями"),
      key<&C::loops>("loop", {}, "inputs that follow outputs", "входы, следующие за выходами"),
      key<&C::indexers>("indexer", {}, "turrets and magazines", "револьверные головки и магазины"),
      key<&C::drives>("drive", {}, "plants of the simulated drives", "механика имитируемых приводов"),
      key<&C::amplifiers>("amplifier", {}, "amplifiers of mock boards", "усилители имитируемых плат"),
  };
  static const Section section{"what the mocks do; without effect on anything real",
                               "поведение имитаторов; на настоящие устройства не влияет", keys,
                               &default_object<C>};
  return section;
}

template <>
const Section& section_of<MachineConfig>() {
  using C = MachineConfig;
  static const Key keys[] = {
      key<&C::schema>("schema", {.min = 1, .max = 1, .required = true}, "version of this format",
                      "версия формата"),
      key<&C::name>("name", {.required = true}, "name of the machine", "название станка"),
      key<&C::control>("control", {}, "the control", "система управления"),
      key<&C::run>("run", {}, "starting and control socket", "пуск и сокет управления"),
      key<&C::realtime>("realtime", {}, "real-time thread", "поток реального времени"),
      key<&C::safety>("safety", {}, "signals of the safety circuit", "сигналы цепи безопасности"),
      key<&C::plc>("plc", {}, "the PLC", "ПЛК"),
      key<&C::buses>("bus", {}, "CAN segments", "сегменты CAN"),
      key<&C::axes>("axis", {.required = true}, "axes", "оси"),
      key<&C::spindles>("spindle", {}, "spindles", "шпиндели"),
      key<&C::lines>("line", {}, "Modbus lines", "линии Modbus"),
      key<&C::stations>("station", {}, "sources of signals", "источники сигналов"),
      key<&C::symbols>("symbol", {}, "free places with names", "именованные свободные адреса"),
      key<&C::own_codes>("own_code", {}, "G and M words of the machine builder's own",
                         "собственные слова G и M станкостроителя"),
      key<&C::modbus_server>("modbus_server", {}, "the Modbus TCP server", "сервер Modbus TCP"),
      key<&C::pendants>("pendant", {}, "hand-held pendants", "выносные пульты"),
      key<&C::path_wheels>("path_wheel", {}, "handwheels that drive programs along their path",
                           "маховички движения программы по контуру"),
      key<&C::electronic_gears>("gear", {}, "axes that follow another axis or a spindle",
                                "оси, следующие за другой осью или шпинделем"),
      key<&C::simulation>("simulation", {}, "what the mocks do; without effect on what is real",
                          "поведение имитаторов; на настоящее не действует"),
  };
  static const Section section{"machine file", "файл станка", keys, &default_object<C>};
  return section;
}

}  // namespace servogate::machine
