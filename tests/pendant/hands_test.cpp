// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/hands.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/pendant/makes.hpp"
#include "tests/property_seed.hpp"

namespace servogate::pendant {
namespace {

/// A pendant in a hand, and a machine that it sees.
class Hand {
 public:
  explicit Hand(Layout layout, Rules rules = {"XYZ", 1.0, -1})
      : layout_(std::move(layout)), rules_(std::move(rules)) {
    for (AxisView& a : view.axes) a = {.jogs = true, .room = 5.0};
    view.current = true;
    hands.see(view);
    reading.axis = layout_.axis >= 0 ? 0 : -1;
    reading.step = layout_.step >= 0 ? 1 : -1;
    report();
  }

  void report() {
    hands.take(reading);
    reading.counts = 0;
  }
  void turn(int counts) {
    reading.counts = counts;
    report();
  }
  void press(const char* name) {
    reading.buttons |= 1u << layout_.button(name);
    report();
  }
  void release(const char* name) {
    reading.buttons &= ~(1u << layout_.button(name));
    report();
  }
  void see() { hands.see(view); }
  bool next() { return hands.next(request, now); }
  /// The next request is this one, and it is granted.
  bool asks(RequestKind kind) {
    if (!next()) return false;
    if (!Hands::is_urgent(request)) answer(true);
    return request.kind == kind;
  }
  void answer(bool accepted) {
    hands.answered(request, accepted);
    if (accepted && request.kind == RequestKind::jog)
      view.axes[static_cast<std::size_t>(request.axis)].moves = true;
    see();  // a new picture of the machine
  }

 private:
  Layout layout_;
  Rules rules_;

 public:
  Hands hands{layout_, rules_};
  View view;
  Reading reading;
  Request request;
  image::Nanoseconds now = 0;
};

TEST(PendantWheel, AsksForAsManyStepsAsItWasTurned) {
  Hand hand(test::with_selectors());
  hand.turn(3);
  hand.turn(4);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  EXPECT_EQ(hand.request.axis, 0);
  EXPECT_NEAR(hand.request.value, 0.07, 1e-12);
  EXPECT_FALSE(hand.next());
}

TEST(PendantWheel, DrivesThePathInsteadOfAnAxisWhileThatIsChosen) {
  Hand hand(test::with_selectors());
  hand.view.by_path = true;
  hand.see();
  hand.turn(3);
  hand.turn(-7);
  ASSERT_TRUE(hand.asks(RequestKind::path_turned));
  EXPECT_EQ(hand.request.value, -4.0);
  EXPECT_FALSE(hand.next()) << "no jog";
  hand.turn(5);
  hand.view.by_path = false;
  hand.see();
  EXPECT_FALSE(hand.next()) << "counts of the path are no jog of an axis";
  hand.turn(5);
  EXPECT_FALSE(hand.next()) << "the hand still turns";
  hand.reading.axis = -1;
  hand.report();
  hand.reading.axis = 0;
  hand.report();
  hand.turn(2);
  EXPECT_TRUE(hand.asks(RequestKind::jog)) << "selected anew";
}

TEST(PendantWheel, CountsAlongThePathNeedTheDeadMan) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("probe")});
  hand.view.by_path = true;
  hand.see();
  hand.turn(3);
  EXPECT_FALSE(hand.next());
  hand.press("probe");
  hand.turn(3);
  ASSERT_TRUE(hand.asks(RequestKind::path_turned));
  hand.turn(2);
  hand.view.released = false;  // the wired one
  hand.see();
  EXPECT_FALSE(hand.next()) << "let go before it was asked for";
}

TEST(PendantWheel, WhatItTurnedBeforeItWasPluggedInMovesNothing) {
  const Layout layout = test::with_selectors();
  const Rules rules{"XYZ", 1.0, -1};
  Hands hands(layout, rules);
  View view;
  view.axes[0] = {.jogs = true, .room = 5.0};
  view.current = true;
  hands.see(view);
  hands.take({.axis = 0, .step = 1, .counts = 10});
  Request request;
  EXPECT_FALSE(hands.next(request, 0));
  EXPECT_EQ(hands.dropped(), 10u);
}

