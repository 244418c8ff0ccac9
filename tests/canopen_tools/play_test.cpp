// SPDX-License-Identifier: Apache-2.0
// `servogate play`: which frames of a log go onto the bus.
#include <algorithm>

#include "tests/canopen_tools/workbench.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::canopen_tools {
namespace {

class Play : public Workbench {
 protected:
  Play() {
    // Enable of node 1 by SDO with its answer, the set-point of node 2, what both send, an extended frame.
    desk_.write("run.log",
                "(1.00) can0 000#0101\n"
                "(1.00) can0 000#8000\n"
                "(1.01) can0 080#\n"
                "(1.01) can0 181#3712\n"
                "(1.02) can0 202#0F00\n"
                "(1.02) can0 601#4041600000000000\n"
                "(1.03) can0 581#4B41600037120000\n"
                "(1.03) can0 701#05\n"
                "(1.03) can0 702#05\n"
                "(1.04) can0 00012345#00\n");
  }
  /// The identifiers that came to the bus, in their order.
  std::vector<std::string> played(const std::string& options) {
    const auto listener = join();
    const Ended ended = tool("play $BUS run.log " + options);
    EXPECT_EQ(ended.code, 0) << ended.err;
    said_ = ended;
    // Behind all that was played, and behind every answer to it.
    constexpr std::uint32_t kMark = 0x7FF;
    const auto last = join();
    EXPECT_TRUE(last->send(usercan::make(kMark, {})));
    std::vector<std::string> ids;
    for (image::CanFrame frame; usercan::wait_for(*listener, frame) && frame.id != kMark;) {
      char id[16];
      std::snprintf(id, sizeof id, frame.extended ? "%08X" : "%03X", frame.id);
      ids.emplace_back(id);
    }
    return ids;
  }
  using Ids = std::vector<std::string>;
  Ended said_;
};

TEST_F(Play, sends_a_whole_log_and_says_how_many_frames_these_were) {
  EXPECT_EQ(played("").size(), 10u);
  EXPECT_EQ(said_.out, "10 of 10 frames were played\n");
}

TEST_F(Play, names_the_error_frames_that_it_cannot_send) {
  desk_.write(
      "errors.log",
      "(1.00) can0 181#3712\n(1.01) can0 20000004#0008000000000000\n(1.02) can0 20000088#0000000000000000\n");
  const Ended ended = tool("play $BUS errors.log");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, "1 of 1 frames were played\n");
  EXPECT_NE(ended.err.find("error frames of the log were not played"), std::string::npos) << ended.err;
  EXPECT_EQ(facts("play $BUS errors.log")["error_frames"], 2);
}

TEST_F(Play, of_what_the_master_sent_leaves_the_drives_own_answers_out_and_names_them) {
  EXPECT_EQ(played("--from master"), (Ids{"000", "000", "080", "202", "601"}));
  EXPECT_EQ(said_.out,
            "5 of 10 frames were played; left out: 181 (1), 581 (1), 701 (1), 702 (1), 00012345 (1)\n");
  EXPECT_EQ(played("--from devices"), (Ids{"181", "581", "701", "702", "00012345"}));
}

TEST_F(Play, of_one_node_does_not_reach_others) {
  EXPECT_EQ(played("--node 1"), (Ids{"000", "080", "181", "601", "581", "701"}));
  EXPECT_TRUE(said_.out_has("left out: 000 (1), 202 (1), 702 (1), 00012345 (1)")) << said_.out;
  EXPECT_EQ(played("--node 2 --from master"), (Ids{"080", "202"}));
}

TEST_F(Play, of_identifiers_takes_numbers_and_ranges) {
  EXPECT_EQ(played("--id 181,600-67F"), (Ids{"181", "601"}));
  EXPECT_EQ(played("--id 12345"), (Ids{"00012345"}));
  for (const char* wrong : {"18G", "300-200", "20000000", "-5", "180-"}) {
    const Ended ended = tool(std::string("play $BUS run.log --id=") + wrong);
    EXPECT_EQ(ended.code, 2) << wrong;
    EXPECT_TRUE(ended.err_has(std::string("--id ") + wrong)) << ended.err;
    EXPECT_TRUE(ended.err_has("hexadecimal")) << ended.err;
  }
}

TEST_F(Play, beside_a_live_drive_warns_of_identifiers_that_both_send) {
  drives("1");
  desk_.write("run.log",
              "(1.00) can0 601#4000100000000000\n"
              "(1.00) can0 581#4300100092010200\n"
              "(3.00) can0 080#\n");
  const Ids ids = played("");
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "581"), 2) << "the drive answers as well";
  EXPECT_TRUE(said_.err_has("581 (1) came from the bus as well")) << said_.err;
  EXPECT_TRUE(said_.err_has("--from master")) << said_.err;
  played("--from master");
  EXPECT_EQ(said_.err, "");
}

}  // namespace
}  // namespace servogate::canopen_tools
