// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace servogate::test {

/// Where a property test begins to draw: SERVOGATE_PROPERTY_SEED of the environment, otherwise new at every
/// run. Prints it in the form in which it can be given again. Fits into 63 bits. `first`: a variable of the
/// environment that goes before it.
inline std::uint64_t property_seed(const char* first = "SERVOGATE_PROPERTY_SEED") {
  const char* given = std::getenv(first);
  if (given == nullptr) given = std::getenv("SERVOGATE_PROPERTY_SEED");
  const std::uint64_t seed =
      given != nullptr
          ? std::strtoull(given, nullptr, 10)
          : static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  std::printf("SERVOGATE_PROPERTY_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return seed;
}

}  // namespace servogate::test
