// SPDX-License-Identifier: Apache-2.0
// `servogate scan`: who is on a CANopen bus.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/device_words.hpp"
#include "firmware_if/text/hex.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/guarding.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "gateway/command/canopen/object_value.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::NodeId;
using nlohmann::json;
namespace object = canopen::object;

const text::Entry kUsed{"scan.in-use",
                        "another master controls this bus (its frame {0} was seen); scan only reads",
                        "этой шиной кто-то управляет (виден его кадр {0}); scan только читает"};
const text::Entry kThrough{"scan.through", "read through the running control of '{0}', which holds the bus",
                           "читается через работающее управление «{0}», которое держит шину"};
const text::Entry kNobody{"scan.nobody",
                          "no node answers and no message is heard: check power, wiring, termination and bit "
                          "rate (`servogate can check`)",
                          "никто не отвечает и никого не слышно: проверьте питание, кабель, терминаторы и "
                          "скорость (`servogate can check`)"};
const text::Entry kNode{"scan.node", "node {0}: {1}, {2}, {3}", "узел {0}: {1}, {2}, {3}"};
const text::Entry kNodeNoObjects{"scan.node-no-objects", "node {0}: {1}, {2}, does not answer SDO",
                                 "узел {0}: {1}, {2}, на SDO не отвечает"};
const text::Entry kNodeNoType{"scan.node-no-type",
                              "node {0}: {1}, {2}, answers SDO, but does not tell its device type (1000h)",
                              "узел {0}: {1}, {2}, на SDO отвечает, но не сообщает тип устройства (1000h)"};
const text::Entry kIdentity{"scan.identity", "vendor {0}, product {1}, revision {2}, serial number {3}",
                            "производитель {0}, изделие {1}, версия {2}, заводской номер {3}"};
const text::Entry kModes{"scan.modes", "modes: {0}", "режимы: {0}"};

/// What is known of a node.
struct Node {
  std::optional<canopen::NmtState> state;
  int heartbeats = 0;
  bool guarded = false;  ///< the state was asked for by a remote frame
  bool answers_sdo = false;
  std::optional<bool> online;  ///< of a held bus: what its control says
  std::optional<std::uint32_t> type, heartbeat_ms, modes;
  std::array<std::optional<std::uint32_t>, 4> identity;
  std::array<std::string, 3> names;  ///< 1008h, 1009h, 100Ah
};
using Nodes = std::map<int, Node>;

bool ask_device_type(ToolBus& bus, const ToolBus::Handler& hear) {
  for (int id = 1; id <= canopen::kMaxNode; ++id) {
    const auto node = static_cast<NodeId>(id);
    const auto bytes = canopen::sdo_request::upload(object::kDeviceType, 0);
    if (!bus.send(canopen::make_frame(canopen::cob::sdo_request(node), bytes))) return false;
    // A slow bus and a slow device get the time that they need.
    bus.listen(image::kMillisecond, hear);
  }
  return true;
}

/// Asks everybody for 1000h, hears heartbeats. The first frame of a foreign master in `master`.
void find_nodes(ToolBus& bus, const ScanOptions& options, Nodes& nodes, std::string& master) {
  const auto hear = [&](const image::CanFrame& frame) {
    const canopen::CobId id = canopen::classify(frame.id, frame.extended);
    if (master.empty() && canopen::sent_by_masters(frame)) master = canopen::frame_words(frame);
    if (frame.remote || frame.error || id.node == 0) return false;
    if (id.service == canopen::Service::sdo_response && frame.length == 8) {
      nodes[id.node].answers_sdo = true;
    } else if (id.service == canopen::Service::heartbeat) {
      if (const auto state = canopen::parse_heartbeat(frame)) {
        // The boot-up message of a node that was just switched on has the identifier of a heartbeat, and is
        // none.
        const bool boot_up = *state == canopen::NmtState::boot_up;
        nodes[id.node].state = boot_up ? canopen::NmtState::pre_operational : *state;
        if (!boot_up) ++nodes[id.node].heartbeats;
      }
    } else if (id.service == canopen::Service::emcy) {
      nodes[id.node];
    }
    return false;
  };
  const image::Nanoseconds begin = bus.now();
  const auto whole = std::llround(std::max(options.seconds * 1e9, options.timeout_ms * 1e6));
  // Twice: who has just been switched on, or was busy, answers the second time.
  for (int round = 1; round <= 2; ++round) {
    if (!ask_device_type(bus, hear)) return;
    bus.listen(begin + round * whole / 2 - bus.now(), hear);
  }
}

