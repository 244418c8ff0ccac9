// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/cursor.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

namespace {
StatementPtr make_statement(StatementKind kind, const Location& at) {
  auto s = std::make_unique<Statement>();
  s->kind = kind;
  s->location = at;
  return s;
}
}  // namespace

Block Parser::block(std::initializer_list<std::string_view> ends) {
  Block out;
  for (tell_foreign_elsif(); !at_end() && !at_any(ends); tell_foreign_elsif()) {
    // A closing word of something outside ends this block too; the caller says what is missing.
    if (now().kind == TokenKind::word && is_keyword(now().key) &&
        (now().key.starts_with("END_") || at_any({"ELSE", "ELSIF", "UNTIL", "PROGRAM", "FUNCTION",
                                                  "FUNCTION_BLOCK", "TYPE", "CONFIGURATION"})))
      break;
    const std::size_t before = at_;
    try {
      StatementPtr s = statement();
      if (s->kind != StatementKind::empty) out.push_back(std::move(s));
    } catch (const SyntaxError&) {
      if (too_deep()) throw;
      recover({";",
               "END_IF",
               "END_CASE",
               "END_FOR",
               "END_WHILE",
               "END_REPEAT",
               "END_PROGRAM",
               "END_FUNCTION",
               "END_FUNCTION_BLOCK",
               "ELSE",
               "ELSIF",
               "UNTIL",
               "IF",
               "CASE",
               "FOR",
               "WHILE",
               "REPEAT",
               "PROGRAM",
               "FUNCTION",
               "FUNCTION_BLOCK",
               "TYPE",
               "CONFIGURATION",
               "VAR_GLOBAL"});
      accept(";");
      if (at_ == before) take();
    }
  }
  return out;
}

// ELSEIF of other languages: told as that, and read as what is meant.
void Parser::tell_foreign_elsif() {
  const bool condition =
      at("ELSEIF") && (ahead().kind == TokenKind::word || ahead().kind == TokenKind::literal ||
                       ahead().kind == TokenKind::direct || ahead().is("("));
  if (!condition) return;
  report_.error(now().location, texts::kForeign, {now().text, "ELSIF"});
  list_[at_].key = "ELSIF";
}

// A mistake in the deepest statement: closing words would be taken for others, so the body is left.
bool Parser::too_deep() {
  if (depth_ < kMaxNesting - 1) return false;
  recover({"END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK"});
  list_[at_].told = true;
  return true;
}

StatementPtr Parser::statement() {
  report_.go_on();
  const Nesting nesting(*this);
  const Location begin = now().location;
  if (accept(";") || skip_unsupported()) return make_statement(StatementKind::empty, begin);
  if (ahead().is(":=") && refuse_reserved()) {
    take();
    throw SyntaxError{};
  }
  if (at("IF")) return if_statement();
  if (at("CASE")) return case_statement();
  if (at("FOR")) return for_statement();
  if (at("WHILE")) return while_statement();
  if (at("REPEAT")) return repeat_statement();
  StatementPtr s;
  if (accept("EXIT"))
    s = make_statement(StatementKind::exit, begin);
  else if (accept("CONTINUE"))
    s = make_statement(StatementKind::continue_, begin);
  else if (accept("RETURN"))
    s = make_statement(StatementKind::return_, begin);
  else
    s = simple_statement();
  expect(";");
  return s;
}

// a += 1 and a++ of other languages.
void Parser::foreign_assignment(const Expression& target) {
  const std::string name = target.kind == ExpressionKind::name ? target.name : "...";
  const std::string op = now().key, foreign = op + ahead().key;
  const std::string rest = foreign.ends_with('=') ? "..." : "1";
  report_.error(now().location, texts::kForeign, {foreign, name + " := " + name + " " + op + " " + rest});
  throw SyntaxError{};
}

StatementPtr Parser::simple_statement() {
  const Location begin = now().location;
  if (now().kind != TokenKind::word && now().kind != TokenKind::direct)
    fail(text::both("a statement", "оператор"));
  if (now().kind == TokenKind::word && is_keyword(now().key)) fail(text::both("a statement", "оператор"));
  ExpressionPtr target = primary();
  StatementPtr s = make_statement(StatementKind::call, begin);
  if (at("=")) {
    report_.error(now().location, texts::kAssignEqual);
    throw SyntaxError{};
  }
  if (at_any({":=", "?="})) {
    s->attempt = take().is("?=");
    s->kind = StatementKind::assign;
    s->target = std::move(target);
    s->value = expression();
    if (at(":=")) fail("';'");
    return s;
  }
  if (at_any({"+", "-", "*", "/"}) && (ahead().is("=") || ahead().is(now().key))) foreign_assignment(*target);
  if (target->kind != ExpressionKind::call) {
    if (!at(";")) fail(text::both("':=' or '('", "':=' или '('"));
    report_.error(begin, texts::kUseless);
  }
  s->value = std::move(target);
  return s;
}

