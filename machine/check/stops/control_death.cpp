// SPDX-License-Identifier: Apache-2.0
#include "machine/check/stops/control_death.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/text/units.hpp"
#include "kernel/cycle/gate/interface_places.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/consequences.hpp"

namespace servogate::machine {

namespace {

namespace object = canopen::object;
using Reaction = ControlDeath::Reaction;
using Brake = ControlDeath::Brake;

constexpr double kGravity = 9810.0;          // mm/s2, the worst that a screw or a belt can do
constexpr std::int16_t kStandardOption = 2;  // of 605Ah and 605Eh, CiA 402-2

/// One hanging axis with what its files say of its drive.
class Hanging {
 public:
  Hanging(const LoadResult& loaded, const AxisConfig& axis, const NodeConfig& node, const BusConfig& bus,
          const DeviceConfig& device)
      : loaded_(loaded),
        axis_(axis),
        bus_(bus),
        device_(device),
        profile_(drive_profile(device, node, axis.counts_per_rev)) {
    const auto files = loaded.node_files.find(axis.drive);
    if (files != loaded.node_files.end())
      if (auto entries = canopen::parse_concise_dcf(files->second.concise_dcf))
        configuration_ = std::move(*entries);
  }

  ControlDeath judge() const {
    ControlDeath d;
    d.notices = notices();
    d.on_silence = on_silence();
    following(d);
    brake(d);
    fall(d, d.notices, d.on_silence);
    if (d.follows < d.notices) fall(d, d.follows, d.on_following);
    d.by_order = d.falls_for > axis_.brake.engage_delay * (1.0 + 1e-9);
    return d;
  }

 private:
  /// What is written into an object at boot: by the node, the device file, or the node's configuration.
  std::optional<std::uint32_t> written(std::uint16_t index) const {
    std::optional<std::uint32_t> value;
    for (const canopen::ConfigurationEntry& e : configuration_) {
      if (e.index != index || e.subindex != 0 || e.data.size() > 4) continue;
      value = 0;
      for (std::size_t i = 0; i < e.data.size(); ++i) *value |= std::uint32_t{e.data[i]} << 8 * i;
    }
    for (const canopen::SdoSetting& s : profile_.settings)
      if (s.index == index && s.subindex == 0) value = s.value;
    return value;
  }
  std::int16_t option(std::uint16_t index) const {
    return static_cast<std::int16_t>(written(index).value_or(kStandardOption));
  }

  double notices() const {
    const BehaviourConfig& b = device_.behaviour;
    double time = kNoLimit;
    if (b.guard_time > 0.0)
      time = b.guard_time * b.life_time_factor;
    else if (b.heartbeat_consumer)
      time = heartbeat_missed(bus_);
    for (const PdoConfig& pdo : device_.rpdos)
      if (pdo.event > 0.0 && !pdo.remote()) time = std::min(time, pdo.event);
    return time;
  }
  static double heartbeat_missed(const BusConfig& bus) { return 3e-3 * planned_services(bus).heartbeat_ms; }

  Reaction on_silence() const {
    switch (device_.behaviour.connection_loss) {
      case ConnectionLoss::none:
        return Reaction::holds;
      case ConnectionLoss::disable_voltage:
        return Reaction::lets_go;
      case ConnectionLoss::quick_stop: {
        const std::int16_t code = option(object::kQuickStopOption);
        return code == 0 ? Reaction::lets_go : code < 5 ? Reaction::ramps_down : Reaction::holds;
      }
      case ConnectionLoss::fault:
        return on_fault();
    }
    return Reaction::holds;
  }
  /// In the state Fault the drive function is off: whatever 605Eh says, the torque goes in the end.
  Reaction on_fault() const {
    return option(object::kFaultReactionOption) == 0 ? Reaction::lets_go : Reaction::ramps_down;
  }

  /// A drive that forms the motion to its set-point by itself goes on to it.
  void following(ControlDeath& d) const {
    constexpr std::uint32_t kOff = 0xFFFF'FFFF;
    if (device_.behaviour.position_mode == PositionMode::pp) return;
    const auto window = written(object::kFollowingErrorWindow),
               time = written(object::kFollowingErrorTimeOut);
    if (window == kOff) return;
    d.on_following = on_fault();
    d.following_known = window && time;
    d.follows = 0.0;
    if (d.following_known) d.follows = *window / axis_.counts_per_unit() / axis_.max_velocity + 1e-3 * *time;
    if (d.follows >= d.notices) d.follows = kNoLimit;
  }

