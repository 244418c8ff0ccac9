// SPDX-License-Identifier: Apache-2.0
#include "machine/consequences.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/modbus/line_time.hpp"
#include "firmware_if/text/units.hpp"
#include "machine/check/bus/slowest.hpp"
#include "machine/check/stops/control_death.hpp"
#include "machine/check/stops/overrun.hpp"

namespace servogate::machine {

namespace {

constexpr text::Entry kScale{"consequence.scale", "{0}: {1} = {2} counts; {3} = {4} rpm",
                             "{0}: {1} = {2} дискрет; {3} = {4} об/мин"};
constexpr text::Entry kStop{"consequence.stop", "{0}: stops from {1} within {2}, in {3} s",
                            "{0}: останавливается с {1} на пути {2} за {3} с"};
constexpr text::Entry kMargin{"consequence.limit_margin",
                              "{0}: the limit switches work {1} and {2} outside the travel",
                              "{0}: концевики срабатывают на {1} и {2} за ходом"};
constexpr text::Entry kOverrun{
    "consequence.overrun",
    "{0}: the mechanical end is {1} beyond the limit switch {0}{2}; a stop that starts at the switch ends in "
    "time from up to {3}; before homing the axis arrives at {4} and needs {5}",
    "{0}: упор в {1} за концевиком {0}{2}; от концевика ось успевает остановиться при скорости до {3}; до "
    "выхода в ноль она подходит к нему на {4} и тормозит на пути {5}"};
constexpr text::Entry kEndUnknown{
    "consequence.end_unknown",
    "{0}: it is not known whether a stop that starts at a limit switch ends before the mechanical end: set "
    "mechanical_end_minus and mechanical_end_plus",
    "{0}: неизвестно, успеет ли ось остановиться между концевиком и упором: задайте mechanical_end_minus и "
    "mechanical_end_plus"};
constexpr text::Entry kHome{"consequence.home",
                            "home {0}: the switch is read over {1} every {2} ms, ±{3} at {4}{5}",
                            "выход в ноль {0}: датчик читается через {1} каждые {2} мс, ±{3} на {4}{5}"};
constexpr text::Entry kFollowing{"consequence.following_error",
                                 "{0}: stops at a following error of {1} at rest, {2} at {3}",
                                 "{0}: останов при рассогласовании {1} в покое, {2} на {3}"};
constexpr text::Entry kFollowingWarn{"consequence.following_error_warn",
                                     "{0}: warns at a following error of {1} at rest, {2} at {3}",
                                     "{0}: предупреждение при рассогласовании {1} в покое, {2} на {3}"};
constexpr text::Entry kInverter{"consequence.inverter",
                                "{0}: {1} rpm is {2} in the register of {3}, standstill is {4}; turns {5}; "
                                "no encoder, so its real speed is not known",
                                "{0}: {1} об/мин — {2} в регистре {3}, покой — {4}; вращение {5}; датчика "
                                "нет, поэтому действительная скорость неизвестна"};
constexpr text::Entry kOnLine{
    "consequence.inverter_on_line",
    "{0}: {1} to {2} Hz on the inverter {3}, {4} in its register at full speed; it counts as lost when it "
    "has "
    "not been heard for {5} ms",
    "{0}: {1}–{2} Гц на преобразователе {3}, при полной частоте в его регистре {4}; считается потерянным, "
    "если не слышен {5} мс"};
constexpr text::Entry kSpindle{"consequence.spindle",
                               "{0}: {1} to {2} rpm, {3} s to full speed; the motor turns at {4} rpm",
                               "{0}: от {1} до {2} об/мин, {3} с до полной частоты; двигатель {4} об/мин"};
constexpr text::Entry kGear{"consequence.gear",
                            "{0}: gear {1} \"{2}\" up to {3} rpm, with the motor at {4} rpm; {5}",
                            "{0}: ступень {1} «{2}» до {3} об/мин, двигатель при этом {4} об/мин; {5}"};
constexpr text::Entry kHomeEdge{"consequence.home_edge",
                                "home {0}: the edge of the switch comes with its time over {1}; {2} for each "
                                "0.1 ms that the interrupt is late, at "
                                "{3}",
                                "выход в ноль {0}: фронт датчика приходит со своим временем через {1}; {2} "
                                "на каждые 0,1 мс опоздания прерывания, "
                                "на {3}"};
constexpr text::Entry kBus{
    "consequence.bus_load",
    "bus {0}: {1} nodes, load {2} % on average, {3} % if all messages fall into one cycle; both figures "
    "assume the most stuff bits possible, a run reports the load that it measures",
    "шина {0}: узлов {1}, загрузка {2} % в среднем и {3} %, если все сообщения попадут в один цикл; обе "
    "величины — при наибольшем числе вставных битов, измеренную загрузку показывает отчёт прогона"};
constexpr text::Entry kFullestCycle{
    "consequence.fullest_cycle",
    "bus {0}: the busiest possible cycle takes {1} % with service data, {2} % with process data alone; what "
    "is due with every SYNC is in time even then, the rest may finish in the next cycle",
    "шина {0}: самый загруженный цикл занимает {1} % с сервисными данными, {2} % с одними данными процесса; "
    "то, что передаётся с каждым SYNC, успевает и тогда, остальное может закончиться в следующем цикле"};
constexpr text::Entry kBySdo{"consequence.by_sdo",
                             "{0}: reached by SDO only: set-point and actual value are exchanged every {1} "
                             "ms at best; after {2} ms without an answer the drive counts as lost",
                             "{0}: связь только по SDO: задание и ответное положение в лучшем случае раз в "
                             "{1} мс; без ответа {2} мс привод считается потерянным"};
constexpr text::Entry kOwnMotion{
    "consequence.own_motion",
    "{0}: its drive plans the motion itself (profile position mode) and lags by up to {1} at {2}",
    "{0}: движение строит сам привод (режим позиционирования), отставание до {1} на {2}"};
constexpr text::Entry kStation{"consequence.station", "{0}: {1} signals, up to {2} ms old",
                               "{0}: сигналов {1}, возраст до {2} мс"};
constexpr text::Entry kEmergencyStop{"consequence.emergency_stop",
                                     "emergency stop: all axes are at rest with their brakes closed after "
                                     "{0} s{1}; the safety relay's delay t_d must be longer",
                                     "аварийный останов: все оси стоят, тормоза держат через {0} с{1}; "
                                     "задержка t_d реле безопасности должна быть больше"};
constexpr text::Entry kBrake{"consequence.brake",
                             "{0}: power is switched off {1} ms after the brake is told to close",
                             "{0}: питание снимается через {1} мс после команды на зажатие тормоза"};
constexpr text::Entry kControlDeath{"consequence.control_death",
                                    "{0}: if the control dies at {1}: {2}; {3}; {4}",
                                    "{0}: если управление прекратит работу на {1}: {2}; {3}; {4}"};

class Sentences {
 public:
  explicit Sentences(const LoadResult& loaded) : loaded_(loaded), m_(loaded.machine) {}

