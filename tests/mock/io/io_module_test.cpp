// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "drivers/mock/io/simulated_io_module.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/mock/node_bench.hpp"

namespace servogate::mock {
namespace {

class IoBench : public NodeBench {
 public:
  explicit IoBench(canopen::IoTerminals terminals = {16, 16, 4, 2}) : module(config(terminals)) {
    plug_in(module);
  }
  void start() {
    nmt(0x01);
    seen.clear();
  }
  static SimulatedIoConfig config(canopen::IoTerminals terminals) {
    SimulatedIoConfig c;
    c.node_id = kNode;
    c.terminals = terminals;
    return c;
  }
  SimulatedIoModule module;
};

TEST(IoModule, says_what_it_is_and_has_only_the_objects_of_its_terminals) {
  IoBench b;
  EXPECT_EQ(b.read(0x1000), 0x000F0191u);
  EXPECT_EQ(b.read(0x6000), 2u);
  EXPECT_EQ(b.read(0x6401), 4u);
  EXPECT_EQ(b.read(0x6411), 2u);
  IoBench inputs({8, 0, 0, 0});
  EXPECT_EQ(inputs.read(0x1000), 0x00010191u);
  EXPECT_EQ(inputs.read(0x6200), 0x06020000u) << "no outputs: the object does not exist";
  EXPECT_TRUE(inputs.aborted);
}

TEST(IoModule, sends_its_inputs_on_becoming_operational_and_then_when_they_change) {
  IoBench b;
  b.nmt(0x01);
  const auto first = b.take(0x185);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->length, 2);
  b.run(50);
  EXPECT_EQ(b.count(0x185), 0) << "nothing has changed";
  b.module.set_digital(9, true);
  b.run(3);
  const auto change = b.take(0x185);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->data[0], 0x00);
  EXPECT_EQ(change->data[1], 0x02);
  EXPECT_EQ(b.read(0x6000, 2), 0x02u);
}

TEST(IoModule, without_supply_is_silent_with_all_outputs_off_and_boots_when_it_is_back) {
  IoBench b;
  b.start();
  b.write(0x6200, 1, 0xFF, 1);
  b.write(0x6411, 1, 1000, 2);
  ASSERT_TRUE(b.module.digital(0));
  ASSERT_EQ(b.module.analogue(0), 1000);
  b.seen.clear();
  b.module.supply(false);
  b.module.set_digital(3, true);
  b.run(50);
  EXPECT_TRUE(b.seen.empty());
  EXPECT_FALSE(b.module.digital(0));
  EXPECT_EQ(b.module.analogue(0), 0);
  b.module.supply(true);
  b.run(30);
  EXPECT_EQ(b.count(0x705), 1);
  EXPECT_EQ(b.module.nmt_state(), canopen::NmtState::pre_operational);
  EXPECT_FALSE(b.module.digital(0)) << "nobody has written it since";
  EXPECT_EQ(b.read(0x6000, 1), 0x08u) << "the world went on meanwhile";
}

TEST(IoModule, another_one_in_its_place_says_so_until_the_right_one_is_back) {
  IoBench b;
  const std::uint32_t own = b.read(0x1018, 2);
  b.module.swap(0);
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), own + 1);
  b.module.swap(77);
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), 77u);
  b.module.swap(std::nullopt);
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), own);
}

TEST(IoModule, changes_that_are_masked_are_no_events_and_are_read_all_the_same) {
  IoBench b;
  b.write(0x6006, 1, 0x00, 1);  // no change is an event ...
  b.write(0x6007, 1, 0x01, 1);  // ... but line 0 when it rises
  b.start();
  b.module.set_digital(3, true);
  b.run(5);
  EXPECT_EQ(b.count(0x185), 0);
  EXPECT_EQ(b.read(0x6000, 1), 0x08u);
  b.module.set_digital(0, true);
  b.run(5);
  ASSERT_EQ(b.count(0x185), 1);
  EXPECT_EQ(b.take(0x185)->data[0], 0x09) << "the PDO carries every line";
  b.module.set_digital(0, false);
  b.run(5);
  EXPECT_EQ(b.count(0x185), 0) << "falling is none";
  b.write(0x6008, 1, 0x01, 1);
  b.module.set_digital(0, true);
  b.run(5);
  b.seen.clear();
  b.module.set_digital(0, false);
  b.run(5);
  EXPECT_EQ(b.count(0x185), 1);
  b.write(0x6005, 0, 0, 1);
  b.module.set_digital(0, true);
  b.run(5);
  EXPECT_EQ(b.count(0x185), 1) << "6005h switches all of them off";
}

