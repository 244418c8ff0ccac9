// SPDX-License-Identifier: Apache-2.0
// Points that come over a drive (60FDh, 60FEh:01) and points that are debounced, in the example mill.
#include <gtest/gtest.h>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

/// The TPDO of servo-cia402-io with 60FDh.
constexpr std::uint32_t kInputsMessage = 2;

/// The mill whose switches of X and emergency-stop chain are wired to the drive of X.
machine::LoadResult wired_to_the_drive() {
  return changed_mill([](std::string& text) {
    replace(text, "device = \"servo-cia402\"", "device = \"servo-cia402-io\"");
    for (const char* line : {"  { name = \"x_limit_plus\", channel = \"di0\", place = \"SA0\", comment = \"1 "
                             "= on the switch\" },\n",
                             "  { name = \"x_limit_minus\", channel = \"di1\", place = \"SA1\" },\n",
                             "  { name = \"x_home\", channel = \"di6\", place = \"SA6\" },\n",
                             "  { name = \"estop_chain_ok\", channel = \"di9\", place = \"SA17\", comment = "
                             "\"1 = the chain is closed\" "
                             "},\n",
                             "  { name = \"control_alive_relay\", channel = \"dq10\", place = \"SA70\", "
                             "comment = \"toggles for the "
                             "safety relay\" },\n"})
      replace(text, line, "");
    replace(text, "[[station]]  # everything",
            "[[station]]\nname = \"x_terminals\"\nkind = \"drive\"\nnode = \"can.x\"\npoints = [\n"
            "  { name = \"x_limit_minus\", channel = \"di0\", place = \"SA1\" },\n"
            "  { name = \"x_limit_plus\", channel = \"di1\", place = \"SA0\" },\n"
            "  { name = \"x_home\", channel = \"di2\", place = \"SA6\" },\n"
            "  { name = \"estop_chain_ok\", channel = \"di16\", place = \"SA17\" },\n"
            "  { name = \"chuck_open\", channel = \"di17\", place = \"SA9\", inverted = true },\n"
            "  { name = \"control_alive_relay\", channel = \"dq18\", place = \"SA70\" },\n]\n\n[[station]]  "
            "# everything");
  });
}

TEST(DrivePoints, carry_home_and_limit_switches_and_the_emergency_stop_chain) {
  Mill mill(wired_to_the_drive(), "N10 G1 X20 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_TRUE(mill.axis("X").homed);
  EXPECT_NEAR(mill.true_position(0), 0.0, 0.01) << "homed on the switch at the drive and the index";
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  mill.run(0.2);
  ASSERT_GT(mill.process().feed_mm_s, 1.0) << mill.alarm_list();
  mill.control().world().set_input("estop_chain_ok", false);
  EXPECT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kEmergencyStop) > 0; }, 0.02))
      << mill.alarm_list();
}

TEST(DrivePoints, outputs_follow_their_places_under_the_mask_and_inputs_their_wires) {
  Mill mill(wired_to_the_drive(), "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const image::Place open = place_of(mill.control(), "chuck_open");
  EXPECT_TRUE(mill.image().packets.bit(open)) << "inverted";
  mill.control().world().set_input("chuck_open", false);
  mill.run(0.01);
  EXPECT_FALSE(mill.image().packets.bit(open));
  const mock::SimulatedDrive& drive = *mill.control().world().drive("can.x");
  bool low = false, high = false;
  mill.after_cycle = [&] {
    (drive.digital_outputs() == 0 ? low : high) = true;
    if (drive.digital_outputs() != 0) {
      EXPECT_EQ(drive.digital_outputs(), std::uint32_t{1} << 18);
    }
  };
  EXPECT_TRUE(mill.until([&] { return low && high; }, 3.0)) << "the relay of the control's life toggles";
}

TEST(DrivePoints, whose_message_alone_is_lost_read_what_is_declared_and_the_message_is_named) {
  Mill mill(wired_to_the_drive(), "N10 G1 X20 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  mill.run(0.2);
  const image::Place chain = place_of(mill.control(), "estop_chain_ok");
  ASSERT_TRUE(mill.image().packets.bit(chain));
  mill.control().world().drive("can.x")->inject({.kind = fault::Kind::pdo_dropped, .number = kInputsMessage});
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kPdoMissing) > 0; }, 0.2))
      << mill.alarm_list();
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
    if (r.number == axis::alarm::kPdoMissing) {
      EXPECT_EQ(r.detail1, kInputsMessage) << "the message that is missing";
    }
  EXPECT_FALSE(mill.image().packets.bit(chain));
}

