// SPDX-License-Identifier: Apache-2.0
// An axis that follows another axis or a spindle by a gear of the machine file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/coupling/electronic_gear.hpp"
#include "tests/axis/rig.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::axis {
namespace {

constexpr int kLinear = 0, kRotary = 1, kSecond = 2;
constexpr double kDt = 0.001, kMark = 777.0;

/// A linear axis X, an endless rotary axis C, a linear axis Z and a spindle with inertia and an encoder.
class Machine {
 public:
  Machine() {
    image.axis_count = 3;
    image.spindle_count = 1;
    for (std::size_t n = 0; n < axes.size(); ++n)
      axes[n].configure(axis_config(static_cast<int>(n)), static_cast<int>(n));
    spindle_config.max_rpm = 3000.0;
    spindle_config.acceleration = 1000.0;
    spindles[0].configure(spindle_config, 0);
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
    image.packets.set_bit(image::at(image::field(image::kSpindleFields, "enable"), image::spindle_base(0)),
                          true);
    for (int n = 0; n < 3; ++n) {
      permit(n, "enable", true);
      permit(n, "feed_enable", true);
      axes[static_cast<std::size_t>(n)].request_power(true);
    }
    run(300);
  }
  static AxisConfig axis_config(int n) {
    AxisConfig c;
    c.counts_numerator = 10000;
    c.limits = n == kRotary   ? MotionLimits{360.0, 2000.0, 40000.0}
               : n == kLinear ? MotionLimits{200.0, 400.0, 4000.0}
                              : MotionLimits{200.0, 1000.0, 10000.0};
    c.rotary = n == kRotary;
    c.travel_limited = n != kRotary;
    c.homing.method = HomingMethod::none;
    c.standstill_velocity = 0.5;
    c.following_error_limit = 5.0;
    return c;
  }
  void permit(int axis, std::string_view name, bool on) {
    for (const image::InterfaceField& f : image::kAxisFields)
      if (f.name == name) image.packets.set_bit(image::place(f, image::axis_base(axis)), on);
  }
  void gear(const ElectronicGearConfig& c) {
    gears.configure(c, axes);
    judged = static_cast<std::size_t>(c.follower);
    run(200);  // its master is known then
  }
  void turn_spindle() {
    image::SpindleImage& s = image.spindles[0];
    const bool on = s.drive_command.power;
    speed = on ? speed + (s.drive_command.velocity_counts_s - speed) * 0.2 : speed * 0.999;
    if (load != 0.0) speed *= 1.0 - load;
    const double before = place;
    place += speed * kDt;
    const auto whole = [](double counts) { return std::floor((counts - kMark) / 4096.0); };
    if (s.drive_command.latch_arm && whole(before) != whole(place)) {
      s.drive.latch_counts = static_cast<std::int64_t>(kMark + 4096.0 * whole(std::max(before, place)));
      ++s.drive.latch_sequence;
    }
    s.drive.online = spindle_online;
    s.drive.state = on ? image::DriveState::operation_enabled : image::DriveState::switch_on_disabled;
    s.drive.position_counts = std::llround(place + noise);
  }
  void cycle() {
    image.now.number += 1;
    image.now.t_ns += image.now.period_ns;
    turn_spindle();
    for (std::size_t n = 0; n < axes.size(); ++n)
      drives[n].cycle(image.axes[n].drive_command, image.axes[n].drive);
    for (Axis& a : axes) a.read(image);
    for (Spindle& s : spindles) s.read(image);
    const ElectronicGear::Machine m{axes, spindles};
    drive_all(m);
    collect();
    judge.add(axes[judged].setpoint().x);
    if (gears.in_step()) worst = std::max(worst, std::abs(gears.phase_error()));
  }
  void drive_all(const ElectronicGear::Machine& m) {
    const counting::Tally tally(allocated);
    gears.look(m, image);
    if (setpoint) axes[kLinear].set_process(*setpoint);
    for (Axis& a : axes) {
      a.react(reaction);
      if (!gears.on() || &a != &follower()) a.command(image);
    }
    gears.lead(m);
    command_all(spindles, reaction, image);
    if (gears.on()) {
      gears.step(m, image.now);
      follower().command(image);
    }
  }
  void collect() {
    for (Axis& a : axes) {
      for (const Event& e : a.events()) events.push_back(e);
      a.clear_events();
    }
    for (const Event& e : gears.events()) events.push_back(e);
    gears.clear_events();
  }
  void run(int n) {
    while (n-- > 0) cycle();
  }
  template <typename Until>
  bool until(Until&& what, int patience = 10000) {
    while (!what() && patience-- > 0) cycle();
    return what();
  }
  bool engage() {
    judge = test::Judge(axes[judged].setpoint().x, kDt);
    return gears.engage({axes, spindles});
  }
  bool in_step(int patience = 10000) {
    return until([&] { return gears.in_step(); }, patience);
  }
  bool at_rest() {
    return until([&] { return !axes[judged].geared() && axes[judged].standstill(); });
  }
  bool raised(image::AlarmNumber number) const {
    return std::any_of(events.begin(), events.end(), [&](const Event& e) { return e.number == number; });
  }
  Axis& follower() { return axes[judged]; }
  bool inside() const { return judge.within(axes[judged].config().limits); }
  double turns() const { return (place - kMark) / 4096.0; }

