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

template <typename T>
double load(const std::uint8_t* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return static_cast<double>(v);
}

template <typename T>
bool store_integer(std::uint8_t* p, double value) noexcept {
  const double rounded = std::nearbyint(value);
  if (!(rounded >= static_cast<double>(std::numeric_limits<T>::min()) &&
        rounded <= static_cast<double>(std::numeric_limits<T>::max())))
    return false;
  const T v = static_cast<T>(rounded);
  std::memcpy(p, &v, sizeof v);
  return true;
}

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
  if (!contains(p)) return 0.0;
  const std::uint8_t* at = data(p.packet) + p.byte();
  switch (p.format) {
    case Format::bl:
      return (*at >> p.bit()) & 1;
    case Format::by:
    case Format::ch:
      return *at;
    case Format::in:
      return load<std::int16_t>(at);
    case Format::li:
      return load<std::int32_t>(at);
    case Format::re:
      return load<float>(at);
    case Format::lr:
      return load<double>(at);
  }
  return 0.0;
}

bool Packets::set_number(const Place& p, double value) noexcept {
  if (!contains(p)) return false;
  std::uint8_t* at = data(p.packet) + p.byte();
  switch (p.format) {
    case Format::bl: {
      if (value != 0.0 && value != 1.0) return false;
      const auto mask = static_cast<std::uint8_t>(1u << p.bit());
      *at = static_cast<std::uint8_t>(value != 0.0 ? (*at | mask) : (*at & ~mask));
      return true;
    }
    case Format::by:
      return store_integer<std::uint8_t>(at, value);
    case Format::in:
      return store_integer<std::int16_t>(at, value);
    case Format::li:
      return store_integer<std::int32_t>(at, value);
    case Format::re: {
      if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) return false;
      const auto v = static_cast<float>(value);
      std::memcpy(at, &v, sizeof v);
      return true;
    }
    case Format::lr:
      std::memcpy(at, &value, sizeof value);
      return true;
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
