// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/words/frame_words.hpp"

#include <cstdio>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

namespace {

struct Row {
  Service service;
  const char* english;
  const char* russian;
  bool of_node;
  bool master;  ///< sent by masters only
};
constexpr Row kRows[] = {
    {Service::nmt, "NMT command", "команда NMT", false, true},
    {Service::sync, "SYNC", "SYNC", false, true},
    {Service::emcy, "EMCY", "EMCY", true, false},
    {Service::time, "TIME", "TIME", false, true},
    {Service::tpdo1, "TPDO 1", "TPDO 1", true, false},
    {Service::rpdo1, "RPDO 1", "RPDO 1", true, true},
    {Service::tpdo2, "TPDO 2", "TPDO 2", true, false},
    {Service::rpdo2, "RPDO 2", "RPDO 2", true, true},
    {Service::tpdo3, "TPDO 3", "TPDO 3", true, false},
    {Service::rpdo3, "RPDO 3", "RPDO 3", true, true},
    {Service::tpdo4, "TPDO 4", "TPDO 4", true, false},
    {Service::rpdo4, "RPDO 4", "RPDO 4", true, true},
    {Service::sdo_response, "SDO answer", "ответ SDO", true, false},
    {Service::sdo_request, "SDO request", "запрос SDO", true, true},
    {Service::heartbeat, "heartbeat", "heartbeat", true, false},
    {Service::lss, "layer setting", "LSS", false, true},
};
constexpr Row kGuarding{Service::heartbeat, "node guarding", "опрос узла", true, true};

constexpr struct {
  NmtCommand command;
  const char* words;
} kCommands[] = {{NmtCommand::start, "start"},
                 {NmtCommand::stop, "stop"},
                 {NmtCommand::enter_pre_operational, "enter pre-operational"},
                 {NmtCommand::reset_node, "reset node"},
                 {NmtCommand::reset_communication, "reset communication"}};

const Row* row_of(const image::CanFrame& frame, const CobId& id) noexcept {
  if (frame.remote && id.service == Service::heartbeat) return &kGuarding;
  for (const Row& row : kRows)
    if (row.service == id.service) return &row;
  return nullptr;
}

/// What an NMT command is to do with whom.
std::string command_words(const NmtRequest& request) {
  for (const auto& row : kCommands) {
    if (row.command != request.command) continue;
    const std::string node = std::to_string(request.node), words = std::string(" ") + row.words;
    return request.node == 0 ? text::both(words + " to all nodes", words + " всем узлам")
                             : text::both(words + " to node " + node, words + " узлу " + node);
  }
  return {};
}

/// Which object an SDO request begins to read or write.
std::string object_words(const image::CanFrame& frame) {
  if (frame.length != 8) return {};
  const unsigned command = frame.data[0] >> 5;
  const bool writes = command == 1 || (command == 6 && (frame.data[0] & 1) == 0);
  const bool reads = command == 2 || (command == 5 && (frame.data[0] & 3) == 0);
  if (!writes && !reads) return {};
  char place[16];
  std::snprintf(place, sizeof place, "%04Xh:%02X", frame.data[1] | frame.data[2] << 8, frame.data[3]);
  return writes ? text::both(std::string(", write ") + place, std::string(", запись ") + place)
                : text::both(std::string(", read ") + place, std::string(", чтение ") + place);
}

/// A download to 6040h, or to that of a further axis of the same node. Source: CiA 402-2, 800h an axis.
bool writes_controlword(const image::CanFrame& frame) noexcept {
  constexpr unsigned kControlword = 0x6040, kAxis = 0x800, kEnd = 0xA000;
  const unsigned command = frame.data[0] >> 5;
  const unsigned index = frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8;
  const bool writes = command == 1 || (command == 6 && (frame.data[0] & 1) == 0);
  return frame.length == 8 && writes && index >= kControlword && index < kEnd &&
         (index - kControlword) % kAxis == 0;
}

}  // namespace

std::string frame_words(const image::CanFrame& frame) {
  const CobId id = classify(frame.id, frame.extended);
  char number[16];
  std::snprintf(number, sizeof number, frame.extended ? "(%08Xh)" : "(%03Xh)", frame.id);
  const Row* row = row_of(frame, id);
  if (row == nullptr) return number;
  std::string words = text::both(row->english, row->russian);
  const std::string node = std::to_string(id.node);
  if (row->of_node) words += text::both(" of node " + node, " узла " + node);
  if (const auto request = parse_nmt(frame)) words += command_words(*request);
  if (row->service == Service::sdo_request) words += object_words(frame);
  return words + " " + number;
}

bool sent_by_masters(const image::CanFrame& frame) noexcept {
  if (frame.error) return false;
  const CobId id = classify(frame.id, frame.extended);
  if (frame.remote) return id.service == Service::heartbeat;
  if (id.service == Service::lss) return frame.id == cob::kLssMaster;
  const Row* row = row_of(frame, id);
  return row != nullptr && row->master;
}

bool leads_nodes(const image::CanFrame& frame, NodeId master) noexcept {
  if (!frame.remote && !frame.error && frame.id == cob::heartbeat(master) && !frame.extended) return true;
  if (!sent_by_masters(frame)) return false;
  const Service service = classify(frame.id, frame.extended).service;
  if (service == Service::sdo_request) return writes_controlword(frame);
  return service != Service::time && service != Service::lss;
}

}  // namespace servogate::canopen
