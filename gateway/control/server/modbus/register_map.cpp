// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/modbus/register_map.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::gateway {

using image::Format;
using image::Packet;
using image::Place;

namespace {

Place bit_place(Packet packet, std::uint32_t n) { return {packet, Format::bl, n, 1}; }
Place word_place(Packet packet, std::uint32_t n) { return {packet, Format::in, n, 1}; }

std::optional<bool> bit_at(std::uint32_t address, const image::Packets& packets) {
  const bool of_k = address >= RegisterMap::kBitsOfK;
  const Place p = bit_place(of_k ? Packet::k : Packet::a, address - (of_k ? RegisterMap::kBitsOfK : 0u));
  if (!packets.contains(p)) return std::nullopt;
  return packets.bit(p);
}

/// A number of 32 bits, its high word first.
std::uint16_t half(double value, std::uint32_t word) {
  const double limited =
      std::clamp(std::isfinite(value) ? std::nearbyint(value) : 0.0, -2147483648.0, 2147483647.0);
  const auto bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(limited));
  return static_cast<std::uint16_t>(word == 0 ? bits >> 16 : bits & 0xFFFFu);
}

unsigned flag(bool is, int bit) { return is ? 1u << bit : 0u; }

std::uint16_t axis_word(const image::AxisImage& a, std::uint32_t n) {
  constexpr double kThousandths = 1000.0;
  if (n < 2) return half(a.actual * kThousandths, n);
  if (n < 4) return half(a.command * kThousandths, n - 2);
  if (n < 6) return half(a.following_error * kThousandths, n - 4);
  if (n == 6)
    return static_cast<std::uint16_t>(flag(a.enabled, 0) | flag(a.homed, 1) | flag(a.moving, 2) |
                                      flag(a.in_position, 3) | flag(a.limit_plus, 4) |
                                      flag(a.limit_minus, 5) | flag(a.drive.online, 6));
  return n == 7 ? static_cast<std::uint16_t>(a.drive.state) : std::uint16_t{0};
}

std::uint16_t spindle_word(const image::SpindleImage& s, std::uint32_t n) {
  constexpr double kTenths = 10.0;
  if (n < 2) return half(s.actual_rpm * kTenths, n);
  if (n < 4) return half(s.command_rpm * kTenths, n - 2);
  if (n == 4)
    return static_cast<std::uint16_t>(flag(s.running, 0) | flag(s.at_speed, 1) | flag(s.drive.online, 2));
  return n == 5 ? static_cast<std::uint16_t>(s.drive.state) : std::uint16_t{0};
}

std::uint16_t machine_word(const image::ProcessImage& image, const SeenAlarms& alarms, std::uint32_t n) {
  const image::ProcessStatus& p = image.processes[0];
  switch (n) {
    case 0:
      return static_cast<std::uint16_t>(image.now.number);
    case 1:
      return static_cast<std::uint16_t>(p.mode);
    case 2:
      return static_cast<std::uint16_t>(p.state);
    case 3:
      return static_cast<std::uint16_t>(alarms.count);
    case 4:
      return alarms.first;
    case 5:
    case 6:
      return half(p.line, n - 5);
    default:
      return static_cast<std::uint16_t>(image.axis_count);
  }
}

std::optional<std::uint16_t> word_at(std::uint32_t address, const image::ProcessImage& image,
                                     const SeenAlarms& alarms) {
  using M = RegisterMap;
  const auto in = [address](std::uint32_t first, int count, std::uint32_t words) {
    return address >= first && address < first + static_cast<std::uint32_t>(count) * words;
  };
  if (in(M::kAxes, image.axis_count, M::kAxisWords)) {
    const std::uint32_t n = address - M::kAxes;
    return axis_word(image.axes[n / M::kAxisWords], n % M::kAxisWords);
  }
  if (in(M::kSpindles, image.spindle_count, M::kSpindleWords)) {
    const std::uint32_t n = address - M::kSpindles;
    return spindle_word(image.spindles[n / M::kSpindleWords], n % M::kSpindleWords);
  }
  if (in(M::kMachine, 1, M::kMachineWords)) return machine_word(image, alarms, address - M::kMachine);
  if (address >= M::kAxes) return std::nullopt;
  const bool of_k = address >= M::kWordsOfK;
  const Place p = word_place(of_k ? Packet::k : Packet::a, address - (of_k ? M::kWordsOfK : 0u));
  if (!image.packets.contains(p)) return std::nullopt;
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(image.packets.number(p)));
}

}  // namespace

modbus::Response read_registers(const modbus::Request& asked, const image::ProcessImage& image,
                                const SeenAlarms& alarms) {
  modbus::Response r{asked.function, modbus::Exception::none, asked.address, asked.count, {}};
  for (std::uint32_t n = 0; n < asked.count; ++n) {
    const std::uint32_t address = asked.address + n;
    if (modbus::carries_bits(asked.function)) {
      const auto bit = bit_at(address, image.packets);
      if (bit) r.data.set_bit(n, *bit);
      if (!bit) r.exception = modbus::Exception::illegal_data_address;
    } else {
      const auto word = word_at(address, image, alarms);
      r.data.words[n] = word.value_or(0);
      if (!word) r.exception = modbus::Exception::illegal_data_address;
    }
  }
  return r;
}

std::optional<ByteRange> parse_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto byte = [](std::string_view name) -> std::optional<std::uint32_t> {
    const auto place = image::parse_place(name);
    if (!place || place->packet != Packet::k || place->format != Format::by) return std::nullopt;
    return place->index;
  };
  const auto first = byte(text.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : byte(text.substr(dash + 1));
  if (!first || !last || *last < *first) return std::nullopt;
  return ByteRange{*first, *last};
}

std::optional<std::vector<PlaceWrite>> places_of(const modbus::Request& asked,
                                                 std::span<const ByteRange> open) {
  const bool bits = modbus::carries_bits(asked.function);
  const std::uint32_t begin = bits ? RegisterMap::kBitsOfK : RegisterMap::kWordsOfK;
  std::vector<PlaceWrite> writes;
  for (std::uint32_t n = 0; n < asked.count; ++n) {
    const std::uint32_t address = asked.address + n;
    if (address < begin || (!bits && address >= RegisterMap::kAxes)) return std::nullopt;
    const Place p = bits ? bit_place(Packet::k, address - begin) : word_place(Packet::k, address - begin);
    const bool opened = std::any_of(open.begin(), open.end(), [&](const ByteRange& r) {
      return p.byte() >= r.first && p.byte() + p.bytes() - 1 <= r.last;
    });
    if (!opened) return std::nullopt;
    writes.push_back({image::to_string(p), bits ? (asked.data.bit(n) ? 1.0 : 0.0)
                                                : static_cast<std::int16_t>(asked.data.words[n])});
  }
  return writes;
}

}  // namespace servogate::gateway