  std::vector<Consequence> all() {
    for (const BusConfig& bus : m_.buses) this->bus(bus);
    for (const AxisConfig& a : m_.axes)
      if (!a.letter.empty() && a.lead > 0.0 && a.counts_per_rev > 0 && a.max_velocity > 0.0 &&
          a.max_acceleration > 0.0 && a.max_jerk > 0.0)
        axis(a);
    emergency_stop();
    for (std::size_t i = 0; i < m_.spindles.size(); ++i) spindle(m_.spindles[i], static_cast<int>(i));
    for (const StationConfig& s : m_.stations) station(s);
    return std::move(lines_);
  }

 private:
  void say(std::string subject, const text::Entry& entry, std::vector<std::string> arguments,
           std::map<std::string, double> figures) {
    lines_.push_back({std::move(subject), &entry, std::move(arguments), std::move(figures)});
  }

  void bus(const BusConfig& bus) {
    if (bus.bit_rate <= 0) return;
    const canopen::SegmentLoad load = segment_load(loaded_, bus);
    say("bus " + bus.name, kBus,
        {bus.name, std::to_string(bus.nodes.size()), text::number(load.load * 100.0, 1),
         text::number(load.worst_cycle * 100.0, 1)},
        {{"load", load.load},
         {"worst_cycle", load.worst_cycle},
         {"nodes", static_cast<double>(bus.nodes.size())}});
    const double fullest = load.worst_cycle + load.worst_service_data;
    if (!bus.nodes.empty() && fullest > 1.0 &&
        canopen::late_pdos(load, static_cast<std::uint32_t>(bus.bit_rate), m_.cycle_ns()).empty())
      say("bus " + bus.name, kFullestCycle,
          {bus.name, text::number(fullest * 100.0, 1), text::number(load.worst_process_data * 100.0, 1)},
          {{"fullest_cycle", fullest}, {"process_data", load.worst_process_data}});
    for (const NodeConfig& node : bus.nodes) by_sdo(bus, node);
  }

