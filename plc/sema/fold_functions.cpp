// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "plc/sema/analyzer.hpp"
#include "plc/vm/machine.hpp"

// Functions and conversions of constants, computed by the functions of the machine itself, so that a folded
// value is the one that a scan would give. What would be a fault stays for the scan.
namespace servogate::plc::sema {

namespace {

struct alignas(8) Value {
  std::array<std::uint8_t, kMaxElementarySize> bytes{};
};

Value value_of(const Expr& constant) {
  Value v;
  store_constant(*constant.type, constant.value, v.bytes.data());
  return v;
}

bool constants(const Expr& e) {
  return !e.args.empty() && std::all_of(e.args.begin(), e.args.end(), [](const ExprPtr& a) {
    return a->kind == ir::ExprKind::constant && is_elementary(a->type->kind);
  });
}

}  // namespace

ExprPtr Analyzer::fold_function(ExprPtr e) {
  if (e->native == Native::now || e->native == Native::select_fault || !constants(*e)) return e;
  Value in[4], out;
  for (std::size_t i = 0; i < e->args.size(); ++i) in[i] = value_of(*e->args[i]);
  vm::Machine machine;
  machine.extra[0] = in[2].bytes.data();
  machine.extra[1] = in[3].bytes.data();
  const vm::NativeFunction function = vm::native_at(vm::native_function(*e));
  if (function(machine, out.bytes.data(), in[0].bytes.data(), in[1].bytes.data()) != Fault::none) return e;
  Constant c = stored_constant(*e->type, out.bytes.data());
  if (!std::isfinite(c.r)) return e;
  return make_constant(e->type, std::move(c), e->at);
}

ExprPtr Analyzer::fold_conversion(ExprPtr e) {
  if (!constants(*e) || is_text(e->type->kind) || is_untyped(e->args[0]->type->kind)) return e;
  const Expr& a = *e->args[0];
  const Cell from = cell_of(*a.type), to = cell_of(*e->type);
  const Value in = value_of(a);
  Value out = in;  // integers that get narrower keep their low bytes
  const bool low_bytes = from <= Cell::u64 && to <= Cell::u64 && cell_size(to) <= cell_size(from);
  if (e->type->kind == Kind::boolean && a.type->kind != Kind::boolean) {
    out.bytes[0] = from >= Cell::f32 ? a.value.r != 0 : a.value.i != 0;
  } else if (e->kind != ir::ExprKind::reinterpret && from != to && !low_bytes) {
    vm::Machine machine;
    const auto number =
        e->kind == ir::ExprKind::truncate ? vm::truncate_function(from, to) : vm::convert_function(from, to);
    if (vm::native_at(number)(machine, out.bytes.data(), in.bytes.data(), nullptr) != Fault::none) return e;
  }
  Constant c = stored_constant(*e->type, out.bytes.data());
  if (!std::isfinite(c.r)) return e;
  return make_constant(e->type, std::move(c), e->at);
}

}  // namespace servogate::plc::sema
