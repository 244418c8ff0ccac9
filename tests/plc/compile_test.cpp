// SPDX-License-Identifier: Apache-2.0
// Several files as one program.
#include <gtest/gtest.h>

#include "plc/compile/compile.hpp"

namespace servogate::plc {
namespace {

TEST(Compile, says_in_which_file_a_name_was_declared_before) {
  const CompileResult r =
      compile({{"one.st", "FUNCTION f : INT f := 1; END_FUNCTION\nVAR_GLOBAL g AT %MW0 : INT; END_VAR"},
               {"two.st",
                "VAR_GLOBAL g : INT; h AT %MW0 : INT; END_VAR\nFUNCTION F : INT F := 2; "
                "END_FUNCTION\nPROGRAM Main VAR a, A : INT; END_VAR a := 1; END_PROGRAM"}},
              {});
  std::vector<std::string> said;
  for (const text::Finding& f : r.findings) said.push_back(f.str(text::Language::english));
  EXPECT_EQ(said, (std::vector<std::string>{
                      "two.st:1:12: error: 'g' is already declared in one.st:2 [plc-duplicate]",
                      "two.st:1:26: warning: %MW0 shares memory with %MW0 of 'g' in one.st:2 [plc-overlap]",
                      "two.st:2:10: error: 'F' is already declared in one.st:1 [plc-duplicate]",
                      "two.st:3:21: error: 'A' is already declared in line 3 [plc-duplicate]"}));
  EXPECT_NE(r.findings.back().str(text::Language::russian).find("уже объявлено в строке 3"),
            std::string::npos);
}

TEST(Compile, reads_several_files_and_names_the_right_one) {
  const CompileResult r =
      compile({{"one.st", "FUNCTION f : INT VAR_INPUT x : INT; END_VAR f := x; END_FUNCTION"},
               {"two.st", "PROGRAM Main\nVAR a : INT; END_VAR\na := f(TRUE);\nEND_PROGRAM"}},
              {});
  ASSERT_EQ(r.findings.size(), 1u);
  EXPECT_EQ(r.findings[0].str(text::Language::english),
            "two.st:3:8: error: expected INT, found BOOL; write BOOL_TO_INT [plc-type]");
  EXPECT_EQ(r.findings[0].str(text::Language::russian),
            "two.st:3:8: error: ожидается INT, встречено BOOL; пишите BOOL_TO_INT [plc-type]");
}

TEST(Compile, says_that_a_file_is_UTF_16_and_nothing_else_of_it) {
  const std::string text = "PROGRAM Main VAR n : INT; END_VAR n := 1; END_PROGRAM";
  std::string little, big;
  for (const char c : text) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (const std::string& utf16 : {"\xFF\xFE" + little, "\xFE\xFF" + big, little, big}) {
    const CompileResult r = compile({{"t.st", utf16}}, {});
    ASSERT_EQ(r.findings.size(), 1u);
    EXPECT_EQ(r.findings[0].str(text::Language::english).substr(0, 56),
              "t.st:1:1: error: the file is UTF-16: save it as UTF-8 [p");
  }
}

TEST(Compile, counts_lines_that_end_with_a_carriage_return_alone) {
  const CompileResult r =
      compile({{"t.st", "PROGRAM Main\rVAR n : INT; END_VAR // a comment\rn := m;\rEND_PROGRAM\r"}}, {});
  ASSERT_EQ(r.findings.size(), 1u);
  EXPECT_EQ(r.findings[0].str(text::Language::english).substr(0, 11), "t.st:3:6: e");
  EXPECT_EQ(r.findings[0].source, "n := m;");
}

}  // namespace
}  // namespace servogate::plc
