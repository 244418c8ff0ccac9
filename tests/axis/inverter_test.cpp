// SPDX-License-Identifier: Apache-2.0
// A spindle on an inverter: speed as a word, direction as two relays, nothing coming back.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::axis {
namespace {

using image::Format;
using image::Packet;

constexpr image::Place kSpeed{Packet::a, Format::in, 24, 1};
constexpr image::Place kCw{Packet::a, Format::bl, 73, 1};
constexpr image::Place kCcw{Packet::a, Format::bl, 74, 1};

class InverterRig {
 public:
  explicit InverterRig(bool relays = true) {
    SpindleConfig c;
    c.encoder = false;
    c.max_rpm = 3000.0;
    c.min_rpm = 100.0;
    c.inverter = InverterConfig{kSpeed, {}, {}, 1u << 2};
    if (relays) c.inverter->cw = kCw, c.inverter->ccw = kCcw;
    spindle.configure(c, 0);
    set("enable", true);
    power_on(true);
  }
  void set(std::string_view name, double value) {
    for (const auto& f : image::kSpindleFields)
      if (f.name == name) {
        const std::uint32_t byte = image::spindle_base(0) + f.byte;
        image.packets.set_number(
            {Packet::k, f.format,
             f.format == Format::bl ? byte * 8 + f.bit : byte / image::format_size(f.format), 1},
            value);
      }
  }
  void power_on(bool on) {
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), on);
  }
  void run(int cycles) {
    while (cycles-- > 0) {
      spindle.read(image);
      if (order_next) spindle.order(*order_next, rpm_next);
      order_next.reset();
      spindle.react(reaction);
      spindle.command(image);
      for (const Event& e : spindle.events()) events.push_back(e.number);
      both = both || (cw() && ccw());
      if ((cw() || ccw()) && (was_cw || was_ccw)) swapped_at_once = swapped_at_once || cw() != was_cw;
      steepest = std::max(steepest, std::abs(speed() - last_speed));
      was_cw = cw(), was_ccw = ccw(), last_speed = speed();
    }
  }
  void order(SpindleMode mode, double rpm) { order_next = mode, rpm_next = rpm; }
  double speed() const { return image.packets.number(kSpeed); }
  bool cw() const { return image.packets.bit(kCw); }
  bool ccw() const { return image.packets.bit(kCcw); }
  bool off() const { return speed() == 0.0 && !cw() && !ccw(); }

  image::ProcessImage image;
  Spindle spindle;
  image::Reaction reaction = image::Reaction::none;
  std::optional<SpindleMode> order_next;
  double rpm_next = 0.0;
  std::vector<image::AlarmNumber> events;
  bool both = false, swapped_at_once = false, was_cw = false, was_ccw = false;
  double steepest = 0.0, last_speed = 0.0;
};

