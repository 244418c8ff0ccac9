// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "drivers/mock/gpio/mock_gpio.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

using image::kMillisecond;
using image::Nanoseconds;

image::Place place(const char* text) { return *image::parse_place(text); }

GpioInput input(const char* name, InputSource source, const char* at, bool inverted = false,
                Bounce bounce = {}) {
  image::PointRule rule;
  rule.place = place(at);
  rule.inverted = inverted;
  return {name, source, rule, bounce};
}

GpioOutput output(const char* name, const char* at, bool inverted = false) {
  return {name, input(name, SetInput{}, at, inverted).rule};
}

struct Slide {
  double mm = 0.0;
  AxisPosition position() {
    return [this](int axis) { return axis == 0 ? mm : 0.0; };
  }
};

void cycle(MockGpio& chip, image::ProcessImage& image, Nanoseconds t) {
  chip.advance_to(t);
  image.now.t_ns = t;
  image::Notices notices;
  image.edges.clear();
  chip.receive(image, notices);
  chip.send(image);
}

TEST(MockGpio, a_limit_switch_is_on_at_its_place_and_beyond) {
  Slide slide;
  MockGpio chip({input("plus", LimitSwitch{0, 305.0, true}, "SA0"),
                 input("minus", LimitSwitch{0, -305.0, false}, "SA1")},
                {}, slide.position());
  image::ProcessImage image;
  const auto at = [&](double mm) {
    slide.mm = mm;
    static Nanoseconds t = 0;
    cycle(chip, image, t += kMillisecond);
    return std::pair(image.packets.bit(place("SA0")), image.packets.bit(place("SA1")));
  };
  EXPECT_EQ(at(0.0), std::pair(false, false));
  EXPECT_EQ(at(304.999), std::pair(false, false));
  EXPECT_EQ(at(305.0), std::pair(true, false));
  EXPECT_EQ(at(1000.0), std::pair(true, false));
  EXPECT_EQ(at(-305.0), std::pair(false, true));
  EXPECT_EQ(at(-304.0), std::pair(false, false));
}

TEST(MockGpio, tells_when_between_two_steps_a_switch_was_passed) {
  Slide slide;
  MockGpio chip(
      {input("plus", LimitSwitch{0, 10.0, true}, "SA0"), input("home", HomeSwitch{0, 30.0, 5.0}, "SA1")}, {},
      slide.position());
  image::ProcessImage image;
  std::vector<image::Edge> edges;
  for (int n = 0; n <= 20; ++n) {
    slide.mm = 4.0 * n;
    cycle(chip, image, n * kMillisecond);
    for (const image::Edge& e : image.edges.list()) edges.push_back(e);
  }
  ASSERT_EQ(edges.size(), 3u);
  EXPECT_EQ(edges[0].t_ns, 2'500'000) << "10 mm at 4 mm a step";
  EXPECT_EQ(edges[1].t_ns, 7'500'000);
  EXPECT_TRUE(edges[1].level);
  EXPECT_EQ(edges[2].t_ns, 8'750'000);
  EXPECT_FALSE(edges[2].level);
}

