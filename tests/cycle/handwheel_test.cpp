// SPDX-License-Identifier: Apache-2.0
// What the counter of a handwheel becomes: requests to the gate.
#include "kernel/cycle/plc_orders/handwheel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {
namespace {

using image::Request;
using image::RequestKind;

/// One axis that stands, with its handwheel; the gate is the test.
class HandwheelTest : public ::testing::Test {
 protected:
  HandwheelTest() {
    axis::AxisConfig config;
    config.homing.method = axis::HomingMethod::absolute;
    config.jog_velocity = 50.0;
    config.limits = {100.0, 1000.0, 10000.0};
    axis_.configure(config, 0);
    axis_.set_reference(0);
    step(0.01);
  }
  void place(const image::Place& p, double value) { ASSERT_TRUE(image_.packets.set_number(p, value)); }
  void select(int number) {
    place(image::at(image::field(image::kAxisFields, "handwheel"), image::axis_base(0)), number);
  }
  void counter(double value) {
    place(image::field(image::kMachineFields, "handwheel1", image::kMachineBase), value);
  }
  void step(double value) {
    image_.packets.set_number(image::field(image::kMachineFields, "handwheel1_step", image::kMachineBase),
                              value);
  }
  /// One cycle: the request, kind none where there is none; `answer` is the gate's.
  Request cycle(Refusal answer = Refusal::none) {
    Request request;
    wheel_.read(image_, 0);
    if (!wheel_.next(request, axis_)) request = {};
    if (request.kind != RequestKind::none) {
      image::Answer a;
      a.refusal = static_cast<std::uint16_t>(answer);
      wheel_.answer(request, a);
    }
    wheel_.write(image_);
    return request;
  }
  double refusal() const {
    return image_.packets.number(
        image::at(image::field(image::kAxisFields, "handwheel_refusal"), image::axis_base(0)));
  }

  image::ProcessImage image_;
  axis::Axis axis_;
  Handwheel wheel_;
};

TEST_F(HandwheelTest, asks_for_what_was_turned_since_the_axis_selected_it) {
  select(1);
  counter(4711);
  EXPECT_EQ(cycle().kind, RequestKind::none) << "the first scan";
  EXPECT_EQ(cycle().kind, RequestKind::none) << "nothing turned";
  counter(4714);
  const Request request = cycle();
  EXPECT_EQ(request.kind, RequestKind::jog_increment);
  EXPECT_EQ(request.asker, image::Asker::plc);
  EXPECT_EQ(request.axis, 0);
  EXPECT_NEAR(request.value, 0.03, 1e-6);
  EXPECT_EQ(cycle().kind, RequestKind::none) << "counts act once";
  counter(4713);
  EXPECT_NEAR(cycle().value, -0.01, 1e-6);
}

TEST_F(HandwheelTest, does_not_count_what_was_turned_while_it_was_not_selected) {
  select(1);
  cycle();
  select(0);
  cycle();
  counter(1000);
  cycle();
  select(1);
  EXPECT_EQ(cycle().kind, RequestKind::none);
  counter(1001);
  EXPECT_NEAR(cycle().value, 0.01, 1e-6);
}

TEST_F(HandwheelTest, is_none_where_its_number_is_not_known) {
  select(3);
  cycle();
  counter(5);
  EXPECT_EQ(cycle().kind, RequestKind::none);
}

TEST_F(HandwheelTest, counts_on_over_both_ends_of_its_counter) {
  select(1);
  counter(std::numeric_limits<std::int32_t>::max());
  cycle();
  counter(std::numeric_limits<std::int32_t>::min() + 1.0);
  EXPECT_NEAR(cycle().value, 0.02, 1e-6);
  counter(std::numeric_limits<std::int32_t>::max() - 1.0);
  EXPECT_NEAR(cycle().value, -0.03, 1e-6);
}

TEST_F(HandwheelTest, loses_the_counts_that_the_gate_refuses_and_says_why) {
  select(1);
  cycle();
  counter(10);
  EXPECT_EQ(cycle(Refusal::not_powered).kind, RequestKind::jog_increment);
  EXPECT_EQ(refusal(), static_cast<double>(Refusal::not_powered));
  EXPECT_EQ(cycle().kind, RequestKind::none) << "they are not made up for";
  EXPECT_EQ(refusal(), static_cast<double>(Refusal::not_powered)) << "it stays until counts are followed";
  counter(11);
  EXPECT_NEAR(cycle().value, 0.01, 1e-6);
  EXPECT_EQ(refusal(), 0.0);
}

TEST_F(HandwheelTest, asks_for_no_more_than_the_axis_can_follow_and_for_whole_counts) {
  select(1);
  step(0.3);
  cycle();
  counter(1'000'000);
  const axis::MotionLimits limits{50.0, 1000.0, 10000.0};
  const double room = axis::Ramp::stopping_distance({0.0, 50.0, 0.0}, limits) + 50.0 * Handwheel::kLag;
  const double asked = cycle().value;
  EXPECT_LE(asked, room);
  EXPECT_GT(asked, room - 0.31);
  EXPECT_NEAR(std::remainder(asked, 0.3), 0.0, 1e-5);
}

TEST_F(HandwheelTest, moves_one_count_from_rest_however_large_its_step) {
  select(1);
  step(20.0);
  cycle();
  counter(3);
  EXPECT_NEAR(cycle().value, 20.0, 1e-9);
}

TEST_F(HandwheelTest, goes_the_other_way_with_a_step_below_0_and_leaves_senseless_steps_to_the_gate) {
  select(1);
  step(-0.01);
  cycle();
  counter(1);
  EXPECT_NEAR(cycle().value, -0.01, 1e-6);
  step(0.0);
  counter(2);
  EXPECT_EQ(cycle(Refusal::bad_value).value, 0.0);
  EXPECT_EQ(refusal(), static_cast<double>(Refusal::bad_value));
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(image_.packets.data(image::Packet::k) + image::kMachineBase + 12, &nothing, sizeof nothing);
  counter(3);
  EXPECT_TRUE(std::isnan(cycle().value));
}

TEST_F(HandwheelTest, waits_behind_a_stop_until_it_is_selected_anew) {
  select(1);
  cycle();
  wheel_.stop();
  counter(5);
  EXPECT_EQ(cycle().kind, RequestKind::none);
  EXPECT_EQ(refusal(), static_cast<double>(Refusal::handwheel_stopped));
  select(0);
  cycle();
  EXPECT_EQ(refusal(), 0.0);
  select(1);
  cycle();
  counter(6);
  EXPECT_EQ(cycle().kind, RequestKind::jog_increment);
}

}  // namespace
}  // namespace servogate::cycle
