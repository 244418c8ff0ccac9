// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/segment_load.hpp"

#include <gtest/gtest.h>

#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using testing::SegmentRig;
constexpr image::Nanoseconds kMs = image::kMillisecond;

std::vector<NodeConfig> axes(int count, void (*map)(DriveProfile&) = use_short_position_map) {
  std::vector<NodeConfig> nodes;
  for (int i = 0; i < count; ++i) {
    nodes.push_back(SegmentRig::axis_node(static_cast<NodeId>(i + 1), i));
    map(nodes.back().profile);
  }
  return nodes;
}

TEST(SegmentLoad, of_three_short_maps_at_1_ms_is_worked_out_by_hand) {
  // SYNC: 47 + 8 = 55 bits; six PDOs of 6 bytes: 95 + 20 = 115 bits each; four heartbeats in 100 ms of 1
  // byte: 55 + 10 = 65 bits.
  const SegmentLoad load = segment_load(1'000'000, kMs, axes(3));
  EXPECT_NEAR(load.load, (55 + 6 * 115 + 4 * 65 / 100.0) / 1000.0, 1e-12);
  EXPECT_NEAR(load.worst_cycle, (55 + 6 * 115 + 4 * 65) / 1000.0, 1e-12);
  ASSERT_EQ(load.frames.size(), 1u + 1u + 3u * 3u);
  EXPECT_EQ(load.frames.front().what, "SYNC");
  EXPECT_EQ(load.frames[1].what, "TPDO1");
  EXPECT_EQ(load.frames[1].id, 0x181u);
  EXPECT_EQ(load.frames[1].bits, 115u);
  EXPECT_EQ(load_text(load.load), nullptr);
}

TEST(SegmentLoad, counts_slow_pdos_by_their_type) {
  auto nodes = axes(1);
  const double before = segment_load(1'000'000, kMs, nodes).load;
  nodes[0].profile.tpdo[1].mapping.add({0x606C, 0, 32});
  nodes[0].profile.tpdo[1].transmission_type = 10;
  EXPECT_NEAR(segment_load(1'000'000, kMs, nodes).load - before, image::worst_case_bits(4) / 10.0 / 1000.0,
              1e-12);
  nodes[0].profile.tpdo[1].transmission_type = 255;
  EXPECT_NEAR(segment_load(1'000'000, kMs, nodes).load - before, image::worst_case_bits(4) / 1000.0, 1e-12)
      << "on event without inhibit time: every cycle";
  nodes[0].profile.tpdo[1].inhibit_100us = 50;
  EXPECT_NEAR(segment_load(1'000'000, kMs, nodes).load - before, image::worst_case_bits(4) / 5.0 / 1000.0,
              1e-12);
}

TEST(SegmentLoad, of_the_fullest_cycle_has_all_pdos_of_one_sync_and_service_data) {
  auto nodes = axes(3);
  const auto load = [&] { return segment_load(1'000'000, kMs, nodes); };
  EXPECT_NEAR(load().worst_process_data, (55 + 6 * 115) / 1000.0, 1e-12);
  EXPECT_NEAR(load().worst_service_data, kExchangeBits / 1000.0, 1e-12) << "one exchange at least";
  EXPECT_TRUE(late_pdos(load(), 1'000'000, kMs).empty());
  // TPDOs every 10th SYNC add little to the mean, and all of them come with the same SYNC.
  for (NodeConfig& node : nodes) {
    node.profile.tpdo[1].mapping.add({0x606C, 0, 32});
    node.profile.tpdo[1].mapping.add({0x6077, 0, 16});
    node.profile.tpdo[1].transmission_type = 10;
  }
  EXPECT_LT(load().load, 0.80);
  EXPECT_GT(load().worst_process_data, 1.0);
  EXPECT_TRUE(late_pdos(load(), 1'000'000, kMs).empty()) << "what may wait a cycle is the one that waits";
  nodes[1].profile.rpdo[2].mapping.add({0x60B8, 0, 16});
  const SegmentLoad full = load();
  const auto late = late_pdos(full, 1'000'000, kMs);
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0]->node, 2);
  EXPECT_EQ(late[0]->what, "RPDO3");
}

