// SPDX-License-Identifier: Apache-2.0
// python-can at the other end of the wire: a master that nobody here wrote.
#include "drivers/slcan/slcan_bus.hpp"
#include "tests/slcan/relay.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::slcan {
namespace {

TEST(PythonCan, as_a_master_brings_a_drive_behind_an_adapter_through_every_state_and_mode) {
  if (usercan::shell("/usr/bin/python3 -c 'import can, serial' 2>/dev/null") != 0)
    GTEST_SKIP() << "no python-can here; install it so: .ci/packages --tests";
  SimulatedAdapter adapter;
  drivers::Notice why;
  auto bus = SlcanBus::open({{adapter.path()}, 1'000'000, false, 60 * image::kSecond}, why);
  ASSERT_NE(bus, nullptr) << why.str();
  const Relay relay(adapter);
  const usercan::LivingDrive drive(std::move(bus), 5);
  EXPECT_EQ(usercan::shell("/usr/bin/python3 " + usercan::counterpart("drive_master.py") + " 5 slcan " +
                           relay.path() + " sleep_after_open=0"),
            0);
}

}  // namespace
}  // namespace servogate::slcan
