// SPDX-License-Identifier: Apache-2.0
// The handwheel that drives a program along its path: its speed, and what it asks of the gate.
#include "kernel/cycle/plc_orders/path_wheel.hpp"

#include <gtest/gtest.h>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {
namespace {

using image::Request;
using image::RequestKind;
using image::WheelNews;

image::Place of_process(const char* name) {
  for (const image::InterfaceField& f : image::kProcessFields)
    if (f.name == name) return image::place(f, image::process_base(0));
  ADD_FAILURE() << name;
  return {};
}

/// A program under way and its wheel, in cycles of 1 ms; the gate is the test.
class PathWheelTest : public ::testing::Test {
 protected:
  PathWheelTest() {
    image_.now.period_ns = image::kMillisecond;
    program().state = image::ProcessState::running;
  }
  void declare(int source) {
    PathWheelConfig config;
    config.source = source;
    config.full = 100.0;
    config.healthy = image::Place{image::Packet::a, image::Format::bl, 7, 1};
    image_.packets.set_bit(*config.healthy, true);
    wheel_.configure(config, 0);
    image_.packets.set_bit(of_process("path_wheel"), true);
  }
  image::ProcessStatus& program() { return image_.processes[0]; }
  void counter(double value) {
    image_.packets.set_number(image::field(image::kMachineFields, "handwheel1", image::kMachineBase), value);
  }
  Request cycle(Refusal answer = Refusal::none) {
    Request request;
    wheel_.read(image_);
    if (wheel_.next(request, image_)) {
      image::Answer a;
      a.refusal = static_cast<std::uint16_t>(answer);
      wheel_.answer(request, a);
    } else {
      request = {};
    }
    wheel_.write(image_);
    return request;
  }
  /// So many cycles, of which each tenth has `counts`; the last request.
  Request turn(int cycles, int counts) {
    Request last;
    for (int n = 0; n < cycles; ++n) {
      if (n % 10 == 0) counter(at_ += counts);
      if (const Request r = cycle(); r.kind != RequestKind::none) last = r;
    }
    return last;
  }
  double rate() { return program().wheel.rate(); }

