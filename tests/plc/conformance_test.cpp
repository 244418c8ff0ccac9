// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cctype>

#include "plc/run/run.hpp"
#include "plc/syntax/time_literal.hpp"
#include "tests/plc/data_files.hpp"

namespace servogate::plc {
namespace {

std::string trimmed(std::string s) {
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.back()))) s.pop_back();
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.front()))) s.erase(s.begin());
  return s;
}

/// The lines of a run, or its findings when it did not end well.
std::vector<std::string> run_lines(const RunRequest& request) {
  std::vector<std::string> out;
  const RunResult r = run(request, [&](std::string_view l) {
    out.emplace_back(l);
    return true;
  });
  if (r.end != RunResult::End::done)
    for (const text::Finding& f : r.findings)
      if (f.severity == text::Severity::error) out.push_back(f.str(text::Language::english));
  return out;
}

// ------------------------------------------------------------------------------------------------
// expressions

/// `INT | INT#32767 + INT#1 | -32768`: the type of the result, the expression, its value as JSON, or `fault
/// X`. Each is computed twice: as written (the compiler folds it), and with every typed literal in a
/// variable.
struct ExpressionLine {
  std::string type, expression, expected;
};

std::string in_variables(const std::string& e, std::string& declarations) {
  std::string out;
  int count = 0;
  for (std::size_t i = 0; i < e.size();) {
    if (e[i] == '\'' || e[i] == '"') {
      std::size_t end = i + 1;
      while (end < e.size() && e[end] != e[i]) end += e[end] == '$' ? 2 : 1;
      out += e.substr(i, end - i + 1);
      i = end + 1;
      continue;
    }
    std::size_t n = i;
    while (n < e.size() && (std::isalnum(static_cast<unsigned char>(e[n])) || e[n] == '_')) ++n;
    if (n == i || n >= e.size() || e[n] != '#' || std::isdigit(static_cast<unsigned char>(e[i]))) {
      if (n == i) ++n;
      out += e.substr(i, n - i);
      i = n;
      continue;
    }
    std::string type = e.substr(i, n - i);
    std::size_t end = n + 1;
    const Kind kind = syntax::time_prefix(key_of(type));
    const bool time = kind != Kind::none;
    if (e[end] == '\'' || e[end] == '"') {
      end = e.find(e[end], end + 1) + 1;
    } else {
      if (e[end] == '-') ++end;
      while (end < e.size() &&
             (std::isalnum(static_cast<unsigned char>(e[end])) || e[end] == '_' || e[end] == '.' ||
              e[end] == '#' || (time && (e[end] == ':' || (kind != Kind::time && e[end] == '-')))))
        ++end;
      // 1.0E-5
      if (end < e.size() && e[end - 1] == 'E' && e[end] == '-') {
        ++end;
        while (end < e.size() && std::isdigit(static_cast<unsigned char>(e[end]))) ++end;
      }
    }
    const std::string literal = e.substr(i, end - i);
    if (time)
      type = kind == Kind::time ? "TIME" : kind == Kind::date ? "DATE" : kind == Kind::tod ? "TOD" : "DT";
    const std::string name = "v" + std::to_string(++count);
    declarations += name + " : " + type + " := " + literal + "; ";
    out += name;
    i = end;
  }
  return out;
}

std::string evaluate(const std::string& type, const std::string& expression,
                     const std::string& declarations) {
  RunRequest r;
  r.files = {{"case.st", "PROGRAM Main VAR r : " + type + "; " + declarations +
                             " END_VAR\nr := " + expression + ";\nEND_PROGRAM\n"}};
  r.prints = {"r"};
  const std::vector<std::string> out = run_lines(r);
  if (out.empty()) return "nothing";
  const std::string head = "{\"cycle\":1,\"values\":{\"r\":";
  if (!out[0].starts_with(head)) {
    const std::size_t code = out[0].rfind('[');
    return "fault " + out[0].substr(code + 1, out[0].size() - code - 2);
  }
  return out[0].substr(head.size(), out[0].size() - head.size() - 2);
}

class Expressions : public testing::TestWithParam<std::string> {};

TEST_P(Expressions, give_the_values_of_the_standard_folded_and_computed) {
  int number = 0, cases = 0;
  for (const std::string& line : lines_of(GetParam())) {
    ++number;
    if (trimmed(line).empty() || line[0] == '#') continue;
    const std::size_t first = line.find(" | "), last = line.rfind(" | ");
    ASSERT_LT(first, last) << GetParam() << ":" << number;
    const std::string type = trimmed(line.substr(0, first)), expected = trimmed(line.substr(last + 3));
    const std::string expression = trimmed(line.substr(first + 3, last - first - 3));
    std::string declarations;
    const std::string computed = in_variables(expression, declarations);
    const bool fault = expected.starts_with("fault ");
    if (!fault) {
      EXPECT_EQ(evaluate(type, expression, ""), expected) << GetParam() << ":" << number << " folded";
    }
    EXPECT_EQ(evaluate(type, computed, declarations), expected) << GetParam() << ":" << number << " computed";
    ++cases;
  }
  EXPECT_GT(cases, 10);
}

