// SPDX-License-Identifier: Apache-2.0
#include "plc/run/run.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace servogate::plc {
namespace {

TEST(Run, prints_one_object_a_cycle_as_requested_and_takes_sets_at_their_cycle) {
  RunRequest r;
  r.files = {
      {"a.st",
       "PROGRAM Main\nVAR a, b : BOOL; t : TON; END_VAR\nt(IN := a, PT := T#20ms);\nb := t.Q;\nEND_PROGRAM"}};
  r.cycles = 4;
  r.prints = {"MAIN.b", "t.ET", "a"};
  RunSet set;
  ASSERT_TRUE(parse_set("a=TRUE@2", set));
  r.sets = {set};
  std::vector<std::string> lines;
  const RunResult out = run(r, [&](std::string_view l) {
    lines.emplace_back(l);
    return true;
  });
  EXPECT_EQ(out.end, RunResult::End::done);
  EXPECT_EQ(lines,
            (std::vector<std::string>{R"({"cycle":1,"values":{"MAIN.b":false,"t.ET":"T#0ms","a":false}})",
                                      R"({"cycle":2,"values":{"MAIN.b":false,"t.ET":"T#0ms","a":true}})",
                                      R"({"cycle":3,"values":{"MAIN.b":false,"t.ET":"T#10ms","a":true}})",
                                      R"({"cycle":4,"values":{"MAIN.b":true,"t.ET":"T#20ms","a":true}})"}));
}

TEST(Run, places_that_the_program_does_not_use_are_printed_too) {
  RunRequest r;
  r.files = {{"a.st", "PROGRAM Main\nVAR w AT %MW4 : WORD; END_VAR\nw := 16#FFFE;\nEND_PROGRAM"}};
  r.prints = {"%MW4", "%MB8", "%MW5", "SK4.IN", "SA16", "%QX1.0"};
  r.cycles = 1;
  std::vector<std::string> lines;
  EXPECT_EQ(run(r, [&](std::string_view l) { return lines.emplace_back(l), true; }).end,
            RunResult::End::done);
  EXPECT_EQ(
      lines,
      (std::vector<std::string>{
          R"({"cycle":1,"values":{"%MW4":65534,"%MB8":254,"%MW5":0,"SK4.IN":-2,"SA16":false,"%QX1.0":false}})"}));
  r.prints = {"%MW5000", "nothing"};
  EXPECT_EQ(run(r, [](std::string_view) { return true; }).findings.size(), 2u);
}

TEST(Run, places_are_set_by_their_address_whether_or_not_the_program_has_a_name_for_them) {
  RunRequest r;
  r.files = {
      {"a.st", "PROGRAM Main\nVAR in AT %IX0.1 : BOOL; n AT %MW4 : INT; END_VAR\nn := n + 1;\nEND_PROGRAM"}};
  r.options.warnings = false;
  r.sets = {{"%IX0.1", "TRUE", 2}, {"%MW4", "16#FF00", 2}, {"%MD40", "7", 1}, {"SK60.4CH", "'ab'", 1}};
  r.prints = {"in", "n", "%MD40", "SK60.4CH"};
  r.cycles = 2;
  std::vector<std::string> lines;
  const RunResult out = run(r, [&](std::string_view l) { return lines.emplace_back(l), true; });
  EXPECT_EQ(out.end, RunResult::End::done) << out.findings[0].str(text::Language::english);
  EXPECT_EQ(lines, (std::vector<std::string>{
                       R"({"cycle":1,"values":{"in":false,"n":1,"%MD40":7,"SK60.4CH":"ab  "}})",
                       R"({"cycle":2,"values":{"in":true,"n":-255,"%MD40":7,"SK60.4CH":"ab  "}})"}));
  r.sets = {{"%IX0.1", "7", 1}, {"%MX9000.0", "TRUE", 1}};
  EXPECT_EQ(run(r, [](std::string_view) { return true; }).findings.size(), 2u);
}

TEST(Run, names_to_print_may_have_several_subscripts) {
  EXPECT_EQ(parse_prints("a,x[2,3],y[1, 2].z,s.t"),
            (std::vector<std::string>{"a", "x[2,3]", "y[1, 2].z", "s.t"}));
  EXPECT_EQ(parse_prints("a,,b,"), (std::vector<std::string>{"a", "b"}));
}

TEST(Run, prints_by_default_each_name_once_that_of_the_program_before_the_global_one) {
  RunRequest r;
  r.files = {{"a.st",
              "VAR_GLOBAL s, g : INT := 5; END_VAR\nPROGRAM Main\nVAR s : INT; END_VAR\ns := s + 1;\n"
              "END_PROGRAM"}};
  r.options.warnings = false;
  std::vector<std::string> lines;
  run(r, [&](std::string_view l) {
    lines.emplace_back(l);
    return true;
  });
  EXPECT_EQ(lines, (std::vector<std::string>{R"({"cycle":1,"values":{"g":5,"s":1}})"}));
}

TEST(Run, ends_when_nobody_wants_its_lines_any_more) {
  RunRequest r;
  r.files = {{"a.st", "PROGRAM Main\nVAR a : INT; END_VAR\na := a + 1;\nEND_PROGRAM"}};
  r.cycles = 1'000'000'000;
  int lines = 0;
  const RunResult out = run(r, [&](std::string_view) { return ++lines < 3; });
  EXPECT_EQ(out.end, RunResult::End::done);
  EXPECT_EQ(lines, 3);
  EXPECT_EQ(out.cycles, 3);
}

TEST(Run, refuses_names_values_and_cycles_that_cannot_be) {
  RunRequest r;
  r.files = {{"a.st", "PROGRAM Main\nVAR a : BOOL; END_VAR\na := a;\nEND_PROGRAM"}};
  r.cycles = 2;
  r.sets = {{"x", "1", 1}, {"a", "7", 1}, {"a", "TRUE", 3}, {"a", "TRUE@soon", 1}};
  r.prints = {"y"};
  const RunResult out = run(r, [](std::string_view line) {
    ADD_FAILURE() << "nothing runs: " << line;
    return true;
  });
  EXPECT_EQ(out.end, RunResult::End::wrong_use);
  std::vector<std::string> said;
  for (const text::Finding& f : out.findings) said.push_back(f.str(text::Language::english));
  EXPECT_EQ(said, (std::vector<std::string>{
                      "plc run: error: there is no variable 'x' [plc-run-name]",
                      "plc run: error: '7' is no value for 'a' of type BOOL [plc-run-value]",
                      "plc run: error: cycle 3 is outside 1..2 [plc-run-cycle]",
                      "plc run: error: 'soon' behind '@' is no number of a cycle [plc-run-cycle]",
                      "plc run: error: there is no variable 'y' [plc-run-name]"}));
}

TEST(Run, a_library_can_be_checked_and_not_run) {
  const std::vector<SourceFile> library = {
      {"lib.st", "FUNCTION Twice : INT VAR_INPUT a : INT; END_VAR Twice := a * 2; END_FUNCTION"}};
  std::vector<text::Finding> findings;
  EXPECT_TRUE(check(library, {}, {}, findings));
  EXPECT_TRUE(findings.empty());
  EXPECT_TRUE(check({{"t.st", "TYPE A : INT; END_TYPE"}}, {}, {}, findings));
  EXPECT_FALSE(check({{"lib.st", "FUNCTION F : INT F := TRUE; END_FUNCTION"}}, {}, {}, findings));
  EXPECT_FALSE(check({{"empty.st", "// nothing"}}, {}, {}, findings)) << "neither a program nor a library";
  RunRequest r;
  r.files = library;
  const RunResult out = run(r, [](std::string_view) { return true; });
  EXPECT_EQ(out.end, RunResult::End::bad_source);
  ASSERT_EQ(out.findings.size(), 1u);
  EXPECT_EQ(out.findings[0].entry->id, "plc-no-program");
}

TEST(Run, takes_a_set_apart) {
  RunSet s;
  EXPECT_TRUE(parse_set("Main.text=a@b@12", s));
  EXPECT_EQ(s.name, "Main.text");
  EXPECT_EQ(s.value, "a@b");
  EXPECT_EQ(s.cycle, 12);
  EXPECT_TRUE(parse_set("m=x@home", s));
  EXPECT_EQ(s.value, "x@home");
  EXPECT_EQ(s.cycle, 1);
  EXPECT_FALSE(parse_set("=5", s));
  EXPECT_FALSE(parse_set("name", s));
}

}  // namespace
}  // namespace servogate::plc
