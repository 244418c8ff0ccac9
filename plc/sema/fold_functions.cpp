// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>

#include "plc/sema/analyzer.hpp"

namespace servogate::plc::sema {

namespace {

// As the machine computes it, in the same precision.
template <typename T>
T real_result(Native n, T a, T b) {
  switch (n) {
    case Native::sqrt:
      return std::sqrt(a);
    case Native::ln:
      return std::log(a);
    case Native::log:
      return std::log10(a);
    case Native::exp:
      return std::exp(a);
    case Native::sin:
      return std::sin(a);
    case Native::cos:
      return std::cos(a);
    case Native::tan:
      return std::tan(a);
    case Native::asin:
      return std::asin(a);
    case Native::acos:
      return std::acos(a);
    case Native::atan:
      return std::atan(a);
    case Native::atan2:
      return std::atan2(a, b);
    default:
      return std::pow(a, b);
  }
}

template <typename T>
std::int64_t shifted(Native n, std::int64_t value, std::int64_t by) {
  constexpr std::int64_t width = sizeof(T) * 8;
  const auto v = static_cast<T>(value);
  T out = v;
  if (n == Native::rol || n == Native::ror)
    out = n == Native::rol ? std::rotl(v, static_cast<int>(by % width))
                           : std::rotr(v, static_cast<int>(by % width));
  else if (by >= width)
    out = 0;
  else if (by > 0)
    out = static_cast<T>(n == Native::shl ? v << by : v >> by);
  return static_cast<std::int64_t>(out);
}

}  // namespace

// Functions of constants that initial values may need; the others are computed when the program runs.
ExprPtr Analyzer::fold_function(ExprPtr e) {
  if (e->args.empty() || std::any_of(e->args.begin(), e->args.end(),
                                     [](const ExprPtr& a) { return a->kind != ir::ExprKind::constant; }))
    return e;
  const Constant &a = e->args.front()->value, &b = e->args.back()->value;
  Constant c;
  if (e->native <= Native::power) {
    c.r = e->type->kind == Kind::real
              ? static_cast<double>(real_result(e->native, static_cast<float>(a.r), static_cast<float>(b.r)))
              : real_result(e->native, a.r, b.r);
    if (!std::isfinite(c.r)) return e;
  } else if (e->native <= Native::ror) {
    const std::uint32_t size = e->type->size;
    c.i = size == 1   ? shifted<std::uint8_t>(e->native, a.i, b.i)
          : size == 2 ? shifted<std::uint16_t>(e->native, a.i, b.i)
          : size == 4 ? shifted<std::uint32_t>(e->native, a.i, b.i)
                      : shifted<std::uint64_t>(e->native, a.i, b.i);
    std::uint8_t bytes[8];
    store_constant(*e->type, c, bytes);
    c = stored_constant(*e->type, bytes);  // with its sign
  } else if (e->native == Native::concat) {
    c.s = (a.s + b.s).substr(0, kMaxStringCapacity);
    c.w = (a.w + b.w).substr(0, kMaxStringCapacity);
  } else {
    return e;
  }
  return make_constant(e->type, std::move(c), e->at);
}

}  // namespace servogate::plc::sema
