// SPDX-License-Identifier: Apache-2.0
#include "plc/ir/ir.hpp"

namespace servogate::plc::ir {

Place Place::copy() const {
  Place p;
  p.root = root;
  p.cell = cell;
  p.offset = offset;
  p.bit = bit;
  p.type = type;
  if (pointer) p.pointer = pointer->copy();
  for (const Step& s : steps) p.steps.push_back(s.copy());
  return p;
}

Step Step::copy() const { return {index->copy(), low, high, stride, limits ? limits->copy() : nullptr}; }

ExprPtr Expr::copy() const {
  auto e = std::make_unique<Expr>();
  e->kind = kind;
  e->type = type;
  e->at = at;
  e->op = op;
  e->native = native;
  e->value = value;
  e->place = place.copy();
  e->unit = unit;
  e->result = result;
  for (const ExprPtr& a : args) e->args.push_back(a->copy());
  for (const Parameter& p : parameters)
    e->parameters.push_back(
        {p.offset, p.type, p.section, p.value ? p.value->copy() : nullptr, p.place.copy(), p.inverted});
  return e;
}

}  // namespace servogate::plc::ir
