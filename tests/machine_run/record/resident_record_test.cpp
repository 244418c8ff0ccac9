// SPDX-License-Identifier: Apache-2.0
// The record of a resident control: several programs, typed blocks, stops. Its replay gives the same bytes.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/comes.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/machine_run/rig/programs.hpp"
#include "tests/places/places.hpp"

namespace servogate::machine_run {
namespace {

using image::ProcessState;
using image::RequestKind;

/// The example mill as `servogate up --record` runs it, in real time on a busy computer, with an operator.
class RecordedControl {
 public:
  explicit RecordedControl(const Scratch& scratch, const std::string& machine_file = mill_file())
      : running_(gateway::RunningMachine::compose(
            machine::load(machine_file), nullptr,
            {.clock = gateway::ClockKind::realtime_best_effort, .record = scratch.path("record")},
            findings_)),
        resident_(running_->control(), machine::MachineState{}, std::string()) {
    running_->watch({scratch.path("trace.csv"), {}, {}});
    std::vector<drivers::Notice> refusals;
    EXPECT_TRUE(running_->begin(refusals));
  }
  gateway::Resident& resident() { return resident_; }
  /// After close(): the only alarm of this number.
  image::AlarmRecord alarm(image::AlarmNumber number) const {
    std::vector<image::AlarmRecord> found = running_->control().cycle().alarms().history();
    std::erase_if(found, [number](const image::AlarmRecord& r) { return r.number != number; });
    EXPECT_EQ(found.size(), 1u) << number;
    return found.empty() ? image::AlarmRecord{} : found.front();
  }
  /// True: accepted. Asks again while an axis is not quite at rest.
  bool ask(RequestKind kind, double value = 0.0, image::Mode mode = image::Mode::off) {
    return tests::comes([&] {
      if (mode != image::Mode::off) post(RequestKind::mode, static_cast<double>(mode));
      return post(kind, value) == 0;
    });
  }
  bool until(const std::function<bool(const image::ProcessImage&)>& met) {
    return tests::comes([&] { return met(resident_.image()); });
  }
  /// So many cycles on, however long the computer takes for them.
  bool go_on(std::int64_t cycles) {
    const std::int64_t end = resident_.image().now.number + cycles;
    return until([end](const image::ProcessImage& i) { return i.now.number >= end; });
  }
  bool until_state(ProcessState state) {
    return until([state](const image::ProcessImage& i) {
      return i.processes[0].state == state && !i.axes[0].moving && !i.axes[1].moving && !i.axes[2].moving;
    });
  }
  bool load(const std::string& path) {
    return tests::comes([&] {
      resident_.read_tables();
      gateway::Resident::Load load = resident_.begin_load(0, path, {});
      resident_.read_and_prove(load, {});
      return resident_.finish(load) == gateway::Resident::Load::End::done;
    });
  }
  /// The program goes by what the last run changed.
  void take_tables() {
    if (auto proof = resident_.take_tables(0)) {
      resident_.prove(*proof, {});
      resident_.proven(*proof);
    }
  }
  bool answered(const image::Request& request, image::Answer& answer) {
    gateway::Asked asked;
    asked.stops = resident_.requests().stops();
    return resident_.ask(request, answer, asked) == gateway::RequestDesk::Outcome::answered;
  }
  /// What went wrong with the files; empty: nothing.
  std::string close() {
    running_->stop();
    std::string problems;
    for (const auto& lost : running_->close_files()) problems += lost.path + ": " + lost.why;
    return problems;
  }

