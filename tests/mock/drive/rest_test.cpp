// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "drivers/mock/drive/drive_rest.hpp"
#include "tests/mock/drive/drive_bench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

struct Counted {
  int value = 0;
};

TEST(DriveRestState, is_sure_only_behind_a_tick_that_changed_nothing) {
  Counted state;
  DriveRest rest({DriveRest::part(state)});
  EXPECT_FALSE(rest.before_tick());
  ++state.value;
  rest.after_tick(true);
  EXPECT_FALSE(rest.sure());
  EXPECT_FALSE(rest.before_tick());
  rest.after_tick(true);
  EXPECT_TRUE(rest.sure());
}

TEST(DriveRestState, is_sure_again_without_a_tick_when_nothing_has_come) {
  Counted state;
  DriveRest rest({DriveRest::part(state)});
  rest.before_tick();
  rest.after_tick(true);
  rest.doubt();
  EXPECT_FALSE(rest.sure());
  EXPECT_TRUE(rest.before_tick());
  EXPECT_TRUE(rest.sure());
}

TEST(DriveRestState, what_comes_from_outside_ends_it) {
  Counted state;
  DriveRest rest({DriveRest::part(state)});
  rest.before_tick();
  rest.after_tick(true);
  rest.doubt();
  state.value = 1;
  EXPECT_FALSE(rest.before_tick());
  EXPECT_FALSE(rest.sure());
}

TEST(DriveRestState, what_is_not_in_its_bytes_ends_it_too) {
  Counted state;
  DriveRest rest({DriveRest::part(state)});
  rest.before_tick();
  rest.after_tick(false);
  EXPECT_FALSE(rest.sure());
  EXPECT_FALSE(rest.before_tick());
}

TEST(DriveRestState, after_a_motion_it_proves_anew_what_it_had_proved) {
  Counted state;
  DriveRest rest({DriveRest::part(state)});
  rest.before_tick();
  rest.after_tick(true);
  rest.forget();
  EXPECT_FALSE(rest.sure());
  EXPECT_FALSE(rest.before_tick());
}

/// Two drives under the same hands: one that leaves out ticks at rest, and one that a fault which does
/// nothing keeps from it.
class Pair {
 public:
  explicit Pair(const SimulatedDriveConfig& config) : resting_(config), ticking_(config) {
    ticking_.drive.inject({.kind = fault::Kind::sdo_late});
  }
  template <typename F>
  void both(F f) {
    f(resting_);
    f(ticking_);
  }
  void compare() {
    ASSERT_EQ(resting_.seen.size(), ticking_.seen.size());
    for (std::size_t i = 0; i < resting_.seen.size(); ++i) {
      const CanFrame &a = resting_.seen[i], &b = ticking_.seen[i];
      ASSERT_EQ(a.id, b.id);
      ASSERT_EQ(a.data, b.data);
      ASSERT_EQ(a.timestamp_ns, b.timestamp_ns);
    }
    both([](DriveBench& b) { b.seen.clear(); });
    ASSERT_EQ(resting_.drive.revolutions(), ticking_.drive.revolutions());
    ASSERT_EQ(resting_.drive.velocity_counts_s(), ticking_.drive.velocity_counts_s());
    ASSERT_EQ(resting_.drive.torque_permille(), ticking_.drive.torque_permille());
    ASSERT_EQ(resting_.drive.thermal(), ticking_.drive.thermal());
    ASSERT_EQ(resting_.drive.statusword(), ticking_.drive.statusword());
    ASSERT_EQ(resting_.drive.brake_released(), ticking_.drive.brake_released());
  }

 private:
  DriveBench resting_, ticking_;
};

