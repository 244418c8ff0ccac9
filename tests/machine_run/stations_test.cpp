// SPDX-License-Identifier: Apache-2.0
// The Modbus station of the example mill as its device file describes it.
#include <gtest/gtest.h>

#include "gateway/control/compose/setup/modbus_setup.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using modbus::Function;

constexpr const char* kPanel = "modbus-io-16-16-4-2";

machine::ModbusMap elsewhere() {
  machine::ModbusMap map{16, 16, 4, 2, 512, 1024, 0x30, 0x40, true};
  return map;
}

machine::LoadResult mill_with(const machine::ModbusMap& panel) {
  machine::LoadResult loaded = machine::load(source("examples/mill/machine.toml"));
  loaded.devices.at(kPanel).modbus = panel;
  return loaded;
}

const machine::StationConfig& panel_of(const machine::LoadResult& loaded) {
  for (const machine::StationConfig& s : loaded.machine.stations)
    if (s.device == kPanel) return s;
  ADD_FAILURE() << "no panel";
  return loaded.machine.stations.front();
}

TEST(Stations, a_poll_plan_asks_at_the_addresses_of_the_device_file) {
  const machine::LoadResult loaded = mill_with(elsewhere());
  const modbus::Map map = gateway::modbus_map(panel_of(loaded), elsewhere());
  ASSERT_EQ(map.blocks.size(), 4u);
  const struct {
    Function function;
    int address, count;
  } expected[] = {{Function::read_input_registers, 512, 1},
                  {Function::write_multiple_coils, 1024, 16},
                  {Function::read_input_registers, 0x30, 4},
                  {Function::write_multiple_registers, 0x40, 2}};
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_EQ(map.blocks[b].function, expected[b].function);
    EXPECT_EQ(map.blocks[b].address, expected[b].address);
    EXPECT_EQ(map.blocks[b].count, expected[b].count);
  }
  EXPECT_TRUE(modbus::check(map, image::Packets{}).empty());
  EXPECT_EQ(map.points.size(), panel_of(loaded).points.size());
}

TEST(Stations, a_station_with_more_channels_than_one_transaction_carries_is_polled_in_several) {
  machine::StationConfig station;
  machine::PointConfig last;
  last.channel = machine::ChannelKind::ai;
  last.number = 299;
  last.place = *image::parse_place("SA16.IN");
  station.points.push_back(last);
  machine::ModbusMap layout;
  layout.ai_count = 300;
  layout.ai_address = 7;
  const modbus::Map map = gateway::modbus_map(station, layout);
  ASSERT_EQ(map.blocks.size(), 3u);
  EXPECT_EQ(map.blocks[2].address, 257);
  EXPECT_EQ(map.blocks[2].count, 50);
  ASSERT_EQ(map.points.size(), 1u);
  EXPECT_EQ(map.points[0].block, 2u);
  EXPECT_EQ(map.points[0].offset, 49);
  EXPECT_TRUE(modbus::check(map, image::Packets{}).empty());
}

TEST(Stations, a_machine_works_with_packed_inputs_and_registers_that_begin_elsewhere) {
  Mill mill(mill_with(elsewhere()), {});
  const auto bit = [&](const char* name) { return mill.image().packets.bit(place_of(mill.control(), name)); };
  mill.run(0.2);
  EXPECT_TRUE(bit("door_closed"));
  EXPECT_TRUE(bit("air_ok"));
  EXPECT_FALSE(bit("cycle_start"));
  EXPECT_EQ(mill.image().packets.number(place_of(mill.control(), "air_pressure")), 600.0);
  mill.control().world().set_input("door_closed", false);
  mill.control().world().set_input("cycle_start", true);
  mill.run(0.1);
  EXPECT_FALSE(bit("door_closed"));
  EXPECT_TRUE(bit("cycle_start"));
  EXPECT_EQ(mill.image().sources[1].quality, image::Quality::good);
  EXPECT_EQ(mill.image().sources[1].errors, 0u);

  mock::MockModbusLine* line = mill.control().world().line_of("panel");
  ASSERT_NE(line, nullptr);
  modbus::Pdu request, answer;
  modbus::Response response;
  const modbus::Request at_zero{Function::read_input_registers, 0, 1, {}};
  ASSERT_TRUE(encode(at_zero, request));
  ASSERT_TRUE(line->station(0).serve(mill.image().now.t_ns, request, answer));
  ASSERT_EQ(decode_response(answer.view(), at_zero, response), modbus::AnswerFault::none);
  EXPECT_EQ(response.exception, modbus::Exception::illegal_data_address);
}

/// The mill with a second unit on the line of its panel.
machine::LoadResult mill_with_two_units() {
  return changed_mill([](std::string& text) {
    const std::string panel = "[[station]]  # everything that may be 20 ms old";
    replace(text, panel,
            "[[station]]\nname = \"cabinet\"\nkind = \"modbus\"\nline = \"panel\"\nunit = 7\n"
            "device = \"modbus-io-16-16-4-2\"\nperiod = \"40 ms\"\npoints = [\n"
            "  { name = \"cabinet_fan\", channel = \"dq0\", place = \"SA200\" },\n"
            "  { name = \"cabinet_warm\", channel = \"di3\", place = \"SA201\", loss = 1 },\n]\n\n" +
                panel);
    replace(text, "url = \"mock:panel\"\n", "url = \"mock:panel\"\nbaud = 1000000\ntimeout = \"20 ms\"\n");
  });
}

TEST(Stations, several_units_share_a_line_and_one_that_is_lost_leaves_the_others_their_data) {
  Mill mill(mill_with_two_units(), {});
  const auto bit = [&](const char* name) { return mill.image().packets.bit(place_of(mill.control(), name)); };
  const auto quality = [&](std::size_t source) { return mill.image().sources[source].quality; };
  mock::MockModbusLine* line = mill.control().world().line_of("panel");
  ASSERT_NE(line, nullptr);
  ASSERT_EQ(line->stations(), 2u);
  EXPECT_EQ(mill.control().world().line_of("cabinet"), line);
  mill.control().world().set_input("cabinet_warm", true);
  mill.run(0.5);
  EXPECT_EQ(quality(1), image::Quality::good);
  EXPECT_EQ(quality(2), image::Quality::good);
  EXPECT_TRUE(bit("cabinet_warm"));
  EXPECT_TRUE(bit("door_closed"));
  mill.control().world().set_input("cabinet_warm", false);
  mill.run(0.2);
  EXPECT_FALSE(bit("cabinet_warm"));
  line->station(0).inject({.kind = fault::Kind::silent});
  mill.run(1.0);
  EXPECT_EQ(quality(1), image::Quality::bad);
  EXPECT_TRUE(bit("cabinet_warm")) << "its value of loss";
  EXPECT_EQ(quality(2), image::Quality::good);
  EXPECT_TRUE(bit("door_closed"));
}

TEST(Stations, what_a_lost_station_shows_on_the_wire_is_the_loss_of_each_output) {
  const machine::LoadResult loaded = changed_mill([](std::string& text) {
    const std::string lamp = "name = \"lamp_red\", channel = \"dq4\", place = \"SA68\"";
    replace(text, lamp, lamp + ", loss = 1");
  });
  Mill mill(loaded, {});
  mill.run(0.3);
  mock::MockModbusLine* line = mill.control().world().line_of("panel");
  ASSERT_NE(line, nullptr);
  line->station(0).advance_to(mill.image().now.t_ns + 2 * image::kSecond);
  EXPECT_TRUE(line->station(0).output(4));
  EXPECT_FALSE(line->station(0).output(3));
}

}  // namespace
}  // namespace servogate::machine_run
