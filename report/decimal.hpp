// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::report {

/// Bytes that one number needs at most in write_fixed(), whatever the double.
inline constexpr int kFixedMax = 340;

/// Writes `value` with exactly `decimals` (0-12) digits after the point and returns the end of the text; no
/// terminating zero. The exact binary value is rounded half to even, as printf("%.*f") does, so the bytes do
/// not depend on processor or library; a zero never carries a sign. Not a number is `nan`, infinities are
/// `inf`, `-inf`. `out` needs kFixedMax bytes. real-time safe for |value| < 1e6 (integer arithmetic only).
char* write_fixed(char* out, double value, int decimals) noexcept;

/// Writes an integer in decimal and returns the end. `out` needs 20 bytes. real-time safe.
char* write_integer(char* out, std::int64_t value) noexcept;

/// Writes nanoseconds as seconds, with 6 decimals, or 9 when `sub_microsecond`; the value is cut, not
/// rounded. `out` needs 24 bytes. real-time safe.
char* write_seconds(char* out, std::int64_t ns, bool sub_microsecond) noexcept;

}  // namespace servogate::report
