// SPDX-License-Identifier: Apache-2.0
// What a cycle reads acts in that cycle: its set-point is already the stop's.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

/// A mill whose axes move at constant speeds; notes the first cycle in which the speed of the set-point of X
/// falls.
class AtConstantSpeed : public Mill {
 public:
  explicit AtConstantSpeed(bool by_program)
      : Mill(by_program ? "N10 G90 G94 G71\nN20 G1 X300 Y150 F3000\nN30 M30\n" : "N10 M30\n") {
    EXPECT_TRUE(make_ready()) << alarm_list();
    EXPECT_EQ(by_program ? ask(RequestKind::start) : ask(RequestKind::jog_increment, 200.0, 0),
              Refusal::none);
    EXPECT_TRUE(until([&] { return axis("X").command_velocity > 20.0 && constant(); }, 5.0)) << alarm_list();
    speed_ = axis("X").command_velocity;
    after_cycle = [this] {
      if (slower_in < 0 && axis("X").command_velocity < speed_ * (1.0 - 1e-9)) slower_in = image().now.number;
    };
  }
  /// Cycle in which the first alarm with this number was raised; -1: none was.
  std::int64_t raised_in(image::AlarmNumber number) {
    for (const image::AlarmRecord& r : control().cycle().alarms().history())
      if (r.number == number) return r.cycle;
    return -1;
  }
  /// Cycle in which the point changed after this call; -1: it has not.
  void look_at(const std::string& point) {
    looked_at_ = place_of(control(), point);
    was_ = image().packets.bit(looked_at_);
    after_cycle = [this, judge = after_cycle] {
      judge();
      if (read_in < 0 && image().packets.bit(looked_at_) != was_) read_in = image().now.number;
    };
  }
  std::int64_t slower_in = -1, read_in = -1;

 private:
  bool constant() {
    const double v = axis("X").command_velocity;
    const bool same = v == before_;
    before_ = v;
    return same;
  }
  double before_ = 0.0, speed_ = 0.0;
  image::Place looked_at_;
  bool was_ = false;
};

struct Case {
  const char* what;
  image::AlarmNumber number;
  std::function<void(Mill&)> happens;
};

void play(Mill& mill, const char* point, double value) { mill.control().world().play_input(point, {value}); }

TEST(ReactionCycle, what_a_cycle_reads_slows_the_set_point_of_the_same_cycle) {
  const Case cases[] = {
      {"limit switch ahead", axis::alarm::kHardLimitPlus, [](Mill& m) { play(m, "x_limit_plus", 1.0); }},
      {"limit switch behind", axis::alarm::kHardLimitMinus, [](Mill& m) { play(m, "x_limit_minus", 1.0); }},
      {"following error", axis::alarm::kFollowingError,
       [](Mill& m) { m.inject("can.x", fault::Kind::encoder_loss); }},
      {"emergency stop", cycle::alarm::kEmergencyStop, [](Mill& m) { play(m, "estop_chain_ok", 0.0); }},
  };
  for (const bool by_program : {false, true})
    for (const Case& c : cases) {
      AtConstantSpeed mill(by_program);
      c.happens(mill);
      ASSERT_TRUE(mill.until([&] { return mill.alarms(c.number) > 0; }, 2.0)) << c.what << mill.alarm_list();
      mill.run(0.1);
      EXPECT_EQ(mill.slower_in, mill.raised_in(c.number))
          << c.what << (by_program ? ", of a program: " : ", of a jog: ") << mill.alarm_list();
      EXPECT_EQ(mill.judge().verdict(), "") << c.what;
    }
}

TEST(ReactionCycle, the_limit_switch_and_the_emergency_stop_act_in_the_cycle_in_which_they_are_read) {
  for (const auto& [point, level] : {std::pair("x_limit_plus", 1.0), std::pair("estop_chain_ok", 0.0)}) {
    AtConstantSpeed mill(true);
    mill.look_at(point);
    play(mill, point, level);
    ASSERT_TRUE(mill.until([&] { return mill.slower_in >= 0; }, 2.0)) << point << mill.alarm_list();
    EXPECT_EQ(mill.slower_in, mill.read_in) << point;
  }
}

TEST(ReactionCycle, a_limit_switch_of_one_axis_slows_the_other_axes_in_the_same_cycle) {
  AtConstantSpeed mill(true);
  play(mill, "y_limit_plus", 1.0);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kHardLimitPlus) > 0; }, 2.0))
      << mill.alarm_list();
  mill.run(0.1);
  EXPECT_EQ(mill.slower_in, mill.raised_in(axis::alarm::kHardLimitPlus)) << mill.alarm_list();
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(ReactionCycle, a_reset_in_the_cycle_of_an_alarm_does_not_take_it_back_unseen) {
  AtConstantSpeed mill(false);
  play(mill, "x_limit_plus", 1.0);
  bool asked = false;
  for (int cycle = 0; cycle < 200; ++cycle) {
    mill.post(RequestKind::reset);
    mill.run(0.001);
    if (mill.alarms(axis::alarm::kHardLimitPlus) == 0) continue;
    asked = true;
    break;
  }
  ASSERT_TRUE(asked) << mill.alarm_list();
  EXPECT_TRUE(mill.control().cycle().alarms().active(axis::alarm::kHardLimitPlus));
}

}  // namespace
}  // namespace servogate::machine_run
