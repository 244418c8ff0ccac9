// SPDX-License-Identifier: Apache-2.0
// The control socket as programs use it, and misuse it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <random>
#include <stdexcept>
#include <thread>

#include "gateway/control/server/socket/socket_server.hpp"
#include "tests/comes.hpp"
#include "tests/property_seed.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;
constexpr int kPatience_ms = 120'000;

class Jog : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up("mill", {"--virtual"});
    ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
  }
  Shell shell_;
};

// That the axis begins to stop a tenth of a second after the last keep-alive: tests/axis/limits_test.cpp.
TEST_F(Jog, stops_when_its_client_is_killed) {
  const pid_t client = shell_.spawn({"jog", "X", "+"}, "jog");
  const auto moved_or_over = [](const json& s) {
    return s["axes"][0]["moving"].get<bool>() || s["axes"][0]["jog_end"].is_object();
  };
  ASSERT_TRUE(shell_.until(moved_or_over));
  const json before = shell_.status();
  kill(client, SIGKILL);
  waitpid(client, nullptr, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return !s["axes"][0]["moving"].get<bool>(); }));
  const json after = shell_.status();
  EXPECT_EQ(after["axes"][0]["jog_end"]["reason"], "keep_alive") << after["axes"][0];
  std::printf("X stands %.2f mm and less than %.0f ms behind the last look before the kill\n",
              after["axes"][0]["command"].get<double>() - before["axes"][0]["command"].get<double>(),
              1e3 * (after["time_s"].get<double>() - before["time_s"].get<double>()));
}

TEST_F(Jog, goes_on_while_its_client_keeps_asking_and_nobody_else_may_do_that_for_it) {
  SocketClient client, other;
  std::string answer;
  ASSERT_TRUE(client.connect(shell_.socket()).empty());
  ASSERT_TRUE(other.connect(shell_.socket()).empty());
  ASSERT_TRUE(other.exchange(R"({"cmd":"keep_alive"})", answer));
  EXPECT_EQ(json::parse(answer)["code"], "socket.no-jog");
  // By the wall clock, for a hand lives by it: one that came within a tenth of a second keeps the axis
  // moving, and one that this computer held up takes hold again. Twenty in a row are four times what silence
  // lasts.
  using Clock = std::chrono::steady_clock;
  Clock::time_point heard;
  int in_time = 0;
  ASSERT_TRUE(tests::comes(
      [&] {
        const Clock::time_point sent = Clock::now();
        const char* request =
            in_time == 0 ? R"({"cmd":"jog_continuous","axis":"X","value":1})" : R"({"cmd":"keep_alive"})";
        if (!client.exchange(request, answer)) throw std::runtime_error("no control answers");
        const bool late = in_time > 0 && Clock::now() - heard > std::chrono::milliseconds(100);
        const json said = json::parse(answer);
        const bool moves = in_time == 0 ? said["ok"].get<bool>() : said.value("moving", false);
        EXPECT_TRUE(moves || late || in_time == 0) << in_time << ": " << answer;
        heard = sent;
        in_time = moves && !late ? in_time + 1 : 0;
        return in_time > 20;
      },
      std::chrono::milliseconds(20)));
  ASSERT_TRUE(other.exchange(R"({"cmd":"jog_stop","axis":"Y"})", answer));
  EXPECT_EQ(json::parse(answer)["text"], "this axis is not being jogged: there is nothing to stop");
  ASSERT_TRUE(client.exchange(R"({"cmd":"jog_stop","axis":"X"})", answer));
  EXPECT_EQ(json::parse(answer)["text"], "the jog of this axis stops");
  EXPECT_TRUE(shell_.until([](const json& s) { return !s["axes"][0]["moving"].get<bool>(); }));
}

TEST_F(Jog, names_who_holds_manual_control) {
  const json pendant = shell_.ask({{"cmd", "jog"}, {"asker", "pendant"}, {"axis", "X"}, {"value", 20.0}});
  ASSERT_TRUE(pendant["ok"].get<bool>()) << pendant;
  const json refused = shell_.ask({{"cmd", "jog"}, {"axis", "Y"}, {"value", 1.0}});
  EXPECT_EQ(refused["code"], "gate.manual_held");
  EXPECT_EQ(refused["text"], "the pendant holds manual control");
  const json russian = shell_.ask({{"cmd", "home"}, {"language", "ru"}});
  EXPECT_EQ(russian["text"], "ручным управлением владеет выносной пульт");
  EXPECT_EQ(shell_.ask({{"cmd", "status"}, {"asker", "plc"}})["code"], "socket.unknown-asker");
  EXPECT_EQ(shell_.ask({{"cmd", "power"}, {"asker", "modbus"}, {"value", 1}})["code"], "gate.asker_may_not");
}

std::string random_line(std::mt19937_64& random) {
  static const std::vector<std::string> seeds = {R"({"cmd":"status"})",
                                                 R"({"cmd":"jog","axis":"X","value":1e999})",
                                                 R"({"cmd":"zero","axis":["X"],"value":{}})",
                                                 R"({"cmd":"home","axes":[1,null,"X",["Y"]]})",
                                                 R"({"cmd":"mdi","block":"G1 X1 F1"})",
                                                 R"({"cmd":"load","program":"/dev/null"})",
                                                 R"({"cmd":"load","program":"/"})",
                                                 R"({"cmd":"override","value":-1})",
                                                 R"({"cmd":"input","point":"door_closed","value":[]})",
                                                 R"({"cmd":"keep_alive"})",
                                                 R"({"cmd":17,"asker":null})",
                                                 R"([[[[[[[[[[]]]]]]]]]])",
                                                 R"("cmd")",
                                                 "{}"};
  std::string line = seeds[random() % seeds.size()];
  for (std::size_t edits = random() % 6; edits-- > 0;) {
    const std::size_t at = line.empty() ? 0 : random() % line.size();
    const char byte = static_cast<char>(random() % 256);
    switch (random() % 3) {
      case 0:
        line.insert(at, 1, byte);
        break;
      case 1:
        if (!line.empty()) line[at] = byte;
        break;
      default:
        if (!line.empty()) line.erase(at, 1 + random() % 4);
        break;
    }
  }
  for (char& c : line)
    if (c == '\n') c = ' ';
  return line;
}

