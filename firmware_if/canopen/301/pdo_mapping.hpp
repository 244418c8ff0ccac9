// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace servogate::canopen {

/// One mapped object: the 32-bit word of 1600h/1A00h:01..40h, index << 16 | subindex << 8 | length in bits.
/// Source: CiA 301, 7.5.2.36 "RPDO mapping parameter".
struct MappingEntry {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bits = 0;
  bool operator==(const MappingEntry&) const = default;

  constexpr std::uint32_t word() const noexcept {
    return static_cast<std::uint32_t>(index) << 16 | static_cast<std::uint32_t>(subindex) << 8 | bits;
  }
  static constexpr MappingEntry from_word(std::uint32_t word) noexcept {
    return {static_cast<std::uint16_t>(word >> 16), static_cast<std::uint8_t>(word >> 8),
            static_cast<std::uint8_t>(word)};
  }
  /// Indices 0001h-0007h and the like name a data type: a gap of so many bits (dummy mapping).
  constexpr bool dummy() const noexcept { return index < 0x0020; }
};

inline constexpr std::size_t kMaxMappedObjects = 64;  ///< one per bit
inline constexpr std::size_t kPdoBytes = 8;

/// The content of one PDO, in order; the first entry takes the lowest bits of the first byte.
struct PdoMapping {
  std::array<MappingEntry, kMaxMappedObjects> entries{};
  std::uint8_t count = 0;

  /// Appends an entry; false (and nothing changed) when it does not fit into 64 bits. real-time safe.
  constexpr bool add(MappingEntry entry) noexcept {
    if (count >= entries.size() || bits() + entry.bits > 8 * kPdoBytes) return false;
    entries[count++] = entry;
    return true;
  }
  constexpr std::uint32_t bits() const noexcept {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += entries[i].bits;
    return sum;
  }
  /// Length of the frame's data. real-time safe.
  constexpr std::uint8_t bytes() const noexcept { return static_cast<std::uint8_t>((bits() + 7) / 8); }
  constexpr std::span<const MappingEntry> used() const noexcept { return {entries.data(), count}; }
};

/// Value of a field of `bits` bits (1-64) that starts at bit `offset` of a little-endian PDO; unsigned. Bits
/// beyond the end of `bytes` read 0. real-time safe.
constexpr std::uint64_t extract_bits(std::span<const std::uint8_t> bytes, std::uint32_t offset,
                                     std::uint32_t bits) noexcept {
  if (offset >= 64 || bits == 0) return 0;
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < bytes.size() && i < kPdoBytes; ++i)
    word |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
  word >>= offset;
  return bits >= 64 ? word : word & ((std::uint64_t{1} << bits) - 1);
}

/// Writes the low `bits` bits of value at bit `offset`; what does not fit into `bytes` is dropped. real-time
/// safe.
constexpr void insert_bits(std::span<std::uint8_t> bytes, std::uint32_t offset, std::uint32_t bits,
                           std::uint64_t value) noexcept {
  for (std::uint32_t done = 0; done < bits;) {
    const std::uint32_t position = offset + done;
    if (position / 8 >= bytes.size()) return;
    const std::uint32_t shift = position % 8;
    const std::uint32_t part = bits - done < 8 - shift ? bits - done : 8 - shift;
    const auto mask = static_cast<std::uint8_t>(((1u << part) - 1u) << shift);
    const auto piece = static_cast<std::uint8_t>((value >> done) << shift);
    bytes[position / 8] = static_cast<std::uint8_t>((bytes[position / 8] & ~mask) | (piece & mask));
    done += part;
  }
}

/// The low `bits` bits as a two's complement number. real-time safe.
constexpr std::int64_t sign_extend(std::uint64_t value, std::uint32_t bits) noexcept {
  if (bits == 0 || bits >= 64) return static_cast<std::int64_t>(value);
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  value &= (std::uint64_t{1} << bits) - 1;
  return static_cast<std::int64_t>((value ^ sign) - sign);
}

/// Packs one value per entry into `bytes`; returns the number of bytes used. real-time safe.
constexpr std::uint8_t pack(const PdoMapping& mapping, std::span<const std::uint64_t> values,
                            std::span<std::uint8_t> bytes) noexcept {
  std::uint32_t offset = 0;
  for (std::size_t i = 0; i < mapping.count; ++i) {
    insert_bits(bytes, offset, mapping.entries[i].bits, i < values.size() ? values[i] : 0);
    offset += mapping.entries[i].bits;
  }
  return mapping.bytes();
}

/// Takes a PDO apart into one raw value per entry. False when the frame is shorter than the mapping (nothing
/// is written then); a longer one is accepted, the rest ignored. Source: CiA 301, 7.2.2. real-time safe.
constexpr bool unpack(const PdoMapping& mapping, std::span<const std::uint8_t> bytes,
                      std::span<std::uint64_t> values) noexcept {
  if (bytes.size() < mapping.bytes()) return false;
  std::uint32_t offset = 0;
  for (std::size_t i = 0; i < mapping.count && i < values.size(); ++i) {
    values[i] = extract_bits(bytes, offset, mapping.entries[i].bits);
    offset += mapping.entries[i].bits;
  }
  return true;
}

}  // namespace servogate::canopen
