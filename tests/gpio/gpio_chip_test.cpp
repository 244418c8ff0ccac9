// SPDX-License-Identifier: Apache-2.0
// A GPIO chip in the cycle, on the kernel's simulated chip: levels from outside by sysfs, outputs read back
// there and by the gpiod tools.
#include "drivers/gpio/gpio_chip.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/counting/allocations.hpp"
#include "tests/gpio/simulated_chip.hpp"

namespace servogate::gpio {
namespace {

using image::Quality;

TEST_F(ChipOfTheKernel, shows_all_inputs_in_the_cycle_in_which_they_are_read) {
  pull(3, false);
  pull(7, true);
  const auto chip = open({{"plus", 3, rule("SA0", true)}, {"closed", 7, rule("SA1", true, true)}});
  ASSERT_NE(chip, nullptr) << why_.str();
  cycle(*chip);
  EXPECT_FALSE(bit("SA0"));
  EXPECT_FALSE(bit("SA1")) << "inverted";
  EXPECT_EQ(image_->sources[0].quality, Quality::good);
  pull(3, true);
  pull(7, false);
  cycle(*chip);
  EXPECT_TRUE(bit("SA0"));
  EXPECT_TRUE(bit("SA1"));
}

TEST_F(ChipOfTheKernel, drives_outputs_from_their_values_of_loss_on) {
  image::PointRule lamp = rule("SA64", false), held = rule("SA65", false, true);
  held.loss = 1.0;
  {
    const auto chip = open({{"lamp", 10, lamp}, {"valve", 11, held}});
    ASSERT_NE(chip, nullptr) << why_.str();
    EXPECT_FALSE(level(10));
    EXPECT_TRUE(level(11)) << "its value of loss, before anybody commands it";
    set("SA64", true);
    set("SA65", true);
    cycle(*chip);
    EXPECT_TRUE(level(10));
    EXPECT_FALSE(level(11)) << "inverted";
    set("SA64", false);
    cycle(*chip);
    EXPECT_FALSE(level(10));
    EXPECT_NE(output_of("gpioinfo " + chip_).find("servogate test"), std::string::npos)
        << "its holder, for others";
  }
  EXPECT_FALSE(level(10)) << "a line that nobody holds goes back to what pulls it";
}

TEST_F(ChipOfTheKernel, is_found_by_its_label_too) {
  const std::string said = output_of("gpiodetect");
  const std::size_t at = said.find(chip_ + " ["), end = said.find(']', at);
  ASSERT_NE(at, std::string::npos) << said;
  chip_ = said.substr(at + chip_.size() + 2, end - at - chip_.size() - 2);
  EXPECT_NE(open({{"plus", 3, rule("SA0", true)}}), nullptr) << why_.str();
}

TEST_F(ChipOfTheKernel, names_the_holder_of_a_line_that_another_program_has) {
  FILE* other = popen(("exec gpiomon --silent " + chip_ + " 5").c_str(), "r");
  ASSERT_NE(other, nullptr);
  std::string said;
  for (int n = 0; n < 1000 && said.find("gpiomon") == std::string::npos; ++n)
    said = output_of("gpioinfo " + chip_);
  EXPECT_EQ(open({{"home", 5, rule("SA0", true)}}), nullptr);
  EXPECT_NE(why_.str(text::Language::english).find("'home': line 5"), std::string::npos) << why_.str();
  EXPECT_NE(why_.str(text::Language::english).find("held by 'gpiomon'"), std::string::npos) << why_.str();
  output_of("pkill gpiomon || killall gpiomon || busybox killall gpiomon");
  pclose(other);
}

TEST_F(ChipOfTheKernel, reads_lines_of_every_bias_together_and_sets_their_resistors) {
  Line up{"up", 16, rule("SA0", true)}, down{"down", 17, rule("SA1", true)},
      off{"off", 18, rule("SA2", true)};
  up.bias = Bias::up;
  down.bias = Bias::down;
  off.bias = Bias::off;
  const auto chip = open({up, down, off, {"as it is", 19, rule("SA3", true)}});
  ASSERT_NE(chip, nullptr) << why_.str();
  cycle(*chip);
  EXPECT_TRUE(bit("SA0")) << "nothing but its resistor is at the line";
  EXPECT_FALSE(bit("SA1"));
  pull(16, false);
  pull(17, true);
  cycle(*chip);
  EXPECT_FALSE(bit("SA0"));
  EXPECT_TRUE(bit("SA1"));
}

TEST_F(ChipOfTheKernel, sets_one_bias_of_all_its_lines_by_the_library) {
  Line line{"up", 16, rule("SA0", true)};
  line.bias = Bias::up;
  const auto chip = open({line});
  ASSERT_NE(chip, nullptr) << why_.str();
  cycle(*chip);
  EXPECT_TRUE(bit("SA0"));
}

TEST_F(ChipOfTheKernel, that_vanishes_gives_its_values_of_loss_and_keeps_the_counts_of_its_encoder) {
  const std::string lab = "/sys/kernel/config/gpio-sim/vanishing";
  output_of("mkdir -p " + lab + "/bank0 && echo 8 > " + lab + "/bank0/num_lines && echo 1 > " + lab +
            "/live");
  std::ifstream(lab + "/bank0/chip_name") >> chip_;
  std::string device;
  std::ifstream(lab + "/dev_name") >> device;
  sysfs_ = "/sys/devices/platform/" + device + "/" + chip_;
  image::PointRule limit = rule("SA0", true, true);
  limit.loss = 1.0;
  Line wheel{"wheel", 2, counts("SA40.LI")};
  wheel.b_offset = 3;
  const auto chip = open({{"limit", 1, limit}, wheel});
  ASSERT_NE(chip, nullptr) << why_.str();
  pull(1, true);
  pull(2, true);
  for (int n = 0; n < 1'000'000 && number("SA40.LI") != 1.0; ++n) cycle(*chip);
  EXPECT_FALSE(bit("SA0"));
  EXPECT_EQ(image_->sources[0].quality, Quality::good);
  output_of("echo 0 > " + lab + "/live");
  cycle(*chip);
  EXPECT_TRUE(bit("SA0")) << "on the limit, as far as anybody can tell";
  EXPECT_EQ(number("SA40.LI"), 1.0);
  EXPECT_EQ(image_->sources[0].quality, Quality::bad);
  output_of("rmdir " + lab + "/bank0 " + lab);
}

TEST_F(ChipOfTheKernel, has_no_line_behind_its_last) {
  EXPECT_EQ(open({{"far", 900, rule("SA0", true)}}), nullptr);
  EXPECT_NE(why_.str(text::Language::english).find("has no line 900; its lines are 0 to 31"),
            std::string::npos)
      << why_.str();
}

TEST_F(ChipOfTheKernel, allocates_nothing_in_the_cycle) {
  const auto chip = open({{"plus", 3, rule("SA0", true)}, {"lamp", 10, rule("SA64", false)}});
  ASSERT_NE(chip, nullptr) << why_.str();
  cycle(*chip);
  const auto before = counting::allocations();
  for (int n = 0; n < 100; ++n) {
    set("SA64", n % 2 == 0);
    cycle(*chip);
  }
  EXPECT_EQ(counting::allocations(), before);
}

TEST(GpioChip, that_is_not_there_is_said_with_those_that_are) {
  drivers::Notice why;
  EXPECT_EQ(GpioChip::open({"no-such-chip", "servogate", {}, -1}, why), nullptr);
  ASSERT_NE(why.entry, nullptr);
  EXPECT_NE(why.str(text::Language::english).find("no-such-chip"), std::string::npos) << why.str();
}

}  // namespace
}  // namespace servogate::gpio
