// SPDX-License-Identifier: Apache-2.0
#include "plc/vm/text_natives.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "plc/syntax/time_literal.hpp"
#include "plc/types/characters.hpp"

namespace servogate::plc::vm {

namespace {

using Bytes = std::uint8_t;
using Wide = char16_t;  // of a WSTRING; a STRING is of char

template <typename T>
T get(const Bytes* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// A text in memory: its length in one byte, or in two of a WSTRING, then the characters.
template <typename C>
std::basic_string_view<C> text_at(const Bytes* p) noexcept {
  using Length = std::conditional_t<sizeof(C) == 1, std::uint8_t, std::uint16_t>;
  return {reinterpret_cast<const C*>(p + sizeof(Length)), get<Length>(p)};
}

// Results grow in a cell of 255 characters that no input shares; what is longer is cut.
template <typename C>
struct Writer {
  Bytes* d;
  std::size_t n = 0;
  void add(std::basic_string_view<C> s) noexcept {
    const std::size_t k = std::min<std::size_t>(s.size(), kMaxStringCapacity - n);
    if (k != 0) std::memcpy(d + (1 + n) * sizeof(C), s.data(), k * sizeof(C));
    n += k;
  }
  Fault done() noexcept {
    const auto length = static_cast<std::uint16_t>(n);
    std::memcpy(d, &length, sizeof(C));
    return Fault::none;
  }
};

std::size_t clamp_length(std::int64_t n, std::size_t most) noexcept {
  return n >= static_cast<std::int64_t>(most) ? most : static_cast<std::size_t>(n);
}

template <typename C>
Fault length(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto n = static_cast<std::int16_t>(text_at<C>(a).size());
  std::memcpy(d, &n, sizeof n);
  return Fault::none;
}
template <typename C>
Fault left(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  if (n < 0) return Fault::text_position;
  const auto s = text_at<C>(a);
  Writer<C> w{d};
  w.add(s.substr(0, clamp_length(n, s.size())));
  return w.done();
}
template <typename C>
Fault right(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  if (n < 0) return Fault::text_position;
  const auto s = text_at<C>(a);
  Writer<C> w{d};
  w.add(s.substr(s.size() - clamp_length(n, s.size())));
  return w.done();
}
// Positions count from 1; one behind the end is allowed where nothing is taken.
bool position(std::int64_t l, std::int64_t p, std::size_t size) noexcept {
  return l >= 0 && p >= 1 && p <= static_cast<std::int64_t>(size) + 1;
}
template <typename C>
Fault mid(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto l = get<std::int64_t>(b), p = get<std::int64_t>(m.extra[0]);
  const auto s = text_at<C>(a);
  if (!position(l, p, s.size())) return Fault::text_position;
  Writer<C> w{d};
  w.add(s.substr(static_cast<std::size_t>(p - 1), clamp_length(l, s.size())));
  return w.done();
}
template <typename C>
Fault concat(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  Writer<C> w{d};
  w.add(text_at<C>(a));
  w.add(text_at<C>(b));
  return w.done();
}
template <typename C>
Fault insert(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto p = get<std::int64_t>(m.extra[0]);
  const auto s = text_at<C>(a);
  if (p < 0 || p > static_cast<std::int64_t>(s.size())) return Fault::text_position;
  Writer<C> w{d};
  w.add(s.substr(0, static_cast<std::size_t>(p)));
  w.add(text_at<C>(b));
  w.add(s.substr(static_cast<std::size_t>(p)));
  return w.done();
}
template <typename C>
Fault cut(Bytes* d, std::basic_string_view<C> s, std::basic_string_view<C> with, std::int64_t l,
          std::int64_t p) noexcept {
  if (!position(l, p, s.size())) return Fault::text_position;
  const auto from = static_cast<std::size_t>(p - 1);
  Writer<C> w{d};
  w.add(s.substr(0, from));
  w.add(with);
  w.add(s.substr(from + clamp_length(l, s.size() - from)));
  return w.done();
}
template <typename C>
Fault remove(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  return cut<C>(d, text_at<C>(a), {}, get<std::int64_t>(b), get<std::int64_t>(m.extra[0]));
}
template <typename C>
Fault replace(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  return cut<C>(d, text_at<C>(a), text_at<C>(b), get<std::int64_t>(m.extra[0]),
                get<std::int64_t>(m.extra[1]));
}
template <typename C>
Fault find(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  using View = std::basic_string_view<C>;
  const View part = text_at<C>(b);
  const std::size_t at = part.empty() ? View::npos : text_at<C>(a).find(part);
  const auto n = static_cast<std::int16_t>(at == View::npos ? 0 : at + 1);
  std::memcpy(d, &n, sizeof n);
  return Fault::none;
}
template <typename C>
Fault compare(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const int order = text_at<C>(a).compare(text_at<C>(b));
  *d = static_cast<Bytes>(order < 0 ? -1 : order > 0 ? 1 : 0);
  return Fault::none;
}
template <typename C, bool kGreatest>
Fault pick(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const bool second = kGreatest ? text_at<C>(b) > text_at<C>(a) : text_at<C>(b) < text_at<C>(a);
  Writer<C> w{d};
  w.add(text_at<C>(second ? b : a));
  return w.done();
}

template <typename T>
Fault number_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, get<T>(a));
  (void)error;
  Writer<char> w{d};
  w.add({buffer, static_cast<std::size_t>(end - buffer)});
  return w.done();
}
template <Kind K>
Fault time_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  char buffer[48];
  Writer<char> w{d};
  w.add({buffer, syntax::print_time(K, get<std::int64_t>(a), buffer)});
  return w.done();
}
Fault bool_to_text(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  Writer<char> w{d};
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
  std::string_view s = trimmed(text_at<char>(a));
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  T v{};
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (error != std::errc{} || end != s.data() + s.size()) return Fault::conversion;
  std::memcpy(d, &v, sizeof v);
  return Fault::none;
}
template <Kind K>
Fault text_to_time(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const std::string_view s = trimmed(text_at<char>(a));
  const std::size_t mark = s.find('#');
  std::int64_t ns = 0;
  if (mark == std::string_view::npos || !syntax::parse_time(K, s.substr(mark + 1), ns))
    return Fault::conversion;
  std::memcpy(d, &ns, sizeof ns);
  return Fault::none;
}
Fault text_to_bool(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const std::string_view s = trimmed(text_at<char>(a));
  const bool yes = same_name(s, "TRUE") || s == "1";
  if (!yes && !same_name(s, "FALSE") && s != "0") return Fault::conversion;
  *d = yes;
  return Fault::none;
}
template <typename C>
Fault first_character(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto s = text_at<C>(a);
  const C c = s.empty() ? C{} : s[0];
  std::memcpy(d, &c, sizeof c);
  return Fault::none;
}
template <typename C>
Fault one_character(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const C c = get<C>(a);
  Writer<C> w{d};
  w.add({&c, 1});
  return w.done();
}
// STRING to WSTRING and back; what does not fit is cut between characters.
template <typename From, typename To>
Fault recoded(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto s = text_at<From>(a);
  Writer<To> w{d};
  To units[4];
  for (std::size_t at = 0; at < s.size();) {
    const std::size_t n = put_character(take_character(s, at), units);
    if (w.n + n > kMaxStringCapacity) break;
    w.add({units, n});
  }
  return w.done();
}
Fault narrow_character(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto c = get<Wide>(a);
  if (c > 0xFF) return Fault::conversion;
  *d = static_cast<Bytes>(c);
  return Fault::none;
}

