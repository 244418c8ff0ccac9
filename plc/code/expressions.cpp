// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "plc/code/generator.hpp"
#include "plc/sema/analyzer.hpp"

namespace servogate::plc::code {

using ir::ExprKind;
using ir::Op;
using vm::Code;

namespace {
// Bytes of a temporary for a value: of a text as much as any result may have.
std::uint32_t cell_bytes(const Type& t) {
  return is_text(t.kind) ? text_size(t.kind, kMaxStringCapacity) : t.size;
}

bool comparison(Op op) { return op >= Op::eq && op <= Op::ge; }

Code first_code(Op op) {
  switch (op) {
    case Op::add:
      return Code::add_i8;
    case Op::sub:
      return Code::sub_i8;
    case Op::mul:
      return Code::mul_i8;
    case Op::div:
      return Code::div_i8;
    case Op::mod:
      return Code::mod_i8;
    case Op::min:
      return Code::min_i8;
    case Op::max:
      return Code::max_i8;
    case Op::eq:
      return Code::eq_i8;
    case Op::ne:
      return Code::ne_i8;
    case Op::lt:
    case Op::gt:
      return Code::lt_i8;
    case Op::le:
    case Op::ge:
      return Code::le_i8;
    case Op::and_:
      return Code::and_w1;
    case Op::or_:
      return Code::or_w1;
    case Op::xor_:
      return Code::xor_w1;
    case Op::neg:
      return Code::neg_i8;
    case Op::abs:
      return Code::abs_i8;
    case Op::not_:
      return Code::not_w1;
  }
  return Code::add_i8;
}
bool bitwise(Op op) { return op == Op::and_ || op == Op::or_ || op == Op::xor_ || op == Op::not_; }
}  // namespace

bool Generator::calls(const ir::Expr& e) {
  if (e.kind == ExprKind::call) return true;
  for (const ir::ExprPtr& a : e.args)
    if (calls(*a)) return true;
  return calls(e.place);
}
bool Generator::calls(const ir::Place& p) {
  return (p.pointer && calls(*p.pointer)) ||
         std::any_of(p.steps.begin(), p.steps.end(), [](const ir::Step& s) { return calls(*s.index); });
}

// Evaluating it costs less than a jump and neither faults nor changes anything.
bool Generator::cheap(const ir::Expr& e, int depth) {
  if (depth > 6) return false;
  switch (e.kind) {
    case ExprKind::constant:
      return true;
    case ExprKind::load:
      return !e.place.computed();
    case ExprKind::unary:
    case ExprKind::binary:
      if (e.op == Op::div || e.op == Op::mod || is_text(e.args[0]->type->kind)) return false;
      for (const ir::ExprPtr& a : e.args)
        if (!cheap(*a, depth + 1)) return false;
      return true;
    default:
      return false;
  }
}

Generator::Operand Generator::destination(const ir::Expr& e, std::optional<Operand> into) {
  return into ? *into : temporary(cell_bytes(*e.type));
}

// Faults name the line of the operation, not of the statement that it belongs to.
Generator::Operand Generator::value(const ir::Expr& e, std::optional<Operand> into) {
  const std::uint32_t outer = line_;
  if (e.at.line > 0) line_ = line_mark(e.at);
  const Operand out = value_of(e, into);
  line_ = outer;
  return out;
}

Generator::Operand Generator::value_of(const ir::Expr& e, std::optional<Operand> into) {
  switch (e.kind) {
    case ExprKind::constant: {
      const Operand c = constant(e);
      if (!into) return c;
      copy(*e.type, *into, c);
      return *into;
    }
    case ExprKind::load:
      return load(target(e.place), *e.type, into);
    case ExprKind::address:
      if (!into) return reference(e.place);
      bind(*into, e.place);
      return *into;
    case ExprKind::unary:
      return unary(e, into);
    case ExprKind::binary:
      return binary(e, into);
    case ExprKind::convert:
    case ExprKind::truncate:
    case ExprKind::reinterpret:
      return converted(e, into);
    case ExprKind::call:
      return call(e, into);
    case ExprKind::native:
      return native(e, into);
    case ExprKind::choose:
      return choose(e, into);
    case ExprKind::let:
      return let(e, into);
    case ExprKind::kept: {
      const Operand x = kept_[e.value.i];
      if (into) copy(*e.type, *into, x);
      return into ? *into : x;
    }
  }
  return 0;
}

Generator::Operand Generator::constant(const ir::Expr& e) {
  std::vector<std::uint8_t> bytes(std::max<std::uint32_t>(e.type->size, 1));
  sema::store_constant(*e.type, e.value, bytes.data());
  return constant_bytes(bytes.data(), value_size(*e.type, bytes.data()));
}

// The value of an operand; copied where a later one calls a function that might change it.
Generator::Operand Generator::stable(const ir::Expr& e, bool keep) {
  if (!keep || e.kind == ExprKind::constant) return value(e);
  const Operand kept = temporary(cell_bytes(*e.type));
  if (!is_text(e.type->kind)) return value(e, kept);
  move_text(e.type->kind, kept, value(e), kMaxStringCapacity);
  return kept;
}

Generator::Operand Generator::binary(const ir::Expr& e, std::optional<Operand> into) {
  const ir::Expr &a = *e.args[0], &b = *e.args[1];
  const Cell cell = cell_of(*a.type);
  if (is_text(a.type->kind)) return text_binary(e, into);
  if (a.type->kind == Kind::boolean && (e.op == Op::and_ || e.op == Op::or_) && !cheap(b))
    return short_circuit(e, into);
  Operand x = stable(a, calls(b)), y = value(b);
  if (e.op == Op::gt || e.op == Op::ge) std::swap(x, y);
  const Operand out = destination(e, into);
  const Code first = first_code(e.op);
  emit(bitwise(e.op) ? vm::code_for_width(first, cell_size(cell)) : vm::code_for(first, cell), out, x, y);
  return out;
}

Generator::Operand Generator::short_circuit(const ir::Expr& e, std::optional<Operand> into) {
  // Not straight into a variable: the right side may read it.
  const Operand work = temporary(1);
  value(*e.args[0], work);
  const std::size_t skip = emit(e.op == Op::and_ ? Code::jump_false : Code::jump_true, work);
  value(*e.args[1], work);
  land(skip);
  if (!into) return work;
  emit(Code::move_w1, *into, work);
  return *into;
}

Generator::Operand Generator::text_binary(const ir::Expr& e, std::optional<Operand> into) {
  const Operand x = stable(*e.args[0], calls(*e.args[1]));
  const Operand y = value(*e.args[1]);
  const bool wide = is_wide(e.args[0]->type->kind);
  if (!comparison(e.op)) {
    const Operand picked = temporary(cell_bytes(*e.type));
    emit(Code::native, picked, x, y, vm::pick_text_function(e.op == Op::max, wide));
    if (into) copy(*e.type, *into, picked);
    return into ? *into : picked;
  }
  const Operand order = temporary(1);
  emit(Code::native, order, x, y, vm::compare_text_function(wide));
  Operand left = order, right = constant_integer(0, Cell::i8);
  if (e.op == Op::gt || e.op == Op::ge) std::swap(left, right);
  const Operand out = destination(e, into);
  emit(vm::code_for(first_code(e.op), Cell::i8), out, left, right);
  return out;
}

Generator::Operand Generator::unary(const ir::Expr& e, std::optional<Operand> into) {
  const Operand x = value(*e.args[0]);
  const Operand out = destination(e, into);
  const Cell cell = cell_of(*e.type);
  if (e.op == Op::not_)
    invert(*e.type, out, x);
  else
    emit(vm::code_for(first_code(e.op), cell), out, x);
  return out;
}

void Generator::invert(const Type& type, Operand to, Operand from) {
  if (type.kind == Kind::boolean)
    emit(Code::not_bool, to, from);
  else
    emit(vm::code_for_width(Code::not_w1, type.size), to, from);
}

Generator::Operand Generator::converted(const ir::Expr& e, std::optional<Operand> into) {
  const ir::Expr& a = *e.args[0];
  const Cell from = cell_of(*a.type), to = cell_of(*e.type);
  const auto finish = [&](Operand x) {
    if (into) copy(*e.type, *into, x);
    return into ? *into : x;
  };
  if (is_text(e.type->kind)) {
    const Operand x = value(a);
    if (is_text(a.type->kind)) return finish(x);
    const Operand out = temporary(text_size(e.type->kind, 1));
    emit(Code::native, out, x, 0, vm::character_text_function(is_wide(e.type->kind)));
    return finish(out);
  }
  if (e.kind == ExprKind::reinterpret) return finish(value(a));
  const Operand x = value(a);
  if (e.type->kind == Kind::boolean && a.type->kind != Kind::boolean) {
    const Operand out = destination(e, into);
    const std::int64_t zero = 0;
    emit(vm::code_for(Code::ne_i8, from), out, x,
         constant_bytes(reinterpret_cast<const std::uint8_t*>(&zero), cell_size(from)));
    return out;
  }
  const bool integers = from <= Cell::u64 && to <= Cell::u64;
  // Little-endian: the low bytes of an integer stand at its own address.
  if (integers && cell_size(to) <= cell_size(from)) return finish(x);
  if (from == to) return finish(x);
  const Operand out = destination(e, into);
  emit(Code::native, out, x, 0,
       e.kind == ExprKind::truncate ? vm::truncate_function(from, to) : vm::convert_function(from, to));
  return out;
}

Generator::Operand Generator::native(const ir::Expr& e, std::optional<Operand> into) {
  std::vector<Operand> in;
  for (std::size_t i = 0; i < e.args.size(); ++i) {
    bool later = false;
    for (std::size_t j = i + 1; j < e.args.size(); ++j) later = later || calls(*e.args[j]);
    in.push_back(stable(*e.args[i], later));
  }
  in.resize(std::max<std::size_t>(in.size(), 4));
  if (e.args.size() > 2) emit(Code::extra, 0, in[2], in[3]);
  const std::uint16_t function = vm::native_function(e);
  if (!is_text(e.type->kind)) {
    const Operand out = destination(e, into);
    emit(Code::native, out, in[0], in[1], function);
    return out;
  }
  const Operand out = temporary(cell_bytes(*e.type));
  emit(Code::native, out, in[0], in[1], function);
  if (into) copy(*e.type, *into, out);
  return into ? *into : out;
}

Generator::Operand Generator::choose(const ir::Expr& e, std::optional<Operand> into) {
  const Operand work = temporary(cell_bytes(*e.type));
  const Operand condition = value(*e.args[0]);
  const std::size_t otherwise = emit(Code::jump_false, condition);
  const auto part = [&](const ir::Expr& x) {
    if (is_text(e.type->kind))
      move_text(e.type->kind, work, value(x), kMaxStringCapacity);
    else
      value(x, work);
  };
  part(*e.args[1]);
  const std::size_t end = emit(Code::jump);
  land(otherwise);
  part(*e.args[2]);
  land(end);
  if (into) copy(*e.type, *into, work);
  return into ? *into : work;
}

// The cell is this unit's own, so that no function called further on touches it.
Generator::Operand Generator::let(const ir::Expr& e, std::optional<Operand> into) {
  const ir::Expr& held = *e.args[0];
  const Operand cell = temporary(cell_bytes(*held.type));
  if (is_text(held.type->kind))
    move_text(held.type->kind, cell, value(held), kMaxStringCapacity);
  else
    value(held, cell);
  kept_[e.value.i] = cell;
  return value(*e.args[1], into);
}

namespace {
bool is_output(const ir::Parameter& p) { return !p.value && p.section == syntax::Section::output; }
}  // namespace

Generator::Operand Generator::call(const ir::Expr& e, std::optional<Operand> into) {
  const ir::Unit& u = program_.units[static_cast<std::size_t>(e.unit)];
  const auto frame = static_cast<std::uint32_t>(u.fixed_base);
  std::vector<Operand> values = argument_values(e);
  pass(e, frame, values);
  const Unit& callee = units_[static_cast<std::size_t>(e.unit)];
  emit(Code::call, callee.entry, frame, callee.length);
  // The subscript of an output may call the function once more.
  const bool again = std::any_of(e.parameters.begin(), e.parameters.end(),
                                 [](const ir::Parameter& p) { return is_output(p) && calls(p.place); });
  const auto kept = [&](const Type& type, Operand from) {
    if (!again) return from;
    const Operand to = temporary(type.size);
    copy(type, to, from);
    return to;
  };
  const bool gives = e.type->kind != Kind::none;
  const Operand result = gives ? kept(*e.type, frame + e.result) : 0;
  for (std::size_t i = 0; i < e.parameters.size(); ++i)
    if (is_output(e.parameters[i])) values[i] = kept(*e.parameters[i].type, frame + e.parameters[i].offset);
  for (std::size_t i = 0; i < e.parameters.size(); ++i)
    if (is_output(e.parameters[i])) give(e.parameters[i], values[i]);
  if (!gives) return 0;
  const Operand out = into ? *into : temporary(e.type->size);
  copy(*e.type, out, result);
  return out;
}

// All values and subscripts before the first of them is passed: an argument may call the same function.
std::vector<Generator::Operand> Generator::argument_values(const ir::Expr& e) {
  const auto calling = [](const ir::Parameter& p) {
    return p.value ? calls(*p.value) : !is_output(p) && calls(p.place);
  };
  std::vector<Operand> values(e.parameters.size());
  std::size_t last = e.parameters.size();  // behind the last one that calls a function
  while (last > 0 && !calling(e.parameters[last - 1])) --last;
  for (std::size_t i = 0; i < e.parameters.size(); ++i) {
    const ir::Parameter& p = e.parameters[i];
    if (!p.value) {
      if (!is_output(p) && p.place.computed()) bind(values[i] = temporary(4), p.place);
      continue;
    }
    if (i + 1 >= last || p.value->kind == ExprKind::constant) {
      values[i] = value(*p.value);
      continue;
    }
    const Operand kept = temporary(p.type->size);
    if (is_text(p.value->type->kind))
      copy(*p.type, kept, value(*p.value));
    else
      value(*p.value, kept);
    values[i] = kept;
  }
  return values;
}

void Generator::pass(const ir::Expr& e, std::uint32_t frame, const std::vector<Operand>& values) {
  for (std::size_t i = 0; i < e.parameters.size(); ++i) {
    const ir::Parameter& p = e.parameters[i];
    const Operand to = frame + p.offset;
    if (p.value && p.type->bounded && p.value->kind != ExprKind::constant)
      emit(vm::code_for(Code::check_i8, cell_of(*p.type)), values[i], 0, 0,
           bounds(p.type->limits.low, p.type->limits.high, 0));
    if (p.value)
      copy(*p.type, to, values[i]);
    else if (!is_output(p) && p.place.computed())
      emit(Code::move_w4, to, values[i]);
    else if (!is_output(p))
      bind(to, p.place);
  }
}

// An output goes to its variable; to one of another integer type when its value fits.
void Generator::give(const ir::Parameter& p, Operand from) {
  if (p.inverted) {
    const Operand inverted = temporary(p.type->size);
    invert(*p.type, inverted, from);
    from = inverted;
  }
  const Type& to = *p.place.type;
  if (to.kind == p.type->kind || !is_integer(to.kind) || !is_integer(p.type->kind))
    return store(target(p.place), *p.type, from);
  std::int64_t low = 0;
  std::uint64_t high = 0;
  integer_limits(to.kind, low, high);
  const Cell cell = cell_of(*p.type);
  emit(vm::code_for(Code::check_i8, cell), from, 0, 0,
       bounds(low, static_cast<std::int64_t>(high & (~std::uint64_t{0} >> 1)), 0));
  const Operand converted_value = temporary(to.size);
  emit(Code::native, converted_value, from, 0, vm::convert_function(cell, cell_of(to)));
  store(target(p.place), to, converted_value);
}

}  // namespace servogate::plc::code
