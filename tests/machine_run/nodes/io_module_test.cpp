// SPDX-License-Identifier: Apache-2.0
// A CiA 401 module on a bus carries the points that the example mill has at its panel.
#include <gtest/gtest.h>

#include "firmware_if/canopen/401/objects.hpp"
#include "machine/consequences.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr int kPanelNode = 9;
constexpr std::size_t kPanelBus = 1;  ///< the drives fill the other one
constexpr int kPanelEndpoint = 1;     ///< after the control

/// The mill whose Modbus panel is a module on the bus of the drives, and its emergency-stop chain with it.
void on_the_bus(std::string& text) {
  replace(text,
          "kind = \"modbus\"\nline = \"panel\"\ndevice = \"modbus-io-16-16-4-2\"\nunit = 1\n"
          "period = \"20 ms\"\n",
          "kind = \"canopen\"\nnode = \"io.panel\"\n");
  replace(text, "# ---------------------------------------------------------------- axes\n",
          "[[bus]]\nname = \"io\"\nurl = \"mock:io\"\nbit_rate = \"1 Mbit/s\"\n"
          "[[bus.node]]\nname = \"panel\"\nid = 9\ndevice = \"io-cia401-16-16-4-2\"\n");
  replace(text,
          "  { name = \"estop_chain_ok\", channel = \"di9\", place = \"SA17\", comment = \"1 = the chain is "
          "closed\" },\n",
          "");
  replace(text, "  { name = \"door_closed\", channel = \"di0\", place = \"SA16\" },\n",
          "  { name = \"door_closed\", channel = \"di0\", place = \"SA16\" },\n"
          "  { name = \"estop_chain_ok\", channel = \"di9\", place = \"SA17\" },\n");
}

machine::LoadResult mill_with_module(const std::function<void(std::string&)>& change = [](std::string&) {}) {
  return changed_mill([&](std::string& text) {
    on_the_bus(text);
    change(text);
  });
}

class IoModuleOnTheBus : public ::testing::Test {
 protected:
  static bool bit(Mill& mill, const char* name) {
    return mill.image().packets.bit(place_of(mill.control(), name));
  }
  static mock::SimulatedIoModule& module(Mill& mill) { return *mill.control().world().module("io.panel"); }
  static void cut(Mill& mill, bool connected = false) {
    mill.control().world().wire(kPanelBus)->set_connected(kPanelEndpoint, connected);
  }
  static std::vector<image::AlarmRecord> stops(Mill& mill) {
    std::vector<image::AlarmRecord> out;
    for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
      if (r.reaction > image::Reaction::warn) out.push_back(r);
    return out;
  }
};

TEST_F(IoModuleOnTheBus, is_booted_like_a_drive_and_the_machine_file_has_nothing_against_it) {
  const machine::LoadResult loaded = mill_with_module();
  for (const text::Finding& f : loaded.findings) EXPECT_EQ(f.severity, text::Severity::warning) << f.str();
  Mill mill(loaded, "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const canopen::Segment& segment = mill.control().suppliers()[kPanelBus]->segment();
  const canopen::NodeStatus status = segment.node_status(segment.config().nodes.size() - 1);
  EXPECT_EQ(status.node, kPanelNode);
  EXPECT_TRUE(status.online);
  EXPECT_EQ(status.boot.step, canopen::BootStep::done);
  EXPECT_EQ(status.device_type, 0x000F'0191u);
}

TEST_F(IoModuleOnTheBus, works_the_program_and_the_plc_with_its_points) {
  Mill mill(mill_with_module(), "N10 M8\nN20 G1 X20 F3000\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_TRUE(bit(mill, "door_closed"));
  EXPECT_TRUE(bit(mill, "air_ok"));
  EXPECT_EQ(mill.image().packets.number(place_of(mill.control(), "air_pressure")), 600.0);
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  bool coolant = false;
  mill.after_cycle = [&] { coolant = coolant || module(mill).digital(1); };
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }))
      << mill.alarm_list();
  EXPECT_TRUE(coolant) << "M8, by the PLC, at the terminal";
  EXPECT_EQ(mill.control().world().play_input("air_pressure", {650.0}), mock::World::Played::done);
  mill.run(0.1);
  EXPECT_EQ(mill.image().packets.number(place_of(mill.control(), "air_pressure")), 650.0);
}

TEST_F(IoModuleOnTheBus, opens_the_emergency_stop_chain_within_three_cycles) {
  Mill mill(mill_with_module(), "N10 G1 X20 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  mill.run(0.2);
  const std::int64_t before = mill.image().now.number;
  mill.control().world().set_input("estop_chain_ok", false);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kEmergencyStop) > 0; }, 0.1))
      << mill.alarm_list();
  EXPECT_LE(mill.image().now.number - before, 4);
}

