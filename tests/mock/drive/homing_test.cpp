// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

// A rail of 12 revolutions: limit switches at both ends, a home switch that is either a bump in the middle or
// active from the middle to an end; zero marks at 30 000 + n turns.
constexpr std::int64_t kTurn = 262'144, kMark = 30'000;
constexpr std::int64_t kNegative = -6 * kTurn + 1111, kPositive = 6 * kTurn - 2222;
constexpr std::int64_t kLeft = -100'003, kRight = 400'007;
constexpr std::int64_t kFar = 100 * kTurn;

std::int64_t mark_above(std::int64_t x) {
  std::int64_t m = kMark - 200 * kTurn;
  while (m <= x) m += kTurn;
  return m;
}
std::int64_t mark_below(std::int64_t x) { return mark_above(x) - kTurn; }

struct Expected {
  int method;
  std::int64_t home;  ///< true position
};

SimulatedDriveConfig rail(int method, double start_rev) {
  SimulatedDriveConfig c;
  c.plant.zero_mark_counts = kMark;
  c.plant.start_rev = start_rev;
  c.plant.end_stop_min_rev = -6.5;
  c.plant.end_stop_max_rev = 6.5;
  using Input = DriveSwitch::Input;
  c.switches = {{Input::negative_limit, -kFar, kNegative}, {Input::positive_limit, kPositive, kFar}};
  const int base = method > 16 ? method - 16 : method;
  if (base == 3 || base == 4) c.switches.push_back({Input::home, kLeft, kFar});
  if (base == 5 || base == 6) c.switches.push_back({Input::home, -kFar, kRight});
  if (base >= 7) c.switches.push_back({Input::home, kLeft, kRight});
  return c;
}

std::int64_t expected_edge(int base) {
  switch (base) {
    case 1:
      return kNegative;
    case 2:
      return kPositive;
    case 3:
    case 4:
    case 7:
    case 8:
    case 13:
    case 14:
      return kLeft;
    default:
      return kRight;
  }
}
bool to_positive(int base) {
  return base == 1 || base == 4 || base == 5 || base == 8 || base == 10 || base == 11 || base == 13;
}

std::int64_t expected_home(int method) {
  const bool index = method < 15;
  const int base = index ? method : method - 16;
  const std::int64_t edge = expected_edge(base);
  if (!index) return edge;
  return to_positive(base) ? mark_above(edge) : mark_below(edge);
}

/// To its end, or for so many milliseconds.
void run_homing(DriveBench& b, int method, int most_ms = 30'000) {
  b.write(0x6098, 0, method, 1);
  b.write(0x6099, 1, 4 * kTurn, 4);
  b.write(0x6099, 2, kTurn / 2, 4);
  b.write(0x609A, 0, 50 * kTurn, 4);
  b.write(0x6060, 0, 6, 1);
  b.enable();
  ASSERT_EQ(b.status() & 0x3400, 0x0400) << "not started";
  b.control(0x1F);
  for (int i = 0; i < most_ms && !(b.drive.statusword() & 0x3000); ++i) b.run(1);
}

TEST(DriveHoming, every_method_finds_its_edge_or_mark_from_every_side_of_the_rail) {
  for (int method = 1; method <= 30; ++method) {
    if (method == 15 || method == 16) continue;
    for (const double start : {-4.7, -0.2, 0.8, 3.3}) {
      SCOPED_TRACE(testing::Message() << "method " << method << " from " << start);
      DriveBench b(rail(method, start));
      const std::int64_t offset = b.drive.position_counts();  // 6064h counts from here
      (void)offset;
      run_homing(b, method);
      ASSERT_TRUE(b.drive.statusword() & 0x1000) << "attained";
      ASSERT_FALSE(b.drive.statusword() & 0x2000);
      const std::int64_t home = b.drive.position_counts() - b.drive.reported_position();
      // An edge is taken in the tick after it; a boundary may belong to either side.
      ASSERT_NEAR(static_cast<double>(home), static_cast<double>(expected_home(method)), 1.0);
    }
  }
}

TEST(DriveHoming, methods_33_and_34_take_the_next_mark) {
  for (const int method : {33, 34}) {
    DriveBench b(rail(method, 0.8));
    const std::int64_t from = b.drive.position_counts();
    run_homing(b, method);
    const std::int64_t home = b.drive.position_counts() - b.drive.reported_position();
    EXPECT_EQ(home, method == 33 ? mark_below(from) : mark_above(from));
  }
}

