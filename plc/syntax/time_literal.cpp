// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/time_literal.hpp"

#include <cctype>
#include <cstdio>
#include <limits>

namespace servogate::plc::syntax {

namespace {

__extension__ typedef __int128 Wide;

struct Unit {
  std::string_view name;
  std::int64_t ns;
};
// Longest name first where one begins another.
constexpr Unit kUnits[] = {{"d", kDay_ns},
                           {"h", 3'600'000'000'000},
                           {"ms", 1'000'000},
                           {"m", 60'000'000'000},
                           {"s", 1'000'000'000},
                           {"us", 1'000},
                           {"ns", 1}};

// Reads digits with an optional fraction; underscores between digits are allowed.
bool read_decimal(std::string_view& text, std::int64_t scale, std::int64_t& value, bool& fraction) {
  Wide whole = 0;
  bool any = false;
  const auto digit = [&] { return !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])); };
  while (digit() || (any && text.size() > 1 && text[0] == '_')) {
    if (text[0] != '_') whole = whole * 10 + (text[0] - '0');
    if (whole > std::numeric_limits<std::int64_t>::max()) return false;
    any = true;
    text.remove_prefix(1);
  }
  if (!any) return false;
  Wide part = 0, unit = 1;
  fraction = !text.empty() && text[0] == '.';
  if (fraction) {
    text.remove_prefix(1);
    if (!digit()) return false;
    for (; digit() || (text.size() > 1 && text[0] == '_'); text.remove_prefix(1))
      if (text[0] != '_' && unit < 1'000'000'000'000'000) part = part * 10 + (text[0] - '0'), unit *= 10;
  }
  const Wide total = whole * scale + (part * scale + unit / 2) / unit;
  if (total > std::numeric_limits<std::int64_t>::max()) return false;
  value = static_cast<std::int64_t>(total);
  return true;
}

std::string_view unit_at(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && std::isalpha(static_cast<unsigned char>(text[n]))) ++n;
  return text.substr(0, n);
}

bool parse_duration(std::string_view text, std::int64_t& ns) {
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  Wide total = 0;
  std::int64_t previous = std::numeric_limits<std::int64_t>::max();
  if (text.empty()) return false;
  bool ended = false;
  while (!text.empty()) {
    if (ended) return false;  // a fraction only in the last part
    if (text[0] == '_' && previous != std::numeric_limits<std::int64_t>::max()) text.remove_prefix(1);
    std::string_view number = text;
    std::int64_t probe = 0;
    if (!read_decimal(number, 1, probe, ended)) return false;
    const std::string_view unit = unit_at(number);
    const Unit* found = nullptr;
    for (const Unit& u : kUnits)
      if (same_name(u.name, unit)) found = &u;
    if (found == nullptr || found->ns >= previous) return false;
    std::int64_t part = 0;
    if (!read_decimal(text, found->ns, part, ended)) return false;
    text.remove_prefix(unit.size());
    previous = found->ns;
    total += part;
  }
  if (total > std::numeric_limits<std::int64_t>::max()) return false;
  ns = static_cast<std::int64_t>(negative ? -total : total);
  return true;
}

bool read_field(std::string_view& text, int digits, int low, int high, std::int64_t& value) {
  value = 0;
  int n = 0;
  for (; n < digits && !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])); ++n) {
    value = value * 10 + (text[0] - '0');
    text.remove_prefix(1);
  }
  return n > 0 && value >= low && value <= high;
}
bool skip(std::string_view& text, char c) {
  if (text.empty() || text[0] != c) return false;
  text.remove_prefix(1);
  return true;
}

bool parse_date(std::string_view& text, std::int64_t& ns) {
  std::int64_t year = 0, month = 0, day = 0;
  if (!read_field(text, 4, 1678, 2261, year) || !skip(text, '-') || !read_field(text, 2, 1, 12, month) ||
      !skip(text, '-') || !read_field(text, 2, 1, 31, day))
    return false;
  const std::int64_t days = days_of(year, static_cast<unsigned>(month), static_cast<unsigned>(day));
  std::int64_t y = 0;
  unsigned m = 0, d = 0;
  date_of(days, y, m, d);
  if (m != month || d != day) return false;  // 31 April
  ns = days * kDay_ns;
  return true;
}

bool parse_clock(std::string_view& text, std::int64_t& ns) {
  std::int64_t hour = 0, minute = 0, seconds = 0;
  bool fraction = false;
  if (!read_field(text, 2, 0, 23, hour) || !skip(text, ':') || !read_field(text, 2, 0, 59, minute))
    return false;
  if (skip(text, ':') && (!read_decimal(text, 1'000'000'000, seconds, fraction) || seconds >= 60'000'000'000))
    return false;
  ns = (hour * 3600 + minute * 60) * 1'000'000'000 + seconds;
  return true;
}

}  // namespace

std::int64_t days_of(std::int64_t y, unsigned m, unsigned d) noexcept {
  y -= m <= 2;
  const std::int64_t era = (y >= 0 ? y : y - 399) / 400;
  const auto yoe = static_cast<unsigned>(y - era * 400);
  const unsigned doy = (153 * (m > 2 ? m - 3 : m + 9) + 2) / 5 + d - 1;
  const unsigned doe = yoe * 365 + yoe / 4 - yoe / 100 + doy;
  return era * 146097 + static_cast<std::int64_t>(doe) - 719468;
}

