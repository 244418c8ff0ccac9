// SPDX-License-Identifier: Apache-2.0
// Forcing what guards motion or energy: which places they are, when the gate lets anybody put them out of
// force and back, and the warning as long as one is.
#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kernel/cycle/executive.hpp"
#include "kernel/cycle/gate/guarded_places.hpp"
#include "tests/alarms.hpp"
#include "tests/cycle/gate/rig.hpp"

namespace servogate::cycle {
namespace {

using image::Format;
using image::Packet;
using image::Place;
using image::Request;
using image::RequestKind;

constexpr int kProcesses = 2, kSpindles = 2;

/// A row of the interface at its place in this machine.
struct Row {
  std::string name;
  Place place;
  bool guards = false;
};

template <std::size_t N>
void add(std::vector<Row>& rows, const std::string& prefix, const image::InterfaceField (&block)[N],
         std::uint32_t base) {
  for (const image::InterfaceField& f : block)
    rows.push_back({prefix + std::string(f.name), image::place(f, base), f.guards});
}

/// The whole interface of two processes, two axes, the second one the PLC's, and two spindles.
std::vector<Row> interface() {
  std::vector<Row> rows;
  for (int n = 0; n < 2; ++n) {
    const std::string number = n == 0 ? "" : "2";
    add(rows, "NC" + number + ".", image::kProcessFields, image::process_base(n));
    add(rows, n == 0 ? "X." : "Y.", image::kAxisFields, image::axis_base(n));
    add(rows, "S" + number + ".", image::kSpindleFields, image::spindle_base(n));
  }
  add(rows, "Y.", image::kMotionFields, image::motion_base(1));
  add(rows, "MC.", image::kMachineFields, image::kMachineBase);
  return rows;
}

/// Guards that no table of the interface has: switches, brakes, outputs of an inverter.
const std::vector<Row>& of_the_machine_file() {
  static const std::vector<Row> rows{{"limit +", {Packet::a, Format::bl, 13, 1}, true},
                                     {"limit -", {Packet::a, Format::bl, 14, 1}, true},
                                     {"home switch", {Packet::a, Format::bl, 15, 1}, true},
                                     {"brake", {Packet::a, Format::bl, 33, 1}, true},
                                     {"inverter's speed", {Packet::a, Format::in, 10, 1}, true},
                                     {"inverter's relay", {Packet::a, Format::bl, 34, 1}, true},
                                     {"inverter's other relay", {Packet::a, Format::bl, 35, 1}, true},
                                     {"lamp", {Packet::a, Format::bl, 77, 1}, false}};
  return rows;
}

axis::AxisConfig guarded_axis(axis::AxisConfig config) {
  config.limit_plus = axis::SwitchPlace{of_the_machine_file()[0].place, false};
  config.limit_minus = axis::SwitchPlace{of_the_machine_file()[1].place, false};
  config.home_switch = axis::SwitchPlace{of_the_machine_file()[2].place, false};
  config.brake.output = axis::BrakeOutput::place;
  config.brake.place = {of_the_machine_file()[3].place, false};
  config.auxiliary = true;
  return config;
}

axis::SpindleConfig inverter_spindle() {
  axis::SpindleConfig config;
  config.inverter.emplace();
  config.inverter->speed = of_the_machine_file()[4].place;
  config.inverter->cw = of_the_machine_file()[5].place;
  config.inverter->ccw = of_the_machine_file()[6].place;
  return config;
}

bool is_emergency_stop(const Row& row) { return row.name == "MC.estop_ok"; }

class Guards : public test::GateRig {
 protected:
  Guards() {
    image_.process_count = kProcesses;
    image_.spindle_count = kSpindles;
    image_.packets.resize(4096, image::kSyvarDefaultSize);
    image_.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
    for (int i = 0; i < 2; ++i)
      for (const char* permission : {"enable", "feed_enable"}) set(i, permission, true);
    axes_[1].configure(guarded_axis(axes_[1].config()), 1);
    axes_[1].set_reference(0);
    spindles_[1].configure(inverter_spindle(), 1);
    run(20);
    context_.spindles = spindles_;
    rows_ = interface();
    rows_.insert(rows_.end(), of_the_machine_file().begin(), of_the_machine_file().end());
  }
  /// What the gate says when somebody forces this place to this value, or lets go of it.
  Refusal force(const Place& place, RequestKind kind, double value) {
    Request r;
    r.kind = kind;
    r.packet = static_cast<std::uint8_t>(place.packet), r.format = static_cast<std::uint8_t>(place.format);
    r.index = place.index, r.length = place.length;
    r.value = value;
    answer_ = decide(r, context_);
    return static_cast<Refusal>(answer_.refusal);
  }
  /// Every place in every direction: forced on, forced off, let go. Guards meet `wanted`, others nothing.
  void expect_for_guards(Refusal wanted, const std::string& when) {
    const std::pair<RequestKind, double> ways[] = {
        {RequestKind::force, 1.0}, {RequestKind::force, 0.0}, {RequestKind::release_force, 0.0}};
    for (const Row& row : rows_)
      for (const auto& [kind, value] : ways) {
        if (is_emergency_stop(row) && kind == RequestKind::force) {
          EXPECT_EQ(force(row.place, kind, value), Refusal::emergency_stop_place);
          continue;
        }
        EXPECT_EQ(force(row.place, kind, value), row.guards ? wanted : Refusal::none)
            << row.name << (kind == RequestKind::force ? " forced to " + std::to_string(value) : " let go")
            << ", " << when;
      }
  }

