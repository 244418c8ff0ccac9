// SPDX-License-Identifier: Apache-2.0
// `servogate jog`: how long a hand holds it, why it ended, and where the axis stands then.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "tests/comes.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

bool x_moves(const json& s) { return s["axes"][0]["moving"].get<bool>(); }

class JogCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up("mill", {"--virtual", "--speed", "20"});
    ASSERT_EQ(shell_.run({"power", "on"}).exit, 0);
    if (homed_) {
      ASSERT_EQ(shell_.run({"home", "--wait"}).exit, 0);
    }
  }
  /// What `jog X DIRECTION` says when `happens` comes while it moves. A hand that a busy computer holds up
  /// for a tenth of a second of the wall clock is a dead one, as it must be: then all begins again, with a
  /// new control, and it is said.
  template <typename Happens>
  Outcome while_it_jogs(Happens&& happens, const std::string& direction = "+") {
    Outcome last;
    EXPECT_TRUE(tests::comes([&] {
      const pid_t client = shell_.spawn({"jog", "X", direction}, "jog");
      EXPECT_TRUE(
          shell_.until([](const json& s) { return x_moves(s) || s["axes"][0]["jog_end"].is_object(); }));
      happens(client);
      last = {ending_of(client), shell_.text("jog.out"), shell_.text("jog.err")};
      EXPECT_FALSE(x_moves(shell_.status())) << "the command ends when the axis stands";
      if (HasFatalFailure() || !contains(last.err, "[jog.keep-alive]")) return true;
      std::printf("this computer held the hand up for too long; once more\n");
      shell_.end(SIGINT);
      SetUp();
      return false;
    }));
    return last;
  }
  bool homed_ = false;
  Shell shell_;
};

class HomedJogCommand : public JogCommand {
 protected:
  HomedJogCommand() { homed_ = true; }
};

TEST_F(JogCommand, goes_on_at_twenty_times_the_wall_clock_until_Ctrl_C_and_says_where_the_axis_stands) {
  double way = 0.0;
  const Outcome o = while_it_jogs([&](pid_t client) {
    const double from = shell_.status()["axes"][0]["command"];
    shell_.until([&](const json& s) {
      way = s["axes"][0]["command"].get<double>() - from;
      return way > 20.0 || !x_moves(s);
    });
    kill(client, SIGINT);
  });
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_TRUE(contains(o.out, "X stands at ")) << o.out;
  EXPECT_GT(way, 20.0) << "ten times as long as 100 ms of the machine's time";
}

TEST_F(JogCommand, ends_at_a_silent_hand_with_that_as_its_reason) {
  SocketClient client;
  std::string answer;
  ASSERT_TRUE(client.connect(shell_.socket()).empty());
  ASSERT_TRUE(client.exchange(R"({"cmd":"jog_continuous","axis":"X","value":1})", answer));
  EXPECT_EQ(json::parse(answer)["keep_alive_ms"], 30.0) << answer;
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["jog_end"].is_object(); }));
  EXPECT_EQ(shell_.status()["axes"][0]["jog_end"]["reason"], "keep_alive");
  ASSERT_TRUE(client.exchange(R"({"cmd":"keep_alive"})", answer));
  EXPECT_EQ(json::parse(answer)["moving"], false) << answer;
  EXPECT_EQ(json::parse(answer)["reason"], "keep_alive") << answer;
  EXPECT_TRUE(contains(json::parse(answer)["text"], "no keep-alive")) << answer;
}

TEST_F(JogCommand, ends_when_another_hand_asks_for_the_other_direction) {
  json answer;
  const Outcome o = while_it_jogs([&](pid_t) {
    answer = shell_.ask({{"cmd", "jog_continuous"}, {"axis", "X"}, {"value", -1}});
  });
  EXPECT_EQ(answer["code"], "gate.axis_moves");
  EXPECT_EQ(o.exit, 3) << o.err;
  EXPECT_TRUE(contains(o.err, "[jog.asked]")) << o.err;
}

class JogOfTwo : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up("mill", {"--virtual", "--speed", "0.5"});
    ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
  }
  Shell shell_;
};

