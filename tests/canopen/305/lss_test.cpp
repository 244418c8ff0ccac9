// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <random>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/305/lss_master.hpp"
#include "firmware_if/canopen/305/lss_slave.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::ScriptedBus;
using testing::show;
constexpr image::Nanoseconds kMs = image::kMillisecond;

/// A device that notes what is asked of it.
class Device final : public LssDevice {
 public:
  bool supports(std::uint32_t bit_s) noexcept override { return bit_s <= 500'000; }
  bool store(NodeId node, std::uint32_t bit_s) noexcept override {
    stored = node;
    stored_bit_s = bit_s;
    return memory_works;
  }
  void node_assigned() noexcept override { ++assigned; }
  void bit_rate_changed(std::uint32_t bit_s) noexcept override { rates.push_back(bit_s); }

  NodeId stored = 0;
  std::uint32_t stored_bit_s = 0;
  bool memory_works = true;
  int assigned = 0;
  std::vector<std::uint32_t> rates;
};

struct LssSlaveTest : ::testing::Test {
  /// The answer to a request, "" for none.
  std::string ask(std::initializer_list<int> bytes) {
    LssBytes answer{};
    if (!slave.on_frame(frame(0x7E5, bytes), now, answer)) return {};
    return show(make_frame(0x7E4, answer));
  }
  void configure() { ask({0x04, 1, 0, 0, 0, 0, 0, 0}); }

