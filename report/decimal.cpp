// SPDX-License-Identifier: Apache-2.0
#include "report/decimal.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <system_error>

namespace servogate::report {

namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::uint64_t kPowers[] = {
    1,          10,          100,           1'000,          10'000,          100'000,          1'000'000,
    10'000'000, 100'000'000, 1'000'000'000, 10'000'000'000, 100'000'000'000, 1'000'000'000'000};
constexpr double kFast = 1e6;  // times 10^12 it still fits 64 bits

constexpr auto kPairs = [] {
  std::array<char, 200> out{};
  for (std::size_t i = 0; i < 100; ++i) {
    out[2 * i] = static_cast<char>('0' + i / 10);
    out[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return out;
}();

/// Exactly `digits` digits, leading zeros included.
void padded(char* out, std::uint64_t v, int digits) noexcept {
  char* at = out + digits;
  for (; digits >= 2; digits -= 2) {
    at -= 2;
    std::memcpy(at, &kPairs[v % 100 * 2], 2);
    v /= 100;
  }
  if (digits == 1) *--at = static_cast<char>('0' + v);
}

char* unsigned_integer(char* out, std::uint64_t v) noexcept {
  char buffer[20];
  char* at = buffer + sizeof buffer;
  for (; v >= 100; v /= 100) {
    at -= 2;
    std::memcpy(at, &kPairs[v % 100 * 2], 2);
  }
  if (v >= 10) {
    at -= 2;
    std::memcpy(at, &kPairs[v * 2], 2);
  } else {
    *--at = static_cast<char>('0' + v);
  }
  const auto size = static_cast<std::size_t>(buffer + sizeof buffer - at);
  std::memcpy(out, at, size);
  return out + size;
}

/// |value| * 10^decimals, rounded half to even on the exact binary value.
std::uint64_t scaled(double magnitude, int decimals) noexcept {
  const auto bits = std::bit_cast<std::uint64_t>(magnitude);
  const int exponent = static_cast<int>(bits >> 52);
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
  const std::uint64_t mantissa = exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
  const int shift =
      1075 - (exponent == 0 ? 1 : exponent);  // value = mantissa / 2^shift; at least 33 below 1e6
  if (shift > 120) return 0;
  const Wide product = Wide{mantissa} * kPowers[decimals];
  const Wide half = Wide{1} << (shift - 1);
  const Wide rest = product & ((Wide{1} << shift) - 1);
  const auto whole = static_cast<std::uint64_t>(product >> shift);
  return whole + (rest > half || (rest == half && whole % 2 == 1));
}

char* slow_fixed(char* out, double value, int decimals) noexcept {
  if (std::isnan(value)) return static_cast<char*>(std::memcpy(out, "nan", 3)) + 3;
  return std::to_chars(out, out + kFixedMax, value, std::chars_format::fixed, decimals).ptr;
}

}  // namespace

char* write_fixed(char* out, double value, int decimals) noexcept {
  const double magnitude = std::fabs(value);
  if (!(magnitude < kFast)) return slow_fixed(out, value, decimals);
  const std::uint64_t v = scaled(magnitude, decimals);
  if (value < 0 && v != 0) *out++ = '-';
  out = unsigned_integer(out, v / kPowers[decimals]);
  if (decimals == 0) return out;
  *out++ = '.';
  padded(out, v % kPowers[decimals], decimals);
  return out + decimals;
}

char* write_integer(char* out, std::int64_t value) noexcept {
  if (value >= 0) return unsigned_integer(out, static_cast<std::uint64_t>(value));
  *out++ = '-';
  return unsigned_integer(out, ~static_cast<std::uint64_t>(value) + 1);
}

char* write_seconds(char* out, std::int64_t ns, bool sub_microsecond) noexcept {
  if (ns < 0) {
    *out++ = '-';
    ns = -ns;
  }
  const auto v = static_cast<std::uint64_t>(ns);
  out = unsigned_integer(out, v / 1'000'000'000);
  *out++ = '.';
  const int digits = sub_microsecond ? 9 : 6;
  padded(out, v % 1'000'000'000 / (sub_microsecond ? 1 : 1000), digits);
  return out + digits;
}

}  // namespace servogate::report
