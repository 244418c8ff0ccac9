// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::text {

/// A sentence in both languages (both()), for who shows it in either. Not real-time safe.
std::string in_both(const Entry& entry, const std::vector<std::string>& arguments);

}  // namespace servogate::text
