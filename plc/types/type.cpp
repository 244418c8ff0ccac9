// SPDX-License-Identifier: Apache-2.0
#include "plc/types/type.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>

namespace servogate::plc {

namespace {

struct Elementary {
  Kind kind;
  const char* name;
  std::uint32_t size;
};
constexpr Elementary kElementary[] = {
    {Kind::error, "?", 1},
    {Kind::none, "nothing", 1},
    {Kind::boolean, "BOOL", 1},
    {Kind::sint, "SINT", 1},
    {Kind::int_, "INT", 2},
    {Kind::dint, "DINT", 4},
    {Kind::lint, "LINT", 8},
    {Kind::usint, "USINT", 1},
    {Kind::uint, "UINT", 2},
    {Kind::udint, "UDINT", 4},
    {Kind::ulint, "ULINT", 8},
    {Kind::byte, "BYTE", 1},
    {Kind::word, "WORD", 2},
    {Kind::dword, "DWORD", 4},
    {Kind::lword, "LWORD", 8},
    {Kind::real, "REAL", 4},
    {Kind::lreal, "LREAL", 8},
    {Kind::time, "TIME", 8},
    {Kind::date, "DATE", 8},
    {Kind::tod, "TIME_OF_DAY", 8},
    {Kind::dt, "DATE_AND_TIME", 8},
    {Kind::character, "CHAR", 1},
    {Kind::wide_character, "WCHAR", 2},
    {Kind::untyped_int, "integer literal", 8},
    {Kind::untyped_real, "real literal", 8},
};
constexpr std::pair<const char*, Kind> kOtherNames[] = {
    {"LTIME", Kind::time},       {"LDATE", Kind::date}, {"TOD", Kind::tod}, {"LTOD", Kind::tod},
    {"LTIME_OF_DAY", Kind::tod}, {"DT", Kind::dt},      {"LDT", Kind::dt},  {"LDATE_AND_TIME", Kind::dt}};

int rank(Kind k) noexcept {
  switch (k) {
    case Kind::boolean:
      return 0;
    case Kind::sint:
    case Kind::usint:
    case Kind::byte:
      return 1;
    case Kind::int_:
    case Kind::uint:
    case Kind::word:
      return 2;
    case Kind::dint:
    case Kind::udint:
    case Kind::dword:
      return 3;
    case Kind::lint:
    case Kind::ulint:
    case Kind::lword:
      return 4;
    default:
      return 0;
  }
}

// IEC 61131-3:2013, figure 11: implicit conversions; what is explicit there but keeps the sort of number is
// "narrowing" here and warned of.
Conversion between(Kind from, Kind to) noexcept {
  if (from == to) return Conversion::same;
  const auto wider = [](bool yes) { return yes ? Conversion::widening : Conversion::narrowing; };
  if (from == Kind::untyped_int && (is_integer(to) || is_bits(to) || is_real(to) || to == Kind::boolean))
    return Conversion::widening;
  if (from == Kind::untyped_int && to == Kind::untyped_real) return Conversion::widening;
  if (from == Kind::untyped_real && is_real(to)) return Conversion::widening;
  if (is_integer(from) && is_integer(to)) {
    if (is_signed(from) == is_signed(to)) return wider(rank(to) > rank(from));
    return wider(is_unsigned(from) && rank(to) > rank(from));
  }
  if (is_integer(from) && is_real(to)) return wider(rank(from) <= (to == Kind::real ? 2 : 3));
  if (is_real(from) && is_real(to)) return wider(from == Kind::real);
  const bool from_bits = is_bits(from) || from == Kind::boolean;
  if (from_bits && is_bits(to)) return wider(rank(to) > rank(from));
  // Extension: a bit string and the unsigned integer of its size are the same bits (packet bytes are both).
  if (is_bits(from) && is_unsigned(to)) return wider(rank(to) >= rank(from));
  if (is_unsigned(from) && is_bits(to)) return wider(rank(to) >= rank(from));
  if (is_character(from) && is_text(to) && is_wide(from) == is_wide(to)) return Conversion::widening;
  return Conversion::none;
}

}  // namespace

std::string key_of(std::string_view name) {
  std::string out(name);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::toupper(static_cast<unsigned char>(x)) == std::toupper(static_cast<unsigned char>(y));
  });
}

const Field* Type::field(std::string_view key) const {
  const auto at = fields.empty() ? by_key_.end() : by_key_.find(key_of(key));
  return at == by_key_.end() ? nullptr : &fields[at->second];
}

const EnumValue* Type::value_named(std::string_view key) const {
  const auto at = values.empty() ? by_key_.end() : by_key_.find(key_of(key));
  return at == by_key_.end() ? nullptr : &values[at->second];
}

const Field* Type::field_at(std::uint32_t offset) const noexcept {
  const auto after = std::upper_bound(fields.begin(), fields.end(), offset,
                                      [](std::uint32_t o, const Field& f) { return o < f.offset; });
  if (after == fields.begin()) return nullptr;
  const Field& f = *std::prev(after);
  return offset - f.offset < (f.reference ? 4 : f.type->size) ? &f : nullptr;
}

