// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/text/units.hpp"
#include "machine/check/boot_objects.hpp"
#include "machine/check/check.hpp"
#include "machine/check/device_kind.hpp"
#include "machine/check/findings.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/consequences.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

/// With what a segment fits, as far as the machine file can say it: a cycle no longer than the longest one,
/// otherwise a faster rate; beside it more segments.
std::string fits_with(const canopen::LoadAdvice& advice, int rate_kbit) {
  std::string words, n = std::to_string(advice.segments);
  if (static_cast<double>(advice.cycle_ns) * 1e-9 <= kLongestCycle * (1.0 + 1e-9)) {
    const std::string ms = text::number(static_cast<double>(advice.cycle_ns) * 1e-6);
    words = text::both("with a cycle of " + ms + " ms", "при цикле " + ms + " мс");
  } else if (rate_kbit > 0) {
    const std::string rate = std::to_string(rate_kbit);
    words = text::both("with bit_rate = \"" + rate + " kbit/s\"", "при bit_rate = \"" + rate + " kbit/s\"");
  }
  if (advice.segments > 0)
    words += words.empty() ? text::both("with its nodes on " + n + " segments",
                                        "при разделении узлов на " + n + " сегмента(ов)")
                           : text::both(", or with its nodes on " + n + " segments",
                                        ", или при разделении узлов на " + n + " сегмента(ов)");
  const std::string longest = text::number(kLongestCycle * 1e3);
  if (words.empty())
    words =
        text::both("with fewer nodes or less process data only: no bit_rate and no cycle up to " + longest +
                       " ms is enough",
                   "только при меньшем числе узлов или данных процесса: не хватит ни bit_rate, ни цикла до " +
                       longest + " мс");
  return words;
}
/// The slowest rate with which it fits, kbit/s; 0: none.
int rate_that_fits(const MachineConfig& m, const std::vector<canopen::NodeConfig>& nodes,
                   const canopen::SegmentServices& services) {
  for (const int kbit : kBitRates)
    if (canopen::segment_load(static_cast<std::uint32_t>(kbit) * 1000, m.cycle_ns(), nodes, services).load <=
        canopen::kLoadWarning)
      return kbit;
  return 0;
}
/// What else would relieve a bus; empty where it would not.
std::string shorter_data(double load, double with_4_byte_pdo) {
  if (with_4_byte_pdo >= load || with_4_byte_pdo > canopen::kLoadError) return {};
  const std::string percent = text::number(with_4_byte_pdo * 100.0, 1);
  return text::both("; with 4-byte process data it would be " + percent + " %",
                    "; с 4-байтными PDO загрузка была бы " + percent + " %");
}

std::string homing_methods_of(const DeviceConfig& device) {
  std::string words;
  for (const std::string& m : device.behaviour.homing_methods) words += (words.empty() ? "" : ", ") + m;
  return words.empty() ? "1-14, 17-30, 33-37" : words;
}

class DeviceUse {
 public:
  DeviceUse(const LoadResult& loaded, Reading& reading)
      : loaded_(loaded), m_(loaded.machine), reading_(reading) {}

  void nodes() {
    for (std::size_t b = 0; b < m_.buses.size(); ++b)
      for (std::size_t n = 0; n < m_.buses[b].nodes.size(); ++n) {
        const NodeConfig& node = m_.buses[b].nodes[n];
        const std::string path = "bus." + std::to_string(b) + ".node." + std::to_string(n);
        const DeviceConfig* device = loaded_.device(node.device);
        if (device != nullptr && known(*device) && !device->drive() && !device->terminals())
          reading_.error(
              m_.where(path + ".device"), finding::kWrongDevice,
              {node.device, kind_name(device->kind), "servo, stepper, spindle, canopen_io, canopen_encoder"});
        if (device != nullptr && known(*device) && device->drive() && !node.unsupervised &&
            !canopen::stops_by_itself(drive_profile(*device, node, 0)))
          reading_.error(m_.where(path + ".device"), finding::kUnsupervised, {node.name, node.device});
        if (device != nullptr && known(*device) && device->drive()) status(*device, node, path);
        objects(node, path);
      }
  }

