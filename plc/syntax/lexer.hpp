// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "plc/syntax/report.hpp"

namespace servogate::plc::syntax {

enum class TokenKind : std::uint8_t {
  end,
  word,     ///< identifier or keyword; `key` is upper case
  literal,  ///< number, string, time, date
  typed,    ///< `NAME#` before a literal or an enumeration value
  direct,   ///< %IX0.0
  ladder,   ///< the lines between LADDER and END_LADDER
  symbol,   ///< operator or punctuation in `key`
  bad,      ///< a finding was reported
};

struct Token {
  TokenKind kind = TokenKind::end;
  Location location;
  std::size_t offset = 0;  ///< first byte in the text
  std::size_t end = 0;     ///< byte behind the last one
  std::string text;        ///< as written
  std::string key;
  Literal literal;
  bool told = false;      ///< why what is expected here does not come was reported
  std::size_t wrong = 0;  ///< errors found in it while reading

  bool is(std::string_view k) const {
    return (kind == TokenKind::word || kind == TokenKind::symbol) && key == k;
  }
};

/// Takes a text apart; the last token is `end`. Comments `(* *)` (nested), `/* */`, `//` and pragmas `{ }`
/// are skipped. Never fails: what cannot be read is reported and becomes a bad token.
/// `begin`: where the text stands in its file.
std::vector<Token> tokens(std::string_view text, const Location& begin, Report& report);

/// A literal as people type it at `--set` or `force`: TRUE, -5, 16#FF, T#30ms, 'text', INT#3. False: it is
/// none.
bool parse_literal(std::string_view text, Literal& out);

}  // namespace servogate::plc::syntax
