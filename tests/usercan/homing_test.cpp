// SPDX-License-Identifier: Apache-2.0
// `servogate drive` with switches on its command line, homed by somebody else's master.
#include <cmath>

#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

constexpr int kTurn = 262'144, kMark = 30'000;

std::string counts(double revolutions) { return std::to_string(std::lround(revolutions * kTurn)); }

struct Rail {
  const char* name;
  const char* home;      ///< of --switch
  std::string from, to;  ///< the same in counts, "-": no end
};

class Homing : public ::testing::TestWithParam<Rail> {};

TEST_P(Homing, by_switches_and_index_ends_where_they_are) {
  if (shell("/usr/bin/python3 -c 'import can' 2>/dev/null") != 0)
    GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  const Rail& rail = GetParam();
  RunningServer server;
  const std::string port = std::to_string(server.address().port);
  Process drive({"drive", "socketcand:127.0.0.1:" + port + "/can0", "--node", "5", "--plant",
                 "zero-mark=" + std::to_string(kMark) + ",start=0.7,end-stop-min=-6,end-stop-max=6",
                 "--switch", std::string("negative_limit=..-2,positive_limit=2..,home=") + rail.home});
  ASSERT_TRUE(drive.says("node 5 on")) << drive.said();
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("homing_master.py") + " 5 " + std::to_string(kTurn) +
                  " " + std::to_string(kMark) + " " + counts(-2) + " " + counts(2) + " " + rail.from + " " +
                  rail.to + " socketcand can0 host=127.0.0.1 port=" + port),
            0)
      << "the drive " << drive.life();
}

INSTANTIATE_TEST_SUITE_P(Rails, Homing,
                         ::testing::Values(Rail{"bump", "-0.2..0.3", counts(-0.2), counts(0.3)},
                                           Rail{"positive_half", "0.3..", counts(0.3), "-"},
                                           Rail{"negative_half", "..-0.2", "-", counts(-0.2)}),
                         [](const auto& rail) { return std::string(rail.param.name); });

TEST(Switches, that_are_none_are_refused_with_what_is_expected) {
  for (const char* wrong :
       {"home", "home=1", "home=2..1", "home=..", "door=1..2", "home=a..2", "home=1..2e9"}) {
    Process drive({"drive", "socketcand:127.0.0.1:1/can0", "--node", "5", "--switch", wrong});
    EXPECT_EQ(drive.wait(), 2) << wrong;
    EXPECT_NE(drive.said().find("INPUT=FROM..TO"), std::string::npos) << drive.said();
    EXPECT_NE(drive.said().find("negative_limit"), std::string::npos) << drive.said();
  }
}

}  // namespace
}  // namespace servogate::usercan
