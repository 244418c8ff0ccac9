// SPDX-License-Identifier: Apache-2.0
// What a computer without CAN skips is said at the end of tests/run.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/places/places.hpp"
#include "tests/socketcan/vcan.hpp"

namespace servogate::socketcan {
namespace {

TEST(Skipped, tests_are_counted_by_their_reason_in_a_line_that_says_how_to_run_them) {
  const std::string build = ::testing::TempDir() + "skipped" + std::to_string(getpid());
  std::filesystem::create_directories(build + "/Testing/Temporary");
  std::ofstream(build + "/Testing/Temporary/LastTest.log")
      << "5/40 Testing: socketcan\n5/40 Test: socketcan\n[ RUN      ] A.b\nlink_test.cpp:12: Skipped\n"
         "no vcan here; run it so: lab\n\n[  SKIPPED ] A.b (0 ms)\nlink_test.cpp:12: Skipped\n"
         "no vcan here; run it so: lab\n6/40 Testing: report\nhtml_test.cpp:9: Skipped\nno node here\n";
  EXPECT_EQ(output_of(tests::source_dir() + "/tests/skipped " + build),
            "skipped: 2 tests of socketcan: no vcan here; run it so: lab\n"
            "skipped: 1 test of report: no node here\n");
  std::ofstream(build + "/Testing/Temporary/LastTest.log") << "5/40 Testing: socketcan\n[       OK ] A.b\n";
  EXPECT_EQ(output_of(tests::source_dir() + "/tests/skipped " + build), "");
  std::filesystem::remove_all(build);
}

}  // namespace
}  // namespace servogate::socketcan
