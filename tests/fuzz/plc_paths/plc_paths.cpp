// SPDX-License-Identifier: Apache-2.0
// A valid PLC program, chosen by the bytes, run by the machine and by the evaluator of tests/plc: after each
// scan every variable must have the same value in both, and a fault must be the same fault.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "tests/plc/two_paths/random_program.hpp"
#include "tests/plc/two_paths/two_paths.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace servogate;
  const std::string source = plc::random_program(std::span(data, size));
  const plc::Comparison both = plc::run_both_ways(source);
  if (both.difference.empty()) return 0;
  std::fprintf(stderr, "%s\n%s\n", source.c_str(), both.difference.c_str());
  std::abort();
}
