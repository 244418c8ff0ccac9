// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes as a program of the language NC-110.
// fuzz_program [-dict=tests/fuzz/program/NAME.dict] [CORPUS]
#include "tests/fuzz/program/one_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  servogate::program::fuzz::run_program("nc110", {"G94", "G97", "G90", "G71", "G27"}, data, size);
  return 0;
}
