// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/alarms/source_names.hpp"

#include <algorithm>

#include "firmware_if/board/master/axis_link.hpp"
#include "kernel/axis/alarms/axis_alarms.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kFaultLine{"board.fault_line", "the fault line of the amplifier reports",
                             "сработала линия аварии усилителя"};
const text::Entry kTripped{"board.tripped",
                           "the watchdog of the board has dropped its outputs: no command came in time",
                           "сторожевой таймер платы снял её выходы: команда не пришла вовремя"};

}  // namespace

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

image::PartPlace board_place(const machine::MachineConfig& m, const machine::BoardChannelConfig& channel) {
  for (std::size_t s = 0; s < m.stations.size(); ++s)
    if (m.stations[s].name == channel.station)
      return {static_cast<std::int16_t>(m.buses.size() + s), static_cast<std::int16_t>(channel.channel)};
  return {};
}

bool on_board(const machine::MachineConfig& m, const image::PartPlace& place) {
  return place.device >= std::ssize(m.buses) && place.device < std::ssize(m.buses) + std::ssize(m.stations);
}

std::string board_channel_name(const machine::MachineConfig& m, const image::PartPlace& place) {
  const auto station = static_cast<std::size_t>(place.device) - m.buses.size();
  return m.stations[station].name + "." + std::to_string(place.part);
}

std::string board_words(std::uint16_t code, text::Language language) {
  return text::render(code == board::kErrorTripped ? kTripped : kFaultLine, {}, language);
}

}  // namespace servogate::gateway
