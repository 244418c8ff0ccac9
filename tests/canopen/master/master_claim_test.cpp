// SPDX-License-Identifier: Apache-2.0
// Of controls that start together one leads the bus. On a simulated wire in virtual time.
#include "firmware_if/canopen/master/master_claim.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/canopen/301/nmt.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using image::kMillisecond;
using image::Nanoseconds;
using State = MasterClaim::State;

constexpr NodeId kOwn = 127;
constexpr Nanoseconds kListening = 1200 * kMillisecond;

/// A bus that hands frames over `latency` later, as a process between the controls would.
class LateBus final : public image::CanBus {
 public:
  LateBus(image::CanBus& wire, Nanoseconds latency) : wire_(wire), latency_(latency) {}
  void advance_to(Nanoseconds now) {
    now_ = now;
    for (image::CanFrame f; wire_.receive(f);) waiting_.push_back({now + latency_, f});
  }
  bool send(const image::CanFrame& f) noexcept override { return wire_.send(f); }
  bool receive(image::CanFrame& f) noexcept override {
    if (waiting_.empty() || waiting_.front().first > now_) return false;
    f = waiting_.front().second;
    waiting_.pop_front();
    return true;
  }
  image::CanState state() const noexcept override { return wire_.state(); }
  std::uint32_t bit_rate() const noexcept override { return wire_.bit_rate(); }

 private:
  image::CanBus& wire_;
  Nanoseconds latency_, now_ = 0;
  std::deque<std::pair<Nanoseconds, image::CanFrame>> waiting_;
};

/// A control that starts: from `begin` on it looks every `every`, and sends SYNC once it leads.
struct Starter {
  Starter(image::CanBus& wire, Nanoseconds latency, std::uint64_t chance, Nanoseconds begins,
          Nanoseconds looks = kMillisecond)
      : bus(wire, latency), claim(kOwn, kListening, chance), begin(begins), every(looks) {}
  void at(Nanoseconds now) {
    bus.advance_to(now);
    if (now < begin || (now - begin) % every != 0) return;
    if (now == begin) claim.begin(now);
    for (image::CanFrame f; bus.receive(f);) claim.on_frame(f);
    if (claim.poll(now, bus) == State::leads) bus.send(make_frame(cob::kSync, {}));
  }
  LateBus bus;
  MasterClaim claim;
  Nanoseconds begin, every;
};

struct Wire {
  Wire() { segment.add_endpoint("drive"); }
  Starter& add(std::uint64_t chance, Nanoseconds begin, Nanoseconds latency = 0,
               Nanoseconds every = kMillisecond) {
    starters.push_back(
        std::make_unique<Starter>(segment.add_endpoint("control"), latency, chance, begin, every));
    return *starters.back();
  }
  void run(Nanoseconds until) {
    for (; now <= until; now += kMillisecond) {
      segment.advance_to(now);
      for (const auto& s : starters) s->at(now);
    }
  }
  int count(State state) const {
    int n = 0;
    for (const auto& s : starters) n += s->claim.state() == state ? 1 : 0;
    return n;
  }
  mock::CanSegment segment;
  std::vector<std::unique_ptr<Starter>> starters;
  Nanoseconds now = 0;
};

TEST(MasterClaim, alone_leads_after_listening_and_announcing_itself) {
  Wire wire;
  const Starter& alone = wire.add(1, 0);
  wire.run(kListening - kMillisecond);
  EXPECT_EQ(wire.segment.statistics().frames, 0u) << "nothing is sent while it listens";
  wire.run(kListening + MasterClaim::kAnnouncing - kMillisecond);
  EXPECT_EQ(alone.claim.state(), State::announcing);
  EXPECT_GE(wire.segment.statistics().frames, 4u);
  wire.run(kListening + MasterClaim::kAnnouncing);
  EXPECT_EQ(alone.claim.state(), State::leads);
}