void Type::add(Field field) {
  by_key_.emplace(key_of(field.name), fields.size());
  if (kind == Kind::structure) {
    holds_reference = holds_reference || field.type->holds_reference;
    holds_instance = holds_instance || field.type->holds_instance;
  }
  holds_location = holds_location || field.located || (!field.reference && field.type->holds_location);
  fields.push_back(std::move(field));
}

void Type::add(EnumValue value) {
  by_key_.emplace(key_of(value.name), values.size());
  values.push_back(std::move(value));
}

bool is_signed(Kind k) noexcept { return k >= Kind::sint && k <= Kind::lint; }
bool is_unsigned(Kind k) noexcept { return k >= Kind::usint && k <= Kind::ulint; }
bool is_bits(Kind k) noexcept { return k >= Kind::byte && k <= Kind::lword; }
bool is_real(Kind k) noexcept { return k == Kind::real || k == Kind::lreal; }
bool is_temporal(Kind k) noexcept { return k >= Kind::time && k <= Kind::dt; }
bool is_untyped(Kind k) noexcept { return k == Kind::untyped_int || k == Kind::untyped_real; }
bool is_elementary(Kind k) noexcept {
  return (k >= Kind::boolean && k <= Kind::enumeration) || is_untyped(k) || k == Kind::error;
}

Cell cell_of(const Type& t) noexcept {
  switch (t.kind) {
    case Kind::sint:
      return Cell::i8;
    case Kind::int_:
      return Cell::i16;
    case Kind::dint:
      return Cell::i32;
    case Kind::lint:
    case Kind::untyped_int:
    case Kind::time:
    case Kind::date:
    case Kind::tod:
    case Kind::dt:
      return Cell::i64;
    case Kind::uint:
    case Kind::word:
    case Kind::wide_character:
      return Cell::u16;
    case Kind::udint:
    case Kind::dword:
    case Kind::reference:  // the address of the variable
      return Cell::u32;
    case Kind::ulint:
    case Kind::lword:
      return Cell::u64;
    case Kind::real:
      return Cell::f32;
    case Kind::lreal:
    case Kind::untyped_real:
      return Cell::f64;
    case Kind::string:
      return Cell::text;
    case Kind::wide_string:
      return Cell::wide_text;
    case Kind::enumeration:
      return cell_of(*t.base);
    case Kind::array:
    case Kind::structure:
    case Kind::block:
      return Cell::blob;
    default:
      return Cell::u8;
  }
}

std::uint32_t cell_size(Cell c) noexcept {
  constexpr std::uint32_t sizes[] = {1, 2, 4, 8, 1, 2, 4, 8, 4, 8, 0, 0, 0};
  return sizes[static_cast<int>(c)];
}

std::uint32_t value_size(const Type& type, const std::uint8_t* at) noexcept {
  if (!is_text(type.kind)) return type.size;
  std::uint16_t length = *at;
  if (type.kind == Kind::wide_string) std::memcpy(&length, at, sizeof length);
  return text_size(type.kind, length);
}

void integer_limits(Kind k, std::int64_t& low, std::uint64_t& high) noexcept {
  const int bits = k == Kind::boolean ? 1 : 8 << (rank(k) - 1);
  if (is_signed(k)) {
    high = (std::uint64_t{1} << (bits - 1)) - 1;
    low = -static_cast<std::int64_t>(high) - 1;
  } else {
    low = 0;
    high = bits == 64 ? std::numeric_limits<std::uint64_t>::max() : (std::uint64_t{1} << bits) - 1;
  }
}

Conversion conversion(const Type& from, const Type& to) noexcept {
  if (&from == &to || from.kind == Kind::error || to.kind == Kind::error) return Conversion::same;
  if (from.kind == Kind::enumeration || to.kind == Kind::enumeration) return Conversion::none;
  if (is_elementary(from.kind) && is_elementary(to.kind)) return between(from.kind, to.kind);
  if (from.kind == Kind::reference && to.kind == Kind::reference) {
    if (from.base == nullptr || to.base == nullptr)
      return from.base == nullptr ? Conversion::widening : Conversion::none;
    return binds(*from.base, *to.base) ? Conversion::same : Conversion::none;
  }
  if (from.kind == Kind::array && to.kind == Kind::array && !from.open && !to.open &&
      from.range.count() == to.range.count() && from.range.low == to.range.low && from.size == to.size)
    return conversion(*from.base, *to.base) == Conversion::same && range_fits(*from.base, *to.base)
               ? Conversion::same
               : Conversion::none;
  return Conversion::none;
}

bool range_fits(const Type& from, const Type& to) noexcept {
  const Type *f = &from, *t = &to;
  for (; f->kind == Kind::array && t->kind == Kind::array; f = f->base) t = t->base;
  return !t->bounded || (f->bounded && f->limits.low >= t->limits.low && f->limits.high <= t->limits.high);
}

