// SPDX-License-Identifier: Apache-2.0
// The test form of PLC programs: what it does, and what it says of mistakes.
#include <gtest/gtest.h>

#include "plc/testing/run_tests.hpp"

namespace servogate::plc::testing {
namespace {

constexpr const char* kLamp = R"(TYPE Light : (Dark, Dim, Bright); END_TYPE
PROGRAM Lamp
VAR on, lit : BOOL; t : TON; n : DINT; big : LINT; x : REAL; name : STRING; light : Light; list : ARRAY[1..3] OF INT; END_VAR
t(IN := on, PT := T#50ms);
lit := t.Q;
n := n + 1;
x := x + 0.1;
IF n = 100 THEN n := n / (n - 100); END_IF;
END_PROGRAM
)";

std::string findings(const std::vector<text::Finding>& list) {
  std::string out;
  for (const text::Finding& f : list) out += f.str(text::Language::english) + "\n" + f.excerpt();
  return out;
}

/// What the first test of a file says; empty: it passed.
std::string outcome(const std::string& steps, const std::vector<image::Symbol>& symbols = {}) {
  const TestFile file = read_test_file("lamp.test", "cycle 10ms\ntest it\n" + steps);
  if (!file.ok()) return findings(file.findings);
  const CompileResult compiled = compile({{"lamp.st", kLamp}}, symbols);
  EXPECT_TRUE(compiled.ok()) << findings(compiled.findings);
  const std::vector<Outcome> outcomes = run_tests(file, compiled.image, symbols, {});
  return outcomes.empty() ? "no test" : findings(outcomes.front().findings);
}

TEST(PlcTestForm, sets_runs_and_expects_in_virtual_time) {
  EXPECT_EQ(outcome("set on = TRUE\nrun 5\nexpect NOT lit, t.ET = T#40ms\nrun 10ms\nexpect lit\n"), "");
  EXPECT_EQ(outcome("set on = TRUE\nuntil lit within 60ms\nexpect n = 6\n"), "");
  EXPECT_EQ(outcome("run 25ms\nexpect n = 3   # whole scans\n"), "");
  EXPECT_EQ(outcome("set name = 'a, b', list[2] = -7\nexpect name = 'a, b', list[2] < 0, list[2] <> 7\n"),
            "");
  EXPECT_EQ(outcome("set light = Dim\nexpect light = Dim, light <> Light#Bright\n"), "");
}

TEST(PlcTestForm, compares_whole_numbers_exactly_and_reals_within_a_tolerance) {
  EXPECT_EQ(outcome("set big = 9007199254740993\nexpect big = 9007199254740993, big > 9007199254740992\n"),
            "");
  EXPECT_NE(outcome("set big = 9007199254740993\nexpect big = 9007199254740992\n"), "");
  EXPECT_EQ(outcome("run 3\nexpect x = 0.3 +- 0.001\n"), "");
  EXPECT_NE(outcome("run 3\nexpect x = 0.31 +- 0.001\n"), "");
}

TEST(PlcTestForm, holds_a_variable_against_the_program_until_it_is_released) {
  EXPECT_EQ(outcome("hold n = 5\nrun 3\nexpect n = 5\nrelease n\nrun 1\nexpect n = 6\n"), "");
}

TEST(PlcTestForm, says_what_was_expected_and_what_came_with_line_scan_and_time) {
  EXPECT_EQ(outcome("set on = TRUE\nrun 3\n  expect lit\n"),
            "lamp.test:5:10: error: expected lit = TRUE, got FALSE (scan 3, after 20ms) [plc-test-failed]\n"
            " 5 |   expect lit\n   |          ^\n");
  EXPECT_EQ(outcome("until lit within 30ms\n"),
            "lamp.test:3:7: error: expected lit = TRUE within 30ms, got FALSE (scan 3, after 20ms) "
            "[plc-test-until]\n 3 | until lit within 30ms\n   |       ^\n");
}

TEST(PlcTestForm, every_condition_of_a_line_is_told_and_the_test_ends_there) {
  const std::string said = outcome("run 1\nexpect n = 2, lit, n = 1\nexpect n = 7\n");
  EXPECT_NE(said.find("expected n = 2, got 1"), std::string::npos) << said;
  EXPECT_NE(said.find("expected lit = TRUE, got FALSE"), std::string::npos) << said;
  EXPECT_EQ(said.find("expected n = 7"), std::string::npos) << said;
}

TEST(PlcTestForm, each_test_begins_with_a_fresh_program_and_the_steps_of_before) {
  const TestFile file = read_test_file(
      "a.test",
      "before\n  set n = 40\n  run 1\ntest first\n  run 1\n  expect n = 42\ntest second\n  expect n = 41\n");
  ASSERT_TRUE(file.ok()) << findings(file.findings);
  const CompileResult compiled = compile({{"lamp.st", kLamp}}, {});
  const std::vector<Outcome> outcomes = run_tests(file, compiled.image, {}, {});
  ASSERT_EQ(outcomes.size(), 2u);
  for (const Outcome& o : outcomes) EXPECT_TRUE(o.passed()) << findings(o.findings);
  EXPECT_EQ(outcomes[1].name, "second");
  EXPECT_EQ(outcomes[1].line, 7);
}

TEST(PlcTestForm, a_fault_fails_the_test_unless_it_was_expected) {
  const std::string said = outcome("run 200\n");
  EXPECT_NE(said.find("the PLC stopped here: lamp.st:8:1: error: task cycle divided by zero"),
            std::string::npos)
      << said;
  EXPECT_EQ(outcome("set n = 99\nrun 1\nexpect fault\n"), "");
  EXPECT_NE(outcome("run 1\nexpect fault\n").find("expected a fault of the PLC, got none"),
            std::string::npos);
}

TEST(PlcTestForm, knows_symbols_of_the_machine_that_the_program_does_not_use) {
  const std::vector<image::Symbol> symbols{
      {"door", {image::Packet::a, image::Format::bl, 3, 1}, image::Writer::input, ""},
      {"speed", {image::Packet::k, image::Format::in, 40, 1}, image::Writer::nc, ""}};
  EXPECT_EQ(outcome("set door = TRUE, speed = -3\nrun 1\nexpect door, speed = -3\n", symbols), "");
  EXPECT_NE(outcome("hold door = TRUE\n", symbols).find("cannot be held"), std::string::npos);
}

TEST(PlcTestForm, names_mistakes_with_a_caret_and_what_was_probably_meant) {
  EXPECT_EQ(outcome("  expct lit\n"),
            "lamp.test:3:3: error: 'expct' is no word of a test; did you mean 'expect'? [plc-test-word]\n"
            " 3 |   expct lit\n   |   ^\n");
  const std::pair<const char*, const char*> wrong[] = {
      {"set lit\n", "3:8: error: expected '='"},
      {"set = 5\n", "3:5: error: expected a name"},
      {"set n =\n", "error: expected a value"},
      {"expect n >\n", "error: expected a value"},
      {"until lit\n", "3:10: error: expected 'within'"},
      {"until lit within soon\n", "3:18: error: 'soon' is no time"},
      {"run 0\n", "3:5: error: 0 scans are not possible"},
      {"run -5\n", "3:5: error: -5 scans are not possible"},
      {"run fast\n", "3:5: error: 'fast' is no time"},
      {"run 25h\n", "3:5: error: '25h' is no time"},
      {"expect n > 1 +- 2\n", "error: '+-' stands behind"},
      {"expect fault today\n", "3:14: error: 'today' is too much here"},
      {"expect lot\n", "3:8: error: there is no variable 'lot'; did you mean 'lit'?"},
      {"expect n = many\n", "3:12: error: 'many' is no value for 'n' of type DINT"},
      {"set list = 1\n", "error: '1' is no value for 'list'"},
      {"expect n\n", "3:8: error: 'n' is DINT; a value is needed"},
      {"expect name < 'b'\n", "error: STRING can only be compared by = and <>"},
      {"expect list[4] = 0\n", "error: there is no variable 'list[4]'"}};
  for (const auto& [steps, message] : wrong) {
    const std::string said = outcome(steps);
    EXPECT_NE(said.find(message), std::string::npos) << steps << said;
  }
}

TEST(PlcTestForm, names_mistakes_of_the_file_all_at_once) {
  EXPECT_EQ(
      findings(read_test_file("x.test", "set a = 1\nmachine\ncycle never\ntest\nbefore now\n").findings),
      "x.test:1:1: error: 'set' stands before the first 'test' or 'before' [plc-test-outside]\n"
      " 1 | set a = 1\n   | ^\n"
      "x.test:2:8: error: expected a path [plc-test-expected]\n"
      " 2 | machine\n   |        ^\n"
      "x.test:3:7: error: 'never' is no time such as 200ms or 1.5s (at most 24h) [plc-test-time]\n"
      " 3 | cycle never\n   |       ^\n"
      "x.test:4:1: error: a test needs a name [plc-test-name]\n"
      " 4 | test\n   | ^\n"
      "x.test:5:8: error: 'now' is too much here [plc-test-too-much]\n"
      " 5 | before now\n   |        ^\n");
  EXPECT_EQ(findings(read_test_file("y.test", "# nothing\n").findings),
            "y.test: error: there is no test in this file [plc-test-none]\n");
}

}  // namespace
}  // namespace servogate::plc::testing
