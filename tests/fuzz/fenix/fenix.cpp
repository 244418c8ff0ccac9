// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes as a program of the language Fenix.
// fuzz_fenix [-dict=tests/fuzz/fenix/NAME.dict] [CORPUS]
#include "tests/fuzz/program/one_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  servogate::program::fuzz::run_program("fenix", {}, data, size);
  return 0;
}
