// SPDX-License-Identifier: Apache-2.0
// Programs that probe.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "kernel/channel/alarms/master_alarms.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;

/// Text of the last message.
std::string message(const Rig& rig) {
  return rig.process->texts().message(rig.status().message).value_or("");
}

constexpr std::string_view kTouch = "(DPT,10,12,600)\nG72 Z-50 E30\n(DIS,E30)\nG0 X7\nM30\n";

TEST(ProbeProgram, knows_where_it_touched_to_a_tenth_of_the_way_of_a_cycle) {
  for (const double surface : {-48.1234, -50.00037, -51.777}) {
    Rig rig(kTouch);
    rig.drives.surface_at(surface);
    double deepest = 0.0;
    rig.each = [&] { deepest = std::min(deepest, rig.x(2)); };
    ASSERT_TRUE(rig.finish()) << rig.alarm_list();
    const double said = std::strtod(message(rig).substr(message(rig).find('=') + 1).c_str(), nullptr);
    std::printf("touch at %.5f mm, said %.5f mm, stopped at %.4f mm\n", surface, said, deepest);
    EXPECT_NEAR(said, surface, 0.1 * 10.0 * 0.001) << message(rig);
    EXPECT_GT(deepest, surface - 0.5) << "the rest of the way is dropped";
    EXPECT_NEAR(rig.x(2), 0.0, 1e-6) << "and back at rapid";
    EXPECT_NEAR(rig.x(0), 7.0, 1e-6) << "the program goes on";
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(ProbeProgram, keeps_each_touch_for_the_report) {
  Rig rig("(DPT,10,12,600)\nG72 Z-50 E30\nG0 X7\nG72 Z-50 E30\nM30\n");
  rig.drives.surface_at(-48.125);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  const std::vector<TouchPlace> touches = rig.process->feeder().touch_log().all();
  ASSERT_EQ(touches.size(), 2u);
  for (const std::size_t n : {0u, 1u}) {
    EXPECT_NEAR(touches[n].at[2], -48.125, 0.001) << n;
    EXPECT_NEAR(touches[n].from[0], n == 0 ? 0.0 : 7.0, 1e-9) << n;
    EXPECT_EQ(touches[n].to[0], touches[n].from[0]) << "along Z only";
    EXPECT_LT(touches[n].to[2], -50.0 + 1e-9) << n;
    EXPECT_EQ(touches[n].feed_mm_min, 600.0) << n;
  }
}

TEST(ProbeProgram, of_an_input_without_times_is_known_to_the_way_of_a_cycle) {
  Rig rig(kTouch);
  rig.drives.surface_at(-49.3217);
  rig.drives.edges = false;
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  const double said = std::strtod(message(rig).substr(message(rig).find('=') + 1).c_str(), nullptr);
  EXPECT_NEAR(said, -49.3217, 10.0 * 0.001 + 1e-6);
}

TEST(ProbeProgram, finds_centre_and_radius_of_a_hole_by_four_touches) {
  Rig rig("(DPT,5,6,600)\nG0 X20 Y-10\nG73 r30 E40\n(DIS,E40,E41,E42)\nM30\n");
  rig.drives.clearance = [](const std::array<double, kAxes>& at) {
    return 30.5 - std::hypot(at[0] - 20.25, at[1] + 9.5);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  double x = 0.0, y = 0.0, r = 0.0;
  ASSERT_EQ(std::sscanf(message(rig).c_str(), "E40=%lf E41=%lf E42=%lf", &x, &y, &r), 3) << message(rig);
  EXPECT_NEAR(x, 20.25, 0.002);
  EXPECT_NEAR(y, -9.5, 0.002);
  EXPECT_NEAR(r, 30.5, 0.01) << "of chords half a millimetre beside the centre";
  EXPECT_EQ(rig.violations(), "");
}

TEST(ProbeProgram, gives_what_a_surface_is_off) {
  Rig rig("(DPT,5,6,600)\nG74 Z-50 E40\n(DIS,E40)\nM30\n");
  rig.drives.surface_at(-51.25);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(std::strtod(message(rig).substr(4).c_str(), nullptr), -1.25, 0.001) << message(rig);
}

TEST(ProbeProgram, stops_with_an_alarm_where_it_touches_nothing) {
  Rig rig(kTouch);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kProbeMissed), 1) << rig.alarm_list();
  EXPECT_NEAR(rig.x(2), -62.0, 1e-6);
  EXPECT_EQ(rig.alarm(alarm::kProbeMissed)->line, 2);
}

TEST(ProbeProgram, on_a_machine_without_a_probe_is_an_alarm) {
  Rig rig(kTouch, "G27", 0.5, RigKind::blind);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kProbeNone), 1) << rig.alarm_list();
}