TEST(Socket, answers_every_line_of_garbage_with_one_object_and_stays_up) {
  Shell shell;
  shell.up();
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  SocketClient client;
  ASSERT_TRUE(client.connect(shell.socket()).empty());
  for (int n = 0; n < 3000; ++n) {
    const std::string line = random_line(random);
    std::string answer;
    ASSERT_TRUE(client.exchange(line, answer)) << n << ": " << line;
    const json reply = json::parse(answer, nullptr, false);
    ASSERT_TRUE(reply.is_object() && reply.contains("ok") && reply.contains("exit")) << line << answer;
    if (!reply["ok"].get<bool>()) {
      ASSERT_FALSE(reply.value("text", "").empty()) << line;
    }
  }
  EXPECT_EQ(shell.run({"status"}).exit, 0);
}

TEST(Socket, lets_a_client_go_whose_line_never_ends) {
  Shell shell;
  shell.up();
  SocketClient client;
  ASSERT_TRUE(client.connect(shell.socket()).empty());
  const std::string endless(200'000, '[');
  client.send(endless);
  std::string answer;
  ASSERT_TRUE(client.receive(answer, kPatience_ms));
  EXPECT_EQ(json::parse(answer)["code"], "socket.long-line");
  EXPECT_FALSE(client.receive(answer, kPatience_ms)) << "closed";
  EXPECT_EQ(shell.run({"status"}).exit, 0);
}

TEST(Socket, takes_a_line_of_64_KiB_and_refuses_one_of_a_byte_more_however_it_arrives) {
  Shell shell;
  shell.up();
  const std::string status = R"({"cmd":"status"})";
  for (const std::size_t excess : {0u, 1u, 2'000u, 30'000u}) {
    SocketClient client;
    ASSERT_TRUE(client.connect(shell.socket()).empty());
    const std::string line = status + std::string(SocketServer::kLongestLine + excess - status.size(), ' ');
    std::string answer;
    ASSERT_TRUE(client.exchange(line, answer)) << excess;
    const json reply = json::parse(answer);
    EXPECT_EQ(reply["ok"], excess == 0);
    if (excess > 0) {
      EXPECT_EQ(reply["code"], "socket.long-line") << excess;
    }
  }
}

TEST(Socket, answers_an_empty_line_too_so_that_answers_never_fall_behind_the_lines) {
  Shell shell;
  shell.up();
  SocketClient client;
  ASSERT_TRUE(client.connect(shell.socket()).empty());
  std::string answer;
  ASSERT_TRUE(client.exchange("", answer));
  EXPECT_EQ(json::parse(answer)["code"], "socket.no-object");
  ASSERT_TRUE(client.exchange(R"({"cmd":"status"})", answer));
  EXPECT_TRUE(json::parse(answer)["ok"]);
}

TEST(Socket, serves_32_clients_and_tells_the_33rd_that_only_its_stops_are_heard) {
  Shell shell;
  shell.up();
  std::vector<std::unique_ptr<SocketClient>> clients;
  std::string answer;
  for (int n = 0; n < 32; ++n) {
    clients.push_back(std::make_unique<SocketClient>());
    ASSERT_TRUE(clients.back()->connect(shell.socket()).empty());
    ASSERT_TRUE(clients.back()->exchange(R"({"cmd":"status"})", answer)) << n;
  }
  SocketClient late;
  ASSERT_TRUE(late.connect(shell.socket()).empty());
  ASSERT_TRUE(late.exchange(R"({"cmd":"hold"})", answer));
  EXPECT_EQ(json::parse(answer)["ok"], true) << answer;
  ASSERT_TRUE(late.exchange(R"({"cmd":"status"})", answer));
  EXPECT_EQ(json::parse(answer)["code"], "socket.full");
  EXPECT_FALSE(late.receive(answer, kPatience_ms)) << "closed";
  SocketClient silent;
  ASSERT_TRUE(silent.connect(shell.socket()).empty());
  ASSERT_TRUE(silent.receive(answer, kPatience_ms)) << "one that says nothing is told, too";
  EXPECT_EQ(json::parse(answer)["code"], "socket.full");
  for (auto& client : clients) ASSERT_TRUE(client->exchange(R"({"cmd":"alarms"})", answer));
  clients.pop_back();
  EXPECT_TRUE(shell.until([](const json& s) { return s.contains("axes"); }));
}

TEST(Socket, does_not_wait_for_a_client_that_does_not_read) {
  Shell shell;
  shell.up();
  SocketClient slow;
  ASSERT_TRUE(slow.connect(shell.socket()).empty());
  std::jthread flood([&](const std::stop_token& end) {
    for (int n = 0; n < 20'000 && !end.stop_requested() && slow.send("{\"cmd\":\"status\"}\n"); ++n) {
    }
  });
  for (int n = 0; n < 50; ++n) shell.status();
  // It is let go when too much is unread, which also ends its flood.
  flood.join();
  EXPECT_EQ(shell.run({"status"}).exit, 0);
}

}  // namespace
}  // namespace servogate::gateway::testing
