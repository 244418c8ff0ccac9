// SPDX-License-Identifier: Apache-2.0
// What operator, PLC and faults do to a running program: hold, override, step, reset, alarm.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "tests/channel/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::channel::test {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;

constexpr const char* kLongLine = "N10 G1 X200 Y100 F9000\nN20 X0 Y100\nN30 M30\n";

TEST(Hold, stops_on_the_path_within_the_limits_and_resume_goes_on_from_there) {
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  ASSERT_GT(rig.status().feed_mm_s, 100.0);
  ASSERT_EQ(rig.ask(RequestKind::hold), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held; }, 1.0));
  const double stood = rig.x();
  EXPECT_LT(off_line(rig.path.back(), 0, 0, 200, 100), 1e-6);
  rig.run(1.0);
  EXPECT_EQ(rig.x(), stood);
  EXPECT_EQ(rig.state(), ProcessState::held);
  ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 0.0, 1e-9);
  EXPECT_NEAR(rig.x(1), 100.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Hold, comes_from_feed_enable_and_from_a_single_axis_just_the_same) {
  const auto try_it = [](const char* what, auto&& hold, auto&& release) {
    Rig rig(kLongLine);
    rig.start();
    rig.run(0.6);
    hold(rig.logic);
    EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::held; }, 1.0)) << what;
    EXPECT_LT(off_line(rig.path.back(), 0, 0, 200, 100), 1e-6) << what;
    rig.run(0.3);
    release(rig.logic);
    EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << what << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "") << what;
  };
  try_it(
      "feed_enable", [](TestLogic& l) { l.feed_enable = false; }, [](TestLogic& l) { l.feed_enable = true; });
  try_it(
      "Y.feed_enable", [](TestLogic& l) { l.axis_feed_enable[1] = false; },
      [](TestLogic& l) { l.axis_feed_enable[1] = true; });
}

TEST(Starved, program_slows_down_on_its_path_and_says_so_and_goes_on_when_its_blocks_come) {
  std::string program = "G1 F6000\n";
  for (int n = 0; n < 300; ++n) program += "X20\nX0\n";  // more than is planned ahead
  Rig rig(program + "M30\n");
  rig.start();
  rig.run(0.3);
  bool reads = false;
  rig.read = [&] {
    if (reads) rig.process->work();
  };
  ASSERT_TRUE(rig.until([&] { return rig.alarms(cycle::alarm::kStarved) > 0; }, 60.0));
  EXPECT_EQ(rig.state(), ProcessState::running) << "a warning stops nothing";
  EXPECT_GT(rig.status().starved, 0u);
  reads = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, 300.0)) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 0.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Hold, by_the_plcs_stop_ends_with_start_or_resume_and_not_before_the_stop_has_gone) {
  for (const RequestKind go_on : {RequestKind::start, RequestKind::resume}) {
    Rig rig(kLongLine);
    rig.start();
    rig.run(0.6);
    rig.logic.stop_bit = true;
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held; }, 1.0));
    rig.ask(go_on);
    rig.run(0.3);
    EXPECT_EQ(rig.state(), ProcessState::held);
    EXPECT_EQ(rig.status().wait.reason, image::WaitReason::plc_hold);
    rig.logic.stop_bit = false;
    rig.run(0.5);
    EXPECT_EQ(rig.state(), ProcessState::held) << "it does not go on by itself";
    EXPECT_EQ(rig.status().wait.reason, image::WaitReason::operator_hold);
    rig.ask(go_on);
    EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(Hold, by_the_plcs_stop_during_a_function_holds_behind_it) {
  Rig rig("N10 M8\nN20 G1 X10 F6000\nN30 M30\n", "G29");
  rig.logic.delay_cycles = 300;
  rig.start();
  rig.run(0.1);
  rig.logic.stop_bit = true;
  rig.run(0.05);
  rig.logic.stop_bit = false;
  rig.run(1.0);
  EXPECT_EQ(rig.x(), 0.0) << "what was told to stop does not begin to move";
  rig.ask(RequestKind::resume);
  EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST(Hold, hands_no_word_to_the_plc_and_no_time_of_its_acknowledge_runs) {
  Rig rig("N10 M8\nN20 M9\nN30 G1 X10 F6000\nN40 M30\n", "G29");
  rig.logic.delay_cycles = 20'000;  // longer than the time for an acknowledge
  rig.start();
  rig.run(0.1);
  ASSERT_EQ(rig.logic.strobes.size(), 1u);
  rig.logic.stop_bit = true;
  rig.run(0.1);
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::plc_hold) << "that helps first";
  rig.logic.stop_bit = false;
  rig.run(22.0);
  EXPECT_NE(rig.state(), ProcessState::stopped_by_alarm) << rig.alarm_list();
  EXPECT_EQ(rig.logic.strobes.size(), 1u) << "M9 waits for a resume";
  EXPECT_EQ(rig.state(), ProcessState::held);
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::operator_hold);
  rig.logic.delay_cycles = 3;
  ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_EQ(rig.logic.strobes.size(), 3u) << "M8, M9, M30";
}

