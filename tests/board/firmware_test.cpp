// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/firmware/firmware.hpp"

#include <gtest/gtest.h>

#include "drivers/mock/board/simulated_board.hpp"

namespace servogate::board {
namespace {

using mock::SimulatedBoard;
using mock::SimulatedBoardConfig;

class BoardFirmware : public ::testing::Test {
 protected:
  BoardFirmware() {
    SimulatedBoardConfig config;
    config.amplifiers[0] = mock::AmplifierConfig{.counts_per_rev = 4000, .steps_per_rev = 1000};
    config.amplifiers[1] = mock::AmplifierConfig{.counts_per_rev = 4000};
    config.inputs = config.outputs = 8;
    board_ = std::make_unique<SimulatedBoard>(config);
    configuration_.channels[0] = {Output::step, false, 5, 100'000, 0};
    configuration_.channels[1] = {Output::analog, false, 0, 0, 0};
    configuration_.safe_outputs = 0x80;
    configuration_.edge_mask = 0x01;
  }

  template <class Body>
  Message ask(Kind kind, const Body& body) {
    const std::size_t size = put({kind, ++sequence_}, body, buffer_);
    return heard({buffer_.data(), size});
  }
  Message ask(Kind kind) { return heard({buffer_.data(), put({kind, ++sequence_}, buffer_)}); }
  Message heard(std::span<const std::uint8_t> message) {
    Message m;
    EXPECT_TRUE(parse(board_->exchange(message), m));
    return m;
  }
  Configured configure() {
    Configured c;
    EXPECT_TRUE(take(ask(Kind::configure, configuration_).body, c));
    return c;
  }
  Status cycle(int count = 1) {
    Status s;
    for (int n = 0; n < count; ++n) {
      EXPECT_TRUE(take(ask(Kind::cycle, command_).body, s));
      pass(1);
    }
    return s;
  }
  void pass(int milliseconds) { board_->advance_to(t_ += milliseconds * image::kMillisecond); }

  std::unique_ptr<SimulatedBoard> board_;
  Configuration configuration_;
  Command command_;
  std::uint32_t sequence_ = 0;
  image::Nanoseconds t_ = 0;
  std::array<std::uint8_t, kMostBytes> buffer_{};
};

TEST_F(BoardFirmware, says_what_it_is_and_has) {
  Description d;
  ASSERT_TRUE(take(ask(Kind::describe).body, d));
  EXPECT_EQ(d.protocol, kProtocolVersion);
  EXPECT_EQ(d.inputs, 8);
  EXPECT_NE(d.capabilities[0], 0);
  EXPECT_EQ(d.capabilities[2], 0);
  EXPECT_EQ(d.max_step_rate, 25'000u);
}

TEST_F(BoardFirmware, obeys_no_command_before_it_is_configured) {
  const Message m = ask(Kind::cycle, command_);
  Refusal r;
  ASSERT_EQ(m.header.kind, Kind::refused);
  ASSERT_TRUE(take(m.body, r));
  EXPECT_EQ(r.reason, Reason::not_configured);
}

TEST_F(BoardFirmware, refuses_a_configuration_that_it_cannot_carry_out_and_names_the_channel) {
  configuration_.watchdog_us = 0;
  EXPECT_EQ(configure().result, ConfigureResult::no_watchdog);
  configuration_.watchdog_us = 1000;
  configuration_.channels[3].output = Output::step;
  const Configured c = configure();
  EXPECT_EQ(c.result, ConfigureResult::no_such_channel);
  EXPECT_EQ(c.channel, 3);
  EXPECT_EQ(ask(Kind::cycle, command_).header.kind, Kind::refused);
}

TEST_F(BoardFirmware, turns_a_stepper_and_a_speed_amplifier) {
  configure();
  command_.enable = 3;
  cycle();
  for (int n = 0; n < 1000; ++n) {
    command_.channels[0].target += 2;
    command_.channels[0].rate = 2000;
    command_.channels[1].target = kFullScale / 10;
    cycle();
  }
  const Status s = cycle();
  EXPECT_NEAR(s.channels[0].steps, 2000, 2);
  EXPECT_NEAR(s.channels[0].counts, 8000, 8);
  EXPECT_NEAR(s.channels[1].counts, 0.1 * 50.0 * 4000 * 1.0, 0.02 * 20'000);
  EXPECT_EQ(s.enabled, 3);
}

TEST_F(BoardFirmware, drops_everything_when_commands_stay_away_until_it_is_told_to_go_on) {
  configure();
  command_.enable = 2;
  command_.outputs = 0x03;
  command_.analog[0] = 1000;
  command_.channels[1].target = 3000;
  cycle(50);
  ASSERT_TRUE(board_->output(0));
  pass(19);
  EXPECT_FALSE(board_->firmware().tripped());
  pass(2);
  EXPECT_TRUE(board_->firmware().tripped());
  EXPECT_FALSE(board_->output(0));
  EXPECT_TRUE(board_->output(7));
  EXPECT_EQ(board_->analog_output(0), 0);
  EXPECT_FALSE(board_->amplifier(1)->enabled());
  Status s = cycle();
  EXPECT_EQ(s.flags & kTripped, kTripped);
  EXPECT_EQ(s.trips, 1);
  EXPECT_FALSE(board_->output(0)) << "a command alone does not end a trip";
  command_.flags = kResetTrip;
  s = cycle();
  EXPECT_EQ(s.flags & kTripped, 0);
  EXPECT_TRUE(board_->output(0));
}

TEST_F(BoardFirmware, waits_for_the_first_command_without_tripping) {
  configure();
  pass(500);
  EXPECT_FALSE(board_->firmware().tripped());
}

TEST_F(BoardFirmware, drops_everything_when_the_control_leaves) {
  configure();
  command_.enable = 3;
  command_.outputs = 1;
  cycle(3);
  EXPECT_EQ(ask(Kind::leave).header.kind, Kind::left);
  EXPECT_FALSE(board_->output(0));
  EXPECT_FALSE(board_->amplifier(0)->enabled());
  EXPECT_EQ(ask(Kind::cycle, command_).header.kind, Kind::refused);
}

TEST_F(BoardFirmware, tells_edges_with_their_times_and_counts_those_without_room) {
  configure();
  cycle();
  board_->set_input(0, true, t_ + 123 * image::kMicrosecond);
  board_->set_input(1, true, t_);  // not asked for
  pass(1);
  Status s = cycle();
  ASSERT_EQ(s.edge_count, 1);
  EXPECT_EQ(s.edges[0].input, 0);
  EXPECT_TRUE(s.edges[0].level);
  EXPECT_EQ(s.edges[0].t_us, 1123u);
  EXPECT_EQ(s.inputs & 3u, 3u);
  for (int n = 0; n < 50; ++n) board_->set_input(0, n % 2 != 0, t_);
  s = cycle();
  EXPECT_EQ(s.edge_count, kEdges);
  EXPECT_EQ(s.lost_edges, 50 - 32);
}

TEST_F(BoardFirmware, captures_the_counter_at_the_index) {
  configure();
  command_.enable = 2;
  command_.latch = 2;
  command_.channels[1].target = kFullScale / 50;  // 1 rev/s
  Status s;
  int cycles = 0;
  while (s.channels[1].latches == 0 && ++cycles < 3000) s = cycle();
  EXPECT_EQ(s.channels[1].latches, 1);
  EXPECT_EQ(s.channels[1].latched, 4000);
  s = cycle(1500);
  EXPECT_EQ(s.channels[1].latches, 1) << "one capture for each time it is armed";
}

TEST_F(BoardFirmware, reports_the_fault_line_of_an_amplifier_of_either_polarity) {
  configure();
  EXPECT_EQ(cycle().faults, 0);
  board_->amplifier(1)->fault = true;
  EXPECT_EQ(cycle().faults, 2);
  configuration_.channels[1].fault_is_low = true;
  configure();
  EXPECT_EQ(cycle().faults, 0);
}

TEST_F(BoardFirmware, puts_faults_onto_its_lines) {
  configure();
  cycle();
  EXPECT_TRUE(board_->inject({Fault::input_high, 3, 0}));
  EXPECT_TRUE(board_->inject({Fault::output_high, 2, 0}));
  EXPECT_TRUE(board_->inject({Fault::analog_value, 1, -500}));
  EXPECT_TRUE(board_->inject({Fault::drive_fault, 0, 0}));
  EXPECT_TRUE(board_->inject({Fault::encoder_jump, 1, 1000}));
  EXPECT_FALSE(board_->inject({Fault::input_high, 8, 0})) << "it has 8 inputs";
  EXPECT_FALSE(board_->inject({Fault::encoder_stuck, 2, 0})) << "there is no such channel";
  Status s = cycle();
  EXPECT_EQ(s.flags & kInjected, kInjected);
  EXPECT_EQ(s.inputs, 8u);
  EXPECT_TRUE(board_->output(2));
  EXPECT_EQ(s.analog[1], -500);
  EXPECT_EQ(s.faults, 1);
  EXPECT_EQ(s.channels[1].counts, 1000);
  EXPECT_TRUE(board_->inject({Fault::input_chatter, 4, 500}));
  int changes = 0;
  std::uint32_t last = 0;
  for (int n = 0; n < 20; ++n) {
    board_->advance_to(t_ += 250 * image::kMicrosecond);
    Status now;
    EXPECT_TRUE(take(ask(Kind::cycle, command_).body, now));
    changes += (now.inputs ^ last) >> 4 & 1u ? 1 : 0;
    last = now.inputs;
  }
  EXPECT_GE(changes, 9);
  EXPECT_TRUE(board_->inject({Fault::none, 255, 0}));
  s = cycle();
  EXPECT_EQ(s.flags & kInjected, 0);
  EXPECT_EQ(s.inputs, 0u);
}

TEST_F(BoardFirmware, answers_whatever_is_sent_to_it) {
  configure();
  for (std::size_t size = 0; size < 70; ++size) {
    std::array<std::uint8_t, 70> bytes{};
    bytes[0] = kMark;
    bytes[1] = static_cast<std::uint8_t>(size % 7);
    bytes[2] = static_cast<std::uint8_t>(size);
    Message m;
    EXPECT_TRUE(parse(board_->exchange({bytes.data(), size}), m));
  }
}

}  // namespace
}  // namespace servogate::board
