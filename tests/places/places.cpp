// SPDX-License-Identifier: Apache-2.0
#include "tests/places/places.hpp"

namespace servogate::tests {

const std::string& source_dir() {
  static const std::string place = SERVOGATE_SOURCE_DIR;
  return place;
}

const std::string& binary_dir() {
  static const std::string place = SERVOGATE_BINARY_DIR;
  return place;
}

const std::string& program() {
  static const std::string place = binary_dir() + "/gateway/servogate";
  return place;
}

const std::string& cmake() {
  static const std::string place = CMAKE_PROGRAM;
  return place;
}

}  // namespace servogate::tests
