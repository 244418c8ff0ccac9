// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/image/alarm.hpp"
#include "machine/load.hpp"

/// What alarms call the stations of a machine file. Not real-time safe.
namespace servogate::gateway {

/// The station is the inverter of a spindle, which says by itself that it is lost.
bool turns_spindle(const machine::MachineConfig& machine, const machine::StationConfig& station);
/// "line.station" of an inverter, else the name of the station.
std::string source_name(const machine::MachineConfig& machine, const machine::StationConfig& station);
/// A trip code of an inverter in words, or the register that must be right; empty: the file has none.
std::string inverter_words(const machine::DeviceConfig& device, image::AlarmNumber number, std::uint16_t code,
                           text::Language language);

/// The place of an amplifier on a channel of a board: stations count behind the buses.
image::PartPlace board_place(const machine::MachineConfig& m, const machine::BoardChannelConfig& channel);
bool on_board(const machine::MachineConfig& m, const image::PartPlace& place);
/// "cabinet.1": station and channel.
std::string board_channel_name(const machine::MachineConfig& m, const image::PartPlace& place);
/// What the error code of such an amplifier means.
std::string board_words(std::uint16_t code, text::Language language);

}  // namespace servogate::gateway
