// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/board_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "drivers/mock/board/simulated_board.hpp"
#include "firmware_if/board/master/board_alarms.hpp"
#include "firmware_if/image/alarms/alarm_text.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::board {
namespace {

using image::DriveState;
using mock::AmplifierConfig;

constexpr image::Nanoseconds kPeriod = image::kMillisecond;
constexpr std::int64_t kCounts = 4000;  ///< a turn

image::Place bit(std::uint16_t n) { return *image::parse_place("SA" + std::to_string(n)); }

/// A control of two axes without a kernel: what it commands, the test says.
class BoardDeviceTest : public ::testing::Test {
 protected:
  void build() {
    mock::SimulatedBoardConfig simulated;
    simulated.amplifiers[0] = stepper_;
    simulated.amplifiers[1] = amplifier_;
    board_ = std::make_unique<mock::SimulatedBoard>(simulated);
    BoardConfig config;
    config.watchdog_us = 20'000;
    config.source = 0;
    config.channels[0] = {Output::step, false, 5, 100'000, 0};
    config.channels[1] = {Output::analog, false, 0, 0, 0};
    AxisLinkConfig step;
    step.axis = 0;
    step.channel = 0;
    step.steps = stepper_.steps_per_rev;
    step.counts = kCounts;
    step.encoder = encoder_;
    if (!encoder_) step.steps = step.counts = 1;
    step.quick_stop = 200'000.0;
    AxisLinkConfig volts;
    volts.axis = 1;
    volts.channel = 1;
    volts.output = Output::analog;
    volts.full_scale_counts_s = 50.0 * kCounts;
    volts.position_gain = 60.0;
    volts.quick_stop = 200'000.0;
    volts.reversed = amplifier_.reversed;
    config.axes = {step, volts};
    config.points.push_back({PointKind::input, 3, {bit(0)}, true});
    config.points.push_back({PointKind::output, 5, {bit(64), false}, false});
    config.points.back().rule.loss = 1.0;
    device_ = std::make_unique<BoardDevice>(config, std::make_unique<mock::MockBoardPort>(*board_));
    image_.axis_count = 2;
    image_.now.period_ns = kPeriod;
  }

  void cycle() {
    image_.now.t_ns += kPeriod;
    ++image_.now.number;
    board_->advance_to(image_.now.t_ns);
    image_.edges.clear();
    device_->receive(image_, notices_);
    for (int a = 0; a < 2; ++a) {
      image::DriveCommand& c = image_.axes[static_cast<std::size_t>(a)].drive_command;
      const image::DriveFeedback& f = feedback(a);
      c.power = power_;
      // As an axis does: off, the set-point is where it stands.
      if (f.state != DriveState::operation_enabled && f.state != DriveState::quick_stop_active)
        c.position_counts = f.position_counts;
    }
    if (move_) move_();
    device_->send(image_);
  }
  void cycles(int count) {
    for (int n = 0; n < count; ++n) cycle();
  }
  const image::DriveFeedback& feedback(int axis) { return image_.axes[static_cast<std::size_t>(axis)].drive; }
  image::DriveCommand& command(int axis) { return image_.axes[static_cast<std::size_t>(axis)].drive_command; }
  void enable() {
    build();
    cycles(10);
    power_ = true;
    cycles(5);
    for (int a = 0; a < 2; ++a) ASSERT_EQ(feedback(a).state, DriveState::operation_enabled) << a;
  }

  /// The newest notice in words.
  std::string said() const {
    static const image::AlarmTable table{alarm_room()};
    image::AlarmNames names;
    names.table = &table;
    names.sources = {"board"};
    return image::render(notices_.records().back(), names, text::Language::english);
  }

  AmplifierConfig stepper_{.counts_per_rev = kCounts, .steps_per_rev = 1000};
  AmplifierConfig amplifier_{.counts_per_rev = kCounts};
  bool encoder_ = true;
  std::unique_ptr<mock::SimulatedBoard> board_;
  std::unique_ptr<BoardDevice> device_;
  image::ProcessImage image_{};
  image::Notices notices_;
  bool power_ = false;
  std::function<void()> move_;
};

TEST_F(BoardDeviceTest, is_described_configured_and_commanded) {
  build();
  EXPECT_FALSE(feedback(0).online);
  cycles(10);
  EXPECT_EQ(device_->session().state(), SessionState::running);
  EXPECT_TRUE(feedback(0).online);
  EXPECT_EQ(feedback(0).state, DriveState::switch_on_disabled);
  EXPECT_EQ(image_.sources[0].quality, image::Quality::good);
  EXPECT_FALSE(board_->amplifier(0)->enabled());
}

TEST_F(BoardDeviceTest, an_axis_follows_its_set_point_as_steps_and_as_volts) {
  enable();
  double t = 0.0, worst_step = 0.0, worst_volts = 0.0;
  const std::int64_t from0 = feedback(0).position_counts, from1 = feedback(1).position_counts;
  std::array<std::array<std::int64_t, 3>, 2> sent{};
  for (auto& s : sent) s = {0, 0, 0};
  move_ = [&] {
    t += 0.001;
    const double turns = 0.5 - 0.5 * std::cos(2.0 * M_PI * t);
    for (int a = 0; a < 2; ++a) {
      auto& s = sent[static_cast<std::size_t>(a)];
      const std::int64_t base = a == 0 ? from0 : from1;
      const double error = static_cast<double>(s[1] - (feedback(a).position_counts - base)) / kCounts;
      if (t > 0.01)
        (a == 0 ? worst_step : worst_volts) = std::max(a == 0 ? worst_step : worst_volts, std::abs(error));
      s = {std::lround(turns * kCounts), s[0], s[1]};
      command(a).position_counts = base + s[0];
    }
  };
  cycles(2000);
  EXPECT_LT(worst_step, 0.002) << "two steps of a thousand";
  EXPECT_LT(worst_volts, 0.02) << "the lag of the amplifier";
  EXPECT_NEAR(static_cast<double>(feedback(0).velocity_counts_s), 0.0, 600.0);
}

TEST_F(BoardDeviceTest, the_position_loop_takes_out_the_drift_of_an_amplifier) {
  amplifier_.drift = 0.002;
  enable();
  const std::int64_t goal = feedback(1).position_counts;
  move_ = [&] { command(1).position_counts = goal; };
  cycles(1000);
  // Proportional: the drift of 400 counts/s stands against a gain of 60 1/s.
  EXPECT_NEAR(static_cast<double>(feedback(1).position_counts - goal), 400.0 / 60.0, 1.5);
}

TEST_F(BoardDeviceTest, a_reversed_amplifier_is_turned_round) {
  amplifier_.reversed = true;
  enable();
  const std::int64_t from = feedback(1).position_counts;
  std::int64_t way = 0;
  move_ = [&] { command(1).position_counts = from + std::min<std::int64_t>(way += 4, 2000); };
  cycles(1500);
  EXPECT_NEAR(static_cast<double>(feedback(1).position_counts - from), 2000.0, 3.0);
}

TEST_F(BoardDeviceTest, without_an_encoder_the_steps_are_the_position) {
  encoder_ = false;
  enable();
  std::int64_t way = 0;
  move_ = [&] { command(0).position_counts = way += 5; };
  cycles(1000);
  EXPECT_NEAR(static_cast<double>(feedback(0).position_counts), 5000.0, 15.0);
}

TEST_F(BoardDeviceTest, steps_that_were_lost_show_as_a_following_error) {
  stepper_.pull_out = 3.0;
  enable();
  std::int64_t way = 0;
  move_ = [&] { command(0).position_counts = way += 20; };  // 5 rev/s
  cycles(500);
  EXPECT_GT(board_->amplifier(0)->lost_steps(), 0);
  EXPECT_GT(way - feedback(0).position_counts, 1000);
}

TEST_F(BoardDeviceTest, an_amplifier_in_fault_is_a_drive_in_fault_and_loses_its_enable) {
  enable();
  board_->amplifier(1)->fault = true;
  cycles(3);
  EXPECT_EQ(feedback(1).state, DriveState::fault);
  EXPECT_EQ(feedback(1).error_code, kErrorFaultInput);
  EXPECT_EQ(feedback(0).state, DriveState::operation_enabled);
  cycles(2);
  EXPECT_FALSE(board_->amplifier(1)->enabled());
}

TEST_F(BoardDeviceTest, a_quick_stop_is_a_ramp_and_then_the_enable_goes) {
  enable();
  std::int64_t way = 0;
  bool stop = false;
  move_ = [&] {
    for (int a = 0; a < 2; ++a) {
      command(a).position_counts = way;
      command(a).quick_stop = stop;
    }
    way += 20;  // 20 000 counts/s
  };
  cycles(300);
  stop = true;
  const std::int64_t at0 = feedback(0).position_counts;
  cycles(3);
  EXPECT_EQ(feedback(0).state, DriveState::quick_stop_active);
  cycles(200);
  // 20 000 counts/s against 200 000 counts/s2: 1000 counts, and the dead time.
  EXPECT_NEAR(static_cast<double>(feedback(0).position_counts - at0), 1000.0 + 40.0, 60.0);
  EXPECT_FALSE(board_->amplifier(0)->enabled());
  EXPECT_FALSE(board_->amplifier(1)->enabled());
  EXPECT_EQ(feedback(0).state, DriveState::switch_on_disabled);
}

TEST_F(BoardDeviceTest, unplugged_it_drops_its_outputs_and_its_axes_are_offline) {
  enable();
  image_.packets.set_bit(bit(64), false);
  cycles(3);
  ASSERT_FALSE(board_->output(5));
  board_->plug(false);
  cycles(30);
  EXPECT_TRUE(board_->output(5)) << "its value of loss";
  EXPECT_FALSE(board_->amplifier(0)->enabled());
  EXPECT_EQ(feedback(0).state, DriveState::offline);
  EXPECT_FALSE(feedback(0).online);
  EXPECT_EQ(image_.sources[0].quality, image::Quality::bad);
  const std::uint8_t restarts = feedback(0).restarts;
  power_ = false;
  board_->plug(true);
  cycles(250);
  EXPECT_TRUE(feedback(0).online);
  EXPECT_NE(feedback(0).restarts, restarts) << "its counters may have begun anew";
  EXPECT_EQ(image_.sources[0].quality, image::Quality::good);
}

TEST_F(BoardDeviceTest, a_board_that_lost_its_voltage_is_configured_again_and_stays_off) {
  enable();
  board_->restart();
  cycles(3);
  EXPECT_FALSE(feedback(0).online);
  power_ = false;
  cycles(250);
  EXPECT_EQ(device_->session().state(), SessionState::running);
  EXPECT_FALSE(board_->amplifier(0)->enabled());
}

TEST_F(BoardDeviceTest, an_edge_has_the_time_at_which_it_happened) {
  build();
  cycles(300);
  const image::Nanoseconds at = image_.now.t_ns + 377 * image::kMicrosecond;
  board_->set_input(3, true, at);
  cycles(1);
  std::size_t edges = image_.edges.list().size();
  if (edges == 0) {
    cycles(1);
    edges = image_.edges.list().size();
  }
  ASSERT_EQ(edges, 1u);
  EXPECT_TRUE(image_.edges.list()[0].level);
  EXPECT_NEAR(static_cast<double>(image_.edges.list()[0].t_ns - at), 0.0, 1000.0) << "a microsecond";
  EXPECT_TRUE(image_.packets.bit(bit(0)));
}

TEST_F(BoardDeviceTest, what_it_cannot_do_is_refused_and_stays_off) {
  mock::SimulatedBoardConfig simulated;
  board_ = std::make_unique<mock::SimulatedBoard>(simulated);
  BoardConfig config;
  config.source = 0;
  config.channels[2].output = Output::step;
  device_ = std::make_unique<BoardDevice>(config, std::make_unique<mock::MockBoardPort>(*board_));
  image_.now.period_ns = kPeriod;
  cycles(1100);
  EXPECT_EQ(device_->session().state(), SessionState::refused);
  EXPECT_EQ(device_->session().refused().why, RefusedFor::channel);
  EXPECT_EQ(device_->session().refused().wanted, 2u);
  EXPECT_EQ(image_.sources[0].quality, image::Quality::bad);
  ASSERT_EQ(notices_.records().size(), 1u) << "told once";
  EXPECT_EQ(said(), "board: the board refuses what the machine file asks of it: it has no channel 2");
  cycles(1100);
  EXPECT_EQ(notices_.records().size(), 2u) << "asked again after two seconds";
}

TEST_F(BoardDeviceTest, lines_encoders_and_steps_that_it_does_not_have_are_named) {
  struct Case {
    std::function<void(BoardConfig&)> wants;
    const char* words;
  };
  const Case cases[] = {
      {[](BoardConfig& c) {
         c.points.push_back({PointKind::input, 20, {bit(0)}, false});
       },
       "21 digital inputs are used, it has 16"},
      {[](BoardConfig& c) {
         c.points.push_back({PointKind::output, 9, {bit(64)}, false});
       },
       "10 digital outputs are used, it has 8"},
      {[](BoardConfig& c) {
         c.points.push_back({PointKind::analog_input, 3, {bit(0)}, false});
       },
       "4 analog inputs are used, it has 0"},
      {[](BoardConfig& c) { c.axes.push_back({.axis = 0, .channel = 0}); }, "its channel 0 has no encoder"},
      {[](BoardConfig& c) { c.step_rate = 50'000; }, "the fastest axis needs 50000 steps/s, it makes 10000"},
  };
  for (const Case& each : cases) {
    BoardConfig config;
    config.source = 0;
    each.wants(config);
    Session session(configuration(config), needs(config));
    std::array<std::uint8_t, kMostBytes> buffer{};
    ASSERT_GT(session.next({}, image::kSecond, buffer), 0u);
    Description has;
    has.inputs = 16, has.outputs = 8, has.max_step_rate = 10'000;
    const std::size_t size = put({Kind::description, 1}, has, buffer);
    session.take({buffer.data(), size}, image::kSecond);
    EXPECT_EQ(session.state(), SessionState::refused) << each.words;
    notices_.clear();
    notices_.add(refused_alarm(session, 0));
    EXPECT_EQ(said(),
              std::string("board: the board refuses what the machine file asks of it: ") + each.words);
  }
}

TEST_F(BoardDeviceTest, a_cycle_allocates_nothing) {
  enable();
  const auto before = counting::allocations();
  cycles(100);
  EXPECT_EQ(counting::allocations(), before);
}

TEST_F(BoardDeviceTest, leaving_it_drops_everything) {
  enable();
  device_.reset();
  EXPECT_FALSE(board_->amplifier(0)->enabled());
  EXPECT_FALSE(board_->amplifier(1)->enabled());
}

}  // namespace
}  // namespace servogate::board
