// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/gears/gearbox.hpp"

#include <algorithm>

namespace servogate::axis {

void Gearbox::configure(const GearboxConfig& config) {
  *this = {};
  config_ = config;
}

void Gearbox::choose(double rpm, int number) noexcept {
  if (!present()) return;
  const auto count = static_cast<int>(config_.ranges.size());
  if (number <= 0) {
    number = 1;
    while (number < count && config_.ranges[static_cast<std::size_t>(number - 1)].max_rpm < rpm) ++number;
  }
  number = std::min(number, count);
  if (number != wanted_ || failed_) shifting_ = false;
  failed_ = false;
  wanted_ = number;
}

bool Gearbox::lost(const image::ProcessImage& image) const noexcept {
  for (std::size_t s = 0; s < image.sources.size(); ++s)
    if ((config_.sources >> s & 1u) != 0 && image.sources[s].quality >= image::Quality::stale) return true;
  return false;
}

void Gearbox::begin(image::ProcessImage& image) noexcept {
  shifting_ = true;
  engaged_ = 0;
  since_s_ = 0.0;
  for (std::size_t n = 0; n < config_.ranges.size(); ++n)
    if (const auto& output = config_.ranges[n].output)
      image.packets.set_bit(*output, static_cast<int>(n) + 1 == wanted_);
}

void Gearbox::drop() noexcept {
  engaged_ = 0;
  shifting_ = false;
}

void Gearbox::step(image::ProcessImage& image, bool slow, bool lost, double dt) noexcept {
  if (wanted_ == 0) return;
  if (lost) return drop();
  const std::optional<image::Place>& confirm = wanted_range().confirm;
  const bool told = confirm && image.packets.bit(*confirm);
  if (engaged_ == wanted_) {
    if (!confirm || told) return;
    drop();
    failed_ = true;
  }
  if (failed_) return;
  if (!shifting_) {
    if (slow) begin(image);
    return;
  }
  since_s_ += dt;
  if (confirm ? told : since_s_ >= config_.change_s)
    engaged_ = wanted_;
  else
    failed_ = since_s_ > config_.timeout_s;
}

double Gearbox::ratio() const noexcept {
  if (!present()) return 1.0;
  return config_.ranges[static_cast<std::size_t>(std::max(engaged_, 1) - 1)].ratio;
}

double Gearbox::max_rpm(double otherwise) const noexcept {
  return wanted_ == 0 ? otherwise : std::min(otherwise, wanted_range().max_rpm);
}

}  // namespace servogate::axis
