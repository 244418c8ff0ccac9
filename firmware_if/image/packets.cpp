// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/packets.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

namespace servogate::image {
static_assert(std::endian::native == std::endian::little, "packets are little-endian in memory");

namespace {

constexpr std::string_view kFormatNames[] = {"BL", "BY", "IN", "LI", "RE", "LR", "CH"};
constexpr struct {
  std::string_view name;
  Packet packet;
  Format format;
} kPacketNames[] = {
    {"SYVAR", Packet::v, Format::by}, {"SA", Packet::a, Format::bl}, {"SK", Packet::k, Format::by}};

/// The numbers of one packet.
struct Numbers {
  std::uint8_t* data;
  std::uint32_t size;

  template <typename T>
  std::uint8_t* at(std::uint32_t index) const noexcept {
    const std::uint32_t byte = index * static_cast<std::uint32_t>(sizeof(T));
    return byte + sizeof(T) <= size ? data + byte : nullptr;
  }
  template <typename T>
  double load(std::uint32_t index) const noexcept {
    const std::uint8_t* const from = at<T>(index);
    if (from == nullptr) return 0.0;
    T v;
    std::memcpy(&v, from, sizeof v);
    return static_cast<double>(v);
  }
  template <typename T>
  bool store(std::uint32_t index, T v) const noexcept {
    std::uint8_t* const to = at<T>(index);
    if (to == nullptr) return false;
    std::memcpy(to, &v, sizeof v);
    return true;
  }
  template <typename T>
  bool store_integer(std::uint32_t index, double value) const noexcept {
    constexpr auto kLow = static_cast<double>(std::numeric_limits<T>::min()),
                   kHigh = static_cast<double>(std::numeric_limits<T>::max());
    if (value >= kLow && value <= kHigh)
      if (const T whole = static_cast<T>(value); static_cast<double>(whole) == value)
        return store(index, whole);  // as most: nothing to round
    const double rounded = std::nearbyint(value);
    return rounded >= kLow && rounded <= kHigh && store(index, static_cast<T>(rounded));
  }
};

}  // namespace

std::optional<Place> parse_place(std::string_view text) {
  Place place;
  const auto* packet = std::find_if(std::begin(kPacketNames), std::end(kPacketNames),
                                    [&](const auto& n) { return text.starts_with(n.name); });
  if (packet == std::end(kPacketNames)) return std::nullopt;
  place.packet = packet->packet;
  place.format = packet->format;
  text.remove_prefix(packet->name.size());
  if (!text.empty() && text[0] >= '0' && text[0] <= '9') {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), place.index);
    if (error != std::errc{} || place.index > 65535) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  if (text.empty()) return place;
  if (text[0] != '.') return std::nullopt;
  text.remove_prefix(1);
  unsigned count = 0;
  if (!text.empty() && text[0] >= '0' && text[0] <= '9') {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || count < 1 || count > kMaxCharacters) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  for (std::size_t f = 0; f < std::size(kFormatNames); ++f)
    if (text == kFormatNames[f]) {
      place.format = static_cast<Format>(f);
      if (count != 0 && place.format != Format::ch) return std::nullopt;
      place.length = static_cast<std::uint8_t>(count == 0 ? 1 : count);
      return place;
    }
  return std::nullopt;
}

std::string to_string(const Place& p) {
  std::string text;
  for (const auto& n : kPacketNames)
    if (n.packet == p.packet) text = n.name;
  text += std::to_string(p.index) + ".";
  if (p.format == Format::ch && p.length != 1) text += std::to_string(p.length);
  return text + std::string(kFormatNames[static_cast<int>(p.format)]);
}

void Packets::resize(std::uint32_t k_bytes, std::uint32_t v_bytes) noexcept {
  k_size_ = std::min(k_bytes, kPacketKMaxSize);
  v_size_ = std::min(v_bytes, kSyvarMaxSize);
}

double Packets::number(const Place& p) const noexcept {
  const Numbers numbers{const_cast<Packets*>(this)->data(p.packet), size(p.packet)};
  switch (p.format) {
    case Format::bl:
      return p.index / 8 < numbers.size ? numbers.data[p.index / 8] >> p.bit() & 1 : 0;
    case Format::by:
      return numbers.load<std::uint8_t>(p.index);
    case Format::in:
      return numbers.load<std::int16_t>(p.index);
    case Format::li:
      return numbers.load<std::int32_t>(p.index);
    case Format::re:
      return numbers.load<float>(p.index);
    case Format::lr:
      return numbers.load<double>(p.index);
    case Format::ch:
      return contains(p) ? numbers.data[p.byte()] : 0;
  }
  return 0.0;
}

bool Packets::set_number(const Place& p, double value) noexcept {
  const Numbers numbers{data(p.packet), size(p.packet)};
  switch (p.format) {
    case Format::bl:
      return (value == 0.0 || value == 1.0) && set_bit(p, value != 0.0);
    case Format::by:
      return numbers.store_integer<std::uint8_t>(p.index, value);
    case Format::in:
      return numbers.store_integer<std::int16_t>(p.index, value);
    case Format::li:
      return numbers.store_integer<std::int32_t>(p.index, value);
    case Format::re:
      return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()) &&
             numbers.store(p.index, static_cast<float>(value));
    case Format::lr:
      return numbers.store(p.index, value);
    case Format::ch:
      return false;
  }
  return false;
}

std::string_view Packets::characters(const Place& p) const noexcept {
  if (p.format != Format::ch || !contains(p)) return {};
  return {reinterpret_cast<const char*>(data(p.packet) + p.byte()), p.length};
}

bool Packets::set_characters(const Place& p, std::string_view text) noexcept {
  if (p.format != Format::ch || !contains(p) || text.size() > p.length) return false;
  char* at = reinterpret_cast<char*>(data(p.packet) + p.byte());
  std::copy(text.begin(), text.end(), at);
  std::fill(at + text.size(), at + p.length, ' ');
  return true;
}

}  // namespace servogate::image
