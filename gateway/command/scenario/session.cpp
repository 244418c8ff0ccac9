// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/session.hpp"

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/reading/read_scenario.hpp"
#include "bench/scenario/time_line/run.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/machine_start.hpp"
#include "gateway/control/scenario/desk_operator.hpp"
#include "gateway/control/server/protocol/reply_json.hpp"
#include "gateway/control/server/protocol/request_form.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
using scenario::Outcome;

const text::Entry kNotVirtual{
    "test.session_real", "a session steps machines of virtual time, and this one has real buses or devices",
    "сеанс работает со станками виртуального времени, а у этого настоящие шины или устройства"};
const text::Entry kNotObject{"test.session_line",
                             "a line is an object with `step`, `read`, `alarms` or `ask`",
                             "строка — объект с `step`, `read`, `alarms` или `ask`"};

machine::Element to_element(const json& value) {
  using Kind = machine::Element::Kind;
  machine::Element e;
  e.at = e.key_at = {1, 1};
  if (value.is_boolean()) {
    e.kind = Kind::boolean;
    e.boolean = value.get<bool>();
  } else if (value.is_number_integer()) {
    e.kind = Kind::integer;
    e.integer = value.get<std::int64_t>();
  } else if (value.is_number()) {
    e.kind = Kind::real;
    e.real = value.get<double>();
  } else if (value.is_string()) {
    e.kind = Kind::string;
    e.string = value.get<std::string>();
  } else if (value.is_array()) {
    e.kind = Kind::array;
    for (const json& item : value) e.children.push_back(to_element(item));
  } else if (value.is_object()) {
    for (const auto& [key, item] : value.items()) {
      e.children.push_back(to_element(item));
      e.children.back().key = key;
    }
  }
  return e;
}

/// A machine that another program steps, line by line.
class SessionLoop {
 public:
  explicit SessionLoop(RunningMachine& machine)
      : machine_(machine),
        who_(machine),
        signals_(machine.machine(), machine.control().symbols(), &who_.variables()),
        session_(machine, who_, signals_) {}

  void run() {
    print({{"ok", true}, {"machine", machine_.machine().name}});
    for (std::string line; std::getline(std::cin, line);) {
      const json request = json::parse(line, nullptr, false);
      if (!print(answer(request))) return;
    }
  }

 private:
  bool print(json answer) {
    answer["t"] = static_cast<double>(machine_.image().now.t_ns) * 1e-9;
    const bool printed = print_exact(answer.dump(-1, ' ', false, json::error_handler_t::replace));
    keep_order();
    return printed;
  }

  static json wrong(const std::vector<text::Finding>& findings) {
    json list = json::array();
    for (const text::Finding& f : findings)
      list.push_back(text::render(*f.entry, f.arguments, text::user_language()));
    return {{"ok", false}, {"status", "impossible"}, {"findings", std::move(list)}};
  }
  static json wrong(const std::string& message) {
    return {{"ok", false}, {"status", "impossible"}, {"message", message}};
  }

  json answer(const json& request) {
    if (!request.is_object()) return wrong(text::render(kNotObject, {}, text::user_language()));
    if (const auto step = request.find("step"); step != request.end()) return perform(*step);
    if (const auto names = request.find("read"); names != request.end()) return read(*names);
    if (request.contains("alarms")) return alarms();
    if (const auto asked = request.find("ask"); asked != request.end()) return ask(*asked);
    return wrong(text::render(kNotObject, {}, text::user_language()));
  }

  json perform(const json& keys) {
    std::vector<text::Finding> findings;
    const auto step = scenario::read_step(to_element(keys), findings);
    if (!step) return wrong(findings);
    const Outcome outcome = session_.perform(*step);
    if (outcome.status == Outcome::Status::passed) return {{"ok", true}};
    if (outcome.status == Outcome::Status::impossible) return wrong(outcome.findings);
    json out{{"ok", false},
             {"status", "failed"},
             {"message", text::in_language(outcome.message)},
             {"diagram", outcome.diagram}};
    if (!outcome.code.empty()) out["code"] = outcome.code;
    return out;
  }

  json read(const json& names) {
    json values = json::array();
    const cycle::AlarmSnapshot& alarms = machine_.alarms();
    for (const json& name : names) {
      const auto signal = name.is_string() ? signals_.find(name.get<std::string>()) : std::nullopt;
      if (!signal)
        return wrong(text::render(scenario::finding::kUnknownSignal, std::vector<std::string>{name.dump()},
                                  text::user_language()));
      const double value = signal->read({machine_.image(), alarms});
      if (signal->digital)
        values.push_back(value != 0.0);
      else if (!signal->words.empty())
        values.push_back(scenario::words_of(value, *signal));
      else
        values.push_back(value);
    }
    return {{"ok", true}, {"values", std::move(values)}};
  }

  json alarms() {
    const cycle::AlarmSnapshot& now = machine_.alarms();
    json numbers = json::array();
    for (int n = 0; n < now.count; ++n)
      if (now.records[static_cast<std::size_t>(n)].active)
        numbers.push_back(now.records[static_cast<std::size_t>(n)].number);
    return {{"ok", true}, {"alarms", std::move(numbers)}};
  }

  json ask(json asked) {
    if (asked.is_object()) asked["asker"] = "scenario";
    FormProblem problem;
    const auto request = read_request(asked.dump(), problem);
    if (!request) return wrong(text::render(*problem.entry, problem.arguments, text::user_language()));
    const Reply reply = who_.ask(request->command, request->language, [this] { return session_.advance(); });
    json out{{"ok", reply.ok}, {"reply", json::parse(line_of(reply), nullptr, false)}};
    if (!reply.ok) out.update({{"status", "failed"}, {"message", reply.text}, {"code", reply.code}});
    return out;
  }

  RunningMachine& machine_;
  DeskOperator who_;
  scenario::Signals signals_;
  scenario::Session session_;
};

}  // namespace

int session(const std::string& machine_file) {
  const machine::LoadResult loaded = machine::load(machine_file);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  ClockKind clock = ClockKind::unset;
  if (!settle_clock(loaded.machine, clock)) return kWrongUse;
  if (clock != ClockKind::virtual_time || !loaded.machine.nothing_real()) {
    complain(kNotVirtual, {});
    return kWrongUse;
  }
  std::vector<text::Finding> findings;
  const auto machine =
      RunningMachine::compose(loaded, nullptr, {.clock = clock, .announce = to_standard_error()}, findings);
  print_findings(findings);
  if (machine == nullptr) return Control::infrastructure(findings) ? kInfrastructure : kWrongUse;
  SessionLoop(*machine).run();
  machine->stop();
  return kDone;
}

}  // namespace servogate::gateway::command
