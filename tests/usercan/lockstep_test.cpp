// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tests/places/places.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

using image::CanFrame;
using image::kMillisecond;
using image::Nanoseconds;

/// Writes down what was on the wire, to the nanosecond.
class Record final : public mock::CanMonitor {
 public:
  void on_wire(const CanFrame& f, int sender, Nanoseconds start, Nanoseconds end,
               Outcome outcome) noexcept override {
    char line[128];
    int n = std::snprintf(line, sizeof line, "%lld %lld %d %d %03X", static_cast<long long>(start),
                          static_cast<long long>(end), sender, static_cast<int>(outcome), f.id);
    for (std::size_t i = 0; i < f.length; ++i)
      n += std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), " %02X", f.data[i]);
    text += std::string(line) + "\n";
  }
  std::string text;
};

BusServerConfig participants(int count) {
  BusServerConfig config;
  config.lockstep = count;
  return config;
}

TEST(Lockstep, time_does_not_begin_before_everybody_is_there) {
  RunningServer server(participants(2));
  auto first = server.join("a");
  std::atomic<bool> granted{false};
  std::thread waiting([&] { granted = first->wait_grant().has_value(); });
  auto second = server.join("b");
  EXPECT_EQ(second->wait_grant(), std::optional<Nanoseconds>(0));
  waiting.join();
  EXPECT_TRUE(granted);
}

TEST(Lockstep, what_is_sent_at_one_instant_competes_by_identifier_whoever_was_first) {
  RunningServer server(participants(3));
  auto a = server.join("a"), b = server.join("b"), c = server.join("c");
  for (SocketcandBus* bus : {a.get(), b.get(), c.get()})
    ASSERT_EQ(bus->wait_grant(), std::optional<Nanoseconds>(0));
  ASSERT_TRUE(a->send(make(0x700, {1})));
  ASSERT_TRUE(a->done(kMillisecond));
  usleep(20'000);  // the others come later in the computer's time, and at the same instant of the bus
  ASSERT_TRUE(b->send(make(0x100, {2})));
  ASSERT_TRUE(b->done(kMillisecond));
  ASSERT_TRUE(c->done(kMillisecond));
  std::vector<std::uint32_t> heard;
  for (int end = 0; end < 2; ++end) {
    for (SocketcandBus* bus : {a.get(), b.get(), c.get()}) {
      const auto now = bus->wait_grant();
      ASSERT_TRUE(now);
      CanFrame f;
      while (bus->receive(f))
        if (bus == c.get()) {
          heard.push_back(f.id);
          EXPECT_EQ(f.timestamp_ns, *now);
        }
      ASSERT_TRUE(bus->done(kMillisecond));
    }
  }
  EXPECT_EQ(heard, (std::vector<std::uint32_t>{0x100, 0x700}));
}

TEST(Lockstep, time_goes_to_the_earliest_instant_that_anybody_wants) {
  RunningServer server(participants(2));
  auto a = server.join("a"), b = server.join("b");
  std::vector<Nanoseconds> grants;
  for (int i = 0; i < 4; ++i) {
    const auto now = a->wait_grant();
    ASSERT_TRUE(now && b->wait_grant() == now);
    grants.push_back(*now);
    a->done((*now / (3 * kMillisecond) + 1) * 3 * kMillisecond);
    b->done((*now / (2 * kMillisecond) + 1) * 2 * kMillisecond);
  }
  EXPECT_EQ(grants, (std::vector<Nanoseconds>{0, 2 * kMillisecond, 3 * kMillisecond, 4 * kMillisecond}));
}

TEST(Lockstep, whoever_asks_for_it_is_woken_by_frames_alone_or_by_nothing_before_its_time) {
  RunningServer server(participants(3));
  auto a = server.join("a"), frames = server.join("frames"), wish = server.join("wish");
  for (SocketcandBus* bus : {a.get(), frames.get(), wish.get()})
    ASSERT_EQ(bus->wait_grant(), std::optional<Nanoseconds>(0));
  ASSERT_TRUE(frames->done(10 * kMillisecond, LockstepWake::frames));
  ASSERT_TRUE(wish->done(10 * kMillisecond, LockstepWake::wish));
  ASSERT_TRUE(a->done(2 * kMillisecond));
  ASSERT_EQ(a->wait_grant(), std::optional<Nanoseconds>(2 * kMillisecond)) << "nobody else had to answer";
  ASSERT_TRUE(a->send(make(0x100, {1})));
  ASSERT_TRUE(a->done(10 * kMillisecond));
  const auto end = a->wait_grant();
  ASSERT_TRUE(end && *end > 2 * kMillisecond && *end < 3 * kMillisecond);
  EXPECT_EQ(frames->wait_grant(), end) << "its first since the beginning";
  CanFrame f;
  EXPECT_TRUE(frames->receive(f));
  EXPECT_FALSE(wish->receive(f));
  ASSERT_TRUE(frames->done(10 * kMillisecond, LockstepWake::frames));
  ASSERT_TRUE(a->done(10 * kMillisecond));
  EXPECT_EQ(wish->wait_grant(), std::optional<Nanoseconds>(10 * kMillisecond));
  ASSERT_TRUE(wish->receive(f));
  EXPECT_EQ(f.id, 0x100u);
}

TEST(Lockstep, time_ends_where_it_was_told_to) {
  BusServerConfig config = participants(1);
  config.until = 10 * kMillisecond;
  RunningServer server(config);
  auto a = server.join("a");
  Nanoseconds last = 0;
  while (const auto now = a->wait_grant()) {
    last = *now;
    a->done(*now + 3 * kMillisecond);
  }
  EXPECT_EQ(last, 9 * kMillisecond);
  EXPECT_TRUE(server.ends());
}

TEST(Lockstep, whoever_lets_time_creep_is_named) {
  RunningServer server(participants(1));
  auto a = server.join("a");
  for (int i = 0; i < 1100; ++i) {
    const auto now = a->wait_grant();
    ASSERT_TRUE(now);
    a->done(*now - 5);
  }
  a->wait_grant();
  const auto notices = server.notices();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("participant a has asked 1000 times in a row for no later time than"),
            std::string::npos)
      << notices[0];
}

