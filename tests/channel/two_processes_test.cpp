// SPDX-License-Identifier: Apache-2.0
// Two processes of one machine: X, Y and a spindle belong to the first, Z and another spindle to the second.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "firmware_if/image/interface_map.hpp"
#include "tests/alarms.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using cycle::Refusal;
using image::field;
using image::ProcessState;
using image::RequestKind;

/// The drive of the second spindle: what it is told, it does.
class SecondSpindle final : public image::CycleDevice {
 public:
  void receive(image::ProcessImage& image, image::Notices&) noexcept override {
    image::DriveFeedback& f = image.spindles[1].drive;
    f.online = true;
    f.state = told_.power ? image::DriveState::operation_enabled : image::DriveState::switch_on_disabled;
    f.velocity_counts_s = told_.power ? told_.velocity_counts_s : 0.0;
  }
  void send(image::ProcessImage& image) noexcept override { told_ = image.spindles[1].drive_command; }

 private:
  image::DriveCommand told_;
};

constexpr image::Place kPermits[] = {field(image::kProcessFields, "feed_enable"),
                                     field(image::kProcessFields, "read_in_enable")};
constexpr image::Place kStrobes[] = {
    field(image::kProcessFields, "m_strobe"), field(image::kProcessFields, "s_strobe"),
    field(image::kProcessFields, "t_strobe"), field(image::kProcessFields, "h_strobe")};
constexpr image::Place kAcks[] = {
    field(image::kProcessFields, "m_ack"), field(image::kProcessFields, "s_ack"),
    field(image::kProcessFields, "t_ack"), field(image::kProcessFields, "h_ack")};

/// Permits everything and acknowledges every word of both processes at once.
class Permits final : public image::Logic {
 public:
  void scan(image::ProcessImage& image, image::Notices&) noexcept override {
    image::Packets& k = image.packets;
    k.set_bit(field(image::kMachineFields, "estop_ok", image::kMachineBase), true);
    k.set_bit(field(image::kMachineFields, "power_on", image::kMachineBase), true);
    for (int a = 0; a < kAxes; ++a)
      for (const image::Place& place :
           {field(image::kAxisFields, "enable"), field(image::kAxisFields, "feed_enable")})
        k.set_bit(image::at(place, image::axis_base(a)), true);
    for (int p = 0; p < 2; ++p) {
      k.set_bit(image::at(field(image::kSpindleFields, "enable"), image::spindle_base(p)), true);
      const std::uint32_t base = image::process_base(p);
      for (const image::Place& place : kPermits) k.set_bit(image::at(place, base), true);
      for (std::size_t w = 0; w < std::size(kStrobes); ++w)
        k.set_bit(image::at(kAcks[w], base), k.bit(image::at(kStrobes[w], base)));
    }
  }
};

