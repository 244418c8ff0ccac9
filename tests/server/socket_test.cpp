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

#include "gateway/server/socket_server.hpp"
#include "tests/property_seed.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

struct Point {
  double t_s, x;
};

/// Machine time and set-point of X for `wall_s`, as fast as the socket answers.
std::vector<Point> follow_x(SocketClient& client, double wall_s) {
  using Clock = std::chrono::steady_clock;
  std::vector<Point> points;
  std::string answer;
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wall_s));
  do {  // twice at least: whoever measures needs two
    if (!client.exchange(R"({"cmd":"status"})", answer)) throw std::runtime_error("no control answers");
    const json s = json::parse(answer);
    points.push_back({s.at("time_s"), s.at("axes").at(0).at("command")});
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  } while (Clock::now() < end || points.size() < 2);
  return points;
}

double speed(const Point& from, const Point& to) {
  return to.t_s > from.t_s ? (to.x - from.x) / (to.t_s - from.t_s) : 0.0;
}

/// Machine time at which the axis is first seen slower than it jogged; and where it stands in the end.
double slower_from(const std::vector<Point>& points, double jog_speed) {
  for (std::size_t i = 8; i < points.size(); ++i)
    if (std::abs(speed(points[i - 8], points[i])) < 0.95 * jog_speed) return points[i - 8].t_s;
  return 1e9;
}

class Jog : public ::testing::Test {
 protected:
  void SetUp() override {
    shell_.up("mill", {"--virtual"});
    ASSERT_EQ(shell_.run({"power", "on", "--wait"}).exit, 0);
    ASSERT_TRUE(watcher_.connect(shell_.socket()).empty());
  }
  /// Steady speed of a jog that is under way.
  double steady() {
    follow_x(watcher_, 0.25);
    const std::vector<Point> points = follow_x(watcher_, 0.1);
    return speed(points.front(), points.back());
  }
  Shell shell_;
  SocketClient watcher_;
};

/// Jogs, kills the client and gives the time until the axis is seen slower, in seconds of the machine. Less
/// than zero: on a busy computer the client itself was late and the jog had ended before.
double delay_after_kill(Shell& shell, SocketClient& watcher, double v, pid_t client) {
  const double killed_s = follow_x(watcher, 0.01).back().t_s;
  kill(client, SIGKILL);
  waitpid(client, nullptr, 0);
  const std::vector<Point> points = follow_x(watcher, 1.0);
  EXPECT_DOUBLE_EQ(points.back().x, points[points.size() - 2].x);
  EXPECT_TRUE(shell.until([](const json& s) { return !s["axes"][0]["moving"].get<bool>(); }, 5.0));
  const double delay_s = slower_from(points, v) - killed_s;
  std::printf("jogged at %.1f mm/s, slower %.1f ms after the last look before the kill\n", v, delay_s * 1e3);
  return delay_s;
}

TEST_F(Jog, stops_within_100_ms_when_its_client_is_killed) {
  // Clocks of three processes: only the best of several looks says what the control does, not what the
  // computer does.
  double best_s = 1e9;
  for (int attempt = 0; attempt < 8 && best_s > 0.1; ++attempt) {
    const pid_t client = shell_.spawn({"jog", "X", attempt % 2 == 0 ? "+" : "-"}, "jog");
    EXPECT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["moving"].get<bool>(); }, 5.0));
    const double v = std::abs(steady());
    const double delay_s = delay_after_kill(shell_, watcher_, v, client);
    if (v > 1.0 && delay_s > -0.02) best_s = std::min(best_s, delay_s);
  }
  EXPECT_LE(best_s, 0.1);
}

TEST_F(Jog, stops_within_100_ms_when_its_client_falls_silent) {
  SocketClient client;
  std::string answer;
  ASSERT_TRUE(client.connect(shell_.socket()).empty());
  ASSERT_TRUE(client.exchange(R"({"cmd":"jog_continuous","axis":"X","value":-1})", answer));
  EXPECT_TRUE(json::parse(answer)["ok"].get<bool>()) << answer;
  EXPECT_NEAR(json::parse(answer)["keep_alive_ms"].get<double>(), 30.0, 1e-9);
  const std::vector<Point> points = follow_x(watcher_, 1.5);
  EXPECT_DOUBLE_EQ(points.back().x, points[points.size() - 2].x);
  double last_motion_s = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].x != points[i - 1].x) last_motion_s = points[i].t_s;
  // 100 ms of silence and the time to speed up and down again at the slow jog of an axis without reference.
  EXPECT_LE(last_motion_s - points.front().t_s, 0.1 + 0.35);
  ASSERT_TRUE(client.exchange(R"({"cmd":"keep_alive"})", answer));
  EXPECT_FALSE(json::parse(answer).value("moving", true)) << "its end is said";
}

TEST_F(Jog, goes_on_while_its_client_keeps_asking_and_nobody_else_may_do_that_for_it) {
  SocketClient client;
  std::string answer;
  ASSERT_TRUE(client.connect(shell_.socket()).empty());
  ASSERT_TRUE(watcher_.exchange(R"({"cmd":"keep_alive"})", answer));
  EXPECT_EQ(json::parse(answer)["code"], "socket.no-jog");
  ASSERT_TRUE(client.exchange(R"({"cmd":"jog_continuous","axis":"X","value":1})", answer));
  for (int n = 0; n < 40; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_TRUE(client.exchange(R"({"cmd":"keep_alive"})", answer));
    ASSERT_TRUE(json::parse(answer)["moving"].get<bool>()) << n;
  }
  ASSERT_TRUE(client.exchange(R"({"cmd":"jog_stop","axis":"X"})", answer));
  EXPECT_TRUE(shell_.until([](const json& s) { return !s["axes"][0]["moving"].get<bool>(); }, 2.0));
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
  ASSERT_TRUE(client.receive(answer, 5000));
  EXPECT_EQ(json::parse(answer)["code"], "socket.long-line");
  EXPECT_FALSE(client.receive(answer, 5000)) << "closed";
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
  EXPECT_FALSE(late.receive(answer, 5000)) << "closed";
  SocketClient silent;
  ASSERT_TRUE(silent.connect(shell.socket()).empty());
  ASSERT_TRUE(silent.receive(answer, 20'000)) << "one that says nothing is told, too";
  EXPECT_EQ(json::parse(answer)["code"], "socket.full");
  for (auto& client : clients) ASSERT_TRUE(client->exchange(R"({"cmd":"alarms"})", answer));
  clients.pop_back();
  EXPECT_TRUE(shell.until([](const json& s) { return s.contains("axes"); }, 5.0));
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
