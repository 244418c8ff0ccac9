// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/ast.hpp"

namespace servogate::plc::syntax {

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

}  // namespace servogate::plc::syntax
