// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <thread>

#include "drivers/clock.hpp"
#include "drivers/gsusb/gsusb_bus.hpp"
#include "tests/comes.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/gsusb/plugged_adapter.hpp"

namespace servogate::gsusb {
namespace {

using image::CanFrame;
using image::CanState;

CanFrame frame(std::uint32_t id, std::uint8_t value = 0) {
  CanFrame f;
  f.id = id;
  f.length = 1;
  f.data[0] = value;
  return f;
}

class GsUsb : public ::testing::Test {
 protected:
  std::unique_ptr<GsUsbBus> open(SimulatedAdapter::Config adapter = {},
                                 GsUsbConfig config = {"A1", 500'000}) {
    plugged_ = std::make_shared<Plugged>(adapter);
    return GsUsbBus::open(std::make_unique<PluggedPort>(plugged_), config, why_);
  }
  template <typename Condition>
  static bool comes(Condition condition) {
    return tests::comes(condition, std::chrono::milliseconds(1));
  }
  /// The adapter has taken all that it gets before it has sent something.
  bool adapter_is_full() {
    return comes([&] { return plugged_->with([](const SimulatedAdapter& a) { return a.waiting() == 10; }); });
  }
  static bool wait_for(image::CanBus& bus, CanFrame& f) {
    return comes([&] { return bus.receive(f); });
  }
  image::CanBus& other() { return plugged_->wire.end(1); }

  std::shared_ptr<Plugged> plugged_;
  drivers::Notice why_;
};

TEST_F(GsUsb, frames_go_through_the_adapter_in_both_directions) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr) << why_.str();
  EXPECT_EQ(plugged_->with([](const SimulatedAdapter& a) { return a.bit_rate(); }), 500'000.0);
  EXPECT_EQ(plugged_->with([](const SimulatedAdapter& a) { return a.sample_point(); }), 0.875);
  CanFrame f = frame(0x601, 0x40);
  ASSERT_TRUE(bus->send(f));
  CanFrame seen;
  ASSERT_TRUE(wait_for(other(), seen));
  EXPECT_EQ(seen.id, 0x601u);
  EXPECT_EQ(seen.data[0], 0x40);
  f = frame(0x18FF1234, 7);
  f.extended = true;
  const image::Nanoseconds before = drivers::clock_ns(CLOCK_MONOTONIC);
  ASSERT_TRUE(other().send(f));
  ASSERT_TRUE(wait_for(*bus, seen));
  EXPECT_TRUE(seen.extended);
  EXPECT_EQ(seen.id, 0x18FF1234u);
  EXPECT_GE(seen.timestamp_ns, before - image::kMillisecond);
  EXPECT_LE(seen.timestamp_ns, drivers::clock_ns(CLOCK_MONOTONIC));
  EXPECT_FALSE(bus->receive(seen)) << "own frames are not received";
}

TEST_F(GsUsb, a_thousand_frames_arrive_in_their_order) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  CanFrame f;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(comes([&] { return bus->send(frame(0x200, static_cast<std::uint8_t>(i))); }));
    if (i % 50 == 49)
      for (int n = i - 49; n <= i; ++n) {
        ASSERT_TRUE(wait_for(other(), f));
        ASSERT_EQ(f.data[0], n & 0xFF);
      }
  }
  EXPECT_EQ(bus->lost(), 0u);
}

TEST_F(GsUsb, the_descriptor_is_readable_when_a_frame_has_come_and_not_before) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  pollfd p{bus->descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&p, 1, 0), 0);
  other().send(frame(0x705));
  EXPECT_EQ(poll(&p, 1, 120'000), 1);
  CanFrame f;
  while (bus->receive(f)) {
  }
  EXPECT_EQ(poll(&p, 1, 0), 0);
}

TEST_F(GsUsb, what_waits_leaves_by_priority_and_a_full_queue_refuses) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  plugged_->wire.acknowledge(false);
  // Ten are in the adapter, the rest waits here.
  int taken = 0;
  ASSERT_TRUE(comes([&] {
    const bool more = bus->send(frame(0x300, static_cast<std::uint8_t>(taken)));
    taken += more ? 1 : 0;
    return taken == 20;
  }));
  ASSERT_TRUE(adapter_is_full());
  ASSERT_TRUE(bus->send(frame(0x080, 0xFF)));
  plugged_->wire.acknowledge(true);
  CanFrame f;
  int at = 0;
  for (int i = 0; i < 21; ++i) {
    ASSERT_TRUE(wait_for(other(), f));
    if (f.id == 0x080) at = i;
  }
  EXPECT_EQ(at, 10) << "behind those that the adapter had taken, before those that waited";
  plugged_->wire.acknowledge(false);
  for (taken = 0; bus->send(frame(0x300)); ++taken) ASSERT_LT(taken, 2000);
  EXPECT_GE(taken, 128);
  EXPECT_EQ(bus->lost(), 0u) << "a refused frame is not lost";
}

TEST_F(GsUsb, an_adapter_that_is_unplugged_is_down_and_what_waited_is_counted) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  plugged_->wire.acknowledge(false);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(bus->send(frame(0x181)));
  plugged_->unplug();
  ASSERT_TRUE(comes([&] { return bus->state() == CanState::down; }));
  EXPECT_EQ(bus->lost(), 5u);
  EXPECT_FALSE(bus->send(frame(0x181)));
  pollfd p{bus->descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&p, 1, 120'000), 1) << "whoever waits for frames hears of it";
  EXPECT_FALSE(bus->ask_state());
}