// An expression and the word behind it. After a mistake reading goes on behind that word, so that the
// statement keeps its form.
ExpressionPtr Parser::header(std::string_view closer) {
  try {
    ExpressionPtr e = expression();
    if (at(":=")) {
      report_.error(now().location, texts::kForeign, {":=", "="});
      throw SyntaxError{};
    }
    expect(closer);
    return e;
  } catch (const SyntaxError&) {
    if (depth_ >= kMaxNesting - 1) throw;
    ExpressionPtr bad = make(ExpressionKind::bad, now().location);
    const int line = list_[at_ - 1].location.line;
    while (!at_end() && !at(closer) && !at(";") && now().location.line == line) take();
    accept(closer);
    return bad;
  }
}

StatementPtr Parser::if_statement() {
  StatementPtr s = make_statement(StatementKind::if_, now().location);
  do {
    take();
    Branch& b = s->branches.emplace_back();
    b.condition = header("THEN");
    b.body = block({"ELSIF", "ELSE", "END_IF"});
  } while (at("ELSIF"));
  if (accept("ELSE")) {
    s->has_else = true;
    s->body = block({"END_IF"});
  }
  expect_closing("END_IF", "IF", s->location);
  accept(";");
  return s;
}

// A label list begins here: something up to a colon, with no ':=' or ';' before it.
bool Parser::at_label() const {
  if (at_any({"ELSE", "END_CASE"})) return true;
  if (now().kind == TokenKind::word && is_keyword(now().key)) return false;
  for (std::size_t n = at_; n < list_.size() && n < at_ + 4000; ++n) {
    if (list_[n].is(":")) return true;
    if (list_[n].kind == TokenKind::end || list_[n].is(";") || list_[n].is(":=") || list_[n].is("("))
      return false;
  }
  return false;
}

std::vector<Label> Parser::labels() {
  std::vector<Label> out;
  do {
    Label l;
    l.low = expression();
    if (accept("..")) l.high = expression();
    out.push_back(std::move(l));
  } while (accept(","));
  expect(":");
  return out;
}

StatementPtr Parser::case_statement() {
  StatementPtr s = make_statement(StatementKind::case_, take().location);
  s->target = header("OF");
  while (!at_end() && !at_any({"ELSE", "END_CASE"})) {
    Branch b;
    try {
      b.labels = labels();
    } catch (const SyntaxError&) {
      if (too_deep()) throw;
      recover({";", "ELSE", "END_CASE", "END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK", "END_IF"});
      if (!accept(";")) break;
      continue;
    }
    while (!at_label() && !at_end()) {
      const std::size_t before = at_;
      if (now().kind == TokenKind::word && now().key.starts_with("END_")) break;
      try {
        StatementPtr inner = statement();
        if (inner->kind != StatementKind::empty) b.body.push_back(std::move(inner));
      } catch (const SyntaxError&) {
        if (too_deep()) throw;
        recover({";", "ELSE", "END_CASE", "END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK", "END_IF"});
        accept(";");
        if (at_ == before) take();
      }
    }
    s->branches.push_back(std::move(b));
    if (now().kind == TokenKind::word && now().key.starts_with("END_")) break;
  }
  if (accept("ELSE")) {
    s->has_else = true;
    s->body = block({"END_CASE"});
  }
  expect_closing("END_CASE", "CASE", s->location);
  accept(";");
  return s;
}

StatementPtr Parser::for_statement() {
  StatementPtr s = make_statement(StatementKind::for_, take().location);
  s->target = make(ExpressionKind::name, now().location);
  s->target->name = identifier(text::both("the variable that counts", "переменная-счётчик"));
  bool counts = true;
  if (at("=")) {
    report_.error(take().location, texts::kAssignEqual);
  } else if (!accept(":=")) {  // FOR a.b := ...: the rest is read, and means nothing
    counts = false;
    report_.error(now().location, texts::kExpected, {"':='", found()});
    recover({":=", ";", "TO", "DO"});
    if (!accept(":=")) throw SyntaxError{};
  }
  s->value = expression();
  expect("TO");
  s->to = expression();
  if (at("BY")) {
    take();
    s->by = header("DO");
  } else if (!accept("DO")) {
    report_.error(now().location, texts::kExpected, {"'DO'", found()});
  }
  s->body = block({"END_FOR"});
  expect_closing("END_FOR", "FOR", s->location);
  accept(";");
  if (!counts) s->kind = StatementKind::empty;
  return s;
}

StatementPtr Parser::while_statement() {
  StatementPtr s = make_statement(StatementKind::while_, take().location);
  s->value = header("DO");
  s->body = block({"END_WHILE"});
  expect_closing("END_WHILE", "WHILE", s->location);
  accept(";");
  return s;
}

StatementPtr Parser::repeat_statement() {
  StatementPtr s = make_statement(StatementKind::repeat, take().location);
  s->body = block({"UNTIL"});
  expect_closing("UNTIL", "REPEAT", s->location);
  s->value = expression();
  accept(";");
  expect_closing("END_REPEAT", "REPEAT", s->location);
  accept(";");
  return s;
}

}  // namespace servogate::plc::syntax