  image::ProcessImage image;
  std::array<Axis, 3> axes;
  std::array<test::FakeDrive, 3> drives;
  SpindleConfig spindle_config;
  std::array<Spindle, 1> spindles;
  ElectronicGear gears;
  image::Reaction reaction = image::Reaction::none;
  std::optional<Setpoint> setpoint;
  std::vector<Event> events;
  test::Judge judge{0.0, kDt};
  std::size_t judged = kRotary;
  std::uint64_t allocated = 0;  ///< by gear, axes and spindle
  double speed = 0.0, place = 0.0, load = 0.0, noise = 0.0, worst = 0.0;
  bool spindle_online = true;
};

/// A hob with one start and a wheel of 40 teeth.
ElectronicGearConfig hob(CouplingBy by = CouplingBy::measured) {
  ElectronicGearConfig c;
  c.follower = kRotary;
  c.master_spindle = 0;
  c.follower_turns = 1;
  c.master_turns = 40;
  c.by = by;
  c.window = 1.0;
  return c;
}

ElectronicGearConfig slide(CouplingBy by = CouplingBy::setpoint, std::int64_t follower = 1,
                           std::int64_t master = 1) {
  ElectronicGearConfig c;
  c.follower = kSecond;
  c.master_axis = kLinear;
  c.follower_turns = follower;
  c.master_turns = master;
  c.by = by;
  c.window = 0.5;
  return c;
}

TEST(ElectronicGear, turns_the_wheel_with_the_hob_at_the_exact_ratio_however_long) {
  for (const CouplingBy by : {CouplingBy::measured, CouplingBy::setpoint}) {
    Machine m;
    m.gear(hob(by));
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(2000);
    ASSERT_TRUE(m.engage());
    ASSERT_TRUE(m.in_step());
    m.run(1000);
    const double wheel = m.follower().setpoint().x, cutter = m.turns();
    m.run(20000);
    EXPECT_NEAR(m.follower().setpoint().x - wheel, (m.turns() - cutter) * 9.0, 0.02);
    EXPECT_LE(m.worst, 0.05);
    EXPECT_TRUE(m.events.empty());
    EXPECT_TRUE(m.inside());
  }
}

TEST(ElectronicGear, engages_while_its_master_turns_and_disengages_to_rest_inside_its_limits) {
  Machine m;
  ElectronicGearConfig c = hob();
  c.follower_turns = -1;
  c.master_turns = 4;
  m.gear(c);
  m.spindles[0].order(SpindleMode::cw, 200.0);
  m.run(2000);
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  EXPECT_NEAR(m.follower().setpoint().v, -200.0 / 60.0 * 90.0, 1.0);
  m.gears.disengage({m.axes, m.spindles});
  ASSERT_TRUE(m.at_rest());
  EXPECT_EQ(m.follower().owner(), image::AxisOwner::none);
  EXPECT_TRUE(m.events.empty());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, stays_in_step_through_a_dip_of_load_and_new_speeds) {
  for (const CouplingBy by : {CouplingBy::measured, CouplingBy::setpoint}) {
    Machine m;
    m.gear(hob(by));
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(2000);
    ASSERT_TRUE(m.engage());
    ASSERT_TRUE(m.in_step());
    m.load = 0.02;  // a tenth of the speed is lost in half a dozen cycles
    m.run(500);
    // By its set-point the spindle itself is held against the load.
    EXPECT_TRUE(by == CouplingBy::setpoint || m.spindles[0].actual_rpm() < 560.0);
    m.load = 0.0;
    m.run(500);
    m.spindles[0].order(SpindleMode::cw, 900.0);
    m.run(2000);
    m.spindles[0].order(SpindleMode::ccw, 300.0);
    m.run(3000);
    EXPECT_NEAR(m.spindles[0].actual_rpm(), -300.0, 3.0);
    EXPECT_TRUE(m.gears.in_step());
    EXPECT_TRUE(m.events.empty());
    EXPECT_TRUE(m.inside());
    EXPECT_EQ(m.allocated, 0u);
  }
}

TEST(ElectronicGear, takes_the_place_of_its_phase_which_is_the_nearest_of_the_equal_ones) {
  for (const CouplingBy by : {CouplingBy::measured, CouplingBy::setpoint}) {
    Machine m;
    ElectronicGearConfig c = hob(by);
    c.phase = 3.0;
    m.gear(c);
    m.spindles[0].order(SpindleMode::cw, 300.0);
    m.run(2000);
    ASSERT_TRUE(m.engage());
    const double begun = m.follower().setpoint().x;
    ASSERT_TRUE(m.in_step());
    m.run(1000);
    const double off = (m.follower().setpoint().x - 3.0 - 9.0 * m.turns()) / 9.0;
    EXPECT_NEAR(off, std::round(off), 0.02 / 9.0 * 9.0) << "teeth of the wheel are equal places";
    EXPECT_LT(std::abs(m.follower().setpoint().x - begun), 360.0);
    EXPECT_TRUE(m.inside());
  }
}

TEST(ElectronicGear, an_axis_follows_the_set_point_of_another_without_error) {
  Machine m;
  m.gear(slide(CouplingBy::setpoint, -1, 2));
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  const double x = m.axes[kLinear].setpoint().x, z = m.follower().setpoint().x;
  ASSERT_TRUE(m.axes[kLinear].move_to(80.0, 150.0));
  double off = 0.0;
  for (int n = 0; n < 1500; ++n) {
    m.cycle();
    off = std::max(off, std::abs(m.follower().setpoint().x - z + 0.5 * (m.axes[kLinear].setpoint().x - x)));
  }
  EXPECT_EQ(m.axes[kLinear].setpoint().x, 80.0);
  EXPECT_LE(off, 1e-9);
  EXPECT_TRUE(m.events.empty());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, an_axis_follows_what_another_one_measures) {
  Machine m;
  m.gear(slide(CouplingBy::measured));
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  ASSERT_TRUE(m.axes[kLinear].move_to(60.0, 80.0));
  m.run(2000);
  EXPECT_NEAR(m.follower().setpoint().x, 60.0, 0.001);
  EXPECT_LE(m.worst, 0.3);
  EXPECT_TRUE(m.events.empty());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, is_disengaged_by_a_master_that_is_faster_than_the_follower) {
  Machine m;
  m.gear(slide(CouplingBy::setpoint, 3, 1));
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  ASSERT_TRUE(m.axes[kLinear].move_to(90.0, 120.0));
  ASSERT_TRUE(m.until([&] { return !m.gears.on(); }));
  EXPECT_TRUE(m.raised(alarm::kGearTooFast) || m.raised(alarm::kGearWindow));
  EXPECT_TRUE(m.at_rest());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, that_does_not_come_into_step_is_given_up_with_an_alarm) {
  Machine m;
  ElectronicGearConfig finer_than_the_encoder = hob();
  finer_than_the_encoder.window = 0.0005;
  m.gear(finer_than_the_encoder);
  m.spindles[0].order(SpindleMode::cw, 600.0);
  m.run(2000);
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.until([&] { return !m.gears.on(); }, 20000));
  EXPECT_TRUE(m.raised(alarm::kGearNotInStep));
  EXPECT_TRUE(m.at_rest());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, stops_inside_the_travel_of_the_follower_with_an_alarm) {
  Machine m;
  m.gear(slide(CouplingBy::setpoint, 2, 1));
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  ASSERT_TRUE(m.axes[kLinear].move_to(200.0, 90.0));
  double furthest = 0.0;
  ASSERT_TRUE(m.until([&] {
    furthest = std::max(furthest, m.follower().setpoint().x);
    return !m.gears.on() && m.follower().standstill() && !m.follower().geared();
  }));
  EXPECT_LE(furthest, 300.0);
  EXPECT_GT(furthest, 280.0) << "nor far before it";
  EXPECT_TRUE(m.raised(alarm::kSoftLimitPlus));
  EXPECT_TRUE(m.raised(alarm::kGearDisengaged));
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, is_disengaged_where_the_follower_loses_feed_power_or_is_stopped_by_an_alarm) {
  enum class Loss { feed, enable, stop_axes, fault, limit };
  for (const Loss loss : {Loss::feed, Loss::enable, Loss::stop_axes, Loss::fault, Loss::limit}) {
    Machine m;
    m.gear(slide());
    ASSERT_TRUE(m.engage());
    ASSERT_TRUE(m.in_step());
    ASSERT_TRUE(m.axes[kLinear].move_to(200.0, 100.0));
    m.run(500);
    ASSERT_NEAR(m.follower().setpoint().v, 100.0, 1e-6);
    if (loss == Loss::feed) m.permit(kSecond, "feed_enable", false);
    if (loss == Loss::enable) m.permit(kSecond, "enable", false);
    if (loss == Loss::stop_axes) m.reaction = image::Reaction::stop_axes;
    if (loss == Loss::fault) m.drives[kSecond].fault = true;
    if (loss == Loss::limit) m.permit(kSecond, "limit_plus", true);
    m.run(2000);
    EXPECT_FALSE(m.gears.on());
    EXPECT_TRUE(m.follower().standstill());
    EXPECT_TRUE(m.raised(alarm::kGearDisengaged)) << static_cast<int>(loss);
    EXPECT_TRUE(loss == Loss::fault || m.inside()) << static_cast<int>(loss);
  }
}