  /// What moves something needs a drive.
  void drives() {
    const auto drive = [this](const std::string& reference, const std::string& path) {
      const DeviceConfig* device = of_node(reference);
      if (device != nullptr && known(*device) && device->terminals())
        reading_.error(m_.where(path), finding::kWrongDevice,
                       {m_.node(reference)->device, kind_name(device->kind), "servo, stepper, spindle"});
    };
    for (std::size_t i = 0; i < m_.axes.size(); ++i)
      drive(m_.axes[i].drive, "axis." + std::to_string(i) + ".drive");
    for (std::size_t i = 0; i < m_.spindles.size(); ++i)
      drive(m_.spindles[i].drive, "spindle." + std::to_string(i) + ".drive");
    for (std::size_t i = 0; i < m_.stations.size(); ++i)
      if (m_.stations[i].kind == StationKind::drive)
        drive(m_.stations[i].node, "station." + std::to_string(i) + ".node");
  }

  void axes() {
    for (std::size_t i = 0; i < m_.axes.size(); ++i) {
      const AxisConfig& a = m_.axes[i];
      const std::string path = "axis." + std::to_string(i);
      const DeviceConfig* device = of_node(a.drive);
      if (device == nullptr || a.lead <= 0.0 || a.counts_per_rev <= 0) continue;
      const std::string speed = text::number(a.max_velocity) + " " + text::unit_words(a.speed_unit());
      motor(*device, m_.node(a.drive)->device, a.letter, speed, a.motor_rpm(a.max_velocity),
            path + ".max_velocity");
      if (device->motor.counts_per_rev > 0 && device->motor.counts_per_rev != a.counts_per_rev)
        reading_.error(m_.where(path + ".counts_per_rev"), finding::kDeviceCounts,
                       {a.letter, std::to_string(a.counts_per_rev),
                        std::to_string(device->motor.counts_per_rev), m_.node(a.drive)->device});
      if (a.home.method == HomingMethod::drive && a.home.drive_method != 0 &&
          !has_homing_method(*device, a.home.drive_method))
        reading_.error(m_.where(path + ".home.drive_method"), finding::kHomeMethodUnknown,
                       {a.letter, std::to_string(a.home.drive_method), m_.node(a.drive)->device,
                        homing_methods_of(*device)});
      own_motion(a, *device, path);
      every_cycle(a, *device, path);
      torque(a, *device, path);
      if (a.brake.drive_output && !device->motor.brake_output)
        reading_.error(m_.where(path + ".brake.drive_output"), finding::kNoBrakeOutput,
                       {a.letter, m_.node(a.drive)->device});
    }
  }

  void spindles() {
    for (std::size_t i = 0; i < m_.spindles.size(); ++i) {
      const SpindleConfig& s = m_.spindles[i];
      const DeviceConfig* device = of_node(s.drive);
      if (device == nullptr) continue;
      if (device->behaviour.sdo_only && device->behaviour.speed_mode == SpeedMode::csv)
        reading_.error(m_.where("spindle." + std::to_string(i) + ".drive"), finding::kSdoOnlyMode,
                       {"speed_mode", "pv, vl"});
      if (s.counts_per_rev == 0 && device->motor.counts_per_rev == 0)
        reading_.error(m_.where("spindle." + std::to_string(i)), finding::kSpindleCounts,
                       {std::to_string(i + 1), m_.node(s.drive)->device});
      motor(*device, m_.node(s.drive)->device,
            text::both("spindle " + std::to_string(i + 1), "шпиндель " + std::to_string(i + 1)),
            text::number(s.max_speed) + " " + text::unit_words("rpm"), s.largest_motor_rpm(),
            "spindle." + std::to_string(i) + ".max_speed");
    }
  }

