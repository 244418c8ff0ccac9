// SPDX-License-Identifier: Apache-2.0
// The master of a Modbus line as pure state: no wire, no clock.
#include "firmware_if/modbus/poller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "firmware_if/modbus/coalesce.hpp"

namespace servogate::modbus {
namespace {

using image::kMillisecond;
using image::Nanoseconds;

Block read_of(std::uint8_t unit, Nanoseconds period = 20 * kMillisecond) {
  return {unit, Function::read_discrete_inputs, 0, 16, period};
}
Block write_of(std::uint8_t unit, Nanoseconds period = 20 * kMillisecond) {
  return {unit, Function::write_multiple_coils, 0, 16, period};
}

/// Carries a poller over a wire on which each transaction takes a millisecond.
struct Wire {
  explicit Wire(std::vector<Block> blocks, PollSettings settings = {}) : poller(settings, std::move(blocks)) {
    poller.start_at(0);
  }
  /// Until `until`; units in `dead` are silent for `patience`.
  void run(Nanoseconds until) {
    for (;;) {
      const auto next = poller.next(idle);
      if (!next || next->start_ns >= until) return;
      const Request& request = poller.begin(*next);
      const Block& block = poller.blocks()[next->block];
      order += static_cast<char>('a' + next->block);
      const bool silent = dead.find(static_cast<char>('0' + block.unit)) != std::string::npos;
      idle = next->start_ns + (silent ? patience : kMillisecond);
      Response response;
      response.function = request.function;
      response.exception = refuses ? Exception::server_device_busy : Exception::none;
      last = silent ? poller.unanswered(idle) : poller.answered(response, idle);
    }
  }
  Poller poller;
  std::string order, dead;
  bool refuses = false;
  Nanoseconds idle = 0, patience = 10 * kMillisecond;
  Outcome last;
};

TEST(ModbusPoller, asks_each_block_at_its_period_and_writes_nothing_before_it_has_something) {
  Wire wire({read_of(1), write_of(1), read_of(1, 40 * kMillisecond)});
  wire.run(80 * kMillisecond);
  EXPECT_EQ(wire.order, "caacaa");
}

TEST(ModbusPoller, writes_a_change_at_once_and_then_again_at_the_period) {
  Wire wire({read_of(1, 200 * kMillisecond), write_of(1, 50 * kMillisecond)});
  wire.run(10 * kMillisecond);
  wire.order.clear();
  Data data;
  data.set_bit(3, true);
  wire.poller.write(1, data, 10 * kMillisecond);
  wire.run(12 * kMillisecond);
  EXPECT_EQ(wire.order, "b");
  wire.run(190 * kMillisecond);
  EXPECT_EQ(wire.order, "bbbb");
}

TEST(ModbusPoller, repeats_what_was_not_answered_and_then_leaves_the_unit_alone) {
  PollSettings settings;
  settings.retries = 2;
  settings.lost_retry_ns = 500 * kMillisecond;
  Wire wire({read_of(1)}, settings);
  wire.dead = "1";
  wire.run(400 * kMillisecond);
  EXPECT_EQ(wire.order, "aaa");
  EXPECT_TRUE(wire.poller.lost(1));
  EXPECT_EQ(wire.poller.errors(1), 3u);
  wire.run(600 * kMillisecond);
  EXPECT_EQ(wire.order, "aaaa") << "once, and not repeated";
  wire.dead.clear();
  wire.run(1100 * kMillisecond);
  EXPECT_FALSE(wire.poller.lost(1));
  EXPECT_GT(wire.order.size(), 6u) << "and at its period again";
}

TEST(ModbusPoller, a_dead_unit_costs_its_neighbour_its_patience_and_no_more) {
  Wire wire({read_of(1), read_of(2)}, {0, 500 * kMillisecond});
  wire.dead = "1";
  wire.run(2000 * kMillisecond);
  EXPECT_NEAR(static_cast<double>(std::count(wire.order.begin(), wire.order.end(), 'b')), 100.0, 3.0);
  EXPECT_LE(std::count(wire.order.begin(), wire.order.end(), 'a'), 5);
}

TEST(ModbusPoller, an_exception_is_an_answer_and_is_not_repeated) {
  Wire wire({read_of(1)});
  wire.refuses = true;
  wire.run(90 * kMillisecond);
  EXPECT_EQ(wire.order, "aaaaa");
  EXPECT_FALSE(wire.poller.lost(1));
  EXPECT_FALSE(wire.last.good);
  EXPECT_EQ(wire.last.exception, Exception::server_device_busy);
  EXPECT_EQ(wire.poller.last_exception(1), Exception::server_device_busy);
}

TEST(ModbusPoller, leaves_blocks_alone_that_a_late_answer_could_be_taken_for) {
  Block second = read_of(1), other = read_of(1), neighbour = read_of(2);
  second.address = 16;
  other.function = Function::read_input_registers;
  PollSettings settings;
  settings.late_ns = 1000 * kMillisecond;
  Wire wire({read_of(1), second, other, neighbour}, settings);
  wire.dead = "1";
  wire.run(kMillisecond);
  EXPECT_EQ(wire.order, "b") << "the round begins behind the first block";
  wire.dead.clear();
  wire.run(900 * kMillisecond);
  EXPECT_EQ(std::count(wire.order.begin(), wire.order.end(), 'a'), 0) << "its answer looks like that of b";
  EXPECT_EQ(std::count(wire.order.begin(), wire.order.end(), 'b'), 2) << "once more at once";
  EXPECT_GT(std::count(wire.order.begin(), wire.order.end(), 'c'), 30);
  EXPECT_GT(std::count(wire.order.begin(), wire.order.end(), 'd'), 30);
  wire.run(1500 * kMillisecond);
  EXPECT_GT(std::count(wire.order.begin(), wire.order.end(), 'a'), 10);
  EXPECT_GT(std::count(wire.order.begin(), wire.order.end(), 'b'), 10);
}

TEST(ModbusPoller, an_output_that_was_not_taken_is_written_again) {
  Wire wire({write_of(1, 1000 * kMillisecond)}, {0, 30 * kMillisecond});
  Data data;
  data.set_bit(0, true);
  wire.poller.write(0, data, 0);
  wire.dead = "1";
  wire.run(100 * kMillisecond);
  const std::size_t tried = wire.order.size();
  EXPECT_GE(tried, 1u);
  wire.dead.clear();
  wire.run(2100 * kMillisecond);
  EXPECT_GT(wire.order.size(), tried);
  EXPECT_TRUE(wire.last.good);
}

TEST(ModbusCoalesce, makes_one_read_of_what_touches_or_overlaps_whatever_the_order) {
  const Range ranges[] = {{Function::read_input_registers, 10, 4},
                          {Function::read_discrete_inputs, 14, 8},
                          {Function::read_input_registers, 20, 4},
                          {Function::read_input_registers, 14, 7},
                          {Function::read_input_registers, 30, 0}};
  const auto blocks = coalesce(ranges, 3, 20 * kMillisecond);
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].function, Function::read_discrete_inputs);
  EXPECT_EQ(blocks[1].address, 10);
  EXPECT_EQ(blocks[1].count, 14);
  EXPECT_EQ(blocks[1].unit, 3);
  const auto spot = spot_of(blocks, Function::read_input_registers, 21);
  ASSERT_TRUE(spot.has_value());
  EXPECT_EQ(spot->block, 1u);
  EXPECT_EQ(spot->offset, 11);
  EXPECT_FALSE(spot_of(blocks, Function::read_input_registers, 24).has_value());
}

TEST(ModbusCoalesce, keeps_writes_apart_and_to_what_one_transaction_carries) {
  const Range ranges[] = {{Function::write_multiple_registers, 0, 2},
                          {Function::write_multiple_registers, 2, 2},
                          {Function::read_holding_registers, 65400, 136}};
  const auto blocks = coalesce(ranges, 1, 20 * kMillisecond);
  ASSERT_EQ(blocks.size(), 4u);
  EXPECT_EQ(blocks[2].count, kMaxReadWords);
  EXPECT_EQ(blocks[3].address, 65400 + kMaxReadWords);
  EXPECT_EQ(blocks[3].count, 11);
}

}  // namespace
}  // namespace servogate::modbus
