// SPDX-License-Identifier: Apache-2.0
// Processes of one machine: X, Y and a spindle belong to the first, Z and another spindle to the second, and
// nothing to the third.
#include <gtest/gtest.h>

#include <array>
#include <map>
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

constexpr int kProcesses = 3;
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
    for (int p = 0; p < kProcesses; ++p) {
      if (p < 2) k.set_bit(image::at(field(image::kSpindleFields, "enable"), image::spindle_base(p)), true);
      const std::uint32_t base = image::process_base(p);
      for (const image::Place& place : kPermits) k.set_bit(image::at(place, base), true);
      for (std::size_t w = 0; w < std::size(kStrobes); ++w)
        k.set_bit(image::at(kAcks[w], base), k.bit(image::at(kStrobes[w], base)));
    }
  }
};

class TwoProcesses : public ::testing::Test {
 protected:
  void compose(const std::string& first, const std::string& second, const std::string& third = "M30\n") {
    program::MachineModel model;
    model.power_on = {"G94", "G97", "G90", "G71", "G27"};
    model.variables = {{"ERF", 0.01}, {"MCD", 2}};
    cycle::CycleParts parts;
    parts.alarms = &tests::alarm_table();
    std::array<ProcessConfig, kProcesses> configs;
    const std::array texts{first, second, third};
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
    }
    for (int p = 0; p < kProcesses; ++p) {
      ProcessConfig& config = configs[static_cast<std::size_t>(p)];
      config.index = p;
      config.axes.spindle_max_rpm = kSpindleMax;
      config.meeting = &meeting_;
      config.supplier = [this, model](int, int to, const std::string& name) {
        const auto found = programs_.find(name);
        Process& other = *processes_[static_cast<std::size_t>(to)];
        if (found == programs_.end()) return Supply::not_found;
        if (other.feeder().reads()) return Supply::busy;
        other.load([model, to, text = found->second](const program::Position& at) {
          return program::Interpreter("nc110", model, {}, "other.nc", text, {}, at, to);
        });
        return Supply::given;
      };
      auto& process = processes_[static_cast<std::size_t>(p)];
      process = std::make_unique<Process>(config);
      process->load([model, p, text = texts[static_cast<std::size_t>(p)]](const program::Position& at) {
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
    for (int p = 0; p < kProcesses; ++p)
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
  double syvar(std::uint32_t byte) const {
    return cycle_->image().packets.number({image::Packet::v, image::Format::by, byte, 1});
  }
  /// The alarm's sentence of a program that was ended by one.
  std::string error_of(int p) const {
    for (const image::AlarmRecord& r : cycle_->alarms().history())
      if (r.process == p)
        if (const auto finding =
                processes_[static_cast<std::size_t>(p)]->texts().finding(static_cast<int>(r.value)))
          return finding->str(text::Language::english);
    return {};
  }

  Meeting meeting_{kProcesses};
  std::map<std::string, std::string> programs_;
  std::array<std::unique_ptr<Process>, kProcesses> processes_;
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

TEST_F(TwoProcesses, refuse_a_window_for_an_axis_of_the_other) {
  compose("M30\n", "G29\n(DTL,Z0.05,Y0.05)\nM30\n");
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::stopped_by_alarm; }));
  EXPECT_TRUE(error_of(1).starts_with("process.nc:2:1: error: Y belongs to another process")) << error_of(1);
  for (const axis::Axis& a : cycle_->axes()) EXPECT_EQ(a.in_position_window(), 0.002);
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

TEST_F(TwoProcesses, start_a_program_in_the_other_one_which_waits_until_it_is_sent_on) {  // T-MP-01
  programs_ = {{"S1", "(WAI,1)\nSYVAR20=7\n(REL)\n"}};
  compose("(EXE,2,S1)\n#(DLY,2)\n#(SND,2)\nM30\n", "M30\n");
  const double begin = cycle_->image().now.seconds();
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::waiting; }));
  EXPECT_EQ(cycle_->image().processes[1].wait.code, 1) << "for the first process";
  ASSERT_TRUE(until([&] { return syvar(20) == 7.0; }));
  EXPECT_NEAR(cycle_->image().now.seconds() - begin, 2.0, 0.1);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended && state(1) == ProcessState::ended; }));
  EXPECT_TRUE(processes_[1]->unloaded());
  EXPECT_EQ(ask(RequestKind::start, 1), Refusal::no_program) << "REL has unloaded it";
  EXPECT_EQ(ask(RequestKind::start, 0), Refusal::none);
}