void date_of(std::int64_t days, std::int64_t& year, unsigned& month, unsigned& day) noexcept {
  days += 719468;
  const std::int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const auto doe = static_cast<unsigned>(days - era * 146097);
  const unsigned yoe = (doe - doe / 1460 + doe / 36524 - doe / 146096) / 365;
  const unsigned doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
  const unsigned mp = (5 * doy + 2) / 153;
  day = doy - (153 * mp + 2) / 5 + 1;
  month = mp < 10 ? mp + 3 : mp - 9;
  year = static_cast<std::int64_t>(yoe) + era * 400 + (month <= 2);
}

Kind time_prefix(std::string_view key) noexcept {
  struct Prefix {
    std::string_view name;
    Kind kind;
  };
  constexpr Prefix prefixes[] = {
      {"T", Kind::time},  {"TIME", Kind::time}, {"LT", Kind::time},          {"LTIME", Kind::time},
      {"D", Kind::date},  {"DATE", Kind::date}, {"LD", Kind::date},          {"LDATE", Kind::date},
      {"TOD", Kind::tod}, {"LTOD", Kind::tod},  {"TIME_OF_DAY", Kind::tod},  {"LTIME_OF_DAY", Kind::tod},
      {"DT", Kind::dt},   {"LDT", Kind::dt},    {"DATE_AND_TIME", Kind::dt}, {"LDATE_AND_TIME", Kind::dt}};
  for (const Prefix& p : prefixes)
    if (p.name == key) return p.kind;
  return Kind::none;
}

std::string_view time_example(Kind kind) noexcept {
  return kind == Kind::time   ? "T#1m2s500ms"
         : kind == Kind::date ? "D#2026-01-31"
         : kind == Kind::tod  ? "TOD#12:30:00"
                              : "DT#2026-01-31-12:30:00";
}

bool parse_time(Kind kind, std::string_view text, std::int64_t& ns) {
  if (kind == Kind::time) return parse_duration(text, ns);
  std::int64_t date = 0, clock = 0;
  if (kind != Kind::tod && !parse_date(text, date)) return false;
  if (kind == Kind::dt && !skip(text, '-')) return false;
  if (kind != Kind::date && !parse_clock(text, clock)) return false;
  ns = date + clock;
  return text.empty();
}

namespace {

std::size_t print_duration(std::int64_t ns, char* out) noexcept {
  std::size_t n = static_cast<std::size_t>(std::snprintf(out, 8, "T#%s", ns < 0 ? "-" : ""));
  std::uint64_t rest = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  constexpr Unit shown[] = {{"d", kDay_ns},
                            {"h", 3'600'000'000'000},
                            {"m", 60'000'000'000},
                            {"s", 1'000'000'000},
                            {"ms", 1'000'000},
                            {"us", 1'000},
                            {"ns", 1}};
  if (rest == 0) return n + static_cast<std::size_t>(std::snprintf(out + n, 8, "0ms"));
  for (const Unit& u : shown) {
    const std::uint64_t count = rest / static_cast<std::uint64_t>(u.ns);
    rest %= static_cast<std::uint64_t>(u.ns);
    if (count != 0)
      n += static_cast<std::size_t>(
          std::snprintf(out + n, 24, "%llu%s", static_cast<unsigned long long>(count), u.name.data()));
  }
  return n;
}

std::size_t print_clock(std::int64_t ns, char* out) noexcept {
  const std::int64_t s = ns / 1'000'000'000, part = ns % 1'000'000'000;
  std::size_t n =
      static_cast<std::size_t>(std::snprintf(out, 16, "%02d:%02d:%02d", static_cast<int>(s / 3600 % 24),
                                             static_cast<int>(s / 60 % 60), static_cast<int>(s % 60)));
  if (part != 0) {
    n += static_cast<std::size_t>(std::snprintf(out + n, 16, ".%09d", static_cast<int>(part)));
    while (out[n - 1] == '0') --n;
  }
  return n;
}

}  // namespace

std::size_t print_time(Kind kind, std::int64_t ns, char* out) noexcept {
  if (kind == Kind::time) return print_duration(ns, out);
  std::int64_t days = ns / kDay_ns, clock = ns % kDay_ns;
  if (clock < 0) clock += kDay_ns, --days;
  std::size_t n = static_cast<std::size_t>(std::snprintf(out, 8, "%s#",
                                                         kind == Kind::date  ? "D"
                                                         : kind == Kind::tod ? "TOD"
                                                                             : "DT"));
  if (kind != Kind::tod) {
    std::int64_t year = 0;
    unsigned month = 0, day = 0;
    date_of(days, year, month, day);
    n += static_cast<std::size_t>(
        std::snprintf(out + n, 24, "%04d-%02u-%02u", static_cast<int>(year), month % 100, day % 100));
  }
  if (kind == Kind::dt) out[n++] = '-';
  return kind == Kind::date ? n : n + print_clock(clock, out + n);
}

}  // namespace servogate::plc::syntax
