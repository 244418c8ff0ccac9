// SPDX-License-Identifier: Apache-2.0
// The road of stops and keep-alives: whatever else the server is busy with, they are heard.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;  // what it measures is printed; answers come before or they do not
constexpr int kPatience_ms = 120'000;

class Urgent : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up("mill", {"--virtual", "--speed", "20"});
    ASSERT_TRUE(stopper_.connect(shell_.socket()).empty());
  }
  /// A part program that takes seconds to look through, or so many times as long.
  std::string long_program(int times = 1) {
    const std::string path = (shell_.folder() / "long.nc").string();
    std::ofstream out(path);
    for (int n = 0; n < times * 700'000; ++n)
      out << "G1 X" << n % 100 << "." << n % 7 << " Y" << n % 90 << " F1000\n";
    out << "M30\n";
    return path;
  }
  /// A PLC program that takes seconds to compile, or so many times as long.
  std::string long_logic(int times = 1) {
    const std::string path = (shell_.folder() / "long.st").string();
    std::ofstream out(path);
    out << "PROGRAM Main\nVAR x, y : DINT; END_VAR\nCASE x OF\n";
    for (int n = 0; n < 20'000; ++n) out << n << ": y := " << n << ";\n";
    out << "END_CASE;\n";
    for (int n = 0; n < times * 150'000; ++n) out << "y := (x + " << n << ") * y - x;\n";
    out << "END_PROGRAM\n";
    return path;
  }
  /// Sends a request that takes long, and waits until it is being worked for, or over.
  void begin(const json& request) {
    worker_ = std::make_unique<SocketClient>();
    answered_ = false;
    ASSERT_TRUE(worker_->connect(shell_.socket()).empty());
    ASSERT_TRUE(worker_->send(request.dump() + "\n"));
    ASSERT_TRUE(
        shell_.until([&](const json& s) { return works(s, request["cmd"]) || worker_has_its_answer(); }));
  }
  static bool works(const json& status, const std::string& what) {
    for (const json& w : status["works"])
      if (w["what"] == what) return true;
    return false;
  }
  bool worker_has_its_answer() {
    if (!answered_) answered_ = worker_->receive(worker_answer_, 0);
    return answered_;
  }
  json say(const json& request) {
    std::string answer;
    EXPECT_TRUE(stopper_.exchange(request.dump(), answer));
    return json::parse(answer, nullptr, false);
  }
  /// Stops of all kinds are answered before the work is. How long that takes is the computer's: where it was
  /// too fast for the work, there is more of it. Behind the work none would be answered, however much it is.
  void every_stop_comes_first(const std::function<json(int times)>& work) {
    for (int times = 1; times <= 4; times *= 2) {
      begin(work(times));
      const std::size_t stops = stops_until_the_work_is_done();
      EXPECT_TRUE(answered_ || worker_->receive(worker_answer_, kPatience_ms));
      if (stops >= 8) return;
    }
    ADD_FAILURE() << "stops wait for the work";
  }
  std::size_t stops_until_the_work_is_done() {
    std::vector<double> times_s;
    for (int n = 0; n < 24 && !worker_has_its_answer(); ++n) {
      const json request = n % 4 == 0   ? json{{"cmd", "hold"}}
                           : n % 4 == 1 ? json{{"cmd", "stop"}}
                           : n % 4 == 2 ? json{{"cmd", "jog_stop"}}
                                        : json{{"cmd", "power"}, {"value", 0}};
      const Clock::time_point begun = Clock::now();
      const json answer = say(request);
      times_s.push_back(std::chrono::duration<double>(Clock::now() - begun).count());
      EXPECT_EQ(answer["ok"], true) << request << answer;
    }
    print_middle_of(times_s);
    return times_s.size();
  }
  static void print_middle_of(std::vector<double>& times_s) {
    std::sort(times_s.begin(), times_s.end());
    if (!times_s.empty())
      std::printf("a stop is answered after %.1f ms\n", 1e3 * times_s[times_s.size() / 2]);
  }

  Shell shell_;
  SocketClient stopper_;
  std::unique_ptr<SocketClient> worker_ = std::make_unique<SocketClient>();
  std::string worker_answer_;
  bool answered_ = false;
};

TEST_F(Urgent, stops_are_answered_while_a_part_program_is_looked_through) {
  every_stop_comes_first([&](int times) { return json{{"cmd", "load"}, {"program", long_program(times)}}; });
  EXPECT_EQ(json::parse(worker_answer_)["ok"], true) << worker_answer_;
}

TEST_F(Urgent, stops_are_answered_while_the_plc_program_is_compiled) {
  every_stop_comes_first([&](int times) {
    return json{{"cmd", "plc_load"}, {"files", {long_logic(times)}}};
  });
}

TEST_F(Urgent, a_stop_is_heard_behind_a_long_request_of_its_own_connection_and_answered_in_its_turn) {
  const std::string program = long_program(6);
  ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
  ASSERT_TRUE(worker_->connect(shell_.socket()).empty());
  ASSERT_TRUE(worker_->send(json{{"cmd", "load"}, {"program", program}}.dump() + "\n" +
                            R"({"cmd":"start"})"
                            "\n"
                            R"({"cmd":"power","value":0})"
                            "\n"));
  EXPECT_TRUE(shell_.until([&](const json& s) {
    return s["axes"][0]["enabled"] == false && works(s, "load");
  })) << "the drives go off before the program is looked through";
  std::string answers[3];
  for (std::string& answer : answers) ASSERT_TRUE(worker_->receive(answer, kPatience_ms));
  EXPECT_TRUE(json::parse(answers[0]).contains("findings")) << answers[0];
  EXPECT_EQ(json::parse(answers[1])["code"], "socket.overtaken") << answers[1];
  EXPECT_EQ(json::parse(answers[2])["text"], "the drives are being switched off") << answers[2];
}

TEST_F(Urgent, others_are_answered_and_jogs_kept_alive_while_somebody_loads) {
  ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
  int asked = 0;
  for (int times = 1; times <= 4 && asked < 5; times *= 2) {  // more work where the computer was too fast
    begin({{"cmd", "load"}, {"program", long_program(times)}});
    for (asked = 0; asked < 20 && !worker_has_its_answer(); ++asked) {
      EXPECT_TRUE(say({{"cmd", "status"}}).contains("axes"));
      EXPECT_TRUE(say({{"cmd", "jog"}, {"axis", "X"}, {"value", 0.01}}).contains("ok"));
    }
    EXPECT_TRUE(answered_ || worker_->receive(worker_answer_, kPatience_ms));
  }
  EXPECT_GE(asked, 5);
}

TEST_F(Urgent, sigterm_ends_the_control_while_somebody_loads_and_the_load_is_given_up) {
  begin({{"cmd", "load"}, {"program", long_program(4)}});
  kill(shell_.pid(), SIGTERM);
  ASSERT_TRUE(worker_->receive(worker_answer_, kPatience_ms));
  EXPECT_EQ(json::parse(worker_answer_)["code"], "socket.ending") << worker_answer_;
  EXPECT_EQ(shell_.wait(), 0);
}

TEST_F(Urgent, connections_that_say_nothing_keep_nobody_from_stopping_the_machine) {
  std::vector<std::unique_ptr<SocketClient>> idle;
  std::string answer;
  for (int n = 0; n < 80; ++n) {
    idle.push_back(std::make_unique<SocketClient>());
    ASSERT_TRUE(idle.back()->connect(shell_.socket()).empty()) << n;
  }
  for (const char* stop : {R"({"cmd":"hold"})", R"({"cmd":"quick_stop"})", R"({"cmd":"power","value":0})"}) {
    SocketClient late;
    ASSERT_TRUE(late.connect(shell_.socket()).empty());
    ASSERT_TRUE(late.exchange(stop, answer)) << stop;
    EXPECT_EQ(json::parse(answer)["ok"], true) << answer;
  }
}

TEST_F(Urgent, a_flood_of_requests_holds_no_stop_up) {
  std::vector<std::jthread> floods;
  for (int f = 0; f < 8; ++f)
    floods.emplace_back([&](const std::stop_token& end) {
      SocketClient client;
      if (!client.connect(shell_.socket()).empty()) return;
      const std::string wide = R"({"cmd":"status","unit":")" + std::string(50'000, 'x') + "\"}\n";
      const std::jthread reader([&] {
        for (std::string line; !end.stop_requested();) client.receive(line, 200);
      });
      while (!end.stop_requested() && client.send(wide)) {
      }
    });
  std::vector<double> times_s;
  for (int n = 0; n < 20; ++n) {
    const Clock::time_point begun = Clock::now();
    EXPECT_EQ(say({{"cmd", "hold"}})["ok"], true);
    times_s.push_back(std::chrono::duration<double>(Clock::now() - begun).count());
  }
  for (std::jthread& flood : floods) flood.request_stop();
  floods.clear();
  print_middle_of(times_s);
}

}  // namespace
}  // namespace servogate::gateway::testing
