// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/guarding.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::gateway::command {

namespace object = canopen::object;

std::optional<std::uint32_t> number_of(SdoAccess& access, canopen::NodeId node, std::uint16_t index,
                                       std::uint8_t subindex) {
  const SdoOutcome outcome = access.read(node, index, subindex);
  if (!outcome.ok()) return std::nullopt;
  return static_cast<std::uint32_t>(canopen::load_le(outcome.data));
}

bool may_guard(ToolBus& bus, canopen::NodeId node) {
  const SdoOutcome heartbeat = bus.read(node, object::kProducerHeartbeatTime, 0);
  if (!heartbeat.answered() || canopen::load_le(heartbeat.data) != 0) return false;
  return number_of(bus, node, object::kGuardTime, 0).value_or(0) == 0 ||
         number_of(bus, node, object::kLifeTimeFactor, 0).value_or(0) == 0;
}

std::map<canopen::NodeId, canopen::NmtState> guard(ToolBus& bus, std::span<const canopen::NodeId> nodes) {
  std::map<canopen::NodeId, canopen::NmtState> states;
  const auto hear = [&](const image::CanFrame& frame) {
    const canopen::CobId id = canopen::classify(frame.id, frame.extended);
    if (id.service != canopen::Service::heartbeat || frame.remote) return false;
    if (std::find(nodes.begin(), nodes.end(), id.node) == nodes.end()) return false;
    if (const auto state = canopen::parse_heartbeat(frame)) states[id.node] = *state;
    return states.size() == nodes.size();
  };
  for (const canopen::NodeId node : nodes) {
    image::CanFrame question;
    question.id = canopen::cob::heartbeat(node);
    question.remote = true;
    question.length = 1;
    if (!bus.send(question)) return states;
    bus.listen(image::kMillisecond, hear);
  }
  if (states.size() < nodes.size()) bus.listen(50 * image::kMillisecond, hear);
  return states;
}

}  // namespace servogate::gateway::command
