// SPDX-License-Identifier: Apache-2.0
// Machines that can never work because something takes longer than somebody waits for it.
#include <algorithm>
#include <cmath>

#include "firmware_if/modbus/line_time.hpp"
#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_waits.hpp"
#include "machine/check/stops/overrun.hpp"
#include "machine/keys/units.hpp"
#include "machine/modbus_blocks.hpp"

namespace servogate::machine {

namespace {

constexpr double kMargin_s = 0.01;  ///< in which a command arrives and its answer comes back

std::string seconds(double s) { return text::number(s, 3) + " " + text::unit_words("s"); }
std::string milliseconds_up(double s) { return text::number(std::ceil(s * 1e4) / 10.0) + " ms"; }

/// Which switches and marks homing needs.
struct HomingParts {
  bool search = false;  ///< drives fast until a switch works
  bool index = false;   ///< seeks a zero mark slowly
};
HomingParts parts_of(const HomingConfig& h) {
  const int m = h.drive_method;
  switch (h.method) {
    case HomingMethod::switch_and_index:
      return {true, true};
    case HomingMethod::switch_only:
      return {true, false};
    case HomingMethod::index:
      return {false, true};
    case HomingMethod::drive:  // CiA 402-2: 1-14 switch and index, 17-30 switch, 33 and 34 index
      return {(m >= 1 && m <= 14) || (m >= 17 && m <= 30), (m >= 1 && m <= 14) || m == 33 || m == 34};
    default:
      return {};
  }
}

class Waits {
 public:
  Waits(const LoadResult& loaded, Reading& reading)
      : loaded_(loaded), m_(loaded.machine), reading_(reading) {}

  void all() {
    for (std::size_t i = 0; i < m_.axes.size(); ++i) {
      const std::string path = "axis." + std::to_string(i) + ".";
      homing(m_.axes[i], path);
      release(m_.axes[i], path);
    }
    for (std::size_t i = 0; i < m_.spindles.size(); ++i)
      ramp(m_.spindles[i], std::to_string(i + 1), "spindle." + std::to_string(i) + ".");
    for (const LineConfig& line : m_.lines) poll(line);
  }

 private:
  bool unread(const std::string& path) const { return m_.unread.contains(path); }

  void homing(const AxisConfig& a, const std::string& path) {
    const HomingConfig& h = a.home;
    const HomingParts parts = parts_of(h);
    if (!(h.slow > 0.0) || (parts.search && !(h.fast > 0.0)) || !(a.max_acceleration > 0.0) ||
        !(a.max_jerk > 0.0) || !(a.lead > 0.0) || unread(path + "home.timeout"))
      return;
    const double turn = a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
    double way = parts.search ? stop_from(h.fast, a.homing_acceleration(), a.max_jerk).way : 0.0;
    if (parts.index) way += h.index_max_travel > 0.0 ? std::min(turn, h.index_max_travel) : turn;
    const std::string speed = " " + text::unit_words(a.speed_unit());
    const double slowly = way / h.slow;
    if (slowly > h.timeout) {
      const double enough = std::ceil(way / h.timeout * 1e3) / 1e3;
      return reading_.error(m_.where(path + "home.slow"), finding::kHomingTooSlow,
                            {a.letter, text::number(h.slow) + speed, seconds(h.timeout),
                             text::number(way, 3) + " " + text::unit_words(a.unit()), seconds(slowly),
                             text::number(enough) + speed});
    }
    if (!parts.search || a.endless() || !(a.travel_max > a.travel_min)) return;
    const double back = h.final_move ? std::abs(h.final_position - h.position) / h.fast : 0.0;
    const double longest = (a.travel_max - a.travel_min) / h.fast + slowly + back;
    if (longest > h.timeout)
      reading_.warning(m_.where(path + "home.timeout"), finding::kHomingTooFar,
                       {a.letter, seconds(longest), seconds(h.timeout)});
  }

  /// A drive with the brake on its own output counts as enabled when the brake is open.
  void release(const AxisConfig& a, const std::string& path) {
    const NodeConfig* node = m_.node(a.drive);
    const DeviceConfig* device = node != nullptr ? loaded_.device(node->device) : nullptr;
    if (device == nullptr || !a.brake.drive_output) return;
    const double patience = device->behaviour.transition_timeout;
    if (a.brake.release_delay + kMargin_s < patience) return;
    reading_.error(m_.where(path + "brake.release_delay"), finding::kReleaseTooLong,
                   {a.letter, seconds(a.brake.release_delay), seconds(patience), node->device});
  }

  void ramp(const SpindleConfig& s, const std::string& number, const std::string& path) {
    if (m_.plc.sources.empty() || !(s.acceleration > 0.0) || unread("plc.handshake_timeout") ||
        unread(path + "acceleration"))
      return;
    // To rest from full speed, another gear, and up again.
    double time = s.max_speed / s.acceleration;
    if (!s.gears.empty()) {
      const bool told =
          std::all_of(s.gears.begin(), s.gears.end(), [](const GearConfig& g) { return !g.confirm.empty(); });
      time = 2.0 * time + (told ? 0.0 : s.gear_change_time);
    }
    if (time > m_.plc.handshake_timeout)
      reading_.error(m_.where(path + "acceleration"), finding::kSpindleTooSlow,
                     {number, text::number(s.max_speed), text::number(s.acceleration), seconds(time),
                      seconds(m_.plc.handshake_timeout)});
  }

  /// Stations of a line are asked one after the other; over TCP a transaction takes no time of a wire.
  void poll(const LineConfig& line) {
    if (line.url.starts_with("tcp:") || line.baud <= 0) return;
    const modbus::LineTime wire(static_cast<std::uint32_t>(line.baud));
    image::Nanoseconds round = 0;
    for (const StationConfig& s : m_.stations)
      if (const DeviceConfig* device = of_line(s, line); device != nullptr)
        for (const modbus::Block& block : blocks_of(s, *device))
          round += wire.transaction(block, modbus::kAnswerDelay);
    const double takes = static_cast<double>(round) * 1e-9;
    for (std::size_t i = 0; i < m_.stations.size(); ++i) {
      const StationConfig& s = m_.stations[i];
      const double stale = s.period * modbus::kStaleAfterPeriods;
      if (of_line(s, line) == nullptr || takes <= stale) continue;
      reading_.error(
          m_.where("station." + std::to_string(i) + ".period"), finding::kPeriodTooShort,
          {s.name, milliseconds(s.period), line.name, milliseconds_up(takes), std::to_string(line.baud),
           milliseconds(stale), std::to_string(modbus::kStaleAfterPeriods),
           milliseconds_up(takes / modbus::kStaleAfterPeriods)});
    }
  }
  static std::vector<modbus::Block> blocks_of(const StationConfig& s, const DeviceConfig& device) {
    return device.kind == DeviceKind::inverter ? inverter_blocks(s, device.inverter).blocks
                                               : modbus_blocks(s, device.modbus);
  }
  /// The device of a station that is polled over this line; nullptr: it is not.
  const DeviceConfig* of_line(const StationConfig& s, const LineConfig& line) const {
    return s.kind == StationKind::modbus && s.line == line.name ? loaded_.device(s.device) : nullptr;
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  Reading& reading_;
};

}  // namespace

void check_waits(const LoadResult& loaded, Reading& reading) { Waits(loaded, reading).all(); }

}  // namespace servogate::machine
