// SPDX-License-Identifier: Apache-2.0
// The control dies: it is killed or stopped, and SYNC, process data and heartbeats end together. What the
// drive of a hanging axis then does is its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "machine/check/stops/control_death.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using image::Mode;
using image::RequestKind;

constexpr int kZ = 2;
/// From full speed the motor brakes with its peak torque within 11 mm, after a few cycles.
constexpr double kStopsWithin = 20.0;
/// Two rapids over the whole travel, up and down again.
constexpr const char* kUpAndDown = "N10 G90 G94 G71\nN20 G0 Z290\nN30 G0 Z-290\nN40 G0 Z290\nN50 M30\n";

/// The mill up to a moment in which its control dies.
struct Phase {
  const char* name;
  bool (*reach)(Mill&);
};

bool starts(Mill& mill) { return mill.make_ready() && mill.ask(RequestKind::start) == cycle::Refusal::none; }
/// Z is in a rapid with a speed between these, in this direction, and gets faster, or slower.
bool in_rapid(Mill& mill, int direction, double least, double most, int change) {
  double before = 0.0, last = 0.0, position = mill.axis("Z").command;
  const double period = static_cast<double>(mill.control().cycle().period_ns()) * 1e-9;
  mill.after_cycle = [&] {
    before = last;
    last = (mill.axis("Z").command - position) / period;
    position = mill.axis("Z").command;
  };
  const bool reached = starts(mill) && mill.until([&] {
    const double change_now = std::abs(last) - std::abs(before);
    return last * direction >= least && last * direction <= most &&
           (change == 0 ? std::abs(change_now) < 1e-6 : change_now * change > 0.0);
  });
  mill.after_cycle = {};
  return reached;
}
bool jogs(Mill& mill, double direction) {
  if (!mill.make_ready() ||
      mill.ask(RequestKind::mode, static_cast<double>(Mode::manual)) != cycle::Refusal::none)
    return false;
  if (mill.ask(RequestKind::jog_continuous, direction, kZ) != cycle::Refusal::none) return false;
  mill.after_cycle = [&mill] { mill.post(RequestKind::keep_alive); };
  const double from = mill.axis("Z").command;
  const bool reached = mill.until([&] { return std::abs(mill.axis("Z").command - from) > 30.0; }, 5.0);
  mill.after_cycle = {};
  return reached;
}
bool homes(Mill& mill) {
  if (!mill.power_on() ||
      mill.ask(RequestKind::mode, static_cast<double>(Mode::home)) != cycle::Refusal::none ||
      mill.ask(RequestKind::home) != cycle::Refusal::none)
    return false;
  const double from = mill.true_position(kZ);
  return mill.until([&] { return std::abs(mill.true_position(kZ) - from) > 10.0; }, 10.0);
}

constexpr Phase kPhases[] = {
    {"power is on, nothing is homed", [](Mill& m) { return m.power_on(); }},
    {"it rests", [](Mill& m) { return m.make_ready(); }},
    {"it accelerates upwards", [](Mill& m) { return in_rapid(m, 1, 100.0, 300.0, 1); }},
    {"a rapid upwards", [](Mill& m) { return in_rapid(m, 1, 499.0, 501.0, 0); }},
    {"it slows down upwards", [](Mill& m) { return in_rapid(m, 1, 100.0, 300.0, -1); }},
    {"it accelerates downwards", [](Mill& m) { return in_rapid(m, -1, 100.0, 300.0, 1); }},
    {"a rapid downwards", [](Mill& m) { return in_rapid(m, -1, 499.0, 501.0, 0); }},
    {"it slows down downwards", [](Mill& m) { return in_rapid(m, -1, 100.0, 300.0, -1); }},
    {"it homes", [](Mill& m) { return homes(m); }},
    {"it is jogged upwards", [](Mill& m) { return jogs(m, 1.0); }},
    {"it is jogged downwards", [](Mill& m) { return jogs(m, -1.0); }},
};

/// Z from the death of the control on.
struct Course {
  double from = 0.0, lowest = 0.0, highest = 0.0, last = 0.0;
  bool still = false;  ///< it stood in the last second
  double fallen() const { return from - lowest; }
};

