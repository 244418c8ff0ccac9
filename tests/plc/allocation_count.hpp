// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::plc {
/// Number of allocations through operator new in this program so far.
std::uint64_t allocations() noexcept;
}  // namespace servogate::plc