TEST(DriveHoming, methods_35_and_37_take_the_present_position_at_once) {
  for (const int method : {35, 37}) {
    DriveBench b(rail(method, 1.25));
    run_homing(b, method);
    EXPECT_EQ(b.status() & 0x3400, 0x1400);
    EXPECT_EQ(b.read_signed(0x6064), 0);
    EXPECT_EQ(b.drive.position_counts(), 327'680);
  }
}

TEST(DriveHoming, zero_is_home_plus_the_home_offset) {
  DriveBench b(rail(37, 1.25));
  b.write(0x607C, 0, 5000, 4);
  run_homing(b, 37);
  EXPECT_EQ(b.read_signed(0x6064), -5000);
}

TEST(DriveHoming, status_bits_tell_running_attained_and_interrupted) {
  DriveBench b(rail(1, 4.0));
  b.write(0x6098, 0, 1, 1);
  b.write(0x6060, 0, 6, 1);
  b.enable();
  b.control(0x1F, 100);
  EXPECT_EQ(b.status() & 0x3400, 0x0000) << "in progress";
  b.control(0x0F, 500);
  EXPECT_EQ(b.status() & 0x3400, 0x0400) << "interrupted";
  const auto held = b.drive.position_counts();
  b.run(100);
  EXPECT_NEAR(static_cast<double>(b.drive.position_counts() - held), 0.0, 20.0);
}

TEST(DriveHoming, a_home_switch_that_is_nowhere_is_a_homing_error_after_both_limits) {
  SimulatedDriveConfig config = rail(7, 0.5);
  config.switches.pop_back();
  DriveBench b(config);
  run_homing(b, 7);
  b.run(500);
  EXPECT_EQ(b.status() & 0x3400, 0x2400) << "error, at rest";
}

TEST(DriveHoming, goes_on_after_a_halt_and_finds_the_same_home_wherever_it_was_halted) {
  std::mt19937 random(402);
  for (const int method : {1, 2, 3, 6, 8, 11, 17, 18, 19, 22, 24, 27, 33, 34}) {
    for (int round = 0; round < 6; ++round) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", round " << round);
      DriveBench b(rail(method, 0.8));
      run_homing(b, method, 1 + static_cast<int>(random() % 900));
      for (int halts = 0; halts < 3 && !(b.drive.statusword() & 0x3000); ++halts) {
        b.control(0x11F, 400);
        EXPECT_TRUE(b.status() & 0x0400) << "at rest";
        const auto rest = b.drive.position_counts();
        b.run(50);
        ASSERT_NEAR(static_cast<double>(b.drive.position_counts()), static_cast<double>(rest), 50.0);
        b.control(0x1F, 1 + static_cast<int>(random() % 500));
      }
      for (int i = 0; i < 30'000 && !(b.drive.statusword() & 0x3000); ++i) b.run(1);
      ASSERT_TRUE(b.drive.statusword() & 0x1000) << "attained";
      const std::int64_t home = b.drive.position_counts() - b.drive.reported_position();
      if (method < 33)
        ASSERT_NEAR(static_cast<double>(home), static_cast<double>(expected_home(method)), 1.0);
      else
        ASSERT_EQ((home - kMark) % kTurn, 0) << "a zero mark";
    }
  }
}

TEST(DriveHoming, whose_start_bit_is_taken_away_in_a_halt_does_not_go_on) {
  DriveBench b(rail(1, 2.0));
  run_homing(b, 17, 200);
  b.control(0x11F, 400);
  b.control(0x10F, 10);
  b.control(0x0F, 10);
  const auto rest = b.drive.position_counts();
  b.run(500);
  EXPECT_NEAR(static_cast<double>(b.drive.position_counts()), static_cast<double>(rest), 50.0);
  EXPECT_EQ(b.status() & 0x3400, 0x0400);
  // A start in a halt waits for its end.
  b.control(0x10F, 10);
  b.control(0x11F, 300);
  EXPECT_NEAR(static_cast<double>(b.drive.position_counts()), static_cast<double>(rest), 50.0);
  b.control(0x1F);
  for (int i = 0; i < 30'000 && !(b.drive.statusword() & 0x3000); ++i) b.run(1);
  EXPECT_TRUE(b.drive.statusword() & 0x1000);
}

TEST(DriveHoming, homing_is_cancelled_by_a_fault_and_can_be_repeated) {
  DriveBench b(rail(1, 2.0));
  b.write(0x6098, 0, 17, 1);
  b.write(0x6060, 0, 6, 1);
  b.enable();
  b.control(0x1F, 100);
  b.drive.inject({.kind = fault::Kind::over_current});
  b.run(500);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault);
  b.control(0x80);
  run_homing(b, 17);
  EXPECT_TRUE(b.drive.statusword() & 0x1000);
}

}  // namespace
}  // namespace servogate::mock
