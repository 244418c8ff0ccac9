// SPDX-License-Identifier: Apache-2.0
// Instruction List (IEC 61131-3:2013, 7.2) to the statements of the tree. The current result is an expression
// until it is needed twice, or until something runs that could change what it reads: then it is held.
#include <algorithm>
#include <map>

#include "plc/syntax/cursor.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

namespace {

enum class Instruction : std::uint8_t { load, store, set, reset, invert, combine, jump, call, leave };
enum class When : std::uint8_t { always, if_true, if_false };

struct Known {
  std::string_view name;
  Instruction what;
  Operator op = Operator::none;
  bool inverted = false;
  When when = When::always;
};
constexpr Known kInstructions[] = {
    {"LD", Instruction::load},
    {"LDN", Instruction::load, Operator::none, true},
    {"ST", Instruction::store},
    {"STN", Instruction::store, Operator::none, true},
    {"S", Instruction::set},
    {"R", Instruction::reset},
    {"NOT", Instruction::invert},
    {"AND", Instruction::combine, Operator::and_},
    {"&", Instruction::combine, Operator::and_},
    {"ANDN", Instruction::combine, Operator::and_, true},
    {"&N", Instruction::combine, Operator::and_, true},
    {"OR", Instruction::combine, Operator::or_},
    {"ORN", Instruction::combine, Operator::or_, true},
    {"XOR", Instruction::combine, Operator::xor_},
    {"XORN", Instruction::combine, Operator::xor_, true},
    {"ADD", Instruction::combine, Operator::add},
    {"SUB", Instruction::combine, Operator::sub},
    {"MUL", Instruction::combine, Operator::mul},
    {"DIV", Instruction::combine, Operator::div},
    {"MOD", Instruction::combine, Operator::mod},
    {"GT", Instruction::combine, Operator::gt},
    {"GE", Instruction::combine, Operator::ge},
    {"EQ", Instruction::combine, Operator::eq},
    {"NE", Instruction::combine, Operator::ne},
    {"LE", Instruction::combine, Operator::le},
    {"LT", Instruction::combine, Operator::lt},
    {"JMP", Instruction::jump},
    {"JMPC", Instruction::jump, Operator::none, false, When::if_true},
    {"JMPCN", Instruction::jump, Operator::none, false, When::if_false},
    {"CAL", Instruction::call},
    {"CALC", Instruction::call, Operator::none, false, When::if_true},
    {"CALCN", Instruction::call, Operator::none, false, When::if_false},
    {"RET", Instruction::leave},
    {"RETC", Instruction::leave, Operator::none, false, When::if_true},
    {"RETCN", Instruction::leave, Operator::none, false, When::if_false},
};
// Inputs of the standard blocks that are instructions as well (table 70). S and R are in the table above.
constexpr std::string_view kInputs[] = {"S1", "R1", "CLK", "CU", "CD", "PV", "IN", "PT"};

const Known* known(std::string_view key) {
  for (const Known& k : kInstructions)
    if (k.name == key) return &k;
  return nullptr;
}
bool input_name(std::string_view key) {
  return std::find(std::begin(kInputs), std::end(kInputs), key) != std::end(kInputs);
}

StatementPtr statement_of(StatementKind kind, const Location& at) {
  auto s = std::make_unique<Statement>();
  s->kind = kind;
  s->location = at;
  return s;
}

/// Reading it again gives the same value, whatever has run between.
bool lasting(const Expression& e) {
  return e.kind == ExpressionKind::literal || e.kind == ExpressionKind::held || e.kind == ExpressionKind::bad;
}

}  // namespace

class InstructionList {
 public:
  InstructionList(Parser& p, const std::vector<Variable>& variables) : p_(p), variables_(variables) {}

  Block run() {
    p_.list_body_ = this;
    find_labels();
    while (!at_end()) {
      line_ = p_.now().location.line;
      try {
        line();
        // A long list is no deep tree.
        if (result_ == nullptr || result_->operands.empty())
          chain_ = 0;
        else if (++chain_ % kLongestChain == 0)
          result_ = held(std::move(result_));
      } catch (const SyntaxError&) {
        while (!at_end() && p_.now().location.line == line_) p_.take();
        result_ = Parser::make(ExpressionKind::bad, p_.now().location);
      }
    }
    if (!open_.empty())
      p_.report_.error(p_.now().location, texts::kUnclosed,
                       {"')'", "'('", std::to_string(open_.back().at.line), p_.found()});
    drop();
    p_.list_body_ = nullptr;
    return std::move(out_);
  }

