// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using ir::ExprKind;
using ir::StmtKind;
using syntax::ExpressionKind;
using syntax::Section;
using syntax::StatementKind;
using syntax::UnitKind;

namespace {
ir::Stmt make(StmtKind kind, const Location& at) {
  ir::Stmt s;
  s.kind = kind;
  s.at = at;
  return s;
}
}  // namespace

void Analyzer::body(int unit) {
  current_ = unit;
  unknown_.clear();
  for_variables_.clear();
  loops_ = 0;
  held_.clear();
  labels_.clear();
  UnitScope& u = here();
  ir::Unit& out = program_.units[static_cast<std::size_t>(unit)];
  for (const Variable& v : u.variables) {  // R_EDGE, F_EDGE: the input becomes its edge
    const auto last = u.by_name.find(key_of(v.name + "$last"));
    if (last == u.by_name.end()) continue;
    const Variable& before = u.variables[last->second];
    const int edge = v.edge;
    ir::Place now, then;
    now.root = then.root = ir::Root::instance;
    now.type = then.type = elementary(Kind::boolean);
    now.cell = v.cell;
    then.cell = before.cell;
    const auto inverse = [&](ExprPtr e, bool wanted) {
      if (!wanted) return e;
      ExprPtr n = node(ExprKind::unary, e->type, v.at);
      n->op = Op::not_;
      n->args.push_back(std::move(e));
      return n;
    };
    ExprPtr changed = combine(Op::xor_, load(now.copy(), v.at), load(then.copy(), v.at), v.at, "XOR");
    ExprPtr pulse =
        combine(Op::and_, std::move(changed), inverse(load(now.copy(), v.at), edge < 0), v.at, "AND");
    ir::Stmt set = make(StmtKind::if_, v.at);
    ir::Branch b;
    b.condition = std::move(pulse);
    assign(then.copy(), load(now.copy(), v.at), v.at, b.body);
    Constant one;
    one.i = 1;
    assign(now.copy(), make_constant(now.type, one, v.at), v.at, b.body);
    set.branches.push_back(std::move(b));
    assign(then.copy(), load(now.copy(), v.at), v.at, set.body);
    assign(now.copy(), make_constant(now.type, {}, v.at), v.at, set.body);
    out.body.push_back(std::move(set));
  }
  collect_labels(u.source->body);
  ir::Block rest = block(u.source->body);
  for (ir::Stmt& s : rest) out.body.push_back(std::move(s));
  if (u.source->kind == UnitKind::function && u.result_variable >= 0 && u.result->kind != Kind::error &&
      !u.variables[static_cast<std::size_t>(u.result_variable)].written)
    report_.warning(u.source->location, texts::kNoResult, {u.source->name});
}

ir::Block Analyzer::block(const syntax::Block& b) {
  ir::Block out;
  for (const syntax::StatementPtr& s : b) statement(*s, out);
  return out;
}