TEST(ReadIn, waits_before_each_function_for_the_plcs_leave) {
  Rig rig("N10 M8\nN20 G1 X10 F6000\nN30 M9\nN40 M30\n", "G29");
  rig.logic.read_in_enable = false;
  rig.start();
  rig.run(0.5);
  EXPECT_TRUE(rig.logic.strobes.empty());
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::read_in_enable);
  rig.logic.read_in_enable = true;
  EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST(Hold, in_every_state_of_a_program_keeps_it_able_to_go_on) {
  // The program waits in a handshake, dwells, moves, waits for a signal; a hold at any moment changes only
  // times.
  const char* program =
      "N5 TMR=0.1\nN10 M8\nN20 G1 X10 F6000\nN30 G4\nN40 X20\nN50 SK10=1\nN60 E1=SK10.IN\nN70 X30 M9\nN80 "
      "M30\n";
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937 random(seed);
  for (int i = 0; i < 25; ++i) {
    Rig rig(program, "G29");
    rig.logic.delay_cycles = 50;
    rig.start();
    rig.run(0.001 * static_cast<double>(random() % 1200));
    rig.ask(RequestKind::hold);
    rig.run(0.001 * static_cast<double>(1 + random() % 400));
    EXPECT_NE(rig.state(), ProcessState::stopped_by_alarm) << rig.alarm_list();
    rig.run(0.3);
    const double stood = rig.x();
    rig.run(0.3);
    EXPECT_EQ(rig.x(), stood) << "moves while held, seed " << seed;
    const Refusal refusal = rig.ask(RequestKind::resume);
    EXPECT_TRUE(refusal == Refusal::none || rig.state() != ProcessState::held);
    EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, 10.0))
        << "seed " << seed << " state " << static_cast<int>(rig.state()) << " x " << rig.x() << ' '
        << rig.alarm_list();
    EXPECT_NEAR(rig.x(), 30.0, 1e-9);
    EXPECT_EQ(rig.violations(), "") << "seed " << seed;
  }
}

TEST(Override, acts_at_once_and_zero_holds) {
  Rig rig("N10 G1 X290 F6000\nN20 M30\n");
  rig.start();
  rig.run(0.5);
  EXPECT_NEAR(rig.status().feed_mm_s, 100.0, 1e-6);
  for (const double ratio : {0.5, 1.2, 0.05, 1.0}) {
    ASSERT_EQ(rig.ask(RequestKind::override_feed, ratio), Refusal::none);
    rig.run(0.5);
    EXPECT_NEAR(rig.status().feed_mm_s, 100.0 * ratio, 1e-6);
    EXPECT_EQ(rig.status().override_ratio, ratio);
  }
  rig.ask(RequestKind::override_feed, 0.0);
  rig.run(0.5);
  EXPECT_EQ(rig.status().feed_mm_s, 0.0);
  rig.ask(RequestKind::override_feed, 1.0);
  rig.logic.feed_override = 30;
  rig.run(0.5);
  EXPECT_NEAR(rig.status().feed_mm_s, 30.0, 1e-6) << "the PLC's value goes before the operator's";
  rig.logic.feed_override = 0;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
}

TEST(Override, above_its_limit_or_below_zero_is_refused) {
  Rig rig(kLongLine);
  EXPECT_EQ(rig.ask(RequestKind::override_feed, 1.51), Refusal::override_range);
  EXPECT_EQ(rig.ask(RequestKind::override_feed, -0.1), Refusal::override_range);
}

