// SPDX-License-Identifier: Apache-2.0
#include "plc/vm/text_natives.hpp"

#include <charconv>
#include <cmath>
#include <cstring>

#include "plc/syntax/time_literal.hpp"

namespace servogate::plc::vm {

namespace {

using Bytes = std::uint8_t;

template <typename T>
T get(const Bytes* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// Results grow in a cell of 254 characters that no input shares; what is longer is cut.
struct Writer {
  Bytes* d;
  std::size_t n = 0;
  void add(std::string_view s) noexcept {
    const std::size_t k = std::min<std::size_t>(s.size(), kMaxStringCapacity - n);
    if (k != 0) std::memcpy(d + 1 + n, s.data(), k);
    n += k;
  }
  Fault done() noexcept {
    *d = static_cast<Bytes>(n);
    return Fault::none;
  }
};

std::size_t clamp_length(std::int64_t n, std::size_t most) noexcept {
  return n >= static_cast<std::int64_t>(most) ? most : static_cast<std::size_t>(n);
}

Fault length(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const std::int16_t n = *a;
  std::memcpy(d, &n, sizeof n);
  return Fault::none;
}
Fault left(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  if (n < 0) return Fault::text_position;
  Writer w{d};
  w.add(text_at(a).substr(0, clamp_length(n, *a)));
  return w.done();
}
Fault right(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  if (n < 0) return Fault::text_position;
  Writer w{d};
  w.add(text_at(a).substr(*a - clamp_length(n, *a)));
  return w.done();
}
// Positions count from 1; one behind the end is allowed where nothing is taken.
bool position(std::int64_t l, std::int64_t p, std::size_t size) noexcept {
  return l >= 0 && p >= 1 && p <= static_cast<std::int64_t>(size) + 1;
}
Fault mid(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto l = get<std::int64_t>(b), p = get<std::int64_t>(m.extra[0]);
  if (!position(l, p, *a)) return Fault::text_position;
  Writer w{d};
  w.add(text_at(a).substr(static_cast<std::size_t>(p - 1), clamp_length(l, 255)));
  return w.done();
}
Fault concat(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  Writer w{d};
  w.add(text_at(a));
  w.add(text_at(b));
  return w.done();
}
Fault insert(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto p = get<std::int64_t>(m.extra[0]);
  if (p < 0 || p > *a) return Fault::text_position;
  const std::string_view s = text_at(a);
  Writer w{d};
  w.add(s.substr(0, static_cast<std::size_t>(p)));
  w.add(text_at(b));
  w.add(s.substr(static_cast<std::size_t>(p)));
  return w.done();
}
Fault cut(Bytes* d, std::string_view s, std::string_view with, std::int64_t l, std::int64_t p) noexcept {
  if (!position(l, p, s.size())) return Fault::text_position;
  const auto from = static_cast<std::size_t>(p - 1);
  Writer w{d};
  w.add(s.substr(0, from));
  w.add(with);
  w.add(s.substr(from + clamp_length(l, s.size() - from)));
  return w.done();
}
Fault remove(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  return cut(d, text_at(a), {}, get<std::int64_t>(b), get<std::int64_t>(m.extra[0]));
}
Fault replace(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  return cut(d, text_at(a), text_at(b), get<std::int64_t>(m.extra[0]), get<std::int64_t>(m.extra[1]));
}
Fault find(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const std::size_t at = *b == 0 ? std::string_view::npos : text_at(a).find(text_at(b));
  const auto n = static_cast<std::int16_t>(at == std::string_view::npos ? 0 : at + 1);
  std::memcpy(d, &n, sizeof n);
  return Fault::none;
}

template <typename T>
Fault number_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, get<T>(a));
  (void)error;
  Writer w{d};
  w.add({buffer, static_cast<std::size_t>(end - buffer)});
  return w.done();
}
template <Kind K>
Fault time_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  char buffer[48];
  Writer w{d};
  w.add({buffer, syntax::print_time(K, get<std::int64_t>(a), buffer)});
  return w.done();
}
Fault bool_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  Writer w{d};
  w.add(*a != 0 ? "TRUE" : "FALSE");
  return w.done();
}

