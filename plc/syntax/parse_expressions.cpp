// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/cursor.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

namespace {

struct Binary {
  std::string_view key;
  Operator op;
  int level;
};
// IEC 61131-3:2013, table 71: the higher level binds tighter; all combine from left to right.
constexpr Binary kBinary[] = {
    {"OR", Operator::or_, 1},   {"XOR", Operator::xor_, 2}, {"AND", Operator::and_, 3},
    {"&", Operator::and_, 3},   {"=", Operator::eq, 4},     {"<>", Operator::ne, 4},
    {"<", Operator::lt, 5},     {">", Operator::gt, 5},     {"<=", Operator::le, 5},
    {">=", Operator::ge, 5},    {"+", Operator::add, 6},    {"-", Operator::sub, 6},
    {"*", Operator::mul, 7},    {"/", Operator::div, 7},    {"MOD", Operator::mod, 7},
    {"**", Operator::power, 8},
};
constexpr int kTightest = 8;
// CODESYS; AND and OR leave out the right side as they are.
constexpr std::pair<std::string_view, std::string_view> kForeignWords[] = {{"AND_THEN", "AND"},
                                                                           {"OR_ELSE", "OR"}};

}  // namespace

ExpressionPtr copy(const Expression& e) {
  const auto same = [](const ExpressionPtr& p) { return p ? copy(*p) : nullptr; };
  auto out = std::make_unique<Expression>();
  out->kind = e.kind;
  out->location = e.location;
  out->op = e.op;
  out->name = e.name;
  out->literal = e.literal;
  out->repeats = e.repeats;
  for (const ExpressionPtr& o : e.operands) out->operands.push_back(same(o));
  for (const Argument& a : e.arguments)
    out->arguments.push_back({a.name, a.location, a.output, a.inverted, a.drawn, same(a.value)});
  out->enable = same(e.enable);
  out->enabled = same(e.enabled);
  out->enabled_inverted = e.enabled_inverted;
  return out;
}

ExpressionPtr Parser::make(ExpressionKind kind, const Location& at) {
  auto e = std::make_unique<Expression>();
  e->kind = kind;
  e->location = at;
  return e;
}

ExpressionPtr Parser::expression() {
  const Nesting nesting(*this);
  return binary(1);
}

ExpressionPtr Parser::binary(int level) {
  if (level > kTightest) return unary();
  ExpressionPtr left = binary(level + 1);
  for (int chain = 0;; ++chain) {
    for (const auto& [foreign, own] : kForeignWords)
      if (at(foreign) && ahead().kind != TokenKind::symbol) foreign_word(own);
    const Binary* found = nullptr;
    for (const Binary& b : kBinary)
      if (b.level == level && at(b.key)) found = &b;
    if (found == nullptr) return left;
    constexpr int kMaxChain = 1000;  // the tree of a chain is as deep as it is long
    if (chain == kMaxChain) {
      report_.error(now().location, texts::kTooDeep, {std::to_string(kMaxChain)});
      throw SyntaxError{};
    }
    ExpressionPtr e = make(ExpressionKind::binary, take().location);
    e->op = found->op;
    e->operands.push_back(std::move(left));
    e->operands.push_back(binary(level + 1));
    left = std::move(e);
  }
}

void Parser::foreign_word(std::string_view own) {
  report_.error(now().location, texts::kForeign, {now().text, std::string(own)});
  list_[at_].key = own;
}

ExpressionPtr Parser::unary() {
  const Operator op = at("-")     ? Operator::negate
                      : at("+")   ? Operator::plus
                      : at("NOT") ? Operator::not_
                                  : Operator::none;
  // NOT(IN := a) is the function.
  const bool function = op == Operator::not_ && ahead().is("(") && ahead(3).is(":=");
  if (op == Operator::none || function) return primary();
  const Nesting nesting(*this);
  const Location begin = take().location;
  ExpressionPtr operand = unary();
  // -5 is one literal, so that the least value of each type can be written.
  if (op == Operator::negate && operand->kind == ExpressionKind::literal && !operand->literal.negative &&
      is_untyped(operand->literal.kind)) {
    operand->literal.negative = true;
    operand->literal.real = -operand->literal.real;
    operand->location = begin;
    return operand;
  }
  ExpressionPtr e = make(ExpressionKind::unary, begin);
  e->op = op;
  e->operands.push_back(std::move(operand));
  return e;
}

