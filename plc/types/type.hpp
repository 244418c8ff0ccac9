// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace servogate::plc {

/// What a value is. `error` silences follow-up findings; the two untyped kinds are literals that have not met
/// their context yet. Times are int64 nanoseconds, dates since 1970-01-01.
enum class Kind : std::uint8_t {
  error,
  none,
  boolean,
  sint,
  int_,
  dint,
  lint,
  usint,
  uint,
  udint,
  ulint,
  byte,
  word,
  dword,
  lword,
  real,
  lreal,
  time,
  date,
  tod,
  dt,
  character,
  wide_character,
  string,
  wide_string,
  enumeration,
  reference,
  array,
  structure,
  block,
  untyped_int,
  untyped_real,
};

/// How the machine holds an elementary value.
enum class Cell : std::uint8_t { i8, i16, i32, i64, u8, u16, u32, u64, f32, f64, text, wide_text, blob };

struct Type;

/// A member of a structure or an instance variable of a function block.
struct Field {
  std::string name;
  const Type* type = nullptr;
  std::uint32_t offset = 0;
  bool retain = false;
  bool reference = false;  ///< VAR_IN_OUT: the cell holds the address of the variable
  bool constant = false;
  bool located = false;     ///< AT %Q*: a reference to the place that VAR_CONFIG gave this instance
  bool non_retain = false;  ///< not even in a retained instance
};

struct Dimension {
  std::int64_t low = 0;
  std::int64_t high = 0;
  std::int64_t count() const noexcept { return high - low + 1; }
};

/// A name of a value; `value` has the bits that the base has in memory, also of a REAL.
struct EnumValue {
  std::string name;
  std::int64_t value = 0;
};

/// A type. Identity is the address; the table that owns it lives as long as the compiled image.
struct Type {
  Kind kind = Kind::error;
  std::string name;
  std::uint32_t size = 0;
  std::uint32_t align = 1;
  bool bounded = false;  ///< subrange: low..high of `limits`
  Dimension limits;
  /// Element of an array, integer under an enumeration or subrange, what a reference leads to (NULL:
  /// nothing).
  const Type* base = nullptr;
  Dimension range;            ///< of an array (several dimensions are arrays of arrays)
  bool open = false;          ///< ARRAY[*]: the limits come with the actual array, `range` is empty
  std::vector<Field> fields;  ///< of a structure or function block, by rising offset; add() keeps them
  std::vector<EnumValue> values;
  std::int32_t block = -1;          ///< function block: index of its body
  std::vector<std::uint8_t> image;  ///< initial value; empty: all zero

  /// Of a STRING or WSTRING, in characters.
  std::uint32_t capacity() const noexcept { return kind == Kind::wide_string ? size / 2 - 1 : size - 1; }
  const Field* field(std::string_view key) const;
  const EnumValue* value_named(std::string_view key) const;
  /// The member in which a byte lies, nullptr: none.
  const Field* field_at(std::uint32_t offset) const noexcept;
  void add(Field field);
  void add(EnumValue value);

  // Known when the type is made, so that nobody walks through types that hold types that hold types.
  bool holds_reference =
      false;  ///< it is one, or an element or member is; what is inside of blocks does not count
  bool holds_instance = false;  ///< it is a function block, or an element or member is
  bool holds_location = false;  ///< a variable AT %Q* is in it, or in a block in it

 private:
  std::unordered_map<std::string, std::size_t> by_key_;  ///< of fields or values
};

/// Names are matched without case: this is the form they are stored under.
std::string key_of(std::string_view name);
bool same_name(std::string_view a, std::string_view b);

