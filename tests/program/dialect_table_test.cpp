// SPDX-License-Identifier: Apache-2.0
// The engine takes a language as a table: a small one with other meanings for the same words runs on it
// unchanged.
#include <gtest/gtest.h>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/nc110.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

/// G20 and G21 are inch and metric, G27 is a machine-zero block, G90 and G91 hold for a block with motion
/// only, I and J count from the start, brackets are comments, H is a feed, F is an axis' letter nowhere, P a
/// dwell code of M.
constexpr GRule kG[] = {
    {0, 'a', Function::rapid, true},
    {1, 'a', Function::line},
    {2, 'a', Function::arc_cw},
    {3, 'a', Function::arc_ccw},
    {17, 'b', Function::plane_12, true},
    {20, 'f', Function::inch},
    {21, 'f', Function::metric, true},
    {27, 'k', Function::machine_zero},
    {61, 'c', Function::exact, true},
    {70, 'x', Function::later},
    {90, 'h', Function::absolute, false, true},
    {91, 'h', Function::incremental, true, true},
    {94, 'l', Function::feed_minute, true},
    {97, 'm', Function::revolutions, true},
};
constexpr MRule kM[] = {{3, true, MAction::spindle_cw}, {17, true, MAction::end}};

Dialect other() {
  Dialect dialect;
  dialect.name = "other";
  dialect.lexis = {.tape = 'O', .bracket = Bracket::comment};
  dialect.expressions.variable = [](std::string_view, std::size_t&, const ValueSource*, double&) {
    return false;
  };
  dialect.arc_centre = ArcCentre::from_start;
  dialect.max_block_characters = 255;
  dialect.max_label_characters = 0;
  dialect.max_block_number_digits = 8;
  dialect.max_m_words = 1;
  dialect.max_repeat_depth = dialect.max_call_depth = 0;
  const auto set = [&](char letter, Meaning meaning) {
    dialect.letters[static_cast<std::size_t>(letter)] = {meaning, ParameterKind::none, -99999.0, 99999.0};
  };
  for (const char axis : {'X', 'Y', 'Z'}) set(axis, Meaning::axis);
  set('N', Meaning::number);
  set('G', Meaning::g);
  set('M', Meaning::m);
  set('H', Meaning::feed);
  set('S', Meaning::speed);
  set('I', Meaning::centre_1);
  set('J', Meaning::centre_2);
  set('R', Meaning::later);
  dialect.g = kG;
  dialect.m = kM;
  dialect.conflict = [](int, int) { return false; };
  return dialect;
}

struct Outcome {
  std::vector<std::string> commands;
  std::string error;
};

Outcome run(const Dialect& dialect, const std::string& text) {
  MachineModel machine = mill();
  machine.power_on.clear();
  machine.variables.clear();
  Execution execution(dialect, machine, {}, "p", text, {}, Position{}, 0);
  const image::Packets packets;
  Outcome out;
  for (;;) {
    const Step step = execution.next(packets, true);
    if (const auto* error = std::get_if<Error>(&step)) {
      out.error = error->finding.str(text::Language::english);
      return out;
    }
    const auto& command = std::get<Command>(step);
    if (std::holds_alternative<End>(command.what)) return out;
    std::string json = to_json(command, {"X", "Y", "Z"}, execution.flow().names());
    out.commands.push_back(json.substr(0, json.find(",\"Z\"")));
  }
}

TEST(DialectTable, gives_the_same_word_another_meaning) {
  const Dialect dialect = other();
  const Outcome result = run(dialect, "O100\nG20 (inch (nested)) X1\nG21 Y5\nG27 X3 Y3\n");
  EXPECT_EQ("", result.error);
  ASSERT_EQ(3u, result.commands.size());
  EXPECT_EQ("{\"cmd\":\"rapid\",\"line\":2,\"to\":{\"X\":25.4,\"Y\":0", result.commands[0]);
  EXPECT_EQ("{\"cmd\":\"rapid\",\"line\":3,\"to\":{\"X\":25.4,\"Y\":5", result.commands[1]);
  EXPECT_EQ("{\"cmd\":\"rapid\",\"line\":4,\"to\":{\"X\":3,\"Y\":3", result.commands[2]);
}

TEST(DialectTable, lets_a_mode_hold_for_its_block_only_where_the_table_says_so) {
  const Dialect dialect = other();
  const Outcome result = run(dialect, "X10\nG90 X50\nX1\nG90\nX7\nG91 X1\nX2");
  EXPECT_EQ("", result.error);
  ASSERT_EQ(6u, result.commands.size());
  const char* const wanted[] = {"10", "50", "51", "7", "8", "2"};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NE(std::string::npos, result.commands[i].find(std::string("\"X\":") + wanted[i] + ","))
        << result.commands[i];
}

TEST(DialectTable, counts_arc_centres_from_the_start_and_reads_feed_from_another_letter) {
  const Dialect dialect = other();
  const Outcome result = run(dialect, "G90\nX20\nG3 X0 Y20 I-20 J0 H300");
  EXPECT_EQ("", result.error);
  ASSERT_EQ(2u, result.commands.size());
  EXPECT_EQ("{\"cmd\":\"arc\",\"line\":3,\"to\":{\"X\":0,\"Y\":20", result.commands[1]);
}

TEST(DialectTable, changes_the_class_of_an_m_function) {
  const Dialect dialect = other();
  const Outcome result = run(dialect, "N12345678 S100 M3 X5");
  ASSERT_EQ(3u, result.commands.size());
  EXPECT_EQ(0u, result.commands[0].find("{\"cmd\":\"spindle\""));
  EXPECT_EQ(0u, result.commands[1].find("{\"cmd\":\"rapid\""));
  EXPECT_EQ(0u, result.commands[2].find("{\"cmd\":\"m\""));
}

TEST(DialectTable, refuses_words_of_another_language) {
  const Dialect dialect = other();
  EXPECT_EQ("p:1:1: error: the language has no G71 [P211]", run(dialect, "G71").error);
  EXPECT_EQ("p:1:1: error: G70 is not executed in this version [P901]", run(dialect, "G70").error);
  EXPECT_EQ("p:1:4: error: the language has no word F100 [P202]", run(dialect, "X1 F100").error);
  EXPECT_EQ("p:1:1: error: R5 is not executed in this version [P901]", run(dialect, "R5").error);
  EXPECT_EQ("p:1:1: error: the character \" has no meaning here [P201]", run(dialect, "\"A\" X1").error);
  EXPECT_EQ("p:1:4: error: the block in brackets has no closing bracket [P110]",
            run(dialect, "X1 (open").error);
}

}  // namespace
}  // namespace servogate::program::tests
