// SPDX-License-Identifier: Apache-2.0
// A control that would become the second master of a bus is refused, and the first one's axes never notice.
#include <csignal>

#include <fstream>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/usercan/rig/mill.hpp"

namespace servogate::canopen_tools {
namespace {

/// The mill cuts a long line on the bus of the workbench, its drives in processes of their own; another
/// machine file names the same wire.
class SecondControl : public Workbench {
 protected:
  SecondControl() {
    machine_ = usercan::mill(bus(), usercan::patience());
    other_ = path("other.toml");
    std::string text = usercan::content(machine_);
    const std::string name = "name = \"Three-axis mill\"";
    text.replace(text.find(name), name.size(), "name = \"Another machine\"");
    std::ofstream(other_) << text;
    drives_ = usercan::mill_drives(machine_);
    desk_.write("long.nc", "N1 G90 G0 X10 Y0 Z0\nN2 G1 X10 Y90 F100\nN3 M30\n");
    desk_.write("short.nc", "N1 G90 G0 X1 Y0 Z0\nN2 M30\n");
  }
  /// The first control. `runtime`: where it can be found; tools look in the folder of the test.
  void run(const std::string& runtime) {
    setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
    first_ = std::make_unique<usercan::Process>(std::vector<std::string>{
        "run", machine_, path("long.nc"), "--realtime=best-effort", "-q", "--report", path("report.json")});
    unsetenv("XDG_RUNTIME_DIR");
  }
  /// Y is cutting: its drive has been moved some way.
  bool cuts() {
    const auto ear = join();
    std::int32_t begin = 0;
    bool known = false;
    for (image::CanFrame frame; usercan::wait_for(*ear, frame);) {
      if (frame.id != canopen::cob::rpdo(1, 2) || frame.length < 6) continue;
      const auto place = static_cast<std::int32_t>(canopen::load_le(std::span(frame.data).subspan(2, 4)));
      if (!known) begin = place;
      known = true;
      if (std::abs(place - begin) > 20'000) return true;
    }
    return false;
  }
  /// What the drives noticed of a second control while `line` was carried out: NMT commands, and statuswords
  /// of Y that are not Operation enabled.
  struct Noticed {
    int commands = 0, faults = 0, statuswords = 0;
  };
  Ended watched(const std::string& line, Noticed& noticed) {
    const auto ear = join();
    image::CanFrame frame;
    while (ear->receive(frame)) continue;
    const Ended ended = desk_.line(line);
    while (ear->receive(frame)) {
      noticed.commands += frame.id == canopen::cob::kNmt ? 1 : 0;
      if (frame.id != canopen::cob::tpdo(1, 2) || frame.length < 2) continue;
      ++noticed.statuswords;
      noticed.faults += (frame.data[0] & 0x6F) != 0x27 ? 1 : 0;
    }
    return ended;
  }
  /// Ends the first control; what it has to say of alarms.
  json alarms() {
    first_->signal(SIGINT);
    EXPECT_EQ(first_->wait(), 3) << first_->said();
    const json report = json::parse(desk_.text("report.json"), nullptr, false);
    return report.is_object() ? report["alarms"] : json("no report");
  }
  std::string start(const std::string& command, const std::string& more = "") const {
    return "$SG " + command + " " + other_ + " " + more + " --realtime=best-effort";
  }
  std::string machine_, other_;
  std::vector<std::unique_ptr<usercan::Process>> drives_;
  std::unique_ptr<usercan::Process> first_;
};

TEST_F(SecondControl, is_refused_by_the_name_of_the_first_where_it_can_be_asked) {
  run(path(""));
  ASSERT_TRUE(cuts()) << first_->said();
  Noticed noticed;
  for (const std::string& line : {start("up", "--state s"), start("run", "short.nc")}) {
    const Ended ended = watched(line, noticed);
    EXPECT_EQ(ended.code, 1) << ended.err;
    EXPECT_TRUE(ended.err_has(
        "starting 'Another machine' is refused: a `servogate run` of 'Three-axis mill' uses bus " + bus()))
        << ended.err;
  }
  EXPECT_EQ(noticed.commands, 0);
  EXPECT_EQ(noticed.faults, 0) << noticed.statuswords;
  EXPECT_GT(noticed.statuswords, 0);
  EXPECT_EQ(alarms(), json::array());
}

TEST_F(SecondControl, hears_a_first_one_that_it_cannot_ask_and_leaves_its_drives_in_peace) {
  run(path("else"));
  ASSERT_TRUE(cuts()) << first_->said();
  Noticed noticed;
  for (const std::string& line : {start("up", "--state s"), start("run", "short.nc")}) {
    const Ended ended = watched(line, noticed);
    EXPECT_EQ(ended.code, 1) << ended.err;
    for (const char* words : {"'Another machine' is not started: another master controls bus ",
                              "SYNC (080h) ", "RPDO 1 of node 1 (201h) ", " times", "Nothing was sent"})
      EXPECT_TRUE(ended.err_has(words)) << words << "\n" << ended.err;
  }
  EXPECT_EQ(noticed.commands, 0);
  EXPECT_EQ(noticed.faults, 0) << noticed.statuswords;
  EXPECT_GT(noticed.statuswords, 50);
  EXPECT_EQ(alarms(), json::array());
}

TEST_F(SecondControl, starts_when_the_first_was_killed_and_its_drives_speak_on) {
  run(path(""));
  ASSERT_TRUE(cuts()) << first_->said();
  first_->signal(SIGKILL);
  EXPECT_EQ(first_->wait(), -1);
  const auto ear = join();
  image::CanFrame frame;
  ASSERT_TRUE(usercan::wait_for(*ear, frame)) << "heartbeats go on";
  Noticed noticed;
  const Ended ended = watched(start("run", "short.nc"), noticed);
  EXPECT_FALSE(ended.err_has("is not started")) << ended.err;
  EXPECT_FALSE(ended.err_has("is refused")) << ended.err;
  EXPECT_GE(noticed.commands, 4) << "it takes the drives over, faults of the loss included\n" << ended.err;
}

TEST_F(SecondControl, that_starts_at_the_same_time_is_one_too_many) {
  const Ended ended = desk_.line("(" + start("run", "short.nc") + " 2>a; echo $? >a.code) & (" +
                                 start("run", "short.nc") + " 2>b; echo $? >b.code) & wait");
  EXPECT_EQ(ended.code, 0);
  const bool first = desk_.text("a.code") == "0\n";
  EXPECT_EQ(desk_.text(first ? "a.code" : "b.code"), "0\n") << desk_.text("a") << desk_.text("b");
  EXPECT_EQ(desk_.text(first ? "b.code" : "a.code"), "1\n") << desk_.text("a") << desk_.text("b");
  const std::string refused = desk_.text(first ? "b" : "a");
  EXPECT_NE(refused.find("has just taken bus " + bus()), std::string::npos) << refused;
}

}  // namespace
}  // namespace servogate::canopen_tools
