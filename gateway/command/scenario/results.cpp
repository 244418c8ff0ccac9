// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/results.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "gateway/command/junit.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
using scenario::Scenario;
using Status = scenario::Outcome::Status;

std::string class_of(const Scenario& s) {
  constexpr std::string_view kEnding = ".scenario.toml";
  return s.file.ends_with(kEnding) ? s.file.substr(0, s.file.size() - kEnding.size()) : s.file;
}

JUnitCase junit_case(const Scenario& s, const Result& r) {
  JUnitCase c;
  c.classname = class_of(s);
  c.name = s.name;
  c.file = s.file;
  c.line = r.line > 0 ? r.line : s.at.line;
  c.time_s = r.wall_s;
  c.result = r.status == Status::passed    ? JUnitCase::Result::passed
             : r.status == Status::failed  ? JUnitCase::Result::failed
             : r.status == Status::skipped ? JUnitCase::Result::skipped
                                           : JUnitCase::Result::error;
  c.message = r.message;
  for (const std::string& finding : r.findings) c.message += (c.message.empty() ? "" : "\n") + finding;
  c.type = r.failed() ? "expectation" : std::string(name_of(r.status));
  c.body = (r.diagram.empty() ? "" : r.diagram + "\n") + again(s);
  c.properties.emplace_back("virtual_time", text::number(r.virtual_s, 3));
  if (s.seed) c.properties.emplace_back("seed", std::to_string(*s.seed));
  for (const std::string& requirement : s.verifies) c.properties.emplace_back("requirement", requirement);
  c.properties.insert(c.properties.end(), s.parameters.begin(), s.parameters.end());
  c.attachments = r.artifacts;
  return c;
}

}  // namespace

std::string_view name_of(Status status) {
  constexpr std::string_view kNames[] = {"passed", "failed", "skipped", "impossible", "infrastructure"};
  return kNames[static_cast<std::size_t>(status)];
}

int Results::count(Status status) const {
  return static_cast<int>(
      std::count_if(results.begin(), results.end(), [&](const Result& r) { return r.status == status; }));
}

std::string again(const Scenario& s) {
  std::string name = s.name;
  for (std::size_t at = 0; (at = name.find('\'', at)) != std::string::npos; at += 4)
    name.replace(at, 1, "'\\''");
  std::string line = "servogate test '" + s.file + "' --name '" + name + "'";
  return s.seed ? line + " --seed " + std::to_string(*s.seed) : line;
}

std::string to_junit(const Results& all) {
  std::vector<JUnitCase> cases;
  for (std::size_t n = 0; n < all.scenarios.size(); ++n)
    cases.push_back(junit_case(all.scenarios[n], all.results[n]));
  return junit("servogate test", cases);
}

std::string to_tap(const Results& all) {
  std::string out = "TAP version 13\n1.." + std::to_string(all.results.size()) + "\n";
  for (std::size_t n = 0; n < all.results.size(); ++n) {
    const Result& r = all.results[n];
    const bool good = r.status == Status::passed || r.status == Status::skipped;
    std::string name = all.scenarios[n].file + ": " + all.scenarios[n].name;
    std::replace(name.begin(), name.end(), '#', ' ');
    out += std::string(good ? "ok " : "not ok ") + std::to_string(n + 1) + " - " + name;
    if (r.status == Status::skipped) out += " # SKIP " + r.message;
    out += "\n";
    if (!good)
      out += "  ---\n  message: " + json(r.message).dump() +
             "\n  again: " + json(again(all.scenarios[n])).dump() + "\n  ...\n";
  }
  return out;
}

std::string to_json(const Results& all) {
  json list = json::array();
  for (std::size_t n = 0; n < all.results.size(); ++n) {
    const Scenario& s = all.scenarios[n];
    const Result& r = all.results[n];
    json entry{{"file", s.file},           {"line", r.line > 0 ? r.line : s.at.line},
               {"title", s.title},         {"name", s.name},
               {"machine", s.machine},     {"status", name_of(r.status)},
               {"verifies", s.verifies},   {"tags", s.tags},
               {"virtual_s", r.virtual_s}, {"wall_s", r.wall_s}};
    for (const auto& [name, value] : s.parameters) entry["parameters"][name] = value;
    if (s.seed) entry["seed"] = *s.seed;
    if (!r.message.empty()) entry["message"] = r.message;
    if (r.failed()) entry["t"] = r.t_s;
    if (!r.diagram.empty()) entry["diagram"] = r.diagram;
    if (!r.findings.empty()) entry["findings"] = r.findings;
    if (!r.artifacts.empty()) entry["artifacts"] = r.artifacts;
    if (!r.smallest.empty()) entry["smallest"] = r.smallest;
    if (r.status != Status::passed) entry["again"] = again(s);
    list.push_back(std::move(entry));
  }
  const json out{{"schema", 1},
                 {"scenarios", std::move(list)},
                 {"passed", all.count(Status::passed)},
                 {"failed", all.count(Status::failed)},
                 {"skipped", all.count(Status::skipped)},
                 {"errors", all.count(Status::impossible) + all.count(Status::infrastructure)},
                 {"wall_s", all.wall_s}};
  return out.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string trace_table(const Results& all) {
  std::map<std::string, std::vector<std::size_t>> by_requirement;
  for (std::size_t n = 0; n < all.scenarios.size(); ++n)
    for (const std::string& requirement : all.scenarios[n].verifies) by_requirement[requirement].push_back(n);
  std::string out = "| requirement | scenario | result |\n|---|---|---|\n";
  for (const auto& [requirement, of] : by_requirement)
    for (const std::size_t n : of) {
      std::string name = all.scenarios[n].file + ": " + all.scenarios[n].name;
      std::replace(name.begin(), name.end(), '|', '/');
      out += "| " + requirement + " | " + name + " | " + std::string(name_of(all.results[n].status)) + " |\n";
    }
  return out;
}

}  // namespace servogate::gateway::command
