// SPDX-License-Identifier: Apache-2.0
// A control that would become the second master of a bus is refused, and the first one's axes never notice.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>

#include "drivers/clock.hpp"
#include "firmware_if/canopen/301/cob_id.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/comes.hpp"
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
    runtime_ = runtime;
    setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
    first_ = std::make_unique<usercan::Process>(std::vector<std::string>{
        "run", machine_, path("long.nc"), "--realtime=best-effort", "-q", "--report", path("report.json")});
    unsetenv("XDG_RUNTIME_DIR");
  }
  /// Y is cutting: its drive has been moved some way. A computer that stalls ends a run in real time: then
  /// the same is tried again.
  bool cuts() {
    constexpr int kTries = 5;
    for (int n = 0; n < kTries; ++n) {
      if (n > 0) run(runtime_);
      if (is_moved()) return true;
      if (!first_->ended()) return false;
    }
    return false;
  }
  bool is_moved() {
    const auto ear = join();
    std::int32_t begin = 0;
    bool known = false;
    for (image::CanFrame frame; !first_->ended() && usercan::wait_for(*ear, frame);) {
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
  /// But for heartbeats that drives missed while this computer stalled: those say nothing of another control.
  json alarms() {
    constexpr double kHeartbeatMissed = 0x8130;
    first_->signal(SIGINT);
    EXPECT_EQ(first_->wait(), 3) << first_->said();
    const json report = json::parse(desk_.text("report.json"), nullptr, false);
    if (!report.is_object()) return "no report";
    json others = json::array();
    for (const json& alarm : report["alarms"])
      if (alarm.value("value", 0.0) != kHeartbeatMissed) others.push_back(alarm);
    return others;
  }
  /// Another control that nobody finds by its socket.
  std::unique_ptr<usercan::Process> up(const std::string& machine, const std::string& name) const {
    setenv("XDG_RUNTIME_DIR", path(name).c_str(), 1);
    auto control = std::make_unique<usercan::Process>(
        std::vector<std::string>{"up", machine, "--realtime=best-effort", "--state", path(name + ".state"),
                                 "--socket", path(name + ".sock")});
    unsetenv("XDG_RUNTIME_DIR");
    return control;
  }
  /// Numbers of the alarms of that control.
  std::vector<int> alarms_of(const std::string& name) const {
    std::vector<int> numbers;
    for (const json& alarm : facts("status --socket " + path(name + ".sock"))["alarms"])
      numbers.push_back(alarm["number"]);
    return numbers;
  }
  /// What has come until now, however much of it still waits in the server.
  template <class Handler>
  static void read_until_now(usercan::SocketcandBus& ear, Handler handler) {
    const image::Nanoseconds now = drivers::clock_ns(CLOCK_MONOTONIC);
    for (image::CanFrame frame; usercan::wait_for(ear, frame) && frame.timestamp_ns < now;) handler(frame);
  }
  static bool has(const std::vector<int>& numbers, int number) {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
  }
  std::string start(const std::string& command, const std::string& more = "") const {
    return "$SG " + command + " " + other_ + " " + more + " --realtime=best-effort";
  }
  static constexpr int kForeignFrame = 2014, kLeadLost = 2025;
  std::string machine_, other_;
  std::vector<std::unique_ptr<usercan::Process>> drives_;
  std::string runtime_;
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

TEST_F(SecondControl, that_starts_at_the_same_time_and_cannot_be_asked_gives_way) {
  for (int i = 0; i < 3; ++i) {
    const std::string a = "a" + std::to_string(i), b = "b" + std::to_string(i);
    const auto first = up(machine_, a), second = up(other_, b);
    const auto leads = [](const usercan::Process& control) {
      return control.said().find("is up; control socket") != std::string::npos;
    };
    ASSERT_TRUE(tests::comes([&] { return leads(*first) || leads(*second); }))
        << first->said() << second->said();
    const bool is_first = leads(*first);
    EXPECT_EQ((is_first ? second : first)->wait(), 1) << first->said() << second->said();
    EXPECT_TRUE(leads(is_first ? *first : *second)) << first->said() << second->said();
    const std::string refused = (is_first ? second : first)->said();
    EXPECT_NE(refused.find("is not started: another "), std::string::npos) << refused;
    EXPECT_FALSE(has(alarms_of(is_first ? a : b), kForeignFrame));
  }
}

TEST_F(SecondControl, that_took_the_place_of_a_stopped_one_keeps_it_when_that_one_wakes_up) {
  run(path("else"));
  ASSERT_TRUE(cuts()) << first_->said();
  first_->signal(SIGSTOP);
  const auto second = up(other_, "second");
  ASSERT_TRUE(second->says("is up; control socket")) << second->said();
  const auto ear = join();
  first_->signal(SIGCONT);
  EXPECT_NE(first_->wait(), 0) << first_->said();
  // A signal may come between two frames of a cycle; of the next one there is nothing.
  std::map<std::uint32_t, int> enabled;
  image::CanFrame frame;
  read_until_now(*ear, [&](const image::CanFrame& f) {
    if (canopen::classify(f.id).service == canopen::Service::rpdo1 && f.length >= 2 &&
        (f.data[0] & 0x0F) == 0x0F)
      ++enabled[f.id];
  });
  for (const auto& [id, count] : enabled) EXPECT_LE(count, 1) << std::hex << id;
  bool said = false;
  const json report = json::parse(desk_.text("report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object()) << first_->said();
  for (const json& alarm : report["alarms"]) said = said || alarm["number"] == kLeadLost;
  EXPECT_TRUE(said) << report["alarms"];
  EXPECT_FALSE(has(alarms_of("second"), kLeadLost)) << "one of them leads the bus";
  while (ear->receive(frame)) continue;
  do {
    ASSERT_TRUE(usercan::wait_for(*ear, frame)) << second->life();
  } while (frame.id != canopen::cob::kSync);
}

TEST_F(SecondControl, that_sends_set_points_all_the_same_stops_the_axes_and_takes_their_power) {
  run(path("else"));
  ASSERT_TRUE(cuts()) << first_->said();
  const auto ear = join();
  ear->send(usercan::make(0x202, {0x0F, 0, 0, 0, 0, 0}));
  EXPECT_NE(first_->wait(), 0) << first_->said();
  const json report = json::parse(desk_.text("report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object()) << first_->said();
  json heard;
  for (const json& alarm : report["alarms"])
    if (alarm["number"] == kForeignFrame) heard = alarm;
  ASSERT_TRUE(heard.is_object()) << report["alarms"];
  EXPECT_NE(heard["text"].get<std::string>().find("another master sends RPDO 1 of node 2 (202h)"),
            std::string::npos)
      << heard;
  int controlword = -1;
  read_until_now(*ear, [&](const image::CanFrame& f) {
    if (f.id == 0x202) controlword = f.data[0];
  });
  EXPECT_NE(controlword & 0x0F, 0x0F) << "the power is off at the end";
}

}  // namespace
}  // namespace servogate::canopen_tools
