// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::text {

/// "10,5 mm" as "10.5 mm"; empty: there is no comma between two digits. Not real-time safe.
std::string with_decimal_point(std::string words);

}  // namespace servogate::text