TEST_F(TwoProcesses, stand_where_they_send_until_the_other_one_waits) {  // T-MP-02
  programs_ = {{"S2", "#(DLY,3)\n(WAI,1)\nSYVAR20=7\n"}};
  compose("(EXE,2,S2)\n(SND,2)\n#SYVAR30=1\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return cycle_->image().processes[0].wait.code == 2; }));
  for (int n = 0; n < 1000; ++n) step();
  EXPECT_EQ(cycle_->image().processes[0].wait.code, 2);
  EXPECT_EQ(syvar(30), 0.0) << "the sender stands";
  ASSERT_TRUE(until([&] { return syvar(20) == 7.0 && syvar(30) == 1.0; }));
  EXPECT_TRUE(until([&] { return state(0) == ProcessState::ended && state(1) == ProcessState::ended; }));
}

TEST_F(TwoProcesses, send_behind_the_motion_before_it) {  // T-MP-11
  compose("G1 X20 F1200\n#(SND,2)\nM30\n", "(WAI,1)\nSYVAR20=7\nM30\n");
  start_both();
  ASSERT_TRUE(until([&] { return syvar(20) == 7.0; }));
  EXPECT_NEAR(at(0), 20.0, 1e-9);
}

TEST_F(TwoProcesses, wait_for_the_one_that_they_name_and_for_no_other) {  // T-MP-04
  compose("(DLY,1)\nM0\n(SND,2)\nM30\n", "(WAI,1)\nSYVAR20=7\n(WAI,3)\nM30\n", "(SND,2)\nSYVAR30=1\nM30\n");
  start_both();
  ASSERT_EQ(ask(RequestKind::start, 2), Refusal::none);
  ASSERT_TRUE(
      until([&] { return cycle_->image().processes[0].wait.reason == image::WaitReason::program_stop; }));
  for (int n = 0; n < 200; ++n) step();
  EXPECT_EQ(syvar(20), 0.0) << "the third one sends in vain";
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return syvar(20) == 7.0 && syvar(30) == 1.0; }));
  EXPECT_TRUE(until([&] { return state(1) == ProcessState::ended; }));
}

TEST_F(TwoProcesses, meet_a_third_one_and_all_go_on_together) {  // T-MP-03
  compose("(WAI,2)\n(WAI,3)\n(SND,2)\n(SND,3)\nG1 X10 F1000\nM30\n",
          "(DLY,1)\n(SND,1)\n(WAI,1)\nG1 Z10 F1000\nM30\n", "(SND,1)\n(WAI,1)\nSYVAR20=7\nM30\n");
  start_both();
  ASSERT_EQ(ask(RequestKind::start, 2), Refusal::none);
  for (int n = 0; n < 800; ++n) step();
  EXPECT_EQ(at(0), 0.0);
  EXPECT_EQ(at(2), 0.0);
  EXPECT_EQ(syvar(20), 0.0) << "the second one is not there yet";
  ASSERT_TRUE(until([&] { return at(2) > 0.0; }));
  for (int n = 0; n < 100; ++n) step();
  EXPECT_GT(at(0), 0.0);
  EXPECT_EQ(syvar(20), 7.0);
  EXPECT_TRUE(until([&] { return state(0) == ProcessState::ended && state(1) == ProcessState::ended; }));
}

TEST_F(TwoProcesses, refuse_an_order_to_a_process_that_the_machine_does_not_have) {
  compose("G1 X5 F1000\n(SND,5)\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::stopped_by_alarm; }));
  EXPECT_NE(error_of(0).find(":2:1: error: there is no process 5: this machine has 3 ([control] processes)"),
            std::string::npos)
      << error_of(0);
  EXPECT_NEAR(at(0), 5.0, 1e-9);
}

TEST_F(TwoProcesses, end_a_wait_by_a_reset_and_wait_anew_in_the_next_run) {
  compose("(SND,2)\nM30\n", "(WAI,1)\nSYVAR20=7\nM30\n");
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::waiting; }));
  EXPECT_EQ(ask(RequestKind::reset, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::idle; }));
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  for (int n = 0; n < 200; ++n) step();
  EXPECT_EQ(state(0), ProcessState::waiting) << "nobody waits any more";
  ASSERT_EQ(ask(RequestKind::start, 1), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended && state(1) == ProcessState::ended; }));
  EXPECT_EQ(syvar(20), 7.0);
}