  // The value of a parameter as a list of its own: IN := ( LD x ANDN y ), a line each (IEC 61131-3, 7.2.3).
  bool at_parameter_list() const {
    const Token& t = p_.ahead();
    const Known* k = t.kind == TokenKind::word ? known(t.key) : nullptr;
    return p_.at("(") && k != nullptr && k->what == Instruction::load &&
           t.location.line > p_.now().location.line;
  }
  ExpressionPtr parameter_list() {
    const Parser::Nesting nesting(p_);
    const Location begin = take().location;
    if (result_ != nullptr) result_ = held(std::move(result_));
    ExpressionPtr outside = std::move(result_);
    std::vector<Open> open = std::move(open_);
    open_.clear();
    while (!at_end() && !(p_.at(")") && open_.empty())) {
      line_ = p_.now().location.line;
      line();
    }
    ExpressionPtr value = need(p_.now());
    p_.expect_closing(")", "'('", begin);
    last_line_ = p_.list_[p_.at_ - 1].location.line;
    open_ = std::move(open);
    result_ = std::move(outside);
    return value;
  }

 private:
  struct Open {
    ExpressionPtr left;
    Operator op;
    bool inverted;
    Location at;
  };

  bool ends(const Token& t) const {
    return t.kind == TokenKind::end ||
           (t.kind == TokenKind::word && (t.key.starts_with("END_") || t.key == "PROGRAM" ||
                                          t.key == "FUNCTION" || t.key == "FUNCTION_BLOCK"));
  }
  bool at_end() const { return ends(p_.now()); }
  bool end_of_line() const { return at_end() || p_.now().location.line != last_line_; }
  const Token& take() {
    const Token& t = p_.take();
    last_line_ = t.location.line;
    return t;
  }

  // Which labels are met with a current result that the instruction behind them uses.
  void find_labels() {
    for (std::size_t i = p_.at_; !ends(p_.list_[i]); ++i) {
      const Token& t = p_.list_[i];
      if (t.kind != TokenKind::word || !p_.list_[i + 1].is(":")) continue;
      std::size_t next = i + 2;
      while (p_.list_[next].kind == TokenKind::word && p_.list_[next + 1].is(":")) next += 2;
      if (uses_result(next)) carried_[t.key] = p_.holds_++;
    }
  }
  // The instruction that begins at this token needs the current result.
  bool uses_result(std::size_t at) const {
    const Token& t = p_.list_[at];
    if (ends(t)) return false;
    if (t.is(")") || t.is("&")) return true;
    if (t.kind != TokenKind::word) return false;
    if (p_.list_[at + 1].is(":")) return carried_.contains(t.key);
    if (const Known* k = known(t.key))
      return k->what != Instruction::load &&
             (k->when != When::always || (k->what != Instruction::jump && k->what != Instruction::call &&
                                          k->what != Instruction::leave));
    return !p_.list_[at + 1].is("(");
  }
  bool used_next() const { return uses_result(p_.at_); }

  void line() {
    const Token& t = p_.now();
    last_line_ = t.location.line;
    if (t.kind == TokenKind::word && p_.ahead().is(":")) return label();
    if (t.is(")")) return close();
    if (t.is("&")) {
      take();
      const bool n = p_.at("N") && p_.now().offset == t.end;
      if (n) take();
      return instruction(*known(n ? "&N" : "&"), t);
    }
    if (t.kind != TokenKind::word) p_.fail(text::both("an instruction", "инструкция"));
    take();
    if (const Known* k = known(t.key)) return instruction(*k, t);
    function_or_input(t);
  }

