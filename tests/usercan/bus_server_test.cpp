// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <regex>

#include "tests/comes.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

using image::CanFrame;

/// A participant that speaks the protocol by hand.
class Hand {
 public:
  explicit Hand(const Address& address) {
    drivers::Notice why;
    socket_ = connect_to(address, why);
  }
  ~Hand() { close(socket_); }
  void say(const std::string& text) {
    EXPECT_EQ(send(socket_, text.data(), text.size(), 0), ssize_t(text.size()));
  }
  /// Reads until the text has come, two minutes at most; all that has come.
  std::string hear(const std::string& until) {
    tests::comes([&] {
      if (heard_.find(until) != std::string::npos) return true;
      pollfd p{socket_, POLLIN, 0};
      if (poll(&p, 1, 100) <= 0) return false;
      char bytes[4096];
      const ssize_t got = recv(socket_, bytes, sizeof bytes, 0);
      if (got <= 0) return true;
      heard_.append(bytes, static_cast<std::size_t>(got));
      return heard_.find(until) != std::string::npos;
    });
    return std::exchange(heard_, {});
  }
  std::string ask(const std::string& text, const std::string& until = ">") {
    say(text);
    return hear(until);
  }

 private:
  int socket_;
  std::string heard_;
};

TEST(BusServer, greets_opens_and_goes_into_raw_mode_in_the_words_of_socketcand) {
  RunningServer server;
  Hand hand(server.address());
  EXPECT_EQ(hand.hear(">"), "< hi >");
  EXPECT_EQ(hand.ask("< open can0 >"), "< ok >");
  EXPECT_EQ(hand.ask("< rawmode >"), "< ok >");
  EXPECT_EQ(hand.ask("< echo >"), "< echo >");
}

TEST(BusServer, says_what_is_wrong_with_a_command) {
  RunningServer server;
  Hand hand(server.address());
  hand.hear(">");
  EXPECT_EQ(hand.ask("< rawmode >"), "< error open a bus first >");
  EXPECT_EQ(hand.ask("< open can7 >"), "< error could not open bus >");
  EXPECT_EQ(hand.ask("< open can0 >"), "< ok >");
  EXPECT_EQ(hand.ask("< rawmode >"), "< ok >");
  EXPECT_EQ(hand.ask("< send 123 9 1 2 3 4 5 6 7 8 9 >"), "< error syntax error in send command >");
  EXPECT_EQ(hand.ask("< isotpmode >"), "< error unknown command >");
  EXPECT_EQ(hand.ask("< lockstep me >"), "< error this bus runs in real time >");
}

TEST(BusServer, frames_have_identifier_time_and_data_as_socketcand_writes_them) {
  RunningServer server;
  Hand hand(server.address());
  hand.ask("< open can0 >", "ok");
  hand.ask("< rawmode >");
  auto bus = server.join();
  ASSERT_TRUE(bus->send(make(0x181, {0xDE, 0xAD})));
  ASSERT_TRUE(bus->send(make(0x12345, {})));
  const std::string heard = hand.hear("00012345");
  EXPECT_TRUE(std::regex_search(heard, std::regex(R"(< frame 181 \d+\.\d{6} DEAD >)"))) << heard;
  EXPECT_TRUE(std::regex_search(heard, std::regex(R"(< frame 00012345 \d+\.\d{6}  >)"))) << heard;
  hand.say("< send 2A 2 1 2 >");
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(f.id, 0x2Au);
  EXPECT_FALSE(f.extended);
  EXPECT_EQ(f.data[1], 2);
}

TEST(BusServer, thousands_of_frames_of_several_participants_arrive_all_and_in_order) {
  RunningServer server;
  constexpr std::uint32_t kSenders = 4, kFrames = 2000;
  auto listener = server.join();
  std::vector<std::thread> senders;
  for (std::uint32_t s = 0; s < kSenders; ++s)
    senders.emplace_back([&server, s] {
      auto bus = server.join();
      for (std::uint32_t i = 0; i < kFrames; ++i)
        while (!bus->send(make(0x200 + s, {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)})))
          usleep(500);
      while (!bus->flushed()) {
        CanFrame f;
        bus->receive(f);
        usleep(500);
      }
    });
  std::uint32_t next[kSenders] = {};
  CanFrame f;
  for (std::uint32_t n = 0; n < kSenders * kFrames; ++n) {
    ASSERT_TRUE(wait_for(*listener, f)) << n << " frames have come";
    const std::uint32_t number = f.data[0] | f.data[1] << 8;
    ASSERT_EQ(number, next[f.id - 0x200]++);
  }
  for (std::thread& t : senders) t.join();
}