TEST(PendantWheel, MovesNothingOutsideItsModeAndNothingIsMadeUpFor) {
  Hand hand(test::with_selectors());
  hand.view.axes[0].jogs = false;
  hand.see();
  hand.turn(20);
  EXPECT_FALSE(hand.next());
  hand.view.axes[0].jogs = true;
  hand.see();
  EXPECT_FALSE(hand.next());
  EXPECT_EQ(hand.hands.dropped(), 20u);
}

TEST(PendantWheel, MovesNoAxisThatTheMachineFileDoesNotName) {
  Hand hand(test::with_selectors(), {"XY", 1.0, -1});
  hand.reading.axis = 2;
  hand.report();
  hand.turn(5);
  EXPECT_FALSE(hand.next());
}

TEST(PendantWheel, OffMovesNothing) {
  Hand hand(test::with_selectors());
  hand.reading.axis = -1;
  hand.report();
  hand.turn(5);
  EXPECT_FALSE(hand.next());
}

TEST(PendantWheel, CountsOfAReportThatChangesTheSelectionAreGone) {
  Hand hand(test::with_selectors());
  hand.reading.axis = 1;
  hand.turn(5);
  EXPECT_FALSE(hand.next());
  hand.reading.step = 2;
  hand.turn(5);
  EXPECT_FALSE(hand.next());
  hand.turn(1);
  EXPECT_TRUE(hand.asks(RequestKind::jog));
}

TEST(PendantWheel, AStepIsNeverLongerThanTheMachineFilePermits) {
  Hand hand(test::with_selectors(), {"XYZ", 0.05, -1});
  hand.reading.step = 3;  // 1 mm
  hand.report();
  hand.turn(2);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  EXPECT_NEAR(hand.request.value, 0.1, 1e-12);
}

TEST(PendantWheel, CountsThatTheAxisCannotFollowAreDroppedAndNotQueued) {
  Hand hand(test::with_selectors());
  hand.view.axes[0].room = 0.25;
  hand.see();
  hand.turn(100);  // 1 mm
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  EXPECT_NEAR(hand.request.value, 0.25, 1e-12);
  EXPECT_EQ(hand.hands.dropped(), 75u);
  hand.view.axes[0].moves = true;
  hand.view.axes[0].to_go = 0.195;
  hand.see();
  hand.turn(100);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  EXPECT_NEAR(hand.request.value, 0.05, 1e-12);
  hand.view.axes[0].to_go = 0.0;
  hand.see();
  EXPECT_FALSE(hand.next()) << "what was dropped stays so";
}

TEST(PendantWheel, WaitsForAPictureOfTheMachineBehindTheLastAnswer) {
  Hand hand(test::with_selectors());
  hand.turn(1);
  ASSERT_TRUE(hand.next());
  hand.turn(1);
  EXPECT_FALSE(hand.next()) << "the answer has not come";
  hand.hands.answered(hand.request, true);
  hand.view.current = false;
  hand.see();
  EXPECT_FALSE(hand.next()) << "what the answer did cannot be seen yet";
  hand.view.current = true;
  hand.see();
  EXPECT_TRUE(hand.next());
}

TEST(PendantWheel, TheAxisStopsWhenTheSelectorLeavesIt) {
  Hand hand(test::with_selectors());
  hand.turn(5);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  hand.view.axes[0].moves = true;
  hand.see();
  hand.reading.axis = 1;
  hand.report();
  ASSERT_TRUE(hand.asks(RequestKind::jog_stop));
  EXPECT_EQ(hand.request.axis, 0);
}

TEST(PendantWheel, TheAxisStopsWhenThePendantIsUnplugged) {
  Hand hand(test::with_selectors());
  hand.turn(5);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  hand.hands.lost();
  ASSERT_TRUE(hand.asks(RequestKind::jog_stop));
  EXPECT_EQ(hand.request.axis, 0);
  EXPECT_FALSE(hand.next());
}

TEST(PendantWheel, AJogThatIsGrantedAfterThePendantWasUnpluggedIsEnded) {
  Hand hand(test::with_selectors());
  hand.turn(5);
  ASSERT_TRUE(hand.next());
  const Request asked = hand.request;
  hand.hands.lost();
  ASSERT_TRUE(hand.asks(RequestKind::jog_stop));
  hand.hands.answered(asked, true);
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop));
}

