// SPDX-License-Identifier: Apache-2.0
// What the gate says to motions of axes that belong to the PLC.
#include <gtest/gtest.h>

#include <limits>

#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/cycle/gate/rig.hpp"

namespace servogate::cycle {
namespace {

using image::Asker;
using image::ProcessState;
using image::Reaction;
using image::Request;
using image::RequestKind;

/// The second axis is the PLC's.
class GateOfAuxiliary : public test::GateRig {
 protected:
  GateOfAuxiliary() {
    axis::AxisConfig c = axes_[1].config();
    c.auxiliary = true;
    c.homing.method = axis::HomingMethod::absolute;
    axes_[1].configure(c, 1);
    axes_[1].set_reference(0);
    axes_[1].request_power(true);
    run(20);
  }
  Refusal move(RequestKind kind, double value, double velocity, double acceleration = 0.0, int axis = 1,
               Asker asker = Asker::plc) {
    Request r;
    r.kind = kind;
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    r.velocity = velocity;
    r.acceleration = acceleration;
    r.asker = asker;
    answer_ = decide(r, context_);
    return static_cast<Refusal>(answer_.refusal);
  }
};

TEST_F(GateOfAuxiliary, lets_the_plc_move_its_axis_also_while_a_program_runs_and_the_operator_jogs) {
  image_.processes[0].state = ProcessState::running;
  context_.manual_held = context_.homing_runs = true;
  context_.holder = Asker::pendant;
  EXPECT_EQ(move(RequestKind::move_absolute, 10, 5), Refusal::none);
  EXPECT_EQ(move(RequestKind::move_relative, -10, 5, 1), Refusal::none);
  EXPECT_EQ(move(RequestKind::move_velocity, -1, 5), Refusal::none);
  EXPECT_EQ(move(RequestKind::axis_home, 0, 0), Refusal::none);
  EXPECT_EQ(move(RequestKind::axis_power, 1, 0), Refusal::none);
}

TEST_F(GateOfAuxiliary, lets_nobody_but_the_plc_move_it) {
  for (const Asker who : {Asker::command_line, Asker::page, Asker::pendant, Asker::scenario, Asker::modbus,
                          Asker::program, Asker::bench})
    for (const RequestKind k : {RequestKind::axis_power, RequestKind::axis_home, RequestKind::move_absolute,
                                RequestKind::move_relative, RequestKind::move_velocity,
                                RequestKind::axis_stop, RequestKind::axis_reset})
      EXPECT_EQ(move(k, 1, 1, 0, 1, who), Refusal::asker_may_not) << static_cast<int>(k);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1), Refusal::axis_owned) << "by hand";
  EXPECT_NE(english().find("the PLC"), std::string::npos) << english();
  EXPECT_EQ(ask(RequestKind::jog_continuous, 1, 1), Refusal::axis_owned);
  EXPECT_EQ(ask(RequestKind::home, 1), Refusal::axis_owned);
  EXPECT_EQ(ask(RequestKind::zero, 1), Refusal::axis_owned);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1, Asker::plc), Refusal::none) << "<axis>.jog_plus";
}

TEST_F(GateOfAuxiliary, keeps_the_axes_of_programs_from_the_plc) {
  for (const RequestKind k : {RequestKind::axis_power, RequestKind::axis_home, RequestKind::move_absolute,
                              RequestKind::move_relative, RequestKind::move_velocity, RequestKind::axis_stop,
                              RequestKind::axis_reset})
    EXPECT_EQ(move(k, 1, 1, 0, 0), Refusal::axis_not_auxiliary) << static_cast<int>(k);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1, 0, 7), Refusal::no_such_axis);
}

TEST_F(GateOfAuxiliary, homes_all_axes_without_it_and_starts_programs_whatever_it_does) {
  image::Request request;
  request.kind = RequestKind::home;
  EXPECT_EQ(homing_mask(request, axes_), 1u);
  axes_[1].request_power(false);
  run(5);
  EXPECT_EQ(ask(RequestKind::start), Refusal::none);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1), Refusal::not_powered);
}

TEST_F(GateOfAuxiliary, says_why_a_motion_cannot_be) {
  const axis::AxisConfig& c = axes_[1].config();
  EXPECT_EQ(move(RequestKind::move_absolute, c.travel_max + 1, 5), Refusal::outside_travel);
  EXPECT_EQ(move(RequestKind::move_relative, c.travel_min - 1, 5), Refusal::outside_travel);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 0), Refusal::velocity_range);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, -1), Refusal::velocity_range);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, std::numeric_limits<double>::quiet_NaN()),
            Refusal::velocity_range);
  EXPECT_EQ(move(RequestKind::move_absolute, std::numeric_limits<double>::infinity(), 1), Refusal::bad_value);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, c.limits.velocity * 1.01), Refusal::velocity_range);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1, c.limits.acceleration * 1.01),
            Refusal::acceleration_range);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1, -1), Refusal::acceleration_range);
  EXPECT_EQ(move(RequestKind::move_velocity, 0.5, 1), Refusal::bad_value);
  set(1, "feed_enable", false);
  run(1);
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1), Refusal::feed_not_enabled);
  set(1, "feed_enable", true);
  set(1, "limit_plus", true);
  run(1);
  EXPECT_EQ(move(RequestKind::move_velocity, 1, 1), Refusal::on_hard_limit);
  EXPECT_EQ(move(RequestKind::move_velocity, -1, 1), Refusal::none) << "away from it";
}

TEST_F(GateOfAuxiliary, wants_alarms_reset_and_the_drives_wished_for) {
  context_.drives_wanted = false;
  EXPECT_EQ(move(RequestKind::axis_power, 1, 0), Refusal::drives_not_wanted);
  EXPECT_EQ(move(RequestKind::axis_power, 0, 0), Refusal::none);
  context_.drives_wanted = true;
  context_.axis_stopping = true;
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1), Refusal::axis_stopping);
  context_.axis_error_stop = true;
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1), Refusal::axis_error_stop);
  EXPECT_EQ(move(RequestKind::axis_reset, 0, 0), Refusal::none);
  context_.axis_error_stop = context_.axis_stopping = false;
  context_.reaction = Reaction::power_off;
  context_.first_alarm = alarm::kEmergencyStop;
  EXPECT_EQ(move(RequestKind::move_absolute, 1, 1), Refusal::emergency_stop);
  EXPECT_EQ(move(RequestKind::axis_power, 1, 0), Refusal::emergency_stop);
  EXPECT_EQ(move(RequestKind::axis_stop, 0, 0), Refusal::none);
}

TEST_F(GateOfAuxiliary, keeps_everybody_from_the_places_of_the_blocks) {
  image_.packets.resize(4096, image::kSyvarDefaultSize);
  const image::Place order = image::field(image::kMotionFields, "mc_order", image::motion_base(1));
  EXPECT_EQ(ask_place(RequestKind::set_place, order), Refusal::place_not_writable);
  EXPECT_EQ(ask_place(RequestKind::set_place,
                      image::field(image::kMotionFields, "mc_order", image::motion_base(0))),
            Refusal::none)
      << "the first axis has none";
}

}  // namespace
}  // namespace servogate::cycle
