// SPDX-License-Identifier: Apache-2.0
// A program of a million blocks is checked in the memory that a small one takes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/places/places.hpp"

namespace servogate::machine_run {
namespace {

constexpr int kBlocks = 1'000'000;

/// Bytes that the program may allocate: much less than the text.
constexpr int kKilobytes = 32 * 1024;

std::string program(const Scratch& scratch, const std::string& comment, const std::string& line_end) {
  const std::string path = scratch.path("large.nc");
  std::ofstream out(path, std::ios::binary);
  out << "G27 G1 X0 Y0 F1000" << line_end;
  for (int n = 1; n < kBlocks - 1; ++n) {
    if (n % 4 == 0) out << comment << line_end;
    out << "X" << n % 100 << " Y" << n % 7 << line_end;
  }
  out << "M30" << line_end;
  return path;
}

/// Exit code of `check` with so much memory for its data; mapped files do not count.
int check(const Scratch& scratch, const std::string& path) {
  const std::string command = "ulimit -d " + std::to_string(kKilobytes) + "; exec '" + tests::program() +
                              "' check '" + mill_file() + "' '" + path + "' >'" + scratch.path("out") +
                              "' 2>&1";
  return std::system(command.c_str());
}

class LargeProgram : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Texts, LargeProgram,
                         ::testing::Values(std::pair("; the next part of the contour", "\n"),
                                           std::pair("; следующая часть контура", "\r\n"),
                                           std::pair("; следующая часть контура", "\r")));

TEST_P(LargeProgram, of_a_million_blocks_is_checked_in_the_memory_of_a_small_one) {
  const Scratch scratch;
  const auto [comment, line_end] = GetParam();
  const std::string path = program(scratch, comment, line_end);
  EXPECT_EQ(check(scratch, path), 0) << read_all(scratch.path("out"));
}

}  // namespace
}  // namespace servogate::machine_run
