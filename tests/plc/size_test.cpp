// SPDX-License-Identifier: Apache-2.0
// Sources that are large or deep, as machines write them: what they come to, and how compiling them is ended.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>

#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {
namespace {

std::string repeated(int count, const std::function<std::string(int)>& line) {
  std::string out;
  for (int i = 0; i < count; ++i) out += line(i);
  return out;
}
std::string n(int i) { return std::to_string(i); }

std::vector<std::string> said(const CompileResult& r) {
  std::vector<std::string> out;
  for (const text::Finding& f : r.findings) out.push_back(f.str(text::Language::english));
  return out;
}

std::string functions(int count) {
  return "FUNCTION f0 : DINT VAR_INPUT x : DINT; END_VAR f0 := x + 1; END_FUNCTION\n" +
         repeated(count - 1,
                  [](int i) {
                    return "FUNCTION f" + n(i + 1) + " : DINT VAR_INPUT x : DINT; END_VAR f" + n(i + 1) +
                           " := f" + n(i) + "(x) + f" + n(i) + "(x); END_FUNCTION\n";
                  }) +
         "PROGRAM Main VAR r : DINT; END_VAR r := f" + n(count - 1) + "(1); END_PROGRAM\n";
}

// Each of the following takes time that doubles with every line, or grows with the square of their number,
// when something is looked for where it need not be: then this program does not come to its end.

TEST(Size, a_function_is_made_once_however_many_ways_lead_to_it) {
  const CompileResult few = compile({{"t.st", functions(50)}}, {}),
                      many = compile({{"t.st", functions(100)}}, {});
  ASSERT_TRUE(few.ok());
  ASSERT_TRUE(many.ok());
  EXPECT_LE(many.image->code.size(), 2 * few.image->code.size());
}

TEST(Size, functions_that_call_too_deep_are_told_once) {
  const CompileResult r = compile({{"t.st", functions(200)}}, {});
  EXPECT_EQ(said(r),
            (std::vector<std::string>{"t.st:121:10: error: nested deeper than 120 levels [plc-depth]"}));
}

TEST(Size, nested_blocks_and_structures_that_double_each_time_are_refused_where_they_are_too_large) {
  std::string blocks = "FUNCTION_BLOCK F0 VAR_INPUT i : LINT; END_VAR END_FUNCTION_BLOCK\n" +
                       repeated(40,
                                [](int i) {
                                  return "FUNCTION_BLOCK F" + n(i + 1) + " VAR a, b : F" + n(i) +
                                         "; END_VAR a(); b(); END_FUNCTION_BLOCK\n";
                                }) +
                       "PROGRAM Main VAR f : F40; END_VAR f(); END_PROGRAM\n";
  const CompileResult of_blocks = compile({{"t.st", blocks}}, {});
  ASSERT_FALSE(of_blocks.findings.empty());
  EXPECT_NE(said(of_blocks)[0].find("t.st:23:"), std::string::npos) << said(of_blocks)[0];
  EXPECT_NE(said(of_blocks)[0].find("[plc-too-large]"), std::string::npos);
  const std::string structures =
      "TYPE S0 : STRUCT a, b : INT; r : REF_TO INT; END_STRUCT END_TYPE\n" +
      repeated(40,
               [](int i) {
                 return "TYPE S" + n(i + 1) + " : STRUCT a, b : S" + n(i) + "; END_STRUCT END_TYPE\n";
               }) +
      "PROGRAM Main VAR s, t : S40; END_VAR s := t; END_PROGRAM\n";
  const CompileResult of_structures = compile({{"t.st", structures}}, {});
  ASSERT_EQ(of_structures.findings.size(), 1u) << said(of_structures)[1];
  EXPECT_NE(said(of_structures)[0].find("[plc-too-large]"), std::string::npos);
  EXPECT_GT(of_structures.findings[0].line, 1);
}

TEST(Size, a_case_of_fifty_thousand_labels_chooses_each_of_them) {
  constexpr int kLabels = 50'000;
  const CompileResult r =
      compile({{"t.st", "PROGRAM Main VAR x, y : DINT; END_VAR CASE x OF\n" +
                            repeated(kLabels, [](int i) { return n(3 * i) + ": y := " + n(i) + ";\n"; }) +
                            "END_CASE; END_PROGRAM"}},
              {});
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(r.findings.empty());
  Engine e(r.image);
  image::Packets p;
  for (const int label : {0, 1, 25'000, kLabels - 1}) {
    ASSERT_TRUE(e.write(p, *e.find("x"), n(3 * label)));
    ASSERT_EQ(e.scan(p, 0).fault, Fault::none);
    EXPECT_EQ(e.read(*e.find("y")), n(label));
  }
}

TEST(Size, two_hundred_thousand_variables_keep_apart) {
  constexpr int kVariables = 200'000;
  const auto declared = [](const char* before, const char* behind) {
    return std::string(before) + repeated(kVariables, [](int i) { return "v" + n(i) + " : DINT;\n"; }) +
           behind +
           repeated(kVariables / 10,
                    [](int i) { return "v" + n(10 * i) + " := v" + n(10 * i) + " + " + n(i) + ";\n"; }) +
           "END_PROGRAM";
  };
  Options quiet;
  quiet.warnings = false;
  for (const std::string& text :
       {declared("PROGRAM Main VAR\n", "END_VAR\n"), declared("VAR_GLOBAL\n", "END_VAR PROGRAM Main\n"),
        declared("TYPE S : STRUCT\n",
                 "END_STRUCT END_TYPE PROGRAM Main VAR s : S; END_VAR "
                 "s.v199990 := 19999;\n(* ") +
            "*) END_PROGRAM"}) {
    const CompileResult r = compile({{"t.st", text}}, {}, quiet);
    ASSERT_TRUE(r.ok()) << said(r)[0];
    Engine e(r.image);
    image::Packets p;
    ASSERT_EQ(e.scan(p, 0).fault, Fault::none);
    const auto last = e.find(text.starts_with("TYPE") ? "s.v199990" : "v199990");
    ASSERT_TRUE(last);
    EXPECT_EQ(e.read(*last), "19999");
  }
}

TEST(Size, findings_beyond_two_hundred_are_counted) {
  const std::string unused = repeated(1000, [](int i) { return "v" + n(i) + " : INT;\n"; });
  const CompileResult warned = compile({{"t.st", "PROGRAM Main VAR\n" + unused + "END_VAR END_PROGRAM"}}, {});
  EXPECT_TRUE(warned.ok());
  ASSERT_EQ(warned.findings.size(), 201u);
  EXPECT_EQ(said(warned).back(),
            "t.st: warning: 800 more warnings: the first 200 are shown [plc-more-warnings]");
  const std::string unknown = repeated(1000, [](int i) { return "w" + n(i) + " := 1;\n"; });
  const CompileResult wrong = compile({{"t.st", "PROGRAM Main\n" + unknown + "END_PROGRAM"}}, {});
  EXPECT_FALSE(wrong.ok());
  ASSERT_EQ(wrong.findings.size(), 201u);
  EXPECT_EQ(said(wrong).back(), "t.st: error: 800 more errors: the first 200 are shown [plc-more-errors]");
}

/// Compiles until it has asked `looks` times whether to stop; how often it has asked is said in `asked`.
CompileResult compile_until(const std::string& text, std::int64_t looks, std::int64_t& asked) {
  Options options;
  asked = 0;
  options.stop = [&asked, looks] { return ++asked >= looks; };
  return compile({{"t.st", text}}, {}, options);
}
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::string assignments(int count) {
  return "PROGRAM Main VAR\n" + repeated(count, [](int i) { return "v" + n(i) + " : DINT;\n"; }) +
         "END_VAR\n" +
         repeated(count, [](int i) { return "v" + n(i) + " := v" + n(i) + " * 3 + " + n(i) + ";\n"; }) +
         "END_PROGRAM";
}

TEST(Compile, is_ended_wherever_it_asks_at_once_and_says_so) {
  const std::string text = assignments(100);
  std::int64_t all = 0, asked = 0;
  EXPECT_TRUE(compile_until(text, kNever, all).ok());
  for (std::int64_t i = 0; i <= 100; ++i) {
    const std::int64_t look = 1 + (all - 1) * i / 100;
    EXPECT_EQ(said(compile_until(text, look, asked)),
              (std::vector<std::string>{
                  "t.st: error: compiling was ended before it was done: it took longer than is allowed here "
                  "[plc-compile-cancelled]"}));
    EXPECT_EQ(asked, look) << "of " << all << ": nothing follows it";
  }
}

TEST(Compile, asks_in_each_of_its_stages_for_every_line) {
  std::int64_t few = 0, many = 0;
  EXPECT_TRUE(compile_until(assignments(100), kNever, few).ok());
  EXPECT_TRUE(compile_until(assignments(1100), kNever, many).ok());
  EXPECT_GE(many - few, 1000 * 5) << "read, declared, parsed, analyzed, generated";
}

TEST(Compile, a_program_of_more_instructions_than_are_allowed_is_refused_where_they_end) {
  Options options;
  options.most_instructions = 1000;
  const std::string text = "PROGRAM Main VAR n : INT; END_VAR\n" +
                           repeated(2000, [](int) { return std::string("n := n + 1;\n"); }) + "END_PROGRAM";
  const CompileResult r = compile({{"t.st", text}}, {}, options);
  EXPECT_FALSE(r.ok());
  ASSERT_EQ(r.findings.size(), 1u);
  EXPECT_EQ(r.findings[0].entry->id, "plc-code-size");
  EXPECT_GT(r.findings[0].line, 400);
  EXPECT_LT(r.findings[0].line, 1003);
}

}  // namespace
}  // namespace servogate::plc