TEST(MockGpio, shows_the_counts_of_an_encoder_and_keeps_them_while_it_is_unplugged) {
  GpioInput wheel = input("wheel", SetCounts{}, "SA40.LI");
  wheel.rule.digital = false;
  wheel.rule.hold = true;
  MockGpio chip({wheel}, {});
  image::ProcessImage image;
  chip.set_counts(0, -123'456);
  cycle(chip, image, kMillisecond);
  EXPECT_EQ(image.packets.number(place("SA40.LI")), -123'456.0);
  chip.plug(false);
  cycle(chip, image, 2 * kMillisecond);
  EXPECT_EQ(image.packets.number(place("SA40.LI")), -123'456.0);
}

TEST(MockGpio, a_home_switch_is_on_over_its_width_only) {
  Slide slide;
  MockGpio chip({input("home", HomeSwitch{0, -10.0, 8.0}, "SA2")}, {}, slide.position());
  for (double mm = -20.0; mm < 10.0; mm += 0.25) {
    slide.mm = mm;
    chip.advance_to(static_cast<Nanoseconds>((mm + 20.0) * 1e6));
    ASSERT_EQ(chip.input(0), mm >= -10.0 && mm <= -2.0) << mm;
  }
  EXPECT_EQ(chip.edges(0), 2u);
}

TEST(MockGpio, a_normally_closed_switch_opens_its_contact_and_its_inverted_place_reads_true_when_pressed) {
  Slide slide;
  MockGpio chip({input("plus", LimitSwitch{0, 100.0, true}, "SA0", true)}, {}, slide.position());
  image::ProcessImage image;
  cycle(chip, image, 0);
  EXPECT_TRUE(chip.input(0));
  EXPECT_FALSE(image.packets.bit(place("SA0")));
  slide.mm = 101.0;
  cycle(chip, image, kMillisecond);
  EXPECT_FALSE(chip.input(0));
  EXPECT_TRUE(image.packets.bit(place("SA0")));
}

TEST(MockGpio, a_bouncing_contact_flickers_and_then_settles_within_its_time) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  int flickered = 0;
  for (int i = 0; i < 300; ++i) {
    const auto time = static_cast<Nanoseconds>(1 + random() % 10'000'000);
    MockGpio chip({input("door", SetInput{}, "SA0", false, {time, random()})}, {});
    chip.advance_to(0);
    chip.set_input(0, true);
    Nanoseconds t = kMillisecond;
    for (; t <= kMillisecond + time; t += 50'000) chip.advance_to(t);
    for (const Nanoseconds end = t + 5 * kMillisecond; t < end; t += 50'000) {
      chip.advance_to(t);
      ASSERT_TRUE(chip.input(0)) << "bounce of " << time << " ns";
    }
    ASSERT_EQ(chip.edges(0) % 2, 1u);
    flickered += chip.edges(0) > 1;
  }
  EXPECT_EQ(flickered, 300);
}

TEST(MockGpio, bounces_alike_from_the_same_seed) {
  const auto levels = [](std::uint64_t seed) {
    MockGpio chip({input("door", SetInput{}, "SA0", false, {5 * kMillisecond, seed})}, {});
    chip.advance_to(0);
    chip.set_input(0, true);
    std::string out;
    for (Nanoseconds t = 0; t < 6 * kMillisecond; t += 100'000) {
      chip.advance_to(t);
      out += chip.input(0) ? '1' : '0';
    }
    return out;
  };
  EXPECT_EQ(levels(7), levels(7));
  EXPECT_NE(levels(7), levels(8));
}

TEST(MockGpio, counts_one_edge_for_each_clean_change) {
  MockGpio chip({input("button", SetInput{true}, "SA0")}, {});
  for (int i = 0; i < 100; ++i) {
    chip.advance_to(i * kMillisecond);
    chip.set_input(0, i % 2 == 1);
  }
  EXPECT_EQ(chip.edges(0), 99u);
}

TEST(MockGpio, a_stuck_contact_stays_where_it_is_held_until_released) {
  Slide slide;
  MockGpio chip({input("plus", LimitSwitch{0, 100.0, true}, "SA0")}, {}, slide.position());
  chip.advance_to(0);
  chip.force_input(0, false);
  slide.mm = 200.0;
  chip.advance_to(kMillisecond);
  EXPECT_FALSE(chip.input(0));
  chip.release_input(0);
  chip.advance_to(2 * kMillisecond);
  EXPECT_TRUE(chip.input(0));
  EXPECT_FALSE(chip.set_input(0, false)) << "a switch that follows an axis is not an operator's";
}

TEST(MockGpio, drives_outputs_from_packet_A_and_counts_their_edges) {
  MockGpio chip({}, {output("lamp", "SA16"), output("enable", "SA17", true)});
  image::ProcessImage image;
  EXPECT_FALSE(chip.output(0));
  EXPECT_TRUE(chip.output(1)) << "an inverted output rests high";
  image.packets.set_bit(place("SA16"), true);
  image.packets.set_bit(place("SA17"), true);
  cycle(chip, image, 0);
  cycle(chip, image, kMillisecond);
  EXPECT_TRUE(chip.output(0));
  EXPECT_FALSE(chip.output(1));
  EXPECT_EQ(chip.output_edges(0), 1u);
  EXPECT_EQ(chip.output_index("enable"), 1);
  EXPECT_EQ(chip.output_index("nothing"), -1);
}

TEST(MockGpio, an_unplugged_chip_says_so_and_its_inputs_have_their_values_of_loss) {
  GpioInput door = input("door", SetInput{true}, "SA0"), air = input("air", SetInput{true}, "SA1"),
            kept = input("kept", SetInput{true}, "SA2"), brake = input("brake", SetInput{false}, "SA3");
  kept.rule.hold = true;
  brake.rule.loss = 1.0;
  air.rule.debounce_ns = kMillisecond * 50;
  MockGpio chip({door, air, kept, brake}, {}, {}, 3);
  image::ProcessImage image;
  for (int ms = 0; ms < 60; ++ms) cycle(chip, image, ms * kMillisecond);
  EXPECT_EQ(image.sources[3].quality, image::Quality::good);
  EXPECT_EQ(image.sources[3].updated_ns, 59 * kMillisecond);
  const auto inputs = [&] {
    std::string levels;
    for (const char* at : {"SA0", "SA1", "SA2", "SA3"}) levels += image.packets.bit(place(at)) ? '1' : '0';
    return levels;
  };
  EXPECT_EQ(inputs(), "1110");
  chip.plug(false);
  cycle(chip, image, 60 * kMillisecond);
  EXPECT_EQ(image.sources[3].quality, image::Quality::bad);
  EXPECT_EQ(image.sources[3].updated_ns, 59 * kMillisecond);
  EXPECT_EQ(image.sources[3].errors, 1u);
  EXPECT_EQ(inputs(), "0011") << "at once, debounced ones too";
  chip.plug(true);
  cycle(chip, image, 61 * kMillisecond);
  EXPECT_EQ(image.sources[3].quality, image::Quality::good);
  EXPECT_EQ(inputs(), "1010") << "what comes back has to last again";
}

TEST(MockGpio, that_was_never_plugged_in_is_missed) {
  MockGpio chip({input("door", SetInput{true}, "SA0")}, {}, {}, 3);
  chip.plug(false);
  image::ProcessImage image;
  for (int ms = 0; ms < 90; ++ms) cycle(chip, image, ms * kMillisecond);
  EXPECT_EQ(image.sources[3].quality, image::Quality::never);
  for (int ms = 90; ms < 120; ++ms) cycle(chip, image, ms * kMillisecond);
  EXPECT_EQ(image.sources[3].quality, image::Quality::bad);
}

TEST(MockGpio, tells_each_edge_of_a_bouncing_contact_with_its_time) {
  GpioInput door = input("door", SetInput{}, "SA5", true, {4 * kMillisecond, 7});
  door.rule.debounce_ns = 20 * kMillisecond;
  MockGpio chip({door}, {});
  image::ProcessImage image;
  cycle(chip, image, 0);
  EXPECT_TRUE(image.edges.list().empty()) << "the first level is no edge";
  chip.set_input(0, true);
  Nanoseconds last = 0;
  std::uint64_t edges = 0;
  bool level = true;  // inverted: the open contact is TRUE
  for (int ms = 1; ms <= 10; ++ms) {
    cycle(chip, image, ms * kMillisecond);
    for (const image::Edge& e : image.edges.list()) {
      EXPECT_EQ(e.place, place("SA5"));
      EXPECT_EQ(e.level, level = !level);
      EXPECT_GE(e.t_ns, last);
      EXPECT_LE(e.t_ns, ms * kMillisecond);
      last = e.t_ns;
      ++edges;
    }
  }
  EXPECT_EQ(edges, chip.edges(0));
  EXPECT_GT(edges, 1u);
  EXPECT_EQ(image.edges.lost(), 0u);
  EXPECT_NE(last % kMillisecond, 0) << "finer than the cycle";
  EXPECT_TRUE(image.packets.bit(place("SA5"))) << "while packet A waits for the debouncing";
}

}  // namespace
}  // namespace servogate::mock