  std::array<axis::Spindle, kSpindles> spindles_;
  std::vector<Row> rows_;
};

TEST_F(Guards, are_forced_changed_and_released_at_standstill_only) {
  expect_for_guards(Refusal::none, "at rest");

  ASSERT_TRUE(axes_[0].jog_increment(20.0));
  expect_for_guards(Refusal::guard_axis, "an axis moves");
  force(rows_[0].place, RequestKind::force, 0.0);
  axes_[0].stop();
  run(2000);
  expect_for_guards(Refusal::none, "at rest again");

  image_.spindles[1].running = true;
  expect_for_guards(Refusal::guard_spindle, "a spindle turns, or is ordered to");
  image_.spindles[1].running = false;

  for (const auto state :
       {image::ProcessState::running, image::ProcessState::held, image::ProcessState::waiting}) {
    image_.processes[1].state = state;
    expect_for_guards(Refusal::guard_program, "a program is in progress");
  }
  image_.processes[1].state = image::ProcessState::ended;
  context_.stopping = 2;
  expect_for_guards(Refusal::guard_program, "a program still stops");
  context_.stopping = 0;

  context_.homing_runs = true;
  expect_for_guards(Refusal::guard_homing, "homing is under way");
}

TEST_F(Guards, are_met_through_any_place_that_covers_them) {
  image_.spindles[0].running = true;
  for (const Row& row : rows_)
    if (row.guards && row.place.packet == Packet::k) {
      EXPECT_EQ(force({Packet::k, Format::by, row.place.byte(), 1}, RequestKind::release_force, 0.0),
                Refusal::guard_spindle)
          << row.name;
    }
  EXPECT_EQ(force({Packet::a, Format::by, 1, 1}, RequestKind::force, 1.0), Refusal::guard_spindle);
  const std::uint32_t unused = image::process_base(kProcesses) + 33;
  EXPECT_EQ(force({Packet::k, Format::by, unused, 1}, RequestKind::force, 1.0), Refusal::none)
      << "the machine has no third process";
}

TEST_F(Guards, that_are_refused_name_what_moves_and_the_command_that_stops_it) {
  const Place enable = image::field(image::kSpindleFields, "enable", image::spindle_base(0));
  const auto said = [&] { return force(enable, RequestKind::force, 1.0), english(); };
  image_.spindles[1].command_rpm = -3000.0;
  EXPECT_EQ(said(),
            "this place guards motion or energy and is forced or released only at standstill: spindle 2 is "
            "ordered to turn or still turns (`servogate reset` stops it)");
  EXPECT_NE(russian().find("шпинделю 2 задано вращение"), std::string::npos) << russian();
  ASSERT_TRUE(axes_[0].jog_increment(20.0));
  EXPECT_NE(said().find("X moves (`servogate stop` stops it)"), std::string::npos) << said();
  context_.homing_runs = true;
  EXPECT_NE(said().find("homing is under way (`servogate stop` stops it)"), std::string::npos) << said();
  image_.processes[0].state = image::ProcessState::held;
  EXPECT_NE(said().find("a program is in progress (`servogate reset` ends it)"), std::string::npos) << said();
}

TEST(GuardTable, marks_what_permits_motion_what_stops_it_and_what_says_that_something_moves) {
  const std::vector<Row> rows = interface();
  for (const char* name :
       {"NC.feed_enable", "NC.stop",         "NC.reset",        "NC.read_in_enable", "NC.external_alarm",
        "NC.m_ack",       "NC.running",      "NC2.feed_enable", "NC2.stop",          "X.enable",
        "X.feed_enable",  "X.limit_plus",    "X.limit_minus",   "X.home_switch",     "X.homed",
        "X.moving",       "X.brake_release", "Y.enable",        "Y.mc_power",        "Y.mc_powered",
        "S.enable",       "S.zero_speed",    "S.run",           "S2.enable",         "MC.estop_ok",
        "MC.power_on",    "MC.ready",        "MC.control_alive"}) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == name; });
    ASSERT_NE(row, rows.end()) << name;
    EXPECT_TRUE(row->guards) << name;
  }
}

