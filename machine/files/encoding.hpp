// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace servogate::files {

/// Line (from 1) of the first byte that is not UTF-8; 0: all of it is.
int first_line_not_utf8(std::string_view text);

/// Name for iconv of the Russian encoding that a text which is not UTF-8 most likely has: "CP1251", "CP866",
/// "KOI8-R"; empty: too little of it to tell. By the frequency of letters, and capitals inside of words.
std::string_view likely_russian_encoding(std::string_view text);

}  // namespace servogate::files
