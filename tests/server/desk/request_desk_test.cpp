// SPDX-License-Identifier: Apache-2.0
// Between clients and the gate: whose answer is whose, and what a stop does to what was asked before it.
#include "gateway/server/gate/request_desk.hpp"

#include <gtest/gtest.h>

#include <future>

#include "gateway/server/work/workshop.hpp"

namespace servogate::gateway {
namespace {

using image::RequestKind;

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
      EXPECT_EQ(desk_.ask({.kind = kind, .value = 1.0}, answer_, before, 0), RequestDesk::Outcome::overtaken);
    EXPECT_EQ(desk_.ask({.kind = RequestKind::power, .value = 1.0}, answer_, before, 0),
              RequestDesk::Outcome::overtaken);
    EXPECT_EQ(desk_.ask({.kind = RequestKind::reset}, answer_, before, 0), RequestDesk::Outcome::silent)
        << "posted: it moves nothing";
    EXPECT_EQ(desk_.ask({.kind = RequestKind::start}, answer_, desk_.stops(), 0),
              RequestDesk::Outcome::silent)
        << "posted: it was asked for behind the stop";
    cycle_.step();
  }
}

TEST_F(RequestDeskTest, takes_a_jog_stop_for_a_stop_of_jogs_only_and_a_dead_hand_for_none) {
  const Stops before = desk_.stops();
  ASSERT_TRUE(desk_.tell({.kind = RequestKind::jog_stop, .axis = 0, .value = 1.0}));
  EXPECT_EQ(desk_.ask({.kind = RequestKind::jog_continuous, .value = 1.0}, answer_, before, 0),
            RequestDesk::Outcome::silent);
  ASSERT_TRUE(desk_.tell({.kind = RequestKind::jog_stop}));
  EXPECT_EQ(desk_.ask({.kind = RequestKind::jog_continuous, .value = 1.0}, answer_, before, 0),
            RequestDesk::Outcome::overtaken);
  EXPECT_EQ(desk_.ask({.kind = RequestKind::start}, answer_, before, 0), RequestDesk::Outcome::silent);
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
