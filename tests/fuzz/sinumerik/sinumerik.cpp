// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes as a program of the language SINUMERIK 808D, in its own mode and in its ISO dialect.
// fuzz_sinumerik [-dict=tests/fuzz/sinumerik/NAME.dict] [CORPUS]
#include "tests/fuzz/program/one_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  servogate::program::fuzz::run_program("sinumerik-808d", {}, data, size);
  servogate::program::fuzz::run_program("sinumerik-808d", {"G291"}, data, size);
  return 0;
}
