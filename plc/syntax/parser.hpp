// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

namespace servogate::plc::syntax {

/// Reads one file of Structured Text and adds what it declares to `source`. After a syntax error reading goes
/// on at the next statement or declaration.
void parse_st(std::string_view text, int file, Source& source, Report& report);

/// One expression by itself (a path such as `Main.list[3].x`); null when the text is none.
ExpressionPtr parse_path(std::string_view text);

inline constexpr int kMaxNesting = 100;

}  // namespace servogate::plc::syntax
