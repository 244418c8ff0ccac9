// SPDX-License-Identifier: Apache-2.0
// The example mill with its spindle on an inverter on a Modbus line, one make after the other.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "machine/consequences.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::DriveState;
using image::ProcessState;
using image::RequestKind;

constexpr const char* kBothWays =
    "N10 G90 G94 G71\nN20 S1500 M3\nN30 G1 X20 F3000\nN40 S800 M4\nN50 X0\nN60 M5\nN70 M30\n";

machine::LoadResult mill_with(const std::string& device, const std::string& more = {}) {
  return changed_mill([&](std::string& text) {
    replace(text, "[[bus.node]]\nname = \"spindle\"\nid = 4\ndevice = \"spindle-cia402-slow\"\n", "");
    replace(text, "drive = \"can.spindle\"\n",
            "inverter = \"vfd\"\nrated_speed = \"3000 rpm\"\nrated_frequency = \"50 Hz\"\n" + more);
    replace(text, "counts_per_rev = 65536\n", "");
    const std::size_t plant = text.find("[[simulation.drive]]\nnode = \"can.spindle\"");
    ASSERT_NE(plant, std::string::npos);
    text.resize(plant);
    text +=
        "[[line]]\nname = \"cabinet\"\nurl = \"mock:cabinet\"\n\n[[station]]\nname = \"vfd\"\nkind = "
        "\"modbus\"\n"
        "line = \"cabinet\"\nunit = 7\nperiod = \"50 ms\"\ndevice = \"" +
        device + "\"\n";
  });
}

class VfdMill : public Mill {
 public:
  explicit VfdMill(const machine::LoadResult& loaded, std::string_view program = kBothWays)
      : Mill(loaded, program) {
    after_cycle = [this] {
      highest = std::max(highest, inverter().motor_hz());
      lowest = std::min(lowest, inverter().motor_hz());
    };
  }
  mock::ModbusStation& unit() { return *control().world().modbus("vfd"); }
  mock::SimulatedInverter& inverter() { return *unit().inverter(); }
  const image::SpindleImage& spindle() const { return image().spindles[0]; }
  bool start() { return make_ready() && ask(RequestKind::start) == Refusal::none; }
  bool turns() {
    return until([&] { return std::abs(inverter().motor_hz() - 25.0) < 0.05 && spindle().at_speed; }, 30.0);
  }
  bool stands() const { return std::abs(spindle().actual_rpm) < 1.0; }
  std::string first_words() {
    const auto history = control().cycle().alarms().history();
    return history.empty() ? std::string()
                           : image::render(history.front(), control().alarm_names(), text::Language::english);
  }
  double highest = 0.0, lowest = 0.0;
};

class EveryInverter : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Devices, EveryInverter,
                         ::testing::Values("inverter-modbus", "inverter-delta-ms300", "inverter-delta-vfd-e",
                                           "inverter-huanyang"));

TEST_P(EveryInverter, turns_both_ways_through_a_whole_program_and_stands_at_its_end) {
  const machine::LoadResult loaded = mill_with(GetParam());
  for (const text::Finding& f : loaded.findings)
    ADD_FAILURE() << f.line << " " << f.str(text::Language::english);
  VfdMill mill(loaded);
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; }, 60.0))
      << mill.alarm_list() << mill.first_words();
  EXPECT_NEAR(mill.highest, 25.0, 0.1) << "1500 rpm";
  EXPECT_NEAR(mill.lowest, -800.0 / 60.0, 0.1);
  mill.run(1.5);
  EXPECT_FALSE(mill.inverter().runs());
  EXPECT_TRUE(mill.stands());
  EXPECT_EQ(mill.spindle().drive.state, DriveState::ready_to_switch_on);
  EXPECT_TRUE(mill.control().cycle().alarms().history().empty()) << mill.alarm_list();
}

TEST_P(EveryInverter, whose_line_is_cut_stops_the_program_with_an_alarm_of_spindle_and_line) {
  VfdMill mill(mill_with(GetParam()));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.turns()) << mill.alarm_list();
  EXPECT_EQ(mill.spindle().drive.state, DriveState::operation_enabled);
  mill.inject("vfd", fault::Kind::silent);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleDriveLost) == 1; }, 1.0));
  EXPECT_EQ(mill.first_words(), "S: its inverter does not answer (cabinet.vfd); it was to turn at 1500 rpm");
  EXPECT_EQ(mill.alarms(cycle::alarm::kSourceStale), 0) << "said once";
  EXPECT_FALSE(mill.image().packets.bit(place_of(mill.control(), "S.zero_speed"))) << "nobody knows";
  mill.run(3.0);
  EXPECT_EQ(mill.process().state, ProcessState::stopped_by_alarm);
  mill.control().faults();
  mill.unit().clear_fault();
  mill.run(2.0);
  EXPECT_FALSE(mill.inverter().runs()) << "what comes back turns nothing";
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  mill.run(2.0);
  EXPECT_FALSE(mill.inverter().runs());
}