void read_facts(SdoAccess& access, int number, Node& node) {
  const auto id = static_cast<NodeId>(number);
  node.type = number_of(access, id, object::kDeviceType, 0);
  for (std::uint8_t i = 0; i < 4; ++i)
    node.identity[i] = number_of(access, id, object::kIdentity, static_cast<std::uint8_t>(i + 1));
  constexpr std::uint16_t kNames[] = {object::kDeviceName, object::kHardwareVersion,
                                      object::kSoftwareVersion};
  for (std::size_t i = 0; i < 3; ++i) {
    const SdoOutcome name = access.read(id, kNames[i], 0);
    if (name.ok()) node.names[i] = json_value(name.data, canopen::type_named("str")).get<std::string>();
  }
  node.heartbeat_ms = number_of(access, id, object::kProducerHeartbeatTime, 0);
  if (node.type && canopen::has_profile(*node.type, 402))
    node.modes = number_of(access, id, object::kSupportedDriveModes, 0);
}

/// The states of nodes that send no heartbeat.
void ask_states(ToolBus& bus, Nodes& nodes) {
  std::vector<NodeId> silent;
  for (const auto& [id, node] : nodes)
    if (!bus.over() && node.answers_sdo && !node.state && may_guard(bus, static_cast<NodeId>(id)))
      silent.push_back(static_cast<NodeId>(id));
  for (const auto& [id, state] : guard(bus, silent)) {
    nodes[id].state = state;
    nodes[id].guarded = true;
  }
}

std::string hexadecimal(std::uint32_t value) { return text::hex_number(value, 8) + "h"; }

std::string state_words(const Node& node) {
  const std::string state = node.state ? canopen::nmt_state_words(*node.state)
                                       : text::both("state unknown", "состояние неизвестно");
  // A node that is heard and that its control cannot use, or not yet.
  return node.online.value_or(true) ? state : state + text::both(", not online", ", не на связи");
}

bool heartbeat_seen(const Node& node) {
  return node.heartbeats > 0 || (node.online && node.state && node.heartbeat_ms.value_or(0) > 0);
}

std::string heartbeat_words(const Node& node) {
  const std::uint32_t ms = node.heartbeat_ms.value_or(0);
  const std::string every = std::to_string(ms);
  if (heartbeat_seen(node))
    return ms > 0 ? text::both("heartbeat every " + every + " ms", "heartbeat каждые " + every + " мс")
                  : text::both("heartbeat seen", "heartbeat виден");
  if (ms > 0)
    return text::both("heartbeat of " + every + " ms not seen",
                      "heartbeat с периодом " + every + " мс не виден");
  return node.guarded ? text::both("no heartbeat, answers guarding", "без heartbeat, на опрос отвечает")
                      : text::both("no heartbeat", "без heartbeat");
}

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

void print_node(int id, const Node& node) {
  const std::string number = std::to_string(id);
  if (!node.type) {
    const text::Entry& entry = node.answers_sdo ? kNodeNoType : kNodeNoObjects;
    print_line(say(entry, {number, state_words(node), heartbeat_words(node)}));
    return;
  }
  print_line(
      say(kNode, {number, state_words(node), heartbeat_words(node), canopen::device_type_words(*node.type)}));
  std::string names;
  for (const std::string& name : node.names)
    if (!name.empty()) names += (names.empty() ? "" : ", ") + name;
  if (!names.empty()) print_line("  " + names);
  if (node.identity[0])
    print_line("  " +
               say(kIdentity, {hexadecimal(*node.identity[0]), hexadecimal(node.identity[1].value_or(0)),
                               hexadecimal(node.identity[2].value_or(0)),
                               std::to_string(node.identity[3].value_or(0))}));
  if (node.modes) print_line("  " + say(kModes, {canopen::drive_modes(*node.modes)}));
}