class TwoProcesses : public ::testing::Test {
 protected:
  void compose(const std::string& first, const std::string& second) {
    program::MachineModel model;
    model.power_on = {"G94", "G97", "G90", "G71", "G27"};
    model.variables = {{"ERF", 0.01}, {"MCD", 2}};
    cycle::CycleParts parts;
    parts.alarms = &tests::alarm_table();
    std::array<ProcessConfig, 2> configs;
    for (ProcessConfig& config : configs) config.path.axis_count = 0;
    for (int a = 0; a < kAxes; ++a) {
      axis::AxisConfig c;
      c.process = a < 2 ? 0 : 1;
      c.limits = kLimits;
      c.counts_numerator = 100000;
      c.homing.method = axis::HomingMethod::none;
      c.in_position_window = 0.002;
      parts.axes.push_back(c);
      program::MachineModel::Axis m;
      m.letter = std::string(1, static_cast<char>('X' + a));
      m.rapid = kLimits.velocity;
      model.axes.push_back(m);
      for (ProcessConfig& process : configs) {
        process.axes.machine.push_back(a);
        process.path.limits[static_cast<std::size_t>(process.path.axis_count++)] = {
            kLimits.velocity, kLimits.acceleration, kLimits.jerk};
      }
    }
    parts.devices = {&drives_, &second_spindle_};
    parts.logic = &logic_;
    for (int p = 0; p < 2; ++p) {
      axis::SpindleConfig& spindle = parts.spindles.emplace_back();
      spindle.process = p;
      spindle.max_rpm = kSpindleMax;
      ProcessConfig& config = configs[static_cast<std::size_t>(p)];
      config.index = p;
      config.axes.spindle_max_rpm = kSpindleMax;
      auto& process = processes_[static_cast<std::size_t>(p)];
      process = std::make_unique<Process>(config);
      process->load([model, p, text = p == 0 ? first : second](const program::Position& at) {
        return program::Interpreter("nc110", model, {}, "process.nc", text, {}, at, p);
      });
      parts.processes.push_back(process.get());
    }
    cycle_ = std::make_unique<cycle::Cycle>(std::move(parts));
    for (int n = 0; n < 10; ++n) step();
    EXPECT_EQ(ask(RequestKind::power, 0, 1.0), Refusal::none);
    EXPECT_TRUE(until([this] {
      for (const axis::Axis& a : cycle_->axes())
        if (!a.motion_permitted()) return false;
      return true;
    }));
    for (int p = 0; p < 2; ++p)
      EXPECT_EQ(ask(RequestKind::mode, p, static_cast<double>(image::Mode::automatic)), Refusal::none);
  }
  void start_both() {
    for (int p = 0; p < 2; ++p) ASSERT_EQ(ask(RequestKind::start, p), Refusal::none);
  }
  void step() {
    for (const auto& process : processes_) process->work();
    ASSERT_TRUE(cycle_->step());
  }
  bool until(const std::function<bool()>& met) {
    for (int n = 0; n < 30'000; ++n) {
      if (met()) return true;
      step();
    }
    return false;
  }
  Refusal ask(RequestKind kind, int process, double value = 0.0, int axis = -1) {
    image::Request r;
    r.kind = kind;
    r.process = static_cast<std::int8_t>(process);
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    EXPECT_TRUE(cycle_->post(r));
    step();
    image::Answer answer;
    EXPECT_TRUE(cycle_->take_answer(answer));
    return static_cast<Refusal>(answer.refusal);
  }
  ProcessState state(std::size_t p) const { return cycle_->image().processes[p].state; }
  double at(std::size_t axis) const { return cycle_->image().axes[axis].command; }
  double rpm(std::size_t spindle) const { return cycle_->image().spindles[spindle].command_rpm; }

  IdealDrives drives_;
  SecondSpindle second_spindle_;
  Permits logic_;
  std::array<std::unique_ptr<Process>, 2> processes_;
  std::unique_ptr<cycle::Cycle> cycle_;
};

TEST_F(TwoProcesses, run_two_programs_in_one_cycle_each_with_its_own_axes_and_spindle) {
  compose("N10 S500 M3\nN20 G1 X20 Y10 F3000\nN30 M30\n", "N10 S900 M4\nN20 G1 Z-60 F1200\nN30 M30\n");
  start_both();
  bool both_move = false;
  ASSERT_TRUE(until([&] {
    const auto& axes = cycle_->image().axes;
    both_move = both_move || (axes[0].moving && axes[1].moving && axes[2].moving);
    return state(0) == ProcessState::ended;
  }));
  EXPECT_TRUE(both_move);
  EXPECT_NEAR(at(0), 20.0, 1e-9);
  EXPECT_NEAR(at(1), 10.0, 1e-9);
  EXPECT_EQ(state(1), ProcessState::running) << "its neighbour's end is not its own";
  for (int n = 0; n < 300; ++n) step();
  EXPECT_EQ(rpm(0), 0.0) << "M30 stops the spindle of its process";
  EXPECT_NEAR(rpm(1), -900.0, 1e-6) << "and no other one";
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::ended; }));
  EXPECT_NEAR(at(2), -60.0, 1e-9);
  EXPECT_NEAR(at(0), 20.0, 1e-9);
  EXPECT_TRUE(cycle_->alarms().history().empty());
}

