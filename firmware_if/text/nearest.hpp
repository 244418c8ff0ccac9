// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace servogate::text {

/// The candidate nearest in spelling to a word that a person wrote, empty when none is near: for "did you
/// mean
/// ...?". Not real-time safe.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace servogate::text
