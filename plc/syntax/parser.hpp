// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

namespace servogate::plc::syntax {

/// Reads one file of Structured Text, with bodies in ST or IL, and adds what it declares to `source`. After a
/// syntax error reading goes on at the next statement or declaration.
void parse_st(std::string_view text, int file, Source& source, Report& report);

/// Pieces of text inside something else, a ladder or an XML file; `begin` is where they stand. What does not
/// hold is reported, and the result is `bad`, empty or what could be read. `initial`: an initial value, which
/// may be a list. `instructions`: Instruction List, else Structured Text.
ExpressionPtr parse_expression(std::string_view text, const Location& begin, Report& report,
                               bool initial = false);
StatementPtr parse_statement(std::string_view text, const Location& begin, Report& report);
Block parse_body(std::string_view text, const Location& begin, bool instructions,
                 const std::vector<Variable>& variables, Report& report);

/// One expression by itself (a path such as `Main.list[3].x`); null when the text is none.
ExpressionPtr parse_path(std::string_view text);

inline constexpr int kMaxNesting = 100;

}  // namespace servogate::plc::syntax