  Device device;
  LssSlave slave{device, {{0x11, 0x22, 0x10002, 0x1234}}, kUnconfiguredNode};
  image::Nanoseconds now = 0;
};

TEST_F(LssSlaveTest, is_selected_by_its_whole_identity_only) {
  EXPECT_EQ(ask({0x40, 0x11, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(ask({0x41, 0x22, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(ask({0x42, 0x02, 0, 0x01, 0, 0, 0, 0}), "");
  EXPECT_EQ(ask({0x43, 0x35, 0x12, 0, 0, 0, 0, 0}), "") << "another serial number";
  EXPECT_EQ(slave.mode(), LssMode::waiting);
  ask({0x40, 0x11, 0, 0, 0, 0, 0, 0});
  ask({0x41, 0x22, 0, 0, 0, 0, 0, 0});
  ask({0x42, 0x02, 0, 0x01, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x43, 0x34, 0x12, 0, 0, 0, 0, 0}), "7E4 44 00 00 00 00 00 00 00");
  EXPECT_EQ(slave.mode(), LssMode::configuration);
}

TEST_F(LssSlaveTest, tells_its_identity_and_node_in_configuration_state_only) {
  EXPECT_EQ(ask({0x5D, 0, 0, 0, 0, 0, 0, 0}), "");
  configure();
  EXPECT_EQ(ask({0x5A, 0, 0, 0, 0, 0, 0, 0}), "7E4 5A 11 00 00 00 00 00 00");
  EXPECT_EQ(ask({0x5C, 0, 0, 0, 0, 0, 0, 0}), "7E4 5C 02 00 01 00 00 00 00");
  EXPECT_EQ(ask({0x5D, 0, 0, 0, 0, 0, 0, 0}), "7E4 5D 34 12 00 00 00 00 00");
  EXPECT_EQ(ask({0x5E, 0, 0, 0, 0, 0, 0, 0}), "7E4 5E FF 00 00 00 00 00 00");
}

TEST_F(LssSlaveTest, takes_node_ids_from_1_to_127_and_255_and_begins_when_the_state_is_left) {
  configure();
  EXPECT_EQ(ask({0x11, 0, 0, 0, 0, 0, 0, 0}), "7E4 11 01 00 00 00 00 00 00");
  EXPECT_EQ(ask({0x11, 128, 0, 0, 0, 0, 0, 0}), "7E4 11 01 00 00 00 00 00 00");
  EXPECT_EQ(ask({0x11, 5, 0, 0, 0, 0, 0, 0}), "7E4 11 00 00 00 00 00 00 00");
  EXPECT_EQ(device.assigned, 0);
  ask({0x04, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(device.assigned, 1);
  EXPECT_EQ(slave.activate_node(), 5);
  configure();
  ask({0x11, 6, 0, 0, 0, 0, 0, 0});
  ask({0x04, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(device.assigned, 1) << "a device with a node-ID keeps it until a reset of communication";
  EXPECT_EQ(slave.active_node(), 5);
  EXPECT_EQ(slave.activate_node(), 6);
}

TEST_F(LssSlaveTest, refuses_bit_rates_that_it_does_not_have_and_tables_that_nobody_has) {
  configure();
  EXPECT_EQ(ask({0x13, 0, 0, 0, 0, 0, 0, 0}), "7E4 13 01 00 00 00 00 00 00") << "1 Mbit/s";
  EXPECT_EQ(ask({0x13, 0, 5, 0, 0, 0, 0, 0}), "7E4 13 01 00 00 00 00 00 00") << "reserved";
  EXPECT_EQ(ask({0x13, 1, 2, 0, 0, 0, 0, 0}), "7E4 13 01 00 00 00 00 00 00");
  EXPECT_EQ(ask({0x13, 0, 2, 0, 0, 0, 0, 0}), "7E4 13 00 00 00 00 00 00 00") << "500 kbit/s";
}

TEST_F(LssSlaveTest, changes_the_bit_rate_after_the_delay_and_speaks_after_another) {
  configure();
  ask({0x13, 0, 3, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x15, 100, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(device.rates, (std::vector<std::uint32_t>{0}));
  slave.tick(199 * kMs);
  EXPECT_EQ(device.rates.size(), 1u);
  slave.tick(200 * kMs);
  EXPECT_EQ(device.rates, (std::vector<std::uint32_t>{0, 250'000}));
}

TEST_F(LssSlaveTest, stores_what_is_pending_or_says_that_its_memory_failed) {
  configure();
  ask({0x11, 7, 0, 0, 0, 0, 0, 0});
  ask({0x13, 0, 4, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x17, 0, 0, 0, 0, 0, 0, 0}), "7E4 17 00 00 00 00 00 00 00");
  EXPECT_EQ(device.stored, 7);
  EXPECT_EQ(device.stored_bit_s, 125'000u);
  device.memory_works = false;
  EXPECT_EQ(ask({0x17, 0, 0, 0, 0, 0, 0, 0}), "7E4 17 02 00 00 00 00 00 00");
}

TEST_F(LssSlaveTest, is_identified_by_ranges_that_hold_it) {
  const auto identify = [&](int revision_low, int revision_high, int serial_high) {
    ask({0x46, 0x11, 0, 0, 0, 0, 0, 0});
    ask({0x47, 0x22, 0, 0, 0, 0, 0, 0});
    ask({0x48, revision_low, 0, 1, 0, 0, 0, 0});
    ask({0x49, revision_high, 0, 1, 0, 0, 0, 0});
    ask({0x4A, 0, 0x12, 0, 0, 0, 0, 0});
    return ask({0x4B, serial_high, 0x12, 0, 0, 0, 0, 0});
  };
  EXPECT_EQ(identify(2, 2, 0x34), "7E4 4F 00 00 00 00 00 00 00");
  EXPECT_EQ(identify(0, 9, 0xFF), "7E4 4F 00 00 00 00 00 00 00");
  EXPECT_EQ(identify(3, 9, 0xFF), "");
  EXPECT_EQ(identify(0, 9, 0x33), "");
}

TEST_F(LssSlaveTest, without_a_node_it_answers_who_has_none) {
  EXPECT_EQ(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), "7E4 50 00 00 00 00 00 00 00");
  slave.power_on(5, {{0x11, 0x22, 0x10002, 0x1234}});
  EXPECT_EQ(ask({0x4C, 0, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), "");
}

/// A master and any number of slaves that hear one another's master at once.
struct Wire {
  std::vector<std::unique_ptr<Device>> devices;
  std::vector<std::unique_ptr<LssSlave>> slaves;
  LssMaster master{20 * kMs};
  ScriptedBus bus;
  image::Nanoseconds now = 0;
  int frames = 0;
  std::mt19937* late = nullptr;  ///< answers come up to `latest` later
  image::Nanoseconds latest = 0;
  std::deque<std::pair<image::Nanoseconds, LssBytes>> answers;

  LssSlave& add(const LssIdentity& identity, NodeId node = kUnconfiguredNode) {
    devices.push_back(std::make_unique<Device>());
    slaves.push_back(std::make_unique<LssSlave>(*devices.back(), identity, node));
    return *slaves.back();
  }
  LssStatus run() {
    while (master.busy()) {
      now += kMs;
      master.poll(now, bus);
      for (const auto& f : bus.sent) {
        ++frames;
        for (auto& s : slaves) {
          LssBytes answer{};
          if (s->on_frame(f, now, answer))
            answers.emplace_back(late ? now + static_cast<image::Nanoseconds>((*late)() % (latest + 1)) : now,
                                 answer);
        }
      }
      bus.sent.clear();
      for (; !answers.empty() && answers.front().first <= now; answers.pop_front())
        master.on_frame(make_frame(cob::kLssSlave, answers.front().second));
    }
    return master.result().status;
  }
};

TEST(LssMasterOnAWire, configures_the_one_it_has_selected) {
  Wire wire;
  const LssIdentity a{{1, 2, 3, 4}}, b{{1, 2, 3, 5}};
  LssSlave& first = wire.add(a);
  LssSlave& second = wire.add(b);
  ASSERT_TRUE(wire.master.switch_selective(b));
  EXPECT_FALSE(wire.master.store()) << "one service at a time";
  EXPECT_EQ(wire.run(), LssStatus::done);
  EXPECT_EQ(first.mode(), LssMode::waiting);
  EXPECT_EQ(second.mode(), LssMode::configuration);
  wire.master.inquire(3);
  EXPECT_EQ(wire.run(), LssStatus::done);
  EXPECT_EQ(wire.master.result().value, 5u);
  wire.master.configure_node(9);
  EXPECT_EQ(wire.run(), LssStatus::done);
  wire.master.configure_bit_rate(1'000'000);
  EXPECT_EQ(wire.run(), LssStatus::refused);
  EXPECT_EQ(lss_error_text(wire.master.result().command, wire.master.result().error).id, "lss-bit-rate");
  EXPECT_FALSE(wire.master.configure_bit_rate(100'000)) << "not in the standard's table";
  wire.master.store();
  EXPECT_EQ(wire.run(), LssStatus::done);
  EXPECT_EQ(wire.devices[1]->stored, 9);
  wire.master.switch_global(LssMode::waiting);
  EXPECT_EQ(wire.run(), LssStatus::done);
  EXPECT_EQ(wire.devices[1]->assigned, 1);
  EXPECT_EQ(wire.devices[0]->assigned, 0);
}

TEST(LssMasterOnAWire, says_when_nobody_answers) {
  Wire wire;
  wire.master.switch_selective({{1, 2, 3, 4}});
  EXPECT_EQ(wire.run(), LssStatus::no_answer);
  wire.master.identify_unconfigured();
  EXPECT_EQ(wire.run(), LssStatus::no_answer);
  wire.master.fastscan();
  EXPECT_EQ(wire.run(), LssStatus::no_answer);
  EXPECT_EQ(wire.frames, 4 + 1 + 1 + 2 * 2) << "the scan with more patience, twice";
}

TEST(LssMasterOnAWire, identifies_by_ranges) {
  Wire wire;
  wire.add({{1, 2, 3, 400}}, 7);
  wire.master.identify({{1, 2, 0, 100}}, 9, 500);
  EXPECT_EQ(wire.run(), LssStatus::done);
  wire.master.identify({{1, 2, 0, 401}}, 9, 500);
  EXPECT_EQ(wire.run(), LssStatus::no_answer);
}

TEST(LssFastscan, finds_every_device_of_any_number_and_gives_each_a_node) {
  std::mt19937 random(305);
  for (int round = 0; round < 30; ++round) {
    Wire wire;
    const int count = 1 + static_cast<int>(random() % 12);
    for (int i = 0; i < count; ++i) {
      // Alike but for a bit or two, as devices of one make are.
      LssIdentity identity{{0x11, 0x22, 0x10000 + static_cast<std::uint32_t>(random() % 2), 0}};
      identity.part[3] =
          round % 2 ? 1000u + static_cast<std::uint32_t>(i) : static_cast<std::uint32_t>(random());
      wire.add(identity);
    }
    std::vector<LssIdentity> found;
    for (NodeId node = 1; wire.master.fastscan() && wire.run() == LssStatus::done; ++node) {
      found.push_back(wire.master.result().identity);
      int selected = 0;
      for (const auto& s : wire.slaves) selected += s->mode() == LssMode::configuration;
      ASSERT_EQ(selected, 1);
      wire.master.configure_node(node);
      ASSERT_EQ(wire.run(), LssStatus::done);
      wire.master.switch_global(LssMode::waiting);
      wire.run();
      for (auto& s : wire.slaves)
        if (s->mode() == LssMode::waiting) s->activate_node();
    }
    ASSERT_EQ(found.size(), wire.slaves.size());
  }
}

TEST(LssFastscan, scans_again_with_more_patience_where_answers_come_later_than_the_timeout) {
  std::mt19937 random(3051);
  int more_than_one_scan = 0;
  for (int round = 0; round < 300; ++round) {
    Wire wire;  // of a master that waits 20 ms, then 80 ms, then 320 ms
    LssIdentity identity;
    for (auto& part : identity.part) part = static_cast<std::uint32_t>(random());
    wire.add(identity);
    wire.late = &random;
    wire.latest = (1 + round) * kMs;
    wire.master.fastscan();
    ASSERT_EQ(wire.run(), LssStatus::done) << round;
    ASSERT_EQ(wire.master.result().identity, identity) << round;
    ASSERT_EQ(wire.slaves[0]->mode(), LssMode::configuration) << round;
    more_than_one_scan += wire.frames > 133;
  }
  EXPECT_GT(more_than_one_scan, 250);
}

TEST(LssFastscan, takes_133_requests) {
  Wire wire;
  wire.add({{0xFFFFFFFF, 0, 0x12345678, 1}});
  wire.master.fastscan();
  EXPECT_EQ(wire.run(), LssStatus::done);
  EXPECT_EQ(wire.master.result().identity, (LssIdentity{{0xFFFFFFFF, 0, 0x12345678, 1}}));
  EXPECT_EQ(wire.frames, 1 + 4 * 33);
}

TEST(LssOnSimulatedDrives, two_without_node_are_found_named_and_boot) {
  mock::CanSegment segment;
  image::CanBus& bus = segment.add_endpoint("master");
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives;
  for (std::uint32_t serial : {70u, 71u}) {
    mock::SimulatedDriveConfig config;
    config.node_id = kUnconfiguredNode;
    config.serial_number = serial;
    drives.push_back(std::make_unique<mock::SimulatedDrive>(config));
    segment.attach(*drives.back());
  }
  LssMaster master(10 * kMs);
  image::Nanoseconds now = 0;
  std::vector<std::string> others;
  const auto run = [&](int ms) {
    for (int i = 0; i < ms; ++i) {
      segment.advance_to(now += kMs);
      image::CanFrame f;
      while (bus.receive(f))
        if (!master.on_frame(f) && f.id != cob::kLssSlave) others.push_back(show(f));
      master.poll(now, bus);
    }
  };
  const auto finish = [&] {
    while (master.busy()) run(1);
    return master.result().status;
  };
  run(100);
  EXPECT_TRUE(others.empty()) << "a drive without node-ID says nothing by itself";
  for (const NodeId node : {NodeId{5}, NodeId{6}}) {
    master.fastscan();
    ASSERT_EQ(finish(), LssStatus::done);
    EXPECT_EQ(master.result().identity.part[3], node == 5 ? 70u : 71u) << "the lowest number first";
    master.configure_node(node);
    ASSERT_EQ(finish(), LssStatus::done);
    master.store();
    ASSERT_EQ(finish(), LssStatus::done);
    master.switch_global(LssMode::waiting);
    ASSERT_EQ(finish(), LssStatus::done);
    run(20);
  }
  EXPECT_EQ(others, (std::vector<std::string>{"705 00", "706 00"}));
  EXPECT_EQ(drives[0]->object(0x1400, 1), 0x205);
  EXPECT_EQ(drives[1]->object(0x1200, 2), 0x586);
  drives[0]->inject({.kind = fault::Kind::reset});
  others.clear();
  run(50);
  EXPECT_EQ(others, (std::vector<std::string>{"705 00"})) << "stored over power-off";
}

}  // namespace
}  // namespace servogate::canopen
