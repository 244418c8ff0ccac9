// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace servogate::image {

/// The memories that program, PLC, operator and NC share. A: on/off signals of the machine; K: words between
/// program, operator, NC and PLC; V: the part programmer's variables (SYVAR).
enum class Packet : std::uint8_t { a, k, v };

/// Formats of the NC-110 language. byte offset of index i = i * size; BL: byte i / 8, bit i % 8 (bit 0 =
/// least significant); nCH: byte i, n characters. Words are little-endian, reals IEEE 754.
enum class Format : std::uint8_t { bl, by, in, li, re, lr, ch };

inline constexpr std::uint32_t kPacketASize = 1024;
inline constexpr std::uint32_t kPacketKDefaultSize = 1024;
inline constexpr std::uint32_t kPacketKMaxSize = 4096;
inline constexpr std::uint32_t kSyvarDefaultSize = 200;
inline constexpr std::uint32_t kSyvarMaxSize = 4096;
inline constexpr std::uint32_t kMaxCharacters = 32;

/// One addressed place. `length` counts characters and is 1 for every other format.
struct Place {
  Packet packet = Packet::a;
  Format format = Format::bl;
  std::uint32_t index = 0;
  std::uint8_t length = 1;

  bool operator==(const Place&) const = default;
  /// First byte touched. real-time safe.
  constexpr std::uint32_t byte() const noexcept;
  /// Number of bytes touched (1 for a bit). real-time safe.
  constexpr std::uint32_t bytes() const noexcept;
  /// Bit in that byte, 0 for all but BL. real-time safe.
  constexpr std::uint8_t bit() const noexcept {
    return format == Format::bl ? static_cast<std::uint8_t>(index % 8) : std::uint8_t{0};
  }
  /// True when both share at least one bit of memory. real-time safe.
  constexpr bool overlaps(const Place& other) const noexcept;
};

constexpr std::uint32_t format_size(Format f) noexcept {
  constexpr std::uint32_t sizes[] = {1, 1, 2, 4, 4, 8, 1};
  return sizes[static_cast<int>(f)];
}
/// What set_number() stores in a place of this format; nothing in characters. real-time safe.
struct NumberRange {
  double min = 0.0, max = 0.0;
};
constexpr NumberRange number_range(Format f) noexcept {
  constexpr NumberRange ranges[] = {{0.0, 1.0},
                                    {0.0, 255.0},
                                    {-32768.0, 32767.0},
                                    {-2147483648.0, 2147483647.0},
                                    {-3.4028234663852886e38, 3.4028234663852886e38},
                                    {-1.7976931348623157e308, 1.7976931348623157e308},
                                    {0.0, 0.0}};
  return ranges[static_cast<int>(f)];
}
constexpr std::uint32_t Place::byte() const noexcept {
  return format == Format::bl ? index / 8 : index * format_size(format);
}
constexpr std::uint32_t Place::bytes() const noexcept {
  return format == Format::ch ? length : format_size(format);
}
constexpr bool Place::overlaps(const Place& o) const noexcept {
  if (packet != o.packet || byte() + bytes() <= o.byte() || o.byte() + o.bytes() <= byte()) return false;
  return !(format == Format::bl && o.format == Format::bl) || bit() == o.bit();
}

/// "SA128", "SK800.BL", "SYVAR1.IN", "SK7.3CH" and back; a missing index is 0, a missing format the packet's
/// own (SA: BL, SK and SYVAR: BY). nullopt when the text is no place. Not real-time safe (strings).
std::optional<Place> parse_place(std::string_view text);
std::string to_string(const Place& place);

/// Packets A, K and V with their addressing law. A value type; its whole content is a snapshot.
/// Source: NC-110 programmer's manual, section "packets A and K, SYVAR".
class Packets {
 public:
  /// True when the place lies inside its packet. real-time safe.
  bool contains(const Place& p) const noexcept { return p.byte() + p.bytes() <= size(p.packet); }
  /// Size of a packet in bytes. real-time safe.
  std::uint32_t size(Packet p) const noexcept {
    return p == Packet::a ? kPacketASize : p == Packet::k ? k_size_ : v_size_;
  }
  /// Sets the configured sizes (clamped to the maxima). Not to be called once the cycle runs.
  void resize(std::uint32_t k_bytes, std::uint32_t v_bytes) noexcept;

  /// Numeric value of a place; a CH place gives its first character. Outside the packet: 0. real-time safe.
  double number(const Place& p) const noexcept;
  /// Stores a number; integers are rounded to nearest and must fit. False (and nothing stored) when the place
  /// is outside or the value does not fit. real-time safe.
  bool set_number(const Place& p, double value) noexcept;
  /// Bit access, the usual case. real-time safe.
  bool bit(const Place& p) const noexcept {
    if (p.format != Format::bl) return number(p) != 0.0;
    return contains(p) && ((data(p.packet)[p.byte()] >> p.bit()) & 1) != 0;
  }
  bool set_bit(const Place& p, bool value) noexcept {
    if (p.format != Format::bl) return set_number(p, value ? 1.0 : 0.0);
    if (!contains(p)) return false;
    std::uint8_t& byte = data(p.packet)[p.byte()];
    const auto mask = static_cast<std::uint8_t>(1u << p.bit());
    byte = static_cast<std::uint8_t>(value ? byte | mask : byte & ~mask);
    return true;
  }
  /// Characters of a CH place / stores them, padded with spaces to the place's length. real-time safe.
  std::string_view characters(const Place& p) const noexcept;
  bool set_characters(const Place& p, std::string_view text) noexcept;

  /// Raw memory for drivers and snapshots. real-time safe.
  std::uint8_t* data(Packet p) noexcept {
    return p == Packet::a ? a_.data() : p == Packet::k ? k_.data() : v_.data();
  }
  const std::uint8_t* data(Packet p) const noexcept { return const_cast<Packets*>(this)->data(p); }

 private:
  std::array<std::uint8_t, kPacketASize> a_{};
  std::array<std::uint8_t, kPacketKMaxSize> k_{};
  std::array<std::uint8_t, kSyvarMaxSize> v_{};
  std::uint32_t k_size_ = kPacketKDefaultSize;
  std::uint32_t v_size_ = kSyvarDefaultSize;
};

}  // namespace servogate::image
