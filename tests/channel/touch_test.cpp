// SPDX-License-Identifier: Apache-2.0
// A place that is measured by hand: its commands, and the whole of it on a machine.
#include "kernel/channel/motion/touch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kernel/channel/alarms/master_alarms.hpp"
#include "tests/channel/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

double place_of(const program::Command& command) {
  if (const auto* probe = std::get_if<program::Probe>(&command.what)) return probe->to[0];
  return std::get<program::Line>(command.what).to[0];
}

TEST(Touch, never_leaves_the_way_that_was_ordered_wherever_the_surface_stands) {
  std::mt19937_64 random(servogate::test::property_seed());
  const auto mm = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int n = 0; n < 1000; ++n) {
    program::Position from{};
    from[0] = mm(-50.0, 50.0);
    const double by = mm(0.1, 40.0) * (n % 2 == 0 ? 1.0 : -1.0), back = mm(0.01, std::abs(by));
    const double surface = from[0] + by * mm(0.0, 1.0);
    Touch touch({.axis = 0, .by = by, .fast = 200.0, .slow = 20.0, .back = back, .times = 3}, from);
    const double low = std::min(from[0], from[0] + by), high = std::max(from[0], from[0] + by);
    int slow = 0;
    while (const auto command = touch.next()) {
      ASSERT_GE(place_of(*command), low - 1e-9) << "by " << by << ", back " << back;
      ASSERT_LE(place_of(*command), high + 1e-9) << "by " << by << ", back " << back;
      if (std::holds_alternative<program::Probe>(command->what)) {
        ++slow;
        touch.touched(surface);
      }
    }
    EXPECT_EQ(slow, 4);
    EXPECT_EQ(touch.places().size(), 3u);
  }
}

/// Z down by 60 mm at most, by hand.
struct TouchRig : Rig {
  explicit TouchRig(std::int32_t times = 1) : Rig("M30\n") {
    process->set_touch({2, -60.0, 600.0, 60.0, 3.0, times});
    each = [this] { deepest = std::min(deepest, x(2)); };
  }
  void begin() {
    ASSERT_EQ(ask(RequestKind::mode, static_cast<double>(image::Mode::mdi)), cycle::Refusal::none);
    start();
    ASSERT_EQ(started(), cycle::Refusal::none);
    run(0.01);
  }
  double deepest = 0.0;
};

TEST(TouchByHand, touches_fast_then_slowly_and_goes_back_to_where_it_began) {
  TouchRig rig;
  rig.drives.surface_at(-31.41592);
  rig.begin();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  const Touches::Found found = rig.process->touches();
  ASSERT_EQ(found.places.size(), 1u);
  EXPECT_EQ(found.axis, 2);
  EXPECT_NEAR(found.places[0], -31.41592, 0.1 * 1.0 * 0.001)
      << "a tenth of the way of a cycle at the slow feed";
  EXPECT_GT(rig.deepest, -31.41592 - 0.5);
  EXPECT_NEAR(rig.x(2), 0.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(TouchByHand, repeats_its_touch_as_often_as_it_is_asked_to) {
  TouchRig rig(5);
  rig.drives.surface_at(-31.41592);
  rig.begin();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  const Touches::Found found = rig.process->touches();
  ASSERT_EQ(found.places.size(), 5u);
  const auto [least, most] = std::minmax_element(found.places.begin(), found.places.end());
  EXPECT_LT(*most - *least, 2 * 0.1 * 0.001);
  EXPECT_NEAR(rig.x(2), 0.0, 1e-6);
}

TEST(TouchByHand, that_finds_nothing_is_an_alarm_and_has_measured_nothing) {
  TouchRig rig;
  rig.begin();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kProbeMissed), 1) << rig.alarm_list();
  EXPECT_TRUE(rig.process->touches().places.empty());
  EXPECT_NEAR(rig.x(2), -60.0, 1e-6) << "and no further";
}

TEST(TouchByHand, with_a_deflected_probe_moves_nothing) {
  TouchRig rig;
  rig.drives.surface_at(1.0);
  rig.begin();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kProbeStuck), 1) << rig.alarm_list();
  EXPECT_EQ(rig.deepest, 0.0);
}

TEST(TouchByHand, is_done_once_the_next_start_does_not_repeat_it) {
  TouchRig rig;
  rig.drives.surface_at(-31.0);
  rig.begin();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  rig.deepest = 0.0;
  rig.start();
  rig.run(2.0);
  EXPECT_EQ(rig.deepest, 0.0);
}

TEST(TouchByHand, that_is_held_in_any_phase_goes_on_and_measures_the_same) {
  for (const double at : {0.3, 1.5, 3.0, 3.3, 3.7, 5.0, 6.5}) {
    TouchRig rig(2);
    rig.drives.surface_at(-31.0);
    rig.begin();
    rig.run(at);
    ASSERT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
    rig.run(0.5);
    ASSERT_EQ(rig.ask(RequestKind::resume), cycle::Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << at << rig.alarm_list();
    ASSERT_EQ(rig.process->touches().places.size(), 2u) << at;
    for (const double place : rig.process->touches().places) EXPECT_NEAR(place, -31.0, 0.001) << at;
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(TouchByHand, whose_drive_fails_or_that_is_stopped_in_any_phase_comes_to_rest_inside_of_the_limits) {
  for (const double at : {0.05, 1.5, 3.0, 3.2, 3.4, 3.7, 5.0})
    for (const bool fails : {true, false}) {
      TouchRig rig(2);
      rig.drives.surface_at(-31.0);
      rig.begin();
      rig.run(at);
      if (fails) {
        rig.drives.fault[2] = true;
      } else {
        ASSERT_EQ(rig.ask(RequestKind::stop), cycle::Refusal::none);
      }
      ASSERT_TRUE(rig.until([&] { return !rig.moving() && rig.state() != ProcessState::running; })) << at;
      EXPECT_LT(rig.process->touches().places.size(), 2u) << at;
      EXPECT_GT(rig.deepest, -31.5) << at;
      if (!fails) {
        EXPECT_EQ(rig.violations(), "") << at;
      }
    }
}

TEST(TouchByHand, survives_a_record_as_text_and_nothing_else_does) {
  const TouchOrder order{1, -12.345678901234567, 200.0, 20.0, 2.0, 7};
  const auto read = touch_from(to_text(order));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->by, order.by);
  EXPECT_EQ(read->times, 7);
  for (const char* wrong : {"", "G0 X1", "2 -20 200 20 2", "2 -20 200 20 2 0", "99 -20 200 20 2 1",
                            "2 0 200 20 2 1", "2 -20 200 20 2 1 X"})
    EXPECT_FALSE(touch_from(wrong)) << wrong;
}

}  // namespace
}  // namespace servogate::channel::test
