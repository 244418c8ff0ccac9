// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::report {

/// Calls of operator new by this thread so far; the whole test program is counted.
std::uint64_t allocations() noexcept;

}  // namespace servogate::report
