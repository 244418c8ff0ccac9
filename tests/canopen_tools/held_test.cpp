// SPDX-License-Identifier: Apache-2.0
// A bus that a running control holds: read through it, and locked to everything else.
#include <csignal>

#include "tests/canopen_tools/workbench.hpp"
#include "tests/comes.hpp"
#include "tests/usercan/rig/mill.hpp"

namespace servogate::canopen_tools {
namespace {

/// A running control of the example mill on its mock bus, found by its socket in this folder.
class HeldBus : public Workbench {
 protected:
  HeldBus() {
    setenv("XDG_RUNTIME_DIR", path("").c_str(), 1);
    control_ = std::make_unique<usercan::Process>(std::vector<std::string>{
        "up", shell::source("examples/mill/machine.toml"), "--virtual", "--state", path("state")});
    unsetenv("XDG_RUNTIME_DIR");
    ready_ = online();
  }
  /// The drives have booted.
  bool online() {
    return tests::comes([&] {
      const json status = json::parse(tool("status --json").out, nullptr, false);
      if (!status.is_object() || !status.contains("buses")) return false;
      for (const json& node : status["buses"][0]["nodes"])
        if (node["online"] != true) return false;
      return true;
    });
  }
  const std::string held_ = shell::source("examples/mill/machine.toml") + "#can";
  std::unique_ptr<usercan::Process> control_;
  bool ready_ = false;
};

TEST_F(HeldBus, is_read_through_the_control_that_holds_it) {
  ASSERT_TRUE(ready_) << control_->said();
  const json scanned = facts("scan " + held_);
  EXPECT_EQ(scanned["held_by"]["machine"], "Three-axis mill");
  ASSERT_EQ(scanned["nodes"].size(), 4u);
  EXPECT_EQ(scanned["nodes"][0]["profile"], 402);
  EXPECT_TRUE(scanned["nodes"][0]["online"]);
  EXPECT_EQ(scanned["nodes"][0]["state"], "operational");
  EXPECT_TRUE(scanned["nodes"][0]["heartbeat_seen"]);
  EXPECT_EQ(facts("sdo " + held_ + " 1 read 1018:4")["value"], 1);
  EXPECT_EQ(facts("sdo " + held_ + " 1 read 1008")["value"], "Servogate simulated drive");
  EXPECT_EQ(facts("sdo " + held_ + " 2 read 5FFF", 1)["abort"], 0x0602'0000);
  EXPECT_EQ(facts("od " + held_ + " 1 --range 6060-6070")["objects"][0]["index"], "6060");
}

TEST_F(HeldBus, is_locked_to_writes_and_commands_with_the_name_of_its_holder) {
  ASSERT_TRUE(ready_) << control_->said();
  for (const char* words : {"sdo BUS 1 write 6083 1000", "sdo BUS 1 write 6040 6 --i-may-move",
                            "nmt BUS stop all --i-may-move", "lss BUS inquire"}) {
    std::string line = words;
    line.replace(line.find("BUS"), 3, held_);
    const Ended ended = tool(line);
    EXPECT_EQ(ended.code, 1) << line;
    EXPECT_TRUE(ended.err_has("the running control of 'Three-axis mill' uses bus")) << ended.err;
  }
  EXPECT_TRUE(tool("can check " + held_).out_has("holds it"));
  const Ended foreign = tool("sdo " + held_ + " 99 read 1000");
  EXPECT_EQ(foreign.code, 1);
  EXPECT_TRUE(
      foreign.err_has("node 99 is not in the machine file of the control that holds the bus; its nodes are"))
      << foreign.err;
}

TEST_F(HeldBus, by_a_control_that_was_stopped_is_still_held_and_nothing_is_done_on_it) {
  ASSERT_TRUE(ready_) << control_->said();
  control_->signal(SIGSTOP);
  for (const char* words :
       {"nmt BUS stop all --i-may-move", "sdo BUS 1 write 6040 6 --i-may-move", "scan BUS"}) {
    std::string line = words;
    line.replace(line.find("BUS"), 3, bus());
    const Ended ended = tool(line);
    EXPECT_EQ(ended.code, 1) << line;
    EXPECT_TRUE(ended.err_has("is running but does not answer")) << ended.err;
    EXPECT_TRUE(ended.err_has("it may be using bus " + bus())) << ended.err;
  }
  const Ended off = tool("sdo " + bus() + " 1 write 6040 0");
  EXPECT_FALSE(off.err_has("is running but does not answer"))
      << "switching off waits for no dead control: " << off.err;
  control_->signal(SIGCONT);
  EXPECT_EQ(tool("nmt " + held_ + " stop all --i-may-move").code, 1);
}

/// The mill runs a long line on the bus of the workbench, its drives in processes of their own.
class HeldByRun : public Workbench {
 protected:
  /// `runtime`: XDG_RUNTIME_DIR of the run; tools look in the folder of the test.
  void run(const std::string& runtime) {
    const std::string machine = usercan::mill(bus(), usercan::patience());
    living_ = usercan::mill_drives(machine);
    desk_.write("long.nc", "N1 G90 G0 X10 Y0 Z0\nN2 G1 X10 Y90 F10\nN3 M30\n");
    setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
    run_ = std::make_unique<usercan::Process>(std::vector<std::string>{
        "run", machine, path("long.nc"), "--realtime=best-effort", "-q", "--report", path("report.json")});
    unsetenv("XDG_RUNTIME_DIR");
  }
  /// The node is operational: it answers the RPDOs of the run.
  bool comes_on() {
    const auto ear = join();
    for (image::CanFrame frame; usercan::wait_for(*ear, frame);)
      if (frame.id == 0x181) return true;
    return false;
  }
  /// Ends the run; numbers of the alarms that it had.
  std::vector<int> alarms() {
    run_->signal(SIGINT);
    EXPECT_EQ(run_->wait(), 3) << run_->said();
    std::vector<int> numbers;
    const json report = json::parse(desk_.text("report.json"), nullptr, false);
    EXPECT_TRUE(report.contains("alarms")) << run_->said();
    for (const json& alarm : report["alarms"]) {
      numbers.push_back(alarm["number"]);
      texts_ += alarm["text"].get<std::string>() + "\n";
    }
    return numbers;
  }
  std::string texts_;  ///< of those alarms
  static constexpr int kForeignRequest = 2024;
  std::vector<std::unique_ptr<usercan::Process>> living_;
  std::unique_ptr<usercan::Process> run_;
};

TEST_F(HeldByRun, is_read_through_it_so_that_it_hears_no_foreign_frame) {
  run(path(""));
  ASSERT_TRUE(comes_on()) << run_->said();
  const json scanned = facts("scan $BUS");
  EXPECT_EQ(scanned["held_by"]["machine"], "Three-axis mill");
  EXPECT_EQ(scanned["nodes"].size(), 4u);
  EXPECT_EQ(facts("sdo $BUS 1 read 1018:4")["value"], 1);
  EXPECT_EQ(facts("sdo socketcand:unix:bus.sock/can0 2 read 1018:4")["value"], 2) << "written otherwise";
  EXPECT_EQ(facts("sdo socketcand:unix:" + path("./bus.sock") + "/can0 3 read 1018:4")["value"], 3);
  EXPECT_EQ(facts("od $BUS 1 --range 6060-6070")["objects"][0]["index"], "6060");
  EXPECT_EQ(alarms(), std::vector<int>());
}

TEST_F(HeldByRun, is_locked_to_every_write_and_command_and_the_run_is_named) {
  run(path(""));
  ASSERT_TRUE(comes_on()) << run_->said();
  for (const char* words : {"sdo $BUS 1 write 1801:1 0x40000281", "sdo $BUS 1 write 6040 6 --i-may-move",
                            "nmt $BUS stop all --i-may-move", "lss $BUS inquire"}) {
    const Ended ended = tool(words);
    EXPECT_EQ(ended.code, 1) << words;
    EXPECT_TRUE(ended.err_has("a `servogate run` of 'Three-axis mill' uses bus")) << ended.err;
  }
  EXPECT_TRUE(tool("can check $BUS --seconds 0.3").out_has("holds it"));
  EXPECT_TRUE(tool("status").err_has("no control is running")) << "clients do not take it for a control";
  for (const char* words : {"status", "power on", "down"}) {
    const Ended refused = tool(std::string(words) + " --socket servogate/*.run");
    EXPECT_EQ(refused.code, 2) << words;
    EXPECT_TRUE(refused.err_has("a `servogate run` does not take")) << refused.err;
  }
  EXPECT_EQ(alarms(), std::vector<int>());
}

TEST_F(HeldByRun, is_locked_to_logs_of_a_master_whoever_runs_it) {
  desk_.write("stop.log", "(1.0) can0 000#8002\n");
  desk_.write("drive.log", "(1.0) can0 77E#05\n");
  run(path(""));
  ASSERT_TRUE(comes_on()) << run_->said();
  const Ended held = tool("play $BUS stop.log");
  EXPECT_EQ(held.code, 1);
  EXPECT_TRUE(held.err_has("`play` is refused: a `servogate run` of")) << held.err;
  const Ended heard = desk_.line("XDG_RUNTIME_DIR=$PWD/else $SG play " + bus() + " stop.log");
  EXPECT_EQ(heard.code, 1);
  EXPECT_TRUE(heard.err_has("`play` is refused: another master controls this bus")) << heard.err;
  EXPECT_EQ(tool("play $BUS drive.log").code, 0) << "a device among simulated ones";
  EXPECT_EQ(alarms(), std::vector<int>());
}

TEST_F(HeldByRun, has_no_room_for_a_second_device_with_the_node_id_of_one_that_lives) {
  run(path(""));
  ASSERT_TRUE(comes_on()) << run_->said();
  for (const char* words : {"drive $BUS --node 1", "io $BUS --node 4", "sim $MILL --bus can=$BUS"}) {
    const Ended ended = tool(words);
    EXPECT_EQ(ended.code, 1) << words;
    EXPECT_TRUE(ended.err_has("is not simulated: a device with this node-ID is on ")) << ended.err;
  }
  EXPECT_TRUE(tool("can check $BUS --seconds 1").out_has("127 (the control)"));
  EXPECT_EQ(alarms(), std::vector<int>()) << texts_;
}

TEST_F(HeldByRun, takes_a_new_process_for_a_drive_that_was_killed) {
  run(path(""));
  ASSERT_TRUE(comes_on()) << run_->said();
  living_.front().reset();
  const usercan::Process again({"drive", bus(), "--node", "1"});
  EXPECT_TRUE(again.says("node 1 on")) << again.said();
}

TEST_F(HeldByRun, of_somebody_else_is_heard_and_left_alone) {
  run(path("else"));
  ASSERT_TRUE(comes_on()) << run_->said();
  for (const char* words : {"sdo $BUS 1 read 6041", "od $BUS 1", "scan $BUS"}) {
    const Ended ended = tool(words);
    EXPECT_EQ(ended.code, 1) << words;
    EXPECT_TRUE(ended.err_has("another master controls this bus")) << ended.err;
    EXPECT_TRUE(ended.err_has("--anyway reads regardless")) << ended.err;
  }
  const Ended written = tool("sdo $BUS 1 write 1801:1 0x40000281");
  EXPECT_EQ(written.code, 1);
  EXPECT_TRUE(written.err_has("writing 1801h:01 is refused: another master controls this bus"))
      << written.err;
  EXPECT_EQ(tool("sdo $BUS 1 write 1801:1 0x40000281 --anyway").code, 2);
  EXPECT_EQ(alarms(), std::vector<int>());
}

TEST_F(HeldByRun, is_told_of_who_reads_all_the_same) {
  run(path("else"));
  ASSERT_TRUE(comes_on()) << run_->said();
  EXPECT_EQ(tool("sdo $BUS 1 read 6041 --anyway").code, 0);
  EXPECT_EQ(alarms(), std::vector<int>{kForeignRequest});
  EXPECT_NE(texts_.find("somebody else sends SDO request of node 1, read 6041h:00 (601h)"), std::string::npos)
      << texts_;
}

}  // namespace
}  // namespace servogate::canopen_tools
