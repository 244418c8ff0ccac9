// SPDX-License-Identifier: Apache-2.0
// An absolute encoder (CiA 406) on the bus of the drives is a point of packet A.
#include <gtest/gtest.h>

#include "gateway/control/compose/setup/canopen_setup.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

constexpr std::size_t kEndpoint = 5;  ///< after the control and four drives

machine::LoadResult with_encoder(const std::string& points) {
  return changed_mill([&](std::string& text) {
    replace(text, "# ---------------------------------------------------------------- axes\n",
            "[[bus.node]]\nname = \"table\"\nid = 9\ndevice = \"encoder-cia406\"\n");
    replace(text, "[[station]]  # everything",
            "[[station]]\nname = \"table\"\nkind = \"canopen\"\nnode = \"can.table\"\npoints = [\n" + points +
                "]\n\n[[station]]  # everything");
  });
}

const std::string kPoints =
    "  { name = \"table_counts\", channel = \"ai0\", place = \"SA50.LI\", hold = true },\n"
    "  { name = \"table_blind\", channel = \"di0\", place = \"SA90\", loss = 1 },\n";

TEST(EncoderOnTheBus, is_compared_at_boot_and_its_counts_are_a_point_of_packet_a) {
  const machine::LoadResult loaded = with_encoder(kPoints);
  for (const text::Finding& f : loaded.findings) EXPECT_EQ(f.severity, text::Severity::warning) << f.str();
  Mill mill(loaded, "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const image::Place counts = place_of(mill.control(), "table_counts");
  mock::SimulatedEncoder& encoder = *mill.control().world().encoder("can.table");
  encoder.set_position(20'000'123);
  mill.run(0.02);
  EXPECT_EQ(mill.image().packets.number(counts), 20'000'123.0);
  EXPECT_EQ(mill.control().world().play_input("table_counts", {77.0}), mock::World::Played::done);
  mill.run(0.02);
  EXPECT_EQ(mill.image().packets.number(counts), 77.0);
  encoder.set_unreadable(true);
  mill.run(0.02);
  EXPECT_TRUE(mill.image().packets.bit(place_of(mill.control(), "table_blind")));
}

TEST(EncoderOnTheBus, lost_stops_the_machine_and_keeps_what_is_to_be_held) {
  Mill mill(with_encoder(kPoints), "");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.control().world().encoder("can.table")->set_position(4711);
  mill.run(0.02);
  mill.control().world().wire(0)->set_connected(kEndpoint, false);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kPdoMissing) > 0; }, 1.0));
  mill.run(0.01);
  EXPECT_EQ(mill.image().packets.number(place_of(mill.control(), "table_counts")), 4711.0);
  EXPECT_TRUE(mill.image().packets.bit(place_of(mill.control(), "table_blind"))) << "loss = 1";
}

TEST(EncoderOnTheBus, of_another_resolution_is_refused_at_its_boot_with_both_numbers) {
  machine::LoadResult loaded = with_encoder(kPoints);
  machine::LoadResult expected = loaded;
  expected.devices.at("encoder-cia406").encoder.counts_per_rev = 4096;
  const auto another = gateway::simulated_world(loaded);
  // The plan of a machine file that wants 4096 counts, carried out on an encoder that has 8192.
  const canopen::SegmentConfig config = gateway::segment_config(expected, 0);
  canopen::Segment segment(*another->bus(0), config);
  auto image = std::make_unique<image::ProcessImage>();
  image->now.period_ns = config.cycle_ns;
  canopen::BusEvent event, failed;
  for (int i = 0; i < 3000 && failed.kind == canopen::BusEventKind::none; ++i) {
    another->advance_to(image->now.t_ns);
    segment.open_cycle(*image);
    segment.receive(*image);
    segment.send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    while (segment.events().pop(event))
      if (event.kind == canopen::BusEventKind::boot_failed) failed = event;
  }
  EXPECT_EQ(failed.node, 9);
  EXPECT_EQ(failed.boot.step, canopen::BootStep::encoder_resolution);
  EXPECT_EQ(failed.boot.index, 0x6501);
  EXPECT_EQ(failed.boot.expected, 4096u);
  EXPECT_EQ(failed.boot.got, 8192u);
}

TEST(EncoderOnTheBus, needs_a_place_that_holds_32_bits) {
  const machine::LoadResult loaded =
      with_encoder("  { name = \"table_counts\", channel = \"ai0\", place = \"SA50.IN\" },\n");
  EXPECT_FALSE(loaded.ok());
  ASSERT_FALSE(loaded.findings.empty());
}

}  // namespace
}  // namespace servogate::machine_run
