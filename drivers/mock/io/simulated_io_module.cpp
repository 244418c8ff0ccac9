// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/io/simulated_io_module.hpp"

#include <cmath>

#include "drivers/mock/io/profiled_node.hpp"
#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/device/io/io_profile.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"

namespace servogate::mock {
namespace {

std::vector<canopen::ObjectSpec> rows_of(const SimulatedIoConfig& c) {
  auto rows =
      canopen::communication_objects(c.node_id, {canopen::io_device_type(c.terminals), c.vendor_id,
                                                 c.product_code, c.revision, c.serial_number, c.name});
  const auto own = canopen::io_objects(c.node_id, c.terminals);
  rows.insert(rows.end(), own.begin(), own.end());
  return rows;
}

}  // namespace

struct SimulatedIoModule::Inside {
  explicit Inside(const SimulatedIoConfig& c)
      : config(c),
        node(config.node_id, config.boot_time_s, rows_of(config), config.terminals,
             static_cast<Nanoseconds>(std::llround(config.filter_s * 1e9))) {
    namespace io = canopen::io;
    if (config.error_states) return;
    for (const canopen::ObjectSpec& row : canopen::io_objects(config.node_id, config.terminals))
      for (const std::uint16_t index : {io::kErrorModeOutput8, io::kErrorValueOutput8,
                                        io::kErrorModeAnalogueOutput, io::kErrorValueAnalogueOutput})
        if (row.index == index) node.dictionary.hide(node.dictionary.find(row.index, row.subindex));
  }

  SimulatedIoConfig config;  ///< the dictionary's texts are its
  ProfiledNode<canopen::IoProfile> node;
};

SimulatedIoModule::SimulatedIoModule(const SimulatedIoConfig& config)
    : inside_(std::make_unique<Inside>(config)) {}
SimulatedIoModule::~SimulatedIoModule() = default;

void SimulatedIoModule::connect(image::CanBus& bus, Nanoseconds now) { inside_->node.connect(bus, now); }
const CanFilter* SimulatedIoModule::filter() const noexcept { return &inside_->node.slave.filter(); }
void SimulatedIoModule::on_frame(const CanFrame& frame) noexcept { inside_->node.on_frame(frame); }
void SimulatedIoModule::advance_to(Nanoseconds t) noexcept { inside_->node.advance_to(t); }
Nanoseconds SimulatedIoModule::next_action_ns() const noexcept { return inside_->node.next; }
bool SimulatedIoModule::alive() const noexcept { return inside_->node.alive; }
void SimulatedIoModule::supply(bool present) noexcept { inside_->node.supply(present); }
void SimulatedIoModule::swap(std::optional<std::uint32_t> product) noexcept { inside_->node.swap(product); }

canopen::NmtState SimulatedIoModule::nmt_state() const noexcept { return inside_->node.slave.state(); }
void SimulatedIoModule::set_digital(std::uint8_t line, bool level) noexcept {
  inside_->node.profile.set_digital(line, level);
}
void SimulatedIoModule::set_analogue(std::uint8_t channel, std::int16_t value) noexcept {
  inside_->node.profile.set_analogue(channel, value);
}
bool SimulatedIoModule::digital(std::uint8_t line) const noexcept {
  return inside_->node.alive && inside_->node.profile.digital(line);
}
std::int16_t SimulatedIoModule::analogue(std::uint8_t channel) const noexcept {
  return inside_->node.alive ? inside_->node.profile.analogue(channel) : std::int16_t{0};
}
std::int64_t SimulatedIoModule::object(std::uint16_t index, std::uint8_t subindex) const noexcept {
  return inside_->node.dictionary.get(index, subindex);
}

}  // namespace servogate::mock