TEST(Stop, ends_the_program_on_the_path_and_reset_makes_it_startable_anew) {
  for (const RequestKind kind : {RequestKind::stop, RequestKind::reset}) {
    Rig rig(kLongLine);
    rig.start();
    rig.run(0.6);
    ASSERT_EQ(rig.ask(kind), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle; }, 1.0));
    rig.run(0.002);
    EXPECT_FALSE(rig.moving());
    EXPECT_LT(off_line(rig.path.back(), 0, 0, 200, 100), 1e-6);
    EXPECT_EQ(rig.image().axes[0].owner, image::AxisOwner::none);
    ASSERT_TRUE(rig.finish()) << rig.alarm_list();
    EXPECT_NEAR(rig.x(1), 100.0, 1e-9);
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(Stop, again_and_again_at_random_moments_never_breaks_a_limit_nor_the_next_start) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937 random(seed);
  Rig rig(
      "N10 M8\nN20 G1 X30 Y10 F6000\nN30 X35 Y40\nN40 G2 X45 Y50 I45 J40\nN50 SK10=1\nN60 G0 X0 Y0\nN70 "
      "M30\n");
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(rig.until([&] { return rig.ask(RequestKind::start) == Refusal::none; }, 3.0))
        << "seed " << seed << rig.alarm_list();
    rig.run(0.001 * static_cast<double>(random() % 1500));
    rig.ask(random() % 2 == 0 ? RequestKind::stop : RequestKind::reset);
    ASSERT_TRUE(rig.until([&] { return !rig.moving() && rig.state() != ProcessState::running; }, 3.0))
        << "seed " << seed << " state " << static_cast<int>(rig.state());
  }
  ASSERT_TRUE(rig.finish()) << "seed " << seed << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "") << "seed " << seed;
}

TEST(Step, runs_one_block_with_each_press) {
  Rig rig("N10 G1 X5 F6000\nN20 X10\nN30 M8\nN40 X15\nN50 M30\n");
  ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(image::Mode::step)), Refusal::none);
  std::vector<double> stops;
  ASSERT_EQ(rig.ask(RequestKind::step), Refusal::none);
  for (int i = 0; i < 10; ++i) {
    rig.run(1.0);
    if (stops.empty() || stops.back() != rig.x()) stops.push_back(rig.x());
    if (rig.state() == ProcessState::ended) break;
    EXPECT_EQ(rig.ask(RequestKind::step), Refusal::none) << "a press after block " << i;
  }
  EXPECT_EQ(rig.state(), ProcessState::ended) << rig.alarm_list();
  ASSERT_GE(stops.size(), 3u);
  EXPECT_NEAR(stops[0], 5.0, 1e-9);
  EXPECT_NEAR(stops[1], 10.0, 1e-9);
  EXPECT_NEAR(stops[2], 15.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Step, is_followed_by_a_run_to_the_end_where_start_asks_for_auto) {
  for (const int steps : {1, 2, 3}) {
    Rig rig("N10 G1 X5 F6000\nN20 X10\nN30 M8\nN40 X15\nN50 M0\nN60 X20\nN70 M30\n");
    ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(image::Mode::step)), Refusal::none);
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(rig.ask(RequestKind::step), Refusal::none);
      rig.run(1.0);
    }
    ASSERT_EQ(rig.state(), ProcessState::waiting);
    image::Request on;
    on.kind = RequestKind::start;
    on.mode = static_cast<std::int8_t>(image::Mode::automatic);
    ASSERT_EQ(rig.ask(on), Refusal::none);
    rig.run(3.0);
    EXPECT_EQ(rig.state(), ProcessState::waiting) << "M0 stops it all the same";
    EXPECT_NEAR(rig.x(), 15.0, 1e-9);
    EXPECT_EQ(rig.image().processes[0].mode, image::Mode::automatic);
    EXPECT_EQ(rig.ask(RequestKind::step), Refusal::not_stepping);
    ASSERT_EQ(rig.ask(RequestKind::start), Refusal::none);
    rig.run(3.0);
    EXPECT_EQ(rig.state(), ProcessState::ended) << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "");
  }
}

std::string short_blocks(int count) {
  std::string program = "N1 G1 X0 F6000\n";
  for (int k = 1; k <= count; ++k) program += "X" + std::to_string(0.3 * k) + "\n";
  return program + "M30\n";
}

TEST(Step, is_followed_by_a_run_that_rests_no_more_behind_what_was_planned_ahead) {
  for (const bool with_mode : {true, false}) {
    Rig rig(short_blocks(900));
    if (with_mode) {
      ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(image::Mode::step)), Refusal::none);
    }
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(rig.ask(RequestKind::step), Refusal::none) << with_mode;
      rig.run(1.0);
      if (!with_mode) break;  // in AUTO what is planned goes on to its end
    }
    image::Request on;
    on.kind = RequestKind::start;
    on.mode = static_cast<std::int8_t>(image::Mode::automatic);
    ASSERT_EQ(rig.ask(on), Refusal::none);
    double fastest = 0.0;
    ASSERT_TRUE(rig.until(
        [&] {
          fastest = std::max(fastest, rig.status().feed_mm_s);
          return rig.state() == ProcessState::ended;
        },
        40.0))
        << "in line " << rig.status().line << " of 900, at most " << fastest << " mm/s";
    EXPECT_GT(fastest, 90.0);
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(Hold, is_taken_back_while_the_path_still_slows_down) {
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  for (const RequestKind on : {RequestKind::resume, RequestKind::start}) {
    ASSERT_EQ(rig.ask(RequestKind::hold), Refusal::none);
    rig.run(0.03);
    ASSERT_EQ(rig.state(), ProcessState::running);
    ASSERT_EQ(rig.ask(on), Refusal::none);
    rig.run(0.6);
    EXPECT_GT(rig.status().feed_mm_s, 0.0);
    EXPECT_EQ(rig.ask(on), on == RequestKind::resume ? Refusal::program_not_held : Refusal::program_runs);
  }
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
}