  image::ProcessImage image_;
  PathWheel wheel_;
  double at_ = 2'147'483'600.0;  // runs over the end of its 32 bits
};

TEST_F(PathWheelTest, is_as_fast_as_it_was_turned_in_the_last_fifth_of_a_second) {
  declare(1);
  turn(300, 0);
  EXPECT_EQ(rate(), 0.0);
  for (int n = 0; n < 300; ++n) {
    if (n % 20 == 0) at_ = at_ >= 2'147'483'647.0 ? -2'147'483'648.0 : at_ + 1.0;
    counter(at_);
    cycle();
  }
  EXPECT_NEAR(rate(), 0.5, 0.1) << "50 counts a second";
  for (int n = 0; n < 250; ++n) cycle();
  EXPECT_EQ(rate(), 0.0) << "the hand rests";
}

TEST_F(PathWheelTest, takes_the_counter_as_it_is_when_it_is_chosen) {
  declare(1);
  counter(1000.0);
  cycle();
  for (int n = 0; n < 250; ++n) cycle();
  EXPECT_EQ(rate(), 0.0);
  image_.packets.set_bit(of_process("path_wheel"), false);
  cycle();
  counter(5000.0);
  cycle();
  image_.packets.set_bit(of_process("path_wheel"), true);
  for (int n = 0; n < 250; ++n) {
    cycle();
    EXPECT_EQ(rate(), 0.0);
  }
}

TEST_F(PathWheelTest, is_never_faster_than_the_programmed_feed) {
  declare(1);
  at_ = 0.0;
  turn(300, 50);
  EXPECT_GT(program().wheel.turned, 10.0);
  EXPECT_EQ(rate(), 1.0);
  turn(300, -50);
  EXPECT_EQ(rate(), -1.0);
}

TEST_F(PathWheelTest, stands_at_once_when_its_encoder_fails_and_asks_for_nothing) {
  declare(1);
  at_ = 0.0;
  turn(300, -1);
  EXPECT_NEAR(rate(), -1.0, 0.1);
  image_.packets.set_bit(image::Place{image::Packet::a, image::Format::bl, 7, 1}, false);
  program().wheel.rests = true;
  EXPECT_EQ(turn(300, -1).kind, RequestKind::none);
  EXPECT_EQ(rate(), 0.0);
  EXPECT_TRUE(program().wheel.lost);
}

TEST_F(PathWheelTest, leads_back_only_where_the_path_rests_for_it_and_on_only_where_it_has_led_back) {
  declare(1);
  at_ = 0.0;
  EXPECT_EQ(turn(300, 1).kind, RequestKind::none) << "forward is an override, no request";
  EXPECT_EQ(turn(500, -1).kind, RequestKind::none) << "the path still moves";
  program().wheel.rests = true;
  EXPECT_EQ(turn(20, -1).kind, RequestKind::retrace);
  EXPECT_TRUE(program().wheel.leads);
  program().wheel.rests = false;
  program().state = image::ProcessState::held;
  program().retraced = program().retracing = true;
  program().retraced_mm = 3.0;
  EXPECT_EQ(turn(500, 1).kind, RequestKind::none) << "the way back is still under way";
  program().retracing = false;
  EXPECT_EQ(turn(20, 1).kind, RequestKind::reposition);
  program().retraced = false;
  program().retraced_mm = 0.0;
  EXPECT_EQ(turn(20, 1).kind, RequestKind::resume);
  EXPECT_FALSE(program().wheel.leads);
  EXPECT_EQ(turn(20, 1).kind, RequestKind::none) << "what somebody else holds is not the wheel's";
}

TEST_F(PathWheelTest, asks_once_for_a_way_that_leads_nowhere) {
  declare(1);
  at_ = 0.0;
  turn(300, -1);
  program().wheel.rests = true;
  EXPECT_EQ(turn(20, -1).kind, RequestKind::retrace);
  program().wheel.rests = false;
  program().state = image::ProcessState::held;
  EXPECT_EQ(turn(300, -1).kind, RequestKind::none);
}

TEST_F(PathWheelTest, whoever_holds_or_leads_the_program_takes_it_from_the_wheel) {
  declare(1);
  at_ = 0.0;
  turn(300, -1);
  program().wheel.rests = true;
  ASSERT_EQ(turn(20, -1).kind, RequestKind::retrace);
  program().wheel.rests = false;
  program().state = image::ProcessState::held;
  program().retraced = true;
  wheel_.let_go();
  EXPECT_EQ(turn(300, -1).kind, RequestKind::none);
  EXPECT_EQ(turn(500, 1).kind, RequestKind::none);
}

TEST_F(PathWheelTest, of_a_pendant_is_lost_until_it_is_plugged_in) {
  declare(PathWheelConfig::kPendant);
  const auto news = [&](WheelNews what, double value) {
    Request r;
    r.kind = RequestKind::path_wheel;
    r.index = static_cast<std::uint32_t>(what);
    r.value = value;
    wheel_.take(r);
  };
  news(WheelNews::turned, 20.0);
  for (int n = 0; n < 100; ++n) cycle();
  EXPECT_TRUE(program().wheel.lost);
  EXPECT_EQ(rate(), 0.0);
  news(WheelNews::here, 1.0);
  for (int n = 0; n < 100; ++n) cycle();
  EXPECT_EQ(rate(), 0.0) << "what it said before counts for nothing";
  news(WheelNews::turned, 10.0);
  for (int n = 0; n < 100; ++n) cycle();
  EXPECT_NEAR(rate(), 0.5, 1e-9);
}

TEST_F(PathWheelTest, that_no_machine_file_declares_is_refused_and_drives_nothing) {
  image_.packets.set_bit(of_process("path_wheel"), true);
  turn(300, 1);
  EXPECT_FALSE(program().wheel.chosen);
  EXPECT_EQ(image_.packets.number(of_process("path_wheel_refusal")),
            static_cast<double>(Refusal::no_path_wheel));
}

}  // namespace
}  // namespace servogate::cycle
