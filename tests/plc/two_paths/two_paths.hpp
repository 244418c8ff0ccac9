// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "plc/engine/engine.hpp"

namespace servogate::plc {

/// How a program went that was run in two ways, by the machine and by the evaluator of the tree.
struct Comparison {
  std::string difference;  ///< empty: none
  Fault outcome = Fault::none;
};

/// Compiles a program that must be valid and compares every variable after each of a few scans.
Comparison run_both_ways(const std::string& source);

}  // namespace servogate::plc