TEST(SegmentLoad, counts_the_remote_frame_that_asks_for_a_tpdo) {
  auto nodes = axes(1);
  const double before = segment_load(1'000'000, kMs, nodes).load * 1000.0;
  nodes[0].profile.tpdo[1].mapping.add({0x606C, 0, 32});
  nodes[0].profile.tpdo[1].transmission_type = 253;
  nodes[0].profile.tpdo[1].event_ms = 10;
  EXPECT_NEAR(segment_load(1'000'000, kMs, nodes).load * 1000.0 - before,
              (image::worst_case_bits(0) + image::worst_case_bits(4)) / 10.0, 1e-9);
}

TEST(SegmentLoad, counts_time_the_sync_counter_guarding_and_a_heartbeat_of_its_own) {
  const auto load = [](const std::vector<NodeConfig>& nodes, const SegmentServices& services = {}) {
    return segment_load(1'000'000, kMs, nodes, services).load * 1000.0;
  };
  auto nodes = axes(1);
  const double before = load(nodes);
  SegmentServices services;
  services.sync_counter = true;
  EXPECT_NEAR(load(nodes, services) - before, image::worst_case_bits(1) - image::worst_case_bits(0), 1e-9);
  services = {};
  services.time_ms = 20;
  EXPECT_NEAR(load(nodes, services) - before, image::worst_case_bits(6) / 20.0, 1e-9);
  nodes[0].heartbeat_ms = 10;
  EXPECT_NEAR(load(nodes) - before, image::worst_case_bits(1) * (1 / 10.0 - 1 / 100.0), 1e-9);
  nodes[0].heartbeat_ms = 0;
  nodes[0].profile.guard_time_ms = 50;
  EXPECT_NEAR(
      load(nodes) - before,
      (image::worst_case_bits(0) + image::worst_case_bits(1)) / 50.0 - image::worst_case_bits(1) / 100.0,
      1e-9)
      << "request and answer take the place of the heartbeat";
}

TEST(SegmentLoad, of_a_full_bus_is_refused_with_what_would_fit) {
  const auto nodes = axes(3, use_full_position_map);
  const SegmentLoad load = segment_load(1'000'000, kMs, nodes);
  ASSERT_GT(load.load, kLoadError);
  const LoadAdvice advice = advise(1'000'000, kMs, nodes);
  EXPECT_EQ(advice.cycle_ns, 4 * kMs);
  EXPECT_LE(segment_load(1'000'000, advice.cycle_ns, nodes).load, kLoadWarning);
  EXPECT_GT(segment_load(1'000'000, advice.cycle_ns / 2, nodes).load, kLoadWarning);
  EXPECT_EQ(advice.segments, 3);
  EXPECT_LT(advice.load_with_4_byte_pdo, kLoadWarning);
  EXPECT_EQ(load_text(load.load)->id, "can-load-error");
}

TEST(SegmentLoad, between_the_limits_is_a_warning) {
  EXPECT_EQ(load_text(0.80), nullptr);
  EXPECT_EQ(load_text(0.81)->id, "can-load-warning");
  EXPECT_EQ(load_text(0.90)->id, "can-load-warning");
  EXPECT_EQ(load_text(0.91)->id, "can-load-error");
}

TEST(SegmentLoad, that_no_number_of_segments_relieves_says_so) {
  const auto nodes = axes(2, use_full_position_map);
  EXPECT_EQ(advise(250'000, kMs, nodes).segments, 0);
}

TEST(SegmentLoad, is_an_upper_bound_of_what_a_running_segment_measures) {
  for (const int count : {1, 2, 3}) {
    SegmentRig rig(count);
    rig.start();
    ASSERT_TRUE(rig.boot());
    rig.run(1200);
    const double planned = segment_load(1'000'000, kMs, rig.config.nodes).load;
    EXPECT_LE(rig.image->segments[0].load, planned);
    EXPECT_GT(rig.image->segments[0].load, planned * 0.8);
  }
}

}  // namespace
}  // namespace servogate::canopen