TEST_F(JogOfTwo, stops_the_axis_of_the_frozen_hand_only_while_the_other_one_goes_on) {
  std::jthread other([&](const std::stop_token& end) {
    SocketClient y;
    std::string answer;
    if (!y.connect(shell_.socket()).empty()) return;
    while (!end.stop_requested()) {
      const bool moves =
          y.exchange(R"({"cmd":"keep_alive"})", answer) && contains(answer, R"("moving":true)");
      // At first, and where it was late on a busy computer, it begins.
      if (!moves) y.exchange(R"({"cmd":"jog_continuous","axis":"Y","value":-1})", answer);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  const auto moves = [](std::size_t axis) {
    return [axis](const json& s) { return s["axes"][axis]["moving"].get<bool>(); };
  };
  EXPECT_TRUE(shell_.until(moves(1)));
  const pid_t x = shell_.spawn({"jog", "X", "+"}, "jog-x");
  EXPECT_TRUE(
      shell_.until([&](const json& s) { return moves(0)(s) || s["axes"][0]["jog_end"].is_object(); }));
  kill(x, SIGSTOP);
  EXPECT_TRUE(shell_.until([&](const json& s) { return !x_moves(s); }));
  const json frozen = shell_.status();
  EXPECT_EQ(frozen["axes"][0]["jog_end"]["reason"], "keep_alive");
  EXPECT_TRUE(shell_.until([&](const json& s) {
    return s["axes"][1]["command"].get<double>() < frozen["axes"][1]["command"].get<double>() - 4.0;
  })) << "the other one goes on";
  EXPECT_EQ(shell_.status()["axes"][0]["command"], frozen["axes"][0]["command"]);
  other.request_stop();
  other.join();
  kill(x, SIGKILL);
  ending_of(x);
}

TEST_F(JogCommand, by_a_distance_returns_when_the_axis_stands) {
  const Outcome o = shell_.run({"jog", "X", "+2mm"});
  EXPECT_EQ(o.exit, 0) << o.err;
  EXPECT_FALSE(x_moves(shell_.status()));
  EXPECT_NEAR(shell_.status()["axes"][0]["command"].get<double>(), 2.0, 1e-9);
  EXPECT_TRUE(contains(o.out, "X stands at ")) << o.out;
  EXPECT_TRUE(contains(shell_.run({"jog", "X", "-2mm"}, "ru_RU.UTF-8").out, "X стоит на "));
  const json told = json::parse(shell_.run({"jog", "X", "+1mm", "--json"}).out);
  EXPECT_EQ(told["reason"], "arrived");
  EXPECT_EQ(told["exit"], 0);
  EXPECT_NEAR(told["position"].get<double>(), 1.0, 0.05);
  const Outcome at_once = shell_.run({"jog", "X", "+100mm", "--no-wait"});
  EXPECT_TRUE(contains(at_once.out, "X moves by +100 mm")) << at_once.out;
}

TEST_F(JogCommand, that_an_alarm_ends_says_so_and_is_no_success) {
  const Outcome o = while_it_jogs([&](pid_t) {
    ASSERT_EQ(shell_.run({"input", "x_limit_plus", "on"}).exit, 0);
  });
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "X was stopped by an alarm")) << o.err;
  EXPECT_TRUE(contains(o.err, "[jog.alarm]")) << o.err;
  EXPECT_TRUE(contains(o.out, "limit")) << "the alarm itself: " << o.out;
}

TEST_F(JogCommand, that_the_plc_ends_says_so_and_is_no_success) {
  const Outcome o = while_it_jogs([&](pid_t) {
    ASSERT_EQ(shell_.run({"input", "door_closed", "off"}).exit, 0);
  });
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "the PLC no longer permits its motion")) << o.err;
}

TEST_F(HomedJogCommand, that_the_end_of_the_travel_ends_says_so) {
  const Outcome o = while_it_jogs([](pid_t) {});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "at the end of its travel; X stands at 300 mm (machine coordinates)")) << o.err;
}

TEST_F(JogCommand, that_somebody_else_ends_is_stopped_by_the_operator) {
  const Outcome o = while_it_jogs([&](pid_t) { ASSERT_EQ(shell_.ask({{"cmd", "stop"}})["ok"], true); });
  EXPECT_EQ(o.exit, 3);
  EXPECT_TRUE(contains(o.err, "stopped by a request")) << o.err;
}

}  // namespace
}  // namespace servogate::gateway::testing