void Analyzer::statement(const syntax::Statement& s, ir::Block& out) {
  report_.go_on();
  if (drawn_call(s, out) || guarded(s, out)) return;
  switch (s.kind) {
    case StatementKind::assign:
      return assignment(s, out);
    case StatementKind::call: {
      if (s.value->kind != ExpressionKind::call) return;  // reported while reading
      const Expression& callee = *s.value->operands[0];
      bool global = false;
      Variable* v = callee.kind == ExpressionKind::name ? find_variable(callee.name, global) : nullptr;
      if (v != nullptr) v->used = true;
      if (callee.kind != ExpressionKind::name || (v != nullptr && v->type->kind == Kind::block)) {
        const auto instance = place(callee, false);
        if (!instance) return;
        if (instance->type->kind == Kind::block && !changeable(callee)) return;
        if (instance->type->kind == Kind::block && !drawn_as(*s.value, *instance->type)) return;
        if (instance->type->kind == Kind::block)
          return block_call(*s.value, *instance, instance->type->block, out);
      }
      if (v != nullptr && v->type->kind == Kind::error) return;
      ir::Stmt call_stmt = make(StmtKind::evaluate, s.location);
      call_stmt.value = call(*s.value, nullptr, true);
      if (call_stmt.value->type->kind == Kind::error) return;
      if (call_stmt.value->kind != ExprKind::call) {
        report_.error(s.location, texts::kUseless);
        return;
      }
      out.push_back(std::move(call_stmt));
      return;
    }
    case StatementKind::hold:
      return hold(s, out);
    case StatementKind::set:
    case StatementKind::reset:
      return set_statement(s, out);
    case StatementKind::label:
    case StatementKind::jump: {
      ir::Stmt mark = make(s.kind == StatementKind::label ? StmtKind::label : StmtKind::jump, s.location);
      mark.label = label(s);
      if (mark.label >= 0) out.push_back(std::move(mark));
      return;
    }
    case StatementKind::if_:
      return if_statement(s, out);
    case StatementKind::case_:
      return case_statement(s, out);
    case StatementKind::for_:
      return for_statement(s, out);
    case StatementKind::while_:
    case StatementKind::repeat:
      return loop_statement(s, out);
    case StatementKind::exit:
    case StatementKind::continue_:
      if (loops_ == 0)
        report_.error(s.location, texts::kExitOutside, {s.kind == StatementKind::exit ? "EXIT" : "CONTINUE"});
      out.push_back(make(s.kind == StatementKind::exit ? StmtKind::exit : StmtKind::continue_, s.location));
      return;
    case StatementKind::return_:
      out.push_back(make(StmtKind::return_, s.location));
      return;
    case StatementKind::empty:
      return;
  }
}

void Analyzer::assignment(const syntax::Statement& s, ir::Block& out) {
  if (s.target->kind == ExpressionKind::call) {
    report_.error(s.target->location, texts::kNotVariable);
    return;
  }
  auto target = place(*s.target, true);
  ExprPtr value =
      expression(*s.value, target ? (target->type->bounded ? target->type->base : target->type) : nullptr);
  if (!target) return;
  if (s.attempt) value = attempted(std::move(value), *target->type);
  assign(std::move(*target), std::move(value), s.location, out);
}

void Analyzer::assign(ir::Place target, ExprPtr value, const Location& at, ir::Block& out) {
  const Type* type = target.type;
  value = assignable(std::move(value), type);
  if (value->type->kind == Kind::error || value->type->kind == Kind::none) {
    if (value->type->kind == Kind::none) report_.error(value->at, texts::kNoValue, {"()"});
    return;
  }
  ir::Stmt s = make(StmtKind::assign, at);
  s.check_range = type->bounded && value->kind != ExprKind::constant;
  s.place = std::move(target);
  s.value = std::move(value);
  out.push_back(std::move(s));
}

// The first hold of a number gives the type; its cell is fixed, because no value outlives the run of a body.
void Analyzer::hold(const syntax::Statement& s, ir::Block& out) {
  const auto known = held_.find(s.number);
  const Type* hint = known == held_.end() ? nullptr : known->second.type;
  ExprPtr value = settle(expression(*s.value, hint), hint);
  if (value->type->kind == Kind::error) return;
  if (value->type->kind == Kind::none || value->type->kind == Kind::block) {
    report_.error(value->at, texts::kNoValue, {value->type->name});
    return;
  }
  if (known == held_.end()) {
    ir::Place p;
    p.type = value->type;
    p.cell = allocate(*p.type);
    held_[s.number] = std::move(p);
  }
  assign(held_[s.number].copy(), std::move(value), s.location, out);
}

