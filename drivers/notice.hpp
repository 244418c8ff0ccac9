// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::drivers {

/// A sentence of a driver for people: why a facility of the computer could not be opened and what mends it, or
/// what happened to it. Not real-time safe.
struct Notice {
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;

  std::string str(text::Language language = text::user_language()) const {
    return entry != nullptr ? text::render(*entry, arguments, language) : std::string();
  }
};

}  // namespace servogate::drivers
