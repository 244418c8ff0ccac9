// SPDX-License-Identifier: Apache-2.0
// What the PLC asks of an electronic gear by <axis>.gear.
#include "kernel/cycle/plc_orders/gear_order.hpp"

#include <gtest/gtest.h>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {
namespace {

using image::Request;
using image::RequestKind;

class GearOrderTest : public ::testing::Test {
 protected:
  void wish(int number) {
    image_.packets.set_number(image::field(image::kAxisFields, "gear", image::axis_base(0)), number);
  }
  /// -1: nothing is asked for.
  double cycle(Refusal answer = Refusal::none) {
    Request request;
    order_.read(image_, 0);
    if (!order_.next(request, on_, geared_)) return -1.0;
    EXPECT_EQ(request.kind, RequestKind::gear);
    EXPECT_EQ(request.axis, 0);
    EXPECT_EQ(request.asker, image::Asker::plc);
    image::Answer a;
    a.refusal = static_cast<std::uint16_t>(answer);
    order_.answer(request, a);
    if (answer == Refusal::none) on_ = geared_ = request.value != 0.0 || geared_;
    if (answer == Refusal::none && request.value == 0.0) on_ = false;
    return request.value;
  }

  image::ProcessImage image_;
  GearOrder order_;
  bool on_ = false, geared_ = false;
};

TEST_F(GearOrderTest, asks_once_for_a_gear_and_once_for_its_end) {
  EXPECT_EQ(cycle(), -1.0);
  wish(2);
  EXPECT_EQ(cycle(), 2.0);
  EXPECT_EQ(cycle(), -1.0);
  EXPECT_EQ(order_.number(), 2);
  wish(0);
  EXPECT_EQ(cycle(), 0.0);
  EXPECT_EQ(cycle(), -1.0) << "it comes to rest";
  geared_ = false;
  EXPECT_EQ(cycle(), -1.0);
  EXPECT_EQ(order_.number(), 0);
}

TEST_F(GearOrderTest, brings_the_axis_to_rest_between_two_gears) {
  wish(1);
  cycle();
  wish(2);
  EXPECT_EQ(cycle(), 0.0);
  EXPECT_EQ(cycle(), -1.0);
  geared_ = false;
  EXPECT_EQ(cycle(), 2.0);
}

TEST_F(GearOrderTest, does_not_engage_again_what_something_has_disengaged) {
  wish(1);
  cycle();
  on_ = geared_ = false;
  EXPECT_EQ(cycle(), -1.0);
  wish(0);
  EXPECT_EQ(cycle(), -1.0);
  wish(1);
  EXPECT_EQ(cycle(), 1.0);
}

TEST_F(GearOrderTest, keeps_why_it_was_refused_until_the_next_order) {
  wish(1);
  EXPECT_EQ(cycle(Refusal::gear_master), 1.0);
  EXPECT_EQ(cycle(), -1.0);
  EXPECT_EQ(order_.answer().refusal, static_cast<std::uint16_t>(Refusal::gear_master));
  wish(0);
  cycle();
  EXPECT_EQ(order_.answer().refusal, 0);
}

}  // namespace
}  // namespace servogate::cycle