  void instruction(const Known& k, const Token& t) {
    switch (k.what) {
      case Instruction::load: {
        drop();
        result_ = inverse(operand(), k.inverted, t.location);
        break;
      }
      case Instruction::store: {
        StatementPtr s = statement_of(StatementKind::assign, t.location);
        s->target = operand();
        s->value = inverse(keep(t), k.inverted, t.location);
        emit(std::move(s));
        break;
      }
      case Instruction::set:
      case Instruction::reset:
        set(k, t);
        break;
      case Instruction::invert:
        result_ = inverse(need(t), true, t.location);
        break;
      case Instruction::combine:
        combine(k, t);
        return;
      case Instruction::jump:
        jump(k, t);
        break;
      case Instruction::call:
        call(k, t);
        break;
      case Instruction::leave:
        conditional(k, t, statement_of(StatementKind::return_, t.location));
        break;
    }
    expect_end_of_line();
  }

  void expect_end_of_line() {
    if (end_of_line() || p_.at(")")) return;
    p_.report_.error(p_.now().location, texts::kEndOfLine, {p_.found()});
    throw SyntaxError{};
  }

  // A constant or a variable; not what stands in the next line.
  ExpressionPtr operand() {
    if (end_of_line()) {
      p_.report_.error(
          {p_.now().location.file, last_line_, column_behind()}, texts::kExpected,
          {text::both("an operand", "операнд"), text::both("the end of the line", "конец строки")});
      throw SyntaxError{};
    }
    ExpressionPtr e = p_.at("-") || p_.at("+") ? p_.unary() : p_.primary();
    last_line_ = p_.list_[p_.at_ - 1].location.line;
    return e;
  }
  int column_behind() const {
    const Token& t = p_.list_[p_.at_ - 1];
    return t.location.column + static_cast<int>(t.text.size());
  }

  ExpressionPtr inverse(ExpressionPtr e, bool wanted, const Location& at) {
    if (!wanted) return e;
    ExpressionPtr out = Parser::make(ExpressionKind::unary, at);
    out->op = Operator::not_;
    out->operands.push_back(std::move(e));
    return out;
  }

  // The current result, which is gone afterwards.
  ExpressionPtr need(const Token& t) {
    if (result_ != nullptr) return std::move(result_);
    p_.report_.error(t.location, texts::kNoCurrent, {t.text});
    return Parser::make(ExpressionKind::bad, t.location);
  }
  // The current result; it stays where the next instruction uses it.
  ExpressionPtr keep(const Token& t) {
    ExpressionPtr e = need(t);
    if (!used_next()) return e;
    e = held(std::move(e));
    result_ = copy(*e);
    return e;
  }
  ExpressionPtr held(ExpressionPtr e) {
    if (lasting(*e)) return e;
    return held_as(std::move(e), p_.holds_++);
  }
  // What stands left of open parentheses is computed first.
  void settle_open() {
    for (Open& o : open_)
      if (o.left && !lasting(*o.left)) o.left = hold_now(std::move(o.left), p_.holds_++);
  }
  ExpressionPtr held_as(ExpressionPtr e, std::uint64_t number) {
    settle_open();
    return hold_now(std::move(e), number);
  }
  ExpressionPtr hold_now(ExpressionPtr e, std::uint64_t number) {
    const Location at = e->location;
    StatementPtr s = statement_of(StatementKind::hold, at);
    s->number = number;
    s->value = std::move(e);
    out_.push_back(std::move(s));
    ExpressionPtr name = Parser::make(ExpressionKind::held, at);
    name->literal.magnitude = number;
    return name;
  }
  void emit(StatementPtr s) {
    settle_open();
    out_.push_back(std::move(s));
  }
  // A result that nobody takes; a call was made for its effects.
  void drop() {
    if (result_ != nullptr && result_->kind == ExpressionKind::call) {
      StatementPtr s = statement_of(StatementKind::call, result_->location);
      s->value = std::move(result_);
      emit(std::move(s));
    }
    result_ = nullptr;
  }

