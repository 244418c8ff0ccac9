// SPDX-License-Identifier: Apache-2.0
// Standard input as programs that serve something read it: beside their work, and never more than a part at
// once.
#include "gateway/command/simulated/input_lines.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string_view>

namespace servogate::gateway::command {
namespace {

/// A pipe in the place of standard input.
class InputFromAPipe : public ::testing::Test {
 protected:
  void SetUp() override {
    own_ = dup(STDIN_FILENO);
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    ASSERT_GE(dup2(ends[0], STDIN_FILENO), 0);
    close(ends[0]);
    write_ = ends[1];
  }
  void TearDown() override {
    close(write_);
    dup2(own_, STDIN_FILENO);
    close(own_);
  }
  void put(std::string_view text) const {
    ASSERT_EQ(write(write_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  int own_ = -1, write_ = -1;
};

TEST_F(InputFromAPipe, comes_line_by_line_and_waits_for_the_end_of_each) {
  InputLines input(true);
  EXPECT_EQ(input.next(), std::nullopt);
  put("silent for=1\n\nmoves");
  EXPECT_EQ(input.next(), "silent for=1");
  EXPECT_EQ(input.next(), "");
  EXPECT_EQ(input.next(), std::nullopt);
  put(" on\n");
  EXPECT_EQ(input.next(), "moves on");
}

TEST_F(InputFromAPipe, without_an_end_of_line_takes_no_memory_and_keeps_nobody_from_his_work) {
  InputLines input(true);
  const std::string part(16'384, 'x');
  for (int n = 0; n < 200; ++n) {
    put(part);
    EXPECT_EQ(input.next(), std::nullopt) << "it comes back although more may have come";
  }
  put("\nclear\n");
  const auto line = input.next();
  ASSERT_TRUE(line);
  EXPECT_EQ(line->size(), InputLines::kMostOfLine);
  EXPECT_EQ(input.next(), "clear");
}

}  // namespace
}  // namespace servogate::gateway::command
