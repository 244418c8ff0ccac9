// SPDX-License-Identifier: Apache-2.0
// Proof that a segment allocates nothing once it is built.
#include <gtest/gtest.h>

#include "tests/canopen/master/segment_fixture.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::canopen {
namespace {

using counting::allocations;
using testing::SegmentRig;

/// Steps a rig like SegmentRig::step, counting only what the segment allocates. The fake network
/// allocates when the master sends, so its queue is given room beforehand.
struct CountingRig : SegmentRig {
  using SegmentRig::SegmentRig;
  void counted_step() {
    network.sent.reserve(256);
    const std::uint64_t before = allocations();
    segment->open_cycle(*image);
    segment->receive(*image);
    segment->send(*image);
    counted += allocations() - before;
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    network.transfer(image->now.t_ns);
    BusEvent e;
    while (segment->events().pop(e)) events.push_back(e);
  }
  std::uint64_t counted = 0;
};

TEST(SegmentAllocation, the_counter_counts) {
  const std::uint64_t before = allocations();
  int* volatile memory = new int(1);  // volatile: the compiler may otherwise leave the pair out
  delete memory;
  EXPECT_GT(allocations(), before);
}

TEST(SegmentAllocation, nothing_is_allocated_in_boot_operation_loss_fault_and_latch) {
  CountingRig rig(4);
  for (std::size_t i = 2; i < 4; ++i) use_full_position_map(rig.config.nodes[i].profile);
  rig.config.nodes[3].profile.vendor_id = 0xBAD;  // this one is refused
  rig.start();
  for (int i = 0; i < 4; ++i) rig.device(i).zero_mark_every = 100;
  for (int cycle = 0; cycle < 6000; ++cycle) {
    for (int axis = 0; axis < 4; ++axis) {
      auto& command = rig.command(axis);
      command.power = cycle > 1000 && cycle % 2000 > 100;
      command.quick_stop = cycle % 700 == 0;
      command.reset_fault = cycle % 50 < 25;
      command.latch_arm = cycle % 400 > 50;
      command.mode = cycle % 3000 < 200 ? image::DriveMode::homing : image::DriveMode::csp;
      command.position_counts = rig.drive(axis).position_counts + 3;
    }
    if (cycle % 1500 == 1400) rig.device(0).raise_fault(0x7305, rig.network.waiting_out);
    if (cycle == 2500) rig.device(1).powered = false;
    if (cycle == 3500) rig.device(1).power_on(rig.network.waiting_out);
    if (cycle == 4000) rig.network.waiting_out.push_back(testing::frame(0x80, {}));
    rig.network.flush_out();
    rig.counted_step();
  }
  EXPECT_GE(rig.count(BusEventKind::node_booted), 4);
  EXPECT_EQ(rig.count(BusEventKind::boot_failed), 1);
  EXPECT_GE(rig.count(BusEventKind::emcy), 3);
  EXPECT_EQ(rig.count(BusEventKind::heartbeat_lost), 1);
  EXPECT_GT(rig.drive(2).latch_sequence, 3u);
  EXPECT_EQ(rig.counted, 0);
}

}  // namespace
}  // namespace servogate::canopen
