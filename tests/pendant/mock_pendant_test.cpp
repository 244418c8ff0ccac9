// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/pendant/mock_pendant.hpp"

#include <gtest/gtest.h>

#include "tests/pendant/makes.hpp"

namespace servogate::mock {
namespace {

using drivers::PendantNews;
using Played = MockPendant::Played;

class PendantOnItsPort : public ::testing::Test {
 protected:
  /// What has come, read as the other end does; counts summed up.
  pendant::Reading read() {
    pendant::Reading last;
    PendantNews news;
    int counts = 0;
    while (mock_.take(news)) {
      kinds_.push_back(news.kind);
      if (news.kind != PendantNews::Kind::report) continue;
      const auto reading = reader_.read(news.report.view());
      if (!reading) {
        ++refused_;
        continue;
      }
      last = *reading;
      counts += reading->counts;
    }
    last.counts = counts;
    return last;
  }

  const pendant::Layout layout_ = pendant::test::with_selectors();
  MockPendant mock_{layout_};
  pendant::ReportReader reader_{layout_};
  std::vector<PendantNews::Kind> kinds_;
  int refused_ = 0;
};

TEST_F(PendantOnItsPort, is_there_and_says_how_it_stands) {
  EXPECT_EQ(read(), pendant::Reading{});
  ASSERT_EQ(kinds_.size(), 2u);
  EXPECT_EQ(kinds_[0], PendantNews::Kind::plugged);
}

TEST_F(PendantOnItsPort, sends_what_is_played_by_name) {
  EXPECT_EQ(mock_.play("axis", 2), Played::done);
  EXPECT_EQ(mock_.play("step", 3), Played::done);
  EXPECT_EQ(mock_.play("fn", 1), Played::done);
  EXPECT_EQ(mock_.play("wheel", 1000), Played::done);
  EXPECT_EQ(mock_.play("wheel", 990), Played::done);
  const pendant::Reading got = read();
  EXPECT_EQ(got.axis, 1);
  EXPECT_EQ(got.step, 2);
  EXPECT_EQ(got.buttons, 1u << layout_.button("fn"));
  EXPECT_EQ(got.counts, 990);
}

TEST_F(PendantOnItsPort, refuses_what_it_has_not) {
  EXPECT_EQ(mock_.play("ring", 1), Played::no_such_control);
  EXPECT_EQ(mock_.play("axis", 5), Played::out_of_range);
  EXPECT_EQ(mock_.play("axis", 0.5), Played::out_of_range);
  EXPECT_EQ(mock_.play("fn", 2), Played::out_of_range);
}

TEST_F(PendantOnItsPort, says_nothing_while_it_is_unplugged) {
  mock_.plug(false);
  mock_.play("fn", 1);
  read();
  ASSERT_EQ(kinds_.back(), PendantNews::Kind::unplugged);
  mock_.plug(true);
  EXPECT_EQ(read().buttons, 1u << layout_.button("fn"));
}

TEST_F(PendantOnItsPort, a_stuck_button_stays_at_its_level) {
  mock_.stick("reset", true);
  EXPECT_EQ(read().buttons, 1u << layout_.button("reset"));
  mock_.play("reset", 1);
  mock_.play("reset", 0);
  EXPECT_EQ(read().buttons, 1u << layout_.button("reset"));
  mock_.release("reset");
  EXPECT_EQ(read().buttons, 0u);
}

TEST_F(PendantOnItsPort, garbage_is_mostly_no_report) {
  read();
  mock_.garble(true);
  for (int n = 1; n <= 100; ++n) mock_.play("wheel", n);
  read();
  EXPECT_GT(refused_, 50);
}

TEST_F(PendantOnItsPort, news_that_nobody_takes_end_as_if_it_had_been_unplugged) {
  for (int n = 1; n <= 3000; ++n) mock_.play("wheel", n);
  read();
  EXPECT_NE(std::find(kinds_.begin(), kinds_.end(), PendantNews::Kind::unplugged), kinds_.end());
  EXPECT_LE(kinds_.size(), 1002u);
}

}  // namespace
}  // namespace servogate::mock
