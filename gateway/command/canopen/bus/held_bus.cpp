// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/held_bus.hpp"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "drivers/clock.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/control/server/socket/socket_path.hpp"
#include "machine/bus_place.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kHeld{
    "can.held",
    "{0} is refused: the running control of '{2}' uses bus {1} ({3}); `servogate down` ends that control",
    "{0} не выполняется: шину {1} держит работающее управление «{2}» ({3}); его завершает "
    "`servogate down`"};
const text::Entry kHeldByRun{
    "can.held-by-run",
    "{0} is refused: a `servogate run` of '{2}' uses bus {1} ({3}); the bus is free when that run has ended",
    "{0} не выполняется: шину {1} держит `servogate run` станка «{2}» ({3}); она освободится, когда прогон "
    "закончится"};
const text::Entry kSilent{
    "can.holder-silent",
    "{0} is refused: the control at {1} is running but does not answer (stopped, or in a debugger?), and it "
    "may be using bus {2}. Let it continue (kill -CONT) or end it first",
    "{0} не выполняется: управление {1} работает и не отвечает (остановлено или в "
    "отладчике?); оно может держать "
    "шину {2}. Сначала продолжите его (kill -CONT) или завершите"};
const text::Entry kThis{"can.this-command", "this command", "эта команда"};
const text::Entry kNoConnection{"can.no-connection", "cannot reach the control at {0}: {1}",
                                "нет связи с управлением {0}: {1}"};

/// Patience with a control that only has to say what it holds, ms.
constexpr int kHolderPatience = 2000;
constexpr int kPatienceInAHurry = 100;  ///< with one that stands in the way of switching a drive off

json ask(SocketClient& connection, const json& request, int patience_ms) {
  std::string line;
  if (!connection.send(request.dump() + "\n") || !connection.receive(line, patience_ms)) return nullptr;
  return json::parse(line, nullptr, false);
}

std::optional<canopen::NmtState> nmt_state(const json& node) {
  const auto found = node.find("nmt_state");
  if (found == node.end() || !found->is_number_integer()) return std::nullopt;
  return static_cast<canopen::NmtState>(found->get<int>());
}

/// Holder of the bus if the control behind this socket has it.
std::optional<Holder> holder_at(const std::string& socket, const std::string& place, int patience_ms) {
  SocketClient connection;
  if (!connection.connect(socket).empty()) return std::nullopt;
  const image::Nanoseconds begin = drivers::clock_ns(CLOCK_MONOTONIC);
  const json held = ask(connection, {{"cmd", "buses"}, {"asker", "command_line"}}, patience_ms);
  const bool closed = drivers::clock_ns(CLOCK_MONOTONIC) - begin < patience_ms * image::kMillisecond;
  if (held.is_null() && !closed) {
    Holder holder;
    holder.socket = socket;
    holder.silent = true;
    return holder;
  }
  if (!held.is_object()) return std::nullopt;
  json all = held.value("buses", json::array());
  for (const json& line : held.value("lines", json::array())) all.push_back(line);
  for (const json& bus : all) {
    if (!machine::same_place(bus.value("place", bus.value("url", "")), place)) continue;
    Holder holder{
        socket, held.value("machine", ""), bus.value("name", ""), held.value("kind", "") == "run", false, {}};
    for (const json& n : bus.value("nodes", json::array()))
      holder.nodes.push_back(
          {n.value("node", 0), n.value("name", ""), n.value("online", false), nmt_state(n)});
    return holder;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Holder> holder_of(const NamedBus& bus, int patience_ms) {
  std::vector<std::string> sockets = known_sockets();
  const std::vector<std::string> runs = known_runs();
  sockets.insert(sockets.end(), runs.begin(), runs.end());
  const auto add = [&](const std::string& socket) {
    if (!socket.empty() && std::find(sockets.begin(), sockets.end(), socket) == sockets.end())
      sockets.push_back(socket);
  };
  if (const char* named = std::getenv("SERVOGATE_SOCKET"); named != nullptr) add(named);
  if (bus.machine && !bus.machine->machine.run.socket.empty())
    add(bus.machine->machine.resolve(bus.machine->machine.run.socket));
  const std::string place = machine::bus_place(bus.url);
  std::optional<Holder> silent;
  for (const std::string& socket : sockets) {
    auto holder = holder_at(socket, place, patience_ms);
    if (holder && !holder->silent) return holder;
    if (holder) silent = std::move(holder);
  }
  return silent;
}

bool find_holder(const std::string& bus, std::optional<Holder>& holder, int& code, bool at_once) {
  const auto named = named_bus(bus, 0.0);
  code = kWrongUse;
  if (!named) return false;
  holder = holder_of(*named, at_once ? kPatienceInAHurry : kHolderPatience);
  if (holder && holder->silent && at_once) holder.reset();
  if (!holder || !holder->silent) return true;
  code = refuse_held(*holder, bus, text::render(kThis, {}, text::user_language()));
  return false;
}

int refuse_held(const Holder& holder, const std::string& url, const std::string& what) {
  if (holder.silent) {
    complain(kSilent, {what, holder.socket, url});
    return kAlarm;
  }
  complain(holder.run ? kHeldByRun : kHeld, {what, url, holder.machine, holder.socket});
  return kAlarm;
}

std::unique_ptr<HeldBus> HeldBus::open(Holder holder, double timeout_ms) {
  std::unique_ptr<HeldBus> bus(new HeldBus(std::move(holder), timeout_ms));
  const std::string problem = bus->connection_.connect(bus->holder_.socket);
  if (problem.empty()) return bus;
  complain(kNoConnection, {bus->holder_.socket, problem});
  return nullptr;
}

SdoOutcome HeldBus::read(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex) {
  SdoOutcome outcome;
  refusal_.clear();
  const json answer = ask(connection_,
                          {{"cmd", "sdo_read"},
                           {"asker", "command_line"},
                           {"language", text::user_language() == text::Language::russian ? "ru" : "en"},
                           {"bus", holder_.bus},
                           {"node", node},
                           {"index", index},
                           {"subindex", subindex}},
                          static_cast<int>(timeout_ms_) + kHolderPatience);
  if (!answer.is_object()) return outcome;
  if (!answer.value("ok", false)) {
    refusal_ = answer.value("text", "");
    return outcome;
  }
  outcome.abort = static_cast<canopen::AbortCode>(answer.value("abort", 0U));
  const std::string status = answer.value("status", "");
  outcome.status = status == "done"      ? canopen::SdoStatus::done
                   : status == "aborted" ? canopen::SdoStatus::aborted
                                         : canopen::SdoStatus::no_answer;
  const auto bytes = canopen::encode_value(answer.value("data", ""), *canopen::type_named("hex"));
  if (bytes) outcome.data = *bytes;
  return outcome;
}

SdoOutcome HeldBus::write(canopen::NodeId, std::uint16_t, std::uint8_t, std::span<const std::uint8_t>) {
  SdoOutcome outcome;
  outcome.status = canopen::SdoStatus::aborted;
  outcome.abort = canopen::AbortCode::local_control;
  return outcome;
}

}  // namespace servogate::gateway::command
