// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/alarms/source_names.hpp"

#include <algorithm>

#include "kernel/axis/alarms/axis_alarms.hpp"

namespace servogate::gateway {

bool turns_spindle(const machine::MachineConfig& m, const machine::StationConfig& station) {
  return std::any_of(m.spindles.begin(), m.spindles.end(),
                     [&](const machine::SpindleConfig& s) { return s.inverter == station.name; });
}

std::string source_name(const machine::MachineConfig& m, const machine::StationConfig& station) {
  return turns_spindle(m, station) ? station.line + "." + station.name : station.name;
}

std::string inverter_words(const machine::DeviceConfig& device, image::AlarmNumber number, std::uint16_t code,
                           text::Language language) {
  return std::string(number == axis::alarm::kSpindleNotReady ? device.required_text(code, language)
                                                             : device.error_text(code, language));
}

}  // namespace servogate::gateway
