// SPDX-License-Identifier: Apache-2.0
// The desk and its clients: one that is no socket, in this process and without a word of JSON, beside one
// that asks in lines.
#include "gateway/control/server/desk/desk.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/server/desk/desk_client.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "gateway/control/server/socket/socket_server.hpp"
#include "tests/comes.hpp"
#include "tests/places/places.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

/// The example mill as `servogate up --virtual --speed 2` runs it, in this process.
class DeskOfAMill : public ::testing::Test {
 protected:
  DeskOfAMill()
      : running_(RunningMachine::compose(machine::load(Shell::example("mill/machine.toml")), nullptr,
                                         {.clock = ClockKind::virtual_time, .pace = 2.0}, findings_)),
        resident_(running_->control(), machine::MachineState{}, std::string(), 2.0) {}
  void SetUp() override {
    ASSERT_EQ(server_.bind(), "");
    std::vector<drivers::Notice> refusals;
    ASSERT_TRUE(running_->begin(refusals));
    desk_.start();
    server_.start();
    ASSERT_EQ(socket_.connect(path_), "");
    ASSERT_TRUE(until([](const StatusReport& s) {
      for (const AxisReport& a : s.axes)
        if (a.axis.drive.state == image::DriveState::offline) return false;
      return !s.axes.empty();
    }));
    ASSERT_TRUE(said(ask::Power{true}).ok);
    ASSERT_TRUE(until([](const StatusReport& s) {
      for (const AxisReport& a : s.axes)
        if (!a.axis.enabled) return false;
      return true;
    }));
  }
  ~DeskOfAMill() override {
    desk_.stop();
    server_.stop();
    running_->stop();
  }

  static Reply said_by(DeskClient& client, ask::Command command) {
    const std::optional<Reply> reply = client.ask(std::move(command), 60s);
    if (!reply) throw std::runtime_error("the desk does not answer");
    return *reply;
  }
  Reply said(ask::Command command) { return said_by(pendant_, std::move(command)); }
  bool until(const std::function<bool(const StatusReport&)>& good) {
    return tests::comes([&] { return good(std::get<StatusReport>(said(ask::Status{}).content)); });
  }
  json line(const json& request) {
    std::string answer;
    if (!socket_.exchange(request.dump(), answer)) throw std::runtime_error("the socket does not answer");
    return json::parse(answer);
  }

  Shell folder_;
  std::vector<text::Finding> findings_;
  std::unique_ptr<RunningMachine> running_;
  Resident resident_;
  Desk desk_{resident_};
  const std::string path_ = (folder_.folder() / "desk.sock").string();
  SocketServer server_{desk_, path_};
  DeskClient pendant_{desk_, image::Asker::pendant, "the pendant", text::Language::english};
  SocketClient socket_;
};

TEST_F(DeskOfAMill, gives_a_client_of_this_process_and_one_of_the_socket_their_own_answers) {
  // Both count their questions from 1, and ask at the same time for what is answered in different ways.
  for (int n = 0; n < 40; ++n) {
    const std::uint64_t mine = pendant_.ask(n % 2 == 0 ? ask::Command(ask::Buses{}) : ask::Hold{});
    const std::uint64_t next = pendant_.ask(ask::Jog{"Q", 1.0, {}});
    EXPECT_EQ(line({{"cmd", n % 2 == 0 ? "hold" : "buses"}}).contains("buses"), n % 2 == 1);
    EXPECT_EQ(line({{"cmd", "jog"}, {"axis", "W"}, {"value", 1}})["text"],
              "the machine has no axis 'W'; it has X, Y, Z");
    std::optional<Reply> answer, refusal;
    ASSERT_TRUE(tests::comes([&] {
      if (!answer) answer = pendant_.take(mine);
      if (!refusal) refusal = pendant_.take(next);
      return answer && refusal;
    })) << n;
    EXPECT_EQ(std::holds_alternative<HeldBuses>(answer->content), n % 2 == 0);
    EXPECT_EQ(refusal->text, "the machine has no axis 'Q'; it has X, Y, Z");
    EXPECT_FALSE(pendant_.take(mine)) << "once";
  }
}

TEST_F(DeskOfAMill, lets_the_same_gate_judge_both_and_says_who_holds_the_hand) {
  ASSERT_TRUE(said(ask::Jog{"X", 200.0, {}}).ok);
  const json refused = line({{"cmd", "jog"}, {"axis", "Y"}, {"value", 1}});
  EXPECT_EQ(refused["code"], "gate.manual_held");
  EXPECT_EQ(refused["text"], "the pendant holds manual control");
  EXPECT_EQ(line({{"cmd", "stop"}})["ok"], true) << "anybody stops it";
  EXPECT_TRUE(until([](const StatusReport& s) { return !s.axes[0].axis.moving; }));
}

TEST_F(DeskOfAMill, ends_what_a_client_held_with_the_client_and_leaves_the_others_alone) {
  {
    DeskClient page(desk_, image::Asker::page, "the page", text::Language::english);
    ASSERT_TRUE(said_by(page, ask::PlcForce{"mist", "TRUE", false}).ok);
    ASSERT_TRUE(line({{"cmd", "plc_force"}, {"name", "door_closed"}, {"value", "TRUE"}})["ok"]);
    ASSERT_EQ(std::get<StatusReport>(said(ask::Status{}).content).forced.size(), 2u);
    const Reply jog = said_by(page, ask::JogContinuous{"X", 1.0});
    ASSERT_TRUE(jog.ok) << jog.text;
    EXPECT_GT(std::get<JogBegun>(jog.content).keep_alive_ms, 0.0);
    EXPECT_EQ(line({{"cmd", "keep_alive"}})["code"], "socket.no-jog") << "it is the page's";
  }
  EXPECT_TRUE(until([](const StatusReport& s) { return !s.axes[0].axis.moving && s.forced.size() == 1; }));
  EXPECT_EQ(line({{"cmd", "status"}})["forced"][0]["name"], "door_closed");
}

TEST_F(DeskOfAMill, gives_a_subscriber_one_whole_cycle_after_the_other_until_it_leaves) {
  std::atomic<int> seen{0}, backwards{0};
  std::atomic<bool> moved{false};
  {
    DeskClient page(desk_, image::Asker::page, "the page", text::Language::english);
    std::int64_t last = -1;
    page.subscribe(1ms, [&](const image::ProcessImage& image, const cycle::AlarmSnapshot&) {
      if (image.now.number <= last) ++backwards;
      last = image.now.number;
      if (image.axes[0].moving) moved = true;
      ++seen;
    });
    ASSERT_TRUE(said(ask::Jog{"X", 20.0, {}}).ok);
    EXPECT_TRUE(tests::comes([&] { return seen > 20 && moved; }));
    EXPECT_EQ(backwards, 0) << "never the same cycle twice";
  }
  const int then = seen;
  EXPECT_TRUE(until([](const StatusReport& s) { return !s.axes[0].axis.moving; }));
  EXPECT_EQ(seen, then) << "the client has gone";
}

TEST_F(DeskOfAMill, tells_every_client_that_the_control_ends) {
  EXPECT_TRUE(said(ask::Down{}).ok);
  EXPECT_TRUE(desk_.down_requested());
  EXPECT_EQ(line({{"cmd", "home"}})["code"], "socket.ending");
  desk_.shut_down();
  EXPECT_EQ(said(ask::Home{}).code, "socket.ending");
  EXPECT_TRUE(tests::comes([&] { return desk_.at_rest(); }));
  EXPECT_TRUE(desk_.rests());
}

}  // namespace
}  // namespace servogate::gateway::testing
