// SPDX-License-Identifier: Apache-2.0
// Requests that lie: which of them a cycle still takes, and whose one is that its poster takes back.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <set>
#include <thread>

#include "kernel/cycle/executive.hpp"
#include "tests/alarms.hpp"

namespace servogate::cycle {
namespace {

using image::kMillisecond;
using image::Request;
using image::RequestKind;

constexpr image::Nanoseconds kLimit = 100 * kMillisecond;

class WallClock final : public image::Clock {
 public:
  image::Nanoseconds now_ns() const noexcept override { return now; }
  image::Nanoseconds now = 1'000'000 * kMillisecond;
};

class RequestAge : public ::testing::Test {
 protected:
  RequestAge() {
    CycleParts parts;
    parts.alarms = &tests::alarm_table();
    parts.axes = {axis::AxisConfig{}};
    parts.request_clock = &clock_;
    cycle_ = std::make_unique<Cycle>(std::move(parts));
  }
  static Request of(RequestKind kind, double value = 1.0) {
    Request r;
    r.id = 5;
    r.kind = kind;
    r.axis = 0;
    r.value = value;
    return r;
  }
  /// The answer to a request that had lain for the one time when it was posted, and lies for the other.
  image::Answer after(const Request& request, image::Nanoseconds lain, image::Nanoseconds lies) {
    EXPECT_NE(cycle_->post_for(request, lain, kLimit), 0u);
    clock_.now += lies;
    cycle_->step();
    image::Answer answer;
    EXPECT_TRUE(cycle_->take_answer(answer));
    EXPECT_EQ(answer.id, request.id);
    return answer;
  }
  static bool too_old(const image::Answer& answer) {
    return answer.refusal == static_cast<std::uint16_t>(Refusal::too_old);
  }

