// SPDX-License-Identifier: Apache-2.0
// The example mill with its spindle on an inverter: speed over an analog output of the Modbus station,
// direction over two of its relays.
#include <gtest/gtest.h>

#include <cmath>

#include "machine/consequences.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;

void put_on_an_inverter(std::string& text) {
  replace(text, "[[bus.node]]\nname = \"spindle\"\nid = 4\ndevice = \"spindle-cia402-slow\"\n", "");
  replace(text, "drive = \"can.spindle\"\n",
          "speed_output = \"spindle_speed\"\ncw_output = \"spindle_cw\"\nccw_output = \"spindle_ccw\"\n");
  replace(text, "counts_per_rev = 65536\n", "");
  const std::size_t plant = text.find("[[simulation.drive]]\nnode = \"can.spindle\"");
  ASSERT_NE(plant, std::string::npos);
  text.resize(plant);
  replace(text,
          "  { name = \"load_meter\", channel = \"aq0\", place = \"SA24.IN\", comment = \"bytes 48 and 49 of "
          "packet A\" },\n",
          "  { name = \"spindle_speed\", channel = \"aq0\", place = \"SA24.IN\", scale = 0.25 },\n"
          "  { name = \"spindle_cw\", channel = \"dq6\", place = \"SA73\" },\n"
          "  { name = \"spindle_ccw\", channel = \"dq7\", place = \"SA74\", inverted = true, loss = 1 },\n");
}

constexpr const char* kBothWays =
    "N10 G90 G94 G71\nN20 S1500 M3\nN30 G1 X20 F3000\nN40 S800 M4\nN50 X0\nN60 M5\nN70 M30\n";

class InverterMill : public Mill {
 public:
  explicit InverterMill(std::string_view program) : Mill(changed_mill(put_on_an_inverter), program) {
    after_cycle = [this] { watch(); };
  }
  mock::ModbusStation& panel() { return *control().world().modbus("panel"); }
  /// What the terminals of the station show: register, relay of M3, relay of M4 (which is inverted).
  int wire() { return panel().analog_output(0); }
  bool cw() { return panel().output(6); }
  bool ccw() { return !panel().output(7); }
  bool off() { return wire() == 0 && !cw() && !ccw(); }
  bool start() { return make_ready() && ask(RequestKind::start) == Refusal::none; }

  int highest_cw = 0, highest_ccw = 0;
  bool both = false;

 private:
  void watch() {
    if (panel().requests_served() == 0) return;
    both = both || (cw() && ccw() && image().now.t_ns > image::kSecond);
    if (cw()) highest_cw = std::max(highest_cw, wire());
    if (ccw()) highest_ccw = std::max(highest_ccw, wire());
  }
};

TEST(InverterMill, is_a_machine_that_check_understands) {
  const machine::LoadResult loaded = changed_mill(put_on_an_inverter);
  for (const text::Finding& f : loaded.findings) ADD_FAILURE() << f.line << " " << f.entry->id;
  bool said = false;
  for (const machine::Consequence& c : machine::consequences(loaded))
    if (std::string_view(c.entry->id) == "consequence.inverter") {
      said = true;
      EXPECT_EQ(c.figures.at("register_at_max_speed"), 24000.0);
      EXPECT_EQ(c.figures.at("register_at_rest"), 0.0);
    }
  EXPECT_TRUE(said);
}

TEST(InverterMill, turns_both_ways_through_a_whole_program_and_stands_at_its_end) {
  InverterMill mill(kBothWays);
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; }, 60.0))
      << mill.alarm_list();
  EXPECT_EQ(mill.highest_cw, 6000) << "1500 rpm at a quarter rpm a step";
  EXPECT_EQ(mill.highest_ccw, 3200);
  EXPECT_FALSE(mill.both);
  mill.run(0.1);
  EXPECT_TRUE(mill.off());
  EXPECT_TRUE(mill.control().cycle().alarms().history().empty()) << mill.alarm_list();
}

TEST(InverterMill, the_emergency_stop_takes_speed_and_relays_away_and_closing_it_turns_nothing) {
  InverterMill mill(kBothWays);
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.wire() == 6000; }, 30.0)) << mill.alarm_list();
  mill.control().world().set_input("estop_chain_ok", false);
  mill.run(0.06);
  EXPECT_TRUE(mill.off()) << mill.wire();
  mill.control().world().set_input("estop_chain_ok", true);
  mill.run(1.0);
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  EXPECT_EQ(mill.ask(RequestKind::power, 1.0), Refusal::none);
  mill.run(3.0);
  EXPECT_TRUE(mill.off());
}

TEST(InverterMill, a_lost_station_stops_the_program_and_drops_its_own_outputs) {
  InverterMill mill(kBothWays);
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.wire() == 6000; }, 30.0)) << mill.alarm_list();
  mill.panel().inject({.kind = fault::Kind::silent});
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kSpindleOutputLost) == 1; }, 1.0))
      << mill.alarm_list();
  EXPECT_EQ(mill.alarms(cycle::alarm::kSourceStale), 1);
  mill.run(1.0);
  EXPECT_TRUE(mill.off()) << "by its watchdog";
  EXPECT_EQ(mill.process().state, ProcessState::stopped_by_alarm);
  mill.panel().clear_fault();
  mill.run(2.0);
  EXPECT_TRUE(mill.off()) << "what comes back turns nothing";
}

TEST(InverterMill, refuses_an_oriented_stop_with_its_reason) {
  InverterMill mill("N10 M19\nN20 M30\n");
  ASSERT_TRUE(mill.start()) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::stopped_by_alarm; }, 5.0));
  const auto history = mill.control().cycle().alarms().history();
  ASSERT_FALSE(history.empty());
  EXPECT_EQ(history.front().number, axis::alarm::kSpindleNoEncoder) << mill.alarm_list();
  EXPECT_EQ(image::render(history.front(), mill.control().alarm_names(), text::Language::english),
            "S: no oriented stop: the spindle has no encoder");
}

}  // namespace
}  // namespace servogate::machine_run
