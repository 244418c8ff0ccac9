// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "drivers/mock/io/simulated_encoder.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/mock/node_bench.hpp"

namespace servogate::mock {
namespace {

/// 1000 counts a turn, 16 turns.
class EncoderBench : public NodeBench {
 public:
  EncoderBench() : encoder(config()) { plug_in(encoder); }
  static SimulatedEncoderConfig config() {
    SimulatedEncoderConfig c;
    c.node_id = kNode;
    c.resolution = {1000, 16};
    return c;
  }
  std::uint32_t at(std::int64_t counts) {
    encoder.set_position(counts);
    run(2);
    return read(0x6004);
  }
  SimulatedEncoder encoder;
};

TEST(Encoder, says_what_it_is_and_what_it_can_tell_apart) {
  EncoderBench b;
  EXPECT_EQ(b.read(0x1000), 0x0002'0196u);
  EXPECT_EQ(b.read(0x6501), 1000u);
  EXPECT_EQ(b.read(0x6502), 16u);
  EXPECT_EQ(b.read(0x6002), 16'000u);
  EXPECT_EQ(b.read(0x6504), 1u);
}

TEST(Encoder, keeps_its_place_without_supply_and_loses_what_was_configured) {
  EncoderBench b;
  b.write(0x6000, 0, 0x0001, 2);
  b.encoder.supply(false);
  b.seen.clear();
  b.encoder.set_position(1234);
  b.run(200);
  EXPECT_TRUE(b.seen.empty());
  b.encoder.supply(true);
  b.run(30);
  EXPECT_EQ(b.count(0x705), 1);
  EXPECT_EQ(b.read(0x6004), 1234u) << "absolute, and the code sequence is that of power-on";
}

TEST(Encoder, goes_round_at_the_end_of_its_turns_both_ways) {
  EncoderBench b;
  EXPECT_EQ(b.at(0), 0u);
  EXPECT_EQ(b.at(15'999), 15'999u);
  EXPECT_EQ(b.at(16'000), 0u);
  EXPECT_EQ(b.at(-1), 15'999u);
  EXPECT_EQ(b.at(5 * 16'000 + 7), 7u);
}

TEST(Encoder, code_sequence_and_scaling_change_what_is_read) {
  EncoderBench b;
  b.write(0x6000, 0, 0x0001, 2);
  EXPECT_EQ(b.at(1), 15'999u) << "clockwise falls";
  EXPECT_EQ(b.read(0x6500), 0x0001u);
  b.write(0x6001, 0, 360, 4);
  b.write(0x6002, 0, 3600, 4);
  b.write(0x6000, 0, 0x0004, 2);
  EXPECT_EQ(b.at(500), 180u);
  EXPECT_EQ(b.at(9'750), 3510u);
  EXPECT_EQ(b.at(10'000), 0u) << "ten turns are the whole range";
  EXPECT_EQ(b.at(-250), 3510u);
  EXPECT_EQ(b.write(0x6001, 0, 1001, 4), 0x0609'0031u) << "more than the disc has";
}

TEST(Encoder, a_preset_is_what_it_reads_where_it_stands_and_nothing_beyond_its_range) {
  EncoderBench b;
  b.at(1234);
  b.write(0x6003, 0, 100, 4);
  EXPECT_EQ(b.read(0x6004), 100u);
  EXPECT_EQ(b.at(1235), 101u);
  EXPECT_EQ(b.at(1134), 0u);
  EXPECT_EQ(b.at(1133), 15'999u);
  EXPECT_EQ(b.write(0x6003, 0, 16'000, 4), 0x0609'0031u);
  EXPECT_EQ(b.at(1234), 100u);
}

TEST(Encoder, sends_its_position_with_every_sync_and_when_it_changes) {
  EncoderBench b;
  b.at(77);
  b.nmt(0x01);
  b.seen.clear();
  b.send(0x080, {});
  b.run(2);
  const auto with_sync = b.take(0x285);
  ASSERT_TRUE(with_sync);
  EXPECT_EQ(with_sync->length, 4);
  EXPECT_EQ(with_sync->data[0], 77);
  b.seen.clear();
  b.encoder.set_position(78);
  b.run(3);
  EXPECT_EQ(b.count(0x185), 1);
  b.run(250);
  EXPECT_GE(b.count(0x185), 3) << "every 100 ms at least";
}

TEST(Encoder, tells_its_speed_and_that_it_cannot_read_its_disc) {
  EncoderBench b;
  for (int i = 0; i < 50; ++i) {
    b.encoder.set_position(3 * i);
    b.run(1);
  }
  EXPECT_NEAR(static_cast<double>(b.encoder.object(0x6030, 1)), 3000.0, 1.0) << "three counts a millisecond";
  b.encoder.set_unreadable(true);
  const std::uint32_t last = b.read(0x6004);
  EXPECT_EQ(b.at(9999), last) << "it stands still";
  EXPECT_EQ(b.read(0x6503), 1u);
  b.encoder.set_unreadable(false);
  EXPECT_EQ(b.at(9999), 9999u);
  EXPECT_EQ(b.read(0x6503), 0u);
}

TEST(Encoder, nothing_is_allocated_while_it_runs) {
  EncoderBench b;
  b.nmt(0x01);
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    b.encoder.set_position(i);
    b.now += image::kMillisecond;
    b.segment.advance_to(b.now);
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::mock