SimulatedDriveConfig any_drive(std::mt19937_64& random) {
  SimulatedDriveConfig c;
  const auto one_in = [&](unsigned n) { return random() % n == 0; };
  if (one_in(3)) c.plant.brake_torque_nm = 5.0;
  if (one_in(3)) c.plant.load_torque_nm = 0.8;
  if (one_in(4)) c.plant.stribeck_friction_nm = 0.1;
  if (one_in(6)) c.plant.thermal_time_s = 0.5;
  if (one_in(6)) c.plant.encoder_noise_counts = 2.0;
  if (one_in(6)) c.plant.torque_noise_nm = 0.01;
  if (one_in(6)) c.plant.cogging_nm = 0.05;
  if (one_in(5)) {
    c.plant.dip_torque_nm = 0.3;
    c.plant.dip_period_s = 0.05;
    c.plant.dip_time_s = 0.01;
  }
  if (one_in(4)) {
    c.plant.load_inertia_kg_m2 = 1.0e-3;
    c.plant.stiffness_nm_rad = 500.0;
    if (one_in(2)) c.plant.backlash_rad = 0.001;
  }
  if (one_in(3))
    c.switches = {{.input = DriveSwitch::Input::home, .from = -500, .to = 500},
                  {.input = DriveSwitch::Input::positive_limit, .from = 6000, .to = 1'000'000}};
  return c;
}

/// Something that a master, a machine or a fault does.
void disturb(Pair& pair, std::mt19937_64& random, std::int32_t& target, std::uint16_t& word) {
  const auto upto = [&](std::int64_t n) { return static_cast<std::int64_t>(random() % (n + 1)); };
  const auto write = [&](std::uint16_t index, std::uint8_t sub, std::int64_t value, int size) {
    pair.both([&](DriveBench& b) { b.write(index, sub, value, size); });
  };
  constexpr std::uint16_t kWords[] = {0x06, 0x07, 0x0F, 0x0F, 0x0F, 0x0B, 0x10F, 0x80, 0x1F};
  constexpr std::int64_t kModes[] = {8, 8, 8, 3, 1, 9, 10, 6, 2};
  switch (random() % 18) {
    case 0:
    case 1:
      target += static_cast<std::int32_t>(upto(40) - 20);
      return;
    case 2:
      target += static_cast<std::int32_t>(upto(8000) - 4000);
      return;
    case 3:
    case 4:
      word = kWords[random() % std::size(kWords)];
      return;
    case 5:
      return write(0x6060, 0, kModes[random() % std::size(kModes)], 1);
    case 6:
      return write(0x60FF, 0, random() % 2 ? 0 : upto(40'000) - 20'000, 4);
    case 7:
      return write(0x60B0, 0, upto(10), 4);
    case 8:
      return write(0x607D, 2, random() % 2 ? target - upto(20) : 0x7FFF'FFFF, 4);
    case 9:
      return write(0x606E, 0, upto(60), 2);
    case 10:
      return write(0x60F9, 1, 400'000 + upto(400'000), 4);
    case 11:
      return write(0x60B8, 0, upto(0x17), 2);
    case 12: {
      const double nm = 0.1 * static_cast<double>(upto(10));
      return pair.both([&](DriveBench& b) { b.drive.set_load_torque(nm); });
    }
    case 13: {
      const auto input = static_cast<DriveSwitch::Input>(upto(4));
      const bool on = random() % 2;
      return pair.both([&](DriveBench& b) { b.drive.set_input(input, on); });
    }
    case 14: {
      const bool on = random() % 3 != 0;
      return pair.both([&](DriveBench& b) { b.drive.set_safe_torque_off(on); });
    }
    case 15:
      return pair.both(
          [&](DriveBench& b) { b.drive.inject({.kind = fault::Kind::encoder_jump, .value = 3}); });
    case 16: {
      const int ms = static_cast<int>(upto(20));
      return pair.both([&](DriveBench& b) { b.run(ms); });
    }
    default:
      return write(0x6071, 0, upto(100) - 50, 2);
  }
}

TEST(DriveRest, a_drive_that_leaves_out_ticks_is_to_the_bit_one_that_does_not) {
  const std::uint64_t first = servogate::test::property_seed();
  for (std::uint64_t seed = first; seed < first + 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Pair pair(any_drive(random));
    pair.both([](DriveBench& b) {
      b.start_cyclic_position();
      for (const int word : {0x06, 0x07, 0x0F})
        for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
    });
    std::int32_t target = 0;
    std::uint16_t word = 0x0F;
    for (int step = 0; step < 40; ++step) {
      disturb(pair, random, target, word);
      for (auto cycles = static_cast<int>(random() % 80); cycles > 0; --cycles) {
        pair.both([&](DriveBench& b) { b.cycle(word, target); });
        ASSERT_NO_FATAL_FAILURE(pair.compare());
      }
    }
  }
}

}  // namespace
}  // namespace servogate::mock
