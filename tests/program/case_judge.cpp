// SPDX-License-Identifier: Apache-2.0
#include "tests/program/case_judge.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"

namespace servogate::program::tests {
namespace {

using nlohmann::json;

constexpr double kTolerance = 2e-4;  ///< the specification's numbers have four decimals

/// What a case gives when it is run as `servogate canon` runs it.
struct Outcome {
  std::vector<json> commands;
  std::optional<text::Finding> error;
  std::string warnings;  ///< one a line
};

Outcome run(const CaseFile& c) {
  Outcome outcome;
  Interpreter interpreter(c.dialect, c.machine, c.tables, c.name + ".nc", c.program, c.loader(), c.start);
  const auto error = write_canon(interpreter, c.machine, [&](std::string_view line) {
    outcome.commands.push_back(json::parse(line));
    return true;
  });
  outcome.error = error;
  for (const auto& warning : interpreter.warnings())
    outcome.warnings += warning.str(text::Language::english) + "\n";
  return outcome;
}

/// True when every key of `wanted` stands in `got` with the same value, numbers within the tolerance.
bool matches(const json& wanted, const json& got) {
  if (wanted.is_number() && got.is_number())
    return std::abs(wanted.get<double>() - got.get<double>()) <=
           kTolerance * std::max(1.0, std::abs(wanted.get<double>()) * 1e-3);
  if (!wanted.is_object()) return wanted == got;
  for (const auto& [key, value] : wanted.items())
    if (!got.is_object() || !got.contains(key) || !matches(value, got.at(key))) return false;
  return true;
}

/// "arc X0 Y30 centre X0 Y0 sweep 90 feed 300 line 4" as the JSON that it stands for.
json short_form(const std::string& text) {
  std::istringstream in(text);
  std::string word;
  in >> word;
  json wanted = {{"cmd", word}};
  std::string into = "to";
  while (in >> word) {
    if (word == "centre") {
      into = "center";
    } else if (word == "sweep" || word == "feed" || word == "line") {
      double value = 0.0;
      in >> value;
      wanted[word] = value;
    } else if (word == "plane" || word == "transition" || word == "feed_unit") {
      std::string value;
      in >> value;
      wanted[word] = value;
    } else {
      wanted[into][word.substr(0, 1)] = std::stod(word.substr(1));
    }
  }
  return wanted;
}

bool is_motion(const json& command) {
  const auto& cmd = command.at("cmd");
  return cmd == "rapid" || cmd == "line" || cmd == "arc" || cmd == "thread" || cmd == "probe";
}

class Judge {
 public:
  explicit Judge(const CaseFile& c) : case_(c) {}

  std::vector<std::string> judge() {
    if (case_.program.empty()) return {case_.path + ": no [program]"};
    if (case_.expected.empty() && case_.contained.empty() && case_.motions.empty() && case_.errors.empty() &&
        case_.findings.empty() && case_.rs274.empty())
      return {case_.path + ": expects nothing"};
    const Outcome outcome = run(case_);
    if (!case_.errors.empty() || case_.findings.empty()) error(outcome);
    if (!case_.expected.empty()) all(as_json(case_.expected), outcome.commands, case_.expected);
    if (!case_.motions.empty()) motions(outcome);
    contained(outcome.commands);
    if (!case_.findings.empty())
      findings();
    else
      same("", outcome.warnings);
    return std::move(failures_);
  }

 private:
  void tell(const std::string& what) { failures_.push_back(case_.path + ": " + what); }
  void same(const std::string& wanted, const std::string& got) {
    if (wanted != got) tell("expected\n  " + wanted + "\n  got\n  " + got);
  }
  /// What it is about can be gone to: `file:line:col`.
  void has_place(const text::Finding& finding) {
    if (finding.line <= 0 || finding.column <= 0) tell("no place: " + finding.str());
  }
  static std::vector<json> as_json(const std::vector<CaseFile::Line>& lines) {
    std::vector<json> wanted;
    for (const auto& line : lines) wanted.push_back(json::parse(line.text));
    return wanted;
  }

  void error(const Outcome& outcome) {
    same(case_.errors.empty() ? "" : case_.errors.front().text,
         outcome.error ? outcome.error->str(text::Language::english) : "");
    if (outcome.error) has_place(*outcome.error);
  }

  void all(const std::vector<json>& wanted, const std::vector<json>& got,
           const std::vector<CaseFile::Line>& lines) {
    for (std::size_t i = 0; i < std::max(wanted.size(), got.size()); ++i) {
      if (i >= wanted.size()) {
        tell("not expected: " + got[i].dump());
      } else if (i >= got.size()) {
        tell("line " + std::to_string(lines[i].number) + ": missing: " + wanted[i].dump());
      } else if (!matches(wanted[i], got[i])) {
        tell("line " + std::to_string(lines[i].number) + ": expected " + wanted[i].dump() + "\n  got " +
             got[i].dump());
      }
    }
  }

  void motions(const Outcome& outcome) {
    std::vector<json> wanted, got;
    for (const auto& line : case_.motions) wanted.push_back(short_form(line.text));
    for (const auto& command : outcome.commands)
      if (is_motion(command)) got.push_back(command);
    all(wanted, got, case_.motions);
  }

  void contained(const std::vector<json>& got) {
    std::size_t at = 0;
    for (const auto& line : case_.contained) {
      const json wanted = json::parse(line.text);
      while (at < got.size() && !matches(wanted, got[at])) ++at;
      if (at == got.size())
        return tell("line " + std::to_string(line.number) + ": not found (in order): " + wanted.dump());
      ++at;
    }
  }

  void findings() {
    const CheckReport report = check_program(case_.dialect, case_.machine, case_.tables, case_.name + ".nc",
                                             case_.program, case_.loader(), case_.start);
    for (const text::Finding& finding : report.findings) has_place(finding);
    for (std::size_t i = 0; i < std::max(case_.findings.size(), report.findings.size()); ++i)
      same(i < case_.findings.size() ? case_.findings[i].text : "(nothing)",
           i < report.findings.size() ? report.findings[i].str(text::Language::english) : "(nothing)");
  }

  const CaseFile& case_;
  std::vector<std::string> failures_;
};

}  // namespace

std::vector<std::string> failures_of(const CaseFile& c) { return Judge(c).judge(); }

}  // namespace servogate::program::tests