TEST_P(EveryInverter, stops_when_the_emergency_stop_opens_and_closing_it_turns_nothing) {
  VfdMill mill(mill_with(GetParam()));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.turns()) << mill.alarm_list();
  mill.control().world().set_input("estop_chain_ok", false);
  mill.run(0.2);
  EXPECT_LT(std::abs(mill.spindle().command_rpm), 1500.0 - 0.1 * 3000.0) << "it brakes on its ramp";
  mill.run(1.0);
  EXPECT_FALSE(mill.inverter().runs());
  EXPECT_LT(std::abs(mill.inverter().motor_hz()), 0.1);
  mill.control().world().set_input("estop_chain_ok", true);
  mill.run(1.0);
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  EXPECT_EQ(mill.ask(RequestKind::power, 1.0), Refusal::none);
  mill.run(3.0);
  EXPECT_FALSE(mill.inverter().runs());
}

TEST_P(EveryInverter, turns_nothing_before_its_parameters_are_right_and_names_the_first_wrong_one) {
  const machine::LoadResult loaded = mill_with(GetParam());
  VfdMill mill(loaded);
  const machine::InverterRequired& first = loaded.devices.at(GetParam()).inverter.required.at(0);
  mill.inverter().set_register(static_cast<std::uint16_t>(first.address),
                               static_cast<std::uint16_t>(first.high + 1));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleNotReady) == 1; }, 30.0));
  EXPECT_EQ(mill.spindle().drive.state, DriveState::switch_on_disabled);
  EXPECT_FALSE(mill.inverter().runs());
  EXPECT_NE(mill.first_words().find(first.english), std::string::npos) << mill.first_words();
  EXPECT_EQ(mill.first_words().rfind("S: its inverter may not run (cabinet.vfd): ", 0), 0u);
}

TEST(VfdMill, is_explained_by_check_in_hertz_and_by_what_stands_in_its_register) {
  for (const machine::Consequence& c : machine::consequences(mill_with("inverter-modbus")))
    if (std::string_view(c.entry->id) == "consequence.inverter_on_line") {
      EXPECT_EQ(
          c.str(text::Language::english),
          "main spindle: 0.83 to 100 Hz on the inverter cabinet.vfd, 10000 in its register at full speed; "
          "it counts as lost when it has not been heard for 150 ms");
      return;
    }
  FAIL() << "it is not explained";
}

TEST(VfdMill, that_trips_says_why_and_turns_again_only_when_it_is_told_to_after_a_reset) {
  VfdMill mill(mill_with("inverter-delta-ms300"));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.turns()) << mill.alarm_list();
  mill.inject("vfd", {.kind = fault::Kind::trip, .error_code = 21});
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleDriveFault) == 1; }, 1.0));
  EXPECT_EQ(mill.first_words(), "S: fault of the spindle drive, error 0x0015 (oL: inverter overload)");
  EXPECT_EQ(mill.spindle().drive.state, DriveState::fault);
  mill.run(2.0);
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.spindle().drive.state != DriveState::fault; }, 2.0));
  EXPECT_EQ(mill.inverter().tripped(), 0);
  mill.run(3.0);
  EXPECT_FALSE(mill.inverter().runs());
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  EXPECT_TRUE(mill.turns()) << mill.alarm_list();
}

TEST(VfdMill, reacts_to_a_lost_line_as_the_machine_file_says) {
  VfdMill mill(mill_with("inverter-modbus", "loss_reaction = \"stop_and_power_off\"\n"));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.turns()) << mill.alarm_list();
  mill.inject("vfd", fault::Kind::kill);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleDriveLost) == 1; }, 1.0));
  EXPECT_TRUE(mill.until([&] { return !mill.axis("X").enabled; }, 5.0)) << "its axes are off, too";
}

TEST(VfdMill, waits_for_at_speed_of_the_inverter_itself) {
  VfdMill mill(mill_with("inverter-modbus", "at_speed_window = \"50 %\"\n"));
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.spindle().at_speed; }, 30.0)) << mill.alarm_list();
  EXPECT_NEAR(mill.spindle().actual_rpm, 1500.0, 10.0) << "not at half of it already";
}

TEST(VfdMill, without_a_reverse_command_refuses_m4_with_its_reason) {
  machine::LoadResult loaded = mill_with("inverter-modbus");
  loaded.devices.at("inverter-modbus").inverter.reverse = -1;
  VfdMill mill(loaded);
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleNoReverse) == 1; }, 30.0));
  EXPECT_GE(mill.lowest, -0.1);
}

}  // namespace
}  // namespace servogate::machine_run
