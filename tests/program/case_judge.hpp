// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tests/program/case_file.hpp"

namespace servogate::program::tests {

/// What a case gives otherwise than its file expects, one sentence each; empty: it passes.
std::vector<std::string> failures_of(const CaseFile& c);

}  // namespace servogate::program::tests
