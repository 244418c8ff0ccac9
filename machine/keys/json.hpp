// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace servogate::machine {

/// Objects keep the order in which they were filled.
using Json = nlohmann::ordered_json;

/// A number as people write it: whole ones without a point; what is not finite becomes null.
Json json_number(double value);
/// The value as text; bytes that are no UTF-8 become U+FFFD. `indent` < 0: on one line.
std::string written(const Json& value, int indent = -1);

}  // namespace servogate::machine
