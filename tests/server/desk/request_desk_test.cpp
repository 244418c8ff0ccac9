// SPDX-License-Identifier: Apache-2.0
// Between clients and the gate: whose answer is whose, and what a stop does to what was asked before it.
#include "gateway/control/server/resident/request_desk.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>

#include "gateway/control/server/resident/work/workshop.hpp"
#include "tests/alarms.hpp"
#include "tests/comes.hpp"

namespace servogate::gateway {
namespace {

using image::RequestKind;

/// Asked for just now, when clients had asked for so many stops.
Asked asked_before(const Stops& stops) {
  Asked asked;
  asked.stops = stops;
  return asked;
}

class RequestDeskTest : public ::testing::Test {
 protected:
  cycle::Cycle cycle_{cycle::CycleParts{}};
  RequestDesk desk_{cycle_};
  image::Answer answer_;
};

TEST_F(RequestDeskTest, gives_each_answer_to_who_asked_in_whatever_order_they_look) {
  const std::uint64_t first = desk_.post({.kind = RequestKind::acknowledge});
  const std::uint64_t second = desk_.post({.kind = RequestKind::start});
  EXPECT_FALSE(desk_.take(first)) << "the cycle has not run";
  cycle_.step();
  ASSERT_TRUE(desk_.tell({.kind = RequestKind::acknowledge}));
  const auto of_second = desk_.take(second);
  ASSERT_TRUE(of_second);
  EXPECT_EQ(of_second->refusal, static_cast<std::uint16_t>(cycle::Refusal::no_such_process));
  const auto of_first = desk_.take(first);
  ASSERT_TRUE(of_first);
  EXPECT_EQ(of_first->refusal, 0);
  EXPECT_FALSE(desk_.take(first)) << "once";
}

TEST_F(RequestDeskTest, begins_nothing_that_was_asked_for_before_a_stop) {
  for (const image::Request& stop :
       {image::Request{.kind = RequestKind::stop}, image::Request{.kind = RequestKind::hold},
        image::Request{.kind = RequestKind::quick_stop},
        image::Request{.kind = RequestKind::power, .value = 0.0}}) {
    const Stops before = desk_.stops();
    ASSERT_TRUE(desk_.tell(stop));
    for (const RequestKind kind : {RequestKind::start, RequestKind::step, RequestKind::resume,
                                   RequestKind::home, RequestKind::jog_increment})
      EXPECT_EQ(desk_.ask({.kind = kind, .value = 1.0}, answer_, asked_before(before), 0),
                RequestDesk::Outcome::overtaken);
    EXPECT_EQ(desk_.ask({.kind = RequestKind::power, .value = 1.0}, answer_, asked_before(before), 0),
              RequestDesk::Outcome::overtaken);
    EXPECT_EQ(desk_.ask({.kind = RequestKind::acknowledge}, answer_, asked_before(before), 0),
              RequestDesk::Outcome::silent)
        << "posted: it moves nothing";
    EXPECT_EQ(desk_.ask({.kind = RequestKind::start}, answer_, asked_before(desk_.stops()), 0),
              RequestDesk::Outcome::silent)
        << "posted: it was asked for behind the stop";
    cycle_.step();
  }
}

TEST_F(RequestDeskTest, takes_a_jog_stop_for_a_stop_of_jogs_only_and_a_dead_hand_for_none) {
  const Stops before = desk_.stops();
  ASSERT_TRUE(desk_.tell({.kind = RequestKind::jog_stop, .axis = 0, .value = 1.0}));
  EXPECT_EQ(desk_.ask({.kind = RequestKind::jog_continuous, .value = 1.0}, answer_, asked_before(before), 0),
            RequestDesk::Outcome::silent);
  ASSERT_TRUE(desk_.tell({.kind = RequestKind::jog_stop}));
  EXPECT_EQ(desk_.ask({.kind = RequestKind::jog_continuous, .value = 1.0}, answer_, asked_before(before), 0),
            RequestDesk::Outcome::overtaken);
  EXPECT_EQ(desk_.ask({.kind = RequestKind::start}, answer_, asked_before(before), 0),
            RequestDesk::Outcome::silent);
}

/// Stands still, and counts how often it is read: once when a request is posted that can grow too old.
class CountedClock final : public image::Clock {
 public:
  image::Nanoseconds now_ns() const noexcept override {
    ++reads;
    return 0;
  }
  mutable std::atomic<int> reads{0};
};

/// A desk whose requests may lie for 100 ms, over a cycle with one axis.
class AgeOfRequests : public ::testing::Test {
 protected:
  AgeOfRequests() { desk_.set_longest_wait(RequestDesk::kLongestWait); }
  cycle::CycleParts parts() const {
    cycle::CycleParts parts;
    parts.alarms = &tests::alarm_table();
    parts.axes = {axis::AxisConfig{}};
    parts.request_clock = &clock_;
    return parts;
  }
  /// Asked for so far ahead that no computer is slow enough to make it too old.
  static Asked asked_in_time() { return asked(-std::chrono::hours(1)); }
  static Asked asked(std::chrono::seconds ago) { return {{}, std::chrono::steady_clock::now() - ago, {}}; }
  cycle::Refusal refusal() const { return static_cast<cycle::Refusal>(answer_.refusal); }
  bool power_wanted() {
    cycle_.step();
    return cycle_.axes()[0].power_requested();
  }
  static constexpr image::Request kPower{.kind = RequestKind::power, .value = 1.0};
  CountedClock clock_;
  cycle::Cycle cycle_{parts()};
  RequestDesk desk_{cycle_};
  image::Answer answer_;
};

TEST_F(AgeOfRequests, refuses_what_would_begin_something_once_it_has_lain_and_says_how_long) {
  const Asked before = asked(std::chrono::seconds(3));
  for (const RequestKind kind : {RequestKind::start, RequestKind::step, RequestKind::resume,
                                 RequestKind::home, RequestKind::jog_increment, RequestKind::jog_continuous,
                                 RequestKind::power, RequestKind::force, RequestKind::logic_scan}) {
    EXPECT_EQ(desk_.ask({.kind = kind, .value = 1.0}, answer_, before, 0), RequestDesk::Outcome::answered);
    EXPECT_EQ(refusal(), cycle::Refusal::too_old);
    EXPECT_GE(answer_.value, 3000.0);
    EXPECT_EQ(answer_.limit, 100.0);
  }
  EXPECT_FALSE(power_wanted());
}

TEST_F(AgeOfRequests, refuses_what_would_begin_something_when_its_client_is_gone) {
  Asked now;
  now.gone = std::make_shared<std::atomic<bool>>(true);
  EXPECT_EQ(desk_.ask(kPower, answer_, now, 0), RequestDesk::Outcome::answered);
  EXPECT_EQ(refusal(), cycle::Refusal::client_gone);
  EXPECT_FALSE(power_wanted());
}

TEST_F(AgeOfRequests, withdraws_what_waits_for_the_cycle_when_its_client_goes) {
  const auto gone = std::make_shared<std::atomic<bool>>(false);
  Asked request = asked_in_time();
  request.gone = gone;
  const auto asks = std::async(std::launch::async, [&] { desk_.ask(kPower, answer_, request, 600'000); });
  ASSERT_TRUE(tests::comes([&] { return clock_.reads > 0; }));
  desk_.stops();  // under the desk's lock: it is posted now
  *gone = true;
  asks.wait();
  EXPECT_EQ(refusal(), cycle::Refusal::client_gone);
  EXPECT_FALSE(power_wanted()) << "no cycle finds it";
}

TEST_F(AgeOfRequests, withdraws_what_the_cycle_did_not_answer_in_time) {
  EXPECT_EQ(desk_.ask(kPower, answer_, asked_in_time(), 0), RequestDesk::Outcome::silent);
  EXPECT_FALSE(power_wanted());
}

TEST_F(AgeOfRequests, carries_stops_out_however_old_they_are_whoever_asked_and_whenever_the_cycle_comes) {
  desk_.set_longest_wait(std::chrono::minutes(10));  // that this computer may need between two lines
  ASSERT_TRUE(desk_.tell(kPower));
  ASSERT_TRUE(power_wanted());
  desk_.set_longest_wait(RequestDesk::kLongestWait);
  Asked before = asked(std::chrono::seconds(3));
  before.gone = std::make_shared<std::atomic<bool>>(true);
  for (const RequestKind kind : {RequestKind::stop, RequestKind::hold, RequestKind::quick_stop,
                                 RequestKind::jog_stop, RequestKind::reset, RequestKind::power}) {
    EXPECT_EQ(desk_.ask({.kind = kind, .process = -1, .value = 0.0}, answer_, before, 0),
              RequestDesk::Outcome::taken)
        << "it is left to the cycle";
  }
  EXPECT_FALSE(power_wanted()) << "power off has come";
}

TEST(Workshop, does_what_waits_before_it_closes_and_begins_nothing_once_it_is_cancelled) {
  int done = 0, cancelled = 0;
  const auto count = [&](Finish finish) { ++(finish ? done : cancelled); };
  Work work;
  work.run = [](const std::stop_token&) -> Finish { return [] { return Reply{}; }; };
  {
    Workshop shop;
    for (int n = 0; n < 5; ++n) shop.take(work, count);
    shop.close();
  }
  EXPECT_EQ(done, 5);
  std::promise<void> begun;
  Work endless;
  endless.run = [&begun](const std::stop_token& stop) -> Finish {
    begun.set_value();
    while (!stop.stop_requested()) std::this_thread::yield();
    throw Cancelled{};
  };
  {
    Workshop shop;
    shop.take(endless, count);
    shop.take(work, count);
    begun.get_future().wait();
    shop.cancel();
    shop.close();
  }
  EXPECT_EQ(done, 5);
  EXPECT_EQ(cancelled, 2);
}

}  // namespace
}  // namespace servogate::gateway
