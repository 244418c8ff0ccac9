// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::fault {

/// What a fault happens to. Values are bits of KindRow::devices.
enum class Device : std::uint16_t {
  drive = 1,      ///< a CiA 402 drive
  encoder = 2,    ///< a CiA 406 encoder
  station = 4,    ///< a Modbus station
  chip = 8,       ///< a GPIO chip
  input = 16,     ///< one contact of a chip, a drive or an I/O module
  bus = 32,       ///< the wire of a CAN segment
  node = 64,      ///< the connection of a device to its wire
  module = 128,   ///< a CiA 401 I/O module
  control = 256,  ///< the computer that controls the machine
  pendant = 512,
  button = 1024,  ///< of a pendant
};

/// The first group lasts until its time is over or it is cleared; the second happens once. Meanings, devices
/// and parameters: kinds().
enum class Kind : std::uint8_t {
  silent,
  deaf,
  heartbeat_lost,
  pdo_dropped,
  pdo_late,
  pdo_corrupted,
  pdo_repeated,
  rpdo_dropped,
  rpdo_late,
  rpdo_corrupted,
  sdo_silent,
  sdo_late,
  sdo_abort,
  stuck_state,
  freeze,
  encoder_loss,
  power_cut,
  torque_off,
  unreadable,
  exception,
  slow,
  drop,
  delay,
  corrupt,
  repeat,
  foreign,
  unplug,
  bus_off,
  kill,
  swapped,
  edges_lost,
  stuck,
  bounce,
  emcy,
  emcy_only,
  over_current,
  encoder_fault,
  encoder_jump,
  following_error,
  over_temperature,
  under_voltage,
  flash_error,
  reset,
  trip,
  parameter,
  late_cycle,
};
inline constexpr std::size_t kKinds = static_cast<std::size_t>(Kind::late_cycle) + 1;

/// A parameter by its bit in KindRow::parameters.
enum class Parameter : std::uint8_t {
  duration,
  delay,
  every,
  number,
  value,
  code,
  index,
  abort,
  state,
  id,
  mask,
  sender,
  skip,
  count,
  exception,
  level,
  seed,
  data,
};

/// One fault with its parameters; those that its kind does not take are ignored. real-time safe to copy.
struct Fault {
  Kind kind = Kind::silent;
  image::Nanoseconds duration_ns = 0;  ///< of a lasting fault; 0: until cleared
  image::Nanoseconds delay_ns = 0;
  std::uint32_t every = 1;
  std::uint32_t number = 0;  ///< of a TPDO or RPDO, 1-4; 0: any
  std::int64_t value = 0;
  std::uint16_t error_code = 0x1000;
  std::uint16_t index = 0;
  canopen::AbortCode abort = canopen::AbortCode::general_error;
  image::DriveState state = image::DriveState::switched_on;
  std::uint32_t id = 0;     ///< frames with (id & mask) == (this & mask)
  std::uint32_t mask = 0;   ///< 0: every frame
  int sender = -1;          ///< node-ID, 0: the control; of a CAN segment the number of its endpoint; -1: any
  std::uint32_t skip = 0;   ///< frames that pass first
  std::uint32_t count = 1;  ///< frames that are hit then; 0: all
  std::uint8_t exception = 4;  ///< Modbus V1.1b3, section 7
  bool level = false;
  std::uint64_t seed = 1;
  std::array<std::uint8_t, 8> data{};
  std::uint8_t length = 0;  ///< bytes of `data`
  bool operator==(const Fault&) const = default;
};

/// A kind: its name as people write it, whom it happens to, what it takes, what it does.
struct KindRow {
  Kind kind;
  std::string_view name;
  unsigned devices;     ///< bits of Device
  unsigned parameters;  ///< bits 1 << Parameter
  std::string_view meaning;
  constexpr bool happens_to(Device device) const noexcept {
    return (devices & static_cast<unsigned>(device)) != 0;
  }
  constexpr bool takes(Parameter parameter) const noexcept {
    return (parameters >> static_cast<unsigned>(parameter) & 1u) != 0;
  }
};

/// A parameter: its name, its unit and range in words, and how it is read.
struct ParameterRow {
  Parameter parameter;
  std::string_view name;
  std::string_view unit;                              ///< and range, for documents
  bool (*set)(std::string_view value, Fault& fault);  ///< false: out of range or no value of its kind
};

/// The tables, in the order of their enumerations.
std::span<const KindRow> kinds() noexcept;
std::span<const ParameterRow> parameters() noexcept;

/// real-time safe.
const KindRow& row(Kind kind) noexcept;
inline std::string_view name_of(Kind kind) noexcept { return row(kind).name; }
/// The fault stays until its time is over or it is cleared. real-time safe.
constexpr bool lasts(Kind kind) noexcept { return kind < Kind::emcy; }

/// "silent", "over_current" ...; dashes do for underscores. nullptr: no such kind. Not real-time safe.
const KindRow* find_kind(std::string_view name);
/// nullptr: no such parameter.
const ParameterRow* find_parameter(std::string_view name) noexcept;
/// Names of the kinds that happen to one of these devices (bits of Device), for a message.
std::string names_for(unsigned devices);
/// Names of all parameters, for a message.
std::string parameter_names();

/// A time as faults have them: seconds, or a number with s, ms or us. nullopt: no such time.
std::optional<image::Nanoseconds> read_time(std::string_view text) noexcept;
/// A finite decimal number.
std::optional<double> read_number(std::string_view text) noexcept;
/// A whole number in a range, decimal or 0x.
std::optional<std::int64_t> read_whole(std::string_view text, std::int64_t min, std::int64_t max) noexcept;

}  // namespace servogate::fault
