// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/decimal_comma.hpp"

namespace servogate::text {

std::string with_decimal_point(std::string words) {
  const auto digit = [&](std::size_t i) { return i < words.size() && words[i] >= '0' && words[i] <= '9'; };
  const std::size_t comma = words.find(',');
  if (comma == std::string::npos || comma == 0 || !digit(comma - 1) || !digit(comma + 1)) return {};
  words[comma] = '.';
  return words;
}

}  // namespace servogate::text
