// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

/// Whether a computer is good enough for a cycle, and what makes it better. Not real-time safe.
namespace servogate::gateway::command {

/// How a worst lateness stands to a cycle.
enum class Fit : std::uint8_t {
  good,      ///< at most a fifth of the cycle
  doubtful,  ///< at most half of it
  no,
};
Fit fit_of(std::int64_t worst_ns, std::int64_t cycle_ns) noexcept;
/// "good", "doubtful", "no".
const char* fit_name(Fit fit) noexcept;

/// Something of a computer that costs time, with what to do about it; both in both languages (text::both).
struct Advice {
  std::string what, remedy;
};
/// Looks at kernel, frequency scaling, isolated processors and so on below `root` ("" on a real computer).
std::vector<Advice> advice_for(const std::string& root);

}  // namespace servogate::gateway::command
