// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "drivers/mock/world/world.hpp"
#include "drivers/notice.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "machine/load.hpp"

namespace servogate::gateway {

/// What is opened: a Modbus line with its stations, or the GPIO chip or the board of one station.
enum class DeviceKind { line, chip, board };

/// One device of the machine file and what its row may use to open it.
struct DeviceRequest {
  const machine::LoadResult& loaded;
  mock::World& world;       ///< everything simulated, made before
  std::size_t station = 0;  ///< of the machine file: the chip's or the board's, or the first one of the line
  const machine::LineConfig* line = nullptr;  ///< nullptr: a chip or a board
  std::string_view rest;                      ///< of the url, behind the scheme

  const machine::StationConfig& first() const { return loaded.machine.stations[station]; }
};

/// Which url is opened by what: one row a scheme. A new kind of input or output is a folder in `drivers/` and
/// a row here.
struct DeviceRow {
  DeviceKind kind;
  std::string_view scheme;  ///< with its colon: "mock:"
  std::string_view form;    ///< for people, text::both(): "mock:NAME"
  bool simulated;           ///< nothing real is behind it
  bool (*well_formed)(std::string_view rest);
  /// nullptr: refused by the computer, `why` says what is wrong and what mends it. A device with a thread of
  /// its own starts it here and ends it in its destructor. Not real-time safe.
  std::unique_ptr<image::CycleDevice> (*open)(const DeviceRequest& request, drivers::Notice& why);
  /// Whether open() would succeed, without a change to anything outside; nullptr: it always does.
  bool (*available)(const DeviceRequest& request, drivers::Notice& why) = nullptr;
};

std::span<const DeviceRow> device_rows();
/// The row of a url; nullptr: none opens it.
const DeviceRow* device_row(DeviceKind kind, std::string_view url);
/// The forms of all rows of a kind, for a message.
std::string device_forms(DeviceKind kind);

}  // namespace servogate::gateway
