// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "plc/compile/compile.hpp"
#include "tests/plc/data_files.hpp"

namespace servogate::plc {
namespace {

/// The machine the wrong programs are written for.
std::vector<image::Symbol> symbols() {
  std::vector<image::Symbol> out = image::interface_symbols(1, {"X"}, 1);
  const auto point = [&](const char* name, std::uint32_t bit, image::Writer w) {
    out.push_back({name, {image::Packet::a, image::Format::bl, bit, 1}, w, ""});
  };
  point("door_closed", 16, image::Writer::input);
  point("lamp", 64, image::Writer::plc);
  return out;
}

class WrongPrograms : public testing::TestWithParam<std::string> {};

/// Behind `---`: every finding, as printed, in order, without the file's name. Nothing else may be said.
TEST_P(WrongPrograms, get_exactly_these_messages) {
  for (const DataCase& c : cases_of(GetParam())) {
    SCOPED_TRACE(stem(GetParam()) + ":" + std::to_string(c.line) + " " + c.title);
    Options options;
    options.cycle_ns = image::kMillisecond;
    const CompileResult r = compile({{"a.st", c.source}}, symbols(), options);
    std::vector<std::string> said;
    for (const text::Finding& f : r.findings) said.push_back(f.str(text::Language::english).substr(5));
    EXPECT_EQ(said, c.rest);
    ASSERT_FALSE(c.rest.empty());
    const bool errors = std::any_of(c.rest.begin(), c.rest.end(), [](const std::string& s) {
      return s.find(": error: ") != std::string::npos;
    });
    EXPECT_EQ(r.ok(), !errors);
    for (const text::Finding& f : r.findings)
      EXPECT_NE(f.str(text::Language::russian), f.str(text::Language::english)) << "no Russian text";
  }
}

INSTANTIATE_TEST_SUITE_P(Files, WrongPrograms, testing::ValuesIn(data_files("wrong", ".wrong")),
                         [](const auto& i) { return stem(i.param); });

std::string excerpt_of(const std::string& source) {
  const CompileResult r = compile({{"a.st", source}}, {});
  return r.findings.empty() ? "no finding" : r.findings[0].excerpt();
}

TEST(Findings, show_their_line_with_a_caret_under_the_column) {
  EXPECT_EQ(excerpt_of("PROGRAM Main\nVAR a : BOOL; n : INT; END_VAR\n\ta := (* я *) n;\r\nEND_PROGRAM"),
            " 3 | \ta := (* я *) n;\n   | \t             ^\n");
}

TEST(Findings, show_the_part_of_a_long_line_that_they_speak_of) {
  const std::string blanks(300, ' ');
  const std::string shown = excerpt_of("PROGRAM Main VAR a : BOOL; n : INT; END_VAR\n" + blanks + "a := n;" +
                                       blanks + "\nEND_PROGRAM");
  EXPECT_NE(shown.find("a := n;"), std::string::npos) << shown;
  EXPECT_LT(shown.size(), 400u);
  const std::size_t line = shown.find('\n');
  EXPECT_EQ(shown.find('^') - (line + 1), shown.find("n;")) << shown;
}

TEST(Findings, of_a_file_that_is_no_text_are_one_and_show_no_byte_of_it) {
  const std::string text =
      std::string("PROGRAM p") + '\0' + "VAR a : INT; END_VAR " + '\x01' + " END_PROGRAM";
  for (const std::string& source : {text, std::string(500, '\0'), "\x7F" + std::string("ELF") + '\x02'}) {
    const CompileResult r = compile({{"a.st", source}}, {});
    ASSERT_EQ(r.findings.size(), 1u) << source;
    EXPECT_EQ(r.findings[0].entry->id, "plc-no-text");
    const std::string shown = r.findings[0].excerpt();
    EXPECT_EQ(std::count(shown.begin(), shown.end(), '\n'), 2) << shown;
    EXPECT_TRUE(std::none_of(shown.begin(), shown.end(),
                             [](char c) { return c != '\n' && (c == 0x7F || (c >= 0 && c < 0x20)); }));
  }
}

}  // namespace
}  // namespace servogate::plc