TEST(PendantWheel, AnAxisThatSomebodyHasStoppedIsToBeSelectedAnew) {
  Hand hand(test::with_selectors());
  hand.turn(5);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  hand.view.axes[0].stopped = true;
  hand.view.axes[0].moves = false;
  hand.see();
  while (hand.next()) EXPECT_EQ(hand.request.kind, RequestKind::jog_stop);
  hand.turn(5);
  EXPECT_FALSE(hand.next());
  hand.view.axes[0].stopped = false;
  hand.reading.axis = -1;
  hand.report();
  hand.reading.axis = 0;
  hand.report();
  hand.turn(1);
  EXPECT_TRUE(hand.asks(RequestKind::jog));
}

TEST(PendantDeadMan, NothingBeginsToMoveWithoutIt) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("probe")});
  hand.turn(5);
  for (const char* button : {"start", "home"}) {
    hand.press(button);
    hand.release(button);
  }
  EXPECT_FALSE(hand.next());
  hand.press("probe");
  EXPECT_FALSE(hand.next()) << "what came before is not made up for";
  hand.turn(1);
  EXPECT_TRUE(hand.asks(RequestKind::jog));
  hand.press("start");
  EXPECT_TRUE(hand.asks(RequestKind::start));
}

TEST(PendantDeadMan, LettingGoStopsTheAxis) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("probe")});
  hand.press("probe");
  hand.turn(5);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  hand.view.axes[0].moves = true;
  hand.see();
  hand.release("probe");
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop));
}

TEST(PendantDeadMan, TheWiredOneStopsTheAxisToo) {
  Hand hand(test::with_selectors());
  hand.turn(5);
  ASSERT_TRUE(hand.asks(RequestKind::jog));
  hand.view.axes[0].moves = true;
  hand.view.released = false;
  hand.see();
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop));
  hand.turn(5);
  EXPECT_FALSE(hand.next());
}

TEST(PendantDeadMan, AStopNeedsNone) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("probe")});
  hand.press("stop");
  EXPECT_TRUE(hand.asks(RequestKind::stop));
  hand.view.running = true;
  hand.see();
  hand.press("start");
  EXPECT_TRUE(hand.asks(RequestKind::hold));
}

TEST(PendantButtons, OneIsPressedOnceUntilItIsReleased) {
  Hand hand(test::with_selectors());
  hand.press("reset");
  hand.report();
  EXPECT_TRUE(hand.asks(RequestKind::reset));
  hand.report();
  EXPECT_FALSE(hand.next());
}

TEST(PendantButtons, OneThatIsStuckWhenThePendantComesDoesNothing) {
  Hand hand(test::with_selectors());
  hand.hands.lost();
  hand.reading.buttons = 1u << test::with_selectors().button("start");
  hand.report();
  EXPECT_FALSE(hand.next());
}

TEST(PendantButtons, AStopOvertakesWhatWaits) {
  Hand hand(test::with_selectors());
  hand.press("home");
  ASSERT_TRUE(hand.next());
  hand.press("reset");
  hand.press("stop");
  EXPECT_TRUE(hand.asks(RequestKind::stop));
  EXPECT_FALSE(hand.next()) << "homing is not answered yet";
}

TEST(PendantButtons, AShiftGivesAnotherMeaningOrNone) {
  Hand hand(test::with_selectors());
  hand.press("fn");
  hand.press("macro");
  ASSERT_TRUE(hand.asks(RequestKind::mdi));
  EXPECT_EQ(*hand.request.text, "M8");
  hand.press("start");
  EXPECT_FALSE(hand.next()) << "nothing is bound to Fn and Start";
}

TEST(PendantButtons, StartBeginsHoldsAndResumes) {
  Hand hand(test::with_selectors());
  const auto press_asks = [&hand](RequestKind kind) {
    hand.see();
    hand.press("start");
    const bool asked = hand.asks(kind);
    hand.release("start");
    return asked;
  };
  EXPECT_TRUE(press_asks(RequestKind::start));
  hand.view.running = true;
  EXPECT_TRUE(press_asks(RequestKind::hold));
  hand.view.running = false;
  hand.view.held = true;
  EXPECT_TRUE(press_asks(RequestKind::resume));
}

