// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/two_paths/two_paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "tests/plc/two_paths/random_program.hpp"

namespace servogate::plc {
namespace {

TEST(TwoPaths, machine_and_tree_walk_agree_on_random_programs) {
  const char* given = std::getenv("SERVOGATE_SEED");
  const std::uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 10) : 20'260'101;
  const char* cases = std::getenv("SERVOGATE_PROPERTY_CASES");
  const int count = cases != nullptr ? std::max(1, std::atoi(cases) / 5) : 400;
  std::printf("seeds %llu to %llu\n", static_cast<unsigned long long>(first),
              static_cast<unsigned long long>(first + count - 1));
  std::map<Fault, int> outcomes;
  for (int i = 0; i < count; ++i) {
    const std::string source = random_program(first + static_cast<std::uint64_t>(i));
    const Comparison both = run_both_ways(source);
    ASSERT_EQ(both.difference, "") << "seed " << first + static_cast<std::uint64_t>(i) << "\n" << source;
    ++outcomes[both.outcome];
  }
  EXPECT_GT(outcomes[Fault::none], count / 3) << "most programs must run through";
  EXPECT_GT(
      outcomes[Fault::division_by_zero] + outcomes[Fault::index_out_of_range] + outcomes[Fault::conversion],
      10);
}

TEST(TwoPaths, a_program_chosen_by_bytes_is_valid_whatever_they_are) {
  std::vector<std::uint8_t> bytes;
  for (int n = 0; n < 12; ++n) {
    for (const int value : {0, 1, 255}) {
      const std::vector<std::uint8_t> same(bytes.size(), static_cast<std::uint8_t>(value));
      const std::string source = random_program(same);
      EXPECT_EQ(run_both_ways(source).difference, "") << value << " x " << same.size() << "\n" << source;
    }
    bytes.resize(bytes.size() * 2 + 1);
  }
}

}  // namespace
}  // namespace servogate::plc
