// SPDX-License-Identifier: Apache-2.0
// When process data go, by their transmission types; maps that cannot be written; values that nobody gives in
// the cycle; records of interpolated position that must not come too early.
#include <gtest/gtest.h>

#include "tests/canopen/master/pair.hpp"
#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::Pair;
using testing::SegmentRig;

/// What passes on the wire of a pair from here on.
struct Listener {
  explicit Listener(Pair& pair) : bus(pair.wire.add_endpoint("listener")) {
    pair.watch = [this] {
      image::CanFrame f;
      while (bus.receive(f)) frames.push_back(f);
    };
  }
  int count(std::uint32_t id, bool remote = false) const {
    int n = 0;
    for (const image::CanFrame& f : frames) n += f.id == id && f.remote == remote;
    return n;
  }
  image::CanBus& bus;
  std::vector<image::CanFrame> frames;
};

void drop_tpdos(Pair& pair) {
  fault::Fault fault;
  fault.kind = fault::Kind::pdo_dropped;
  pair.drive->inject(fault);
}

TEST(Transmission, a_tpdo_that_comes_when_it_is_asked_for_is_asked_for_and_watched) {
  for (const std::uint8_t type : {252, 253}) {
    Pair pair({}, [type](NodeConfig& node) {
      node.profile.tpdo[0].transmission_type = type;
      node.profile.tpdo[0].event_ms = 5;
    });
    ASSERT_TRUE(pair.enable()) << pair.story;
    EXPECT_EQ(pair.drive->object(0x1800, 1) & 0x4000'0000, 0) << "it may be asked";
    Listener listener(pair);
    pair.run(100);
    EXPECT_EQ(listener.count(0x181, true), 20);
    EXPECT_TRUE(pair.feedback().online);
    drop_tpdos(pair);
    EXPECT_TRUE(pair.until([&] { return !pair.feedback().online; }, 30)) << pair.story;
  }
}

TEST(Transmission, a_tpdo_on_event_is_lost_when_its_timer_has_passed_three_times) {
  Pair pair({}, [](NodeConfig& node) {
    node.profile.tpdo[0].transmission_type = 254;
    node.profile.tpdo[0].event_ms = 10;
  });
  ASSERT_TRUE(pair.enable()) << pair.story;
  pair.run(200);
  EXPECT_TRUE(pair.feedback().online);
  drop_tpdos(pair);
  pair.run(20);
  EXPECT_TRUE(pair.feedback().online);
  pair.run(20);
  EXPECT_FALSE(pair.feedback().online);
}

TEST(Transmission, an_rpdo_of_types_0_254_and_255_goes_when_its_content_is_another_one) {
  for (const std::uint8_t type : {0, 254, 255}) {
    Pair pair({}, [type](NodeConfig& node) { node.profile.rpdo[0].transmission_type = type; });
    ASSERT_TRUE(pair.enable()) << pair.story;
    const std::int64_t from = pair.feedback().position_counts;
    pair.control = [&] { pair.command().position_counts = from; };
    pair.run(300);
    Listener listener(pair);
    pair.run(1000);
    const int resting = listener.count(0x201);
    EXPECT_LE(resting, 11) << "now and then all the same";
    pair.control = [&, target = from]() mutable { pair.command().position_counts = target += 20; };
    pair.run(1000);
    EXPECT_GE(listener.count(0x201) - resting, 999);
    EXPECT_NEAR(static_cast<double>(pair.feedback().position_counts - from), 20'000.0, 200.0);
  }
}

TEST(Transmission, every_nth_sync_makes_every_nth_frame) {
  Pair pair({}, [](NodeConfig& node) {
    node.profile.rpdo[0].transmission_type = 4;
    node.profile.tpdo[0].transmission_type = 4;
  });
  ASSERT_TRUE(pair.enable()) << pair.story;
  Listener listener(pair);
  pair.run(400);
  EXPECT_EQ(listener.count(0x181), 100);
  EXPECT_TRUE(pair.feedback().online);
}

constexpr std::uint32_t kReadOnly = 0x0601'0002;

struct FixedMap : ::testing::Test {
  SegmentRig rig;
  /// A drive that keeps the maps it comes with.
  bool boots(bool told, std::uint32_t second_object) {
    rig.config.nodes[0].profile.pdo_map_fixed = told;
    rig.config.boot_attempts = 1;
    rig.start();
    testing::FakeDrive& drive = rig.device();
    const std::uint32_t maps[][2] = {{0x6040'0010, second_object}, {0x6041'0010, 0x6064'0020}};
    for (const int transmit : {0, 1}) {
      const auto index = static_cast<std::uint16_t>(transmit ? 0x1A00 : 0x1600);
      drive.set(index, 0, 1, 2);
      for (std::uint8_t i = 0; i < 2; ++i)
        drive.set(index, static_cast<std::uint8_t>(i + 1), 4, maps[transmit][i]);
      for (std::uint32_t sub = 0; sub <= 2; ++sub)
        drive.aborts[static_cast<std::uint32_t>(index) << 8 | sub] = kReadOnly;
    }
    return rig.boot();
  }
};

TEST_F(FixedMap, runs_a_drive_that_refuses_to_be_mapped_where_its_file_says_so) {
  ASSERT_TRUE(boots(true, 0x607A'0020)) << rig.sentence(BusEventKind::boot_failed);
  EXPECT_TRUE(rig.enable());
}

TEST_F(FixedMap, is_no_help_where_the_drive_has_another_map) {
  EXPECT_FALSE(boots(true, 0x60FF'0020));
  EXPECT_NE(rig.sentence(BusEventKind::boot_failed).find("1600h:02"), std::string::npos)
      << rig.sentence(BusEventKind::boot_failed);
  EXPECT_NE(rig.sentence(BusEventKind::boot_failed).find("expected 607A0020h, got 60FF0020h"),
            std::string::npos)
      << rig.sentence(BusEventKind::boot_failed);
}

TEST_F(FixedMap, has_to_be_told_of_a_drive_that_refuses_to_be_mapped) {
  EXPECT_FALSE(boots(false, 0x607A'0020));
  EXPECT_NE(rig.sentence(BusEventKind::boot_failed).find("1600h:00"), std::string::npos)
      << rig.sentence(BusEventKind::boot_failed);
}

TEST(MappedValue, that_nobody_gives_in_the_cycle_is_the_one_of_the_settings) {
  const auto torque_limit = [](bool told) {
    Pair pair({}, [told](NodeConfig& node) {
      node.profile.rpdo[0].mapping.add({0x6072, 0, 16});
      if (told) node.profile.settings = {{0x6072, 0, 2, 850, true}};
    });
    EXPECT_TRUE(pair.enable()) << pair.story;
    pair.run(10);
    return pair.drive->object(0x6072);
  };
  EXPECT_EQ(torque_limit(true), 850);
  EXPECT_EQ(torque_limit(false), 0) << "which is why check refuses it";
}

void use_ip(NodeConfig& node, bool own_pdo) {
  node.profile.position_mode = OperationMode::interpolated_position;
  node.profile.modes = supported_bit(OperationMode::interpolated_position);
  node.profile.rpdo[0].mapping = {};
  node.profile.rpdo[0].mapping.add({0x6040, 0, 16});
  node.profile.rpdo[own_pdo ? 1 : 0].mapping.add({0x60C1, 1, 32});
}

TEST(InterpolatedPosition, opens_the_buffer_before_it_asks_for_interpolation_and_closes_it_behind) {
  Pair pair({}, [](NodeConfig& node) {
    use_ip(node, false);
    node.profile.ip_buffer = true;
    node.profile.settings = {{0x60C4, 2, 4, 8, true}, {0x60C4, 5, 1, 4, false}};
  });
  Listener listener(pair);
  const auto order = [&] {
    std::string words;
    for (const image::CanFrame& f : listener.frames) {
      if (f.id == 0x601 && f.data[0] >> 5 == 1 && (f.data[1] | f.data[2] << 8) == 0x60C4 && f.data[3] == 6)
        words += f.data[4] ? "open " : "close ";
      if (f.id == 0x201 && (f.data[0] & 0x10) && !words.ends_with("on ")) words += "on ";
    }
    return words;
  };
  ASSERT_TRUE(pair.until([&] { return pair.feedback().online; })) << pair.story;
  pair.run(100);
  EXPECT_EQ(pair.drive->object(0x60C4, 4), 0) << "no record before the drive interpolates";
  ASSERT_TRUE(pair.enable()) << pair.story;
  const std::int64_t from = pair.feedback().position_counts;
  pair.control = [&, target = from]() mutable { pair.command().position_counts = target += 100; };
  pair.run(1000);
  EXPECT_NEAR(static_cast<double>(pair.feedback().position_counts - from), 100'000.0, 2'000.0);
  pair.command().power = false;
  pair.control = nullptr;
  pair.run(100);
  EXPECT_EQ(order(), "close open on close ");
  EXPECT_EQ(pair.drive->object(0x60C4, 4), 0);
  EXPECT_EQ(pair.story, "");
}

TEST(InterpolatedPosition, sends_no_record_in_a_pdo_of_its_own_before_the_drive_interpolates) {
  Pair pair({}, [](NodeConfig& node) { use_ip(node, true); });
  Listener listener(pair);
  ASSERT_TRUE(pair.until([&] { return pair.feedback().online; })) << pair.story;
  pair.run(100);
  ASSERT_TRUE(pair.enable()) << pair.story;
  pair.run(100);
  bool interpolates = false;
  int early = 0, records = 0;
  for (const image::CanFrame& f : listener.frames) {
    interpolates = interpolates || (f.id == 0x181 && (f.data[1] & 0x10));
    if (f.id != 0x301) continue;
    ++records;
    early += !interpolates;
  }
  EXPECT_GT(records, 90);
  EXPECT_EQ(early, 0);
}

}  // namespace
}  // namespace servogate::canopen
