// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

using nlohmann::json;

constexpr double kTolerance = 2e-4;  ///< the specification's numbers have four decimals
const std::string kFolder = servogate::tests::source_dir() + "/tests/program";

/// What a case gives when it is run as `servogate canon` runs it.
struct Outcome {
  std::vector<json> commands;
  std::optional<text::Finding> error;
  std::string warnings;  ///< one a line
};

ProgramLoader loader_of(const CaseFile& c) {
  return [&c](std::string_view name) -> std::optional<std::string> {
    const auto at = c.subprograms.find(std::string(name));
    if (at == c.subprograms.end()) return std::nullopt;
    return at->second;
  };
}

Outcome run(const CaseFile& c) {
  Outcome outcome;
  Interpreter interpreter(c.dialect, c.machine, c.tables, c.name + ".nc", c.program, loader_of(c), c.start);
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

void expect_all(const std::vector<json>& wanted, const std::vector<json>& got,
                const std::vector<CaseFile::Line>& lines, const CaseFile& c) {
  for (std::size_t i = 0; i < std::max(wanted.size(), got.size()); ++i) {
    if (i >= wanted.size()) {
      ADD_FAILURE() << c.path << ": not expected: " << got[i].dump();
    } else if (i >= got.size()) {
      ADD_FAILURE() << c.path << ":" << lines[i].number << ": missing: " << wanted[i].dump();
    } else {
      EXPECT_TRUE(matches(wanted[i], got[i])) << c.path << ":" << lines[i].number << ": expected "
                                              << wanted[i].dump() << "\n  got " << got[i].dump();
    }
  }
}

void expect_contained(const CaseFile& c, const std::vector<json>& got) {
  std::size_t at = 0;
  for (const auto& line : c.contained) {
    const json wanted = json::parse(line.text);
    while (at < got.size() && !matches(wanted, got[at])) ++at;
    ASSERT_LT(at, got.size()) << c.path << ":" << line.number << ": not found (in order): " << wanted.dump();
    ++at;
  }
}

/// What it is about can be gone to: `file:line:col`.
void expect_place(const text::Finding& finding) {
  EXPECT_GT(finding.line, 0) << finding.str();
  EXPECT_GT(finding.column, 0) << finding.str();
}

void expect_findings(const CaseFile& c) {
  const CheckReport report =
      check_program(c.dialect, c.machine, c.tables, c.name + ".nc", c.program, loader_of(c), c.start);
  for (const text::Finding& finding : report.findings) expect_place(finding);
  for (std::size_t i = 0; i < std::max(c.findings.size(), report.findings.size()); ++i) {
    const std::string got =
        i < report.findings.size() ? report.findings[i].str(text::Language::english) : "(nothing)";
    const std::string wanted = i < c.findings.size() ? c.findings[i].text : "(nothing)";
    EXPECT_EQ(wanted, got) << c.path;
  }
}

void judge(const CaseFile& c) {
  ASSERT_FALSE(c.program.empty()) << c.path << ": no [program]";
  ASSERT_FALSE(c.expected.empty() && c.contained.empty() && c.motions.empty() && c.errors.empty() &&
               c.findings.empty())
      << c.path << ": expects nothing";
  const Outcome outcome = run(c);
  const bool error_allowed = c.errors.empty() && !c.findings.empty();
  if (!error_allowed) {
    EXPECT_EQ(c.errors.empty() ? "" : c.errors.front().text,
              outcome.error ? outcome.error->str(text::Language::english) : "")
        << c.path;
    if (outcome.error) expect_place(*outcome.error);
  }
  if (!c.expected.empty()) {
    std::vector<json> wanted;
    for (const auto& line : c.expected) wanted.push_back(json::parse(line.text));
    expect_all(wanted, outcome.commands, c.expected, c);
  }
  if (!c.motions.empty()) {
    std::vector<json> wanted, motions;
    for (const auto& line : c.motions) wanted.push_back(short_form(line.text));
    for (const auto& command : outcome.commands)
      if (is_motion(command)) motions.push_back(command);
    expect_all(wanted, motions, c.motions, c);
  }
  expect_contained(c, outcome.commands);
  if (!c.findings.empty())
    expect_findings(c);
  else
    EXPECT_EQ("", outcome.warnings) << c.path;
}

class ProgramCase : public testing::TestWithParam<std::string> {};

TEST_P(ProgramCase, gives_what_its_file_expects) {
  CaseFile c;
  ASSERT_NO_THROW(c = read_case(GetParam()));
  judge(c);
}

std::string case_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = std::filesystem::relative(info.param, kFolder).replace_extension().string();
  for (char& ch : name)
    if (std::isalnum(static_cast<unsigned char>(ch)) == 0) ch = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, ProgramCase, testing::ValuesIn(case_paths(kFolder)), case_name);

}  // namespace
}  // namespace servogate::program::tests