TEST_F(TwoProcesses, are_both_reached_by_a_stop_and_by_an_alarm_of_either) {
  compose("N10 G1 X200 F3000\nN20 M30\n", "N10 G1 Z200 F3000\nN20 M30\n");
  start_both();
  const auto both = [this](ProcessState s) { return state(0) == s && state(1) == s; };
  ASSERT_TRUE(until([&] { return at(0) > 5.0 && at(2) > 5.0; }));
  EXPECT_EQ(ask(RequestKind::stop, -1), Refusal::none);
  EXPECT_TRUE(until([&] { return both(ProcessState::idle); }));
  start_both();
  ASSERT_TRUE(until([&] { return both(ProcessState::running) && at(2) > 20.0; }));
  drives_.fault[2] = true;
  EXPECT_TRUE(until([&] { return both(ProcessState::stopped_by_alarm); }));
  EXPECT_LT(at(0), 190.0);
}

TEST_F(TwoProcesses, refuse_a_program_that_names_an_axis_of_the_other_with_its_place) {
  compose("N10 M30\n", "N10 G1 Z5 F1000\nN20 Z8 X3\nN30 M30\n");
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(at(0), 0.0);
  EXPECT_NEAR(at(2), 5.0, 1e-9) << "nothing of the block is driven";
  const auto history = cycle_->alarms().history();
  ASSERT_FALSE(history.empty());
  EXPECT_EQ(history.front().process, 1);
  EXPECT_EQ(history.front().line, 2);
  const auto finding = processes_[1]->texts().finding(static_cast<int>(history.front().value));
  ASSERT_TRUE(finding.has_value());
  EXPECT_EQ(
      finding->str(text::Language::english),
      "process.nc:2:8: error: X belongs to another process: its programs move it [channel.foreign-axis]");
}

TEST_F(TwoProcesses, hand_an_axis_over_at_standstill_and_only_then) {
  compose("N10 G1 X20 Z-30 F3000\nN20 M30\n", "N10 G1 Z40 F3000\nN20 M30\n");
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return at(2) > 1.0; }));
  EXPECT_EQ(ask(RequestKind::assign, 0, 0.0, 2), Refusal::program_runs) << "its own program moves it";
  EXPECT_EQ(ask(RequestKind::assign, 1, 0.0, 0), Refusal::program_runs) << "the new one's program runs";
  EXPECT_EQ(ask(RequestKind::assign, 7, 0.0, 2), Refusal::no_such_process);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::ended; }));
  ASSERT_EQ(ask(RequestKind::jog_continuous, 1, 1.0, 2), Refusal::none);
  for (int n = 0; n < 20; ++n) step();
  EXPECT_EQ(ask(RequestKind::assign, 0, 0.0, 2), Refusal::axis_moves);
  ASSERT_TRUE(until([&] { return cycle_->axes()[2].standstill(); }));
  ASSERT_EQ(ask(RequestKind::assign, 0, 0.0, 2), Refusal::none);
  EXPECT_EQ(cycle_->image().axes[2].process, 0);
  ASSERT_EQ(ask(RequestKind::mode, 0, static_cast<double>(image::Mode::automatic)), Refusal::none);
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended; }));
  EXPECT_NEAR(at(2), -30.0, 1e-9) << "where the new process' program says";
  const double before = at(2);
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(at(2), before) << "the old one's no longer moves it";
}

TEST_F(TwoProcesses, keep_manual_control_of_the_axes_whose_program_does_not_run) {
  compose("N10 G1 X200 F1000\nN20 M30\n", "N10 G1 Z5 F1000\nN20 M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return at(0) > 1.0; }));
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0, 1), Refusal::program_runs) << "Y is the program's";
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0, 2), Refusal::none) << "Z is not";
  ASSERT_TRUE(until([&] { return !cycle_->image().axes[2].moving && at(2) > 0.9; }));
  EXPECT_EQ(state(0), ProcessState::running);
}

}  // namespace
}  // namespace servogate::channel::test