  void by_sdo(const BusConfig& bus, const NodeConfig& node) {
    const double period = sdo_round(loaded_, bus.name + "." + node.name);
    if (period <= 0.0) return;
    const double patience = node.sdo_timeout > 0.0
                                ? node.sdo_timeout
                                : static_cast<double>(canopen::SegmentConfig{}.sdo_timeout_ms) * 1e-3;
    say(bus.name + "." + node.name, kBySdo,
        {bus.name + "." + node.name, text::number(period * 1e3), text::number(patience * 1e3)},
        {{"period", period}, {"patience", patience}});
  }

  void axis(const AxisConfig& a) {
    unit_ = text::unit_words(a.unit());
    speed_unit_ = text::unit_words(a.speed_unit());
    const double counts = a.counts_per_unit(), rpm = a.motor_rpm(a.max_velocity);
    say(a.letter, kScale,
        {a.letter, "1 " + unit_, text::number(counts, 4), speed(a.max_velocity), text::number(rpm, 1)},
        {{"counts_per_unit", counts}, {"max_velocity", a.max_velocity}, {"motor_rpm", rpm}});
    const Stop stop = stop_from(a.max_velocity, a.max_acceleration, a.max_jerk);
    say(a.letter, kStop, {a.letter, speed(a.max_velocity), length(stop.way), text::number(stop.time, 3)},
        {{"stop_distance", stop.way}, {"stop_time", stop.time}});
    // The stop may begin in full acceleration, which has to be taken back first.
    const double back = std::min(a.max_acceleration / a.max_jerk, std::sqrt(a.max_velocity / a.max_jerk));
    longest_stop_ = std::max(longest_stop_, stop.time + back + brake_command_time(loaded_, a) +
                                                (a.brake.present() ? a.brake.engage_delay : 0.0));
    margin(a);
    if (const double lag = own_motion_lag(loaded_, a); lag > 0.0)
      say(a.letter, kOwnMotion, {a.letter, length(lag), speed(a.max_velocity)}, {{"lag", lag}});
    const double moving = a.following_error_stop + a.following_error_velocity * a.max_velocity;
    say(a.letter, kFollowing,
        {a.letter, length(a.following_error_stop), length(moving), speed(a.max_velocity)},
        {{"at_rest", a.following_error_stop}, {"at_max_velocity", moving}});
    if (a.following_error_warn > 0.0) {
      const double warns = a.following_error_warn + a.following_error_velocity * a.max_velocity;
      say(a.letter, kFollowingWarn,
          {a.letter, length(a.following_error_warn), length(warns), speed(a.max_velocity)},
          {{"at_rest", a.following_error_warn}, {"at_max_velocity", warns}});
    }
    home(a);
    if (a.brake.present()) {
      const double after = brake_command_time(loaded_, a) + a.brake.engage_delay;
      say(a.letter, kBrake, {a.letter, text::number(after * 1e3)},
          {{"engage_delay", a.brake.engage_delay}, {"power_off_after", after}});
    }
    dies(a);
  }

  void dies(const AxisConfig& a) {
    const auto death = control_death(loaded_, a);
    if (!death) return;
    const ControlDeathWords words = words_of(*death, a);
    std::map<std::string, double> figures;
    const auto figure = [&figures](const char* name, double value) {
      if (value != kNoLimit) figures[name] = value;
    };
    figure("notices", death->notices);
    figure("following_error", death->follows);
    figure("brake_closed", death->brake_closed);
    figure("falls_for", death->falls_for);
    if (death->falls_for != kNoLimit) figure("falls", death->falls);
    say(a.letter, kControlDeath, {a.letter, speed(a.max_velocity), words.drive, words.brake, words.fall},
        std::move(figures));
  }