TEST(Inverter, that_the_plc_does_not_enable_is_not_missed_at_its_speed) {
  InverterRig rig;
  rig.set("enable", false);
  rig.order(SpindleMode::cw, 600.0);
  rig.run(11'000);
  EXPECT_TRUE(rig.events.empty()) << "a door may stand open for long";
  rig.set("enable", true);
  rig.run(2'000);
  EXPECT_EQ(rig.speed(), 600.0);
  EXPECT_TRUE(rig.events.empty());
}

TEST(Inverter, ramps_the_speed_with_the_relay_of_its_direction_on_and_is_at_speed_by_the_command) {
  InverterRig rig;
  rig.run(10);
  EXPECT_TRUE(rig.off());
  rig.order(SpindleMode::cw, 1500.0);
  rig.run(400);
  EXPECT_TRUE(rig.cw());
  EXPECT_FALSE(rig.ccw());
  EXPECT_NEAR(rig.speed(), 1200.0, 5.0);
  EXPECT_FALSE(rig.spindle.at_speed());
  rig.run(150);
  EXPECT_EQ(rig.speed(), 1500.0);
  EXPECT_TRUE(rig.spindle.at_speed());
  EXPECT_TRUE(rig.spindle.settled());
  EXPECT_LE(rig.steepest, 3.0 + 0.5) << "3000 rpm/s, rounded to whole rpm";
  EXPECT_EQ(rig.image.spindles[0].actual_rpm, 1500.0);
  rig.order(SpindleMode::stop, 0.0);
  rig.run(300);
  EXPECT_TRUE(rig.cw()) << "it brakes along its ramp";
  EXPECT_FALSE(rig.spindle.zero_speed());
  rig.run(300);
  EXPECT_TRUE(rig.off());
  EXPECT_TRUE(rig.spindle.settled());
  EXPECT_TRUE(rig.events.empty());
}

TEST(Inverter, changes_the_relay_only_at_standstill_and_never_holds_both) {
  InverterRig rig;
  rig.order(SpindleMode::cw, 600.0);
  rig.run(300);
  rig.order(SpindleMode::ccw, 900.0);
  rig.run(100);
  EXPECT_TRUE(rig.cw());
  rig.run(110);
  EXPECT_TRUE(rig.off()) << "the relays have a pause between them";
  rig.run(500);
  EXPECT_TRUE(rig.ccw());
  EXPECT_EQ(rig.speed(), 900.0) << "the direction is the relay's, the word has no sign";
  EXPECT_EQ(rig.image.spindles[0].command_rpm, -900.0);
  EXPECT_TRUE(rig.spindle.at_speed());
  EXPECT_FALSE(rig.both);
  EXPECT_FALSE(rig.swapped_at_once);
}

TEST(Inverter, keeps_minimum_and_maximum_under_the_override) {
  InverterRig rig;
  rig.set("override", 50);
  rig.order(SpindleMode::cw, 150.0);
  rig.run(500);
  EXPECT_EQ(rig.speed(), 100.0);
  rig.set("override", 125);
  rig.order(SpindleMode::cw, 2900.0);
  rig.run(1500);
  EXPECT_EQ(rig.speed(), 3000.0);
  rig.set("override", 100);
  rig.order(SpindleMode::cw, 0.0);
  rig.run(2000);
  EXPECT_TRUE(rig.off()) << "S0 is no speed below the minimum";
}

TEST(Inverter, drops_speed_and_relays_at_once_when_the_machine_lets_go_and_stays_off) {
  const auto let_go = [](int how, InverterRig& rig, bool back) {
    if (how == 0) rig.reaction = back ? image::Reaction::none : image::Reaction::quick_stop;
    if (how == 1) rig.reaction = back ? image::Reaction::none : image::Reaction::power_off;
    if (how == 2) rig.power_on(back);
    if (how == 3) rig.image.sources[2].quality = back ? image::Quality::good : image::Quality::stale;
  };
  for (int how = 0; how < 4; ++how) {
    InverterRig rig;
    rig.order(SpindleMode::ccw, 1500.0);
    rig.run(800);
    ASSERT_TRUE(rig.ccw());
    let_go(how, rig, false);
    rig.run(1);
    EXPECT_TRUE(rig.off()) << how;
    EXPECT_FALSE(rig.spindle.zero_speed()) << "it coasts: standstill is not before its ramp would have ended";
    rig.run(480);
    EXPECT_FALSE(rig.spindle.zero_speed()) << how;
    rig.run(40);
    EXPECT_TRUE(rig.spindle.zero_speed()) << how;
    let_go(how, rig, true);
    rig.run(2000);
    EXPECT_TRUE(rig.off()) << "nothing turns again unasked: " << how;
    EXPECT_EQ(rig.events, how == 3 ? std::vector<image::AlarmNumber>{alarm::kSpindleOutputLost}
                                   : std::vector<image::AlarmNumber>{});
    rig.order(SpindleMode::cw, 500.0);
    rig.run(1000);
    EXPECT_EQ(rig.speed(), 500.0) << how;
  }
}

TEST(Inverter, ramps_down_without_the_enable_of_the_plc_and_up_again_with_it) {
  InverterRig rig;
  rig.order(SpindleMode::cw, 600.0);
  rig.run(300);
  rig.set("enable", false);
  rig.run(100);
  EXPECT_TRUE(rig.cw());
  EXPECT_NEAR(rig.speed(), 300.0, 5.0);
  rig.run(200);
  EXPECT_TRUE(rig.off());
  EXPECT_FALSE(rig.spindle.at_speed());
  rig.set("enable", true);
  rig.run(400);
  EXPECT_TRUE(rig.spindle.at_speed());
}

TEST(Inverter, says_what_it_cannot_do_and_stops) {
  InverterRig rig;
  rig.order(SpindleMode::cw, 600.0);
  rig.run(300);
  rig.order(SpindleMode::orient, 0.0);
  rig.run(300);
  EXPECT_EQ(rig.events, std::vector<image::AlarmNumber>{alarm::kSpindleNoEncoder});
  EXPECT_TRUE(rig.off());

  InverterRig bare(false);
  bare.order(SpindleMode::cw, 600.0);
  bare.run(300);
  EXPECT_EQ(bare.speed(), 600.0) << "without relays the speed alone turns it";
  bare.order(SpindleMode::ccw, 600.0);
  bare.run(300);
  EXPECT_EQ(bare.events, std::vector<image::AlarmNumber>{alarm::kSpindleNoReverse});
  EXPECT_EQ(bare.speed(), 0.0);
}

}  // namespace
}  // namespace servogate::axis