  void load() {
    for (std::size_t b = 0; b < m_.buses.size(); ++b) {
      const BusConfig& bus = m_.buses[b];
      if (bus.bit_rate <= 0 || bus.nodes.empty()) continue;
      const std::vector<canopen::NodeConfig> nodes = planned_nodes(loaded_, bus);
      const auto rate = static_cast<std::uint32_t>(bus.bit_rate);
      const canopen::SegmentLoad load = segment_load(loaded_, bus);
      if (load.load <= canopen::kLoadError) late_pdos(bus, b, load);
      const text::Entry* entry = canopen::load_text(load.load);
      if (entry == nullptr) continue;
      const canopen::SegmentServices services = planned_services(bus);
      const canopen::LoadAdvice advice = canopen::advise(rate, m_.cycle_ns(), nodes, services);
      const bool error = load.load > canopen::kLoadError;
      const double limit = error ? canopen::kLoadError : canopen::kLoadWarning;
      const std::vector<std::string> arguments{bus.name, text::number(load.load * 100.0, 1),
                                               text::number(limit * 100.0, 1),
                                               fits_with(advice, rate_that_fits(m_, nodes, services)),
                                               shorter_data(load.load, advice.load_with_4_byte_pdo)};
      const Where at = m_.where("bus." + std::to_string(b) + ".bit_rate");
      if (error)
        reading_.error(at, *entry, arguments);
      else
        reading_.warning(at, *entry, arguments);
    }
  }

 private:
  static bool known(const DeviceConfig& device) { return kind_known(device); }

  /// What speaks on event only, and has no timer, may be silent because it is dead.
  void status(const DeviceConfig& device, const NodeConfig& node, const std::string& path) {
    if (node.silent_status) return;
    for (const PdoConfig& pdo : device.tpdos) {
      const bool has_status = std::any_of(pdo.objects.begin(), pdo.objects.end(),
                                          [](const PdoObject& o) { return o.index == 0x6041; });
      if (has_status && !pdo.cyclic() && !pdo.remote() && pdo.event <= 0.0)
        reading_.error(
            m_.where(path + ".device"), finding::kSilentStatus,
            {node.name, std::to_string(pdo.number), std::to_string(pdo.transmission), node.device});
    }
  }

  /// A drive that forms its motion by itself cannot keep to a path.
  void own_motion(const AxisConfig& a, const DeviceConfig& device, const std::string& path) {
    const bool by_sdo = device.behaviour.sdo_only;
    if (!by_sdo && device.behaviour.position_mode != PositionMode::pp) return;
    const std::string name = m_.node(a.drive)->device;
    if (!a.auxiliary)
      return reading_.error(
          m_.where(path + ".drive"), finding::kOwnMotion,
          {a.letter, name,
           by_sdo ? text::both("only answers SDO", "отвечает только по SDO")
                  : text::both("works in profile position", "работает в режиме позиционирования")});
    if (device.behaviour.position_mode != PositionMode::pp)
      return reading_.error(m_.where(path + ".drive"), finding::kSdoOnlyMode, {"position_mode", "pp"});
    const double lag = own_motion_lag(loaded_, a);
    const double allowed = a.following_error_stop + a.following_error_velocity * a.max_velocity;
    const std::string unit = " " + text::unit_words(a.unit());
    if (a.max_acceleration > 0.0 && lag > allowed)
      reading_.warning(m_.where(path + ".following_error_velocity"), finding::kOwnMotionLag,
                       {a.letter, name, text::number(lag, 3) + unit,
                        text::number(a.max_velocity) + " " + text::unit_words(a.speed_unit()),
                        text::number(allowed, 3) + unit});
  }

