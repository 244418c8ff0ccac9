// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// A sentence that a machine has for its people while it runs: who runs it says where it goes (standard
/// error, a page, a test). Called from any thread outside the cycle; empty: nobody listens.
using Announce = std::function<void(const text::Entry& entry, const std::vector<std::string>& arguments)>;

}  // namespace servogate::gateway
