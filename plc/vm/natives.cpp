// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "plc/syntax/time_literal.hpp"
#include "plc/vm/machine.hpp"
#include "plc/vm/text_natives.hpp"

namespace servogate::plc::vm {

namespace {

using Bytes = std::uint8_t;

template <typename T>
T get(const Bytes* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <typename T>
void put(Bytes* p, T v) noexcept {
  std::memcpy(p, &v, sizeof v);
}

// The real that an integer type can hold: limits as powers of two are exact in double.
template <typename To>
bool fits(double v) noexcept {
  const double high = std::ldexp(1.0, static_cast<int>(sizeof(To) * 8) - (std::is_signed_v<To> ? 1 : 0));
  const double low = std::is_signed_v<To> ? -high : 0.0;
  return v >= low && v < high;
}

template <typename From, typename To, bool kTruncate>
Fault convert(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const From v = get<From>(a);
  if constexpr (std::is_floating_point_v<From> && std::is_integral_v<To>) {
    // IEC 61131-3, 6.6.2.5.4: to the nearest, a half to the even one.
    const double r = kTruncate ? std::trunc(static_cast<double>(v)) : std::nearbyint(static_cast<double>(v));
    if (!fits<To>(r)) return Fault::conversion;
    put(d, static_cast<To>(r));
  } else if constexpr (std::is_same_v<From, double> && std::is_same_v<To, float>) {
    const bool too_large =
        std::isfinite(v) && std::abs(v) > static_cast<double>(std::numeric_limits<float>::max());
    if (too_large) return Fault::conversion;
    put(d, static_cast<float>(v));
  } else {
    put(d, static_cast<To>(v));
  }
  return Fault::none;
}

template <bool kTruncate, typename From>
constexpr std::array<NativeFunction, 10> convert_row() {
  return {convert<From, std::int8_t, kTruncate>,   convert<From, std::int16_t, kTruncate>,
          convert<From, std::int32_t, kTruncate>,  convert<From, std::int64_t, kTruncate>,
          convert<From, std::uint8_t, kTruncate>,  convert<From, std::uint16_t, kTruncate>,
          convert<From, std::uint32_t, kTruncate>, convert<From, std::uint64_t, kTruncate>,
          convert<From, float, kTruncate>,         convert<From, double, kTruncate>};
}
template <bool kTruncate>
constexpr std::array<std::array<NativeFunction, 10>, 10> convert_table() {
  return {convert_row<kTruncate, std::int8_t>(),   convert_row<kTruncate, std::int16_t>(),
          convert_row<kTruncate, std::int32_t>(),  convert_row<kTruncate, std::int64_t>(),
          convert_row<kTruncate, std::uint8_t>(),  convert_row<kTruncate, std::uint16_t>(),
          convert_row<kTruncate, std::uint32_t>(), convert_row<kTruncate, std::uint64_t>(),
          convert_row<kTruncate, float>(),         convert_row<kTruncate, double>()};
}

template <typename T, T (*F)(T)>
Fault real(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  put(d, F(get<T>(a)));
  return Fault::none;
}
template <typename T>
Fault atan2_of(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  put(d, static_cast<T>(std::atan2(get<T>(a), get<T>(b))));
  return Fault::none;
}
template <typename T>
Fault power_of(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  put(d, static_cast<T>(std::pow(get<T>(a), get<T>(b))));
  return Fault::none;
}

// N beyond the width shifts everything out; a negative N shifts by nothing.
template <typename T>
Fault shl(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  const T v = get<T>(a);
  put(d, static_cast<T>(n <= 0 ? v : n >= static_cast<std::int64_t>(sizeof(T) * 8) ? 0 : v << n));
  return Fault::none;
}
template <typename T>
Fault shr(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const auto n = get<std::int64_t>(b);
  const T v = get<T>(a);
  put(d, static_cast<T>(n <= 0 ? v : n >= static_cast<std::int64_t>(sizeof(T) * 8) ? 0 : v >> n));
  return Fault::none;
}
template <typename T, bool kLeft>
Fault rotate(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  const int n = static_cast<int>(get<std::int64_t>(b) % static_cast<std::int64_t>(sizeof(T) * 8));
  put(d, kLeft ? std::rotl(get<T>(a), n) : std::rotr(get<T>(a), n));
  return Fault::none;
}

Fault now(Machine& m, Bytes* d, const Bytes*, const Bytes*) noexcept {
  put(d, m.now_ns);
  return Fault::none;
}
Fault clock_part(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto t = get<std::int64_t>(a) % syntax::kDay_ns;
  put(d, t < 0 ? t + syntax::kDay_ns : t);
  return Fault::none;
}
Fault day_part(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto t = get<std::int64_t>(a), rest = t % syntax::kDay_ns;
  put(d, t - (rest < 0 ? rest + syntax::kDay_ns : rest));
  return Fault::none;
}
Fault select_fault(Machine&, Bytes*, const Bytes*, const Bytes*) noexcept { return Fault::selector; }

// `b`: the number of bits that there are for the digits.
Fault to_bcd(Machine&, Bytes* d, const Bytes* a, const Bytes* b) noexcept {
  auto v = get<std::uint64_t>(a);
  const auto bits = static_cast<int>(get<std::uint64_t>(b));
  std::uint64_t out = 0;
  for (int shift = 0; shift < bits; shift += 4, v /= 10) out |= v % 10 << shift;
  if (v != 0) return Fault::conversion;
  put(d, out);
  return Fault::none;
}
Fault from_bcd(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  const auto v = get<std::uint64_t>(a);
  std::uint64_t out = 0;
  for (int shift = 60; shift >= 0; shift -= 4) {
    const std::uint64_t digit = v >> shift & 15;
    if (digit > 9) return Fault::conversion;
    out = out * 10 + digit;
  }
  put(d, out);
  return Fault::none;
}

template <std::size_t kBytes>
Fault turn_bytes(Machine&, Bytes* d, const Bytes* a, const Bytes*) noexcept {
  std::array<Bytes, kBytes> v;
  std::reverse_copy(a, a + kBytes, v.begin());
  std::memcpy(d, v.data(), kBytes);
  return Fault::none;
}

constexpr std::size_t kRealFunctions = 12;
template <typename T>
constexpr std::array<NativeFunction, kRealFunctions> real_functions() {
  return {real<T, std::sqrt>, real<T, std::log>,  real<T, std::log10>, real<T, std::exp>,
          real<T, std::sin>,  real<T, std::cos>,  real<T, std::tan>,   real<T, std::asin>,
          real<T, std::acos>, real<T, std::atan>, atan2_of<T>,         power_of<T>};
}
template <typename T>
constexpr std::array<NativeFunction, 4> shift_functions() {
  return {shl<T>, shr<T>, rotate<T, true>, rotate<T, false>};
}
constexpr std::array<std::array<NativeFunction, 4>, 4> kShifts = {
    shift_functions<std::uint8_t>(), shift_functions<std::uint16_t>(), shift_functions<std::uint32_t>(),
    shift_functions<std::uint64_t>()};
constexpr std::array<std::array<NativeFunction, kRealFunctions>, 2> kReals = {real_functions<float>(),
                                                                              real_functions<double>()};
constexpr auto kConvert = convert_table<false>();
constexpr auto kTruncate = convert_table<true>();
constexpr NativeFunction kOthers[] = {now,      day_part,      clock_part,    select_fault, to_bcd,
                                      from_bcd, turn_bytes<2>, turn_bytes<4>, turn_bytes<8>};

// Numbers: 0 convert, 100 truncate, 200 reals, 230 shifts, 250 others, 300 texts.
constexpr std::uint16_t kTruncateBase = 100, kRealBase = 200, kShiftBase = 230, kOtherBase = 250;

}  // namespace

std::uint16_t convert_function(Cell from, Cell to) noexcept {
  return static_cast<std::uint16_t>(static_cast<int>(from) * 10 + static_cast<int>(to));
}
std::uint16_t truncate_function(Cell from, Cell to) noexcept {
  return static_cast<std::uint16_t>(kTruncateBase + static_cast<int>(from) * 10 + static_cast<int>(to));
}

std::uint16_t native_function(const ir::Expr& e) noexcept {
  const ir::Native n = e.native;
  const Cell cell = cell_of(*e.type);
  const int i = static_cast<int>(n);
  if (n <= ir::Native::power)
    return static_cast<std::uint16_t>(kRealBase + i +
                                      (cell == Cell::f64 ? static_cast<int>(kRealFunctions) : 0));
  if (n <= ir::Native::ror) {
    const std::uint32_t bytes = cell_size(cell);
    const int row = bytes == 1 ? 0 : bytes == 2 ? 1 : bytes == 4 ? 2 : 3;
    return static_cast<std::uint16_t>(kShiftBase + row * 4 + i - static_cast<int>(ir::Native::shl));
  }
  switch (n) {
    case ir::Native::now:
      return kOtherBase;
    case ir::Native::day_part:
      return kOtherBase + 1;
    case ir::Native::clock_part:
      return kOtherBase + 2;
    case ir::Native::select_fault:
      return kOtherBase + 3;
    case ir::Native::to_bcd:
      return kOtherBase + 4;
    case ir::Native::from_bcd:
      return kOtherBase + 5;
    case ir::Native::turn_bytes:
      return static_cast<std::uint16_t>(kOtherBase + (cell_size(cell) == 2   ? 6
                                                      : cell_size(cell) == 4 ? 7
                                                                             : 8));
    case ir::Native::to_text:
      return to_text_function(*e.args[0]->type, is_wide(e.type->kind));
    case ir::Native::from_text:
      return from_text_function(*e.args[0]->type, *e.type);
    default:
      return text_function(n, is_wide(e.args[0]->type->kind));
  }
}

NativeFunction native_at(std::uint16_t n) noexcept {
  if (n < kTruncateBase) return kConvert[n / 10u][n % 10u];
  if (n < kRealBase) return kTruncate[(n - kTruncateBase) / 10u][(n - kTruncateBase) % 10u];
  if (n < kShiftBase) return kReals[(n - kRealBase) / kRealFunctions][(n - kRealBase) % kRealFunctions];
  if (n < kOtherBase) return kShifts[(n - kShiftBase) / 4u][(n - kShiftBase) % 4u];
  if (n < kTextBase) return kOthers[n - kOtherBase];
  return text_native(n);
}

}  // namespace servogate::plc::vm
