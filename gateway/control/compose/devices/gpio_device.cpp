// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/gpio_device.hpp"

#include "drivers/gpio/gpio_chip.hpp"
#include "gateway/control/compose/points/point_rules.hpp"

namespace servogate::gateway {

std::unique_ptr<image::CycleDevice> open_gpio_device(const DeviceRequest& request, drivers::Notice& why) {
  const machine::StationConfig& station = request.first();
  gpio::ChipConfig config;
  config.chip = std::string(request.rest);
  config.consumer = "servogate " + station.name;
  config.source = static_cast<int>(request.station);
  for (const machine::PointConfig& p : station.points)
    config.lines.push_back({p.name, static_cast<unsigned>(p.number), point_rule(p)});
  return gpio::GpioChip::open(config, why);
}

}  // namespace servogate::gateway
