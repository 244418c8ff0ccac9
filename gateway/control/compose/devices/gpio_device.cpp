// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/gpio_device.hpp"

#include <utility>

#include "drivers/gpio/gpio_chip.hpp"
#include "gateway/control/compose/points/point_rules.hpp"

namespace servogate::gateway {

namespace {

gpio::Bias bias(machine::PointBias b) {
  switch (b) {
    case machine::PointBias::off:
      return gpio::Bias::off;
    case machine::PointBias::up:
      return gpio::Bias::up;
    case machine::PointBias::down:
      return gpio::Bias::down;
    case machine::PointBias::as_is:
      break;
  }
  return gpio::Bias::as_is;
}

gpio::ChipConfig chip_config(const DeviceRequest& request) {
  const machine::StationConfig& station = request.first();
  gpio::ChipConfig config;
  config.chip = std::string(request.rest);
  config.consumer = "servogate " + station.name;
  config.source = static_cast<int>(request.station);
  for (const machine::PointConfig& p : station.points) {
    gpio::Line line{p.name, static_cast<unsigned>(p.number), point_rule(p)};
    line.bias = bias(p.bias);
    line.edges = p.edges;
    if (p.is_encoder()) line.b_offset = static_cast<unsigned>(p.b_line);
    config.lines.push_back(std::move(line));
  }
  return config;
}

}  // namespace

bool gpio_available(const DeviceRequest& request, drivers::Notice& why) {
  return gpio::GpioChip::available(chip_config(request), why);
}

std::unique_ptr<image::CycleDevice> open_gpio_device(const DeviceRequest& request, drivers::Notice& why) {
  return gpio::GpioChip::open(chip_config(request), why);
}

}  // namespace servogate::gateway
