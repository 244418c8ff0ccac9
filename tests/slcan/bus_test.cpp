// SPDX-License-Identifier: Apache-2.0
// A bus behind an adapter on a serial port.
#include <gtest/gtest.h>

#include <chrono>

#include "drivers/slcan/slcan_bus.hpp"
#include "tests/comes.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/slcan/simulated_adapter.hpp"

namespace servogate::slcan {
namespace {

using image::CanFrame;
using image::CanState;
using Strings = std::vector<std::string>;

CanFrame frame(std::uint32_t id, std::uint8_t value = 0) {
  CanFrame f;
  f.id = id;
  f.length = 1;
  f.data[0] = value;
  return f;
}

template <typename Condition>
bool comes(Condition condition) {
  return tests::comes(condition, std::chrono::milliseconds(1));
}

std::unique_ptr<SlcanBus> open(const SimulatedAdapter& adapter, drivers::Notice& why,
                               std::uint32_t bit_rate = 500'000, bool listen_only = false) {
  return SlcanBus::open({{adapter.path()}, bit_rate, listen_only, 60 * image::kSecond}, why);
}

TEST(Slcan, is_opened_with_its_bit_rate_and_closed_behind_its_last_frame) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  ASSERT_TRUE(bus->send(frame(0x601, 0x40)));
  ASSERT_TRUE(comes([&] { return adapter.frames() == Strings{"t601140"}; }));
  bus.reset();
  ASSERT_TRUE(comes([&] { return adapter.commands().back() == "C"; }));
  Strings all = adapter.commands();
  std::erase(all, "");
  EXPECT_EQ(all, (Strings{"C", "V", "S6", "O", "t601140", "C"}));
}

TEST(Slcan, frames_are_received_with_the_time_of_their_arrival) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  adapter.say("t18141122334");
  adapter.say("4\rT1ABCDEF00\r");
  CanFrame f;
  ASSERT_TRUE(comes([&] { return bus->receive(f); }));
  EXPECT_EQ(f.id, 0x181u);
  EXPECT_EQ(f.length, 4);
  EXPECT_EQ(f.data[3], 0x44);
  EXPECT_GT(f.timestamp_ns, 0);
  ASSERT_TRUE(comes([&] { return bus->receive(f); }));
  EXPECT_TRUE(f.extended);
  EXPECT_EQ(f.id, 0x1ABCDEF0u);
  EXPECT_FALSE(bus->receive(f));
}

TEST(Slcan, what_waits_leaves_by_priority_where_the_adapter_acknowledges) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  // A computer that stalls may take a missing acknowledgement for a lost one: then once more.
  std::size_t before = 0;
  const auto overtakes = [&] {
    adapter.hold(true);
    for (std::uint8_t n = 0; n < 40; ++n) EXPECT_TRUE(bus->send(frame(0x700, n)));
    EXPECT_TRUE(bus->send(frame(0x080)));
    adapter.hold(false);
    EXPECT_TRUE(comes([&] { return adapter.frames().size() == before + 41; }));
    before = adapter.frames().size();
    return adapter.frames().back() != "t080100";
  };
  EXPECT_TRUE(comes(overtakes));
}

TEST(Slcan, an_adapter_that_acknowledges_nothing_gets_all_frames_in_their_order) {
  SimulatedAdapter adapter({.acknowledges = false, .has_flags = false});
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  for (std::uint8_t n = 0; n < 100; ++n) ASSERT_TRUE(bus->send(frame(0x181, n)));
  ASSERT_TRUE(comes([&] { return adapter.frames().size() == 100; }));
  EXPECT_EQ(adapter.frames().front(), "t181100");
  EXPECT_EQ(adapter.frames().back(), "t181163");
  EXPECT_EQ(bus->lost(), 0u);
}

TEST(Slcan, frames_that_the_adapter_refuses_are_counted_as_lost) {
  SimulatedAdapter adapter({.frames_until_full = 3});
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  for (std::uint8_t n = 0; n < 10; ++n) ASSERT_TRUE(bus->send(frame(0x181, n)));
  EXPECT_TRUE(comes([&] { return bus->lost() == 7; })) << bus->lost();
}