ExpressionPtr Parser::primary() {
  const Token& t = now();
  if (t.kind == TokenKind::literal) {
    ExpressionPtr e = make(ExpressionKind::literal, t.location);
    e->literal = take().literal;
    return e;
  }
  if (t.kind == TokenKind::typed) return typed();
  if (t.kind == TokenKind::direct) {
    ExpressionPtr e = make(ExpressionKind::direct, t.location);
    e->name = take().text;
    return e;
  }
  if (at("(")) {
    const Location begin = take().location;
    ExpressionPtr e = expression();
    expect_closing(")", "'('", begin);
    return e;
  }
  // AND, OR, XOR, MOD and NOT are functions too.
  const bool operator_function = at_any({"AND", "OR", "XOR", "MOD", "NOT"}) && ahead().is("(");
  if (t.kind != TokenKind::word || (is_keyword(t.key) && !operator_function))
    fail(text::both("an expression", "выражение"));
  ExpressionPtr e = make(ExpressionKind::name, t.location);
  e->name = take().text;
  return postfix(std::move(e));
}

ExpressionPtr Parser::postfix(ExpressionPtr e) {
  for (int chain = 0;; ++chain) {
    if (chain > kMaxNesting) fail(text::both("fewer parts", "меньше частей"));
    const Location where = now().location;
    if (at("(")) {
      ExpressionPtr call = make(ExpressionKind::call, e->location);
      call->operands.push_back(std::move(e));
      arguments(*call);
      e = std::move(call);
    } else if (accept("[")) {
      ExpressionPtr index = make(ExpressionKind::index, e->location);
      index->operands.push_back(std::move(e));
      do index->operands.push_back(expression());
      while (accept(","));
      expect_closing("]", "'['", where);
      e = std::move(index);
    } else if (at("^")) {
      ExpressionPtr target = make(ExpressionKind::dereference, take().location);
      target->operands.push_back(std::move(e));
      e = std::move(target);
    } else if (at(".")) {
      take();
      const bool bit = now().kind == TokenKind::literal && now().literal.kind == Kind::untyped_int;
      const bool direct_bit = now().kind == TokenKind::direct && now().text.size() > 2;
      if (!bit && !direct_bit && now().kind != TokenKind::word) fail(text::both("a member", "элемент"));
      ExpressionPtr member =
          make(bit || direct_bit ? ExpressionKind::bit : ExpressionKind::member, now().location);
      member->name = now().text;
      member->literal = now().literal;
      member->operands.push_back(std::move(e));
      take();
      e = std::move(member);
    } else {
      return e;
    }
  }
}

ExpressionPtr Parser::typed() {
  ExpressionPtr e = make(ExpressionKind::typed, now().location);
  e->name = take().text;
  e->name.pop_back();
  const bool negative = at("-");
  if (negative || at("+")) take();
  if (now().kind == TokenKind::literal) {
    ExpressionPtr value = make(ExpressionKind::literal, now().location);
    value->literal = take().literal;
    if (negative) value->literal.negative = true, value->literal.real = -value->literal.real;
    e->operands.push_back(std::move(value));
  } else if (now().kind == TokenKind::word && !negative) {
    e->literal.text = take().text;
  } else {
    fail(text::both("a value", "значение"));
  }
  return e;
}

void Parser::arguments(Expression& call) {
  const Location begin = now().location;
  expect("(");
  while (!at(")")) {
    argument(call);
    if (!accept(",")) break;
    if (at(")")) fail(text::both("an argument", "аргумент"));
  }
  expect_closing(")", "'('", begin);
}

void Parser::argument(Expression& call) {
  Argument a;
  a.location = now().location;
  const bool inverted = at("NOT") && ahead().kind == TokenKind::word && ahead(2).is("=>");
  if (inverted) take();
  if (now().kind == TokenKind::word && (ahead().is(":=") || ahead().is("=>"))) {
    a.name = take().text;
    a.output = take().key == "=>";
    a.inverted = inverted;
  }
  if (!(a.output && at_any({",", ")"})))
    a.value = !a.name.empty() && at_parameter_list() ? parameter_list() : expression();
  const std::string key = key_of(a.name);
  if (key == "EN" && !a.output)
    call.enable = std::move(a.value);
  else if (key == "ENO" && a.output)
    call.enabled = std::move(a.value), call.enabled_inverted = a.inverted;
  else
    call.arguments.push_back(std::move(a));
}

}  // namespace servogate::plc::syntax