// A value and a WSTRING by way of the STRING of its ASCII characters.
constexpr std::size_t kTextCell = text_size(Kind::string, kMaxStringCapacity);
template <NativeFunction F>
Fault to_wide(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  Bytes text[kTextCell];
  if (const Fault f = F(m, text, a, b); f != Fault::none) return f;
  return recoded<char, Wide>(m, d, text, nullptr);
}
template <NativeFunction F>
Fault from_wide(Machine& m, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  Bytes text[kTextCell];
  Writer<char> w{text};
  for (const Wide c : text_at<Wide>(a)) {
    const char narrowed = static_cast<char>(c);
    if (c > 0x7F) return Fault::conversion;
    w.add({&narrowed, 1});
  }
  w.done();
  return F(m, d, text, b);
}

template <typename C>
constexpr std::array<NativeFunction, 12> functions() {
  return {length<C>, left<C>,    right<C>, mid<C>,     concat<C>,      insert<C>,
          remove<C>, replace<C>, find<C>,  compare<C>, pick<C, false>, pick<C, true>};
}
constexpr std::array<std::array<NativeFunction, 12>, 2> kFunctions = {functions<char>(), functions<Wide>()};

// By cell, then by kind: BOOL and the four of times.
constexpr std::size_t kValues = 15;
constexpr std::array<NativeFunction, kValues> kToText = {number_to_text<std::int8_t>,
                                                         number_to_text<std::int16_t>,
                                                         number_to_text<std::int32_t>,
                                                         number_to_text<std::int64_t>,
                                                         number_to_text<std::uint8_t>,
                                                         number_to_text<std::uint16_t>,
                                                         number_to_text<std::uint32_t>,
                                                         number_to_text<std::uint64_t>,
                                                         number_to_text<float>,
                                                         number_to_text<double>,
                                                         bool_to_text,
                                                         time_to_text<Kind::time>,
                                                         time_to_text<Kind::date>,
                                                         time_to_text<Kind::tod>,
                                                         time_to_text<Kind::dt>};