TEST(ElectronicGear, is_disengaged_where_its_master_is_lost) {
  enum class Loss { spindle_offline, axis_enable, axis_fault };
  for (const Loss loss : {Loss::spindle_offline, Loss::axis_enable, Loss::axis_fault}) {
    Machine m;
    m.gear(loss == Loss::spindle_offline ? hob() : slide());
    m.spindles[0].order(SpindleMode::cw, 600.0);
    m.run(2000);
    ASSERT_TRUE(m.engage());
    ASSERT_TRUE(m.in_step());
    ASSERT_TRUE(m.axes[kLinear].move_to(200.0, 100.0));
    m.run(500);
    if (loss == Loss::spindle_offline) m.spindle_online = false;
    if (loss == Loss::axis_enable) m.permit(kLinear, "enable", false);
    if (loss == Loss::axis_fault) m.drives[kLinear].fault = true;
    ASSERT_TRUE(m.until([&] { return !m.gears.on(); }, 100));
    EXPECT_TRUE(m.raised(alarm::kGearMasterLost)) << static_cast<int>(loss);
    EXPECT_TRUE(m.at_rest());
    EXPECT_TRUE(m.inside()) << static_cast<int>(loss);
  }
}

TEST(ElectronicGear, is_disengaged_where_the_follower_leaves_its_window) {
  Machine m;
  m.gear(slide());
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step());
  ASSERT_TRUE(m.axes[kLinear].move_to(200.0, 100.0));
  m.run(500);
  m.drives[kSecond].lag = 0.99;  // its drive follows badly
  ASSERT_TRUE(m.until([&] { return !m.gears.on(); }, 1000));
  EXPECT_TRUE(m.raised(alarm::kGearWindow));
  EXPECT_TRUE(m.at_rest());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, follows_nobody_who_turns_the_spindle_while_it_rests) {
  Machine m;
  m.gear(hob());
  m.spindles[0].order(SpindleMode::cw, 300.0);
  m.run(2000);
  m.spindles[0].order(SpindleMode::stop, 0.0);
  m.run(6000);
  ASSERT_TRUE(m.engage());
  ASSERT_TRUE(m.in_step()) << "a master at rest has a place, too";
  const double before = m.follower().setpoint().x;
  for (int n = 0; n < 500; ++n) {
    m.place += 0.5;  // by hand
    m.cycle();
  }
  EXPECT_NEAR(m.follower().setpoint().x, before, 1e-6);
  EXPECT_TRUE(m.gears.on());
  m.spindles[0].order(SpindleMode::cw, 300.0);
  m.run(4000);
  EXPECT_TRUE(m.gears.in_step());
  EXPECT_TRUE(m.events.empty());
  EXPECT_TRUE(m.inside());
}

