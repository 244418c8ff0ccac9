// SPDX-License-Identifier: Apache-2.0
// What the gate says to an electronic gear, and to everybody else while one is engaged.
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/cycle/gate/rig.hpp"

namespace servogate::cycle {
namespace {

using image::Asker;
using image::Reaction;
using image::RequestKind;

/// Y follows X half as far; both stand at 0.
class GateOfGears : public test::GateRig {
 protected:
  GateOfGears() {
    config_.follower = 1;
    config_.master_axis = 0;
    config_.master_turns = 2;
    config_.window = 0.5;
    context_.gears = 1;
    context_.gear = &gear_;
    configure();
  }
  void configure() {
    gear_.configure(config_, axes_);
    run_with_gear(200);
  }
  void run_with_gear(int cycles) {
    while (cycles-- > 0) {
      run(1);
      gear_.look(machine(), image_);
    }
  }
  axis::ElectronicGear::Machine machine() { return {axes_, {}}; }
  Refusal engage(double number = 1.0) { return ask(RequestKind::gear, 1, number, Asker::plc); }

  axis::ElectronicGearConfig config_;
  axis::ElectronicGear gear_;
};

TEST_F(GateOfGears, lets_the_plc_engage_and_disengage_and_nobody_else) {
  EXPECT_EQ(engage(), Refusal::none);
  EXPECT_EQ(engage(0.0), Refusal::none);
  for (const Asker asker : {Asker::command_line, Asker::page, Asker::pendant, Asker::scenario, Asker::modbus,
                            Asker::program, Asker::bench})
    EXPECT_EQ(ask(RequestKind::gear, 1, 1.0, asker), Refusal::asker_may_not);
}

TEST_F(GateOfGears, names_the_number_that_the_axis_does_not_have) {
  context_.gear = nullptr;
  EXPECT_EQ(engage(3.0), Refusal::no_gear);
  EXPECT_EQ(english(), "Y has no gear number 3: `[[gear]]` of the machine file gives it 1");
}

TEST_F(GateOfGears, refuses_a_follower_that_may_not_move) {
  context_.reaction = Reaction::stop_on_path;
  context_.first_alarm = alarm::kEmergencyStop;
  EXPECT_EQ(engage(), Refusal::emergency_stop);
  EXPECT_EQ(engage(0.0), Refusal::none) << "what ends a motion is never refused";
  context_.reaction = Reaction::none;
  set(1, "feed_enable", false);
  run(1);
  EXPECT_EQ(engage(), Refusal::feed_not_enabled);
  set(1, "feed_enable", true);
  set(1, "limit_plus", true);
  run(1);
  EXPECT_EQ(engage(), Refusal::on_hard_limit);
  set(1, "limit_plus", false);
  run(1);
  ASSERT_TRUE(axes_[1].jog_increment(20.0));
  run(10);
  EXPECT_EQ(engage(), Refusal::axis_moves);
  not_homed(1);
  EXPECT_EQ(engage(), Refusal::not_homed);
}

TEST_F(GateOfGears, refuses_a_master_that_gives_no_position) {
  not_homed(0);
  run_with_gear(1);
  EXPECT_EQ(engage(), Refusal::gear_master);
  EXPECT_EQ(english(),
            "the master of Y gives no position: it is not homed, its zero mark has not been passed, or its "
            "drive does not answer");
}

TEST_F(GateOfGears, refuses_a_master_that_is_too_fast_for_the_follower) {
  config_.follower_turns = 20;
  configure();
  ASSERT_TRUE(axes_[0].move_to(200.0, 300.0));
  run_with_gear(500);
  EXPECT_EQ(engage(), Refusal::gear_too_fast);
  EXPECT_EQ(answer_.limit, 500.0);
  EXPECT_GT(answer_.value, 500.0);
}

TEST_F(GateOfGears, in_phase_the_follower_has_to_be_at_its_one_place_before) {
  config_.phase = 3.0;
  configure();
  EXPECT_EQ(engage(), Refusal::gear_off_place);
  EXPECT_EQ(english(),
            "Y is -3 mm off its place behind its master, 0.5 mm allowed (`window`): jog it there first");
  ASSERT_TRUE(axes_[1].move_to(2.8, 50.0));
  run_with_gear(1000);
  EXPECT_EQ(engage(), Refusal::none);
}

TEST_F(GateOfGears, refuses_every_other_motion_of_the_follower_while_it_is_engaged) {
  ASSERT_TRUE(gear_.engage(machine()));
  EXPECT_EQ(engage(), Refusal::axis_geared);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0), Refusal::axis_geared);
  EXPECT_EQ(english(),
            "Y follows its master by an electronic gear: disengage it first (the PLC sets Y.gear to 0; "
            "`servogate stop` stops all)");
  EXPECT_EQ(ask(RequestKind::jog_continuous, 1, 1.0), Refusal::axis_geared);
  EXPECT_EQ(ask(RequestKind::home, 1), Refusal::axis_geared);
  EXPECT_EQ(ask(RequestKind::home), Refusal::axis_geared);
  EXPECT_EQ(ask(RequestKind::zero, 1, 5.0), Refusal::axis_geared);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::none) << "its master may move";
  EXPECT_EQ(ask(RequestKind::start), Refusal::none) << "a program does without the follower";
}

}  // namespace
}  // namespace servogate::cycle