  void brake(ControlDeath& d) const {
    const BrakeConfig& b = axis_.brake;
    int station = -1;
    if (b.drive_output && device_.behaviour.brake_interlock) {
      d.brake = Brake::drive;
      return;
    }
    if (!b.point.empty() && loaded_.machine.point(b.point, &station) != nullptr) {
      const StationConfig& s = loaded_.machine.stations[static_cast<std::size_t>(station)];
      if (const double silence = module_notices(s); silence != kNoLimit) {
        d.brake = Brake::station;
        d.brake_closed = silence + b.engage_delay;
      }
    }
    if (b.relay_delay > 0.0 && !loaded_.machine.safety.control_alive.empty() &&
        b.relay_delay + b.engage_delay < d.brake_closed) {
      d.brake = Brake::relay;
      d.brake_closed = b.relay_delay + b.engage_delay;
    }
  }

  /// When an I/O module takes its outputs to where they belong without the control.
  double module_notices(const StationConfig& station) const {
    int bus = -1;
    const NodeConfig* node = loaded_.machine.node(station.node, &bus);
    const DeviceConfig* device = node == nullptr ? nullptr : loaded_.device(node->device);
    if (station.kind != StationKind::canopen || device == nullptr || node->unsupervised) return kNoLimit;
    double time =
        device->behaviour.connection_loss != ConnectionLoss::none && device->behaviour.heartbeat_consumer
            ? heartbeat_missed(loaded_.machine.buses[static_cast<std::size_t>(bus)])
            : kNoLimit;
    for (const PdoConfig& pdo : device->rpdos)
      if (pdo.event > 0.0 && !pdo.remote()) time = std::min(time, pdo.event);
    return time;
  }

  /// The torque goes not before `at`. What the ramp takes is not counted: a slow axis has none.
  void fall(ControlDeath& d, double at, Reaction reaction) const {
    if (reaction == Reaction::holds || at == kNoLimit) return;
    const bool moves = reaction == Reaction::lets_go;
    double time = 0.0;
    if (d.brake != Brake::drive)
      time = std::max(0.0, d.brake_closed - at);
    else if (moves)
      time = axis_.brake.engage_delay;
    if (time < d.falls_for || (time == d.falls_for && reaction <= d.worst)) return;
    d.falls_for = time;
    d.worst = reaction;
    if (axis_.type == AxisType::linear && time != kNoLimit)
      d.falls = time * (moves ? axis_.max_velocity : 0.0) + kGravity / 2.0 * time * time;
  }

