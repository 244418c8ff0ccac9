// SPDX-License-Identifier: Apache-2.0
// What `servogate run` does in an operator's place, and what it leaves to the person at a real machine.
#include "gateway/control/run/operator_script.hpp"

#include <gtest/gtest.h>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using gateway::OperatorScript;
using image::ProcessState;

/// The script at the example mill, with a person at the start button.
class Operated {
 public:
  explicit Operated(bool wait_for_start)
      : mill_("N10 G90 G94 G71\nN20 G1 X10 Y5 F3000\nN30 M30\n"),
        script_(wishes(wait_for_start),
                [this](const image::Request& r) { return mill_.control().cycle().post(r); }) {
    mill_.after_cycle = [this] {
      image::Answer answer;
      while (mill_.control().cycle().take_answer(answer)) script_.take(answer);
      script_.poll(mill_.image());
      for (const char* letter : {"X", "Y", "Z"}) {
        const image::AxisImage& axis = mill_.axis(letter);
        asked_for_power_ = asked_for_power_ || axis.drive_command.power;
      }
    };
  }
  Mill& mill() { return mill_; }
  OperatorScript& script() { return script_; }
  bool asked_for_power() const { return asked_for_power_; }
  bool reaches(OperatorScript::Stage stage) {
    return mill_.until([&] { return script_.stage() == stage; });
  }
  void button(bool pressed) { mill_.control().world().set_input("cycle_start", pressed); }

 private:
  OperatorScript::Wishes wishes(bool wait_for_start) {
    OperatorScript::Wishes w;
    w.wait_for_start = wait_for_start;
    w.start_place = mill_.control().machine().point("cycle_start", &w.start_source)->place;
    w.letters = mill_.control().machine().letters();
    w.needs_homing.assign(w.letters.size(), true);
    w.fault = [this] { return gateway::fault_stands(mill_.machine().alarms()); };
    return w;
  }
  Mill mill_;
  OperatorScript script_;
  bool asked_for_power_ = false;
};

TEST(Operator, of_mock_buses_asks_nobody) {
  Operated run(false);
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::done));
  EXPECT_EQ(run.script().outcome(), OperatorScript::Outcome::finished);
}

TEST(Operator,
     at_a_real_machine_switches_nothing_on_before_the_button_and_starts_nothing_before_it_is_pressed_again) {
  Operated run(true);
  run.mill().run(20.0);
  EXPECT_FALSE(run.asked_for_power());
  EXPECT_EQ(run.script().stage(), OperatorScript::Stage::button);

  run.button(true);
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::start)) << run.mill().alarm_list();
  run.mill().run(20.0);
  for (const char* letter : {"X", "Y", "Z"}) EXPECT_TRUE(run.mill().axis(letter).homed) << letter;
  EXPECT_EQ(run.mill().process().state, ProcessState::idle)
      << "a button that stays pressed starts no program";

  run.button(false);
  run.mill().run(0.5);
  run.button(true);
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::done));
  EXPECT_EQ(run.script().outcome(), OperatorScript::Outcome::finished);
  EXPECT_EQ(run.mill().judge().verdict(), "");
}

TEST(Operator, does_not_take_a_button_that_was_stuck_from_the_beginning_for_a_press) {
  Operated run(true);
  run.button(true);
  run.mill().run(5.0);
  EXPECT_FALSE(run.asked_for_power());
  run.button(false);
  run.mill().run(1.0);
  run.button(true);
  EXPECT_TRUE(run.reaches(OperatorScript::Stage::homing));
}

TEST(Operator, whose_homing_somebody_ended_gives_up_and_names_the_axes_that_are_not_homed) {
  Operated run(false);
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::homing)) << run.mill().alarm_list();
  ASSERT_TRUE(run.mill().until([&] { return run.mill().axis("Z").moving; }));
  run.mill().control().cycle().post(
      {.id = 1000, .asker = image::Asker::page, .kind = image::RequestKind::hold});
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::done)) << run.mill().alarm_list();
  EXPECT_EQ(run.script().outcome(), OperatorScript::Outcome::alarm);
  EXPECT_EQ(run.script().came_to(), OperatorScript::Stage::homing);
  EXPECT_EQ(run.script().waiting_for(), (std::vector<std::string>{"X", "Y", "Z"}));
}

TEST(Operator, that_is_interrupted_before_the_button_ends_with_everything_off) {
  Operated run(true);
  run.mill().run(1.0);
  run.script().interrupt();
  ASSERT_TRUE(run.reaches(OperatorScript::Stage::done));
  EXPECT_EQ(run.script().outcome(), OperatorScript::Outcome::stopped);
  EXPECT_FALSE(run.asked_for_power());
}

}  // namespace
}  // namespace servogate::machine_run
