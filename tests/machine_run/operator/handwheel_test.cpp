// SPDX-License-Identifier: Apache-2.0
// The example mill whose PLC moves an axis by a handwheel: one counter, through the one gate.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr const char* kDesk = R"(
VAR_GLOBAL counter, counter2 : DINT; selected, selected_y : USINT; step : REAL := 0.01; feed : BOOL := TRUE;
  jog : BOOL; END_VAR
PROGRAM Main
MC.estop_ok := estop_chain_ok; MC.power_on := estop_chain_ok;
X.enable := TRUE; Y.enable := TRUE; Z.enable := TRUE;
X.feed_enable := feed; Y.feed_enable := feed; Z.feed_enable := feed;
NC.feed_enable := feed; NC.read_in_enable := TRUE; NC.m_ack := NC.m_strobe;
X.handwheel := selected; Y.handwheel := selected_y; X.jog_minus := jog;
MC.handwheel1 := counter; MC.handwheel1_step := step;
MC.handwheel2 := counter2; MC.handwheel2_step := -0.1;
END_PROGRAM
)";

machine::LoadResult machine_with(const Scratch& scratch) {
  const std::string path = source("examples/mill/machine.toml");
  std::string text = read_all(path);
  replace(text, "\"mill.st\"", "\"" + scratch.write("desk.st", kDesk) + "\"");
  return machine::parse(text, path);
}

/// The mill, and the hand at its handwheel.
class Hand : public Scratch, public Mill {
 public:
  explicit Hand(std::string_view program = {}) : Mill(machine_with(*this), program) {}
  void set(const std::string& name, double value) {
    plc::Engine& engine = control().logic()->engine();
    const auto handle = engine.find(name);
    ASSERT_TRUE(handle) << name;
    image::Packets unused;
    ASSERT_TRUE(engine.set_number(unused, *handle, value)) << name;
  }
  /// So many counts, one in each cycle.
  void turn(int counts) {
    for (int n = 0; n < std::abs(counts); ++n) {
      counter_ += counts > 0 ? 1 : -1;
      set("counter", counter_);
      run(0.001);
    }
  }
  /// All of them from one cycle to the next.
  void jump(int counts) {
    counter_ += counts;
    set("counter", counter_);
    run(0.002);
  }
  void select(bool on) {
    set("selected", on ? 1 : 0);
    run(0.002);
  }
  bool rests() {
    return until([&] { return !axis("X").moving; }, 5.0);
  }
  Refusal refusal(const std::string& axis = "X") {
    const image::Place place = place_of(control(), axis + ".handwheel_refusal");
    return static_cast<Refusal>(static_cast<int>(image().packets.number(place)));
  }

 private:
  int counter_ = 1'000'000;  ///< as of an absolute encoder
};

