// SPDX-License-Identifier: Apache-2.0
// `servogate drive` with what masters in Python, written after the standard, ask of its stops and its PDOs.
#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

bool no_python_can() { return shell("/usr/bin/python3 -c 'import can' 2>/dev/null") != 0; }

std::string socketcand(const RunningServer& server) {
  return " socketcand can0 host=127.0.0.1 port=" + std::to_string(server.address().port);
}
std::string url(const RunningServer& server) {
  return "socketcand:127.0.0.1:" + std::to_string(server.address().port) + "/can0";
}

TEST(OptionCodes, each_value_brakes_on_its_ramp_and_ends_in_its_state) {
  if (no_python_can()) GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  RunningServer server;
  Process drive({"drive", url(server), "--node", "5", "--plant",
                 "inertia=0.01,friction=0.002,viscous=0,torque=2.4,peak-torque=7.2"});
  ASSERT_TRUE(drive.says("node 5 on")) << drive.said();
  EXPECT_EQ(
      shell("/usr/bin/python3 " + counterpart("option_codes_master.py") + " 5 262144" + socketcand(server)),
      0)
      << "the drive " << drive.life();
}

struct Pdos {
  const char* name;
  std::vector<std::string> options;
};
class ForeignPdos : public ::testing::TestWithParam<Pdos> {};

TEST_P(ForeignPdos, are_what_a_master_in_python_expects) {
  if (no_python_can()) GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  RunningServer server;
  std::vector<std::string> arguments = {"drive", url(server), "--node", "5"};
  arguments.insert(arguments.end(), GetParam().options.begin(), GetParam().options.end());
  Process drive(arguments);
  ASSERT_TRUE(drive.says("node 5 on")) << drive.said();
  EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("pdo_master.py") + " " + GetParam().name + " 5" +
                  socketcand(server)),
            0)
      << "the drive " << drive.life();
}

INSTANTIATE_TEST_SUITE_P(Drives, ForeignPdos,
                         ::testing::Values(Pdos{"fixed", {"--pdo-map", "fixed"}},
                                           Pdos{"whole", {"--pdo-map", "whole"}},
                                           Pdos{"moved", {"--fault", "pdo_dropped every=3 number=1"}}),
                         [](const auto& pdos) { return std::string(pdos.param.name); });

TEST(PdoMaps, of_another_access_than_there_is_are_refused) {
  Process drive({"drive", "socketcand:127.0.0.1:1/can0", "--node", "5", "--pdo-map", "half"});
  EXPECT_EQ(drive.wait(), 2);
  EXPECT_NE(drive.said().find("--pdo-map"), std::string::npos) << drive.said();
}

}  // namespace
}  // namespace servogate::usercan