  /// Torque set-points and what comes of them belong into every cycle.
  void torque(const AxisConfig& a, const DeviceConfig& device, const std::string& path) {
    if (a.torque_max <= 0.0 || !known(device)) return;
    const std::string name = m_.node(a.drive)->device;
    const auto mapped = [](const std::vector<PdoConfig>& pdos, std::uint16_t index) {
      return std::any_of(pdos.begin(), pdos.end(), [index](const PdoConfig& pdo) {
        return std::any_of(pdo.objects.begin(), pdo.objects.end(),
                           [index](const PdoObject& o) { return o.index == index; });
      });
    };
    if (!mapped(device.rpdos, 0x6071))
      reading_.error(m_.where(path + ".torque_max"), finding::kTorqueUnmapped,
                     {a.letter, name, "6071:00/16", "rpdo"});
    if (!mapped(device.tpdos, 0x6077))
      reading_.error(m_.where(path + ".torque_max"), finding::kTorqueUnmapped,
                     {a.letter, name, "6077:00/16", "tpdo"});
    const double rated = device.motor.rated_torque, peak = device.motor.peak_torque;
    if (rated > 0.0 && peak > 0.0 && a.torque_max > 100.0 * peak / rated)
      reading_.error(m_.where(path + ".torque_max"), finding::kTorqueAbovePeak,
                     {a.letter, text::number(a.torque_max), text::number(100.0 * peak / rated, 1), name});
  }

  /// Where the mean is fine and the cycle of a SYNC that many wait for is not.
  void late_pdos(const BusConfig& bus, std::size_t index, const canopen::SegmentLoad& load) {
    std::string names;
    for (const canopen::FrameLoad* frame :
         canopen::late_pdos(load, static_cast<std::uint32_t>(bus.bit_rate), m_.cycle_ns()))
      names += (names.empty() ? "" : ", ") + frame->what + " (" + node_name(bus, frame->node) + ")";
    if (names.empty()) return;
    reading_.warning(m_.where("bus." + std::to_string(index) + ".bit_rate"), finding::kPdosTooLate,
                     {bus.name, text::number(load.worst_process_data * 100.0, 1), names,
                      text::number(load.load * 100.0, 1)});
  }
  static std::string node_name(const BusConfig& bus, canopen::NodeId id) {
    for (const NodeConfig& node : bus.nodes)
      if (node.id == id) return node.name;
    return std::to_string(id);
  }

  const DeviceConfig* of_node(const std::string& reference) const {
    const NodeConfig* node = m_.node(reference);
    return node == nullptr ? nullptr : loaded_.device(node->device);
  }

  void objects(const NodeConfig& node, const std::string& path) {
    check_boot_objects(
        node.objects, loaded_.device(node.device),
        [&](const std::string& name) { return m_.where(path + ".objects." + name); }, reading_);
  }

  /// What stops and leads an axis, and what is known of it, may not wait: the stopping times of check and the
  /// following error count on it.
  void every_cycle(const AxisConfig& a, const DeviceConfig& device, const std::string& path) {
    namespace object = canopen::object;
    const auto slow = [&](const std::vector<PdoConfig>& pdos, std::initializer_list<int> leading,
                          const text::Entry& entry) {
      for (const PdoConfig& pdo : pdos) {
        if (pdo.transmission < 2 || pdo.transmission > 240) continue;
        const bool leads = std::any_of(pdo.objects.begin(), pdo.objects.end(), [&](const PdoObject& o) {
          return std::find(leading.begin(), leading.end(), o.index) != leading.end();
        });
        if (leads)
          reading_.error(m_.where(path + ".drive"), entry,
                         {a.letter, std::to_string(pdo.number), m_.node(a.drive)->device,
                          std::to_string(pdo.transmission)});
      }
    };
    slow(device.rpdos, {object::kControlword, object::kTargetPosition, object::kInterpolationData},
         finding::kSlowCommand);
    slow(device.tpdos, {object::kStatusword, object::kPositionActual}, finding::kSlowFeedback);
  }

  void motor(const DeviceConfig& device, const std::string& name, const std::string& who,
             const std::string& speed, double rpm, const std::string& path) {
    if (device.motor.max_speed > 0.0 && rpm > device.motor.max_speed * (1.0 + 1e-9))
      reading_.warning(m_.where(path), finding::kMotorTooFast,
                       {who, speed, text::number(rpm, 1), name, text::number(device.motor.max_speed, 1)});
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  Reading& reading_;
};

}  // namespace

void check_devices(const LoadResult& loaded, Reading& reading) {
  DeviceUse use(loaded, reading);
  use.nodes();
  use.drives();
  use.axes();
  use.spindles();
  use.load();
}

}  // namespace servogate::machine