  void emergency_stop() {
    if (longest_stop_ <= 0.0) return;
    // The input is read, answered and obeyed in three cycles.
    const double time = std::ceil((longest_stop_ + 3.0 * m_.control.cycle_time) * 100.0) / 100.0;
    double turning = 0.0;  // an inverter is told 0 at once and says nothing of its way to rest
    for (const SpindleConfig& s : m_.spindles)
      if (s.speed_output.empty())
        turning = std::max(turning, s.max_speed / s.acceleration + command_wait(s.drive));
    turning = std::ceil(turning * 100.0 - 1e-6) / 100.0;
    const std::string seconds = text::number(turning, 2);
    say("emergency stop", kEmergencyStop,
        {text::number(time, 2), turning > 0.0 ? text::both(", the spindle after " + seconds + " s",
                                                           ", шпиндель через " + seconds + " с")
                                              : ""},
        {{"stop_time", time}, {"spindle_stop_time", turning}});
  }

  /// How long a command may wait for its frame, beyond the cycle that gives it.
  double command_wait(const std::string& reference) const {
    namespace object = canopen::object;
    const DeviceConfig* device = device_of(loaded_, reference);
    if (device == nullptr) return 0.0;
    if (device->behaviour.sdo_only) return sdo_round(loaded_, reference);
    return (slowest(device->rpdos,
                    {object::kControlword, object::kTargetVelocity, object::kVlTargetVelocity}) -
            1) *
           m_.control.cycle_time;
  }

  void margin(const AxisConfig& a) {
    if (!std::isfinite(a.hard_limit_plus) || !std::isfinite(a.hard_limit_minus)) return;
    const double plus = a.hard_limit_plus - a.travel_max, minus = a.travel_min - a.hard_limit_minus;
    say(a.letter, kMargin, {a.letter, length(minus), length(plus)},
        {{"margin_minus", minus}, {"margin_plus", plus}});
    bool known = false;
    for (const bool side : {false, true}) {
      const auto o = overrun(loaded_, a, side);
      if (!o) continue;
      known = true;
      say(a.letter, kOverrun,
          {a.letter, length(o->room), side ? "+" : "-", speed(std::floor(o->safe_velocity * 10.0) / 10.0),
           speed(o->velocity), length(o->way)},
          {{"room", o->room},
           {"safe_velocity", o->safe_velocity},
           {"velocity", o->velocity},
           {"overrun", o->way}});
    }
    if (!known && !(a.limit_plus.empty() && a.limit_minus.empty()))
      say(a.letter, kEndUnknown, {a.letter}, {});
  }

  /// The switch is seen once in the period of its station: that long the axis moves on unseen.
  void home(const AxisConfig& a) {
    const HomingConfig& h = a.home;
    int station = -1;
    if (h.switch_point.empty() || m_.point(h.switch_point, &station) == nullptr) return;
    const StationConfig& s = m_.stations[static_cast<std::size_t>(station)];
    const double period = std::max(read_every(loaded_, s), m_.control.cycle_time);
    const bool index = h.method == HomingMethod::switch_and_index;
    // Without an index the slow edge is the zero; with one it only has to find the right turn.
    const double v = h.method == HomingMethod::switch_only ? h.slow : h.fast;
    if (v <= 0.0) return;
    static constexpr const char* kNames[] = {"Modbus", "GPIO", "CAN", "CAN", "USB"};
    if (m_.point(h.switch_point)->edges && !index) {
      constexpr double kLate = 1e-4;
      return say(a.letter, kHomeEdge,
                 {a.letter, kNames[static_cast<std::size_t>(s.kind)], uncertainty(v * kLate), speed(v)},
                 {{"each_0.1_ms", v * kLate}, {"velocity", v}});
    }
    say(a.letter, kHome,
        {a.letter, kNames[static_cast<std::size_t>(s.kind)], text::number(period * 1e3),
         uncertainty(v * period), speed(v),
         index ? text::both("; the index pulse then gives the exact zero", "; точный ноль даёт нулевая метка")
               : ""},
        {{"uncertainty", v * period}, {"velocity", v}, {"period", period}});
  }