 private:
  std::uint16_t post(RequestKind kind, double value) {
    image::Request r;
    r.kind = kind;
    r.value = value;
    image::Answer answer;
    EXPECT_TRUE(answered(r, answer));
    return answer.refusal;
  }
  std::vector<text::Finding> findings_;
  std::unique_ptr<gateway::RunningMachine> running_;
  gateway::Resident resident_;
};

/// A scan that ends by nothing else within the half second that it is given, however fast the computer: each
/// of the thousand million instructions that it may take turns a number into text.
constexpr const char* kLongScan = R"(
PROGRAM Main
VAR x : LREAL := 0.1; words : STRING; END_VAR
MC.estop_ok := estop_chain_ok;
coolant := TIME() > T#200ms;
IF TIME() > T#400ms THEN WHILE TRUE DO words := CONCAT(LREAL_TO_STRING(x), LREAL_TO_STRING(x)); END_WHILE; END_IF;
END_PROGRAM
)";

TEST(ResidentRecord, of_a_scan_that_was_ended_from_outside_replays_byte_by_byte) {
  const Scratch scratch;
  const std::string machine =
      changed_mill(scratch, "\"mill.st\"]",
                   "\"" + scratch.write("long.st", kLongScan) + "\"]\ninstruction_budget = 1000000000");
  {
    RecordedControl control(scratch, machine);
    ASSERT_TRUE(
        control.until([](const image::ProcessImage& i) { return i.now.t_ns > 700 * image::kMillisecond; }));
    ASSERT_EQ(control.close(), "");
    const image::AlarmRecord stopped = control.alarm(cycle::alarm::kPlcBudget);
    EXPECT_EQ(stopped.line, 6);
    EXPECT_EQ(stopped.reaction, image::Reaction::stop_and_power_off);
    const image::AlarmRecord late = control.alarm(cycle::alarm::kPlcWatchdog);
    EXPECT_EQ(late.cycle, stopped.cycle + 1);
    EXPECT_EQ(late.limit, 500.0);
    EXPECT_GE(late.value, late.limit);
  }
  const Ending replay =
      servogate({"replay", scratch.path("record"), "--against", scratch.path("trace.csv"), "--json"});
  EXPECT_EQ(replay.code, 0) << replay.err << replay.out;
  EXPECT_NE(replay.out.find("\"first_difference\":0"), std::string::npos) << replay.out;
}

TEST(ResidentRecord, of_a_plc_that_was_held_for_single_scans_replays_byte_by_byte) {
  const Scratch scratch;
  {
    RecordedControl control(scratch);
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.axes[2].drive.online; }));
    ASSERT_TRUE(control.ask(RequestKind::reset));
    ASSERT_TRUE(control.ask(RequestKind::logic_scan, 1.0));
    for (const std::uint32_t scans : {1u, 20u, 3u}) {
      image::Request r;
      r.kind = RequestKind::logic_scan;
      r.value = 2.0;
      r.index = scans;
      image::Answer answer;
      ASSERT_TRUE(control.answered(r, answer));
      ASSERT_EQ(answer.refusal, 0);
      ASSERT_TRUE(control.go_on(60));
    }
    ASSERT_TRUE(control.ask(RequestKind::logic_scan, 0.0));
    ASSERT_TRUE(control.ask(RequestKind::reset));
    ASSERT_TRUE(control.ask(RequestKind::power, 1.0));
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.axes[2].enabled; }));
    ASSERT_EQ(control.close(), "");
  }
  const Ending replay =
      servogate({"replay", scratch.path("record"), "--against", scratch.path("trace.csv"), "--json"});
  EXPECT_EQ(replay.code, 0) << replay.err << replay.out;
  EXPECT_NE(replay.out.find("\"first_difference\":0"), std::string::npos) << replay.out;
}

TEST(ResidentRecord, of_two_programs_with_a_stop_and_a_typed_block_between_replays_byte_by_byte) {
  const Scratch scratch;
  // Long enough to be read far ahead when it is given up.
  std::string long_program = "N10 G90 G94 G71 G27\nN20 G1 X40 F6000\n";
  for (int i = 0; i < 400; ++i)
    long_program += "G1 X" + std::to_string(40 - i % 3) + " Y" + std::to_string(i % 7) + "\n";
  const std::string first = scratch.write("first.nc", long_program + "M30\n");
  const std::string second = scratch.write("second.nc", std::string("N5 (CLS,SUB)\n") + kShortProgram);
  scratch.write("SUB.nc", "N1 G0 X7\nN2 G0 X1\n");
  {
    RecordedControl control(scratch);
    using image::Mode;
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.axes[2].drive.online; }));
    ASSERT_TRUE(control.ask(RequestKind::reset));
    ASSERT_TRUE(control.ask(RequestKind::power, 1.0));
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.axes[2].enabled; }));
    ASSERT_TRUE(control.ask(RequestKind::home, 0.0, Mode::home));
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) {
      return i.axes[0].homed && i.axes[1].homed && i.axes[2].homed && !i.axes[0].moving && !i.axes[1].moving;
    }));
    ASSERT_TRUE(control.load(first));
    ASSERT_TRUE(control.ask(RequestKind::start, 0.0, Mode::automatic));
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.processes[0].line > 20; }));
    ASSERT_TRUE(control.ask(RequestKind::stop));
    ASSERT_TRUE(control.until_state(ProcessState::idle));
    control.take_tables();
    control.resident().set_manual_block(0, "(UOT,0,X2)");
    ASSERT_TRUE(control.ask(RequestKind::start, 0.0, Mode::mdi));
    ASSERT_TRUE(control.until_state(ProcessState::ended));
    control.take_tables();
    control.resident().set_manual_block(0, "G1 X12 Y3 F3000");
    ASSERT_TRUE(control.ask(RequestKind::start, 0.0, Mode::mdi));
    ASSERT_TRUE(control.until_state(ProcessState::ended));
    ASSERT_TRUE(control.load(second));
    control.take_tables();
    ASSERT_TRUE(control.ask(RequestKind::start, 0.0, Mode::automatic));
    ASSERT_TRUE(control.until_state(ProcessState::ended));
    ASSERT_TRUE(control.ask(RequestKind::start, 0.0, Mode::automatic)) << "and once more";
    ASSERT_TRUE(control.until_state(ProcessState::ended));
    ASSERT_EQ(control.close(), "");
  }
  // What was loaded stands in the record.
  for (const char* file : {"first.nc", "second.nc", "SUB.nc"}) std::remove(scratch.path(file).c_str());
  const Ending replay =
      servogate({"replay", scratch.path("record"), "--against", scratch.path("trace.csv"), "--json"});
  EXPECT_EQ(replay.code, 0) << replay.err << replay.out;
  EXPECT_NE(replay.out.find("\"first_difference\":0"), std::string::npos) << replay.out;
  const TraceFile trace(scratch.path("trace.csv"));
  EXPECT_GT(trace.rows(), 5000u);
}