TEST(PendantButtons, TheOverrideIsChangedFromWhatItIs) {
  Hand hand(test::with_selectors());
  hand.view.override_percent = 95.0;
  hand.see();
  hand.press("feed_plus");
  ASSERT_TRUE(hand.asks(RequestKind::override_feed));
  EXPECT_EQ(hand.request.value, 105.0);
  hand.release("feed_plus");
  hand.view.override_percent = 145.0;
  hand.see();
  hand.press("feed_plus");
  ASSERT_TRUE(hand.asks(RequestKind::override_feed));
  EXPECT_EQ(hand.request.value, 150.0);
}

TEST(PendantRing, JogsWhileItIsHeldAndIsKeptAlive) {
  Hand hand(test::with_ring());
  hand.press("b1");
  hand.reading.ring = -5;
  hand.report();
  ASSERT_TRUE(hand.asks(RequestKind::jog_on));
  EXPECT_EQ(hand.request.value, -1.0);
  hand.now += 10 * image::kMillisecond;
  EXPECT_FALSE(hand.next());
  hand.now += 25 * image::kMillisecond;
  EXPECT_TRUE(hand.asks(RequestKind::keep_alive));
  hand.reading.ring = 1;
  hand.report();
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop));
}

TEST(PendantRing, DoesNothingWithoutTheButtonOfAnAxis) {
  Hand hand(test::with_ring());
  hand.reading.ring = 7;
  hand.report();
  EXPECT_FALSE(hand.next());
  hand.press("b1");
  EXPECT_FALSE(hand.next()) << "it is to be let go first";
  hand.reading.ring = 0;
  hand.report();
  hand.reading.ring = 7;
  hand.report();
  EXPECT_TRUE(hand.asks(RequestKind::jog_on));
  hand.release("b1");
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop));
}

TEST(PendantRing, AJogThatEndedOtherwiseBeginsAnewOnlyBehindItsRest) {
  Hand hand(test::with_ring());
  hand.press("b1");
  hand.reading.ring = 7;
  hand.report();
  ASSERT_TRUE(hand.asks(RequestKind::jog_on));
  hand.now += 40 * image::kMillisecond;
  ASSERT_TRUE(hand.next());
  hand.answer(false);
  hand.report();
  EXPECT_FALSE(hand.next());
}

TEST(PendantRing, AJogThatIsGrantedAfterTheRingWasLetGoIsEnded) {
  Hand hand(test::with_ring());
  hand.press("b1");
  hand.reading.ring = 7;
  hand.report();
  ASSERT_TRUE(hand.next());
  const Request asked = hand.request;
  hand.reading.ring = 0;
  hand.report();
  ASSERT_TRUE(hand.asks(RequestKind::jog_stop));
  hand.hands.answered(asked, true);
  EXPECT_TRUE(hand.asks(RequestKind::jog_stop)) << "the first one may have come before the jog";
}