class Handwheel : public ::testing::Test {
 protected:
  Handwheel() {
    hand_.turn(1);
    EXPECT_TRUE(hand_.make_ready()) << hand_.alarm_list();
    EXPECT_EQ(hand_.ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  }
  double x() const { return hand_.axis("X").command; }

  Hand hand_;
};

TEST_F(Handwheel, moves_the_axis_that_selects_it_count_by_count_and_within_its_limits) {
  hand_.select(true);
  hand_.run(0.1);
  const double from = x();
  hand_.turn(300);
  EXPECT_TRUE(hand_.axis("X").moving);
  EXPECT_EQ(hand_.axis("X").owner, image::AxisOwner::manual);
  EXPECT_LT(x() - from, 3.0) << "it follows";
  ASSERT_TRUE(hand_.rests());
  EXPECT_NEAR(x() - from, 3.0, 1e-5);
  hand_.turn(-500);
  ASSERT_TRUE(hand_.rests());
  EXPECT_NEAR(x() - from, -2.0, 1e-5);
  EXPECT_EQ(hand_.axis("Y").command_velocity, 0.0);
  EXPECT_EQ(hand_.refusal(), Refusal::none);
  EXPECT_EQ(hand_.judge().verdict(), "");
  EXPECT_EQ(hand_.alarm_list(), "");
}

TEST_F(Handwheel, does_nothing_by_being_selected_whatever_was_turned_before) {
  const double from = x();
  hand_.turn(200);
  hand_.select(true);
  hand_.run(0.2);
  EXPECT_EQ(x(), from);
  hand_.select(false);
  hand_.turn(200);
  hand_.select(true);
  hand_.run(0.2);
  EXPECT_EQ(x(), from);
}

TEST_F(Handwheel, does_not_make_up_for_what_was_turned_during_a_hold) {
  hand_.select(true);
  hand_.turn(100);
  hand_.set("feed", 0);
  hand_.turn(400);
  ASSERT_TRUE(hand_.rests());
  EXPECT_EQ(hand_.refusal(), Refusal::feed_not_enabled);
  const double held = x();
  hand_.set("feed", 1);
  hand_.run(0.5);
  EXPECT_EQ(x(), held);
  hand_.turn(10);
  ASSERT_TRUE(hand_.rests());
  EXPECT_NEAR(x() - held, 0.1, 1e-5);
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, leads_to_the_end_of_the_travel_and_not_beyond) {
  hand_.select(true);
  hand_.set("step", 0.5);
  for (int n = 0; n < 100 && hand_.refusal() != Refusal::at_soft_limit; ++n) hand_.turn(40);
  EXPECT_EQ(hand_.refusal(), Refusal::at_soft_limit);
  ASSERT_TRUE(hand_.rests());
  EXPECT_EQ(x(), 300.0);
  hand_.turn(-10);
  ASSERT_TRUE(hand_.rests());
  EXPECT_NEAR(x(), 295.0, 1e-5);
  EXPECT_EQ(hand_.alarm_list(), "") << "a controlled stop";
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, turned_faster_than_the_axis_can_follow_loses_counts) {
  hand_.select(true);
  const double from = x();
  hand_.jump(1'000'000);
  ASSERT_TRUE(hand_.rests());
  EXPECT_GT(x() - from, 5.0);
  EXPECT_LT(x() - from, 20.0) << "its braking way from 100 mm/s, and 50 ms more";
  hand_.set("step", 1.0);
  hand_.turn(500);  // 1 m/s
  const double released = x();
  EXPECT_NEAR(hand_.axis("X").command_velocity, 100.0, 1e-6);
  ASSERT_TRUE(hand_.rests());
  EXPECT_LT(x() - released, 20.0) << "and stops when the hand does";
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, let_go_in_motion_stops_the_axis) {
  hand_.select(true);
  hand_.set("step", 1.0);
  hand_.turn(300);
  const double from = x();
  hand_.select(false);
  ASSERT_TRUE(hand_.rests());
  EXPECT_LT(x() - from, 15.0);
  EXPECT_EQ(hand_.axis("X").owner, image::AxisOwner::none);
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, is_selected_anew_behind_a_stop_of_the_operator) {
  hand_.select(true);
  for (const RequestKind stop : {RequestKind::hold, RequestKind::stop, RequestKind::jog_stop}) {
    hand_.turn(200);
    ASSERT_EQ(hand_.ask(stop), Refusal::none);
    hand_.turn(200);
    ASSERT_TRUE(hand_.rests());
    EXPECT_EQ(hand_.refusal(), Refusal::handwheel_stopped);
    const double stopped = x();
    hand_.turn(100);
    EXPECT_EQ(x(), stopped);
    hand_.select(false);
    hand_.select(true);
    EXPECT_EQ(hand_.refusal(), Refusal::none);
    hand_.turn(10);
    ASSERT_TRUE(hand_.rests());
    EXPECT_NEAR(x() - stopped, 0.1, 1e-5);
  }
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, gives_way_to_a_jog_and_to_whoever_holds_manual_control) {
  hand_.select(true);
  hand_.set("jog", 1);
  hand_.run(0.2);
  EXPECT_LT(hand_.axis("X").command_velocity, 0.0);
  hand_.turn(50);
  EXPECT_LT(hand_.axis("X").command_velocity, 0.0);
  EXPECT_EQ(hand_.refusal(), Refusal::axis_moves);
  hand_.set("jog", 0);
  hand_.run(0.002);
  ASSERT_TRUE(hand_.rests());
  hand_.run(0.1);
  ASSERT_EQ(hand_.ask(RequestKind::jog_increment, 20.0, 0), Refusal::none);
  hand_.turn(50);
  EXPECT_EQ(hand_.refusal(), Refusal::manual_held);
  EXPECT_EQ(hand_.judge().verdict(), "");
}

TEST_F(Handwheel, of_number_2_moves_another_axis_at_the_same_time_the_other_way) {
  hand_.select(true);
  hand_.set("selected_y", 2);
  hand_.run(0.01);
  const double from = x(), from_y = hand_.axis("Y").command;
  hand_.set("counter2", 7);
  hand_.turn(100);
  ASSERT_TRUE(hand_.until([&] { return !hand_.axis("X").moving && !hand_.axis("Y").moving; }, 5.0));
  EXPECT_NEAR(x() - from, 1.0, 1e-5);
  EXPECT_NEAR(hand_.axis("Y").command - from_y, -0.7, 1e-5);
}

TEST_F(Handwheel, does_not_move_an_axis_without_power_nor_behind_an_emergency_stop) {
  hand_.select(true);
  ASSERT_EQ(hand_.ask(RequestKind::power, 0.0), Refusal::none);
  ASSERT_TRUE(hand_.until([&] { return !hand_.axis("X").drive_command.power; }, 5.0));
  hand_.run(0.1);
  const double from = x();
  hand_.turn(50);
  EXPECT_EQ(hand_.refusal(), Refusal::not_powered);
  EXPECT_NEAR(x(), from, 1e-3);
  hand_.control().world().play_input("estop_chain_ok", {0.0});
  hand_.run(0.1);
  hand_.turn(50);
  EXPECT_EQ(hand_.refusal(), Refusal::emergency_stop);
  EXPECT_NEAR(x(), from, 1e-3);
}

TEST(HandwheelOfAProgram, does_not_move_its_axes_while_it_runs) {
  Hand hand("N10 G90 G94 G71\nN20 G1 X100 F3000\nN30 X0\nN40 M30\n");
  ASSERT_TRUE(hand.make_ready()) << hand.alarm_list();
  hand.select(true);
  ASSERT_EQ(hand.ask(RequestKind::start), Refusal::none);
  hand.run(0.5);
  hand.turn(100);
  EXPECT_EQ(hand.refusal(), Refusal::program_runs);
  EXPECT_EQ(hand.axis("X").owner, image::AxisOwner::process);
  EXPECT_EQ(hand.judge().verdict(), "");
}

TEST(HandwheelBeforeHoming, moves_slowly_and_knows_no_end_of_the_travel_yet) {
  Hand hand;
  hand.turn(1);
  ASSERT_TRUE(hand.power_on()) << hand.alarm_list();
  hand.select(true);
  hand.set("step", 0.1);
  const double from = hand.axis("X").command;
  hand.turn(300);
  EXPECT_NEAR(hand.axis("X").command_velocity, 10.0, 1e-6) << "jog_velocity_not_homed";
  ASSERT_TRUE(hand.rests());
  EXPECT_GT(hand.axis("X").command, from);
  EXPECT_EQ(hand.judge().verdict(), "");
}

/// The counts come from two lines of the GPIO chip, through the PLC and the same gate.
TEST(HandwheelOfTwoLines, moves_the_axis_and_does_not_when_its_chip_is_gone) {
  class Wheel : public Scratch, public Mill {
   public:
    Wheel() : Mill(with(*this), {}) {}

   private:
    static machine::LoadResult with(const Scratch& scratch) {
      const std::string path = source("examples/mill/machine.toml");
      std::string text = read_all(path), desk = kDesk;
      replace(desk, "MC.handwheel1 := counter;", "MC.handwheel1 := wheel;");
      replace(text, "\"mill.st\"", "\"" + scratch.write("desk.st", desk) + "\"");
      replace(text, "  { name = \"x_home\"",
              "  { name = \"wheel\", channel = \"ai11\", b_line = 12, place = \"SA40.LI\" },\n  { name = "
              "\"x_home\"");
      return machine::parse(text, path);
    }
  } mill;
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  image::Packets unused;
  plc::Engine& engine = mill.control().logic()->engine();
  ASSERT_TRUE(engine.set_number(unused, *engine.find("selected"), 1.0));
  mill.run(0.01);
  const double from = mill.axis("X").command;
  for (int n = 1; n <= 40; ++n) {
    mill.control().world().play_input("wheel", {static_cast<double>(-n)});
    mill.run(0.002);
  }
  ASSERT_TRUE(mill.until([&] { return !mill.axis("X").moving; }, 5.0));
  EXPECT_NEAR(mill.axis("X").command, from - 0.4, 1e-4) << "a hundredth a count, the other way round";
  mill.control().world().chip("gpio")->plug(false);
  mill.run(0.5);
  EXPECT_EQ(mill.image().packets.number(place_of(mill.control(), "wheel")), -40.0);
  EXPECT_NEAR(mill.axis("X").command, from - 0.4, 1e-4);
}

}  // namespace
}  // namespace servogate::machine_run
