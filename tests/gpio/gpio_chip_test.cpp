// SPDX-License-Identifier: Apache-2.0
// A GPIO chip in the cycle, on the kernel's simulated chip: levels from outside by sysfs, outputs read back
// there and by the gpiod tools.
#include "drivers/gpio/gpio_chip.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/counting/allocations.hpp"
#include "tests/skip_here.hpp"

namespace servogate::gpio {
namespace {

using image::Quality;

constexpr const char* kHowToRun =
    "no simulated GPIO chip: tests/lab/lab run build/release/tests/gpio/test_gpio";

image::PointRule rule(const char* place, bool input, bool inverted = false) {
  image::PointRule r;
  r.place = *image::parse_place(place);
  r.input = input;
  r.inverted = inverted;
  return r;
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[256];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  pclose(pipe);
  return text;
}

class ChipOfTheKernel : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* name = std::getenv("LAB_GPIOCHIP");
    const char* sysfs = std::getenv("LAB_GPIO_SYSFS");
    if (name == nullptr || sysfs == nullptr) SKIP_HERE(kHowToRun);
    chip_ = name;
    sysfs_ = sysfs;
  }
  /// The world at line `n`.
  void pull(int n, bool up) const {
    std::ofstream(sysfs_ + "/sim_gpio" + std::to_string(n) + "/pull") << (up ? "pull-up" : "pull-down");
  }
  bool level(int n) const {
    char c = '?';
    std::ifstream(sysfs_ + "/sim_gpio" + std::to_string(n) + "/value") >> c;
    return c == '1';
  }
  std::unique_ptr<GpioChip> open(std::vector<Line> lines) {
    return GpioChip::open({chip_, "servogate test", std::move(lines), 0}, why_);
  }
  void cycle(GpioChip& chip) {
    image_->now.t_ns += image::kMillisecond;
    chip.receive(*image_, notices_);
    chip.send(*image_);
  }
  bool bit(const char* place) const { return image_->packets.bit(*image::parse_place(place)); }
  void set(const char* place, bool on) { image_->packets.set_bit(*image::parse_place(place), on); }

  std::string chip_, sysfs_;
  drivers::Notice why_;
  image::Notices notices_;
  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
};

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
