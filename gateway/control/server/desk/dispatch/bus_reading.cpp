// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/bus_reading.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

using canopen::SdoStatus;

/// The master's own patience with a node, and as much again for its turn.
constexpr auto kPatience = std::chrono::milliseconds(1500);
constexpr int kMostSteps = 20'000;  ///< more cycles than the master waits for, whatever their length

CanSupplier* supplier_of(Control& control, const std::string& bus) {
  const auto& buses = control.machine().buses;
  for (std::size_t i = 0; i < buses.size() && i < control.suppliers().size(); ++i)
    if (buses[i].name == bus) return control.suppliers()[i].get();
  return nullptr;
}

std::string_view name_of(SdoStatus status) {
  return status == SdoStatus::done ? "done" : status == SdoStatus::aborted ? "aborted" : "no_answer";
}

/// nullopt: another question is under way, or the cycle does not come to it.
std::optional<ObjectRead> read_object(canopen::ObjectQuestion& question, const ask::SdoRead& wanted,
                                      const std::function<bool()>& pause) {
  if (!question.ask(static_cast<canopen::NodeId>(wanted.node), static_cast<std::uint16_t>(wanted.index),
                    static_cast<std::uint8_t>(wanted.subindex)))
    return std::nullopt;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  int steps = 0;
  while (!question.answered()) {
    if (pause != nullptr) {
      if (!pause() || ++steps > kMostSteps) break;
    } else {
      if (std::chrono::steady_clock::now() >= until) break;
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
  }
  std::optional<ObjectRead> read;
  if (question.answered()) {
    const auto data = question.data();
    read = {
        name_of(question.status()), static_cast<std::uint32_t>(question.abort()), {data.begin(), data.end()}};
  }
  question.done();
  return read;
}

}  // namespace

Reply sdo_read(Control& control, const ask::SdoRead& wanted, text::Language language,
               const std::function<bool()>& pause) {
  CanSupplier* const supplier = supplier_of(control, wanted.bus);
  if (supplier == nullptr || wanted.node < 0 || wanted.index < 0 || wanted.subindex < 0)
    return refuse(says::kNoSuchObject, {}, kWrongUse, language);
  const auto& nodes = supplier->segment().config().nodes;
  if (std::none_of(nodes.begin(), nodes.end(), [&](const auto& n) { return n.node == wanted.node; })) {
    std::string names;
    for (const auto& n : nodes) names += (names.empty() ? "" : ", ") + std::to_string(n.node);
    return refuse(says::kForeignNode, {std::to_string(wanted.node), names}, kAlarm, language);
  }
  std::optional<ObjectRead> read = read_object(supplier->question(), wanted, pause);
  if (!read) return refuse(says::kObjectUnanswered, {}, kAlarm, language);
  return accept(says::kObjectRead, {}, language, std::move(*read));
}

}  // namespace servogate::gateway