TEST_F(IoModuleOnTheBus, lost_is_one_fault_that_names_node_and_segment_and_stops_on_the_path) {
  Mill mill(mill_with_module([](std::string& text) {
              replace(text, "{ name = \"coolant\", channel = \"dq1\", place = \"SA65\" }",
                      "{ name = \"coolant\", channel = \"dq1\", place = \"SA65\", hold = true }");
              replace(text, "{ name = \"lamp_red\", channel = \"dq4\", place = \"SA68\" }",
                      "{ name = \"lamp_red\", channel = \"dq4\", place = \"SA68\", loss = 1 }");
              replace(text, "{ name = \"tool_clamped\", channel = \"di3\", place = \"SA19\" }",
                      "{ name = \"tool_clamped\", channel = \"di3\", place = \"SA19\", hold = true }");
            }),
            "N10 G1 X200 F6000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  mill.run(0.3);
  ASSERT_GT(mill.process().feed_mm_s, 1.0) << mill.alarm_list();
  const std::int64_t cut_at = mill.image().now.number;
  cut(mill);
  ASSERT_TRUE(mill.until([&] { return !stops(mill).empty(); }, 1.0));
  const image::AlarmRecord fault = stops(mill).front();
  EXPECT_EQ(fault.number, axis::alarm::kPdoMissing);
  EXPECT_EQ(fault.part.part, kPanelNode);
  EXPECT_EQ(fault.reaction, image::Reaction::stop_on_path);
  EXPECT_LE(fault.cycle - cut_at, 5);
  const std::string said = image::render(fault, mill.control().alarm_names(), text::Language::english);
  EXPECT_NE(said.find("9 (io.panel)"), std::string::npos) << said;
  EXPECT_FALSE(image::render_remedy(fault, mill.control().alarm_names(), text::Language::english).empty());
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 2.0));
  EXPECT_FALSE(bit(mill, "door_closed")) << "loss = 0";
  EXPECT_TRUE(bit(mill, "tool_clamped")) << "hold";
  mill.run(1.0);
  EXPECT_TRUE(module(mill).digital(4)) << "6207h";
  for (const image::AlarmRecord& r : stops(mill)) EXPECT_EQ(r.first_fault, fault.sequence) << r.number;

  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  mill.run(0.1);
  EXPECT_GT(mill.image().alarms_active, 0u) << "the cause has not gone";
  cut(mill, true);
  ASSERT_TRUE(mill.until([&] { return mill.image().segments[kPanelBus].operational; }, 10.0));
  mill.run(0.5);
  EXPECT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.image().alarms_active == 0; }, 2.0)) << mill.alarm_list();
  EXPECT_TRUE(bit(mill, "door_closed"));
}

TEST_F(IoModuleOnTheBus, loss_reaction_of_its_node_is_what_the_machine_does) {
  Mill mill(mill_with_module([](std::string& text) {
              replace(text, "name = \"panel\"\nid = 9\n",
                      "name = \"panel\"\nid = 9\nloss_reaction = \"quick_stop\"\n");
            }),
            "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  cut(mill);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kPdoMissing) > 0; }, 1.0));
  EXPECT_GE(stops(mill).front().reaction, image::Reaction::quick_stop);
}

TEST_F(IoModuleOnTheBus, that_is_another_device_is_named_with_the_step_and_never_written_to) {
  Mill mill(mill_with_module([](std::string& text) {
              replace(text, "device = \"io-cia401-16-16-4-2\"",
                      "device = \"io-cia401-16-16-4-2\"\nsoftware_version = \"9.9\"");
            }),
            "");
  ASSERT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kBootFailed) > 0; }, 5.0));
  EXPECT_EQ(module(mill).object(canopen::io::kErrorModeOutput8, 1), 0xFF);
  EXPECT_EQ(module(mill).object(0x1017), 0) << "nothing was written";
}

TEST_F(IoModuleOnTheBus, without_error_states_works_and_goes_to_rest_by_the_deadline_of_its_outputs) {
  machine::LoadResult loaded = mill_with_module();
  machine::DeviceConfig& device = loaded.devices.at("io-cia401-16-16-4-2");
  device.behaviour.connection_loss = machine::ConnectionLoss::none;
  for (machine::PdoConfig& pdo : device.rpdos) pdo.event = 0.25;
  Mill mill(loaded, "N10 M8\nN20 M0\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.alarms(cycle::alarm::kBootFailed), 0);
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  EXPECT_EQ(module(mill).object(0x1400, 5), 250);
  const auto any_on = [&] {
    for (std::uint8_t line = 0; line < 16; ++line)
      if (module(mill).digital(line)) return true;
    return false;
  };
  ASSERT_TRUE(mill.until(any_on, 5.0)) << "coolant";
  // The control dies: nobody steps its cycle any more. Its last frame is 0.1 s old at most.
  const image::Nanoseconds now = mill.image().now.t_ns;
  mill.control().world().advance_to(now + 100 * image::kMillisecond);
  EXPECT_TRUE(any_on());
  mill.control().world().advance_to(now + 300 * image::kMillisecond);
  EXPECT_FALSE(any_on());
}

TEST_F(IoModuleOnTheBus, debounce_works_for_its_inputs) {
  Mill mill(mill_with_module([](std::string& text) {
              replace(text, "{ name = \"air_ok\", channel = \"di2\", place = \"SA18\" }",
                      "{ name = \"air_ok\", channel = \"di2\", place = \"SA18\", debounce = \"50 ms\" }");
            }),
            "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const auto play = [&](double value) { mill.control().world().play_input("air_ok", {value}); };
  play(0.0);
  mill.run(0.03);
  EXPECT_TRUE(bit(mill, "air_ok"));
  play(1.0);
  mill.run(0.1);
  EXPECT_TRUE(bit(mill, "air_ok"));
  play(0.0);
  mill.run(0.08);
  EXPECT_FALSE(bit(mill, "air_ok"));
}

TEST_F(IoModuleOnTheBus, is_in_the_planned_load_of_its_segment) {
  const machine::LoadResult loaded = mill_with_module();
  const canopen::SegmentLoad load = machine::segment_load(loaded, loaded.machine.buses[kPanelBus]);
  EXPECT_GT(load.load, 0.05);
  EXPECT_LT(load.load, 0.5);
  int frames = 0;
  for (const canopen::FrameLoad& f : load.frames) frames += f.node == kPanelNode;
  EXPECT_EQ(frames, 5) << "two TPDOs, two RPDOs, heartbeat";
}

}  // namespace
}  // namespace servogate::machine_run
