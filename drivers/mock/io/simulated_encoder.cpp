// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/io/simulated_encoder.hpp"

#include "drivers/mock/io/profiled_node.hpp"
#include "firmware_if/canopen/406/objects.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"

namespace servogate::mock {
namespace {

std::vector<canopen::ObjectSpec> rows_of(const SimulatedEncoderConfig& c) {
  auto rows = canopen::communication_objects(
      c.node_id, {canopen::encoder::kDeviceProfile | canopen::encoder::kMultiTurnAbsolute, c.vendor_id,
                  c.product_code, c.revision, c.serial_number, c.name});
  const auto own = canopen::encoder_objects(c.node_id, c.resolution);
  rows.insert(rows.end(), own.begin(), own.end());
  return rows;
}

}  // namespace

struct SimulatedEncoder::Inside {
  explicit Inside(const SimulatedEncoderConfig& c)
      : config(c), node(config.node_id, config.boot_time_s, rows_of(config), config.resolution) {}

  SimulatedEncoderConfig config;  ///< the dictionary's texts are its
  ProfiledNode<canopen::EncoderProfile> node;
};

SimulatedEncoder::SimulatedEncoder(const SimulatedEncoderConfig& config)
    : inside_(std::make_unique<Inside>(config)) {}
SimulatedEncoder::~SimulatedEncoder() = default;

void SimulatedEncoder::connect(image::CanBus& bus, Nanoseconds now) { inside_->node.connect(bus, now); }
const CanFilter* SimulatedEncoder::filter() const noexcept { return &inside_->node.slave.filter(); }
void SimulatedEncoder::on_frame(const CanFrame& frame) noexcept { inside_->node.on_frame(frame); }
void SimulatedEncoder::advance_to(Nanoseconds t) noexcept { inside_->node.advance_to(t); }
Nanoseconds SimulatedEncoder::next_action_ns() const noexcept { return inside_->node.next; }
bool SimulatedEncoder::alive() const noexcept { return inside_->node.alive; }
void SimulatedEncoder::supply(bool present) noexcept { inside_->node.supply(present); }
void SimulatedEncoder::swap(std::optional<std::uint32_t> product) noexcept { inside_->node.swap(product); }

void SimulatedEncoder::set_position(std::int64_t counts) noexcept {
  inside_->node.profile.set_position(counts);
}
std::int64_t SimulatedEncoder::position() const noexcept { return inside_->node.profile.position(); }
void SimulatedEncoder::set_unreadable(bool unreadable) noexcept {
  inside_->node.profile.set_unreadable(unreadable);
}
std::int64_t SimulatedEncoder::object(std::uint16_t index, std::uint8_t subindex) const noexcept {
  return inside_->node.dictionary.get(index, subindex);
}

}  // namespace servogate::mock