// A function in a drawing: a pin that is none of its VAR_OUTPUT carries its result.
bool Analyzer::drawn_call(const syntax::Statement& s, ir::Block& out) {
  const auto drawn = [](const syntax::Argument& a) { return a.drawn; };
  if (s.kind != StatementKind::hold || s.value->kind != ExpressionKind::call ||
      std::none_of(s.value->arguments.begin(), s.value->arguments.end(), drawn))
    return false;
  const int unit = function_named(*s.value->operands[0]);
  if (unit >= 0) lay_out(unit);
  syntax::Statement plain;
  plain.kind = StatementKind::call;
  plain.location = s.location;
  plain.value = syntax::copy(*s.value);
  std::vector<std::uint64_t> results;
  std::erase_if(plain.value->arguments, [&](syntax::Argument& a) {
    if (!a.drawn) return false;
    a.drawn = false;
    const std::uint64_t number = a.value->literal.magnitude;
    const Variable* v = unit < 0 ? nullptr : match(a, 0, unit);
    if (v == nullptr && (unit < 0 || result_pin(unit, a.name))) {
      results.push_back(number);
      return true;
    }
    if (v != nullptr) {  // what it has not: the arguments are checked below
      ir::Place p;
      p.type = v->type;
      p.cell = allocate(*p.type);
      held_[number] = std::move(p);
    }
    return false;
  });
  if (!results.empty()) {
    plain.kind = StatementKind::hold;
    plain.number = results.front();
  }
  statement(plain, out);
  if (!results.empty())
    if (const auto result = held_.find(results.front()); result != held_.end())
      for (const std::uint64_t other : results) held_[other] = result->second.copy();
  return true;
}

// The pin of the result is called like the function, OUT, or not at all; where nothing else comes out,
// anyhow.
bool Analyzer::result_pin(int unit, const std::string& name) const {
  const UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  if (u.result_variable < 0) return false;
  return name.empty() || same_name(name, "OUT") || same_name(name, u.source->name) ||
         std::none_of(u.variables.begin(), u.variables.end(),
                      [](const Variable& v) { return v.section == Section::output; });
}

// S and R of IL, (S) and (R) of a ladder. The same letters are inputs of bistables and counters.
void Analyzer::set_statement(const syntax::Statement& s, ir::Block& out) {
  auto target = place(*s.target, false);
  if (!target) return;
  if (target->type->kind == Kind::block && s.alternative) return statement(*s.alternative, out);
  target = place(*s.target, true);
  if (!target) return;
  ir::Stmt test = make(StmtKind::if_, s.location);
  ir::Branch b;
  b.condition = condition(*s.value);
  Constant c;
  c.i = s.kind == StatementKind::set;
  assign(std::move(*target), make_constant(elementary(Kind::boolean), c, s.location), s.location, b.body);
  test.branches.push_back(std::move(b));
  out.push_back(std::move(test));
}

void Analyzer::collect_labels(const syntax::Block& b) {
  for (const syntax::StatementPtr& s : b)
    if (s->kind == StatementKind::label)
      if (!labels_.emplace(key_of(s->name), static_cast<std::int32_t>(labels_.size())).second)
        report_.error(s->location, texts::kLabelTwice, {s->name});
}

std::int32_t Analyzer::label(const syntax::Statement& s) {
  const auto at = labels_.find(key_of(s.name));
  if (at != labels_.end()) return at->second;
  std::vector<std::string> names;
  for (const syntax::StatementPtr& other : here().source->body)
    if (other->kind == StatementKind::label) names.push_back(other->name);
  report_.error(s.location, texts::kNoLabel, {s.name, syntax::suggestion(s.name, names)});
  return -1;
}

ExprPtr Analyzer::condition(const Expression& e) {
  ExprPtr c = expression(e, elementary(Kind::boolean));
  if (c->type->kind == Kind::error) return c;
  return assignable(std::move(c), elementary(Kind::boolean));
}

void Analyzer::if_statement(const syntax::Statement& s, ir::Block& out) {
  ir::Stmt stmt = make(StmtKind::if_, s.location);
  for (const syntax::Branch& b : s.branches) {
    ir::Branch branch;
    branch.condition = condition(*b.condition);
    branch.body = block(b.body);
    stmt.branches.push_back(std::move(branch));
  }
  stmt.body = block(s.body);
  out.push_back(std::move(stmt));
}

