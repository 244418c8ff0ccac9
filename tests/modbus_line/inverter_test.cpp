// SPDX-License-Identifier: Apache-2.0
// An inverter as the drive of a spindle on a real line, against a simulated one at the other end of the wire.
#include <gtest/gtest.h>

#include "machine/device.hpp"
#include "machine/modbus_blocks.hpp"
#include "tests/comes.hpp"
#include "tests/modbus_line/rig/cycles.hpp"
#include "tests/places/places.hpp"

namespace servogate::modbus_line {
namespace {

using image::DriveState;
using modbus::Heard;

constexpr double kCountsPerHz = 1000.0;

machine::DeviceConfig device(const std::string& name) {
  return machine::load_device(tests::source_dir() + "/devices/" + name + ".toml").device;
}

mock::StationSettings unit_of(const machine::DeviceConfig& device) {
  mock::StationSettings unit;
  unit.unit = 3;
  unit.inverter.emplace();
  unit.inverter->registers = machine::inverter_registers(device.inverter);
  unit.inverter->ramp_hz_s = 1000.0;
  return unit;
}

/// The line of a control with a spindle on it.
class SpindleLine {
 public:
  SpindleLine(const machine::DeviceConfig& device, const modbus::LineSettings& settings) {
    machine::StationConfig station;
    station.unit = 3;
    station.period = 0.05;
    machine::InverterBlocks blocks = machine::inverter_blocks(station, device.inverter);
    blocks.inverter.counts_s_per_hz = kCountsPerHz;
    modbus::Map map;
    map.blocks = blocks.blocks;
    map.inverters.push_back(blocks.inverter);
    drivers::Notice why;
    line_ = modbus::ModbusLine::open(settings, map, {{3, 0}}, why);
    EXPECT_NE(line_, nullptr) << why.str(text::Language::english);
    image_->now.number = -1;
  }
  void turn(double hz) {
    command().power = true;
    command().velocity_counts_s = hz * kCountsPerHz;
  }
  bool until(const std::function<bool()>& met) {
    return tests::comes(
        [&] {
          image::CycleTime& now = image_->now;
          now = {now.number + 1, (now.number + 1) * image::kMillisecond, image::kMillisecond};
          line_->receive(*image_, notices_);
          line_->send(*image_);
          return met();
        },
        std::chrono::milliseconds(1));
  }
  bool comes_to(double hz) {
    return until([&] { return std::abs(drive().velocity_counts_s - hz * kCountsPerHz) < 1.0; });
  }
  image::DriveCommand& command() { return image_->spindles[0].drive_command; }
  const image::DriveFeedback& drive() const { return image_->spindles[0].drive; }
  modbus::LineCounters counters() const { return line_->counters(); }
  void end() { line_.reset(); }

 private:
  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
  image::Notices notices_;
  std::unique_ptr<modbus::ModbusLine> line_;
};

void both_ways(SpindleLine& line, Units& units) {
  ASSERT_TRUE(line.until([&] { return line.drive().state == DriveState::ready_to_switch_on; }));
  line.turn(25.0);
  EXPECT_TRUE(line.comes_to(25.0));
  EXPECT_EQ(line.drive().state, DriveState::operation_enabled);
  line.turn(-12.5);
  EXPECT_TRUE(line.comes_to(-12.5));
  line.command().power = false;
  EXPECT_TRUE(line.comes_to(0.0));
  units.with(3, [](mock::ModbusStation& s) { EXPECT_FALSE(s.inverter()->runs()); });
  line.turn(10.0);
  EXPECT_TRUE(line.comes_to(10.0));
  EXPECT_EQ(line.counters().of(Heard::malformed), 0u);
  line.end();
  units.with(3,
             [](mock::ModbusStation& s) { EXPECT_FALSE(s.inverter()->runs()) << "the control has ended"; });
}

TEST(InverterLine, of_a_delta_turns_both_ways_over_tcp_and_stands_when_the_control_ends) {
  const machine::DeviceConfig delta = device("inverter-delta-ms300");
  Units units(unit_of(delta), Units::Wire::tcp);
  SpindleLine line(delta, tcp(units));
  both_ways(line, units);
}

TEST(InverterLine, of_a_delta_turns_both_ways_over_a_serial_device) {
  const machine::DeviceConfig delta = device("inverter-delta-vfd-e");
  Units units(unit_of(delta), Units::Wire::rtu);
  SpindleLine line(delta, rtu(units.device()));
  both_ways(line, units);
}

TEST(InverterLine, of_a_huanyang_turns_both_ways_with_its_own_requests) {
  const machine::DeviceConfig huanyang = device("inverter-huanyang");
  Units units(unit_of(huanyang), Units::Wire::rtu);
  SpindleLine line(huanyang, rtu(units.device()));
  both_ways(line, units);
  for (const Asked& asked : units.asked())
    EXPECT_TRUE(asked.function() == 1 || (asked.function() >= 3 && asked.function() <= 5))
        << asked.function();
}

TEST(InverterLine, of_a_huanyang_takes_no_damaged_half_or_foreign_answer) {
  const machine::DeviceConfig huanyang = device("inverter-huanyang");
  Units units(unit_of(huanyang), Units::Wire::rtu);
  int bent = 0;
  units.bend([&](const Asked& asked, const Bytes& good) {
    Reply reply{units.frame(asked, good)};
    if (asked.function() != 4 || bent == 3) return reply;
    ++bent;
    if (bent == 1) reply.bytes.back() ^= 1;
    if (bent == 2) reply.bytes.resize(4);
    Asked other = asked;
    other.unit = 4;
    if (bent == 3) reply.bytes = units.frame(other, good);
    return reply;
  });
  SpindleLine line(huanyang, rtu(units.device(), image::kSecond));
  EXPECT_TRUE(line.until([&] { return line.drive().state == DriveState::ready_to_switch_on; }));
  EXPECT_GE(line.counters().of(Heard::malformed), 1u);
  EXPECT_GE(line.counters().of(Heard::half), 1u);
  EXPECT_GE(line.counters().of(Heard::wrong_unit), 1u);
}

TEST(InverterLine, that_is_cut_is_offline_and_turns_nothing_when_it_is_back_until_it_is_told_to) {
  const machine::DeviceConfig delta = device("inverter-delta-ms300");
  mock::StationSettings unit = unit_of(delta);
  unit.watchdog_ns = 500 * image::kMillisecond;
  Units units(unit, Units::Wire::tcp);
  SpindleLine line(delta, tcp(units));
  line.turn(25.0);
  ASSERT_TRUE(line.comes_to(25.0));
  units.unplug();
  EXPECT_TRUE(line.until([&] { return !line.drive().online; }));
  EXPECT_EQ(line.drive().state, DriveState::offline);
  line.command() = {};
  units.plug();
  EXPECT_TRUE(line.until([&] { return line.drive().online; }));
  units.with(3, [](mock::ModbusStation& s) { EXPECT_FALSE(s.inverter()->runs()); });
}

}  // namespace
}  // namespace servogate::modbus_line
