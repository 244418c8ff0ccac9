// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/finding.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace servogate::text {
namespace {

constexpr Entry kSample{"sample.limit", "{0} leaves the travel at {1} mm",
                        "{0} выходит за пределы хода: {1} мм"};

TEST(Finding, prints_file_line_column_severity_text_and_code) {
  Finding f{Severity::error, "bracket.nc", 12, 7, &kSample, {"X", "301"}};
  EXPECT_EQ(f.str(Language::english), "bracket.nc:12:7: error: X leaves the travel at 301 mm [sample.limit]");
  f.severity = Severity::warning;
  f.line = 0;
  EXPECT_EQ(f.str(Language::russian),
            "bracket.nc: warning: X выходит за пределы хода: 301 мм [sample.limit]");
}

TEST(Visible, leaves_no_byte_that_commands_a_terminal) {
  const struct {
    std::string words, shown;
  } rows[] = {
      {"\x1b[2J\x1b]0;title\x07", "\\x1B[2J\\x1B]0;title\\x07"},
      {"a\tb\nc\rd", "a\tb\nc\\x0Dd"},
      {"\xC2\x9B"
       "31m",
       "\\xC2\\x9B"
       "31m"},  // CSI of Latin-1 as UTF-8
      {"\x9B"
       "31m",
       "\\x9B"
       "31m"},  // and as a byte
      {"\x7f", "\\x7F"},
      {"\xE2\x80\xAE"
       "cba",
       "\\xE2\\x80\\xAE"
       "cba"},  // from right to left
      {"ось \u00B5 \u20AC \U0001F600", "ось \u00B5 \u20AC \U0001F600"},
      {"\xD0", "\\xD0"},  // cut off
      {std::string("a\0b", 3),
       "a\\x00"
       "b"},
  };
  for (const auto& row : rows) EXPECT_EQ(visible(row.words), row.shown);
}

TEST(Finding, of_a_file_with_a_wild_name_and_a_wild_line_shows_both_visibly) {
  const Finding f{Severity::error, "a\x1b[2J.nc", 1, 5, &kSample, {"X\x1b", "1"}, "N1 \xC2\x9BX"};
  EXPECT_EQ(f.str(Language::english),
            "a\\x1B[2J.nc:1:5: error: X\\x1B leaves the travel at 1 mm [sample.limit]");
  EXPECT_EQ(f.excerpt(), " 1 | N1 ??X\n   |      ^\n");
}

TEST(Render, keeps_a_placeholder_without_an_argument_visible) {
  EXPECT_EQ(render(kSample, std::vector<std::string>{"X"}, Language::english),
            "X leaves the travel at {1} mm");
}

TEST(Both, is_resolved_wherever_it_stands_in_an_argument) {
  constexpr Entry kCannot{"sample.cannot", "cannot do it: {0}", "не удаётся: {0}"};
  const std::vector<std::string> said = {"a.st: " + both("missing", "нет файла") + " (2 " + both("mm", "мм") +
                                         ")"};
  EXPECT_EQ(render(kCannot, said, Language::english), "cannot do it: a.st: missing (2 mm)");
  EXPECT_EQ(render(kCannot, said, Language::russian), "не удаётся: a.st: нет файла (2 мм)");
}

TEST(Both, may_stand_inside_of_another) {
  const std::string unit = both("mm", "мм");
  const std::string words = both("of 2 " + unit + " each", "по 2 " + unit);
  EXPECT_EQ(in_language(words, Language::english), "of 2 mm each");
  EXPECT_EQ(in_language(words, Language::russian), "по 2 мм");
}

TEST(UserLanguage, follows_the_first_variable_that_is_set) {
  setenv("LC_ALL", "", 1);
  setenv("LC_MESSAGES", "", 1);
  setenv("LANG", "ru_RU.UTF-8", 1);
  EXPECT_EQ(user_language(), Language::russian);
  setenv("LC_ALL", "C", 1);
  EXPECT_EQ(user_language(), Language::english);
}

TEST(Number, is_plain_decimal_without_trailing_zeros_or_minus_zero) {
  EXPECT_EQ(number(26214.4), "26214.4");
  EXPECT_EQ(number(500), "500");
  EXPECT_EQ(number(-0.0000001), "0");
  EXPECT_EQ(number(1e12), "1000000000000");
  EXPECT_EQ(number(-123456789012345.0), "-123456789012345");
  EXPECT_EQ(number(1e300), "1e+300") << "not three hundred digits";
  EXPECT_EQ(number(-1.7976931348623157e308), "-1.79769e+308");
}

}  // namespace
}  // namespace servogate::text
