// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/bus_reading.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "gateway/cli/options.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

namespace {

using canopen::SdoStatus;
using nlohmann::json;

/// What came of a question.
struct ReadThrough {
  /// `bus` is no bus of the machine, or the object is none: what the question names wrongly.
  bool unknown = false;
  /// The bus has no such node.
  bool foreign = false;
  /// Another question is under way, or the cycle does not come to it.
  bool no_answer = false;
  json answer;  ///< status, abort, data; null without an answer
};

/// The master's own patience with a node, and as much again for its turn.
constexpr auto kPatience = std::chrono::milliseconds(1500);

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  char two[3];
  for (const std::uint8_t b : bytes) {
    std::snprintf(two, sizeof two, "%02X", b);
    text += two;
  }
  return text;
}

int number(const json& request, const char* key) {
  const auto found = request.find(key);
  if (found == request.end() || !found->is_number_integer()) return -1;
  const auto value = found->get<std::int64_t>();
  return value >= 0 && value <= 0xFFFF ? static_cast<int>(value) : -1;
}

CanSupplier* supplier_of(Control& control, const json& request) {
  const auto& buses = control.machine().buses;
  const auto found = request.find("bus");
  if (found == request.end() || !found->is_string()) return nullptr;
  for (std::size_t i = 0; i < buses.size() && i < control.suppliers().size(); ++i)
    if (buses[i].name == found->get<std::string>()) return control.suppliers()[i].get();
  return nullptr;
}

ReadThrough read_object(Control& control, const json& request) {
  ReadThrough out;
  CanSupplier* supplier = supplier_of(control, request);
  const int node = number(request, "node"), index = number(request, "index"),
            subindex = number(request, "subindex");
  out.unknown =
      supplier == nullptr || node < 0 || index < 0 || index > 0xFFFF || subindex < 0 || subindex > 0xFF;
  if (out.unknown) return out;
  const auto& nodes = supplier->segment().config().nodes;
  out.foreign = std::none_of(nodes.begin(), nodes.end(), [&](const auto& n) { return n.node == node; });
  if (out.foreign) return out;
  canopen::ObjectQuestion& question = supplier->question();
  out.no_answer = true;
  if (!question.ask(static_cast<canopen::NodeId>(node), static_cast<std::uint16_t>(index),
                    static_cast<std::uint8_t>(subindex)))
    return out;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!question.answered() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  if (question.answered()) {
    out.no_answer = false;
    const SdoStatus status = question.status();
    out.answer = {{"status", status == SdoStatus::done      ? "done"
                             : status == SdoStatus::aborted ? "aborted"
                                                            : "no_answer"},
                  {"abort", static_cast<std::uint32_t>(question.abort())},
                  {"data", hex(question.data())}};
  }
  question.done();
  return out;
}

}  // namespace

Reply sdo_read(Control& control, const json& request, text::Language language) {
  ReadThrough read = read_object(control, request);
  if (read.unknown) return refuse(says::kNoSuchObject, {}, kWrongUse, language);
  if (read.foreign) {
    std::string names;
    for (const auto& n : supplier_of(control, request)->segment().config().nodes)
      names += (names.empty() ? "" : ", ") + std::to_string(n.node);
    return refuse(says::kForeignNode, {std::to_string(number(request, "node")), names}, kAlarm, language);
  }
  if (read.no_answer) return refuse(says::kObjectUnanswered, {}, kAlarm, language);
  return accept(says::kObjectRead, {}, language, std::move(read.answer));
}

}  // namespace servogate::gateway