TEST(ProbeProgram, does_not_move_with_a_probe_that_is_deflected_before) {
  Rig rig("(DPT,60,12,600)\nG72 Z-50 E30\nM30\n");
  rig.drives.surface_at(1.0);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kProbeStuck), 1) << rig.alarm_list();
  EXPECT_EQ(rig.x(2), 0.0);
}

TEST(ProbeProgram, whose_contacts_bounce_counts_the_first_edge_and_is_no_touch_in_the_rapid_back) {
  for (const bool edges : {true, false}) {
    Rig rig(kTouch);
    rig.drives.surface_at(-49.3217);
    rig.drives.edges = edges;
    rig.drives.bounce_cycles = 12;
    ASSERT_TRUE(rig.finish()) << rig.alarm_list();
    const double said = std::strtod(message(rig).substr(message(rig).find('=') + 1).c_str(), nullptr);
    EXPECT_NEAR(said, -49.3217, edges ? 0.001 : 0.010 + 1e-6) << edges;
    EXPECT_EQ(rig.alarm_list(), "");
  }
}

TEST(ProbeProgram, that_touches_at_the_end_of_its_way_has_touched) {
  // From a hundredth before the end on, where the set-point has arrived before the axis.
  for (const double surface : {-61.9, -61.99, -61.999, -61.9999}) {
    Rig rig(kTouch);
    rig.drives.surface_at(surface);
    ASSERT_TRUE(rig.finish()) << surface << " " << rig.alarm_list();
    const double said = std::strtod(message(rig).substr(message(rig).find('=') + 1).c_str(), nullptr);
    EXPECT_NEAR(said, surface, 0.001);
    EXPECT_NEAR(rig.x(0), 7.0, 1e-6) << "the program goes on";
  }
}

TEST(ProbeProgram, whose_touch_is_told_in_the_cycle_of_its_end_or_just_behind_has_touched) {
  for (int late = 0; late < 8; ++late) {
    Rig rig(kTouch);
    rig.drives.surface_at(-200.0);
    rig.drives.edges = false;
    int rests = -1;
    rig.each = [&] {
      if (rests < 0 && std::abs(rig.x(2) + 62.0) < 1e-9 && rig.image().axes[2].in_position) rests = 0;
      if (rests >= 0 && rests++ == late) rig.drives.surface_at(-61.9999);
    };
    ASSERT_TRUE(rig.finish()) << late << " " << rig.alarm_list();
    EXPECT_NEAR(rig.x(0), 7.0, 1e-6);
  }
}

TEST(ProbeProgram, knows_where_its_drives_have_latched_the_touch) {
  Rig rig("(DPT,10,12,600)\nG72 X40 Z-30 E30\n(DIS,E30,E31)\nM30\n", "G27", 0.5, RigKind::latching);
  rig.drives.edges = false;
  rig.drives.clearance = [](const std::array<double, kAxes>& at) { return at[2] + 30.4321; };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  double x = 0.0, z = 0.0;
  ASSERT_EQ(std::sscanf(message(rig).c_str(), "E30=%lf E31=%lf", &x, &z), 2) << message(rig);
  EXPECT_NEAR(z, -30.4321, 1e-4) << "to the count, from an input that is known to a cycle";
  EXPECT_NEAR(x, 40.0 * 30.4321 / 30.0, 1e-4);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ProbeProgram, whose_moving_axis_has_no_latch_ends_with_an_alarm_that_names_it) {
  Rig rig("(DPT,10,12,600)\nG72 X40 Z-30 E30\nM30\n", "G27", 0.5, RigKind::latching);
  rig.drives.clearance = [](const std::array<double, kAxes>& at) { return at[2] + 30.4321; };
  rig.drives.latches[0] = false;
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kProbeNotLatched), 1) << rig.alarm_list();
  EXPECT_EQ(rig.alarm(alarm::kProbeNotLatched)->axis, 0);
}

TEST(ProbeProgram, whose_probe_stays_deflected_behind_the_touch_stops_with_an_alarm) {
  Rig rig(kTouch);
  rig.drives.surface_at(-49.0);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.image().packets.bit(kProbePlace); }));
  rig.drives.clearance = [](const std::array<double, kAxes>&) { return -1.0; };
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kProbeNotFree), 1) << rig.alarm_list();
  EXPECT_LT(rig.x(2), -10.0) << "on its way back";
  EXPECT_EQ(rig.violations(), "");
}

TEST(ProbeProgram, that_touches_in_a_rapid_stops_with_an_alarm) {
  Rig rig(kTouch);
  rig.drives.surface_at(-20.0);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kProbeInRapid), 1) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
}

}  // namespace
}  // namespace servogate::channel::test
