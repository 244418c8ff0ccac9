// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Texts of everything that reading a file by its keys can find.
namespace servogate::machine::finding {

inline constexpr text::Entry kFileMissing{"machine.file_missing", "the file cannot be read: {0}",
                                          "файл не читается: {0}"};
inline constexpr text::Entry kSyntax{"machine.syntax", "TOML syntax: {0}", "синтаксис TOML: {0}"};
inline constexpr text::Entry kNoQuotes{"machine.no_quotes", "{0} is text and stands in quotes: \"{0}\"",
                                       "{0} — текст и пишется в кавычках: \"{0}\""};
inline constexpr text::Entry kMovedKey{"machine.moved_key", "`{0}` is no key any more: it is now {1}",
                                       "ключа `{0}` больше нет: теперь это {1}"};
inline constexpr text::Entry kUnknownKey{"machine.unknown_key", "unknown key `{0}`; did you mean `{1}`?",
                                         "неизвестный ключ «{0}»; имелся в виду «{1}»?"};
inline constexpr text::Entry kUnknownKeyList{"machine.unknown_key", "unknown key `{0}`; known here: {1}",
                                             "неизвестный ключ «{0}»; здесь допустимы: {1}"};
inline constexpr text::Entry kMissingKey{"machine.missing_key", "`{0}` is missing: {1}",
                                         "не задан «{0}»: {1}"};
inline constexpr text::Entry kWrongType{"machine.wrong_type", "`{0}` must be {1}, not {2}",
                                        "«{0}» должен быть: {1}, а не {2}"};
inline constexpr text::Entry kWrongUnit{"machine.wrong_unit",
                                        "`{0}`: \"{1}\" has the wrong unit; expected {2} ({3})",
                                        "«{0}»: у «{1}» не та единица; ожидалось {2} ({3})"};
inline constexpr text::Entry kDecimalComma{"machine.decimal_comma",
                                           "`{0}`: \"{1}\" has a decimal comma; write \"{2}\"",
                                           "«{0}»: в «{1}» десятичная запятая; пишите «{2}»"};
inline constexpr text::Entry kNoUnit{"machine.no_unit",
                                     "`{0}`: \"{1}\" has no unit; expected a number or a string in {2}",
                                     "«{0}»: у «{1}» нет единицы; ожидалось число или строка в {2}"};
inline constexpr text::Entry kNotANumber{"machine.not_a_number",
                                         "`{0}`: \"{1}\" does not begin with a number; expected {2}",
                                         "«{0}»: «{1}» не начинается с числа; ожидалось {2}"};
inline constexpr text::Entry kNotFinite{"machine.not_finite", "`{0}` must be a finite number",
                                        "«{0}» должен быть конечным числом"};
inline constexpr text::Entry kOutOfRange{"machine.out_of_range", "`{0}` is {1}; allowed is {2}",
                                         "«{0}» равен {1}; допускается {2}"};
inline constexpr text::Entry kUnknownChoice{"machine.unknown_choice", "`{0}`: \"{1}\" is not one of {2}",
                                            "«{0}»: «{1}» не входит в список: {2}"};
inline constexpr text::Entry kNotAPlace{
    "machine.not_a_place", "`{0}`: \"{1}\" is no place; expected a form like SA16, SA20.IN, SK8.RE",
    "«{0}»: «{1}» не адрес; ожидался вид SA16, SA20.IN, SK8.RE"};
inline constexpr text::Entry kEmptyText{"machine.empty_text", "`{0}` must not be empty",
                                        "«{0}» не должен быть пустым"};

}  // namespace servogate::machine::finding