void Analyzer::case_statement(const syntax::Statement& s, ir::Block& out) {
  ir::Stmt stmt = make(StmtKind::case_, s.location);
  stmt.value = settle(expression(*s.target), nullptr);
  const Type* type = stmt.value->type;
  const bool good = is_elementary(type->kind) && type->kind != Kind::error;
  if (!good && type->kind != Kind::error) report_.error(s.target->location, texts::kCaseType, {type->name});
  const bool cells = cell_of(*type) < Cell::f32;
  std::vector<Chosen> seen;
  ir::Place held;
  if (good && !cells) {  // compared in turn with what is held
    stmt.kind = StmtKind::if_;
    held.type = is_text(type->kind) ? types_->string(kMaxStringCapacity, type->kind) : type;
    held.cell = allocate(*held.type);
    assign(held.copy(), std::move(stmt.value), s.location, out);
    type = held.type;
  }
  for (const syntax::Branch& b : s.branches) {
    ir::Branch branch;
    for (const syntax::Label& l : b.labels) {
      const std::size_t before = seen.size();
      if (good) case_label(l, *type, seen);
      if (seen.size() == before) continue;
      const Chosen& chosen = seen.back();
      if (cells) {
        branch.ranges.push_back({chosen.low.i, chosen.high.i});
        continue;
      }
      const auto compared = [&](Op op, const Constant& c) {
        return combine(op, load(held.copy(), l.low->location), make_constant(type, c, l.low->location),
                       l.low->location, "=");
      };
      ExprPtr test = l.high ? combine(Op::and_, compared(Op::ge, chosen.low), compared(Op::le, chosen.high),
                                      l.low->location, "AND")
                            : compared(Op::eq, chosen.low);
      branch.condition = branch.condition ? combine(Op::or_, std::move(branch.condition), std::move(test),
                                                    l.low->location, "OR")
                                          : std::move(test);
    }
    branch.body = block(b.body);
    if (!cells && !branch.condition)
      branch.condition = make_constant(elementary(Kind::boolean), {}, s.location);
    stmt.branches.push_back(std::move(branch));
  }
  if (good) warn_chosen_twice(seen, *type);
  stmt.body = block(s.body);
  if (good) out.push_back(std::move(stmt));
}

namespace {
bool before(const Type& type, const Constant& a, const Constant& b) {
  const Cell cell = cell_of(type);
  return is_text(type.kind)  ? a.s < b.s || a.w < b.w
         : cell >= Cell::f32 ? a.r < b.r
         : cell == Cell::u64 ? static_cast<std::uint64_t>(a.i) < static_cast<std::uint64_t>(b.i)
                             : a.i < b.i;
}
}  // namespace

// One label or range of a CASE; of several that hold a value the first counts.
void Analyzer::case_label(const syntax::Label& l, const Type& type, std::vector<Chosen>& seen) {
  const auto low = constant(*l.low, &type), high = l.high ? constant(*l.high, &type) : low;
  if (!low || !high) return;
  if (before(type, *high, *low)) {
    report_.error(l.low->location, texts::kEmptyRange,
                  {constant_text(type, *low), constant_text(type, *high)});
    return;
  }
  seen.push_back({*low, *high, l.low->location});
}

namespace {
/// Which of several labels was the first to hold a value: a tree over the values that labels begin or end
/// with, in which a range is taken, and asked for, in as many steps as its number has digits.
class FirstTaken {
 public:
  static constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
  explicit FirstTaken(std::size_t values)
      : first_(4 * std::max<std::size_t>(values, 1), kNobody), whole_(first_) {}

  /// The first label that holds one of the values low to high; from now on `label` does, where nobody did.
  std::size_t take(std::size_t low, std::size_t high, std::size_t label) {
    return take(1, 0, first_.size() / 4 - 1, low, high, label);
  }

 private:
  std::size_t take(std::size_t node, std::size_t begin, std::size_t end, std::size_t low, std::size_t high,
                   std::size_t label) {
    if (high < begin || end < low) return kNobody;
    const std::size_t above = whole_[node];
    std::size_t found = kNobody;
    if (low <= begin && end <= high) {
      found = first_[node];
      whole_[node] = std::min(whole_[node], label);
    } else {
      const std::size_t middle = begin + (end - begin) / 2;
      found = std::min(take(2 * node, begin, middle, low, high, label),
                       take(2 * node + 1, middle + 1, end, low, high, label));
    }
    first_[node] = std::min(first_[node], label);
    return std::min(found, above);
  }

  std::vector<std::size_t> first_;  ///< by node: of any value below it
  std::vector<std::size_t> whole_;  ///< of every value below it
};
}  // namespace

