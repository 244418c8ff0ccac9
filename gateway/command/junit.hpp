// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace servogate::gateway::command {

/// One test as hosts of continuous integration read it.
struct JUnitCase {
  enum class Result : std::uint8_t { passed, failed, error, skipped };
  std::string classname, name, file;
  int line = 0;
  double time_s = 0.0;  ///< of the wall clock
  Result result = Result::passed;
  std::string message, type, body;
  std::vector<std::pair<std::string, std::string>> properties;
  std::vector<std::string> attachments;  ///< files
};

/// JUnit XML: a suite for each file, in the order of their names. Characters that XML cannot hold are written
/// as \x1B.
std::string junit(const std::string& name, const std::vector<JUnitCase>& cases);

}  // namespace servogate::gateway::command