TEST(IoModule, polarity_turns_a_line_over_and_the_filter_holds_a_spike_back) {
  IoBench b;
  b.write(0x6002, 1, 0x01, 1);
  b.run(2);
  EXPECT_EQ(b.read(0x6000, 1), 0x01u);
  b.write(0x6003, 1, 0x02, 1);
  b.module.set_digital(1, true);
  b.run(3);
  EXPECT_EQ(b.read(0x6000, 1), 0x01u) << "not for 5 ms yet";
  b.module.set_digital(1, false);
  b.run(10);
  EXPECT_EQ(b.read(0x6000, 1), 0x01u);
  b.module.set_digital(1, true);
  b.run(10);
  EXPECT_EQ(b.read(0x6000, 1), 0x03u);
}

TEST(IoModule, analogue_inputs_are_silent_until_asked_and_then_speak_by_their_delta) {
  IoBench b;
  b.start();
  b.module.set_analogue(0, 1000);
  b.run(5);
  EXPECT_EQ(b.count(0x285), 0) << "6423h is off at power-on";
  EXPECT_EQ(b.read(0x6401, 1), 1000u);
  b.write(0x6421, 1, 0x04, 1);
  b.write(0x6426, 1, 100 << 16, 4);
  b.write(0x6423, 0, 1, 1);
  b.run(5);
  ASSERT_EQ(b.count(0x285), 1);
  b.seen.clear();
  b.module.set_analogue(0, 1099);
  b.run(5);
  EXPECT_EQ(b.count(0x285), 0);
  b.module.set_analogue(0, 900);
  b.run(5);
  const auto f = b.take(0x285);
  ASSERT_TRUE(f);
  EXPECT_EQ(f->length, 8);
  EXPECT_EQ(f->data[0] | f->data[1] << 8, 900);
}

TEST(IoModule, outputs_follow_the_bus_with_polarity_and_mask) {
  IoBench b;
  b.start();
  b.send(0x205, {0x05, 0x80});
  b.run(3);
  EXPECT_TRUE(b.module.digital(0));
  EXPECT_FALSE(b.module.digital(1));
  EXPECT_TRUE(b.module.digital(15));
  b.write(0x6202, 1, 0x01, 1);
  EXPECT_FALSE(b.module.digital(0));
  b.write(0x6208, 1, 0x02, 1);
  b.send(0x205, {0x02, 0x00});
  b.run(3);
  EXPECT_TRUE(b.module.digital(1));
  EXPECT_TRUE(b.module.digital(2)) << "the mask keeps it";
  b.send(0x305, {0x18, 0xFC, 0x10, 0x00});
  b.run(3);
  EXPECT_EQ(b.module.analogue(0), -1000);
  EXPECT_EQ(b.module.analogue(1), 16);
}

TEST(IoModule, outputs_have_their_error_values_when_the_master_is_gone_until_they_are_written_again) {
  IoBench b;
  b.write(0x6206, 1, 0x0F, 1);  // lines 0 to 3 take 6207h, the others stay
  b.write(0x6207, 1, 0x08, 1);
  b.write(0x6444, 1, 77 << 16, 4);
  b.write(0x1016, 1, 0x007F0064, 4);  // the master's heartbeat, 100 ms
  b.start();
  b.send(0x77F, {0x05});
  b.send(0x205, {0xF7, 0x00});
  b.send(0x305, {0x10, 0x27, 0x10, 0x27});
  b.run(3);
  EXPECT_TRUE(b.module.digital(0));
  EXPECT_FALSE(b.module.digital(3));
  b.run(150);
  EXPECT_FALSE(b.module.digital(0));
  EXPECT_TRUE(b.module.digital(3));
  EXPECT_TRUE(b.module.digital(7)) << "6206h says that it stays";
  EXPECT_EQ(b.module.analogue(0), 77);
  b.send(0x77F, {0x05});
  b.nmt(0x01);
  EXPECT_FALSE(b.module.digital(0)) << "being back is not being told";
  b.send(0x205, {0x01, 0x00});
  b.run(3);
  EXPECT_TRUE(b.module.digital(0));
}

TEST(IoModule, nothing_is_allocated_while_it_runs) {
  IoBench b;
  b.start();
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    b.module.set_digital(0, i % 2 == 0);
    b.now += image::kMillisecond;
    b.segment.advance_to(b.now);
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::mock