TEST(Slcan, its_flags_are_the_state_of_the_bus) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  EXPECT_EQ(bus->state(), CanState::error_active);
  adapter.set_flags("04");
  EXPECT_TRUE(comes([&] { return bus->state() == CanState::error_warning; }));
  adapter.set_flags("24");
  EXPECT_TRUE(comes([&] { return bus->state() == CanState::error_passive; }));
  adapter.set_flags("00");
  EXPECT_TRUE(comes([&] { return bus->state() == CanState::error_active; }));
}

TEST(Slcan, that_is_unplugged_is_a_bus_that_is_down) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  adapter.unplug();
  EXPECT_TRUE(comes([&] { return bus->state() == CanState::down; }));
  EXPECT_FALSE(bus->send(frame(1)));
}

TEST(Slcan, that_only_listens_sends_nothing) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why, 125'000, true);
  ASSERT_NE(bus, nullptr) << why.str();
  EXPECT_FALSE(bus->send(frame(1)));
  const Strings all = adapter.commands();
  EXPECT_NE(std::find(all.begin(), all.end(), "L"), all.end());
  EXPECT_NE(std::find(all.begin(), all.end(), "S4"), all.end());
}

TEST(Slcan, a_port_where_no_adapter_answers_is_refused_by_its_name) {
  SimulatedAdapter adapter({.answers = false});
  drivers::Notice why;
  EXPECT_EQ(SlcanBus::open({{adapter.path()}, 500'000, false}, why), nullptr);
  EXPECT_NE(
      why.str(text::Language::english).find("no CAN adapter answers on the serial port " + adapter.path()),
      std::string::npos)
      << why.str();
}

TEST(Slcan, an_adapter_that_refuses_its_bit_rate_or_to_listen_is_not_used) {
  SimulatedAdapter without_rate({.refuses = 'S'}), deaf({.refuses = 'L'});
  drivers::Notice why;
  EXPECT_EQ(open(without_rate, why), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("refuses 500000 bit/s"), std::string::npos) << why.str();
  EXPECT_EQ(open(deaf, why, 500'000, true), nullptr);
  EXPECT_NE(why.str(text::Language::english).find("refuses listen-only"), std::string::npos) << why.str();
}

TEST(Slcan, is_not_opened_without_a_bit_rate_at_one_that_it_has_not_or_where_there_is_no_port) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  EXPECT_EQ(open(adapter, why, 0), nullptr);
  EXPECT_EQ(std::string_view(why.entry->id), "slcan.no-bit-rate");
  EXPECT_EQ(open(adapter, why, 333'000), nullptr);
  EXPECT_EQ(std::string_view(why.entry->id), "slcan.no-rate");
  EXPECT_EQ(SlcanBus::open({{"/dev/no-such-port"}, 500'000, false}, why), nullptr);
  EXPECT_EQ(std::string_view(why.entry->id), "slcan.no-port");
  EXPECT_EQ(SlcanBus::open({{"/dev/null"}, 500'000, false}, why), nullptr);
  EXPECT_EQ(std::string_view(why.entry->id), "slcan.not-serial");
}

TEST(Slcan, has_its_port_for_itself) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  EXPECT_EQ(open(adapter, why), nullptr);
  EXPECT_EQ(std::string_view(why.entry->id), "slcan.in-use") << why.str();
}

TEST(Slcan, sending_and_receiving_take_no_memory) {
  SimulatedAdapter adapter;
  drivers::Notice why;
  const auto bus = open(adapter, why);
  ASSERT_NE(bus, nullptr) << why.str();
  adapter.say("t1811AA\r");
  CanFrame f;
  ASSERT_TRUE(comes([&] { return bus->receive(f); }));
  const std::uint64_t before = counting::allocations();
  for (int n = 0; n < 20; ++n) {
    bus->send(frame(0x201));
    bus->receive(f);
  }
  EXPECT_EQ(counting::allocations(), before);
}

TEST(SlcanPlace, is_a_path_with_or_without_a_speed_of_the_port) {
  EXPECT_EQ(parse_place("/dev/ttyACM0")->path, "/dev/ttyACM0");
  EXPECT_EQ(parse_place("/dev/ttyACM0")->baud, 115'200u);
  EXPECT_EQ(parse_place("/dev/ttyUSB0@921600")->baud, 921'600u);
  EXPECT_FALSE(parse_place(""));
  EXPECT_FALSE(parse_place("/dev/ttyUSB0@12345"));
  EXPECT_FALSE(parse_place("/dev/ttyUSB0@fast"));
}

}  // namespace
}  // namespace servogate::slcan