  WallClock clock_;
  std::unique_ptr<Cycle> cycle_;
};

/// Every kind with a value, and whether it is carried out however old it is.
struct Row {
  RequestKind kind;
  double value;
  bool always;
};
constexpr Row kRows[] = {
    {RequestKind::power, 1.0, false},
    {RequestKind::power, 0.0, true},
    {RequestKind::home, 0.0, false},
    {RequestKind::jog_increment, 1.0, false},
    {RequestKind::jog_continuous, 1.0, false},
    {RequestKind::keep_alive, 0.0, false},
    {RequestKind::jog_stop, 0.0, true},
    {RequestKind::jog_stop, 1.0, true},
    {RequestKind::zero, 0.0, false},
    {RequestKind::mode, 1.0, false},
    {RequestKind::start, 0.0, false},
    {RequestKind::step, 0.0, false},
    {RequestKind::hold, 0.0, true},
    {RequestKind::resume, 0.0, false},
    {RequestKind::stop, 0.0, true},
    {RequestKind::reset, 0.0, true},
    {RequestKind::override_feed, 1.0, false},
    {RequestKind::override_feed, 0.0, true},
    {RequestKind::quick_stop, 0.0, true},
    {RequestKind::acknowledge, 0.0, false},
    {RequestKind::set_place, 0.0, false},
    {RequestKind::force, 0.0, false},
    {RequestKind::release_force, 0.0, false},
    {RequestKind::logic, 1.0, false},
    {RequestKind::axis_power, 1.0, false},
    {RequestKind::axis_power, 0.0, true},
    {RequestKind::axis_home, 0.0, false},
    {RequestKind::move_absolute, 0.0, false},
    {RequestKind::move_relative, 0.0, false},
    {RequestKind::move_velocity, 1.0, false},
    {RequestKind::axis_stop, 0.0, true},
    {RequestKind::axis_reset, 0.0, true},
    {RequestKind::logic_scan, 0.0, false},
    {RequestKind::torque, 0.0, false},
};

TEST_F(RequestAge, is_no_reason_against_what_takes_away_and_one_against_all_that_begins) {
  std::set<RequestKind> seen;
  for (const Row& row : kRows) {
    seen.insert(row.kind);
    const Request r = of(row.kind, row.value);
    EXPECT_EQ(never_too_old(r), row.always) << static_cast<int>(row.kind);
    EXPECT_FALSE(too_old(after(r, 0, kLimit))) << static_cast<int>(row.kind);
    EXPECT_EQ(too_old(after(r, 0, kLimit + 1)), !row.always) << static_cast<int>(row.kind);
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(RequestKind::torque)) << "every kind has its row";
}

TEST_F(RequestAge, counts_what_a_request_had_lain_before_it_was_posted_and_says_how_long_that_was) {
  const Request power = of(RequestKind::power);
  EXPECT_FALSE(too_old(after(power, 60 * kMillisecond, 40 * kMillisecond)));
  const image::Answer late = after(power, 60 * kMillisecond, 90 * kMillisecond);
  ASSERT_TRUE(too_old(late));
  EXPECT_EQ(late.value, 150.0);
  EXPECT_EQ(late.limit, 100.0);
  EXPECT_EQ(render(late, {"X"}, text::Language::english),
            "the request waited for 150 ms before the control could carry it out, and 100 ms is the longest: "
            "nothing was done; send it again if it is still wanted");
  EXPECT_FALSE(cycle_->image().axes[0].enabled);
}

TEST_F(RequestAge, is_not_asked_for_where_no_limit_was_given) {
  ASSERT_TRUE(cycle_->post(of(RequestKind::power)));
  clock_.now += 3600 * image::kSecond;
  cycle_->step();
  image::Answer answer;
  ASSERT_TRUE(cycle_->take_answer(answer));
  EXPECT_EQ(answer.refusal, 0);
}

/// Keeps the requests that a record would hold.
class Requests final : public InputTap {
 public:
  void take(const CycleInputs& in) noexcept override { count += in.request_count; }
  int count = 0;
};

TEST_F(RequestAge, keeps_what_is_too_old_or_withdrawn_out_of_the_record) {
  Requests record;
  cycle_->attach(&record);
  after(of(RequestKind::power), 0, 2 * kLimit);
  const Claim claim = cycle_->post_for(of(RequestKind::power), 0, kLimit);
  EXPECT_TRUE(cycle_->withdraw(claim));
  cycle_->step();
  EXPECT_EQ(record.count, 0);
  after(of(RequestKind::power), 0, 0);
  EXPECT_EQ(record.count, 1);
}

TEST_F(RequestAge, a_request_is_either_withdrawn_or_taken) {
  const Claim before = cycle_->post_for(of(RequestKind::power), 0, kLimit);
  EXPECT_TRUE(cycle_->withdraw(before));
  EXPECT_FALSE(cycle_->withdraw(before)) << "once";
  cycle_->step();
  image::Answer answer;
  EXPECT_FALSE(cycle_->take_answer(answer)) << "nobody waits for it";
  const Claim taken = cycle_->post_for(of(RequestKind::power), 0, kLimit);
  cycle_->step();
  EXPECT_FALSE(cycle_->withdraw(taken));
  EXPECT_TRUE(cycle_->take_answer(answer));
  EXPECT_FALSE(cycle_->withdraw(0));
}

TEST_F(RequestAge, each_is_either_withdrawn_or_answered_when_both_sides_want_it_at_once) {
  std::atomic<bool> end{false};
  std::thread steps([&] {
    while (!end) cycle_->step();
  });
  std::set<std::uint64_t> withdrawn, answered;
  const auto collect = [&] {
    for (image::Answer a; cycle_->take_answer(a);) EXPECT_TRUE(answered.insert(a.id).second) << a.id;
  };
  constexpr std::uint64_t kMany = 20'000;
  for (std::uint64_t id = 1; id <= kMany; ++id) {
    Request r = of(RequestKind::acknowledge);
    r.id = id;
    Claim claim = 0;
    while ((claim = cycle_->post_for(r, 0, kLimit)) == 0) collect();
    if (id % 2 == 0 && cycle_->withdraw(claim)) withdrawn.insert(id);
    collect();
  }
  end = true;
  steps.join();
  for (int n = 0; n < 100; ++n) {
    cycle_->step();
    collect();
  }
  EXPECT_EQ(withdrawn.size() + answered.size(), kMany);
  for (const std::uint64_t id : withdrawn) EXPECT_FALSE(answered.contains(id)) << id;
}

}  // namespace
}  // namespace servogate::cycle