TEST(BusServer, what_a_participant_said_before_it_left_is_carried_out) {
  RunningServer server;
  auto listener = server.join();
  {
    Hand hand(server.address());
    hand.ask("< open can0 >", "ok");
    hand.say("< rawmode >< send 101 1 1 >< send 102 1 2 >< send 103 1 3 >");
  }
  CanFrame f;
  for (const std::uint32_t id : {0x101u, 0x102u, 0x103u}) {
    ASSERT_TRUE(wait_for(*listener, f));
    EXPECT_EQ(f.id, id);
  }
}

TEST(BusServer, equal_identifiers_of_two_participants_both_arrive) {
  RunningServer server;
  auto a = server.join();
  auto b = server.join();
  auto listener = server.join();
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(a->send(make(0x601, {1})));
    ASSERT_TRUE(b->send(make(0x601, {2})));
  }
  int from_a = 0, from_b = 0;
  CanFrame f;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(wait_for(*listener, f));
    ++(f.data[0] == 1 ? from_a : from_b);
  }
  EXPECT_EQ(from_a, 50);
  EXPECT_EQ(from_b, 50);
}

TEST(BusServer, remote_frames_reach_those_who_know_them) {
  RunningServer server;
  auto a = server.join();
  auto b = server.join();
  CanFrame f = make(0x701, {});
  f.remote = true;
  f.length = 1;
  ASSERT_TRUE(a->send(f));
  ASSERT_TRUE(wait_for(*b, f));
  EXPECT_TRUE(f.remote);
  EXPECT_EQ(f.id, 0x701u);
  EXPECT_EQ(f.length, 1);
}

TEST(BusServer, buses_of_one_server_are_apart) {
  BusServerConfig config;
  config.buses = {"can0", "can1"};
  RunningServer server(config);
  auto a = server.join({}, "can0");
  auto b = server.join({}, "can1");
  auto c = server.join({}, "can0");
  ASSERT_TRUE(a->send(make(0x123, {1})));
  CanFrame f;
  ASSERT_TRUE(wait_for(*c, f));
  EXPECT_FALSE(b->receive(f));
}

TEST(BusServer, whoever_does_not_read_is_thrown_out_and_named) {
  BusServerConfig config;
  config.backlog = 1000;
  RunningServer server(config);
  Hand sleeper(server.address());
  sleeper.ask("< open can0 >", "ok");
  sleeper.ask("< rawmode >");
  auto bus = server.join();
  // Far more than the buffers of two sockets may grow to.
  for (int i = 0; i < 5'000'000 && server.notices().empty(); ++i)
    if (!bus->send(make(0x100, {1, 2, 3, 4, 5, 6, 7, 8}))) usleep(200);
  ASSERT_FALSE(server.notices().empty());
  EXPECT_EQ(server.notices()[0].find("participant #1 was thrown out: "), 0u) << server.notices()[0];
}

TEST(BusServer, serves_over_a_unix_socket_and_takes_over_what_a_killed_server_left) {
  BusServerConfig config;
  config.listen.path = scratch("bus.sock");
  {
    RunningServer first(config);
    shell("cp -a " + config.listen.path + " " + config.listen.path + ".kept");
  }
  shell("mv " + config.listen.path + ".kept " + config.listen.path);
  RunningServer server(config);
  auto a = server.join();
  auto b = server.join();
  ASSERT_TRUE(a->send(make(0x1, {1})));
  CanFrame f;
  EXPECT_TRUE(wait_for(*b, f));
}