// Whatever a hand does by chance: no request moves an axis without dead-man, mode and permission, and what is
// left of a jog never exceeds what the axis may have to go.
TEST(PendantWheel, NoHandMovesWhatIsNotPermitted) {
  std::mt19937_64 random(servogate::test::property_seed());
  const auto chance = [&random](int one_in) { return random() % static_cast<unsigned>(one_in) == 0; };
  const Layout layout = test::with_selectors();
  const Rules rules{"XZ", 0.5, layout.button("probe")};
  Hand hand(layout, rules);
  for (int n = 0; n < 100'000; ++n) {
    hand.reading.counts = static_cast<int>(random() % 41) - 20;
    if (chance(10)) hand.reading.axis = static_cast<int>(random() % 5) - 1;
    if (chance(10)) hand.reading.step = static_cast<int>(random() % 5) - 1;
    if (chance(5)) hand.reading.buttons ^= 1u << random() % layout.buttons.size();
    if (chance(100)) hand.hands.lost();
    for (std::size_t a = 0; a < hand.view.axes.size(); ++a) {
      AxisView& axis = hand.view.axes[a];
      if (chance(20)) axis.jogs = !axis.jogs;
      axis.room = 0.3;
      axis.moves = axis.to_go != 0.0;
    }
    if (chance(20)) hand.view.released = !hand.view.released;
    hand.see();
    hand.report();
    while (hand.next()) {
      const Request request = hand.request;
      if (request.kind == RequestKind::jog) {
        AxisView& axis = hand.view.axes[static_cast<std::size_t>(request.axis)];
        ASSERT_TRUE(axis.jogs);
        ASSERT_TRUE(hand.view.released);
        ASSERT_NE(hand.reading.buttons >> rules.dead_man & 1u, 0u);
        ASSERT_EQ(request.axis, hand.reading.axis);
        ASSERT_NE(rules.axes.find(layout.axes[static_cast<std::size_t>(request.axis)].letter),
                  std::string::npos);
        const bool rested = axis.to_go * request.value <= 0.0;
        axis.to_go += request.value;
        axis.moves = true;
        if (!rested) {
          ASSERT_LE(std::abs(axis.to_go), 0.3 + 1e-9);
        }
        ASSERT_LE(std::abs(axis.to_go), 0.6 + 1e-9) << "a turn back may add its room to what is left";
      }
      if (request.kind == RequestKind::jog_stop)
        hand.view.axes[static_cast<std::size_t>(request.axis)].to_go = 0.0;
      if (!Hands::is_urgent(request)) hand.answer(chance(10) ? false : true);
    }
    for (AxisView& axis : hand.view.axes)
      axis.to_go = std::abs(axis.to_go) < 0.02 ? 0.0 : axis.to_go - std::copysign(0.02, axis.to_go);
  }
}

TEST(PendantStop, WorksWhileAnotherButtonShiftsAndWhileADeadManIsHeld) {
  Hand hand(test::with_selectors());
  hand.press("fn");
  hand.press("stop");
  EXPECT_TRUE(hand.asks(RequestKind::stop));
}

TEST(PendantStop, IsAskedForThoughMoreWaitsThanThereIsRoomForAndTakesWhatWaitsAway) {
  Hand hand(test::with_selectors());
  hand.press("start");
  ASSERT_TRUE(hand.next());
  ASSERT_EQ(hand.request.kind, RequestKind::start);  // its answer stays away
  for (int n = 0; n < 20; ++n) {
    hand.release("reset");
    hand.press("reset");
  }
  hand.press("stop");
  EXPECT_TRUE(hand.asks(RequestKind::stop));
  EXPECT_FALSE(hand.next());
}

TEST(PendantStop, OutlivesThePlugThatIsPulledBehindIt) {
  Hand hand(test::with_selectors());
  hand.press("stop");
  hand.hands.lost();
  EXPECT_TRUE(hand.asks(RequestKind::stop));
}

TEST(PendantStart, IsNotMadeUpForWhenItsButtonHasBeenLetGoMeanwhile) {
  Hand hand(test::with_selectors());
  hand.press("reset");
  ASSERT_TRUE(hand.next());
  const Request waits = hand.request;
  hand.press("start");
  hand.release("start");
  hand.hands.answered(waits, true);
  hand.see();
  EXPECT_FALSE(hand.next());
}

TEST(PendantStart, IsNotMadeUpForWhenTheDeadManHasBeenLetGoMeanwhile) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("fn")});
  hand.press("fn");
  hand.press("reset");
  ASSERT_TRUE(hand.next());
  const Request waits = hand.request;
  hand.press("start");
  hand.release("fn");
  hand.hands.answered(waits, true);
  hand.see();
  EXPECT_FALSE(hand.next());
}

TEST(PendantDeadMan, ThatIsHeldWhenThePendantComesIsNoneUntilItWasReleased) {
  const Layout layout = test::with_selectors();
  Hand hand(layout, {"XYZ", 1.0, layout.button("fn")});
  hand.press("fn");
  hand.hands.lost();
  hand.report();
  hand.turn(3);
  EXPECT_FALSE(hand.next());
  hand.release("fn");
  hand.press("fn");
  hand.turn(3);
  EXPECT_TRUE(hand.asks(RequestKind::jog));
}

TEST(PendantZero, IsOfItsOwnAxesOnly) {
  Hand hand(test::with_selectors(), {"XY", 1.0, -1});
  hand.reading.axis = 2;
  hand.report();
  hand.press("fn");
  hand.press("home");
  EXPECT_FALSE(hand.next());
}

}  // namespace
}  // namespace servogate::pendant