/// The mill's PLC file, changed.
std::string other_logic(const Scratch& scratch) {
  std::ifstream in(tests::source_dir() + "/examples/mill/mill.st");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string lamp = "lamp_red := MC.alarm OR NOT MC.estop_ok;";
  const std::size_t at = text.find(lamp);
  EXPECT_NE(at, std::string::npos);
  text.replace(at, lamp.size(), "(* \xD2 *) lamp_red := NOT lamp_red;");  // CP1251, as old files have it
  return scratch.write("mill.st", text);
}

TEST(ResidentRecord, of_forces_and_another_PLC_program_replays_byte_by_byte) {
  const Scratch scratch;
  const std::string plc = other_logic(scratch);
  {
    RecordedControl control(scratch);
    ASSERT_TRUE(control.until([](const image::ProcessImage& i) { return i.axes[2].drive.online; }));
    gateway::PlcDesk desk(control.resident());
    gateway::Caller caller;
    caller.connection = 7;
    caller.user = "somebody";
    const auto ask = [&](const gateway::ask::Command& command) {
      gateway::Outcome outcome = desk.carry_out(command, caller);
      while (const auto* work = std::get_if<gateway::Work>(&outcome)) {
        const gateway::Finish finish = work->run({});
        outcome = finish();
      }
      const auto& reply = std::get<gateway::Reply>(outcome);
      return reply.ok ? std::string() : reply.text;
    };
    const auto wait = [&] { EXPECT_TRUE(control.go_on(120)); };
    EXPECT_EQ(ask(gateway::ask::PlcForce{"door_closed", "FALSE", false}), "");
    EXPECT_EQ(ask(gateway::ask::PlcForce{"Mill.coolant_on", "TRUE", false}), "");
    EXPECT_EQ(ask(gateway::ask::PlcForce{"mist", "TRUE", false}), "");
    wait();
    EXPECT_EQ(ask(gateway::ask::PlcLoad{{plc}, true, false}), "");
    wait();
    EXPECT_EQ(ask(gateway::ask::PlcRelease{"Mill.coolant_on"}), "");
    desk.release_of(7);
    wait();
    EXPECT_EQ(ask(gateway::ask::PlcLoad{}), "");
    wait();
    ASSERT_EQ(control.close(), "");
  }
  std::remove(plc.c_str());  // what was loaded stands in the record
  const Ending replay =
      servogate({"replay", scratch.path("record"), "--against", scratch.path("trace.csv"), "--json"});
  EXPECT_EQ(replay.code, 0) << replay.err << replay.out;
  EXPECT_NE(replay.out.find("\"first_difference\":0"), std::string::npos) << replay.out;
  const TraceFile trace(scratch.path("trace.csv"));
  int changes = 0;
  const std::size_t lamp = trace.column("lamp_red");
  for (std::size_t row = 1; row < trace.rows(); ++row)
    changes += trace.at(row, lamp) != trace.at(row - 1, lamp) ? 1 : 0;
  EXPECT_GT(changes, 50) << "the other program ran for a while";
}

}  // namespace
}  // namespace servogate::machine_run