constexpr std::array<NativeFunction, kValues> kFromText = {text_to_number<std::int8_t>,
                                                           text_to_number<std::int16_t>,
                                                           text_to_number<std::int32_t>,
                                                           text_to_number<std::int64_t>,
                                                           text_to_number<std::uint8_t>,
                                                           text_to_number<std::uint16_t>,
                                                           text_to_number<std::uint32_t>,
                                                           text_to_number<std::uint64_t>,
                                                           text_to_number<float>,
                                                           text_to_number<double>,
                                                           text_to_bool,
                                                           text_to_time<Kind::time>,
                                                           text_to_time<Kind::date>,
                                                           text_to_time<Kind::tod>,
                                                           text_to_time<Kind::dt>};

template <std::size_t... I>
constexpr std::array<std::array<NativeFunction, kValues>, 4> conversions(std::index_sequence<I...>) {
  return {kToText, {to_wide<kToText[I]>...}, kFromText, {from_wide<kFromText[I]>...}};
}
constexpr auto kConversions = conversions(std::make_index_sequence<kValues>{});
constexpr NativeFunction kOthers[] = {one_character<char>,   one_character<Wide>, first_character<char>,
                                      first_character<Wide>, recoded<Wide, char>, recoded<char, Wide>,
                                      narrow_character};

// Numbers: functions of STRING and WSTRING, conversions in four rows, others.
constexpr std::uint16_t kWideBase = kTextBase + 12, kConversionBase = kTextBase + 24,
                        kOtherBase = kConversionBase + 4 * kValues;

std::uint16_t conversion_number(std::size_t row, const Type& type) noexcept {
  std::size_t column = static_cast<std::size_t>(cell_of(type));
  if (type.kind == Kind::boolean) column = 10;
  if (is_temporal(type.kind))
    column = 11 + static_cast<std::size_t>(type.kind) - static_cast<std::size_t>(Kind::time);
  return static_cast<std::uint16_t>(kConversionBase + row * kValues + column);
}

}  // namespace

std::uint16_t text_function(ir::Native n, bool wide) noexcept {
  return static_cast<std::uint16_t>((wide ? kWideBase : kTextBase) + static_cast<int>(n) -
                                    static_cast<int>(ir::Native::length));
}
std::uint16_t to_text_function(const Type& from, bool wide) noexcept {
  if (is_character(from.kind)) return kOtherBase + (wide ? 1 : 0);
  if (is_text(from.kind)) return kOtherBase + (wide ? 5 : 4);
  return conversion_number(wide ? 1 : 0, from);
}
std::uint16_t from_text_function(const Type& from, const Type& to) noexcept {
  if (is_character(from.kind)) return kOtherBase + 6;
  const bool wide = is_wide(from.kind);
  if (is_character(to.kind)) return kOtherBase + (wide ? 3 : 2);
  return conversion_number(wide ? 3 : 2, to);
}
std::uint16_t character_text_function(bool wide) noexcept { return kOtherBase + (wide ? 1 : 0); }
std::uint16_t compare_text_function(bool wide) noexcept { return (wide ? kWideBase : kTextBase) + 9; }
std::uint16_t pick_text_function(bool greatest, bool wide) noexcept {
  return static_cast<std::uint16_t>((wide ? kWideBase : kTextBase) + (greatest ? 11 : 10));
}
NativeFunction text_native(std::uint16_t number) noexcept {
  if (number < kConversionBase) return kFunctions[(number - kTextBase) / 12u][(number - kTextBase) % 12u];
  if (number >= kOtherBase) return kOthers[number - kOtherBase];
  return kConversions[(number - kConversionBase) / kValues][(number - kConversionBase) % kValues];
}

}  // namespace servogate::plc::vm