INSTANTIATE_TEST_SUITE_P(Files, Expressions, testing::ValuesIn(data_files("conformance", ".expr")),
                         [](const auto& i) { return stem(i.param); });

// ---------------------------------------------------------------------------------------------------
// programs

/// Behind `---`: `set NAME=VALUE[@CYCLE]`, `cycle_ms N`, and `CYCLE: NAME = JSON, ...` or `CYCLE: fault
/// CODE:LINE`.
class Programs : public testing::TestWithParam<std::string> {};

struct Expectation {
  std::int64_t cycle;
  std::string name, value;
};

bool read_expectation(const std::string& line, std::vector<Expectation>& out) {
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos || !std::isdigit(static_cast<unsigned char>(line[0]))) return false;
  const std::int64_t cycle = std::stoll(line.substr(0, colon));
  std::string rest = trimmed(line.substr(colon + 1));
  if (rest.starts_with("fault ")) {
    out.push_back({cycle, "", rest.substr(6)});
    return true;
  }
  for (std::size_t at = 0; at < rest.size();) {
    std::size_t end = at;
    for (int depth = 0; end < rest.size() && (depth > 0 || rest.compare(end, 2, ", ") != 0); ++end)
      depth += rest[end] == '[' || rest[end] == '{' ? 1 : rest[end] == ']' || rest[end] == '}' ? -1 : 0;
    const std::string part = rest.substr(at, end - at);
    const std::size_t equal = part.find(" = ");
    if (equal == std::string::npos) return false;
    out.push_back({cycle, trimmed(part.substr(0, equal)), trimmed(part.substr(equal + 3))});
    at = end + 2;
  }
  return true;
}

void run_case(const DataCase& c, const std::string& file) {
  SCOPED_TRACE(file + ":" + std::to_string(c.line) + " " + c.title);
  RunRequest r;
  r.files = {{"case.st", c.source}};
  r.options.warnings = false;
  std::vector<Expectation> wanted;
  for (const std::string& line : c.rest) {
    RunSet set;
    if (line.starts_with("set ") && parse_set(line.substr(4), set)) {
      r.sets.push_back(set);
    } else if (line.starts_with("cycle_ms ")) {
      r.cycle_ns = std::stoll(line.substr(9)) * image::kMillisecond;
    } else {
      EXPECT_TRUE(read_expectation(line, wanted)) << "cannot read: " << line;
    }
  }
  ASSERT_FALSE(wanted.empty());
  for (const Expectation& e : wanted) {
    r.cycles = std::max(r.cycles, e.cycle);
    if (!e.name.empty() && std::find(r.prints.begin(), r.prints.end(), e.name) == r.prints.end())
      r.prints.push_back(e.name);
  }
  const std::vector<std::string> lines = run_lines(r);
  for (const Expectation& e : wanted) {
    ASSERT_GE(static_cast<std::int64_t>(lines.size()), e.cycle) << (lines.empty() ? "" : lines.back());
    const std::string& line = lines[static_cast<std::size_t>(e.cycle) - 1];
    if (e.name.empty()) {  // case.st:4:1: error: ... [code]
      const std::size_t code = line.rfind('[');
      const std::string line_number = line.substr(8, line.find(':', 8) - 8);
      EXPECT_EQ(line.substr(code + 1, line.size() - code - 2) + ":" + line_number, e.value) << line;
      continue;
    }
    const std::string key = "\"" + e.name + "\":";
    const std::size_t at = line.find(key);
    ASSERT_NE(at, std::string::npos) << line;
    const std::string tail = line.substr(at + key.size(), e.value.size() + 1);
    EXPECT_EQ(tail.substr(0, e.value.size()), e.value)
        << "cycle " << e.cycle << " " << e.name << " in " << line;
    EXPECT_TRUE(tail.size() > e.value.size() && (tail.back() == ',' || tail.back() == '}'))
        << "cycle " << e.cycle << " " << e.name << " in " << line;
  }
}

TEST_P(Programs, take_the_expected_values_cycle_by_cycle) {
  const std::vector<DataCase> cases = cases_of(GetParam());
  EXPECT_FALSE(cases.empty());
  for (const DataCase& c : cases) run_case(c, stem(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Files, Programs, testing::ValuesIn(data_files("conformance", ".test")),
                         [](const auto& i) { return stem(i.param); });

}  // namespace
}  // namespace servogate::plc