// A value that an earlier label has is never chosen here.
void Analyzer::warn_chosen_twice(const std::vector<Chosen>& seen, const Type& type) {
  const auto less = [&type](const Constant& a, const Constant& b) { return before(type, a, b); };
  std::vector<const Constant*> values;
  for (const Chosen& x : seen) values.insert(values.end(), {&x.low, &x.high});
  std::sort(values.begin(), values.end(), [&](const auto* a, const auto* b) { return less(*a, *b); });
  values.erase(
      std::unique(values.begin(), values.end(), [&](const auto* a, const auto* b) { return !less(*a, *b); }),
      values.end());
  const auto index = [&](const Constant& c) {
    return static_cast<std::size_t>(
        std::lower_bound(values.begin(), values.end(), &c,
                         [&](const auto* a, const auto* b) { return less(*a, *b); }) -
        values.begin());
  };
  FirstTaken taken(values.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Chosen& now = seen[i];
    const std::size_t other = taken.take(index(now.low), index(now.high), i);
    if (other == FirstTaken::kNobody) continue;
    const Chosen& x = seen[other];
    report_.warning(now.at, texts::kCaseTwice,
                    {constant_text(type, less(now.low, x.low) ? x.low : now.low), std::to_string(x.at.line)});
  }
}

void Analyzer::for_statement(const syntax::Statement& s, ir::Block& out) {
  ir::Stmt stmt = make(StmtKind::for_, s.location);
  auto control = place(*s.target, true);
  bool global = false;
  const Variable* v = find_variable(s.target->name, global);
  bool good = control.has_value();
  if (control && !is_integer(control->type->kind)) {
    report_.error(s.target->location, texts::kForType, {control->type->name});
    good = false;
  }
  const Type* type = !good ? nullptr : control->type->bounded ? control->type->base : control->type;
  const auto limit = [&](const Expression& e) {
    ExprPtr x = assignable(expression(e, type), type);
    if (x->type->kind == Kind::error) return x;
    x = explicit_conversion(std::move(x), elementary(Kind::lint), false, e.location);
    if (cell_of(*type) != Cell::u64) return x;
    // Moved down by 2^63: as a signed number in the right order. The machine moves it back.
    Constant half;
    half.i = std::numeric_limits<std::int64_t>::min();
    ExprPtr moved = node(ExprKind::binary, elementary(Kind::lint), e.location);
    moved->op = Op::add;
    moved->args.push_back(std::move(x));
    moved->args.push_back(make_constant(elementary(Kind::lint), half, e.location));
    return fold(std::move(moved));
  };
  if (!good) {  // reported; its limits have no type to be compared with
    for (const Expression* e : {s.value.get(), s.to.get(), s.by.get()})
      if (e != nullptr) expression(*e);
    ++loops_;
    block(s.body);
    --loops_;
    return;
  }
  stmt.value = limit(*s.value);
  stmt.to = limit(*s.to);
  Constant one;
  one.i = 1;
  // A step may be negative although the variable is unsigned.
  stmt.by = s.by ? assignable(settle(expression(*s.by, elementary(Kind::lint)), elementary(Kind::lint)),
                              elementary(Kind::lint))
                 : make_constant(elementary(Kind::lint), one, s.location);
  if (stmt.by->kind == ExprKind::constant && stmt.by->type->kind != Kind::error && stmt.by->value.i == 0)
    report_.error(s.by->location, texts::kForZero);
  if (v != nullptr) for_variables_.push_back(v);
  ++loops_;
  stmt.body = block(s.body);
  --loops_;
  if (v != nullptr) for_variables_.pop_back();
  stmt.check_range = control->type->bounded;
  stmt.place = std::move(*control);
  out.push_back(std::move(stmt));
}

void Analyzer::loop_statement(const syntax::Statement& s, ir::Block& out) {
  ir::Stmt stmt = make(s.kind == StatementKind::while_ ? StmtKind::while_ : StmtKind::repeat, s.location);
  stmt.value = condition(*s.value);
  ++loops_;
  stmt.body = block(s.body);
  --loops_;
  out.push_back(std::move(stmt));
}

}  // namespace servogate::plc::sema
