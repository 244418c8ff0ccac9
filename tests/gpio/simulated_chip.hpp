// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/gpio/gpio_chip.hpp"
#include "tests/skip_here.hpp"

namespace servogate::gpio {

inline constexpr const char* kHowToRun =
    "no simulated GPIO chip: tests/lab/lab run build/release/tests/gpio/test_gpio";

inline image::PointRule rule(const char* place, bool input, bool inverted = false) {
  image::PointRule r;
  r.place = *image::parse_place(place);
  r.input = input;
  r.inverted = inverted;
  return r;
}

inline image::PointRule counts(const char* place) {
  image::PointRule r = rule(place, true);
  r.digital = false;
  r.hold = true;
  return r;
}

inline std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[256];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  pclose(pipe);
  return text;
}

/// The world at one line of a simulated chip.
class Wire {
 public:
  Wire(const std::string& sysfs, unsigned line)
      : pull_(::open((sysfs + "/sim_gpio" + std::to_string(line) + "/pull").c_str(), O_WRONLY)) {}
  ~Wire() { ::close(pull_); }
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;
  void pull(bool up) const {
    const std::string to = up ? "pull-up" : "pull-down";
    ASSERT_EQ(::pwrite(pull_, to.data(), to.size(), 0), static_cast<ssize_t>(to.size()));
  }

 private:
  int pull_;
};

/// One simulated chip of the laboratory, and a control that has it as a device.
class ChipOfTheKernel : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* name = std::getenv("LAB_GPIOCHIP");
    const char* sysfs = std::getenv("LAB_GPIO_SYSFS");
    if (name == nullptr || sysfs == nullptr) SKIP_HERE(kHowToRun);
    chip_ = name;
    sysfs_ = sysfs;
  }
  void pull(unsigned n, bool up) const { Wire(sysfs_, n).pull(up); }
  bool level(unsigned n) const {
    char c = '?';
    std::ifstream(sysfs_ + "/sim_gpio" + std::to_string(n) + "/value") >> c;
    return c == '1';
  }
  std::unique_ptr<GpioChip> open(std::vector<Line> lines) {
    return GpioChip::open({chip_, "servogate test", std::move(lines), 0}, why_);
  }
  void cycle(GpioChip& chip) {
    image_->now.t_ns += image::kMillisecond;
    image_->edges.clear();
    chip.open_cycle(*image_);
    chip.receive(*image_, notices_);
    chip.send(*image_);
  }
  bool bit(const char* place) const { return image_->packets.bit(*image::parse_place(place)); }
  double number(const char* place) const { return image_->packets.number(*image::parse_place(place)); }
  void set(const char* place, bool on) { image_->packets.set_bit(*image::parse_place(place), on); }

  std::string chip_, sysfs_;
  drivers::Notice why_;
  image::Notices notices_;
  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
};

}  // namespace servogate::gpio
