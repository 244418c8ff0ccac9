// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "plc/sema/analyzer.hpp"
#include "plc/syntax/time_literal.hpp"
#include "plc/terms/texts.hpp"
#include "plc/types/characters.hpp"

namespace servogate::plc::sema {

using ir::ExprKind;
using syntax::ExpressionKind;
using syntax::Operator;

ExprPtr Analyzer::node(ExprKind kind, const Type* type, const Location& at) {
  auto e = std::make_unique<Expr>();
  e->kind = kind;
  e->type = type;
  e->at = at;
  return e;
}

ExprPtr Analyzer::bad(const Location& at) { return node(ExprKind::constant, elementary(Kind::error), at); }

ExprPtr Analyzer::load(ir::Place p, const Location& at) {
  ExprPtr e = node(ExprKind::load, p.type->bounded ? p.type->base : p.type, at);
  e->place = std::move(p);
  return e;
}

ExprPtr Analyzer::native(Native n, const Type* type, const Location& at, std::vector<ExprPtr> args) {
  for (const ExprPtr& a : args)
    if (a->type->kind == Kind::error) return bad(at);
  ExprPtr e = node(ExprKind::native, type, at);
  e->native = n;
  e->args = std::move(args);
  return fold_function(std::move(e));
}

ExprPtr Analyzer::expression(const Expression& e, const Type* hint) {
  report_.go_on();
  switch (e.kind) {
    case ExpressionKind::literal:
      return literal(e, hint);
    case ExpressionKind::typed:
      return typed_literal(e);
    case ExpressionKind::held:
    case ExpressionKind::name:
    case ExpressionKind::member:
    case ExpressionKind::index:
    case ExpressionKind::bit:
    case ExpressionKind::dereference:
    case ExpressionKind::direct:
      return name_expression(e, hint);
    case ExpressionKind::call:
      return call(e, hint, false);
    case ExpressionKind::unary:
      return unary(e, hint);
    case ExpressionKind::binary:
      return binary(e, hint);
    default:
      if (e.kind != ExpressionKind::bad)
        report_.error(e.location, texts::kExpected,
                      {text::both("a value", "значение"), text::both("a list", "список")});
      return bad(e.location);
  }
}

namespace {
std::size_t length_of(const Constant& text) { return text.s.size() + text.w.size(); }
}  // namespace

ExprPtr Analyzer::literal(const Expression& e, const Type*) {
  const syntax::Literal& l = e.literal;
  Constant c;
  c.s = l.text;
  c.w = l.wide;
  c.r = l.real;
  c.i = static_cast<std::int64_t>(l.negative ? 0 - l.magnitude : l.magnitude);
  const Type* type = elementary(l.kind);
  if (is_text(l.kind)) {
    const std::size_t n = length_of(c);
    type =
        types_->string(static_cast<std::uint32_t>(std::clamp<std::size_t>(n, 1, kMaxStringCapacity)), l.kind);
    if (n > kMaxStringCapacity)
      report_.error(e.location, texts::kStringLength, {std::to_string(n), elementary(l.kind)->name});
  }
  constexpr std::uint64_t kHalf = std::uint64_t{1} << 63;
  if (l.kind == Kind::untyped_int && l.magnitude > kHalf - (l.negative ? 0 : 1)) {
    if (l.negative) {
      report_.error(e.location, texts::kHugeNumber, {"-" + std::to_string(l.magnitude)});
      return bad(e.location);
    }
    type = elementary(Kind::ulint);
  }
  return make_constant(type, c, e.location);
}

ExprPtr Analyzer::typed_literal(const Expression& e) {
  const Type* type = types_->find(e.name);
  if (type == nullptr)
    if (const auto at = declared_types_.find(key_of(e.name)); at != declared_types_.end())
      type = resolve_declared(at->second);
  if (type == nullptr) {
    report_.error(e.location, texts::kUnknownType, {e.name, ""});
    return bad(e.location);
  }
  if (const bool value = e.operands.empty();
      !type->values.empty() && (value || type->kind == Kind::enumeration)) {
    const EnumValue* v = type->value_named(e.literal.text);
    if (v != nullptr) return make_constant(type, named_constant(*type, *v), e.location);
    std::vector<std::string> names;
    for (const EnumValue& n : type->values) names.push_back(n.name);
    report_.error(e.location, texts::kNotEnumValue,
                  {type->name, e.literal.text, syntax::suggestion(e.literal.text, names)});
    return bad(e.location);
  }
  if (e.operands.empty() || !is_elementary(type->kind)) {
    report_.error(e.location, texts::kMismatch, {type->name, "'" + e.literal.text + "'", ""});
    return bad(e.location);
  }
  ExprPtr value = literal(*e.operands[0], type);
  if (type->kind == Kind::boolean && value->type->kind == Kind::untyped_int && (value->value.i & ~1) != 0) {
    report_.error(e.location, texts::kLiteralRange, {std::to_string(value->value.i), "BOOL", "0", "1"});
    return bad(e.location);
  }
  if (is_character(type->kind) && value->type->kind == Kind::untyped_int) {  // CHAR#16#41
    const std::int64_t most = is_wide(type->kind) ? 65535 : 255;
    if (value->value.i >= 0 && value->value.i <= most) return make_constant(type, value->value, e.location);
    report_.error(e.location, texts::kLiteralRange,
                  {std::to_string(value->value.i), type->name, "0", std::to_string(most)});
    return bad(e.location);
  }
  if (is_text(type->kind) && type == elementary(type->kind) && value->type->kind == type->kind) return value;
  return assignable(std::move(value), type);
}

ExprPtr Analyzer::name_expression(const Expression& e, const Type* hint) {
  if (e.kind == ExpressionKind::name) {
    bool global = false;
    Variable* v = find_variable(e.name, global);
    if (v != nullptr && v->value) {
      v->used = true;
      return make_constant(v->type->bounded ? v->type->base : v->type, *v->value, e.location);
    }
    if (v == nullptr && symbol(e.name) == nullptr)
      if (ExprPtr value = enumeration_value(e.name, e.location, hint)) return value;
    if (v == nullptr && symbol(e.name) == nullptr && same_name(e.name, "NULL"))
      return make_constant(types_->reference(nullptr), {}, e.location);
  }
  if (e.kind == ExpressionKind::member && leads_global(*e.operands[0])) {
    Expression plain;
    plain.kind = ExpressionKind::name;
    plain.location = e.location;
    plain.name = e.name;
    return name_expression(plain, hint);
  }
  if (e.kind == ExpressionKind::member && e.operands[0]->kind == ExpressionKind::name) {  // Colour.red
    bool global = false;
    const auto at = declared_types_.find(key_of(e.operands[0]->name));
    if (at != declared_types_.end() && find_variable(e.operands[0]->name, global) == nullptr) {
      const Type* t = resolve_declared(at->second);
      if (!t->values.empty()) {
        Expression typed;
        typed.kind = ExpressionKind::typed;
        typed.location = e.location;
        typed.name = t->name;
        typed.literal.text = e.name;
        return typed_literal(typed);
      }
    }
  }
  auto p = place(e, false);
  if (!p) return bad(e.location);
  return load(std::move(*p), e.location);
}

ExprPtr Analyzer::unary(const Expression& e, const Type* hint) {
  return unary(e.op, expression(*e.operands[0], hint), e, hint);
}

ExprPtr Analyzer::unary(Operator op, ExprPtr a, const Expression& e, const Type* hint) {
  if (a->type->kind == Kind::error) return a;
  const Kind k = a->type->kind;
  if (op == Operator::not_) {
    if (k == Kind::untyped_int && hint != nullptr && (is_bits(hint->kind) || hint->kind == Kind::boolean))
      a = convert(std::move(a), hint);
    const Kind now = a->type->kind;
    if (now != Kind::boolean && !is_bits(now) && !is_integer(now)) {
      report_.error(e.location, texts::kOperand, {"NOT", a->type->name});
      return bad(e.location);
    }
  } else if (!(is_signed(k) || is_real(k) || is_untyped(k) || k == Kind::time ||
               (op == Operator::plus && is_unsigned(k)))) {
    report_.error(e.location, texts::kOperand, {op == Operator::plus ? "+" : "-", a->type->name});
    return bad(e.location);
  }
  if (op == Operator::plus) return a;
  ExprPtr out = node(ExprKind::unary, a->type, e.location);
  out->op = op == Operator::not_ ? Op::not_ : Op::neg;
  out->args.push_back(std::move(a));
  return fold(std::move(out));
}

namespace {
struct Shown {
  Op op;
  std::string_view text;
};
Shown op_of(Operator op) {
  switch (op) {
    case Operator::add:
      return {Op::add, "+"};
    case Operator::sub:
      return {Op::sub, "-"};
    case Operator::mul:
      return {Op::mul, "*"};
    case Operator::div:
      return {Op::div, "/"};
    case Operator::mod:
      return {Op::mod, "MOD"};
    case Operator::lt:
      return {Op::lt, "<"};
    case Operator::gt:
      return {Op::gt, ">"};
    case Operator::le:
      return {Op::le, "<="};
    case Operator::ge:
      return {Op::ge, ">="};
    case Operator::eq:
      return {Op::eq, "="};
    case Operator::ne:
      return {Op::ne, "<>"};
    case Operator::and_:
      return {Op::and_, "AND"};
    case Operator::xor_:
      return {Op::xor_, "XOR"};
    default:
      return {Op::or_, "OR"};
  }
}
bool logical(Op op) { return op == Op::and_ || op == Op::or_ || op == Op::xor_; }
bool comparing(Op op) { return op >= Op::eq && op <= Op::ge; }
}  // namespace

ExprPtr Analyzer::binary(const Expression& e, const Type* hint) {
  const Shown shown = op_of(e.op);
  const Type* inner = comparing(shown.op) ? nullptr : hint;
  ExprPtr a = expression(*e.operands[0], inner);
  ExprPtr b = expression(*e.operands[1], a->type->values.empty() ? inner : a->type);
  if (!b->type->values.empty() && !a->type->values.empty() && a->type != b->type)
    a = expression(*e.operands[0], b->type);
  if (e.op == Operator::power) return power(std::move(a), std::move(b), e.location);
  return combine(shown.op, std::move(a), std::move(b), e.location, shown.text);
}

ExprPtr Analyzer::combine(Op op, ExprPtr a, ExprPtr b, const Location& at, std::string_view shown) {
  if (a->type->kind == Kind::error) return a;
  if (b->type->kind == Kind::error) return b;
  const auto refuse = [&] {
    report_.error(at, texts::kOperands, {std::string(shown), a->type->name, b->type->name});
    return bad(at);
  };
  const Kind x = a->type->kind, y = b->type->kind;
  if (is_temporal(x) || is_temporal(y)) {
    ExprPtr out = combine_times(op, a, b, at);
    return out ? std::move(out) : refuse();
  }
  const Type* common = nullptr;
  const bool references = x == Kind::reference && y == Kind::reference && (op == Op::eq || op == Op::ne);
  if (x == Kind::enumeration || y == Kind::enumeration) {
    if (a->type != b->type || !comparing(op)) return refuse();
    common = a->type;
  } else {
    const bool alike = is_wide(x) == is_wide(y);
    if (is_text(x) && is_character(y) && alike) b = convert(std::move(b), a->type);
    if (is_character(x) && is_text(y) && alike) {
      if (b->kind == ExprKind::constant && length_of(b->value) == 1)
        b = convert(std::move(b), a->type);
      else
        a = convert(std::move(a), b->type);
    }
    common = types_->common(*a->type, *b->type);
    // An untyped number too large for the other side widens the operation.
    for (int side = 0; common != nullptr && side < 2; ++side) {
      const Expr& c = side == 0 ? *a : *b;
      if (c.type->kind != Kind::untyped_int || c.kind != ExprKind::constant || !is_integer(common->kind))
        continue;
      static constexpr Kind wider[] = {Kind::sint, Kind::int_, Kind::dint, Kind::lint};
      std::int64_t low = 0;
      std::uint64_t high = 0;
      integer_limits(common->kind, low, high);
      const auto fits = [&](std::int64_t v) {
        return v >= low && (v < 0 || static_cast<std::uint64_t>(v) <= high);
      };
      for (std::size_t i = 0; i < std::size(wider) && !fits(c.value.i); ++i) {
        const Type* t = elementary(wider[i]);
        if (conversion(*common, *t) != Conversion::widening) continue;
        common = t;
        integer_limits(common->kind, low, high);
      }
    }
  }
  if (common == nullptr || common->kind == Kind::none || !(references || is_elementary(common->kind)))
    return refuse();
  const Kind k = common->kind;
  if (logical(op)     ? !(k == Kind::boolean || is_bits(k) || is_integer(k) || k == Kind::untyped_int)
      : comparing(op) ? false
                      : (!is_number(k) && !is_bits(k)))
    return refuse();
  if (!logical(op) && !comparing(op) &&
      is_bits(k)) {  // a byte of a packet counts as a number beside a number
    if (!is_integer(x) && !is_integer(y)) return refuse();
    const Kind same[] = {Kind::usint, Kind::uint, Kind::udint, Kind::ulint};
    common = elementary(same[static_cast<int>(k) - static_cast<int>(Kind::byte)]);
  }
  if (op == Op::mod && (is_real(k) || k == Kind::untyped_real)) return refuse();
  if (op == Op::div && is_integer(k) && b->kind == ExprKind::constant && b->value.i == 0)
    report_.warning(at, texts::kDividesByZero);
  ExprPtr out = node(ExprKind::binary, comparing(op) ? elementary(Kind::boolean) : common, at);
  out->op = op;
  out->args.push_back(convert(std::move(a), common));
  out->args.push_back(convert(std::move(b), common));
  if (out->args[0]->type->kind == Kind::error || out->args[1]->type->kind == Kind::error) return bad(at);
  return fold(std::move(out));
}

// IEC 61131-3:2013, table 35: arithmetic of times. Null: no such combination.
ExprPtr Analyzer::combine_times(Op op, ExprPtr& a, ExprPtr& b, const Location& at) {
  const Kind x = a->type->kind, y = b->type->kind;
  const Type* result = nullptr;
  if (comparing(op)) {
    if (x != y) return nullptr;
    result = elementary(Kind::boolean);
  } else if (op == Op::add && (y == Kind::time || x == Kind::time)) {
    if (x == Kind::time && y == Kind::time) result = a->type;
    if (y == Kind::time && (x == Kind::tod || x == Kind::dt)) result = a->type;
  } else if (op == Op::sub) {
    if (x == y) result = elementary(Kind::time);
    if (y == Kind::time && (x == Kind::time || x == Kind::tod || x == Kind::dt)) result = a->type;
  } else if (op == Op::min || op == Op::max) {
    if (x == y) result = a->type;
  } else if ((op == Op::mul || op == Op::div) && x == Kind::time && is_number(y)) {
    const Type* as = elementary(is_integer(y) || y == Kind::untyped_int ? Kind::lint : Kind::lreal);
    const Type* time = a->type;
    ExprPtr out = node(ExprKind::binary, as, at);
    out->op = op;
    out->args.push_back(as->kind == Kind::lreal ? explicit_conversion(std::move(a), as, false, at)
                                                : std::move(a));
    if (out->args[0]->type->kind == Kind::time && as->kind == Kind::lint) out->type = time;
    out->args.push_back(explicit_conversion(std::move(b), as, false, at));
    if (as->kind == Kind::lint) return fold(std::move(out));
    return explicit_conversion(fold(std::move(out)), time, false, at);
  }
  if (result == nullptr) return nullptr;
  ExprPtr out = node(ExprKind::binary, result, at);
  out->op = op;
  out->args.push_back(std::move(a));
  out->args.push_back(std::move(b));
  out = fold(std::move(out));
  if (result->kind != Kind::tod || comparing(op)) return out;
  std::vector<ExprPtr> args;
  args.push_back(std::move(out));
  return native(Native::clock_part, result, at, std::move(args));  // the clock goes round
}

ExprPtr Analyzer::power(ExprPtr a, ExprPtr b, const Location& at) {
  if (a->type->kind == Kind::error) return a;
  if (b->type->kind == Kind::error) return b;
  if (!is_number(a->type->kind) || !is_number(b->type->kind)) {
    report_.error(at, texts::kOperands, {"**", a->type->name, b->type->name});
    return bad(at);
  }
  const bool untyped = is_untyped(a->type->kind) && is_untyped(b->type->kind);
  const Type* result = a->type->kind == Kind::real ? a->type : elementary(Kind::lreal);
  if (is_integer(a->type->kind) && conversion(*a->type, *elementary(Kind::real)) == Conversion::widening)
    result = elementary(Kind::real);
  if (untyped && a->kind == ExprKind::constant && b->kind == ExprKind::constant) {
    const auto value = [](const Expr& e) {
      return e.type->kind == Kind::untyped_int ? static_cast<double>(e.value.i) : e.value.r;
    };
    Constant c;
    c.r = std::pow(value(*a), value(*b));
    ExprPtr out = make_constant(elementary(Kind::untyped_real), c, at);
    out->native = Native::power;  // for the message: no literal was written
    return out;
  }
  std::vector<ExprPtr> args;
  args.push_back(explicit_conversion(std::move(a), result, false, at));
  args.push_back(explicit_conversion(std::move(b), result, false, at));
  return native(Native::power, result, at, std::move(args));
}

ExprPtr Analyzer::settle(ExprPtr e, const Type* hint) {
  if (!is_untyped(e->type->kind)) return e;
  if (e->type->kind == Kind::untyped_real)
    return convert(std::move(e), hint != nullptr && is_real(hint->kind) ? hint : elementary(Kind::lreal));
  if (hint != nullptr && is_number(hint->kind) && !is_untyped(hint->kind)) return convert(std::move(e), hint);
  const std::int64_t v = e->value.i;
  const bool small = e->kind == ExprKind::constant && v >= std::numeric_limits<std::int32_t>::min() &&
                     v <= std::numeric_limits<std::int32_t>::max();
  return convert(std::move(e), elementary(small ? Kind::dint : Kind::lint));
}

// Without any message but that a literal does not fit.
ExprPtr Analyzer::convert(ExprPtr e, const Type* to) {
  const Type* base = to->bounded ? to->base : to;
  if (e->type == to || e->type == base || e->type->kind == Kind::error) return e;
  if (e->kind != ExprKind::constant) {
    if (e->type->kind == base->kind && !is_text(base->kind)) return e;
    ExprPtr out = node(ExprKind::convert, base, e->at);
    out->args.push_back(std::move(e));
    return out;
  }
  const Kind from = e->type->kind;
  Constant c = e->value;
  if (base->kind == Kind::string && from == Kind::character) c.s.assign(1, static_cast<char>(c.i));
  if (base->kind == Kind::wide_string && from == Kind::wide_character)
    c.w.assign(1, static_cast<char16_t>(c.i));
  if (base->kind == Kind::character && from == Kind::string)
    c.i = c.s.empty() ? 0 : static_cast<unsigned char>(c.s[0]);
  if (base->kind == Kind::wide_character && from == Kind::wide_string) c.i = c.w.empty() ? 0 : c.w[0];
  const bool from_real = is_real(from) || from == Kind::untyped_real;
  const bool to_real = is_real(base->kind) || base->kind == Kind::untyped_real;
  if (to_real && !from_real)
    c.r = cell_of(*e->type) == Cell::u64 ? static_cast<double>(static_cast<std::uint64_t>(c.i))
                                         : static_cast<double>(c.i);
  if (base->kind == Kind::real) {
    if (std::abs(c.r) > static_cast<double>(std::numeric_limits<float>::max())) {
      report_.error(e->at, texts::kLiteralRange, {text::number(c.r), "REAL", "-3.4e38", "3.4e38"});
      return bad(e->at);
    }
    c.r = static_cast<double>(static_cast<float>(c.r));
  }
  if ((is_integer(base->kind) || is_bits(base->kind) || base->kind == Kind::boolean) && !from_real) {
    std::int64_t low = 0;
    std::uint64_t high = 0;
    integer_limits(base->kind, low, high);
    const bool huge = cell_of(*e->type) == Cell::u64 && c.i < 0;
    const bool fits = huge ? high == std::numeric_limits<std::uint64_t>::max()
                           : c.i >= low && (c.i < 0 || static_cast<std::uint64_t>(c.i) <= high);
    if (!fits) {
      report_.error(e->at, texts::kLiteralRange,
                    {constant_text(*e->type, c), base->name, std::to_string(low), std::to_string(high)});
      return bad(e->at);
    }
  }
  return make_constant(base, std::move(c), e->at);
}

namespace {
// As conversion functions call it: STRING[3] is STRING, a subrange its base.
std::string plain_name(const Type& t) {
  return t.bounded || (!t.values.empty() && t.kind != Kind::enumeration) ? t.base->name
         : t.kind == Kind::string                                        ? "STRING"
         : t.kind == Kind::wide_string                                   ? "WSTRING"
                                                                         : t.name;
}
}  // namespace

ExprPtr Analyzer::assignable(ExprPtr e, const Type* to) {
  const Type& from = *e->type;
  if (from.kind == Kind::error || to->kind == Kind::error) return e;
  if (from.kind == Kind::none) {
    report_.error(
        e->at, texts::kNoValue,
        {e->kind == ExprKind::call ? program_.units[static_cast<std::size_t>(e->unit)].name : "()"});
    return bad(e->at);
  }
  if (to->holds_instance) {
    report_.error(e->at, to->kind == Kind::block ? texts::kInstanceCopy : texts::kInstancesCopy, {to->name});
    return bad(e->at);
  }
  if (from.open || to->open) {
    report_.error(e->at, texts::kOpenArrayWhole, {from.open ? from.name : to->name});
    return bad(e->at);
  }
  if (is_character(to->kind) && is_text(from.kind) && is_wide(to->kind) == is_wide(from.kind) &&
      e->kind == ExprKind::constant && length_of(e->value) == 1)
    return convert(std::move(e), to);
  const bool bool_literal = to->kind == Kind::boolean && from.kind == Kind::untyped_int;
  const Conversion c =
      is_text(from.kind) && from.kind == to->kind ? Conversion::widening : conversion(from, *to);
  const bool alias = from.kind == to->kind && is_elementary(from.kind) && from.kind != Kind::enumeration;
  if (!alias && (c == Conversion::none || (bool_literal && e->kind != ExprKind::constant))) {
    if (e->native == Native::power && from.kind == Kind::untyped_real && is_integer(to->kind)) {
      report_.error(e->at, texts::kPowerReal, {plain_name(*to)});
      return bad(e->at);
    }
    std::string how;
    if (is_elementary(from.kind) && is_elementary(to->kind) && !is_untyped(from.kind) &&
        from.kind != Kind::enumeration && to->kind != Kind::enumeration)
      how = plain_name(from) + "_TO_" + plain_name(*to);
    report_.error(e->at, how.empty() ? texts::kMismatch : texts::kMismatchWrite, {to->name, from.name, how});
    return bad(e->at);
  }
  if (c == Conversion::narrowing && e->kind != ExprKind::constant)
    report_.warning(e->at, texts::kNarrowing,
                    {from.name, to->name, plain_name(from) + "_TO_" + plain_name(*to)});
  if (is_text(from.kind) && e->kind == ExprKind::constant && length_of(e->value) > to->capacity())
    report_.warning(e->at, texts::kNarrowing, {constant_text(from, e->value), to->name, "LEFT"});
  ExprPtr out = convert(std::move(e), to);
  if (to->bounded && out->kind == ExprKind::constant && out->type->kind != Kind::error &&
      (out->value.i < to->limits.low || out->value.i > to->limits.high)) {
    report_.error(out->at, texts::kLiteralRange,
                  {std::to_string(out->value.i), to->name, std::to_string(to->limits.low),
                   std::to_string(to->limits.high)});
    return bad(out->at);
  }
  return out;
}

}  // namespace servogate::plc::sema
