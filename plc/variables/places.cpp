// SPDX-License-Identifier: Apache-2.0
#include "plc/variables/places.hpp"

#include <cstddef>
#include <initializer_list>
#include <string>

#include "plc/types/direct_place.hpp"

namespace servogate::plc {

namespace {

const Type* by_format(const TypeTable& types, image::Format format, std::initializer_list<Kind> kinds) {
  const auto i = static_cast<std::size_t>(format);
  return i < kinds.size() ? types.elementary(kinds.begin()[i]) : nullptr;
}

}  // namespace

std::optional<image::Place> place_of(std::span<const image::Symbol> symbols, std::string_view name) {
  if (const auto direct = direct_place(name)) return direct;
  for (const image::Symbol& s : symbols)
    if (same_name(s.name, name)) return s.place;
  return image::parse_place(name);
}

const Type* number_type(const TypeTable& types, image::Format format) {
  return by_format(types, format,
                   {Kind::boolean, Kind::usint, Kind::int_, Kind::dint, Kind::real, Kind::lreal});
}

const Type* bit_string_type(const TypeTable& types, image::Format format) {
  return by_format(types, format,
                   {Kind::boolean, Kind::byte, Kind::word, Kind::dword, Kind::dword, Kind::lword});
}

}  // namespace servogate::plc
