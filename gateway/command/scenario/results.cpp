// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/results.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
using scenario::Scenario;
using Status = scenario::Outcome::Status;

/// For XML 1.0: what has a meaning there, and the characters that it cannot hold.
std::string xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
        out += "&#10;";
        break;
      case '\t':
        out += "&#9;";
        break;
      default:
        if (code < 0x20 || code == 0x7F)
          out += "\\x" + std::string(1, "0123456789ABCDEF"[code >> 4]) + "0123456789ABCDEF"[code & 15];
        else
          out += c;
    }
  }
  return out;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + xml(value) + "\"";
}
std::string attribute(const char* name, double value) { return attribute(name, text::number(value, 6)); }
std::string attribute(const char* name, int value) { return attribute(name, std::to_string(value)); }

std::string property(const char* name, const std::string& value) {
  return "        <property" + attribute("name", std::string(name)) + attribute("value", value) + "/>\n";
}

std::string class_of(const Scenario& s) {
  constexpr std::string_view kEnding = ".scenario.toml";
  return s.file.ends_with(kEnding) ? s.file.substr(0, s.file.size() - kEnding.size()) : s.file;
}

std::string testcase(const Scenario& s, const Result& r) {
  std::string out = "    <testcase" + attribute("classname", class_of(s)) + attribute("name", s.name) +
                    attribute("file", s.file) + attribute("line", r.line > 0 ? r.line : s.at.line) +
                    attribute("time", r.wall_s) + ">\n      <properties>\n" +
                    property("virtual_time", text::number(r.virtual_s, 3));
  if (s.seed) out += property("seed", std::to_string(*s.seed));
  for (const std::string& requirement : s.verifies) out += property("requirement", requirement);
  for (const auto& [name, value] : s.parameters) out += property(name.c_str(), value);
  out += "      </properties>\n";
  const std::string rest = (r.diagram.empty() ? "" : r.diagram + "\n") + again(s);
  if (r.status == Status::failed)
    out += "      <failure" + attribute("message", r.message) +
           attribute("type", std::string("expectation")) + ">" + xml(rest) + "</failure>\n";
  else if (r.status == Status::skipped)
    out += "      <skipped" + attribute("message", r.message) + "/>\n";
  else if (r.status != Status::passed)
    out += "      <error" + attribute("message", r.message) +
           attribute("type", std::string(name_of(r.status))) + ">" + xml(again(s)) + "</error>\n";
  std::string attached;
  for (const std::string& file : r.artifacts) attached += "[[ATTACHMENT|" + file + "]]\n";
  if (!attached.empty()) out += "      <system-out>" + xml(attached) + "</system-out>\n";
  return out + "    </testcase>\n";
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
  std::map<std::string, std::vector<std::size_t>> files;
  for (std::size_t n = 0; n < all.scenarios.size(); ++n) files[all.scenarios[n].file].push_back(n);
  const auto counts = [&](const std::vector<std::size_t>& of) {
    int failed = 0, errors = 0, skipped = 0;
    double wall = 0.0;
    for (const std::size_t n : of) {
      const Result& r = all.results[n];
      failed += r.failed() ? 1 : 0;
      skipped += r.status == Status::skipped ? 1 : 0;
      errors += r.status == Status::impossible || r.status == Status::infrastructure ? 1 : 0;
      wall += r.wall_s;
    }
    return attribute("tests", static_cast<int>(of.size())) + attribute("failures", failed) +
           attribute("errors", errors) + attribute("skipped", skipped) + attribute("time", wall);
  };
  std::vector<std::size_t> every;
  for (std::size_t n = 0; n < all.scenarios.size(); ++n) every.push_back(n);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" +
                    attribute("name", std::string("servogate test")) + counts(every) + ">\n";
  for (const auto& [file, of] : files) {
    out += "  <testsuite" + attribute("name", file) + attribute("file", file) + counts(of) + ">\n";
    for (const std::size_t n : of) out += testcase(all.scenarios[n], all.results[n]);
    out += "  </testsuite>\n";
  }
  return out + "</testsuites>\n";
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