TEST(Lockstep, whoever_leaves_is_named_and_the_others_go_on) {
  RunningServer server(participants(2));
  auto a = server.join("a"), b = server.join("b");
  a->wait_grant();
  b->wait_grant();
  a->done(kMillisecond);
  b.reset();
  EXPECT_EQ(a->wait_grant(), std::optional<Nanoseconds>(kMillisecond));
  ASSERT_EQ(server.notices().size(), 1u);
  EXPECT_EQ(server.notices()[0], "participant b left at 0 s; the others go on without it");
}

TEST(Lockstep, two_participants_of_one_name_are_not_let_in) {
  RunningServer server(participants(2));
  auto a = server.join("a");
  SocketcandConfig config;
  config.address = server.address();
  config.lockstep = "a";
  drivers::Notice why;
  EXPECT_EQ(SocketcandBus::open(config, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("a name of your own"), std::string::npos);
}

/// A participant in C, one in Python and a simulated drive, for so long; what the wire saw and the master
/// heard.
std::string run_of_three(int milliseconds) {
  Record record;
  const std::string heard = scratch("heard");
  {
    BusServerConfig config = participants(3);
    config.until = milliseconds * kMillisecond;
    RunningServer server(config, &record);
    const std::string port = std::to_string(server.address().port);
    std::thread master([&] {
      EXPECT_EQ(shell("/usr/bin/python3 " + counterpart("lockstep_master.py") + " " + port + " > " + heard),
                0);
    });
    std::thread firmware([&] {
      EXPECT_EQ(shell(tests::binary_dir() + "/tests/usercan/lockstep_participant" + " " + port + " 3"), 0);
    });
    std::thread device([&] {
      auto bus = server.join("drive");
      mock::SimulatedDriveConfig node;
      node.node_id = 4;
      mock::SimulatedDrive drive(node);
      mock::PolledDrive polled(drive, *bus, 0);
      while (const auto now = bus->wait_grant()) {
        polled.advance_to(*now);
        bus->done(*now + 250'000);
      }
    });
    master.join();
    device.join();
    firmware.join();
  }
  return record.text + "heard\n" + content(heard);
}

TEST(Lockstep, a_run_with_participants_in_C_Python_and_Cpp_repeats_to_the_bit) {
  const std::string first = run_of_three(50);
  const std::string second = run_of_three(50);
  EXPECT_EQ(first, second);
  // 50 SYNC, an answer of the C program to each, heartbeats of it, boot-up of the drive.
  const auto count = [&first](const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = first.find(part); at != std::string::npos; at = first.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_GE(count(" 080\n"), 49u);
  EXPECT_GE(count(" 183 "), 2u * 48u);
  EXPECT_GE(count(" 704 "), 2u);
}

}  // namespace
}  // namespace servogate::usercan
