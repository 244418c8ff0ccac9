// SPDX-License-Identifier: Apache-2.0
// Words that every room needs: the system's complaints, and units.
#include <gtest/gtest.h>

#include <cerrno>
#include <cstring>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/system_words.hpp"
#include "firmware_if/text/units.hpp"

namespace servogate::text {
namespace {

TEST(SystemWords, are_the_systems_in_english_and_translated_in_russian) {
  for (const int error : {ENOENT, EACCES, EPERM, EISDIR, ENOTDIR, EEXIST, ENOSPC, EROFS, EBUSY, ECONNREFUSED,
                          EADDRINUSE, ENODEV, ENETDOWN, ENXIO, ETIMEDOUT, EINVAL}) {
    const std::string words = words_of(error), russian = in_language(words, Language::russian);
    EXPECT_EQ(in_language(words, Language::english), std::strerror(error));
    EXPECT_NE(russian, std::strerror(error)) << error;
    EXPECT_FALSE(russian.empty());
  }
  EXPECT_EQ(words_of(ELIBBAD), std::strerror(ELIBBAD)) << "a rare one stays the system's";
}

TEST(UnitWords, are_in_the_language_of_the_sentence) {
  EXPECT_EQ(in_language("5 " + unit_words("mm/s"), Language::english), "5 mm/s");
  EXPECT_EQ(in_language("5 " + unit_words("mm/s"), Language::russian), "5 мм/с");
  EXPECT_EQ(in_language(unit_words("deg"), Language::russian), "град");
  EXPECT_EQ(unit_words("furlong"), "furlong");
}

TEST(UnitSymbol, is_read_in_both_languages) {
  EXPECT_EQ(unit_symbol("мм"), "mm");
  EXPECT_EQ(unit_symbol("град"), "deg");
  EXPECT_EQ(unit_symbol("mm"), "mm");
  EXPECT_EQ(unit_symbol("furlong"), "furlong");
}

}  // namespace
}  // namespace servogate::text