TEST(Start, takes_the_place_where_the_axes_stand_after_a_jog) {
  Rig rig("N10 G91 G1 X10 F6000\nN20 M30\n");
  ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  ASSERT_EQ(rig.ask(RequestKind::jog_increment, 7.0, 0), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return !rig.moving() && rig.x() == 7.0; }, 5.0));
  rig.run(0.5);
  ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(image::Mode::automatic)), Refusal::none);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 17.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Program, with_an_error_runs_up_to_it_and_stops_in_the_end_point_of_the_block_before) {
  Rig rig("N10 G1 X20 F6000\nN20 X40\nN30 X60 Q\nN40 X80\nN50 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 10.0))
      << static_cast<int>(rig.state());
  const image::AlarmRecord* a = rig.alarm(cycle::alarm::kProgramError);
  ASSERT_NE(a, nullptr) << rig.alarm_list();
  EXPECT_EQ(a->line, 3);
  rig.run(0.5);
  EXPECT_NEAR(rig.x(), 40.0, 1e-9);
  const auto finding = rig.process->texts().finding(static_cast<std::int32_t>(a->value));
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->line, 3);
  EXPECT_EQ(rig.violations(), "");
}

TEST(Fault, of_one_drive_stops_the_other_axes_together_on_the_path_and_none_of_them_steps) {
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  rig.drives.fault[1] = true;
  const double before = rig.x();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }, 3.0))
      << rig.alarm_list();
  EXPECT_EQ(rig.alarms(axis::alarm::kDriveFault), 1) << rig.alarm_list();
  EXPECT_GT(rig.x(), before) << "X does not stop dead";
  EXPECT_EQ(rig.violations(), "");
}

TEST(Fault, that_asks_for_a_stop_on_the_path_stays_on_it) {
  // An external alarm of the PLC: all drives stay able.
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  rig.logic.external_alarm = 701;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }, 3.0));
  const image::AlarmRecord* a = rig.alarm(cycle::alarm::kExternalAlarm);
  ASSERT_NE(a, nullptr) << rig.alarm_list();
  EXPECT_EQ(a->value, 701.0);
  for (std::size_t i = rig.path.size() - 400; i < rig.path.size(); ++i)
    ASSERT_LT(off_line(rig.path[i], 0, 0, 200, 100), 1e-6) << i;
  EXPECT_EQ(rig.violations(), "");
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::alarm_active);
  rig.ask(RequestKind::reset);
  rig.run(0.3);
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::alarm_active) << "the cause is still there";
  rig.logic.external_alarm = 0;
  rig.run(0.3);
  rig.ask(RequestKind::reset);
  rig.run(0.3);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
}

TEST(Fault, of_following_names_the_axis_and_stops_the_rest) {
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  rig.drives.stuck[0] = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }, 3.0));
  const image::AlarmRecord* a = rig.alarm(axis::alarm::kFollowingError);
  ASSERT_NE(a, nullptr) << rig.alarm_list();
  EXPECT_EQ(a->axis, 0);
  EXPECT_GT(std::abs(a->value), a->limit);
}

bool any_axis(const Rig& rig) { return rig.moving(); }
bool axis_x(const Rig& rig) { return rig.image().axes[0].moving; }

/// Short blocks, which are driven as a course, at the acceleration of the axes.
std::string fast_circle() {
  std::string program = "G1 F12000\n";
  for (int k = 1; k <= 400; ++k) {
    const double a = 2 * std::numbers::pi * k / 200;
    program += "X" + std::to_string(40 - 40 * std::cos(a)) + " Y" + std::to_string(40 * std::sin(a)) + "\n";
  }
  return program + "M30\n";
}

