// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/values/packet_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program {
namespace {

using image::Format;

template <typename T>
double as(const std::uint8_t* bytes) {
  T v;
  std::memcpy(&v, bytes, sizeof v);
  return static_cast<double>(v);
}

template <typename T>
void put(std::uint8_t* bytes, double value) {
  const T v = static_cast<T>(value);
  std::memcpy(bytes, &v, sizeof v);
}

double decode(const image::Place& place, const std::uint8_t* bytes) {
  switch (place.format) {
    case Format::bl:
      return (*bytes >> place.bit()) & 1;
    case Format::in:
      return as<std::int16_t>(bytes);
    case Format::li:
      return as<std::int32_t>(bytes);
    case Format::re:
      return as<float>(bytes);
    case Format::lr:
      return as<double>(bytes);
    case Format::by:
    case Format::ch:
      break;
  }
  return *bytes;
}

void encode(const image::Place& place, double value, std::uint8_t* bytes) {
  switch (place.format) {
    case Format::bl:
    case Format::by:
    case Format::ch:
      put<std::uint8_t>(bytes, value);
      break;
    case Format::in:
      put<std::int16_t>(bytes, value);
      break;
    case Format::li:
      put<std::int32_t>(bytes, value);
      break;
    case Format::re:
      put<float>(bytes, value);
      break;
    case Format::lr:
      put<double>(bytes, value);
      break;
  }
}

struct Limits {
  double min;
  double max;
};
Limits limits(Format format) {
  constexpr double kFloat = static_cast<double>(std::numeric_limits<float>::max());
  constexpr double kDouble = std::numeric_limits<double>::max();
  constexpr Limits kLimits[] = {
      {0, 1},  {0, 255}, {-32768, 32767}, {-2147483648.0, 2147483647}, {-kFloat, kFloat}, {-kDouble, kDouble},
      {0, 255}};
  return kLimits[static_cast<int>(format)];
}

}  // namespace

void PacketView::check_inside(const image::Place& place, int column) const {
  if (!packets_->contains(place))
    fail(Fault::place_outside, column,
         {image::to_string(place), std::to_string(packets_->size(place.packet))});
}

void PacketView::load(const image::Place& place,
                      std::array<std::uint8_t, image::kMaxCharacters>& bytes) const {
  const std::uint32_t first = place.byte(), count = place.bytes();
  std::memcpy(bytes.data(), packets_->data(place.packet) + first, count);
  for (const Pending& write : pending_) {
    if (write.place.packet != place.packet) continue;
    const std::uint32_t from = write.place.byte();
    for (std::uint32_t i = 0; i < write.place.bytes(); ++i) {
      if (from + i < first || from + i >= first + count) continue;
      std::uint8_t& byte = bytes[from + i - first];
      if (write.place.format != Format::bl) {
        byte = write.bytes[i];
      } else {
        const auto mask = static_cast<std::uint8_t>(1u << write.place.bit());
        byte = static_cast<std::uint8_t>(write.bytes[i] != 0 ? (byte | mask) : (byte & ~mask));
      }
    }
  }
}

double PacketView::number(const image::Place& place, int column) const {
  if (place.format == Format::ch) fail(Fault::characters_as_number, column, {image::to_string(place)});
  check_inside(place, column);
  std::array<std::uint8_t, image::kMaxCharacters> bytes;
  load(place, bytes);
  const double value = decode(place, bytes.data());
  return std::isfinite(value) ? value : 0.0;
}

std::string PacketView::text(const image::Place& place, int column) const {
  check_inside(place, column);
  std::array<std::uint8_t, image::kMaxCharacters> bytes;
  load(place, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), place.bytes()};
}

double PacketView::storable(const image::Place& place, double value, int column) const {
  check_inside(place, column);
  const bool whole = place.format != Format::re && place.format != Format::lr;
  const double stored = whole ? std::nearbyint(value) : value;
  const Limits l = limits(place.format);
  if (!(stored >= l.min && stored <= l.max))
    fail(Fault::place_range, column,
         {text::number(value), image::to_string(place), text::number(l.min), text::number(l.max)});
  return stored + 0.0;
}

void PacketView::remember(const image::Place& place, double value, std::string_view characters) {
  Pending write{place, {}};
  if (place.format == Format::ch) {
    write.bytes.fill(' ');
    std::copy_n(characters.begin(), std::min<std::size_t>(characters.size(), place.length),
                write.bytes.begin());
  } else {
    encode(place, value, write.bytes.data());
  }
  pending_.push_back(write);
}

}  // namespace servogate::program
