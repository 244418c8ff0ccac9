// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "plc/sema/analyzer.hpp"
#include "plc/syntax/time_literal.hpp"
#include "plc/terms/texts.hpp"
#include "plc/types/characters.hpp"

namespace servogate::plc::sema {

namespace {

std::int64_t wrapped(Cell cell, std::int64_t v) {
  switch (cell) {
    case Cell::i8:
      return static_cast<std::int8_t>(v);
    case Cell::i16:
      return static_cast<std::int16_t>(v);
    case Cell::i32:
      return static_cast<std::int32_t>(v);
    case Cell::u8:
      return static_cast<std::uint8_t>(v);
    case Cell::u16:
      return static_cast<std::uint16_t>(v);
    case Cell::u32:
      return static_cast<std::uint32_t>(v);
    default:
      return v;
  }
}

bool real_cell(Cell c) { return c == Cell::f32 || c == Cell::f64; }
double rounded(Cell c, double v) { return c == Cell::f32 ? static_cast<double>(static_cast<float>(v)) : v; }

template <typename T>
bool compare(Op op, T a, T b) {
  switch (op) {
    case Op::eq:
      return a == b;
    case Op::ne:
      return a != b;
    case Op::lt:
      return a < b;
    case Op::le:
      return a <= b;
    case Op::gt:
      return a > b;
    default:
      return a >= b;
  }
}
bool comparison(Op op) { return op >= Op::eq && op <= Op::ge; }

std::optional<double> real_result(Op op, double a, double b) {
  switch (op) {
    case Op::add:
      return a + b;
    case Op::sub:
      return a - b;
    case Op::mul:
      return a * b;
    case Op::div:
      return b == 0 ? std::nullopt : std::optional(a / b);
    case Op::min:
      return b < a ? b : a;
    case Op::max:
      return b > a ? b : a;
    default:
      return std::nullopt;
  }
}

std::optional<std::int64_t> divide(bool quotient, bool is_unsigned_64, std::int64_t a, std::int64_t b) {
  if (b == 0) return quotient ? std::nullopt : std::optional<std::int64_t>(0);
  if (is_unsigned_64) {
    const auto x = static_cast<std::uint64_t>(a), y = static_cast<std::uint64_t>(b);
    return static_cast<std::int64_t>(quotient ? x / y : x % y);
  }
  if (b == -1) return quotient ? static_cast<std::int64_t>(0 - static_cast<std::uint64_t>(a)) : 0;
  return quotient ? a / b : a % b;
}

std::optional<std::int64_t> integer_result(Op op, Cell cell, std::int64_t a, std::int64_t b) {
  const auto x = static_cast<std::uint64_t>(a), y = static_cast<std::uint64_t>(b);
  const bool u64 = cell == Cell::u64;
  switch (op) {
    case Op::add:
      return static_cast<std::int64_t>(x + y);
    case Op::sub:
      return static_cast<std::int64_t>(x - y);
    case Op::mul:
      return static_cast<std::int64_t>(x * y);
    case Op::div:
      return divide(true, u64, a, b);
    case Op::mod:
      return divide(false, u64, a, b);
    case Op::and_:
      return a & b;
    case Op::or_:
      return a | b;
    case Op::xor_:
      return a ^ b;
    case Op::min:
      return (u64 ? y < x : b < a) ? b : a;
    case Op::max:
      return (u64 ? y > x : b > a) ? b : a;
    default:
      return std::nullopt;
  }
}

}  // namespace

void store_constant(const Type& type, const Constant& c, std::uint8_t* out) {
  switch (cell_of(type)) {
    case Cell::f32: {
      const auto v = static_cast<float>(c.r);
      std::memcpy(out, &v, sizeof v);
      break;
    }
    case Cell::f64:
      std::memcpy(out, &c.r, sizeof c.r);
      break;
    case Cell::text: {
      const std::size_t n = std::min<std::size_t>(c.s.size(), type.capacity());
      out[0] = static_cast<std::uint8_t>(n);
      std::memcpy(out + 1, c.s.data(), n);
      break;
    }
    case Cell::wide_text: {
      const auto n = static_cast<std::uint16_t>(std::min<std::size_t>(c.w.size(), type.capacity()));
      std::memcpy(out, &n, sizeof n);
      std::memcpy(out + sizeof n, c.w.data(), n * sizeof(char16_t));
      break;
    }
    case Cell::blob:
      break;
    default:
      std::memcpy(out, &c.i, cell_size(cell_of(type)));
  }
}

Constant stored_constant(const Type& type, const std::uint8_t* bytes) {
  Constant c;
  const Cell cell = cell_of(type);
  if (cell == Cell::f32) {
    float v = 0;
    std::memcpy(&v, bytes, sizeof v);
    c.r = static_cast<double>(v);
  } else if (cell == Cell::f64) {
    std::memcpy(&c.r, bytes, sizeof c.r);
  } else if (cell == Cell::text) {
    c.s.assign(reinterpret_cast<const char*>(bytes) + 1, bytes[0]);
  } else if (cell == Cell::wide_text) {
    c.w.resize(value_size(type, bytes) / 2 - 1);
    std::memcpy(c.w.data(), bytes + 2, c.w.size() * sizeof(char16_t));
  } else {
    std::memcpy(&c.i, bytes, cell_size(cell));
    c.i = wrapped(cell, c.i);
  }
  return c;
}

Constant named_constant(const Type& type, const EnumValue& value) {
  std::uint8_t bytes[sizeof value.value];
  std::memcpy(bytes, &value.value, sizeof bytes);
  return stored_constant(type, bytes);
}

std::string constant_text(const Type& type, const Constant& c) {
  for (const EnumValue& v : type.values) {
    const Constant named = named_constant(type, v);
    if (named.i == c.i && named.r == c.r) return v.name;
  }
  if (type.kind == Kind::string) return "'" + c.s + "'";
  if (type.kind == Kind::wide_string) return "\"" + narrow(c.w) + "\"";
  if (is_real(type.kind) || type.kind == Kind::untyped_real) return text::number(c.r);
  if (type.kind == Kind::boolean) return c.i != 0 ? "TRUE" : "FALSE";
  if (is_temporal(type.kind)) {
    char buffer[48];
    return {buffer, syntax::print_time(type.kind, c.i, buffer)};
  }
  if (type.kind == Kind::enumeration) return constant_text(*type.base, c);
  return cell_of(type) == Cell::u64 ? std::to_string(static_cast<std::uint64_t>(c.i)) : std::to_string(c.i);
}

ExprPtr Analyzer::make_constant(const Type* type, Constant c, const Location& at) {
  ExprPtr e = node(ir::ExprKind::constant, type, at);
  e->value = std::move(c);
  return e;
}

// Computes an operation whose operands are all constants; everything else comes back as it is.
ExprPtr Analyzer::fold(ExprPtr e) {
  if (e->kind != ir::ExprKind::unary && e->kind != ir::ExprKind::binary) return e;
  for (const ExprPtr& a : e->args)
    if (a->kind != ir::ExprKind::constant || is_text(a->type->kind) || a->type->kind == Kind::error) return e;
  const Type* operand = e->args[0]->type;
  const Cell cell = cell_of(*operand);
  const Constant& a = e->args[0]->value;
  Constant out;
  if (e->kind == ir::ExprKind::unary) {
    if (e->op == Op::not_)
      out.i = operand->kind == Kind::boolean ? !a.i : wrapped(cell, ~a.i);
    else if (real_cell(cell))
      out.r = e->op == Op::neg ? -a.r : std::abs(a.r);
    else
      out.i = e->op == Op::neg || (a.i < 0 && cell <= Cell::i64)
                  ? wrapped(cell, static_cast<std::int64_t>(0 - static_cast<std::uint64_t>(a.i)))
                  : a.i;
    return make_constant(e->type, out, e->at);
  }
  const Constant& b = e->args[1]->value;
  if (comparison(e->op)) {
    out.i = real_cell(cell) ? compare(e->op, a.r, b.r)
            : cell == Cell::u64
                ? compare(e->op, static_cast<std::uint64_t>(a.i), static_cast<std::uint64_t>(b.i))
                : compare(e->op, a.i, b.i);
    return make_constant(e->type, out, e->at);
  }
  if (real_cell(cell)) {
    const auto r = real_result(e->op, a.r, b.r);
    if (!r) {
      report_.error(e->at, texts::kConstantFault, {constant_text(*operand, a) + " / 0"});
      return bad(e->at);
    }
    out.r = rounded(cell, *r);
  } else {
    const auto i = integer_result(e->op, cell, a.i, b.i);
    if (!i) {
      report_.error(e->at, texts::kConstantFault, {constant_text(*operand, a) + " / 0"});
      return bad(e->at);
    }
    out.i = wrapped(cell, *i);
  }
  return make_constant(e->type, out, e->at);
}

std::optional<Constant> Analyzer::constant(const Expression& e, const Type* type, const Type* hint) {
  const std::size_t before = report_.errors();
  ExprPtr value = assignable(expression(e, hint != nullptr ? hint : type), type);
  if (report_.errors() != before || value->type->kind == Kind::error) return std::nullopt;
  if (value->kind == ir::ExprKind::constant) return value->value;
  report_.error(e.location, texts::kNotConstant);
  return std::nullopt;
}

std::optional<std::int64_t> Analyzer::constant_integer(const Expression& e) {
  const std::size_t before = report_.errors();
  const ExprPtr value = expression(e, elementary(Kind::lint));
  if (report_.errors() != before || value->type->kind == Kind::error) return std::nullopt;
  if (value->kind != ir::ExprKind::constant) {
    report_.error(e.location, texts::kNotConstant);
    return std::nullopt;
  }
  if (!is_integer(value->type->kind) && value->type->kind != Kind::untyped_int) {
    report_.error(e.location, texts::kMismatch, {"ANY_INT", value->type->name, ""});
    return std::nullopt;
  }
  return value->value.i;
}

std::vector<std::uint8_t> Analyzer::initial_bytes(const Expression& e, const Type& type) {
  std::vector<std::uint8_t> out = type.image;
  out.resize(type.size);
  if (type.kind == Kind::error) return out;
  if (type.kind == Kind::array) {
    initial_list(e, type, out);
  } else if (type.kind == Kind::structure || type.kind == Kind::block) {
    initial_record(e, type, out);
  } else if (type.kind == Kind::reference && gather_reference(e, type)) {
    return out;  // the address is written when it is known
  } else if (const auto c = constant(e, &type)) {
    store_constant(type, *c, out.data());
  }
  return out;
}

void Analyzer::initial_list(const Expression& e, const Type& type, std::vector<std::uint8_t>& out) {
  if (e.kind != syntax::ExpressionKind::list) {
    if (e.kind == syntax::ExpressionKind::name) {  // a constant array
      bool global = false;
      const Variable* v = find_variable(e.name, global);
      if (v != nullptr && v->constant && v->type == &type && !type.holds_reference) {
        out = v->initial;
        return;
      }
    }
    report_.error(e.location, texts::kExpected,
                  {"'[' (" + type.name + ")", text::both("a single value", "одно значение")});
    return;
  }
  // Several dimensions take nested lists or one flat list (IEC 61131-3, 6.4.4.5).
  const Type* element = type.base;
  auto count = static_cast<std::uint64_t>(type.range.count());
  const bool nested =
      !e.operands.empty() && e.operands[0] && e.operands[0]->kind == syntax::ExpressionKind::list;
  for (; !nested && element->kind == Kind::array; element = element->base)
    count *= static_cast<std::uint64_t>(element->range.count());
  std::uint64_t total = 0;
  for (const std::int64_t r : e.repeats) total += static_cast<std::uint64_t>(r);
  if (total > count) {
    report_.error(e.location, texts::kListLength, {std::to_string(total), std::to_string(count)});
    return;
  }
  std::size_t at = 0;
  const std::uint32_t stride = element->size;
  const std::uint32_t begin = gather_at_;
  for (std::size_t i = 0; i < e.operands.size(); ++i) {
    const std::int64_t times = e.repeats[i];
    if (e.operands[i]) {
      const std::size_t references = gathered_.size();
      gather_at_ = begin + static_cast<std::uint32_t>(at) * stride;
      const std::vector<std::uint8_t> bytes = initial_bytes(*e.operands[i], *element);
      repeat_references(references, times, stride);
      for (std::int64_t r = 0; r < times; ++r)
        std::copy(bytes.begin(), bytes.end(),
                  out.begin() + static_cast<std::ptrdiff_t>((at + static_cast<std::size_t>(r)) * stride));
    }
    at += static_cast<std::size_t>(times);
  }
  gather_at_ = begin;
}

void Analyzer::initial_record(const Expression& e, const Type& type, std::vector<std::uint8_t>& out) {
  if (e.kind != syntax::ExpressionKind::record) {
    report_.error(e.location, texts::kExpected,
                  {"'(' (" + type.name + ")", text::both("a single value", "одно значение")});
    return;
  }
  const std::uint32_t begin = gather_at_;
  for (const syntax::Argument& a : e.arguments) {
    const Field* f = type.field(a.name);
    if (f == nullptr || f->reference) {
      std::vector<std::string> names;
      for (const Field& g : type.fields) names.push_back(g.name);
      report_.error(a.location, texts::kNoMember, {type.name, a.name, syntax::suggestion(a.name, names)});
      continue;
    }
    gather_at_ = begin + f->offset;
    const std::vector<std::uint8_t> bytes = initial_bytes(*a.value, *f->type);
    std::copy(bytes.begin(), bytes.end(), out.begin() + f->offset);
  }
  gather_at_ = begin;
}

}  // namespace servogate::plc::sema
