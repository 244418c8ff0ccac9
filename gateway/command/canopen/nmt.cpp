// SPDX-License-Identifier: Apache-2.0
// `servogate nmt`: an NMT command, and what the nodes made of it.
#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware_if/canopen/inspect/device_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/guarding.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using nlohmann::json;

const text::Entry kBadNode{"nmt.bad-node", "'{0}' is no node-ID; expected 1 to 127, or all",
                           "«{0}» — не номер узла; нужно от 1 до 127 или all"};
const text::Entry kNotSent{"nmt.not-sent", "the bus takes no frame", "шина не принимает кадр"};
const text::Entry kState{"nmt.state", "node {0}: {1}", "узел {0}: {1}"};
const text::Entry kSilent{"nmt.silent", "the command is sent; no heartbeat or boot-up tells what came of it",
                          "команда отправлена; ни heartbeat, ни запуск не показали результата"};
const text::Entry kElsewhere{"nmt.elsewhere", "node {0} is still: {1}", "узел {0} по-прежнему: {1}"};

struct Row {
  const char* word;
  NmtCommand command;
  NmtState result;  ///< state that a node shows afterwards
};
constexpr Row kRows[] = {{"start", NmtCommand::start, NmtState::operational},
                         {"stop", NmtCommand::stop, NmtState::stopped},
                         {"preop", NmtCommand::enter_pre_operational, NmtState::pre_operational},
                         {"reset", NmtCommand::reset_node, NmtState::pre_operational},
                         {"reset-comm", NmtCommand::reset_communication, NmtState::pre_operational}};

/// How long the nodes have to show what they made of it: longer than usual heartbeats and restarts.
constexpr double kWatch_s = 2.0;
/// How long a node that has no heartbeat may take before it is asked.
constexpr double kBeforeGuarding_s = 0.2;

using States = std::map<int, NmtState>;

bool restarts(const Row& row) {
  return row.command == NmtCommand::reset_node || row.command == NmtCommand::reset_communication;
}

/// Heartbeats and boot-ups behind the command. One node asked for ends it early.
States watch(ToolBus& bus, int node, const Row& row, double seconds) {
  States states;
  std::map<int, bool> booted;
  bus.listen(static_cast<image::Nanoseconds>(seconds * 1e9), [&](const image::CanFrame& frame) {
    const canopen::CobId id = canopen::classify(frame.id, frame.extended);
    if (id.service != canopen::Service::heartbeat || (node != 0 && id.node != node)) return false;
    const auto state = canopen::parse_heartbeat(frame);
    if (!state) return false;
    booted[id.node] |= *state == NmtState::boot_up;
    // Before its boot-up a node that restarts says nothing of what comes.
    if (restarts(row) && !booted[id.node]) return false;
    states[id.node] = *state == NmtState::boot_up ? NmtState::pre_operational : *state;
    return node != 0 && states[id.node] == row.result;
  });
  return states;
}

/// Sends the command and sees what comes of it. nullopt: the bus takes no frame.
std::optional<States> command(ToolBus& bus, int node, const Row& row) {
  const auto id = static_cast<canopen::NodeId>(node);
  // Asked before: a stopped node answers no SDO.
  const bool guardable = node != 0 && !restarts(row) && may_guard(bus, id);
  if (!bus.send(canopen::nmt_frame(row.command, id))) return std::nullopt;
  States states = watch(bus, node, row, guardable ? kBeforeGuarding_s : kWatch_s);
  if (!states.empty() || !guardable) return states;
  for (const auto& [guarded, state] : guard(bus, std::span(&id, 1))) states[guarded] = state;
  return states;
}

int tell(const NmtOptions& options, const States& states, const Row& row) {
  bool all = true;
  json list = json::array();
  for (const auto& [id, state] : states) {
    const bool there = state == row.result;
    all = all && there;
    list.push_back({{"node", id}, {"state", canopen::nmt_state_name(state)}});
    const std::vector<std::string> words{std::to_string(id), canopen::nmt_state_words(state)};
    if (there && !options.json) print_line(text::render(kState, words, text::user_language()));
    if (!there) complain(kElsewhere, words);
  }
  if (options.json)
    print_exact(
        json{{"schema", 1}, {"command", options.command}, {"node", options.node}, {"states", list}}.dump(1));
  if (states.empty()) complain(kSilent, {});
  return all ? kDone : kAlarm;
}

}  // namespace

int nmt(const NmtOptions& options) {
  int node = 0;
  if (options.node != "all") {
    const char* end = options.node.data() + options.node.size();
    const auto [at, error] = std::from_chars(options.node.data(), end, node);
    if (error != std::errc{} || at != end || node < 1 || node > canopen::kMaxNode) {
      complain(kBadNode, {options.node});
      return kWrongUse;
    }
  }
  const Row& row = *std::find_if(std::begin(kRows), std::end(kRows),
                                 [&](const Row& r) { return r.word == options.command; });
  const std::string what = "`nmt " + options.command + "`";
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(options.bus, holder, code)) return code;
  if (holder) return refuse_held(*holder, options.bus, what);
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  code = may_move(*bus, what, options);
  if (code != kDone) return bus->finish(code);
  const auto states = command(*bus, node, row);
  if (states) return bus->finish(tell(options, *states, row));
  if (!bus->over()) complain(kNotSent, {});
  return bus->finish(kInfrastructure);
}

}  // namespace servogate::gateway::command
