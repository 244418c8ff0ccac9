// SPDX-License-Identifier: Apache-2.0
// The example mill with a gearbox behind its spindle: on its CANopen drive, on an inverter on a Modbus line,
// and on an inverter on outputs.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "machine/consequences.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;

constexpr const char* kProgram =
    "N10 G90 G94 G71\nN20 S300 M3\nN30 G1 X10 F3000\nN40 S1600 M3\nN50 X20\nN60 M5\nN70 M30\n";

constexpr const char* kGears =
    "gear_change_time = \"200 ms\"\n"
    "gears = [ { name = \"low\", max_speed = \"500 rpm\", gear = [4, 1], output = \"gear_low\", confirm = "
    "\"in_low\" },\n"
    "          { name = \"high\", max_speed = \"6000 rpm\", gear = [1, 1], output = \"gear_high\" } ]\n";

void remove_drive(std::string& text, const std::string& instead) {
  replace(text, "[[bus.node]]\nname = \"spindle\"\nid = 4\ndevice = \"spindle-cia402-slow\"\n", "");
  replace(text, "drive = \"can.spindle\"\n", instead);
  const std::size_t plant = text.find("[[simulation.drive]]\nnode = \"can.spindle\"");
  ASSERT_NE(plant, std::string::npos);
  text.resize(plant);
}

machine::LoadResult geared(const std::string& supplier) {
  machine::LoadResult loaded = changed_mill([&](std::string& text) {
    const std::string lamp =
        "  { name = \"load_meter\", channel = \"aq0\", place = \"SA24.IN\", comment = \"bytes 48 and 49 of "
        "packet A\" },\n";
    std::string points =
        "  { name = \"gear_low\", channel = \"dq6\", place = \"SA73\" },\n"
        "  { name = \"gear_high\", channel = \"dq7\", place = \"SA74\" },\n"
        "  { name = \"in_low\", channel = \"di14\", place = \"SA44\" },\n";
    replace(text, "counts_per_rev = 65536\n", kGears);
    if (supplier == "outputs") {
      remove_drive(text, "speed_output = \"spindle_speed\"\n");
      points += "  { name = \"spindle_speed\", channel = \"aq0\", place = \"SA24.RE\", scale = 0.5 },\n";
      replace(text, lamp, points);
    } else {
      replace(text, lamp, lamp + points);
    }
    if (supplier == "inverter")
      remove_drive(text, "inverter = \"vfd\"\nrated_speed = \"3000 rpm\"\nrated_frequency = \"50 Hz\"\n");
    text += "\n[[simulation.loop]]\noutput = \"gear_low\"\ninput = \"in_low\"\ndelay = \"100 ms\"\n";
    if (supplier == "inverter")
      text +=
          "[[line]]\nname = \"cabinet\"\nurl = \"mock:cabinet\"\n\n[[station]]\nname = \"vfd\"\nkind = "
          "\"modbus\"\nline = \"cabinet\"\nunit = 7\nperiod = \"50 ms\"\ndevice = \"inverter-modbus\"\n";
  });
  if (supplier == "drive") loaded.devices.at("spindle-cia402-slow").motor.counts_per_rev = 65536;
  return loaded;
}

class EverySupplier : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Suppliers, EverySupplier, ::testing::Values("drive", "inverter", "outputs"));

TEST_P(EverySupplier, changes_its_gear_at_rest_between_two_speeds_of_a_program) {
  Mill mill(geared(GetParam()), kProgram);
  const auto gear = [&] { return mill.image().packets.number(place_of(mill.control(), "S.gear")); };
  const auto on = [&](const char* point) {
    return mill.image().packets.bit(place_of(mill.control(), point));
  };
  double fastest_change = 0.0, at_speed_low = 0.0, at_speed_high = 0.0;
  bool was_low = false, both = false;
  mill.after_cycle = [&] {
    const image::SpindleImage& s = mill.image().spindles[0];
    if (was_low && !on("gear_low")) fastest_change = std::max(fastest_change, std::abs(s.actual_rpm));
    was_low = on("gear_low");
    both = both || (on("gear_low") && on("gear_high"));
    if (s.at_speed && gear() == 1.0) at_speed_low = s.actual_rpm;
    if (s.at_speed && gear() == 2.0) at_speed_high = s.actual_rpm;
  };
  ASSERT_TRUE(mill.make_ready() && mill.ask(RequestKind::start) == Refusal::none) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; }, 60.0))
      << mill.alarm_list();
  EXPECT_NEAR(at_speed_low, 300.0, 15.0);
  EXPECT_NEAR(at_speed_high, 1600.0, 80.0);
  EXPECT_LE(fastest_change, 5.0);
  EXPECT_FALSE(both);
  EXPECT_TRUE(mill.control().cycle().alarms().history().empty()) << mill.alarm_list();
}

TEST_P(EverySupplier, is_a_machine_that_check_understands_and_puts_into_words) {
  machine::LoadResult loaded = geared(GetParam());
  for (const text::Finding& f : loaded.findings)
    if (std::string_view(f.entry->id) != "machine.spindle_counts")
      ADD_FAILURE() << f.line << " " << f.str(text::Language::english);
  int gears = 0;
  for (const machine::Consequence& c : machine::consequences(loaded))
    if (std::string_view(c.entry->id) == "consequence.gear") ++gears;
  EXPECT_EQ(gears, 2);
}

TEST_P(EverySupplier, stops_the_program_with_an_alarm_of_the_gear_that_is_not_confirmed) {
  Mill mill(geared(GetParam()), kProgram);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.control().world().play_input("in_low", {0.0});
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleGear) == 1; }, 20.0))
      << mill.alarm_list();
  const auto history = mill.control().cycle().alarms().history();
  EXPECT_EQ(image::render(history.front(), mill.control().alarm_names(), text::Language::english),
            "S: gear 1 is not engaged: its input does not confirm it; the spindle stops");
  mill.run(3.0);
  EXPECT_EQ(mill.process().state, ProcessState::stopped_by_alarm);
  EXPECT_NEAR(mill.image().spindles[0].actual_rpm, 0.0, 1.0);
}

}  // namespace
}  // namespace servogate::machine_run