std::string_view trimmed(std::string_view s) noexcept {
  while (!s.empty() && s.front() == ' ') s.remove_prefix(1);
  while (!s.empty() && s.back() == ' ') s.remove_suffix(1);
  return s;
}
template <typename T>
Fault text_to_number(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  std::string_view s = trimmed(text_at(a));
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  T v{};
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (error != std::errc{} || end != s.data() + s.size()) return Fault::conversion;
  std::memcpy(d, &v, sizeof v);
  return Fault::none;
}
template <Kind K>
Fault text_to_time(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const std::string_view s = trimmed(text_at(a));
  const std::size_t mark = s.find('#');
  std::int64_t ns = 0;
  if (mark == std::string_view::npos || !syntax::parse_time(K, s.substr(mark + 1), ns))
    return Fault::conversion;
  std::memcpy(d, &ns, sizeof ns);
  return Fault::none;
}
Fault text_to_bool(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const std::string_view s = trimmed(text_at(a));
  const bool yes = same_name(s, "TRUE") || s == "1";
  if (!yes && !same_name(s, "FALSE") && s != "0") return Fault::conversion;
  *d = yes;
  return Fault::none;
}
Fault text_to_character(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  *d = *a == 0 ? 0 : a[1];
  return Fault::none;
}

Fault compare(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const int order = text_at(a).compare(text_at(b));
  *d = static_cast<Bytes>(order < 0 ? -1 : order > 0 ? 1 : 0);
  return Fault::none;
}
template <bool kGreatest>
Fault pick(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const bool second = kGreatest ? text_at(b) > text_at(a) : text_at(b) < text_at(a);
  Writer w{d};
  w.add(text_at(second ? b : a));
  return w.done();
}

constexpr NativeFunction kFunctions[] = {
    length, left, right, mid, concat, insert, remove, replace, find, compare, pick<false>, pick<true>,
    // 12: to text, by cell
    number_to_text<std::int8_t>, number_to_text<std::int16_t>, number_to_text<std::int32_t>,
    number_to_text<std::int64_t>, number_to_text<std::uint8_t>, number_to_text<std::uint16_t>,
    number_to_text<std::uint32_t>, number_to_text<std::uint64_t>, number_to_text<float>,
    number_to_text<double>,
    // 22: to text, by kind
    bool_to_text, time_to_text<Kind::time>, time_to_text<Kind::date>, time_to_text<Kind::tod>,
    time_to_text<Kind::dt>,
    // 27: from text, by cell
    text_to_number<std::int8_t>, text_to_number<std::int16_t>, text_to_number<std::int32_t>,
    text_to_number<std::int64_t>, text_to_number<std::uint8_t>, text_to_number<std::uint16_t>,
    text_to_number<std::uint32_t>, text_to_number<std::uint64_t>, text_to_number<float>,
    text_to_number<double>,
    // 37: from text, by kind
    text_to_bool, text_to_time<Kind::time>, text_to_time<Kind::date>, text_to_time<Kind::tod>,
    text_to_time<Kind::dt>, text_to_character};

std::uint16_t numbered(int base, int kinds, const Type& type) noexcept {
  int index = base + static_cast<int>(cell_of(type));
  if (type.kind == Kind::boolean) index = kinds;
  if (is_temporal(type.kind)) index = kinds + 1 + static_cast<int>(type.kind) - static_cast<int>(Kind::time);
  return static_cast<std::uint16_t>(kTextBase + index);
}

}  // namespace

std::uint16_t to_text_function(const Type& type) noexcept { return numbered(12, 22, type); }
std::uint16_t from_text_function(const Type& type) noexcept {
  return type.kind == Kind::character ? static_cast<std::uint16_t>(kTextBase + 42) : numbered(27, 37, type);
}
std::uint16_t compare_text_function() noexcept { return kTextBase + 9; }
std::uint16_t pick_text_function(bool greatest) noexcept {
  return static_cast<std::uint16_t>(kTextBase + (greatest ? 11 : 10));
}
NativeFunction text_native(std::uint16_t number) noexcept { return kFunctions[number - kTextBase]; }

}  // namespace servogate::plc::vm
