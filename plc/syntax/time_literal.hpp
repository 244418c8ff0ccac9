// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "plc/types/type.hpp"

namespace servogate::plc::syntax {

/// Which kind of time a literal prefix names ("T", "LTOD", ...); Kind::none: it is no such prefix.
Kind time_prefix(std::string_view key) noexcept;
/// How such a literal is written, for messages.
std::string_view time_example(Kind kind) noexcept;
/// Nanoseconds of what stands behind the `#`: "1d2h3m4s5ms", "2026-01-31", "12:30:00.5",
/// "2026-01-31-12:30:00". False when it is none or does not fit.
bool parse_time(Kind kind, std::string_view text, std::int64_t& nanoseconds);
/// The same as people write it, prefix included: "T#1s500ms", "D#2026-01-31". Returns the length written to
/// `out` (at most 48 bytes). real-time safe.
std::size_t print_time(Kind kind, std::int64_t nanoseconds, char* out) noexcept;

/// Days since 1970-01-01 of a date of the proleptic Gregorian calendar, and back. real-time safe.
std::int64_t days_of(std::int64_t year, unsigned month, unsigned day) noexcept;
void date_of(std::int64_t days, std::int64_t& year, unsigned& month, unsigned& day) noexcept;

inline constexpr std::int64_t kDay_ns = 86'400'000'000'000;

}  // namespace servogate::plc::syntax
