// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/guarding.hpp"

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

std::optional<canopen::NmtState> guard_once(ToolBus& bus, canopen::NodeId node) {
  image::CanFrame question;
  question.id = canopen::cob::heartbeat(node);
  question.remote = true;
  question.length = 1;
  std::optional<canopen::NmtState> state;
  if (!bus.send(question)) return state;
  bus.listen(50 * image::kMillisecond, [&](const image::CanFrame& frame) {
    if (frame.id != question.id || frame.remote || frame.extended) return false;
    state = canopen::parse_heartbeat(frame);
    return state.has_value();
  });
  return state;
}

}  // namespace servogate::gateway::command
