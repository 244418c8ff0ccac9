// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/inverter/inverter.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {

namespace {

/// A relay that lets go needs 5 to 20 ms, a contactor 50 ms.
constexpr double kRelayPause = 0.1;  // s

int sign(double v) noexcept { return v > 0.0 ? 1 : v < 0.0 ? -1 : 0; }

double toward(double from, double to, double step) noexcept {
  return from + std::clamp(to - from, -step, step);
}

}  // namespace

void Inverter::configure(const InverterConfig& config) noexcept {
  *this = Inverter{};
  config_ = config;
}

bool Inverter::lost(const image::ProcessImage& image) const noexcept {
  for (std::size_t s = 0; s < image.sources.size(); ++s)
    if ((config_.sources >> s & 1u) != 0 && image.sources[s].quality >= image::Quality::stale) return true;
  return false;
}

void Inverter::advance(double wanted_rpm, double step_rpm, bool cut, double dt) noexcept {
  pause_s_ = std::max(0.0, pause_s_ - dt);
  const int asked = cut ? 0 : sign(wanted_rpm);
  // Against the relay that is on the way leads through standstill.
  const bool against = direction_ != 0 && asked != direction_;
  command_ = cut ? 0.0 : toward(command_, against ? 0.0 : wanted_rpm, step_rpm);
  if (direction_ != 0 && (cut || (against && command_ == 0.0))) {
    direction_ = 0;
    pause_s_ = kRelayPause;
  }
  if (direction_ == 0) {
    direction_ = pause_s_ > 0.0 ? 0 : asked;
    if (direction_ == 0) command_ = 0.0;
  }
  assumed_ = toward(assumed_, command_, step_rpm);
}

void Inverter::write(image::ProcessImage& image, double ratio) const noexcept {
  image.packets.set_number(config_.speed, direction_ != 0 ? std::abs(command_) * ratio : 0.0);
  if (config_.cw) image.packets.set_bit(*config_.cw, direction_ > 0);
  if (config_.ccw) image.packets.set_bit(*config_.ccw, direction_ < 0);
}

}  // namespace servogate::axis