TEST(MasterClaim, of_two_that_start_at_the_same_moment_exactly_one_goes_on) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Wire wire;
    wire.add(2 * seed, 0);
    wire.add(2 * seed + 1, 0);
    wire.run(3 * image::kSecond);
    ASSERT_EQ(wire.count(State::leads), 1) << seed;
    ASSERT_EQ(wire.segment.statistics().errors, 0u) << seed << ": announcements never destroy one another";
  }
}

TEST(MasterClaim, of_three_that_start_one_after_the_other_exactly_one_goes_on_over_a_slow_bus_too) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Wire wire;
    wire.add(3 * seed, 0, 30 * kMillisecond);
    wire.add(3 * seed + 1, static_cast<Nanoseconds>(seed % 500) * kMillisecond, 5 * kMillisecond);
    wire.add(3 * seed + 2, static_cast<Nanoseconds>(seed % 70) * kMillisecond, 20 * kMillisecond,
             7 * kMillisecond);
    wire.run(4 * image::kSecond);
    ASSERT_EQ(wire.count(State::leads), 1) << seed;
  }
}

TEST(MasterClaim, who_starts_while_another_one_announces_itself_sends_nothing) {
  Wire wire;
  wire.add(5, 0);
  wire.run(1000 * kMillisecond);
  const Starter& second = wire.add(6, 1001 * kMillisecond);
  wire.run(kListening + MasterClaim::kAnnouncing - kMillisecond);
  EXPECT_EQ(second.claim.state(), State::late);
  wire.run(4 * image::kSecond);
  EXPECT_EQ(wire.count(State::leads), 1);
}

TEST(MasterClaim, numbers_that_are_equal_are_drawn_anew) {
  testing::ScriptedBus bus;
  MasterClaim claim(kOwn, kListening, 9);
  claim.begin(0);
  Nanoseconds now = kListening;
  while (bus.sent.empty()) claim.poll(now += kMillisecond, bus);
  const image::CanFrame own = bus.sent.front();
  claim.on_frame(own);  // of somebody else: nobody receives his own
  const Nanoseconds drawn = now;
  while (claim.poll(now += kMillisecond, bus) == State::announcing) continue;
  EXPECT_EQ(claim.state(), State::leads);
  EXPECT_GE(now, drawn + MasterClaim::kAnnouncing) << "the new number is announced for the whole time";
  EXPECT_NE(bus.sent.back().id, own.id);
}

TEST(MasterClaim, gives_way_to_whoever_leads_nodes_even_while_it_announces_itself) {
  for (const image::CanFrame& frame :
       {make_frame(cob::kSync, {}), nmt_frame(NmtCommand::start, 0), testing::frame(0x201, {15, 0}),
        heartbeat_frame(kOwn, NmtState::operational)}) {
    testing::ScriptedBus bus;
    MasterClaim claim(kOwn, kListening, 3);
    claim.begin(0);
    for (Nanoseconds now = 0; now < kListening + 100 * kMillisecond; now += kMillisecond)
      claim.poll(now, bus);
    ASSERT_EQ(claim.state(), State::announcing);
    claim.on_frame(frame);
    EXPECT_EQ(claim.poll(kListening + 101 * kMillisecond, bus), State::led) << testing::show(frame);
  }
}

TEST(MasterClaim, time_in_which_it_did_not_look_does_not_count) {
  testing::ScriptedBus bus;
  MasterClaim claim(kOwn, kListening, 4);
  claim.begin(0);
  Nanoseconds now = 0;
  for (; now < kListening + 200 * kMillisecond; now += kMillisecond) claim.poll(now, bus);
  now += 5 * image::kSecond;
  for (int i = 0; i < 150; ++i)
    EXPECT_EQ(claim.poll(now += kMillisecond, bus), State::announcing) << "as if nothing had been";
  now += 200 * kMillisecond;
  bus.sent.clear();
  claim.on_frame(make_frame(MasterClaim::kFirstCob, {}));
  EXPECT_NE(claim.state(), State::late) << "a frame of a device under this identifier is no announcement";
}

}  // namespace
}  // namespace servogate::canopen
