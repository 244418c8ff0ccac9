// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::text {

/// What an errno means, as an argument of a sentence in both languages (text::both); the system's own English
/// where the table has none. Not real-time safe.
std::string words_of(int error);

}  // namespace servogate::text
