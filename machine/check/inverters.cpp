// SPDX-License-Identifier: Apache-2.0
// Spindles on inverters on Modbus.
#include <cmath>
#include <map>

#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_inverter.hpp"

namespace servogate::machine {

namespace {

class InverterUse {
 public:
  InverterUse(const LoadResult& loaded, Reading& reading)
      : loaded_(loaded), m_(loaded.machine), reading_(reading) {}

  void all() {
    for (std::size_t i = 0; i < m_.spindles.size(); ++i) {
      path_ = "spindle." + std::to_string(i) + ".";
      number_ = std::to_string(i + 1);
      m_.spindles[i].inverter.empty() ? none() : spindle(m_.spindles[i]);
    }
    for (std::size_t s = 0; s < m_.stations.size(); ++s)
      station(m_.stations[s], "station." + std::to_string(s));
  }

 private:
  void error(const std::string& key, const text::Entry& entry, std::vector<std::string> arguments) {
    reading_.error(m_.where(path_ + key), entry, std::move(arguments));
  }
  bool written(const std::string& key) const { return m_.places.contains(path_ + key); }

  void none() {
    for (const char* key : {"rated_speed", "rated_frequency", "loss_reaction"})
      if (written(key)) error(key, finding::kInverterOnly, {number_, key});
  }

  /// The device of a station that is an inverter; nullptr: it is none.
  const DeviceConfig* device_of(const StationConfig& s) const {
    const DeviceConfig* device = s.kind == StationKind::modbus ? loaded_.device(s.device) : nullptr;
    return device != nullptr && device->kind == DeviceKind::inverter ? device : nullptr;
  }

  void spindle(const SpindleConfig& s) {
    for (const char* key : {"counts_per_rev", "orient_angle", "orient_speed"})
      if (written(key)) error(key, finding::kInverterNoEncoder, {number_, key});
    for (const auto& [key, value] :
         {std::pair("rated_speed", s.rated_speed), std::pair("rated_frequency", s.rated_frequency)})
      if (!(value > 0.0)) error(written(key) ? key : "inverter", finding::kInverterMotor, {number_, key});
    const DeviceConfig* device = nullptr;
    for (const StationConfig& station : m_.stations)
      if (station.name == s.inverter) device = device_of(station);
    if (device == nullptr) return error("inverter", finding::kInverterStation, {number_, s.inverter});
    const auto [taken, fresh] = taken_.try_emplace(s.inverter, number_);
    if (!fresh) error("inverter", finding::kInverterTwice, {s.inverter, taken->second});
    if (!(s.rated_speed > 0.0) || !(s.rated_frequency > 0.0)) return;
    const double most = 65535.0 * device->inverter.frequency_unit;
    if (s.largest_hertz() > most)
      error("max_speed", finding::kInverterFrequency,
            {number_, text::number(s.max_speed), text::number(s.largest_hertz(), 1), text::number(most, 1)});
  }

  void station(const StationConfig& s, const std::string& path) {
    const DeviceConfig* device = device_of(s);
    if (device == nullptr) return;
    if (!taken_.contains(s.name))
      reading_.error(m_.where(path + ".device"), finding::kInverterIdle, {s.name});
    const LineConfig* line = m_.line(s.line);
    if (device->inverter.protocol == InverterProtocol::huanyang && line != nullptr &&
        line->url.starts_with("tcp:"))
      reading_.error(m_.where(path + ".line"), finding::kInverterSerial, {s.name, line->name, line->url});
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  Reading& reading_;
  std::string path_, number_;
  std::map<std::string, std::string, std::less<>> taken_;
};

}  // namespace

void check_inverters(const LoadResult& loaded, Reading& reading) { InverterUse(loaded, reading).all(); }

}  // namespace servogate::machine
