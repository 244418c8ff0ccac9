// SPDX-License-Identifier: Apache-2.0
#include "plc/variables/values.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "plc/syntax/lexer.hpp"
#include "plc/syntax/time_literal.hpp"
#include "plc/types/characters.hpp"

namespace servogate::plc {

namespace {

std::int64_t integer_at(const Type& type, const std::uint8_t* at) noexcept {
  const Cell c = cell_of(type);
  const std::uint32_t size = cell_size(c);
  std::int64_t v = 0;
  std::memcpy(&v, at, size);
  const int unused = 64 - static_cast<int>(size) * 8;
  if (c <= Cell::i64 && unused > 0)
    v = static_cast<std::int64_t>(static_cast<std::uint64_t>(v) << unused) >> unused;
  return v;
}

template <typename T>
std::string shortest(T v) {
  if (!std::isfinite(v)) return std::isnan(v) ? "\"NaN\"" : v > 0 ? "\"INF\"" : "\"-INF\"";
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, v);
  (void)error;
  return {buffer, end};
}

// A STRING holds bytes; one that is no UTF-8 is shown by its number, as $FF.
std::string quoted(std::string_view s) {
  std::string out = "\"";
  std::size_t inside = 0;  // bytes of the character begun
  for (std::size_t at = 0; at < s.size(); ++at) {
    const char c = s[at];
    if (inside == 0) inside = utf8_length(s, at);
    const bool whole = inside > 0;
    inside -= whole;
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char buffer[8];
      std::snprintf(buffer, sizeof buffer, "\\u%04x", static_cast<unsigned>(c));
      out += buffer;
    } else if (!whole) {
      char buffer[8];
      std::snprintf(buffer, sizeof buffer, "$%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += buffer;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

// The units of a WSTRING or WCHAR, wherever they lie.
std::u16string units_at(const Type& type, const std::uint8_t* at) {
  const std::uint32_t before = type.kind == Kind::wide_string ? 2 : 0;
  std::u16string out((value_size(type, at) - before) / 2, u'\0');
  std::memcpy(out.data(), at + before, out.size() * sizeof(char16_t));
  return out;
}
// The bytes of a STRING or CHAR; of a WSTRING or WCHAR its characters as UTF-8, half a surrogate pair by its
// number.
std::string bytes_at(const Type& type, const std::uint8_t* at) {
  const auto* text = reinterpret_cast<const char*>(at);
  if (type.kind == Kind::character) return {text, 1};
  if (type.kind == Kind::string) return {text + 1, *at};
  std::string out;
  const std::u16string units = units_at(type, at);
  for (std::size_t i = 0; i < units.size();) {
    const char32_t c = take_character(units, i);
    char buffer[8];
    out.append(buffer, is_surrogate(c) ? static_cast<std::size_t>(std::snprintf(
                                             buffer, sizeof buffer, "$%04X", static_cast<unsigned>(c)))
                                       : put_character(c, buffer));
  }
  return out;
}

std::string compound(const Type& type, const std::uint8_t* at) {
  std::string out;
  if (type.kind == Kind::array) {
    for (std::int64_t i = 0; i < type.range.count(); ++i)
      out += (i == 0 ? "" : ",") + to_json(*type.base, at + i * type.base->size);
    return "[" + out + "]";
  }
  for (const Field& f : type.fields)
    if (!f.reference && f.name.find('$') == std::string::npos)
      out += (out.empty() ? "" : ",") + quoted(f.name) + ":" + to_json(*f.type, at + f.offset);
  return "{" + out + "}";
}

}  // namespace

std::string to_json(const Type& type, const std::uint8_t* at, int bit) {
  if (bit >= 0) return ((*at >> bit) & 1) != 0 ? "true" : "false";
  for (const EnumValue& e : type.values)
    if (std::memcmp(&e.value, at, type.size) == 0) return quoted(e.name);
  switch (type.kind) {
    case Kind::boolean:
      return *at != 0 ? "true" : "false";
    case Kind::real: {
      float v = 0;
      std::memcpy(&v, at, sizeof v);
      return shortest(v);
    }
    case Kind::lreal: {
      double v = 0;
      std::memcpy(&v, at, sizeof v);
      return shortest(v);
    }
    case Kind::string:
    case Kind::wide_string:
    case Kind::character:
    case Kind::wide_character:
      return quoted(bytes_at(type, at));
    case Kind::reference:
      return integer_at(type, at) == 0 ? "\"NULL\"" : "\"REF\"";
    case Kind::array:
    case Kind::structure:
    case Kind::block:
      return compound(type, at);
    default:
      break;
  }
  const std::int64_t v = integer_at(type, at);
  if (is_temporal(type.kind)) {
    char buffer[48];
    return quoted({buffer, syntax::print_time(type.kind, v, buffer)});
  }
  if (type.kind == Kind::enumeration) return to_json(*type.base, at);
  return cell_of(type) == Cell::u64 ? std::to_string(static_cast<std::uint64_t>(v)) : std::to_string(v);
}

std::string to_literal(const Type& type, const std::uint8_t* at) {
  if (!is_text(type.kind) && !is_character(type.kind)) {
    std::string s = to_json(type, at);
    if (s.size() > 1 && s[0] == '"') s = s.substr(1, s.size() - 2);
    return s;
  }
  const char quote = is_wide(type.kind) ? '"' : '\'';
  std::string out(1, quote);
  const auto add = [&](char32_t c, const char* as_number, std::string_view as_it_is) {
    char buffer[8];
    const bool plain =
        c >= 0x20 && c != '$' && c != static_cast<char32_t>(quote) && c != 0x7F && !is_surrogate(c);
    if (!plain) std::snprintf(buffer, sizeof buffer, as_number, static_cast<unsigned>(c));
    out += plain ? as_it_is : std::string_view(buffer);
  };
  if (is_wide(type.kind)) {
    const std::u16string units = units_at(type, at);
    for (std::size_t i = 0; i < units.size();) {
      const std::size_t begin = i;
      const char32_t c = take_character(units, i);
      add(c, "$%04X", narrow(std::u16string_view(units).substr(begin, i - begin)));
    }
  } else {
    for (const char c : bytes_at(type, at)) add(static_cast<unsigned char>(c), "$%02X", {&c, 1});
  }
  return out + quote;
}

namespace {

bool store_literal(const Type& type, const syntax::Literal& l, std::uint8_t* out) {
  if (is_temporal(type.kind) || l.kind == Kind::boolean || type.kind == Kind::boolean ||
      is_temporal(l.kind)) {
    const bool truth =
        type.kind == Kind::boolean && l.kind == Kind::untyped_int && l.magnitude <= 1 && !l.negative;
    if (l.kind != type.kind && !truth) return false;
    const auto v = static_cast<std::int64_t>(l.negative ? 0 - l.magnitude : l.magnitude);
    std::memcpy(out, &v, type.size);
    return true;
  }
  if (is_real(type.kind)) {
    const double whole = static_cast<double>(l.magnitude) * (l.negative ? -1.0 : 1.0);
    return from_number(type, l.kind == Kind::untyped_real ? l.real : whole, out);
  }
  if (type.kind == Kind::enumeration && !is_integer(type.base->kind) && !is_bits(type.base->kind))
    return store_literal(*type.base, l, out);
  if (l.kind != Kind::untyped_int) return false;
  std::int64_t low = 0;
  std::uint64_t high = 0;
  integer_limits(type.kind == Kind::enumeration ? type.base->kind : type.kind, low, high);
  if (l.negative
          ? l.magnitude > static_cast<std::uint64_t>(-(low + 1)) + (low < 0 ? 1 : 0) && l.magnitude != 0
          : l.magnitude > high)
    return false;
  if (l.negative && low == 0 && l.magnitude != 0) return false;
  const std::uint64_t v = l.negative ? 0 - l.magnitude : l.magnitude;
  const auto as_signed = static_cast<std::int64_t>(v);
  if (type.bounded && (as_signed < type.limits.low || as_signed > type.limits.high)) return false;
  std::memcpy(out, &v, cell_size(cell_of(type)));
  return true;
}

}  // namespace

namespace {

// A literal with either quotes, or plain text.
bool parse_text(const Type& type, std::string_view text, std::uint8_t* out) {
  syntax::Literal l;
  std::string s(text);
  std::u16string w;
  const bool literal = !text.empty() && (text[0] == '\'' || text[0] == '"') && syntax::parse_literal(text, l);
  if (literal && is_text(l.kind)) s = l.kind == Kind::string ? l.text : narrow(l.wide);
  if (is_wide(type.kind)) w = literal && l.kind == Kind::wide_string ? l.wide : wide(s);
  const std::size_t length = is_wide(type.kind) ? w.size() : s.size();
  if (is_character(type.kind) ? length != 1 : length > type.capacity()) return false;
  if (is_text(type.kind)) {
    const auto n = static_cast<std::uint16_t>(length);
    const std::uint32_t bytes = is_wide(type.kind) ? 2 : 1;
    std::memcpy(out, &n, bytes);
    out += bytes;
  }
  if (is_wide(type.kind))
    std::memcpy(out, w.data(), length * sizeof(char16_t));
  else
    std::memcpy(out, s.data(), length);
  return true;
}

}  // namespace

bool parse_value(const Type& type, std::string_view text, std::uint8_t* out) {
  if (is_text(type.kind) || is_character(type.kind)) return parse_text(type, text, out);
  if (!is_elementary(type.kind)) return false;
  if (!type.values.empty()) {
    const std::size_t mark = text.find('#');
    if (const EnumValue* v =
            type.value_named(mark == std::string_view::npos ? text : text.substr(mark + 1))) {
      std::memcpy(out, &v->value, type.size);
      return true;
    }
  }
  syntax::Literal l;
  return syntax::parse_literal(text, l) && store_literal(type, l, out);
}

double to_number(const Type& type, const std::uint8_t* at) noexcept {
  const Cell c = cell_of(type);
  if (c >= Cell::text) return std::numeric_limits<double>::quiet_NaN();
  if (c == Cell::f32) {
    float v = 0;
    std::memcpy(&v, at, sizeof v);
    return static_cast<double>(v);
  }
  if (c == Cell::f64) {
    double v = 0;
    std::memcpy(&v, at, sizeof v);
    return v;
  }
  const std::int64_t v = integer_at(type, at);
  return c == Cell::u64 ? static_cast<double>(static_cast<std::uint64_t>(v)) : static_cast<double>(v);
}

bool from_number(const Type& type, double value, std::uint8_t* out) noexcept {
  const Cell c = cell_of(type);
  if (c >= Cell::text || std::isnan(value)) return false;
  if (c == Cell::f32) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) return false;
    const auto v = static_cast<float>(value);
    std::memcpy(out, &v, sizeof v);
    return true;
  }
  if (c == Cell::f64) {
    std::memcpy(out, &value, sizeof value);
    return true;
  }
  const double r = std::nearbyint(value);
  const int bits = type.kind == Kind::boolean ? 1 : static_cast<int>(cell_size(c)) * 8;
  const bool is_signed = c <= Cell::i64;
  const double high = std::ldexp(1.0, bits - (is_signed ? 1 : 0));
  if (!(r >= (is_signed ? -high : 0.0) && r < high)) return false;
  if (type.bounded && (r < static_cast<double>(type.limits.low) || r > static_cast<double>(type.limits.high)))
    return false;
  const std::uint64_t v =
      is_signed ? static_cast<std::uint64_t>(static_cast<std::int64_t>(r)) : static_cast<std::uint64_t>(r);
  std::memcpy(out, &v, cell_size(c));
  return true;
}

}  // namespace servogate::plc
