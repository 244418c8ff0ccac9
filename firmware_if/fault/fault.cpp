// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/fault/fault.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

namespace servogate::fault {

namespace {

constexpr unsigned kDrive = static_cast<unsigned>(Device::drive);
constexpr unsigned kEncoder = static_cast<unsigned>(Device::encoder);
constexpr unsigned kStation = static_cast<unsigned>(Device::station);
constexpr unsigned kChip = static_cast<unsigned>(Device::chip);
constexpr unsigned kInput = static_cast<unsigned>(Device::input);
constexpr unsigned kBus = static_cast<unsigned>(Device::bus);
constexpr unsigned kNode = static_cast<unsigned>(Device::node);
constexpr unsigned kModule = static_cast<unsigned>(Device::module);
constexpr unsigned kControl = static_cast<unsigned>(Device::control);
constexpr unsigned kPendant = static_cast<unsigned>(Device::pendant);
constexpr unsigned kButton = static_cast<unsigned>(Device::button);

template <class... P>
constexpr unsigned takes(P... parameters) {
  return (0u | ... | (1u << static_cast<unsigned>(parameters)));
}
using enum Parameter;
constexpr unsigned kFor = takes(duration);
constexpr unsigned kFrames = takes(duration, id, mask, sender, skip, count);

constexpr KindRow kKindRows[kKinds] = {
    {Kind::silent, "silent", kDrive | kStation, kFor, "sends nothing, receives and works on"},
    {Kind::deaf, "deaf", kDrive, kFor, "receives nothing"},
    {Kind::heartbeat_lost, "heartbeat_lost", kDrive, kFor, "no heartbeat"},
    {Kind::pdo_dropped, "pdo_dropped", kDrive, takes(duration, every, number),
     "every so-many-th of its TPDOs is not sent"},
    {Kind::pdo_late, "pdo_late", kDrive, takes(duration, Parameter::delay, number),
     "its TPDOs are sent later"},
    {Kind::pdo_corrupted, "pdo_corrupted", kDrive, takes(duration, value, number),
     "its TPDOs carry these bits of their first eight bytes flipped"},
    {Kind::pdo_repeated, "pdo_repeated", kDrive, takes(duration, number),
     "its TPDOs repeat their old content"},
    {Kind::rpdo_dropped, "rpdo_dropped", kDrive, takes(duration, every, number),
     "every so-many-th RPDO does not reach it"},
    {Kind::rpdo_late, "rpdo_late", kDrive, takes(duration, Parameter::delay, number), "RPDOs reach it later"},
    {Kind::rpdo_corrupted, "rpdo_corrupted", kDrive, takes(duration, value, number),
     "RPDOs reach it with these bits of their first eight bytes flipped"},
    {Kind::sdo_silent, "sdo_silent", kDrive, kFor, "SDO requests are not answered"},
    {Kind::sdo_late, "sdo_late", kDrive, takes(duration, Parameter::delay),
     "SDO requests are answered later"},
    {Kind::sdo_abort, "sdo_abort", kDrive, takes(duration, index, abort),
     "SDO requests to this object are aborted"},
    {Kind::stuck_state, "stuck_state", kDrive, takes(duration, state),
     "the state machine does not leave this state"},
    {Kind::freeze, "freeze", kDrive, kFor, "the whole device stands still, mechanics and all"},
    {Kind::encoder_loss, "encoder_loss", kDrive, kFor,
     "the encoder repeats its last position, and the drive does not notice"},
    {Kind::power_cut, "power_cut", kDrive, kFor, "its main supply is gone, its electronics live"},
    {Kind::torque_off, "torque_off", kDrive, kFor, "safe torque off"},
    {Kind::unreadable, "unreadable", kEncoder, kFor, "the disc cannot be read: the value stands still"},
    {Kind::exception, "exception", kStation, takes(duration, Parameter::exception),
     "answers every request with this exception"},
    {Kind::slow, "slow", kStation, takes(duration, Parameter::delay), "answers later"},
    {Kind::drop, "drop", kBus, kFrames, "frames occupy the wire, and nobody receives them"},
    {Kind::delay, "delay", kBus, kFrames | takes(Parameter::delay), "frames are offered later"},
    {Kind::corrupt, "corrupt", kBus | kStation | kPendant, kFrames,
     "a bit error: error frame and retransmission; of a station a wrong checksum; of a pendant reports of "
     "bytes "
     "by chance"},
    {Kind::repeat, "repeat", kBus, kFrames, "frames are received twice"},
    {Kind::foreign, "foreign", kBus, takes(duration, Parameter::delay, id, Parameter::data, count),
     "a device that does not belong to the machine sends `count` frames, each `delay` behind the one before "
     "(default: as close as the wire permits)"},
    {Kind::unplug, "unplug", kNode | kChip | kBus | kPendant, kFor,
     "nothing comes from it and nothing reaches it; of a bus the interface of the control is down"},
    {Kind::bus_off, "bus_off", kNode | kBus, kFor,
     "its controller is bus-off, as after 256 transmit errors; of a bus that of the control"},
    {Kind::kill, "kill", kDrive | kEncoder | kModule | kStation, kFor,
     "its electronics die: nothing is sent, heard or held, outputs and torque are gone; then it starts as "
     "after "
     "power-on"},
    {Kind::swapped, "swapped", kDrive | kEncoder | kModule, takes(duration, value),
     "another device with its node-ID takes its place, and boots with the product code `value` (1018h:02; 0: "
     "the next one)"},
    {Kind::edges_lost, "edges_lost", kChip, kFor, "its edges and their times are lost, its levels are right"},
    {Kind::stuck, "stuck", kInput | kButton, takes(duration, level),
     "the point or the button stays at a level, whatever drives it"},
    {Kind::bounce, "bounce", kInput, takes(duration, Parameter::delay, seed),
     "after a change the contact flickers for half of `delay` to all of it"},
    {Kind::emcy, "emcy", kDrive, takes(code), "sends an emergency and falls into a fault with it"},
    {Kind::emcy_only, "emcy_only", kDrive, takes(code), "sends an emergency and works on: a warning"},
    {Kind::over_current, "over_current", kDrive, 0, "2310h"},
    {Kind::encoder_fault, "encoder_fault", kDrive, 0, "7305h"},
    {Kind::encoder_jump, "encoder_jump", kDrive, takes(value),
     "the encoder says so many counts more from now on"},
    {Kind::following_error, "following_error", kDrive, 0, "8611h"},
    {Kind::over_temperature, "over_temperature", kDrive, 0, "4310h"},
    {Kind::under_voltage, "under_voltage", kDrive, 0, "3220h"},
    {Kind::flash_error, "flash_error", kDrive, takes(code),
     "the next program written to it ends with this error of 1F57h"},
    {Kind::reset, "reset", kDrive, 0, "restarts as after power-on"},
    {Kind::trip, "trip", kStation, takes(code), "an inverter trips with this code of its own"},
    {Kind::parameter, "parameter", kStation, takes(index, value),
     "somebody sets the parameter `index` of an inverter to `value` at its keypad"},
    {Kind::late_cycle, "late_cycle", kControl, takes(Parameter::delay),
     "the next cycle begins so much later, and what it drives lives on meanwhile"},
};

struct State {
  std::string_view name;
  image::DriveState state;
};
constexpr State kStates[] = {{"not_ready_to_switch_on", image::DriveState::not_ready_to_switch_on},
                             {"switch_on_disabled", image::DriveState::switch_on_disabled},
                             {"ready_to_switch_on", image::DriveState::ready_to_switch_on},
                             {"switched_on", image::DriveState::switched_on},
                             {"operation_enabled", image::DriveState::operation_enabled},
                             {"quick_stop_active", image::DriveState::quick_stop_active},
                             {"fault", image::DriveState::fault}};

template <class Table>
auto find_in(const Table& table, std::string_view name) -> decltype(&table[0]) {
  const auto found =
      std::find_if(std::begin(table), std::end(table), [&](const auto& row) { return row.name == name; });
  return found == std::end(table) ? nullptr : found;
}

bool set_time(std::string_view text, image::Nanoseconds& out) {
  const auto value = read_time(text);
  if (value) out = *value;
  return value.has_value();
}

template <class T>
bool set_whole(std::string_view text, std::int64_t min, std::int64_t max, T& out) {
  const auto value = read_whole(text, min, max);
  if (value) out = static_cast<T>(*value);
  return value.has_value();
}

/// Bytes as pairs of hexadecimal digits, with or without blanks between them.
bool set_data(std::string_view text, Fault& out) {
  std::array<std::uint8_t, 8> data{};
  std::size_t length = 0;
  while (!text.empty()) {
    if (text.front() == ' ') {
      text.remove_prefix(1);
      continue;
    }
    if (text.size() < 2 || length == data.size()) return false;
    const auto [end, error] = std::from_chars(text.data(), text.data() + 2, data[length], 16);
    if (error != std::errc{} || end != text.data() + 2) return false;
    ++length;
    text.remove_prefix(2);
  }
  out.data = data;
  out.length = static_cast<std::uint8_t>(length);
  return true;
}

constexpr std::int64_t kMost32 = 0xFFFF'FFFF;
constexpr std::int64_t kMostId = 0x1FFF'FFFF;
using Text = std::string_view;
constexpr ParameterRow kParameterRows[] = {
    {duration, "for", "s, ms; none: until cleared",
     [](Text v, Fault& f) { return set_time(v, f.duration_ns); }},
    {Parameter::delay, "delay", "s, ms", [](Text v, Fault& f) { return set_time(v, f.delay_ns); }},
    {every, "every", "1 to 4294967295", [](Text v, Fault& f) { return set_whole(v, 1, kMost32, f.every); }},
    {number, "number", "of the PDO, 1 to 4; none: any",
     [](Text v, Fault& f) { return set_whole(v, 1, 4, f.number); }},
    {value, "value", "bits, counts, a product code or the value of a parameter",
     [](Text v, Fault& f) { return set_whole(v, INT64_MIN, INT64_MAX, f.value); }},
    {code, "code", "error code, 1 to 0xFFFF",
     [](Text v, Fault& f) { return set_whole(v, 1, 0xFFFF, f.error_code); }},
    {index, "index", "object, 0: any; address of a parameter",
     [](Text v, Fault& f) { return set_whole(v, 0, 0xFFFF, f.index); }},
    {abort, "abort", "SDO abort code", [](Text v, Fault& f) { return set_whole(v, 1, kMost32, f.abort); }},
    {state, "state", "of CiA 402, switched_on ...",
     [](Text v, Fault& f) {
       const State* found = find_in(kStates, v);
       if (found != nullptr) f.state = found->state;
       return found != nullptr;
     }},
    {id, "id", "CAN identifier",
     [](Text v, Fault& f) {
       if (f.mask == 0) f.mask = kMostId;
       return set_whole(v, 0, kMostId, f.id);
     }},
    {mask, "mask", "of the identifier (default: all its bits)",
     [](Text v, Fault& f) { return set_whole(v, 0, kMostId, f.mask); }},
    {sender, "sender", "node-ID, 0: the control; none: any",
     [](Text v, Fault& f) { return set_whole(v, 0, 127, f.sender); }},
    {skip, "skip", "frames that pass first",
     [](Text v, Fault& f) { return set_whole(v, 0, kMost32, f.skip); }},
    {count, "count", "frames, 0: all (default 1)",
     [](Text v, Fault& f) { return set_whole(v, 0, kMost32, f.count); }},
    {Parameter::exception, "exception", "1 to 255 (default 4)",
     [](Text v, Fault& f) { return set_whole(v, 1, 255, f.exception); }},
    {level, "level", "0 or 1", [](Text v, Fault& f) { return set_whole(v, 0, 1, f.level); }},
    {seed, "seed", "of the chance", [](Text v, Fault& f) { return set_whole(v, 0, kMost32, f.seed); }},
    {Parameter::data, "data", "up to 8 bytes in hexadecimal digits: \"40 18 10\" (default: none)", set_data},
};

template <class Table, class Wanted>
std::string names_of(const Table& table, Wanted&& wanted) {
  std::string list;
  for (const auto& r : table)
    if (wanted(r)) list += (list.empty() ? "" : ", ") + std::string(r.name);
  return list;
}

}  // namespace

std::span<const KindRow> kinds() noexcept { return kKindRows; }
std::span<const ParameterRow> parameters() noexcept { return kParameterRows; }
const KindRow& row(Kind kind) noexcept { return kKindRows[static_cast<std::size_t>(kind)]; }

const KindRow* find_kind(std::string_view word) {
  std::string name(word);
  std::replace(name.begin(), name.end(), '-', '_');
  return find_in(kKindRows, name);
}
const ParameterRow* find_parameter(std::string_view name) noexcept { return find_in(kParameterRows, name); }

std::string names_for(unsigned devices) {
  return names_of(kKindRows, [=](const KindRow& r) { return (r.devices & devices) != 0; });
}
std::string parameter_names() {
  return names_of(kParameterRows, [](const ParameterRow&) { return true; });
}

std::optional<double> read_number(std::string_view text) noexcept {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<image::Nanoseconds> read_time(std::string_view text) noexcept {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
  double scale = 1e9;
  for (const auto& [unit, ns] : kUnits) {
    if (!text.ends_with(unit)) continue;
    scale = ns;
    text.remove_suffix(unit.size());
    break;
  }
  while (text.ends_with(' ')) text.remove_suffix(1);
  const auto value = read_number(text);
  if (!value || *value < 0.0 || *value > 1e9) return std::nullopt;
  return std::llround(*value * scale);
}

std::optional<std::int64_t> read_whole(std::string_view text, std::int64_t min, std::int64_t max) noexcept {
  const bool minus = text.starts_with('-');
  if (minus) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::int64_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (minus) value = -value;
  return value < min || value > max ? std::nullopt : std::optional(value);
}

}  // namespace servogate::fault