TEST_F(GsUsb, after_bus_off_nothing_stale_is_sent_and_the_controller_comes_back) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  plugged_->wire.acknowledge(false);
  for (std::uint8_t i = 0; i < 30; ++i) ASSERT_TRUE(bus->send(frame(0x181, i)));
  ASSERT_TRUE(adapter_is_full());
  plugged_->with([](SimulatedAdapter& a) { a.go_bus_off(1); });
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_TRUE(f.error);
  EXPECT_EQ(bus->lost(), 30u);
  plugged_->wire.acknowledge(true);
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_TRUE(f.error);
  EXPECT_EQ(f.id, 0x100u) << "it says that it takes part again";
  ASSERT_TRUE(comes([&] { return bus->state() == CanState::error_active; }));
  ASSERT_TRUE(bus->send(frame(0x182, 99)));
  ASSERT_TRUE(wait_for(other(), f));
  EXPECT_EQ(f.id, 0x182u);
}

TEST_F(GsUsb, a_wrong_bit_rate_is_seen_in_error_frames_and_in_the_state) {
  const auto bus = open({.bus_rate = 250'000});
  ASSERT_NE(bus, nullptr);
  int errors = 0;
  CanFrame f;
  ASSERT_TRUE(comes([&] {
    other().send(frame(0x181));
    while (bus->receive(f)) {
      EXPECT_TRUE(f.error) << "no frame can be read at a wrong rate";
      ++errors;
    }
    return bus->state() == CanState::error_passive;
  }));
  EXPECT_GT(errors, 0);
  const auto state = bus->ask_state();
  ASSERT_TRUE(state);
  EXPECT_GE(state->receive_errors, 128u);
  EXPECT_EQ(state->state, CanState::error_passive);
}

TEST_F(GsUsb, in_listen_only_mode_nothing_is_sent_and_the_error_counters_stand_still) {
  const auto bus = open({.bus_rate = 250'000}, {"A1", 500'000, 0, true});
  ASSERT_NE(bus, nullptr);
  EXPECT_TRUE(plugged_->with([](const SimulatedAdapter& a) { return a.listens_only(); }));
  EXPECT_FALSE(bus->send(frame(0x181)));
  other().send(frame(0x181));
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_TRUE(f.error);
  EXPECT_EQ(bus->ask_state()->receive_errors, 0u);
}

TEST_F(GsUsb, frames_that_the_adapter_had_no_room_for_are_known_to_be_lost) {
  const auto bus = open({.frames_to_host = 2});
  ASSERT_NE(bus, nullptr);
  plugged_->with([&](SimulatedAdapter& a) {
    for (int i = 0; i < 5; ++i) other().send(frame(0x181));
    a.step(1);
    return 0;
  });
  ASSERT_TRUE(comes([&] {
    other().send(frame(0x182));
    return bus->lost() > 0;
  }));
}

TEST_F(GsUsb, without_a_clock_of_the_adapter_frames_have_the_time_of_their_arrival) {
  const auto bus = open({.timestamps = false, .tells_state = false});
  ASSERT_NE(bus, nullptr);
  const image::Nanoseconds before = drivers::clock_ns(CLOCK_MONOTONIC);
  other().send(frame(0x181));
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_GE(f.timestamp_ns, before);
  EXPECT_FALSE(bus->ask_state()) << "this firmware cannot tell";
}

TEST_F(GsUsb, what_cannot_be_started_is_refused_with_the_reason) {
  EXPECT_EQ(open({}, {"A1", 0}), nullptr);
  EXPECT_EQ(why_.entry->id, "gsusb.no-bit-rate");
  EXPECT_EQ(open({}, {"A1", 500'000, 1}), nullptr);
  EXPECT_EQ(why_.str(text::Language::english), "the adapter A1 has no channel 1; it has 1, from 0");
  EXPECT_EQ(open({.clock_hz = 7'372'800}, {"A1", 1'000'000}), nullptr);
  EXPECT_EQ(why_.entry->id, "gsusb.no-timing");
  plugged_ = std::make_shared<Plugged>();
  plugged_->unplug();
  EXPECT_EQ(GsUsbBus::open(std::make_unique<PluggedPort>(plugged_), {"A1", 500'000}, why_), nullptr);
  EXPECT_EQ(why_.str(text::Language::english),
            "the adapter A1 does not answer as one of the gs_usb class (unplugged)");
}

TEST_F(GsUsb, the_channel_is_reset_when_the_bus_is_closed) {
  auto bus = open();
  ASSERT_NE(bus, nullptr);
  EXPECT_TRUE(plugged_->with([](const SimulatedAdapter& a) { return a.started(); }));
  bus.reset();
  EXPECT_FALSE(plugged_->with([](const SimulatedAdapter& a) { return a.started(); }));
}

TEST_F(GsUsb, nothing_is_allocated_by_who_sends_and_receives) {
  const auto bus = open();
  ASSERT_NE(bus, nullptr);
  CanFrame f = frame(0x181);
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    bus->send(f);
    bus->receive(f);
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::gsusb