json node_json(int id, const Node& node) {
  const auto or_null = [](const auto& value) { return value ? json(*value) : json(); };
  json out{{"node", id},
           {"state", node.state ? json(canopen::nmt_state_name(*node.state)) : json()},
           {"heartbeat_seen", heartbeat_seen(node)},
           {"heartbeat_ms", or_null(node.heartbeat_ms)},
           {"answers_sdo", node.answers_sdo},
           {"device_type", or_null(node.type)},
           {"vendor_id", or_null(node.identity[0])},
           {"product_code", or_null(node.identity[1])},
           {"revision", or_null(node.identity[2])},
           {"serial_number", or_null(node.identity[3])},
           {"device_name", node.names[0]},
           {"hardware_version", node.names[1]},
           {"software_version", node.names[2]}};
  if (node.online) out["online"] = *node.online;
  if (!node.type) return out;
  out["profile"] = *node.type & 0xFFFF;
  out["device"] = say({"", "{0}", "{0}"}, {canopen::device_type_words(*node.type)});
  if (!node.modes) return out;
  out["modes"] = json::array();
  std::string words = canopen::drive_modes(*node.modes) + " ";
  for (std::size_t at = 0, end = 0; (end = words.find(' ', at)) != std::string::npos; at = end + 1)
    if (end > at) out["modes"].push_back(words.substr(at, end - at));
  return out;
}

int tell(const ScanOptions& options, const Nodes& nodes, const std::string& master, const Holder* holder) {
  if (options.json) {
    json out{{"schema", 1}, {"bus", options.bus}, {"nodes", json::array()}};
    if (!master.empty()) out["controlled_by_frame"] = say({"", "{0}", "{0}"}, {master});
    if (holder != nullptr) out["held_by"] = {{"machine", holder->machine}, {"socket", holder->socket}};
    for (const auto& [id, node] : nodes) out["nodes"].push_back(node_json(id, node));
    print_exact(out.dump(1, ' ', false, json::error_handler_t::replace));
  } else {
    if (holder != nullptr) gateway::tell(say(kThrough, {holder->machine}));
    if (!master.empty()) gateway::tell(say(kUsed, {master}));
    for (const auto& [id, node] : nodes) print_node(id, node);
  }
  if (!nodes.empty()) return kDone;
  complain(kNobody, {});
  return kAlarm;
}

int scan_held(const ScanOptions& options, const Holder& holder) {
  const auto bus = HeldBus::open(holder, options.timeout_ms);
  if (bus == nullptr) return kInfrastructure;
  Nodes nodes;
  for (const Holder::Node& n : holder.nodes) {
    Node& node = nodes[n.id];
    node.online = n.online;
    node.state = n.state;
    read_facts(*bus, n.id, node);
    node.answers_sdo = node.type.has_value();
  }
  return tell(options, nodes, "", &holder);
}

}  // namespace

int scan(const ScanOptions& options) {
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(options.bus, holder, code)) return code;
  if (holder) return scan_held(options, *holder);
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  if (code = may_read(*bus, options); code != kDone) return bus->finish(code);
  Nodes nodes;
  std::string master;
  find_nodes(*bus, options, nodes, master);
  for (auto& [id, node] : nodes) {
    if (bus->over()) break;
    if (!node.answers_sdo) continue;
    read_facts(*bus, id, node);
  }
  ask_states(*bus, nodes);
  if (bus->over()) return bus->finish(kDone);
  return bus->finish(tell(options, nodes, master, nullptr));
}

}  // namespace servogate::gateway::command