bool takes_output(const Type& actual, const Type& formal) noexcept {
  const Type *a = &actual, *f = &formal;
  if (a->kind == Kind::error || f->kind == Kind::error) return true;
  for (; f->open; a = a->base, f = f->base)
    if (a->kind != Kind::array) return false;
  return a == f ||
         (!a->open && a->size == f->size && conversion(*a, *f) == Conversion::same && range_fits(*f, *a));
}

bool binds(const Type& actual, const Type& formal) noexcept {
  const bool known = actual.kind != Kind::error && formal.kind != Kind::error;
  return takes_output(actual, formal) && (!known || range_fits(actual, formal));
}

TypeTable::TypeTable() {
  for (const Elementary& e : kElementary) {
    Type* t = add(e.kind, e.name);
    t->size = t->align = e.size;
    by_kind_[static_cast<std::size_t>(e.kind)] = t;
    if (e.kind >= Kind::boolean && e.kind <= Kind::wide_character) named_[e.name] = t;
  }
  for (const auto& [name, kind] : kOtherNames) named_[name] = elementary(kind);
  for (const Kind k : {Kind::string, Kind::wide_string}) {
    const Type* t = string(kDefaultStringCapacity, k);
    by_kind_[static_cast<std::size_t>(k)] = t;
    named_[t->name] = t;
  }
}

const Type* TypeTable::string(std::uint32_t capacity, Kind kind) {
  const Type*& known = strings_[{kind, capacity}];
  if (known != nullptr) return known;
  const std::string name = kind == Kind::wide_string ? "WSTRING" : "STRING";
  const bool plain = capacity == kDefaultStringCapacity;
  Type* t = add(kind, plain ? name : name + "[" + std::to_string(capacity) + "]");
  t->size = text_size(kind, capacity);
  t->align = kind == Kind::wide_string ? 2 : 1;
  return known = t;
}

const Type* TypeTable::array(const Type* element, Dimension range) {
  const Type*& known = arrays_[{element, range.low, range.high}];
  if (known != nullptr) return known;
  Type* t = add(Kind::array, "ARRAY[" + std::to_string(range.low) + ".." + std::to_string(range.high) +
                                 "] OF " + element->name);
  t->base = element;
  t->range = range;
  t->align = element->align;
  t->size = static_cast<std::uint32_t>(range.count()) * element->size;
  if (!element->image.empty())
    for (std::int64_t i = 0; i < range.count(); ++i)
      t->image.insert(t->image.end(), element->image.begin(), element->image.end());
  t->holds_reference = element->holds_reference;
  t->holds_instance = element->holds_instance;
  t->holds_location = element->holds_location;
  return known = t;
}

const Type* TypeTable::open_array(const Type* element) {
  const Type*& known = open_arrays_[element];
  if (known != nullptr) return known;
  Type* t = add(Kind::array, "ARRAY[*] OF " + element->name);
  t->open = true;
  t->base = element;
  t->range = {0, -1};
  t->holds_reference = element->holds_reference;
  t->holds_instance = element->holds_instance;
  t->holds_location = element->holds_location;
  return known = t;
}

const Type* TypeTable::reference(const Type* target) {
  const Type*& known = references_[target];
  if (known != nullptr) return known;
  Type* t = add(Kind::reference, target == nullptr ? "NULL" : "REF_TO " + target->name);
  t->base = target;
  t->size = t->align = 4;
  return known = t;
}

Type* TypeTable::add(Kind k, std::string name) {
  Type& t = all_.emplace_back();
  t.kind = k;
  t.name = std::move(name);
  t.holds_reference = k == Kind::reference;
  t.holds_instance = k == Kind::block;
  return &t;
}

bool TypeTable::name(std::string_view name, const Type* type) {
  return named_.emplace(key_of(name), type).second;
}

const Type* TypeTable::find(std::string_view name) const {
  const auto at = named_.find(key_of(name));
  return at == named_.end() ? nullptr : at->second;
}

const Type* TypeTable::common(const Type& a, const Type& b) const noexcept {
  const auto fits = [](const Type& from, const Type& to) {
    const Conversion c = conversion(from, to);
    return c == Conversion::same || c == Conversion::widening;
  };
  if (is_text(a.kind) && a.kind == b.kind) return a.size >= b.size ? &a : &b;
  if (fits(b, a)) return a.bounded ? a.base : &a;
  if (fits(a, b)) return b.bounded ? b.base : &b;
  static constexpr Kind order[] = {Kind::sint,  Kind::usint, Kind::int_, Kind::uint, Kind::dint,
                                   Kind::udint, Kind::lint,  Kind::real, Kind::lreal};
  for (const Kind k : order)
    if (fits(a, *elementary(k)) && fits(b, *elementary(k))) return elementary(k);
  return nullptr;
}

}  // namespace servogate::plc