Course after_death(Mill& mill, double seconds) {
  Course c;
  c.from = c.lowest = c.highest = mill.true_position(kZ);
  const image::Nanoseconds death = mill.image().now.t_ns;
  double a_second_before_the_end = 0.0;
  for (int ms = 1; ms <= static_cast<int>(seconds * 1e3); ++ms) {
    mill.control().world().advance_to(death + ms * image::kMillisecond);
    c.last = mill.true_position(kZ);
    c.lowest = std::min(c.lowest, c.last);
    c.highest = std::max(c.highest, c.last);
    if (ms == static_cast<int>(seconds * 1e3) - 1000) a_second_before_the_end = c.last;
  }
  c.still = std::abs(c.last - a_second_before_the_end) < 1e-3;
  return c;
}

machine::LoadResult mill_with(const char* cycle_time) {
  return changed_mill([&](std::string& text) {
    replace(text, "cycle_time = \"1 ms\"", "cycle_time = \"" + std::string(cycle_time) + "\"");
  });
}

TEST(ControlDeath, in_any_phase_of_a_motion_lets_no_axis_fall_and_ends_with_the_brake_closed) {
  for (const char* cycle_time : {"1 ms", "4 ms"}) {
    const machine::LoadResult machine = mill_with(cycle_time);
    for (const Phase& phase : kPhases)
      for (const int later : {0, 3}) {
        SCOPED_TRACE(std::string(phase.name) + ", " + cycle_time + ", " + std::to_string(later) +
                     " cycles later");
        Mill mill(machine, kUpAndDown);
        ASSERT_TRUE(phase.reach(mill)) << mill.alarm_list();
        mill.run(later * static_cast<double>(mill.control().cycle().period_ns()) * 1e-9);
        const Course z = after_death(mill, 3.0);
        EXPECT_LT(z.fallen(), kStopsWithin);
        EXPECT_LT(z.highest - z.from, kStopsWithin);
        EXPECT_TRUE(z.still);
        const mock::SimulatedDrive& drive = *mill.control().world().drive("can.z");
        EXPECT_FALSE(drive.brake_released()) << "nobody is there any more to close it later";
        EXPECT_NE(drive.state(), image::DriveState::operation_enabled);
      }
  }
}

/// What a drive can be told, and whether its own logic works the brake.
struct Setting {
  const char* name;
  bool interlock;
  machine::ConnectionLoss loss;
  double quick_stop, fault_reaction;
};
constexpr Setting kSettings[] = {
    {"ramp, brake, off", true, machine::ConnectionLoss::fault, 2, 2},
    {"quick stop, brake, off", true, machine::ConnectionLoss::quick_stop, 2, 2},
    {"quick stop that holds by torque", true, machine::ConnectionLoss::quick_stop, 6, 2},
    {"a fault that coasts", true, machine::ConnectionLoss::fault, 2, 0},
    {"voltage off", true, machine::ConnectionLoss::disable_voltage, 2, 2},
    {"a brake of the bus, and a fault", false, machine::ConnectionLoss::fault, 2, 2},
    {"a brake of the bus, and a hold by torque", false, machine::ConnectionLoss::quick_stop, 6, 2},
};

TEST(ControlDeath, falls_as_far_as_check_says_and_no_farther_whatever_the_drive_is_told) {
  for (const Setting& s : kSettings)
    for (const char* phase : {"it rests", "a rapid downwards"}) {
      SCOPED_TRACE(std::string(s.name) + ", " + phase);
      machine::LoadResult machine = mill_with("1 ms");
      machine::DeviceConfig& device = machine.devices.at("servo-cia402-brake");
      device.behaviour.brake_interlock = s.interlock;
      device.behaviour.connection_loss = s.loss;
      device.objects["605A:00/16"] = s.quick_stop;
      device.objects["605E:00/16"] = s.fault_reaction;
      const auto death = machine::control_death(machine, machine.machine.axes.at(kZ));
      ASSERT_TRUE(death.has_value());
      Mill mill(machine, kUpAndDown);
      const auto found =
          std::ranges::find_if(kPhases, [&](const Phase& p) { return std::string_view(p.name) == phase; });
      ASSERT_TRUE(found->reach(mill)) << mill.alarm_list();
      const Course z = after_death(mill, 2.5);
      const bool moves = std::string_view(phase) == "a rapid downwards";
      if (death->falls_for == machine::kNoLimit) {
        // At rest the drive that holds by torque never trips.
        const bool holds = s.loss == machine::ConnectionLoss::quick_stop;
        if (moves || !holds) {
          EXPECT_GT(z.fallen(), 500.0) << "this is what check warns of";
        }
        continue;
      }
      EXPECT_TRUE(z.still);
      EXPECT_LT(z.fallen(), death->falls + (moves ? kStopsWithin + 10.0 : 0.1));
    }
}

}  // namespace
}  // namespace servogate::machine_run