TEST_F(TwoProcesses, take_program_after_program_from_the_other_one_a_thousand_times) {  // T-MP-10
  programs_ = {{"A", "SYVAR1=1\n(SND,1)\n(REL)\n"}, {"B", "SYVAR1=2\n(SND,1)\n(REL)\n"}};
  compose("(RPT,99)\n(RPT,10)\n(EXE,2,A)\n(WAI,2)\n(EXE,2,B)\n(WAI,2)\n(ERP)\n(ERP)\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended || !cycle_->alarms().history().empty(); }));
  EXPECT_EQ(state(0), ProcessState::ended) << error_of(0);
  EXPECT_EQ(syvar(1), 2.0);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::ended; }));
  EXPECT_TRUE(processes_[1]->unloaded());
  EXPECT_EQ(cycle_->image().processes[1].run, 1980u);
}

TEST_F(TwoProcesses, end_with_an_error_at_a_program_that_is_missing_or_cannot_be_started) {
  programs_ = {{"A", "G1 Z5 F1000\nM30\n"}};
  compose("(EXE,2,NONE)\nG1 X50 F1000\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::stopped_by_alarm; }));
  EXPECT_NE(error_of(0).find(":1:"), std::string::npos) << error_of(0);
  EXPECT_NE(error_of(0).find("there is no program 'NONE' for process 2"), std::string::npos) << error_of(0);
  EXPECT_EQ(at(0), 0.0);
}

TEST_F(TwoProcesses, end_with_an_error_where_somebody_works_by_hand_in_the_other_one) {  // nc110-b.md 19, 2
  programs_ = {{"A", "G1 Z5 F1000\nM30\n"}};
  compose("(EXE,2,A)\nG1 X50 F1000\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::mode, 1, static_cast<double>(image::Mode::manual)), Refusal::none);
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::stopped_by_alarm; }));
  EXPECT_NE(error_of(0).find("process 2 does not start 'A': `servogate start --process 2` says"),
            std::string::npos)
      << error_of(0);
  for (int n = 0; n < 1000; ++n) step();
  EXPECT_EQ(at(2), 0.0);
  EXPECT_EQ(cycle_->image().processes[1].mode, image::Mode::manual);
}

TEST_F(TwoProcesses, ask_the_gate_for_a_start_and_end_with_its_refusal) {
  programs_ = {{"A", "G1 Z5 F1000\nM30\n"}};
  compose("(EXE,2,A)\nG1 X50 F1000\nM30\n", "M30\n");
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended; })) << error_of(0);
  ASSERT_TRUE(until([&] { return state(1) == ProcessState::ended; }));
  EXPECT_NEAR(at(2), 5.0, 1e-9);
  ASSERT_EQ(ask(RequestKind::jog_continuous, 1, -1.0, 2), Refusal::none);
  ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
  ASSERT_TRUE(until([&] { return state(0) == ProcessState::stopped_by_alarm; }));
  EXPECT_NEAR(at(0), 50.0, 1e-9) << "nothing behind it";
}

TEST_F(TwoProcesses, start_and_send_nothing_while_they_are_held) {
  programs_ = {{"A", "G1 Z100 F6000\nM30\n"}, {"B", "(WAI,1)\nG1 Z50 F6000\nM30\n"}};
  for (const bool sends : {false, true}) {
    SCOPED_TRACE(sends);
    compose(sends ? "(EXE,2,B)\n#(DLY,1)\n#(SND,2)\nM30\n" : "#(DLY,1)\n(EXE,2,A)\nM30\n", "M30\n");
    const double begin = at(2);
    ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
    if (sends) {
      ASSERT_TRUE(until([&] { return state(1) == ProcessState::waiting; }));
    }
    for (int n = 0; n < 300; ++n) step();
    ASSERT_EQ(ask(RequestKind::hold, 0), Refusal::none);
    for (int n = 0; n < 5000; ++n) step();
    EXPECT_EQ(at(2), begin);
    ASSERT_EQ(ask(RequestKind::start, 0), Refusal::none);
    ASSERT_TRUE(until([&] { return state(0) == ProcessState::ended && state(1) == ProcessState::ended; }));
    EXPECT_NEAR(at(2), sends ? 50.0 : 100.0, 1e-9);
  }
}

}  // namespace
}  // namespace servogate::channel::test
