// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/two_paths/evaluator.hpp"

#include <cmath>
#include <cstring>

namespace servogate::plc {

using ir::ExprKind;
using ir::Op;
using ir::StmtKind;

namespace {

struct Stopped {
  Fault fault;
};

bool real(Cell c) { return c == Cell::f32 || c == Cell::f64; }
int bits(Cell c) { return static_cast<int>(cell_size(c)) * 8; }
bool is_signed_cell(Cell c) { return c <= Cell::i64; }

std::int64_t wrap(Cell c, std::int64_t v) {
  const int n = bits(c);
  if (n == 64) return v;
  const std::int64_t modulus = std::int64_t{1} << n;
  std::int64_t r = v % modulus;
  if (r < 0) r += modulus;
  return is_signed_cell(c) && r >= modulus / 2 ? r - modulus : r;
}
double narrow(Cell c, double v) { return c == Cell::f32 ? static_cast<double>(static_cast<float>(v)) : v; }
bool less(Cell c, std::int64_t a, std::int64_t b) {
  return c == Cell::u64 ? static_cast<std::uint64_t>(a) < static_cast<std::uint64_t>(b) : a < b;
}

}  // namespace

Fault Evaluator::scan() {
  steps_ = 0;
  try {
    for (const ir::Task& t : program_.tasks) run(t.unit, 0);
    return Fault::none;
  } catch (const Stopped& s) {
    return s.fault;
  }
}

void Evaluator::run(int unit, std::uint32_t self) {
  const ir::Unit& u = program_.units[static_cast<std::size_t>(unit)];
  for (const auto& r : u.resets)
    for (std::uint32_t b = 0; b < r.size; ++b) {
      const std::uint32_t at = r.offset + b;
      memory[self + at] = at < u.frame->image.size() ? u.frame->image[at] : 0;
    }
  // Labels stand in the outermost block only.
  for (std::size_t at = 0; at < u.body.size(); ++at) {
    if (++steps_ > 3'000'000) throw Stopped{Fault::budget};
    const Flow f = statement(u.body[at], self);
    if (f == Flow::jump) {
      const std::int32_t wanted = target_;
      for (at = 0; u.body[at].kind != StmtKind::label || u.body[at].label != wanted;) ++at;
    } else if (f != Flow::next) {
      return;
    }
  }
}

Evaluator::Address Evaluator::address(const ir::Place& p, std::uint32_t self) {
  Address a;
  a.bit = p.bit;
  a.at = p.cell + p.offset;
  if (p.root == ir::Root::instance) a.at += self;
  if (p.root == ir::Root::reference) {
    std::uint32_t target = 0;
    std::memcpy(&target, memory.data() + self + p.cell, 4);
    a.at = target + p.offset;
  }
  if (p.root == ir::Root::pointer) {
    std::uint32_t target = 0;
    std::memcpy(&target, memory.data() + p.cell, 4);
    a.at = target + p.offset;
  }
  if (p.pointer) {
    a.at = static_cast<std::uint32_t>(evaluate(*p.pointer, self).i) + p.offset;
    if (a.at == p.offset) throw Stopped{Fault::null_reference};
  }
  for (const ir::Step& s : p.steps) {
    const Value index = evaluate(*s.index, self);
    const bool huge = cell_of(*s.index->type) == Cell::u64 && index.i < 0;
    ir::Limits limits{s.low, s.high, s.stride};
    if (s.limits) std::memcpy(&limits, memory.data() + address(s.limits->place, self).at, sizeof limits);
    if (huge || index.i < limits.low || index.i > limits.high) throw Stopped{Fault::index_out_of_range};
    a.at += static_cast<std::uint32_t>((index.i - limits.low) * limits.stride);
  }
  return a;
}

Evaluator::Value Evaluator::load(const Address& a, const Type& t) const {
  Value v;
  const std::uint8_t* at = memory.data() + a.at;
  if (a.bit >= 0) {
    v.i = *at >> a.bit & 1;
    return v;
  }
  const Cell c = cell_of(t);
  if (c == Cell::f32) {
    float f = 0;
    std::memcpy(&f, at, 4);
    v.r = static_cast<double>(f);
  } else if (c == Cell::f64) {
    std::memcpy(&v.r, at, 8);
  } else if (c == Cell::blob) {
    v.bytes.assign(at, at + t.size);
  } else {
    std::memcpy(&v.i, at, cell_size(c));
    v.i = wrap(c, v.i);
  }
  return v;
}

void Evaluator::store(const Address& a, const Type& t, const Value& v) {
  std::uint8_t* at = memory.data() + a.at;
  if (a.bit >= 0) {
    *at = static_cast<std::uint8_t>(v.i != 0 ? *at | 1 << a.bit : *at & ~(1 << a.bit));
    return;
  }
  const Cell c = cell_of(t);
  if (c == Cell::f32) {
    const auto f = static_cast<float>(v.r);
    std::memcpy(at, &f, 4);
  } else if (c == Cell::f64) {
    std::memcpy(at, &v.r, 8);
  } else if (c == Cell::blob) {
    std::memcpy(at, v.bytes.data(), t.size);
  } else {
    std::memcpy(at, &v.i, cell_size(c));
  }
}

Evaluator::Value Evaluator::evaluate(const ir::Expr& e, std::uint32_t self) {
  switch (e.kind) {
    case ExprKind::constant:
      return {e.value.i, e.value.r, {}};
    case ExprKind::load:
      return load(address(e.place, self), *e.type);
    case ExprKind::address:
      return {address(e.place, self).at, 0, {}};
    case ExprKind::unary:
      return unary(e, self);
    case ExprKind::binary:
      return binary(e, self);
    case ExprKind::convert:
    case ExprKind::truncate:
      return convert(e, self);
    case ExprKind::reinterpret:
      return evaluate(*e.args[0], self);
    case ExprKind::call:
      return call(e, self);
    case ExprKind::native:
      return native(e, self);
    case ExprKind::choose:
      return evaluate(evaluate(*e.args[0], self).i != 0 ? *e.args[1] : *e.args[2], self);
    case ExprKind::let:
      kept_[e.value.i] = evaluate(*e.args[0], self);
      return evaluate(*e.args[1], self);
    case ExprKind::kept:
      return kept_[e.value.i];
  }
  return {};
}

Evaluator::Value Evaluator::unary(const ir::Expr& e, std::uint32_t self) {
  Value v = evaluate(*e.args[0], self);
  const Cell c = cell_of(*e.type);
  if (e.op == Op::not_) {
    v.i = e.type->kind == Kind::boolean ? v.i == 0 : wrap(c, ~v.i);
  } else if (real(c)) {
    v.r = e.op == Op::neg ? -v.r : std::fabs(v.r);
  } else if (e.op == Op::neg || (is_signed_cell(c) && v.i < 0)) {
    v.i = wrap(c, static_cast<std::int64_t>(~static_cast<std::uint64_t>(v.i) + 1));
  }
  return v;
}

Evaluator::Value Evaluator::binary(const ir::Expr& e, std::uint32_t self) {
  const Cell c = cell_of(*e.args[0]->type);
  const Value a = evaluate(*e.args[0], self);
  if (e.args[0]->type->kind == Kind::boolean) {  // stops where the result is known
    if (e.op == Op::and_ && a.i == 0) return a;
    if (e.op == Op::or_ && a.i != 0) return a;
  }
  const Value b = evaluate(*e.args[1], self);
  Value v;
  const auto order = [&](bool r, bool i) { return real(c) ? r : i; };
  const auto x = static_cast<std::uint64_t>(a.i), y = static_cast<std::uint64_t>(b.i);
  switch (e.op) {
    case Op::eq:
      v.i = order(a.r == b.r, a.i == b.i);
      return v;
    case Op::ne:
      v.i = order(a.r != b.r, a.i != b.i);
      return v;
    case Op::lt:
      v.i = order(a.r < b.r, less(c, a.i, b.i));
      return v;
    case Op::gt:
      v.i = order(a.r > b.r, less(c, b.i, a.i));
      return v;
    case Op::le:
      v.i = order(a.r <= b.r, !less(c, b.i, a.i));
      return v;
    case Op::ge:
      v.i = order(a.r >= b.r, !less(c, a.i, b.i));
      return v;
    case Op::min:
      return order(b.r < a.r, less(c, b.i, a.i)) ? b : a;
    case Op::max:
      return order(b.r > a.r, less(c, a.i, b.i)) ? b : a;
    case Op::add:
      v.r = narrow(c, a.r + b.r);
      v.i = static_cast<std::int64_t>(x + y);
      break;
    case Op::sub:
      v.r = narrow(c, a.r - b.r);
      v.i = static_cast<std::int64_t>(x - y);
      break;
    case Op::mul:
      v.r = narrow(c, a.r * b.r);
      v.i = static_cast<std::int64_t>(x * y);
      break;
    case Op::div:
      if (real(c) ? b.r == 0.0 : b.i == 0) throw Stopped{Fault::division_by_zero};
      if (real(c))
        v.r = narrow(c, a.r / b.r);
      else
        v.i = c == Cell::u64 ? static_cast<std::int64_t>(x / y)
              : b.i == -1    ? static_cast<std::int64_t>(0 - x)
                             : a.i / b.i;
      break;
    case Op::mod:
      v.i = b.i == 0 || (b.i == -1 && c != Cell::u64) ? 0
            : c == Cell::u64                          ? static_cast<std::int64_t>(x % y)
                                                      : a.i % b.i;
      break;
    case Op::and_:
      v.i = a.i & b.i;
      break;
    case Op::or_:
      v.i = a.i | b.i;
      break;
    case Op::xor_:
      v.i = a.i ^ b.i;
      break;
    default:
      break;
  }
  if (!real(c)) v.i = wrap(c, v.i);
  return v;
}

Evaluator::Value Evaluator::convert(const ir::Expr& e, std::uint32_t self) {
  const Value a = evaluate(*e.args[0], self);
  const Cell from = cell_of(*e.args[0]->type), to = cell_of(*e.type);
  Value v;
  if (e.type->kind == Kind::boolean && e.args[0]->type->kind != Kind::boolean) {
    v.i = real(from) ? a.r != 0.0 : a.i != 0;
  } else if (real(from) && real(to)) {
    v.r = narrow(to, a.r);
    if (std::isinf(v.r) && !std::isinf(a.r)) throw Stopped{Fault::conversion};
  } else if (real(from)) {
    const double r = e.kind == ExprKind::truncate ? std::trunc(a.r) : std::nearbyint(a.r);
    const double high = std::pow(2.0, bits(to) - (is_signed_cell(to) ? 1 : 0));
    if (!(r >= (is_signed_cell(to) ? -high : 0.0) && r < high)) throw Stopped{Fault::conversion};
    v.i = to == Cell::u64 ? static_cast<std::int64_t>(static_cast<std::uint64_t>(r))
                          : static_cast<std::int64_t>(r);
  } else if (real(to)) {
    if (to == Cell::f32)
      v.r = static_cast<double>(from == Cell::u64 ? static_cast<float>(static_cast<std::uint64_t>(a.i))
                                                  : static_cast<float>(a.i));
    else
      v.r =
          from == Cell::u64 ? static_cast<double>(static_cast<std::uint64_t>(a.i)) : static_cast<double>(a.i);
  } else {
    v.i = wrap(to, a.i);
  }
  return v;
}

Evaluator::Value Evaluator::native(const ir::Expr& e, std::uint32_t self) {
  if (e.native == ir::Native::select_fault) throw Stopped{Fault::selector};
  const Value a = evaluate(*e.args[0], self);
  const Cell c = cell_of(*e.type);
  Value v;
  if (e.native == ir::Native::sqrt) {
    v.r = c == Cell::f32 ? static_cast<double>(std::sqrt(static_cast<float>(a.r))) : std::sqrt(a.r);
    return v;
  }
  const std::int64_t n = evaluate(*e.args[1], self).i;
  const int width = bits(c);
  const std::uint64_t mask = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
  const std::uint64_t x = static_cast<std::uint64_t>(a.i) & mask;
  const auto turned = static_cast<int>(((n % width) + width) % width);
  std::uint64_t out = x;
  if (e.native == ir::Native::shl && n > 0) out = n >= width ? 0 : x << n;
  if (e.native == ir::Native::shr && n > 0) out = n >= width ? 0 : x >> n;
  const int left = e.native == ir::Native::rol ? turned : (width - turned) % width;
  if (e.native == ir::Native::rol || e.native == ir::Native::ror)
    out = left == 0 ? x : x << left | x >> (width - left);
  v.i = wrap(c, static_cast<std::int64_t>(out & mask));
  return v;
}

Evaluator::Value Evaluator::call(const ir::Expr& e, std::uint32_t self) {
  const auto frame = static_cast<std::uint32_t>(program_.units[static_cast<std::size_t>(e.unit)].fixed_base);
  std::vector<Value> values;
  std::vector<std::uint32_t> bound;
  for (const ir::Parameter& p : e.parameters) {
    const bool binds_place = !p.value && p.section != syntax::Section::output;
    values.push_back(p.value ? evaluate(*p.value, self) : Value{});
    bound.push_back(binds_place ? address(p.place, self).at : 0);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ir::Parameter& p = e.parameters[i];
    if (p.value) {
      const Dimension& limits = p.type->limits;
      if (p.type->bounded && (values[i].i < limits.low || values[i].i > limits.high))
        throw Stopped{Fault::subrange};
      store({frame + p.offset, -1}, *p.type, values[i]);
    } else if (p.section != syntax::Section::output) {
      std::memcpy(memory.data() + frame + p.offset, &bound[i], 4);
    }
  }
  run(e.unit, frame);
  const auto is_output = [](const ir::Parameter& p) {
    return !p.value && p.section == syntax::Section::output;
  };
  for (std::size_t i = 0; i < values.size(); ++i)
    if (const ir::Parameter& p = e.parameters[i]; is_output(p))
      values[i] = load({frame + p.offset, -1}, *p.type);
  const Value result = e.type->kind == Kind::none ? Value{} : load({frame + e.result, -1}, *e.type);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (const ir::Parameter& p = e.parameters[i]; is_output(p)) {
      Value& v = values[i];
      if (p.inverted) v.i = p.type->kind == Kind::boolean ? v.i == 0 : wrap(cell_of(*p.type), ~v.i);
      store(address(p.place, self), *p.type, v);
    }
  return result;
}

Evaluator::Flow Evaluator::block(const ir::Block& b, std::uint32_t self) {
  for (const ir::Stmt& s : b) {
    if (++steps_ > 3'000'000) throw Stopped{Fault::budget};
    if (const Flow f = statement(s, self); f != Flow::next) return f;
  }
  return Flow::next;
}

Evaluator::Flow Evaluator::statement(const ir::Stmt& s, std::uint32_t self) {
  switch (s.kind) {
    case StmtKind::assign: {
      const Value v = evaluate(*s.value, self);
      const Type& t = *s.place.type;
      if (s.check_range && (v.i < t.limits.low || v.i > t.limits.high)) throw Stopped{Fault::subrange};
      store(address(s.place, self), t, v);
      return Flow::next;
    }
    case StmtKind::bind: {
      const std::uint32_t at = address(s.other, self).at;
      std::memcpy(memory.data() + address(s.place, self).at, &at, 4);
      return Flow::next;
    }
    case StmtKind::invoke:
      run(s.unit, address(s.place, self).at);
      return Flow::next;
    case StmtKind::evaluate:
      evaluate(*s.value, self);
      return Flow::next;
    case StmtKind::if_:
      for (const ir::Branch& b : s.branches)
        if (evaluate(*b.condition, self).i != 0) return block(b.body, self);
      return block(s.body, self);
    case StmtKind::case_: {
      const Value v = evaluate(*s.value, self);
      const Cell c = cell_of(*s.value->type);
      for (const ir::Branch& b : s.branches)
        for (const ir::Range& r : b.ranges)
          if (!less(c, v.i, r.low) && !less(c, r.high, v.i)) return block(b.body, self);
      return block(s.body, self);
    }
    case StmtKind::label:
      return Flow::next;
    case StmtKind::jump:
      target_ = s.label;
      return Flow::jump;
    case StmtKind::exit:
      return Flow::exit;
    case StmtKind::continue_:
      return Flow::continue_;
    case StmtKind::return_:
      return Flow::return_;
    default:
      return loop(s, self);
  }
}

Evaluator::Flow Evaluator::loop(const ir::Stmt& s, std::uint32_t self) {
  if (s.kind != StmtKind::for_) {
    do {
      if (++steps_ > 3'000'000) throw Stopped{Fault::budget};
      if (s.kind == StmtKind::while_ && evaluate(*s.value, self).i == 0) break;
      const Flow f = block(s.body, self);
      if (f == Flow::exit) break;
      if (f == Flow::return_ || f == Flow::jump) return f;
    } while (s.kind == StmtKind::while_ || evaluate(*s.value, self).i == 0);
    return Flow::next;
  }
  const Cell c = cell_of(*s.place.type);
  Value n = evaluate(*s.value, self);
  const std::int64_t to = evaluate(*s.to, self).i, by = evaluate(*s.by, self).i;
  const auto show = [&] {
    Value shown = n;
    if (c == Cell::u64)
      shown.i = static_cast<std::int64_t>(static_cast<std::uint64_t>(n.i) + (std::uint64_t{1} << 63));
    if (bits(c) == 64 || wrap(c, n.i) == n.i) store(address(s.place, self), *s.place.type, shown);
  };
  show();
  while (by >= 0 ? n.i <= to : n.i >= to) {
    if (++steps_ > 3'000'000) throw Stopped{Fault::budget};
    const Dimension& limits = s.place.type->limits;
    if (s.check_range && (n.i < limits.low || n.i > limits.high)) throw Stopped{Fault::subrange};
    const Flow f = block(s.body, self);
    if (f == Flow::exit) break;
    if (f == Flow::return_ || f == Flow::jump) return f;
    if (__builtin_add_overflow(n.i, by, &n.i)) break;
    show();
  }
  return Flow::next;
}

}  // namespace servogate::plc