  const LoadResult& loaded_;
  const AxisConfig& axis_;
  const BusConfig& bus_;
  const DeviceConfig& device_;
  canopen::DriveProfile profile_;
  std::vector<canopen::ConfigurationEntry> configuration_;
};

std::string ms(double seconds) { return text::number(seconds * 1e3, 1) + " " + text::both("ms", "мс"); }

std::string reaction_words(Reaction r) {
  switch (r) {
    case Reaction::holds:
      return text::both("and keeps its torque", "и сохраняет момент");
    case Reaction::ramps_down:
      return text::both("and loses its torque after braking", "и после торможения снимает момент");
    case Reaction::lets_go:
      return text::both("and loses its torque at once", "и сразу снимает момент");
  }
  return {};
}

std::string drive_words(const ControlDeath& d) {
  std::string words;
  if (d.follows != kNoLimit) {
    const std::string when = d.following_known ? text::both("after ", "через ") + ms(d.follows)
                                               : text::both("(6065h and 6066h in the drive say when)",
                                                            "(когда — задают 6065h и 6066h привода)");
    words = text::both("the drive trips on following error ", "привод отключается по рассогласованию ") +
            when + " " + reaction_words(d.on_following) + ", ";
    words += d.notices == kNoLimit ? text::both("and does not detect that the control is silent",
                                                "а пропажи управления не обнаруживает")
                                   : text::both("or detects that the control is silent after ",
                                                "либо обнаруживает пропажу управления через ") +
                                         ms(d.notices) + " " + reaction_words(d.on_silence);
    return words;
  }
  if (d.notices == kNoLimit)
    return text::both("the drive does not detect it and keeps its torque",
                      "привод этого не обнаруживает и сохраняет момент");
  return text::both("the drive detects that the control is silent after ",
                    "привод обнаруживает пропажу управления через ") +
         ms(d.notices) + " " + reaction_words(d.on_silence);
}

std::string brake_words(const ControlDeath& d, const AxisConfig& a) {
  switch (d.brake) {
    case Brake::drive:
      return text::both("the drive closes the brake together with its power stage",
                        "тормоз накладывает сам привод вместе с силовой частью");
    case Brake::station:
      return text::both("the module that switches the brake closes it within ",
                        "модуль тормоза накладывает его за ") +
             ms(d.brake_closed);
    case Brake::relay:
      return text::both("the relay on safety.control_alive closes the brake within ",
                        "реле по сигналу safety.control_alive накладывает тормоз за ") +
             ms(d.brake_closed);
    case Brake::nobody: {
      const std::string output = a.brake.drive_output ? "60FEh" : "\"" + a.brake.point + "\"";
      return text::both("the brake stays open, because its output (" + output + ") is the control's",
                        "тормоз остаётся отпущенным: его выходом (" + output + ") управляет система");
    }
  }
  return {};
}

std::string fall_words(const ControlDeath& d, const AxisConfig& a) {
  if (d.falls_for == kNoLimit)
    return text::both("the axis falls until something stops it",
                      "ось падает, пока что-нибудь её не остановит");
  if (d.falls_for <= 0.0) return text::both("the axis does not fall", "ось не падает");
  std::string words = text::both("the axis falls for up to ", "ось падает до ") + ms(d.falls_for);
  if (d.falls > 0.0)
    words += text::both(", by up to ", ", на расстояние до ") + text::number(d.falls, 1) + " " +
             text::unit_words(a.unit());
  return words;
}

}  // namespace

std::optional<ControlDeath> control_death(const LoadResult& loaded, const AxisConfig& axis) {
  int bus = -1;
  const NodeConfig* node = loaded.machine.node(axis.drive, &bus);
  const DeviceConfig* device = node == nullptr ? nullptr : loaded.device(node->device);
  if (!axis.brake.present() || device == nullptr || !device->drive() || axis.lead <= 0.0 ||
      axis.counts_per_rev <= 0 || axis.max_velocity <= 0.0)
    return std::nullopt;
  return Hanging(loaded, axis, *node, loaded.machine.buses[static_cast<std::size_t>(bus)], *device).judge();
}

ControlDeathWords words_of(const ControlDeath& death, const AxisConfig& axis) {
  return {drive_words(death), brake_words(death, axis), fall_words(death, axis)};
}

namespace {

std::string remedy(const ControlDeath& d, const AxisConfig& a) {
  if (d.worst == Reaction::lets_go && !d.by_order)
    return text::both(
        "make the drive brake first: 605Ah and 605Eh other than 0, connection_loss fault or quick_stop",
        "сначала должен тормозить привод: 605Ah и 605Eh не 0, connection_loss fault или quick_stop");
  return a.brake.drive_output
             ? text::both(
                   "let the drive operate the brake (brake_interlock in its device file), or supply the "
                   "brake through a relay that watches safety.control_alive (brake.relay_delay)",
                   "поручите тормоз приводу (brake_interlock файла устройства) либо питайте тормоз через "
                   "реле, следящее за safety.control_alive (brake.relay_delay)")
             : text::both(
                   "connect the brake to the drive (drive_output, brake_interlock), or supply it through a "
                   "fast relay that watches safety.control_alive (brake.relay_delay)",
                   "подключите тормоз к приводу (drive_output, brake_interlock) либо питайте его через "
                   "быстрое реле, следящее за safety.control_alive (brake.relay_delay)");
}

void check_axis(const LoadResult& loaded, std::size_t index, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  const AxisConfig& a = m.axes[index];
  const std::string path = "axis." + std::to_string(index);
  if (a.brake.relay_delay > 0.0) {
    const double change = static_cast<double>(cycle::places::kAliveCycles * m.cycle_ns()) * 1e-9;
    const Where at = m.where(path + ".brake.relay_delay");
    if (m.safety.control_alive.empty())
      reading.error(at, finding::kRelayWatchesNothing, {a.letter});
    else if (a.brake.relay_delay <= change)
      reading.error(at, finding::kRelayTooQuick,
                    {a.letter, text::number(a.brake.relay_delay * 1e3), text::number(change * 1e3)});
  }
  const auto death = control_death(loaded, a);
  if (!death || (!death->by_order && death->falls <= a.brake.slip_window)) return;
  const ControlDeathWords words = words_of(*death, a);
  const std::string speed = text::number(a.max_velocity) + " " + text::unit_words(a.speed_unit());
  const std::vector<std::string> arguments{a.letter,    speed,      words.drive,
                                           words.brake, words.fall, remedy(*death, a)};
  if (a.vertical && death->by_order)
    reading.error(m.where(path + ".brake"), finding::kFallsWithControl, arguments);
  else
    reading.warning(m.where(path + ".brake"), finding::kFallsWithControl, arguments);
}

}  // namespace

void check_control_death(const LoadResult& loaded, Reading& reading) {
  for (std::size_t i = 0; i < loaded.machine.axes.size(); ++i) check_axis(loaded, i, reading);
}

}  // namespace servogate::machine
