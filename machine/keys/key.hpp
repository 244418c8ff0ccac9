// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "machine/keys/units.hpp"

/// The one description of every key of the machine and device files. Reading, the JSON schema and the
/// reference all walk it; defaults are the member initialisers of the structs.
namespace servogate::machine {

enum class KeyKind : std::uint8_t {
  boolean,
  integer,       ///< int
  long_integer,  ///< int64
  number,        ///< double, with its unit
  text,
  choice,   ///< an enum over one byte
  place,    ///< image::Place
  texts,    ///< list of strings
  numbers,  ///< table of name -> number
  ratio,    ///< [a, b] of integers
  pairs,    ///< list of [a, b] of numbers
  table,
  tables,  ///< list of tables
};

/// What a text names; checked once the whole file is read.
enum class Refers : std::uint8_t {
  nothing,
  input_point,
  output_point,
  digital_input,
  digital_output,
  analog_output,
  axis,
  node,
  device,
  file
};

struct Section;

/// What a value must satisfy beside its type.
struct Rule {
  Unit unit = Unit::none;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself is not allowed
  bool required = false;
  Refers refers = Refers::nothing;
  bool computed = false;  ///< the default is computed from other keys; the meaning says how
};

/// The longest cycle, in seconds.
inline constexpr double kLongestCycle = 0.02;
/// Bit rates in kbit/s. Source: CiA 301, "Bit rates".
inline constexpr int kBitRates[] = {10, 20, 50, 125, 250, 500, 800, 1000};

/// No machine is beyond these; what is written beyond is a slip, and would break the arithmetic of motion. In
/// mm or degrees, and seconds; the rotary bounds are wide, the linear ones a thousandfold of what machines
/// do.
inline constexpr double kLongest = 1e6;              ///< lengths: 1 km
inline constexpr double kFastest = 1e6;              ///< velocity: 1 km/s, 167 000 rpm
inline constexpr double kSteepest = 1e8;             ///< acceleration: 10 000 times that of falling
inline constexpr double kHardest = 1e11;             ///< jerk: that acceleration within a millisecond
inline constexpr double kSlowest = 1e-3;             ///< a micrometre a second, a second², a second³
inline constexpr double kMostCounts = 4294967296.0;  ///< of one turn: 32 bits

struct Key {
  std::string_view name;
  KeyKind kind;
  Rule rule;
  std::string_view english;
  std::string_view russian;
  void* (*member)(void* object);
  std::span<const std::string_view> choices = {};
  const Section& (*child)() = nullptr;
  void* (*append)(void* list) = nullptr;
  std::size_t (*count)(void* list) = nullptr;
  void* (*item)(void* list, std::size_t index) = nullptr;
};

/// A key that older files have, and where its meaning is now.
struct MovedKey {
  std::string_view name;
  std::string_view english;
  std::string_view russian;
};

/// One table of the file.
struct Section {
  std::string_view english;
  std::string_view russian;
  std::span<const Key> keys;
  void* (*defaults)();   ///< a default-made object of its struct
  bool is_axis = false;  ///< its `type` chooses the axis units
  std::span<const MovedKey> moved = {};
};

/// Specialised in the keys_*.cpp beside the table.
template <class T>
const Section& section_of();
/// Names of an enum in the order of its values; specialised beside the table that uses it.
template <class E>
std::span<const std::string_view> choices_of();

namespace detail {
template <class T>
struct MemberOf;
template <class C, class T>
struct MemberOf<T C::*> {
  using Class = C;
  using Type = T;
};
template <class T>
struct ElementOf {
  using Type = void;
};
template <class T>
struct ElementOf<std::vector<T>> {
  using Type = T;
};

template <class T>
constexpr KeyKind kind_of() {
  using E = typename ElementOf<T>::Type;
  if constexpr (std::is_same_v<T, bool>)
    return KeyKind::boolean;
  else if constexpr (std::is_same_v<T, int>)
    return KeyKind::integer;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return KeyKind::long_integer;
  else if constexpr (std::is_same_v<T, double>)
    return KeyKind::number;
  else if constexpr (std::is_same_v<T, std::string>)
    return KeyKind::text;
  else if constexpr (std::is_enum_v<T>)
    return KeyKind::choice;
  else if constexpr (std::is_same_v<T, image::Place>)
    return KeyKind::place;
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    return KeyKind::texts;
  else if constexpr (std::is_same_v<T, std::map<std::string, double>>)
    return KeyKind::numbers;
  else if constexpr (std::is_same_v<T, std::array<std::int64_t, 2>>)
    return KeyKind::ratio;
  else if constexpr (std::is_same_v<T, std::vector<std::array<double, 2>>>)
    return KeyKind::pairs;
  else if constexpr (!std::is_void_v<E>)
    return KeyKind::tables;
  else
    return KeyKind::table;
}
}  // namespace detail

/// A key bound to a member: its kind follows from the member's type.
template <auto Member>
Key key(std::string_view name, Rule rule, std::string_view english, std::string_view russian) {
  using Class = typename detail::MemberOf<decltype(Member)>::Class;
  using Type = typename detail::MemberOf<decltype(Member)>::Type;
  constexpr KeyKind kind = detail::kind_of<Type>();
  Key out{name,    kind,    rule,
          english, russian, [](void* object) -> void* {
            return &(static_cast<Class*>(object)->*Member); }};
  if constexpr (kind == KeyKind::choice) {
    static_assert(sizeof(Type) == 1);
    out.choices = choices_of<Type>();
  } else if constexpr (kind == KeyKind::table) {
    out.child = &section_of<Type>;
  } else if constexpr (kind == KeyKind::tables) {
    using E = typename detail::ElementOf<Type>::Type;
    out.child = &section_of<E>;
    out.append = [](void* list) -> void* { return &static_cast<Type*>(list)->emplace_back(); };
    out.count = [](void* list) { return static_cast<Type*>(list)->size(); };
    out.item = [](void* list, std::size_t i) -> void* { return &(*static_cast<Type*>(list))[i]; };
  }
  return out;
}

template <class T>
void* default_object() {
  static T object;
  return &object;
}

}  // namespace servogate::machine
