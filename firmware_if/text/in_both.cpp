// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/in_both.hpp"

namespace servogate::text {

std::string in_both(const Entry& entry, const std::vector<std::string>& arguments) {
  return both(render(entry, arguments, Language::english), render(entry, arguments, Language::russian));
}

}  // namespace servogate::text