TEST(ElectronicGear, keeps_the_limits_of_the_follower_behind_a_spindle_that_does_anything) {
  std::mt19937 random(test::fresh_seed());
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int run = 0; run < 8; ++run) {
    Machine m;
    ElectronicGearConfig c = hob(run % 2 == 0 ? CouplingBy::measured : CouplingBy::setpoint);
    c.master_turns = run % 3 == 0 ? 3 : 12;
    c.window = 30.0;
    if (run % 4 < 2) c.phase = real(0.0, 360.0);
    m.gear(c);
    m.spindles[0].order(SpindleMode::cw, 300.0);
    m.run(2000);
    for (int step = 0; step < 12; ++step) {
      if (!m.gears.on() && !m.follower().geared()) m.engage();
      const double what = real(0.0, 1.0);
      if (what < 0.5)
        m.spindles[0].order(real(0.0, 1.0) < 0.5 ? SpindleMode::cw : SpindleMode::ccw, real(0.0, 900.0));
      else if (what < 0.7)
        m.spindles[0].order(SpindleMode::stop, 0.0);
      else if (what < 0.85)
        m.load = real(0.0, 0.05);
      else
        m.gears.disengage({m.axes, m.spindles});
      for (int n = 0; n < 600; ++n) {
        m.noise = real(-1.0, 1.0);
        m.cycle();
      }
      m.load = 0.0;
    }
    ASSERT_TRUE(m.inside()) << "run " << run;
  }
}

}  // namespace
}  // namespace servogate::axis