/// A process with nothing to do.
class IdleProcess final : public ProcessInCycle {
 public:
  void published(std::span<std::uint64_t>) const noexcept override {}
  void interpolate(ProcessContext&) noexcept override {}
  bool order(const Request&, ProcessContext&) noexcept override { return true; }
  bool loaded() const noexcept override { return false; }
};

TEST(GuardWarning, lasts_as_long_as_any_guard_is_forced_whatever_is_reset) {
  IdleProcess processes[kProcesses];
  CycleParts parts;
  parts.alarms = &tests::alarm_table();
  for (IdleProcess& p : processes) parts.processes.push_back(&p);
  parts.axes = {axis::AxisConfig{}, guarded_axis({})};
  parts.spindles = {axis::SpindleConfig{}, inverter_spindle()};
  parts.k_bytes = 4096;
  Cycle cycle(std::move(parts));
  const auto ask = [&](RequestKind kind, const Place& place, double value) {
    Request r;
    r.kind = kind;
    r.packet = static_cast<std::uint8_t>(place.packet), r.format = static_cast<std::uint8_t>(place.format);
    r.index = place.index, r.length = place.length;
    r.value = value;
    image::Answer answer;
    EXPECT_TRUE(cycle.post(r) && cycle.step() && cycle.take_answer(answer));
    return answer.refusal;
  };
  const auto warned = [&] { return cycle.alarms().active(alarm::kGuardForced); };
  std::vector<Row> rows = interface();
  rows.insert(rows.end(), of_the_machine_file().begin(), of_the_machine_file().end());
  for (const Row& row : rows) {
    if (is_emergency_stop(row)) continue;
    for (const double value : {0.0, 1.0}) {
      ASSERT_EQ(ask(RequestKind::force, row.place, value), 0) << row.name;
      EXPECT_EQ(warned(), row.guards) << row.name << " = " << value;
      ask(RequestKind::acknowledge, {}, 0.0);
      EXPECT_EQ(warned(), row.guards) << row.name << ", acknowledged";
    }
    ASSERT_EQ(ask(RequestKind::release_force, row.place, 0.0), 0) << row.name;
    EXPECT_FALSE(warned()) << row.name << " is free";
  }
}

}  // namespace
}  // namespace servogate::cycle