bool is_signed(Kind k) noexcept;
bool is_unsigned(Kind k) noexcept;
inline bool is_integer(Kind k) noexcept { return is_signed(k) || is_unsigned(k); }
bool is_bits(Kind k) noexcept;  ///< BYTE WORD DWORD LWORD
bool is_real(Kind k) noexcept;
bool is_temporal(Kind k) noexcept;  ///< TIME DATE TOD DT
bool is_untyped(Kind k) noexcept;
inline bool is_text(Kind k) noexcept { return k == Kind::string || k == Kind::wide_string; }
inline bool is_character(Kind k) noexcept { return k == Kind::character || k == Kind::wide_character; }
/// WSTRING and WCHAR, which do not mix with STRING and CHAR.
inline bool is_wide(Kind k) noexcept { return k == Kind::wide_string || k == Kind::wide_character; }
bool is_elementary(Kind k) noexcept;
inline bool is_number(Kind k) noexcept { return is_integer(k) || is_real(k) || is_untyped(k); }

/// Machine form of an elementary type; blob for arrays, structures and blocks.
Cell cell_of(const Type& t) noexcept;
std::uint32_t cell_size(Cell c) noexcept;
/// Least and greatest value of an integer, bit string or enumeration base as the machine holds it.
void integer_limits(Kind k, std::int64_t& low, std::uint64_t& high) noexcept;

/// How a value of one type gets into a variable of another.
enum class Conversion : std::uint8_t { same, widening, narrowing, none };
Conversion conversion(const Type& from, const Type& to) noexcept;
/// Whether a variable of one type can stand for one of the other: a parameter that is bound, not copied. A
/// subrange is never lost, whichever side writes.
bool binds(const Type& actual, const Type& formal) noexcept;
/// The same of a parameter that is written only.
bool takes_output(const Type& actual, const Type& formal) noexcept;
/// Every value of `from` is one of `to` as far as subranges go; of arrays those of the elements.
bool range_fits(const Type& from, const Type& to) noexcept;

/// All types of a compilation.
class TypeTable {
 public:
  TypeTable();
  TypeTable(const TypeTable&) = delete;
  TypeTable& operator=(const TypeTable&) = delete;

  const Type* elementary(Kind k) const noexcept { return by_kind_[static_cast<std::size_t>(k)]; }
  /// STRING[capacity] or WSTRING[capacity], 1 to 255 characters.
  const Type* string(std::uint32_t capacity, Kind kind = Kind::string);
  const Type* array(const Type* element, Dimension range);
  /// ARRAY[*] of it, for parameters (IEC 61131-3:2013, 6.5.3.4); it has no size.
  const Type* open_array(const Type* element);
  /// REF_TO it; of nullptr the type of NULL.
  const Type* reference(const Type* target);
  /// A new type that the caller fills; named types are found again by find().
  Type* add(Kind k, std::string name);
  /// Declares a name for a type; false when the name is taken.
  bool name(std::string_view name, const Type* type);
  const Type* find(std::string_view name) const;

  /// The smallest elementary type into which both go without loss; null: there is none.
  const Type* common(const Type& a, const Type& b) const noexcept;

 private:
  std::deque<Type> all_;
  std::map<std::string, const Type*> named_;
  std::map<std::pair<Kind, std::uint32_t>, const Type*> strings_;
  std::map<std::tuple<const Type*, std::int64_t, std::int64_t>, const Type*> arrays_;
  std::map<const Type*, const Type*> open_arrays_, references_;
  const Type* by_kind_[static_cast<std::size_t>(Kind::untyped_real) + 1] = {};
};

inline constexpr std::uint32_t kDefaultStringCapacity = 80;
inline constexpr std::uint32_t kMaxStringCapacity = 255;
/// Bytes of a text in memory: its length in one byte and the characters; of a WSTRING both have two bytes.
constexpr std::uint32_t text_size(Kind kind, std::uint32_t characters) noexcept {
  return kind == Kind::wide_string ? 2 + 2 * characters : 1 + characters;
}
/// The largest variable of an elementary type.
inline constexpr std::uint32_t kMaxElementarySize = text_size(Kind::wide_string, kMaxStringCapacity);
/// Bytes of the value that a variable of elementary type has: of a text only what its length says.
std::uint32_t value_size(const Type& type, const std::uint8_t* at) noexcept;

}  // namespace servogate::plc