TEST(DrivePoints, read_what_is_declared_for_a_loss_when_the_drive_is_silent) {
  Mill mill(wired_to_the_drive(), "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const image::Place chain = place_of(mill.control(), "estop_chain_ok");
  EXPECT_TRUE(mill.image().packets.bit(chain));
  mill.inject("can.x", fault::Kind::silent);
  EXPECT_TRUE(mill.until([&] { return !mill.axis("X").drive.online; }, 3.0));
  mill.run(0.002);
  EXPECT_FALSE(mill.image().packets.bit(chain)) << "a chain that nobody reports is open";
}

TEST(Debounce, lets_through_what_has_lasted_from_a_chip_and_from_a_polled_station) {
  Mill mill(changed_mill([](std::string& text) {
              replace(text, "name = \"y_home\", channel = \"di7\",",
                      "name = \"y_home\", channel = \"di7\", debounce = \"5 ms\",");
              replace(text, "name = \"air_ok\", channel = \"di2\",",
                      "name = \"air_ok\", channel = \"di2\", debounce = \"50 ms\",");
            }),
            "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  auto& world = mill.control().world();
  const image::Place home = place_of(mill.control(), "y_home");
  const auto play = [&](const char* point, double value) {
    EXPECT_EQ(world.play_input(point, {value}), mock::World::Played::done);
  };
  play("y_home", 0.0);
  mill.run(0.02);
  ASSERT_FALSE(mill.image().packets.bit(home));
  play("y_home", 1.0);
  mill.run(0.004);
  EXPECT_FALSE(mill.image().packets.bit(home)) << "4 ms is not 5 ms";
  play("y_home", 0.0);
  mill.run(0.001);
  play("y_home", 1.0);
  mill.run(0.004);
  EXPECT_FALSE(mill.image().packets.bit(home)) << "each change begins anew";
  mill.run(0.004);
  EXPECT_TRUE(mill.image().packets.bit(home));

  const image::Place air = place_of(mill.control(), "air_ok");
  const bool before = mill.image().packets.bit(air);
  play("air_ok", before ? 0.0 : 1.0);
  mill.run(0.045);
  EXPECT_EQ(mill.image().packets.bit(air), before) << "polled, but not long enough";
  play("air_ok", before ? 1.0 : 0.0);
  mill.run(0.1);
  EXPECT_EQ(mill.image().packets.bit(air), before);
  play("air_ok", before ? 0.0 : 1.0);
  mill.run(0.1);
  EXPECT_NE(mill.image().packets.bit(air), before);
}

TEST(LoopedInput, that_is_played_stays_so_whatever_its_output_does_until_it_is_let_go) {
  Mill mill("N10 T2.2 M6\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mock::World& world = mill.control().world();
  const image::Place clamped = place_of(mill.control(), "tool_clamped");
  ASSERT_TRUE(mill.image().packets.bit(clamped));
  ASSERT_EQ(world.play_input("tool_clamped", {0.0}), mock::World::Played::done);
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kExternalAlarm) > 0; }, 10.0))
      << mill.alarm_list();
  EXPECT_FALSE(mill.image().packets.bit(clamped)) << "the valve is closed, the clamp does not report";
  ASSERT_EQ(world.play_input("tool_clamped", {}), mock::World::Played::done);
  EXPECT_TRUE(mill.until([&] { return mill.image().packets.bit(clamped); }, 1.0));
}

}  // namespace
}  // namespace servogate::machine_run
