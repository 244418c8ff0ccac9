// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/cursor.hpp"

#include <algorithm>

#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

bool is_keyword(std::string_view key) {
  static constexpr std::string_view words[] = {"AND",
                                               "ARRAY",
                                               "AT",
                                               "BY",
                                               "CASE",
                                               "CONFIGURATION",
                                               "CONSTANT",
                                               "CONTINUE",
                                               "DO",
                                               "ELSE",
                                               "ELSIF",
                                               "END_CASE",
                                               "END_CONFIGURATION",
                                               "END_FOR",
                                               "END_FUNCTION",
                                               "END_FUNCTION_BLOCK",
                                               "END_IF",
                                               "END_PROGRAM",
                                               "END_REPEAT",
                                               "END_RESOURCE",
                                               "END_STRUCT",
                                               "END_TYPE",
                                               "END_VAR",
                                               "END_WHILE",
                                               "EXIT",
                                               "FOR",
                                               "FUNCTION",
                                               "FUNCTION_BLOCK",
                                               "IF",
                                               "MOD",
                                               "NON_RETAIN",
                                               "NOT",
                                               "OF",
                                               "OR",
                                               "PROGRAM",
                                               "REPEAT",
                                               "RESOURCE",
                                               "RETAIN",
                                               "RETURN",
                                               "STRUCT",
                                               "TASK",
                                               "THEN",
                                               "TO",
                                               "TYPE",
                                               "UNTIL",
                                               "VAR",
                                               "VAR_ACCESS",
                                               "VAR_CONFIG",
                                               "VAR_EXTERNAL",
                                               "VAR_GLOBAL",
                                               "VAR_INPUT",
                                               "VAR_IN_OUT",
                                               "VAR_OUTPUT",
                                               "VAR_TEMP",
                                               "WHILE",
                                               "XOR"};
  return std::binary_search(std::begin(words), std::end(words), key);
}

bool Parser::at_any(std::initializer_list<std::string_view> keys) const {
  return std::any_of(keys.begin(), keys.end(), [&](std::string_view k) { return at(k); });
}

bool Parser::accept(std::string_view key) {
  if (!at(key)) return false;
  take();
  return true;
}

void Parser::expect(std::string_view key) {
  if (!accept(key)) fail("'" + std::string(key) + "'");
}

void Parser::expect_closing(std::string_view key, std::string_view opener, const Location& begin) {
  if (accept(key)) return;
  if (!now().told)
    report_.error(now().location, texts::kUnclosed,
                  {"'" + std::string(key) + "'", std::string(opener), std::to_string(begin.line), found()});
  throw SyntaxError{};
}

std::string Parser::identifier(std::string what) {
  if (now().kind != TokenKind::word || is_keyword(now().key)) fail(std::move(what));
  return take().text;
}

std::string Parser::found() const {
  if (!at_end()) return "'" + cropped(now().text) + "'";
  return piece_ ? text::both("the end", "конец") : text::both("the end of the file", "конец файла");
}

void Parser::fail(std::string wanted) {
  // A bad token has been reported by its reader; saying it again helps nobody.
  if (now().kind != TokenKind::bad && !now().told)
    report_.error(now().location, texts::kExpected, {std::move(wanted), found()});
  throw SyntaxError{};
}

void Parser::recover(std::initializer_list<std::string_view> stops) {
  while (!at_end() && !at_any(stops)) take();
}

Parser::Nesting::Nesting(Parser& parser) : p(parser) {
  if (++p.depth_ <= kMaxNesting) return;
  --p.depth_;
  p.report_.error(p.now().location, texts::kTooDeep, {std::to_string(kMaxNesting)});
  throw SyntaxError{};
}

ExpressionPtr Parser::whole(ExpressionPtr e) {
  if (!at_end()) fail(text::both("the end of the expression", "конец выражения"));
  return e;
}

StatementPtr Parser::whole_statement() {
  StatementPtr s = simple_statement();
  accept(";");
  if (!at_end()) fail(text::both("the end of the statement", "конец оператора"));
  return s;
}

Block Parser::whole_body(bool instructions, const std::vector<Variable>& variables) {
  Block out;
  while (!at_end()) {
    Block some = instructions ? instruction_list(variables) : block({});
    for (StatementPtr& s : some) out.push_back(std::move(s));
    if (at_end()) break;
    report_.error(now().location, texts::kExpected, {text::both("a statement", "оператор"), found()});
    take();
  }
  return out;
}

void parse_st(std::string_view text, int file, Source& source, Report& report) {
  Parser(text, {static_cast<std::int16_t>(file), 1, 1}, source, report).file();
}

ExpressionPtr parse_expression(std::string_view text, const Location& begin, Report& report, bool initial) {
  Source none;
  try {
    Parser p(text, begin, none, report);
    p.piece();
    return p.whole(initial ? p.initializer() : p.expression());
  } catch (const SyntaxError&) {
    auto bad = std::make_unique<Expression>();
    bad->location = begin;
    return bad;
  }
}

StatementPtr parse_statement(std::string_view text, const Location& begin, Report& report) {
  Source none;
  try {
    Parser p(text, begin, none, report);
    p.piece();
    return p.whole_statement();
  } catch (const SyntaxError&) {
    auto empty = std::make_unique<Statement>();
    empty->location = begin;
    return empty;
  }
}

Block parse_body(std::string_view text, const Location& begin, bool instructions,
                 const std::vector<Variable>& variables, Report& report) {
  Source none;
  try {
    Parser p(text, begin, none, report);
    p.piece();
    return p.whole_body(instructions, variables);
  } catch (const SyntaxError&) {
    return {};
  }
}

ExpressionPtr parse_path(std::string_view text) {
  Report report({"name"});
  Source none;
  try {
    Parser p(text, {0, 1, 1}, none, report);
    ExpressionPtr e = p.expression();
    return report.failed() || !p.at_end() ? nullptr : std::move(e);
  } catch (const SyntaxError&) {
    return nullptr;
  }
}

}  // namespace servogate::plc::syntax