  void spindle(const SpindleConfig& s, int index) {
    const double motor = s.largest_motor_rpm();
    const std::string who = s.name.empty() ? "S" + (index == 0 ? "" : std::to_string(index + 1)) : s.name;
    say("S" + (index == 0 ? std::string() : std::to_string(index + 1)), kSpindle,
        {who, text::number(s.min_speed), text::number(s.max_speed),
         text::number(s.max_speed / s.acceleration, 2), text::number(motor, 1)},
        {{"max_speed", s.max_speed},
         {"motor_rpm", motor},
         {"time_to_full_speed", s.max_speed / s.acceleration}});
    gears(s, "S" + (index == 0 ? std::string() : std::to_string(index + 1)), who);
    inverter(s, "S" + (index == 0 ? std::string() : std::to_string(index + 1)), who);
    on_line(s, "S" + (index == 0 ? std::string() : std::to_string(index + 1)), who);
  }

  void gears(const SpindleConfig& s, const std::string& subject, const std::string& who) {
    for (std::size_t g = 0; g < s.gears.size(); ++g) {
      const GearConfig& gear = s.gears[g];
      const double most = std::min(gear.max_speed, s.max_speed);
      const std::string change =
          gear.confirm.empty()
              ? text::both(
                    "engaged " + text::number(s.gear_change_time, 2) + " s after its output, by assumption",
                    "считается включённой через " + text::number(s.gear_change_time, 2) + " с после выхода")
              : text::both("confirmed by " + gear.confirm, "подтверждается входом " + gear.confirm);
      say(subject, kGear,
          {who, std::to_string(g + 1), gear.name, text::number(most), text::number(most * gear.ratio(), 1),
           change},
          {{"max_speed", most}, {"motor_rpm", most * gear.ratio()}});
    }
  }

  void on_line(const SpindleConfig& s, const std::string& subject, const std::string& who) {
    for (const StationConfig& station : m_.stations) {
      const DeviceConfig* device = station.name == s.inverter ? loaded_.device(station.device) : nullptr;
      if (device == nullptr || !(s.rated_speed > 0.0) || !(device->inverter.frequency_unit > 0.0)) continue;
      const double full = std::round(s.largest_hertz() / device->inverter.frequency_unit);
      const double lost = station.period * modbus::kStaleAfterPeriods;
      say(subject, kOnLine,
          {who, text::number(s.hertz(s.min_speed), 2), text::number(s.largest_hertz(), 2),
           station.line + "." + station.name, text::number(full), text::number(lost * 1e3)},
          {{"frequency_at_max_speed", s.largest_hertz()},
           {"register_at_max_speed", full},
           {"lost_after", lost}});
    }
  }

  void inverter(const SpindleConfig& s, const std::string& subject, const std::string& who) {
    const PointConfig* p = s.speed_output.empty() ? nullptr : m_.point(s.speed_output);
    if (p == nullptr || p->scale == 0.0) return;
    const double full = std::round((s.largest_motor_rpm() - p->shift) / p->scale),
                 rest = std::round((0.0 - p->shift) / p->scale);
    const std::string ways = s.ccw_output.empty()
                                 ? text::both("clockwise only", "только по часовой стрелке")
                                 : text::both("in both directions, reversing through standstill",
                                              "в обе стороны, реверс через остановку");
    say(subject, kInverter,
        {who, text::number(s.max_speed), text::number(full), s.speed_output, text::number(rest), ways},
        {{"register_at_max_speed", full}, {"register_at_rest", rest}});
  }

  void station(const StationConfig& s) {
    // A poll may just have passed when a signal changes, and the answer then waits for its cycle.
    const double age = read_every(loaded_, s) + m_.control.cycle_time;
    say(s.name, kStation, {s.name, std::to_string(s.points.size()), text::number(age * 1e3)},
        {{"signals", static_cast<double>(s.points.size())}, {"age", age}});
  }

  std::string length(double v) const { return text::number(v, 3) + " " + unit_; }
  /// With a decimal always: what is not known is no exact number.
  std::string uncertainty(double v) const {
    const std::string number = text::number(v, 3);
    return number + (number.find('.') == std::string::npos ? ".0 " : " ") + unit_;
  }
  std::string speed(double v) const { return text::number(v, 3) + " " + speed_unit_; }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  std::vector<Consequence> lines_;
  std::string unit_, speed_unit_;
  double longest_stop_ = 0.0;  ///< with the engaging of its brake, s
};

}  // namespace

std::string Consequence::str(text::Language language) const {
  return text::render(*entry, arguments, language);
}

std::vector<Consequence> consequences(const LoadResult& loaded) { return Sentences(loaded).all(); }

}  // namespace servogate::machine
