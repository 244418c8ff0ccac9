// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/foreign_master.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::Service;

const text::Entry kMayMove{"can.may-move", "{0} can move a drive: --i-may-move says that it may",
                           "{0} может двинуть привод: --i-may-move разрешает это"};
const text::Entry kInUse{"can.in-use",
                         "{0} is not done: somebody controls this bus, its frame {1} came within {2} s",
                         "{0} не выполняется: этой шиной кто-то управляет, за {2} с пришёл его кадр {1}"};

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

const Row* row_of(Service service) {
  const auto found =
      std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.service == service; });
  return found == std::end(kRows) ? nullptr : found;
}

}  // namespace

std::string frame_words(const image::CanFrame& frame) {
  const canopen::CobId id = canopen::classify(frame.id, frame.extended);
  char number[16];
  std::snprintf(number, sizeof number, frame.extended ? "(%08Xh)" : "(%03Xh)", frame.id);
  const Row* row = frame.remote && id.service == Service::heartbeat ? &kGuarding : row_of(id.service);
  if (row == nullptr) return number;
  const std::string node = std::to_string(id.node);
  return text::both(row->english + (row->of_node ? " of node " + node : "") + " " + number,
                    row->russian + (row->of_node ? " узла " + node : "") + " " + number);
}

bool shows_master(const image::CanFrame& frame) {
  if (frame.error) return false;
  const canopen::CobId id = canopen::classify(frame.id, frame.extended);
  if (frame.remote) return id.service == Service::heartbeat;
  if (id.service == Service::lss) return frame.id == canopen::cob::kLssMaster;
  const Row* row = row_of(id.service);
  return row != nullptr && row->master;
}

std::optional<image::CanFrame> foreign_master(ToolBus& bus, image::Nanoseconds listening) {
  std::optional<image::CanFrame> found;
  bus.listen(listening, [&](const image::CanFrame& frame) {
    if (shows_master(frame)) found = frame;
    return found.has_value();
  });
  return found;
}

bool can_move(std::uint16_t index) {
  constexpr std::uint16_t kObjects[] = {0x6040, 0x6042, 0x6060, 0x6071, 0x607A, 0x60B0,
                                        0x60B1, 0x60B2, 0x60C1, 0x60FE, 0x60FF};
  if (index == 0x1F82 || index == 0x1F51) return true;
  if (index < 0x6000 || index >= 0xA000) return false;
  const auto own = static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  // Outputs of a CiA 401 module, digital and analogue, with their polarity: valves and brakes hang on them.
  if ((own >= 0x6200 && own < 0x6400) || (own >= 0x6410 && own < 0x6420)) return true;
  return std::find(std::begin(kObjects), std::end(kObjects), own) != std::end(kObjects);
}

int must_be_idle(ToolBus& bus, const std::string& what, double listen_s) {
  const auto frame = foreign_master(bus, std::llround(listen_s * 1e9));
  if (!frame) return kDone;
  complain(kInUse, {what, frame_words(*frame), text::number(listen_s)});
  return kAlarm;
}

int may_move(ToolBus& bus, const std::string& what, bool i_may_move, double listen_s) {
  if (!i_may_move) {
    complain(kMayMove, {what});
    return kWrongUse;
  }
  return must_be_idle(bus, what, listen_s);
}

}  // namespace servogate::gateway::command
