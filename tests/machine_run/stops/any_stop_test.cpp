// SPDX-License-Identifier: Apache-2.0
// Whatever stops a machine in motion, and whatever somebody does then: no set-point breaks a limit of its
// axis.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/property_seed.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::Mode;
using image::ProcessState;
using image::RequestKind;

// Always in two axes at once, so that one that leaves the path has a path to come back to.
constexpr const char* kRound =
    "N10 G90 G94 G71\nN20 G0 X0 Y0\nN30 G3 I40 J0 F2400\nN40 G27 G1 X60 Y30 Z-20 F9000\n"
    "N50 X-40 Y35\nN60 G2 X-40 Y35 I-10 J0\nN70 G1 X0 Y0 Z0\nN80 M30\n";

/// A mill in motion on the arc.
class OnTheArc : public Mill {
 public:
  OnTheArc() : Mill(kRound) {
    EXPECT_TRUE(make_ready()) << alarm_list();
    EXPECT_EQ(ask(RequestKind::start), Refusal::none);
    run(2.0);
    EXPECT_EQ(process().state, ProcessState::running);
    EXPECT_GT(process().feed_mm_s, 30.0);
  }
  double off_the_arc() const {
    return std::abs(std::hypot(axis("X").command - 40.0, axis("Y").command) - 40.0);
  }
};

TEST(AnyStop, by_a_limit_switch_stops_every_axis_within_its_limits_and_none_comes_back_to_the_path) {
  OnTheArc mill;
  mill.control().world().play_input("x_limit_plus", {1.0});
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::stopped_by_alarm; }, 2.0));
  mill.run(1.0);
  EXPECT_EQ(mill.alarms(axis::alarm::kHardLimitPlus), 1) << mill.alarm_list();
  EXPECT_EQ(mill.judge().verdict(), "");
  EXPECT_GT(mill.off_the_arc(), 0.01) << "each axis at its own limits leaves the path";
  EXPECT_GE(mill.alarms(axis::alarm::kOffPath), 1) << "and that is said: " << mill.alarm_list();
}

TEST(AnyStop, by_taking_the_drives_power_brakes_along_the_path_first) {
  OnTheArc mill;
  double off = 0.0;
  mill.after_cycle = [&] {
    if (mill.axis("X").drive_command.power) off = std::max(off, mill.off_the_arc());
  };
  ASSERT_EQ(mill.ask(RequestKind::power, 0.0), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return !mill.axis("X").drive_command.power; }, 2.0));
  EXPECT_LT(off, 1e-4);
  EXPECT_TRUE(mill.standing());
  EXPECT_EQ(mill.judge().verdict(), "");
  mill.run(0.5);
  EXPECT_NE(mill.process().state, ProcessState::running);
  for (const char* letter : {"X", "Y", "Z"}) EXPECT_FALSE(mill.axis(letter).drive_command.power) << letter;
  EXPECT_EQ(mill.alarms(axis::alarm::kOffPath), 0) << mill.alarm_list();
}

/// Somebody who does anything at any time.
class Anybody {
 public:
  Anybody(Mill& mill, std::mt19937_64& random) : mill_(mill), random_(random) {}
  void act() {
    switch (draw(18)) {
      case 0:
        return mill_.post(RequestKind::power, 0.0);
      case 1:
      case 2:
        return mill_.post(RequestKind::power, 1.0);
      case 3:
      case 4:
        return mill_.post(RequestKind::reset);
      case 5:
        return mill_.post(RequestKind::hold);
      case 6:
        return mill_.post(RequestKind::resume);
      case 7:
        return mill_.post(RequestKind::override_feed, draw(151) / 100.0);
      case 8:
        return mill_.post(RequestKind::stop);
      case 9:
        return mill_.post(RequestKind::quick_stop);
      case 10:
        return mill_.post(RequestKind::mode,
                          static_cast<double>(draw(2) == 0 ? Mode::manual : Mode::automatic));
      case 11:
        return mill_.post(RequestKind::jog_increment, draw(41) - 20.0, draw(3));
      case 12:
        return input("door_closed", draw(2));
      case 13:
        return input(draw(2) == 0 ? "x_limit_plus" : "y_limit_minus", draw(2));
      case 14:
        return input("estop_chain_ok", draw(3) > 0);
      case 15:
        return mill_.post(RequestKind::home, 0.0, draw(3));
      default:
        mill_.post(RequestKind::mode, static_cast<double>(Mode::automatic));
        return mill_.post(RequestKind::start);
    }
  }

 private:
  int draw(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }
  void input(const char* name, int value) {
    if (std::string_view(name).find("limit") != std::string_view::npos)
      mill_.control().world().play_input(name, {static_cast<double>(value)});
    else
      mill_.control().world().set_input(name, value != 0);
  }
  Mill& mill_;
  std::mt19937_64& random_;
};

TEST(AnyStop, of_anybody_at_any_time_keeps_every_limit) {
  const char* given = std::getenv("SERVOGATE_PROPERTY_CASES");
  const int cases = given != nullptr ? std::max(1, std::atoi(given) / 20) : 60;
  std::mt19937_64 random(test::property_seed());
  int stops = 0;
  for (int n = 0; n < cases; ++n) {
    OnTheArc mill;
    Anybody anybody(mill, random);
    for (int i = 0; i < 40; ++i) {
      anybody.act();
      mill.run(std::uniform_real_distribution<double>(0.001, 0.3)(random));
    }
    stops += mill.alarms(axis::alarm::kHardLimitPlus) + mill.alarms(cycle::alarm::kEmergencyStop);
    EXPECT_EQ(mill.alarms(axis::alarm::kSetpointStep), 0) << "case " << n << ": " << mill.alarm_list();
    ASSERT_EQ(mill.judge().verdict(), "") << "case " << n << ": " << mill.alarm_list();
  }
  EXPECT_GT(stops, cases / 4) << "stops of each kind were among them";
}

}  // namespace
}  // namespace servogate::machine_run