  void combine(const Known& k, const Token& t) {
    ExpressionPtr left = need(t);
    if (p_.at("(") && !end_of_line()) {
      take();
      if (open_.size() >= kMaxNesting) {
        p_.report_.error(t.location, texts::kTooDeep, {std::to_string(kMaxNesting)});
        p_.recover({"END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK"});  // the list is left
        open_.clear();
        throw SyntaxError{};
      }
      open_.push_back({std::move(left), k.op, k.inverted, t.location});
      result_ = nullptr;
      if (!end_of_line() && !(p_.now().kind == TokenKind::word && known(p_.now().key) != nullptr &&
                              p_.ahead().location.line == last_line_ && !p_.ahead().is(")")))
        result_ = operand();
      if (p_.at(")")) close();
      return;
    }
    ExpressionPtr right = inverse(operand(), k.inverted, t.location);
    result_ = joined(k.op, std::move(left), std::move(right), t.location);
    expect_end_of_line();
  }
  static ExpressionPtr joined(Operator op, ExpressionPtr left, ExpressionPtr right, const Location& at) {
    ExpressionPtr e = Parser::make(ExpressionKind::binary, at);
    e->op = op;
    e->operands.push_back(std::move(left));
    e->operands.push_back(std::move(right));
    return e;
  }
  void close() {
    const Token& t = take();
    if (open_.empty()) {
      p_.report_.error(t.location, texts::kExpected, {text::both("an instruction", "инструкция"), "')'"});
      throw SyntaxError{};
    }
    ExpressionPtr right = need(t);
    Open o = std::move(open_.back());
    open_.pop_back();
    result_ = joined(o.op, std::move(o.left), inverse(std::move(right), o.inverted, o.at), o.at);
    if (!p_.at(")") || end_of_line()) expect_end_of_line();
  }

  // S and R set a BOOL; where the operand is a block they are its inputs.
  void set(const Known& k, const Token& t) {
    StatementPtr s =
        statement_of(k.what == Instruction::set ? StatementKind::set : StatementKind::reset, t.location);
    s->target = operand();
    ExpressionPtr value = keep(t);
    if (!surely_bool(*s->target)) {
      value = held(std::move(value));
      s->alternative = input_call(copy(*s->target), t, copy(*value));
    }
    s->value = std::move(value);
    emit(std::move(s));
  }
  bool surely_bool(const Expression& target) const {
    return target.kind == ExpressionKind::name &&
           std::any_of(variables_.begin(), variables_.end(), [&](const Variable& v) {
             return same_name(v.name, target.name) && v.type && same_name(v.type->name, "BOOL");
           });
  }
  static StatementPtr input_call(ExpressionPtr block, const Token& input, ExpressionPtr value) {
    StatementPtr s = statement_of(StatementKind::call, input.location);
    s->value = Parser::make(ExpressionKind::call, block->location);
    s->value->operands.push_back(std::move(block));
    Argument a;
    a.name = input.text;
    a.location = input.location;
    a.value = std::move(value);
    s->value->arguments.push_back(std::move(a));
    return s;
  }

  // CLK trigger; LIMIT 0, 10 with the current result first; F(a := 1, b := 2).
  void function_or_input(const Token& t) {
    if (p_.at("(") && p_.now().location.line == t.location.line) {
      drop();
      --p_.at_;
      result_ = p_.primary();
      last_line_ = p_.list_[p_.at_ - 1].location.line;
    } else if (p_.at(":=") || p_.at(".") || p_.at("[")) {
      p_.report_.error(p_.now().location, texts::kListOnly, {p_.now().text});
      throw SyntaxError{};
    } else if (end_of_line() && result_ == nullptr) {
      unknown(t);
    } else if (input_name(t.key)) {
      ExpressionPtr block = operand();
      emit(input_call(std::move(block), t, keep(t)));
    } else {
      ExpressionPtr call = Parser::make(ExpressionKind::call, t.location);
      call->operands.push_back(Parser::make(ExpressionKind::name, t.location));
      call->operands[0]->name = t.text;
      if (result_ == nullptr) unknown(t);
      const auto add = [&](ExpressionPtr e) {
        Argument a;
        a.location = e->location;
        a.value = std::move(e);
        call->arguments.push_back(std::move(a));
      };
      add(need(t));
      if (!end_of_line() && !p_.at(")")) {
        add(operand());
        while (!end_of_line() && p_.at(",")) {
          take();
          add(operand());
        }
      }
      result_ = std::move(call);
    }
    expect_end_of_line();
  }
  [[noreturn]] void unknown(const Token& t) {
    std::vector<std::string> names;
    for (const Known& k : kInstructions) names.emplace_back(k.name);
    p_.report_.error(t.location, texts::kNoInstruction, {t.text, suggestion(t.text, names)});
    throw SyntaxError{};
  }

