// SPDX-License-Identifier: Apache-2.0
// What a client asked for while the control was stopped: motion and energy only if it still waits and the
// control stood for no time, stops always.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <thread>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// More than a request may lie; a slow computer makes it longer, never shorter.
constexpr std::chrono::milliseconds kStall{300};

class Stalled : public ::testing::Test {
 protected:
  /// Stops the control, says something to it, and lets it go on.
  template <typename Say>
  void while_it_stands(const Say& say) {
    ASSERT_EQ(kill(shell_.pid(), SIGSTOP), 0);
    siginfo_t stopped{};  // a signal is sent before it acts
    ASSERT_EQ(waitid(P_PID, static_cast<id_t>(shell_.pid()), &stopped, WSTOPPED), 0);
    say();
    std::this_thread::sleep_for(kStall);
    ASSERT_EQ(kill(shell_.pid(), SIGCONT), 0);
  }
  void load(const std::string& blocks) {
    std::ofstream(shell_.folder() / "part.nc") << blocks;
    ASSERT_EQ(shell_.run({"load", (shell_.folder() / "part.nc").string()}).exit, 0);
  }
  /// Refusals of this code in the history.
  std::size_t refused(const std::string& code) {
    std::size_t n = 0;
    const json history = shell_.ask({{"cmd", "history"}});
    for (const json& event : history["events"])
      if (event.dump().find(code) != std::string::npos) ++n;
    return n;
  }
  Shell shell_;
};

/// Each of a client that has closed its connection meanwhile.
class OfAClientThatIsGone : public Stalled {
 protected:
  void says(const json& request) {
    const std::size_t before = refused("has gone");
    while_it_stands([&] {
      SocketClient gone;
      ASSERT_TRUE(gone.connect(shell_.socket()).empty());
      ASSERT_TRUE(gone.send(request.dump() + "\n"));
    });
    EXPECT_TRUE(shell_.until([&](const json&) { return refused("has gone") > before; })) << request;
  }
};

TEST_F(OfAClientThatIsGone, nothing_is_switched_on_homed_or_moved) {
  shell_.up("mill", {"--virtual", "--speed", "5"});
  says({{"cmd", "power"}, {"value", 1}});
  EXPECT_FALSE(shell_.status()["axes"][0]["enabled"].get<bool>());
  ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
  says({{"cmd", "home"}});
  EXPECT_FALSE(shell_.status()["axes"][2]["moving"].get<bool>());
  says({{"cmd", "jog"}, {"axis", "X"}, {"value", 10}});
  says({{"cmd", "jog_continuous"}, {"axis", "X"}, {"value", 1}});
  EXPECT_EQ(shell_.status()["axes"][0]["command"], 0.0);
}

TEST_F(OfAClientThatIsGone, no_block_no_program_and_no_held_program_goes_on) {
  shell_.up();
  shell_.ready();
  const json x = shell_.status()["axes"][0]["command"];
  const auto x_stands = [&] { return shell_.status()["axes"][0]["command"] == x; };
  says({{"cmd", "mdi"}, {"block", "G0 X40"}});
  EXPECT_TRUE(x_stands());
  load("N10 G0 X40\nN20 M2\n");
  says({{"cmd", "start"}});
  says({{"cmd", "step"}});
  EXPECT_TRUE(x_stands());
  load("N10 M0\nN20 G0 X40\nN30 M2\n");
  ASSERT_EQ(shell_.run({"start"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "waiting"; }));
  says({{"cmd", "resume"}});
  EXPECT_EQ(shell_.status()["state"], "waiting");
  EXPECT_TRUE(x_stands());
  EXPECT_EQ(shell_.run({"resume"}).exit, 0) << "of one who waits for the answer it goes on";
  EXPECT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["command"] == 40.0; }));
}

TEST_F(Stalled, every_stop_of_a_client_that_is_gone_is_carried_out_however_much_stood_before_it) {
  shell_.up();
  shell_.ready();
  load("N10 G1 X200 F60\nN20 M2\n");
  ASSERT_EQ(shell_.run({"start"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["feed_mm_min"] > 50.0; }));
  while_it_stands([&] {
    SocketClient gone;
    ASSERT_TRUE(gone.connect(shell_.socket()).empty());
    std::string lines;
    for (int n = 0; n < 100; ++n) lines += R"({"cmd":"status"})" "\n";
    ASSERT_TRUE(gone.send(lines + R"({"cmd":"stop"})" "\n"));
  });
  EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "idle" && !s["axes"][0]["moving"]; }))
      << shell_.status();
  EXPECT_LT(shell_.status()["axes"][0]["command"].get<double>(), 199.0);
}

TEST_F(Stalled, in_real_time_what_begins_something_is_too_old_even_for_a_client_that_still_waits) {
  shell_.up("mill", {"--realtime=best-effort", "--state", (shell_.folder() / "state").string()});
  load("N10 G0 X40\nN20 M2\n");
  for (const json& request :
       {json{{"cmd", "mdi"}, {"block", "G0 X40"}}, json{{"cmd", "jog"}, {"axis", "X"}, {"value", 10}},
        json{{"cmd", "jog_continuous"}, {"axis", "X"}, {"value", 1}}, json{{"cmd", "start"}},
        json{{"cmd", "step"}}, json{{"cmd", "resume"}}, json{{"cmd", "home"}},
        json{{"cmd", "power"}, {"value", 1}}, json{{"cmd", "override"}, {"value", 100}},
        json{{"cmd", "plc_force"}, {"name", "coolant"}, {"value", "TRUE"}, {"stay", true}}}) {
    SocketClient waits;
    std::string answer;
    while_it_stands([&] {
      ASSERT_TRUE(waits.connect(shell_.socket()).empty());
      ASSERT_TRUE(waits.send(request.dump() + "\n"));
    });
    ASSERT_TRUE(waits.receive(answer, 60'000));
    EXPECT_EQ(json::parse(answer)["code"], "gate.too_old") << request << answer;
  }
  const json status = shell_.status();
  EXPECT_FALSE(status["axes"][0]["enabled"].get<bool>());
  EXPECT_TRUE(status["forced"].empty());
  for (const json& request :
       {json{{"cmd", "stop"}}, json{{"cmd", "hold"}}, json{{"cmd", "jog_stop"}},
        json{{"cmd", "power"}, {"value", 0}}, json{{"cmd", "override"}, {"value", 0}},
        json{{"cmd", "reset"}}, json{{"cmd", "quick_stop"}}}) {
    SocketClient waits;
    std::string answer;
    while_it_stands([&] {
      ASSERT_TRUE(waits.connect(shell_.socket()).empty());
      ASSERT_TRUE(waits.send(request.dump() + "\n"));
    });
    ASSERT_TRUE(waits.receive(answer, 60'000));
    EXPECT_EQ(json::parse(answer)["ok"], true) << request << answer;
  }
}

}  // namespace
}  // namespace servogate::gateway::testing
