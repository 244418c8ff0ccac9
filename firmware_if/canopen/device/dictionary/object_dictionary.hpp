// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/canopen/301/sdo_codec.hpp"

namespace servogate::canopen {

/// Data types by their number in the object dictionary. Source: CiA 301, 7.4.7.
enum class DataType : std::uint8_t {
  boolean = 0x01,
  integer8 = 0x02,
  integer16 = 0x03,
  integer32 = 0x04,
  unsigned8 = 0x05,
  unsigned16 = 0x06,
  unsigned32 = 0x07,
  real32 = 0x08,  ///< its bits, as an unsigned number
  visible_string = 0x09,
  octet_string = 0x0A,
  unicode_string = 0x0B,
  time_of_day = 0x0C,      ///< its six bytes, as an unsigned number
  time_difference = 0x0D,  ///< the same
  domain = 0x0F,
  integer24 = 0x10,
  real64 = 0x11,  ///< its bits
  integer40 = 0x12,
  integer48 = 0x13,
  integer56 = 0x14,
  integer64 = 0x15,
  unsigned24 = 0x16,
  unsigned40 = 0x18,
  unsigned48 = 0x19,
  unsigned56 = 0x1A,
  unsigned64 = 0x1B,
};
/// Length in bytes by number of the type; 0 for strings and domains, and for what is no DataType.
inline constexpr std::array<std::uint8_t, 0x1C> kTypeSizes{0, 1, 1, 2, 4, 1, 2, 4, 4, 0, 0, 0, 6, 6,
                                                           0, 0, 3, 8, 5, 6, 7, 8, 3, 0, 5, 6, 7, 8};
/// Length in bytes; 0 for strings and domains. real-time safe.
constexpr std::uint8_t size_of(DataType type) noexcept { return kTypeSizes[static_cast<std::size_t>(type)]; }
constexpr bool is_signed(DataType type) noexcept {
  return (type >= DataType::integer8 && type <= DataType::integer32) || type == DataType::integer24 ||
         (type >= DataType::integer40 && type <= DataType::integer64);
}
constexpr bool is_real(DataType type) noexcept {
  return type == DataType::real32 || type == DataType::real64;
}

enum class Access : std::uint8_t { ro, wo, rw, constant };
/// Into which PDOs an object may be mapped.
enum class Mappable : std::uint8_t { no, tpdo, rpdo, both };

/// One sub-index as a row of a static table: what an EDS says of it. A range that is wider than the type
/// means the type's own range.
struct ObjectSpec {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  DataType type = DataType::unsigned32;
  Access access = Access::ro;
  Mappable mappable = Mappable::no;
  std::int64_t value = 0;  ///< default
  std::int64_t low = std::numeric_limits<std::int64_t>::min();
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
  std::string_view text = {};  ///< default of a string or domain: its bytes
  std::uint32_t room = 0;  ///< of a string or domain, in bytes: at least this and its default and kMaxText
};

/// Room of a string or domain that asks for no more.
inline constexpr std::size_t kMaxText = 64;

/// Values behind static tables of objects. All memory is taken in the constructor; addresses of values never
/// change. A number is kept as int64: signed types sign-extended, unsigned ones zero-extended.
class ObjectDictionary {
 public:
  /// Place of a sub-index in this dictionary; kNone: there is none.
  using Slot = int;
  static constexpr Slot kNone = -1;

  /// Rows of all tables together; a later row of the same place replaces an earlier one. Not real-time safe.
  explicit ObjectDictionary(std::initializer_list<std::span<const ObjectSpec>> tables);

  /// real-time safe, as everything below unless said otherwise.
  Slot find(std::uint16_t index, std::uint8_t subindex) const noexcept;
  bool has_index(std::uint16_t index) const noexcept;
  /// Takes a row out of what the bus can see: to SDO and PDO mapping it does not exist. Its owner keeps its
  /// value. Not real-time safe.
  void hide(Slot slot);
  /// As find() and has_index(), of what the bus can see.
  Slot find_visible(std::uint16_t index, std::uint8_t subindex) const noexcept;
  bool index_visible(std::uint16_t index) const noexcept;
  int size() const noexcept { return static_cast<int>(specs_.size()); }
  const ObjectSpec& spec(Slot slot) const noexcept { return specs_[static_cast<std::size_t>(slot)]; }

  std::int64_t value(Slot slot) const noexcept { return values_[static_cast<std::size_t>(slot)]; }
  void set_value(Slot slot, std::int64_t value) noexcept { values_[static_cast<std::size_t>(slot)] = value; }
  /// The variable behind an object, for its owner to keep. Throws std::out_of_range when there is none. Not
  /// real-time safe.
  std::int64_t& variable(std::uint16_t index, std::uint8_t subindex = 0);
  /// 0 when there is none.
  std::int64_t get(std::uint16_t index, std::uint8_t subindex = 0) const noexcept;
  /// Nothing happens when there is none; neither access nor range is checked.
  void set(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept;

  /// Makes a value the default of this device (a serial number, an identifier with the node-ID).
  void set_default(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept;

  std::string_view text(Slot slot) const noexcept;
  /// Cut off where its room ends.
  void set_text(Slot slot, std::string_view text) noexcept;
  /// Memory for a text or domain that is still to come, as long as the room of this row; it is the same for
  /// all rows. Empty: the row is a number.
  std::span<std::uint8_t> staging(Slot slot) noexcept;

  /// Bytes of a value as they go over the bus; `bytes` has at least kMaxText, and of a longer text only what
  /// fits is given. Returns their number.
  std::size_t encode(Slot slot, std::span<std::uint8_t> bytes) const noexcept;
  /// Checks access, length and range of a download and gives the number it means.
  AbortCode decode(Slot slot, std::span<const std::uint8_t> bytes, std::int64_t& value) const noexcept;
  /// Range check alone: value_too_high, value_too_low or none.
  AbortCode check_range(Slot slot, std::int64_t value) const noexcept;

  /// Indices from first to last.
  struct Range {
    std::uint16_t first = 0;
    std::uint16_t last = 0xFFFF;
  };
  /// Keeps the writable values of a range as what reset() returns to ("save", 1010h).
  void store(Range range) noexcept;
  /// From the next reset() on the range has its defaults again ("load", 1011h).
  void forget(Range range) noexcept;
  /// Stored values, or the defaults where nothing is stored.
  void reset(Range range) noexcept;

 private:
  struct Text {
    char* bytes = nullptr;  ///< in text_memory_
    std::size_t room = 0, length = 0;
  };
  void make_texts();
  std::vector<ObjectSpec> specs_;  ///< by index, then sub-index
  std::vector<std::int64_t> values_, stored_;
  std::vector<bool> hidden_;  ///< empty: none is
  std::vector<Text> texts_;   ///< of the string rows, in order
  std::vector<int> text_of_;  ///< row -> place in texts_, -1
  // Not filled at first, so that room which is never used costs no memory of the computer.
  std::unique_ptr<char[]> text_memory_;
  std::unique_ptr<std::uint8_t[]> staging_;
};

}  // namespace servogate::canopen