  void label() {
    StatementPtr s = statement_of(StatementKind::label, p_.now().location);
    s->name = take().text;
    take();
    outside_parentheses(s->location, text::both("a label", "метка"));
    const auto carried = carried_.find(key_of(s->name));
    if (carried == carried_.end()) {
      drop();
    } else {
      if (result_ != nullptr) held_as(std::move(result_), carried->second);
      result_ = Parser::make(ExpressionKind::held, s->location);
      result_->literal.magnitude = carried->second;
    }
    out_.push_back(std::move(s));
  }
  void jump(const Known& k, const Token& t) {
    outside_parentheses(t.location, t.text);
    if (p_.now().kind != TokenKind::word || end_of_line()) {
      p_.fail(text::both("a label", "метка"));
    }
    StatementPtr s = statement_of(StatementKind::jump, p_.now().location);
    s->name = take().text;
    const auto carried = carried_.find(key_of(s->name));
    if (carried != carried_.end()) {
      ExpressionPtr e = held(need(t));
      if (k.when != When::always) result_ = copy(*e);
      held_as(std::move(e), carried->second);
    }
    conditional(k, t, std::move(s));
  }
  void outside_parentheses(const Location& at, std::string what) {
    if (open_.empty()) return;
    p_.report_.error(at, texts::kInParentheses, {std::move(what)});
    throw SyntaxError{};
  }

  void call(const Known& k, const Token& t) {
    StatementPtr s = statement_of(StatementKind::call, t.location);
    ExpressionPtr e = operand();
    if (e->kind != ExpressionKind::call) {
      ExpressionPtr whole = Parser::make(ExpressionKind::call, e->location);
      whole->operands.push_back(std::move(e));
      e = std::move(whole);
    }
    s->location = e->location;
    s->value = std::move(e);
    conditional(k, t, std::move(s));
  }

  // The statement, under the current result where the instruction ends in C or CN.
  void conditional(const Known& k, const Token& t, StatementPtr s) {
    const bool leaves = k.what != Instruction::call;
    if (k.when == When::always) {
      if (result_ != nullptr && !leaves && used_next())
        result_ = held(std::move(result_));
      else
        drop();
      emit(std::move(s));
      return;
    }
    StatementPtr test = statement_of(StatementKind::if_, t.location);
    Branch& b = test->branches.emplace_back();
    b.condition = inverse(keep(t), k.when == When::if_false, t.location);
    b.body.push_back(std::move(s));
    emit(std::move(test));
  }

  Parser& p_;
  const std::vector<Variable>& variables_;
  Block out_;
  ExpressionPtr result_;
  std::vector<Open> open_;
  std::map<std::string, std::uint64_t> carried_;
  static constexpr int kLongestChain = 20;
  int chain_ = 0;      ///< operations in the tree of the current result
  int line_ = 0;       ///< of the instruction
  int last_line_ = 0;  ///< of the token taken last
};

// A list begins with LD, CAL, JMP or RET, perhaps behind labels; a body of ST never does.
bool Parser::at_instruction_list() const {
  std::size_t n = 0;
  while (ahead(n).kind == TokenKind::word && ahead(n + 1).is(":")) n += 2;
  constexpr std::string_view kFirst[] = {"LD", "LDN", "CAL", "JMP", "RET"};
  const Token& next = ahead(n + 1);
  return std::find(std::begin(kFirst), std::end(kFirst), ahead(n).key) != std::end(kFirst) &&
         ahead(n).kind == TokenKind::word && !next.is(":=") && !next.is(".") && !next.is("[") &&
         !next.is("(") && !next.is("=");
}

Block Parser::instruction_list(const std::vector<Variable>& variables) {
  return InstructionList(*this, variables).run();
}

bool Parser::at_parameter_list() const { return list_body_ != nullptr && list_body_->at_parameter_list(); }
ExpressionPtr Parser::parameter_list() { return list_body_->parameter_list(); }

}  // namespace servogate::plc::syntax
