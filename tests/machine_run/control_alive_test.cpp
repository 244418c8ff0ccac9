// SPDX-License-Identifier: Apache-2.0
// `safety.control_alive` in the composed mill.
#include <gtest/gtest.h>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

TEST(ControlAlive,
     the_alive_output_toggles_without_the_logic_and_rests_after_a_cycle_that_came_far_too_late) {
  Mill mill;
  const image::Place alive = place_of(mill.control(), "control_alive_relay");
  int changes = 0;
  bool was = false;
  mill.after_cycle = [&] {
    const bool is = mill.image().packets.bit(alive);
    changes += is != was;
    was = is;
  };
  mill.run(1.0);
  EXPECT_NEAR(changes, 20, 1);
  mill.control().cycle().note_overrun(20 * image::kMillisecond);
  mill.run(0.1);
  changes = 0;
  mill.run(1.0);
  EXPECT_EQ(changes, 0);
  EXPECT_FALSE(was);
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  mill.run(1.0);
  EXPECT_GE(changes, 19);
}

TEST(ControlAlive, a_logic_that_writes_the_alive_output_is_an_error) {
  const machine::LoadResult loaded = changed_mill([](std::string& text) {
    replace(text, "control_alive = \"control_alive_relay\"", "control_alive = \"coolant\"");
  });
  ASSERT_TRUE(loaded.ok());
  std::vector<text::Finding> findings;
  EXPECT_EQ(gateway::Control::compose(loaded, findings), nullptr);
  ASSERT_FALSE(findings.empty());
  EXPECT_NE(findings.front().str(text::Language::english).find("coolant"), std::string::npos)
      << findings.front().str(text::Language::english);
}

}  // namespace
}  // namespace servogate::machine_run