/// Asks for less speed there.
void begin_change(Rig& rig) {
  rig.start();
  EXPECT_TRUE(rig.until([&] { return rig.x() > 30.0; }));
  EXPECT_GT(rig.status().feed_mm_s, 150.0);
  EXPECT_EQ(rig.ask(RequestKind::override_feed, 0.2), Refusal::none);
}

/// Seconds from when the machine loses its leave to move until what is asked about rests, `after` ms behind a
/// change of the override.
double seconds_to_rest(int after, const std::function<void(Rig&)>& lose,
                       bool (*moves)(const Rig&) = any_axis) {
  Rig rig(fast_circle());
  begin_change(rig);
  rig.run(0.001 * after);
  lose(rig);
  const double began = rig.now();
  EXPECT_TRUE(rig.until([&] { return !moves(rig); }, 5.0));
  const double seconds = rig.now() - began;
  EXPECT_TRUE(rig.until([&] { return !rig.moving(); }, 5.0));
  EXPECT_TRUE(rig.until([&] { return rig.state() != ProcessState::running; }, 5.0)) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
  return seconds;
}

TEST(EmergencyStop, along_a_course_never_waits_for_a_change_of_rate) {
  // By the limits of one axis 200 mm/s take 0.3 s; the change of the override takes longer.
  const double stop = kLimits.velocity * 0.4 / kLimits.acceleration + kLimits.acceleration / kLimits.jerk;
  for (const int after : {0, 5, 60, 150, 300}) {
    EXPECT_LE(seconds_to_rest(after, [](Rig& rig) { rig.logic.estop_ok = false; }), stop + 0.13) << after;
    EXPECT_LE(seconds_to_rest(after, [](Rig& rig) { rig.logic.power_on = false; }), stop + 0.13) << after;
  }
  Rig rig(fast_circle());
  begin_change(rig);
  const double began = rig.now(), feed = rig.status().feed_mm_s;
  EXPECT_TRUE(rig.until([&] { return rig.status().feed_mm_s < 0.21 * feed; }, 5.0));
  EXPECT_GE(rig.now() - began, stop + 0.13);
}

TEST(LimitSwitch, along_a_course_stops_its_axis_without_waiting_for_a_change_of_rate) {
  const double stop = kLimits.velocity * 0.4 / kLimits.acceleration + kLimits.acceleration / kLimits.jerk;
  for (const int after : {0, 5, 60, 150, 300})
    EXPECT_LE(seconds_to_rest(
                  after, [](Rig& rig) { rig.logic.limit_plus[0] = true; }, axis_x),
              stop + 0.13)
        << after;
}

TEST(LostEnable, along_a_course_stops_its_axis_without_waiting_for_a_change_of_rate) {
  const double stop = kLimits.velocity * 0.4 / kLimits.acceleration + kLimits.acceleration / kLimits.jerk;
  for (const int after : {0, 5, 60, 150, 300})
    EXPECT_LE(seconds_to_rest(
                  after, [](Rig& rig) { rig.logic.axis_enable[0] = false; }, axis_x),
              stop + 0.13)
        << after;
}

TEST(EmergencyStop, during_motion_ramps_down_takes_the_power_at_rest_and_gives_it_back_only_when_asked) {
  Rig rig(kLongLine);
  rig.start();
  rig.run(0.6);
  rig.logic.estop_ok = false;
  rig.run(0.003);
  EXPECT_TRUE(rig.moving());
  for (; rig.moving(); rig.run(0.001))
    for (const int a : {0, 1}) {
      const image::AxisImage& axis = rig.image().axes[static_cast<std::size_t>(a)];
      ASSERT_TRUE(!axis.moving || axis.drive_command.power) << "axis " << a;
    }
  rig.run(0.002);
  for (int a = 0; a < kAxes; ++a)
    EXPECT_FALSE(rig.image().axes[static_cast<std::size_t>(a)].drive_command.power) << "axis " << a;
  EXPECT_EQ(rig.violations(), "");
  EXPECT_EQ(rig.alarms(cycle::alarm::kEmergencyStop), 1) << rig.alarm_list();
  rig.run(0.5);
  EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
  rig.logic.estop_ok = true;
  rig.run(0.5);
  for (int a = 0; a < kAxes; ++a)
    EXPECT_FALSE(rig.image().axes[static_cast<std::size_t>(a)].drive_command.power)
        << "closing the chain alone switches nothing on";
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::emergency_stop);
  EXPECT_EQ(rig.ask(RequestKind::reset), Refusal::none);
  EXPECT_EQ(rig.ask(RequestKind::power, 1.0), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.image().axes[0].enabled; }, 2.0)) << rig.alarm_list();
}

}  // namespace
}  // namespace servogate::channel::test
