// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/world_device.hpp"

namespace servogate::gateway {

namespace {

/// A device of the world in the cycle: it lives as long as its world does, which time passes in.
class WorldDevice : public image::CycleDevice {
 public:
  explicit WorldDevice(image::CycleDevice& device) : device_(device) {}
  void open_cycle(image::ProcessImage& image) noexcept override { device_.open_cycle(image); }
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override {
    device_.receive(image, notices);
  }
  void send(image::ProcessImage& image) noexcept override { device_.send(image); }

 private:
  image::CycleDevice& device_;
};

class WorldLine final : public WorldDevice, public modbus::CountedLine {
 public:
  explicit WorldLine(mock::MockModbusLine& line) : WorldDevice(line), line_(line) {}
  modbus::LineCounters counters() const noexcept override { return line_.counters(); }

 private:
  const mock::MockModbusLine& line_;
};

}  // namespace

std::unique_ptr<image::CycleDevice> open_world_device(const DeviceRequest& request, drivers::Notice&) {
  const std::string& station = request.first().name;
  if (request.line != nullptr) return std::make_unique<WorldLine>(*request.world.line_of(station));
  return std::make_unique<WorldDevice>(*request.world.chip(station));
}

}  // namespace servogate::gateway