TEST(BusServer, does_not_listen_for_other_computers) {
  BusServerConfig config;
  config.listen.host = "0.0.0.0";
  drivers::Notice why;
  EXPECT_EQ(BusServer::open(config, {}, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("0.0.0.0 is not this computer"), std::string::npos);
}

TEST(SocketcandBus, says_that_there_is_no_server_and_how_to_start_one) {
  SocketcandConfig config;
  config.address.host = "127.0.0.1";
  config.address.port = 1;
  drivers::Notice why;
  EXPECT_EQ(SocketcandBus::open(config, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("servogate can bus can0 --listen 127.0.0.1:1"),
            std::string::npos);
}

TEST(SocketcandBus, says_which_bus_the_server_does_not_have) {
  RunningServer server;
  SocketcandConfig config;
  config.address = server.address();
  config.bus = "can7";
  drivers::Notice why;
  EXPECT_EQ(SocketcandBus::open(config, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("refuses '< open can7 >'"), std::string::npos);
}

TEST(SocketcandBus, is_down_when_the_server_has_gone) {
  auto server = std::make_unique<RunningServer>();
  auto bus = server->join();
  EXPECT_EQ(bus->state(), image::CanState::error_active);
  server.reset();
  CanFrame f;
  EXPECT_TRUE(tests::comes([&] {
    bus->receive(f);
    return bus->state() == image::CanState::down;
  }));
  EXPECT_FALSE(bus->send(make(0x1, {})));
}

TEST(SocketcandBus, time_stamps_are_of_the_monotonic_clock) {
  RunningServer server;
  auto a = server.join();
  auto b = server.join();
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * image::kSecond + t.tv_nsec;
  };
  const image::Nanoseconds before = now();
  ASSERT_TRUE(a->send(make(0x1, {})));
  CanFrame f;
  ASSERT_TRUE(wait_for(*b, f));
  EXPECT_GE(f.timestamp_ns, before - image::kMillisecond);
  EXPECT_LE(f.timestamp_ns, now() + image::kMillisecond);
}

/// The connected TCP sockets of this process at that port, server and clients; what an option of each is.
std::vector<int> options_of_peers(std::uint16_t port, int option) {
  std::vector<int> found;
  for (int s = 0; s < 1024; ++s) {
    sockaddr_in own{}, peer{};
    socklen_t own_size = sizeof own, peer_size = sizeof peer;
    if (getsockname(s, reinterpret_cast<sockaddr*>(&own), &own_size) != 0 ||
        getpeername(s, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0 || own.sin_family != AF_INET ||
        (ntohs(own.sin_port) != port && ntohs(peer.sin_port) != port))
      continue;
    int set = -1;
    socklen_t size = sizeof set;
    EXPECT_EQ(getsockopt(s, IPPROTO_TCP, option, &set, &size), 0);
    found.push_back(set);
  }
  return found;
}

TEST(SocketcandBus, does_not_collect_small_writes_at_either_end) {
  RunningServer server;
  const auto a = server.join(), b = server.join();
  EXPECT_EQ(options_of_peers(server.address().port, TCP_NODELAY), (std::vector<int>{1, 1, 1, 1}));
}

// Linux turns to delayed acknowledgement once a socket has answered what it read; what is set is lost by
// that.
TEST(SocketcandBus, acknowledges_at_once_after_it_has_answered) {
  RunningServer server;
  const auto a = server.join(), b = server.join();
  CanFrame f;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(a->send(make(0x1, {})) && wait_for(*b, f));
    ASSERT_TRUE(b->send(make(0x2, {})) && wait_for(*a, f));
  }
  const auto at_once = [&] {
    const std::vector<int> set = options_of_peers(server.address().port, TCP_QUICKACK);
    return std::count(set.begin(), set.end(), 1);
  };
  // Who has read last: the client a, and the server of b. The others have sent since.
  EXPECT_GE(at_once(), 2);
}

TEST(SocketcandBus, allocates_nothing_while_frames_pass) {
  RunningServer server;
  auto a = server.join();
  auto b = server.join();
  CanFrame f = make(0x181, {1, 2, 3});
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    a->send(f);
    b->receive(f);
    usleep(100);
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::usercan
