// SPDX-License-Identifier: Apache-2.0
// What nodes report of their errors: many messages at once, and an error of which no message came.
#include <gtest/gtest.h>

#include <set>

#include "firmware_if/image/alarms/drive_report.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

image::DriveReport report_of(const image::AlarmRecord& r) {
  return r.detail.get<image::DriveReport>().value_or(image::DriveReport{});
}

/// An emergency message without a fault, while the drive is silent for so long.
void warn(Mill& mill, const std::string& node, std::uint16_t code, image::Nanoseconds silent_ns) {
  mock::SimulatedDrive& drive = *mill.control().world().drive(node);
  fault::Fault fault;
  fault.kind = fault::Kind::silent;
  fault.duration_ns = silent_ns;
  drive.inject(fault);
  fault = {};
  fault.kind = fault::Kind::emcy_only;
  fault.error_code = code;
  drive.inject(fault);
}

TEST(Reports, of_all_nodes_at_once_are_all_shown) {
  Mill mill(changed_mill(
                [](std::string& text) { replace(text, "cycle_time = \"1 ms\"", "cycle_time = \"4 ms\""); }),
            "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  int most = 0, before = 0;
  mill.after_cycle = [&] {
    const int now = mill.alarms(cycle::alarm::kEmergencyMessage);
    most = std::max(most, now - before);
    before = now;
  };
  image::CanBus& wire = mill.control().world().wire(0)->add_endpoint("three nodes");
  for (std::uint16_t i = 0; i < 30; ++i)
    EXPECT_TRUE(wire.send(canopen::emcy_frame(static_cast<canopen::NodeId>(1 + i % 3),
                                              {static_cast<std::uint16_t>(0xFF10 + i), 0x81, {}})));
  mill.run(0.1);
  std::set<int> codes;
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
    if (r.number == cycle::alarm::kEmergencyMessage) codes.insert(report_of(r).error_code);
  EXPECT_EQ(codes.size(), 30u) << mill.alarm_list();
  EXPECT_GT(most, 8) << "this test is about many in one cycle";
  EXPECT_EQ(mill.alarms(cycle::alarm::kReportsLost), 0);
}

TEST(Reports, that_never_end_are_counted_where_they_find_no_place) {
  Mill mill(changed_mill(
                [](std::string& text) { replace(text, "cycle_time = \"1 ms\"", "cycle_time = \"4 ms\""); }),
            "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  image::CanBus& wire = mill.control().world().wire(0)->add_endpoint("a node that floods");
  mill.after_cycle = [&] {
    for (int i = 0; i < 28; ++i) wire.send(canopen::emcy_frame(2, {0xFF10, 0x81, {}}));
  };
  ASSERT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kReportsLost) > 0; }, 2.0))
      << mill.alarm_list();
  EXPECT_EQ(mill.alarms(cycle::alarm::kEmergencyMessage), 1) << "the same from the same node";
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
    if (r.number == cycle::alarm::kReportsLost) {
      EXPECT_EQ(r.part.device, 0);
      EXPECT_GT(r.value, 0.0);
    }
}

TEST(Reports, an_error_of_which_no_message_came_is_named_when_the_next_one_has_come) {
  Mill mill("");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.run(0.5);
  warn(mill, "can.y", 0x7305, image::kMillisecond);  // too short for a loss
  mill.run(0.2);
  EXPECT_EQ(mill.alarms(cycle::alarm::kEmergencyMessage), 0) << "it did not get through";
  EXPECT_EQ(mill.alarms(cycle::alarm::kErrorHistory), 0);
  mill.inject("can.y", fault::Kind::over_temperature);
  mill.run(0.5);
  ASSERT_EQ(mill.alarms(cycle::alarm::kErrorHistory), 1) << mill.alarm_list();
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history()) {
    if (r.number != cycle::alarm::kErrorHistory) continue;
    EXPECT_EQ(report_of(r).error_code, 0x7305);
    EXPECT_EQ(r.part.part, 2);
    EXPECT_EQ(r.axis, 1);
    EXPECT_EQ(report_of(r).object_index, 0x1003);
  }
}

}  // namespace
}  // namespace servogate::machine_run
