// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using ir::ExprKind;
using syntax::ExpressionKind;
using syntax::Section;
using syntax::UnitKind;

namespace {
// EN and ENO where a unit declares them itself (table 18): no list without names has them.
bool is_enable(const Variable& v) {
  return (v.section == Section::input && same_name(v.name, "EN")) ||
         (v.section == Section::output && same_name(v.name, "ENO"));
}
}  // namespace

ExprPtr Analyzer::call(const Expression& e, const Type* hint, bool) {
  const Expression& callee = *e.operands[0];
  if (e.enable && !e.enabled && guarded_ != &e) return enabled_call(e, hint);
  if (e.enabled && guarded_ != &e) report_.error(e.location, texts::kEnableNested);
  if (callee.kind == ExpressionKind::name) {
    const std::string key = key_of(callee.name);
    bool global = false;
    const Variable* v = find_variable(callee.name, global);
    if (v == nullptr || v->type->kind != Kind::block) {
      const auto unit = units_by_name_.find(key);
      if (const int function = function_named(callee); function >= 0) return function_call(e, function);
      if (is_standard(key)) return standard_call(e, key, hint);
      if (key == "REF") return reference_to(e);
      if (v == nullptr) {
        std::vector<std::string> names = names_in_scope();
        for (const syntax::Unit& u : source_.units)
          if (u.kind == UnitKind::function) names.push_back(u.name);
        for (const char* n : {"ABS", "SQRT", "MIN", "MAX", "LIMIT", "SEL", "MUX", "CONCAT", "LEN", "TRUNC"})
          names.push_back(n);
        const bool program =
            unit != units_by_name_.end() &&
            scopes_[static_cast<std::size_t>(unit->second)].source->kind == UnitKind::program;
        if (program)
          report_.error(callee.location, texts::kProgramCall, {callee.name});
        else if (unit != units_by_name_.end())
          report_.error(
              callee.location, texts::kUnknownCall,
              {callee.name, "; VAR x : " + scopes_[static_cast<std::size_t>(unit->second)].source->name});
        else
          report_.error(callee.location, texts::kUnknownCall,
                        {callee.name, syntax::suggestion(callee.name, names)});
        for (const syntax::Argument& a : e.arguments)
          if (a.value && !a.output) expression(*a.value);
        return bad(e.location);
      }
    }
  }
  std::string shown;
  if (!dotted_symbol(callee, shown)) shown = "(...)";
  bool global = false;
  const Variable* v = callee.kind == ExpressionKind::name ? find_variable(callee.name, global) : nullptr;
  if (v != nullptr && v->type->kind != Kind::block)
    report_.error(callee.location, texts::kNotCallable, {shown, v->type->name});
  else
    report_.error(callee.location, texts::kNoValue, {shown});
  return bad(e.location);
}

// EN inside of an expression: FALSE calls nothing, and the value is what the type begins with.
ExprPtr Analyzer::enabled_call(const Expression& e, const Type* hint) {
  const Expression* outer = std::exchange(guarded_, &e);
  ExprPtr enable = condition(*e.enable);
  ExprPtr value = settle(call(e, hint, false), hint);
  guarded_ = outer;
  const Type& type = *value->type;
  if (enable->type->kind == Kind::error || type.kind == Kind::error) return bad(e.location);
  if (!is_elementary(type.kind)) {
    report_.error(e.location, texts::kEnableNested);
    return bad(e.location);
  }
  std::vector<std::uint8_t> bytes = type.image;
  bytes.resize(type.size);
  ExprPtr out = node(ExprKind::choose, value->type, e.location);
  out->args.push_back(std::move(enable));
  out->args.push_back(std::move(value));
  out->args.push_back(make_constant(&type, stored_constant(type, bytes.data()), e.location));
  return out;
}

// The FUNCTION that a call names; -1: none that is declared in text.
int Analyzer::function_named(const Expression& callee) {
  if (callee.kind != ExpressionKind::name) return -1;
  const int unit = unit_named(callee.name);
  const bool found = unit >= 0 && scopes_[static_cast<std::size_t>(unit)].source->kind == UnitKind::function;
  return found ? unit : -1;
}

const Variable* Analyzer::match(const syntax::Argument& a, std::size_t position, int unit,
                                bool with_outputs) {
  const UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  const auto is_input = [](const Variable& v) {
    return v.section == Section::input || v.section == Section::in_out;
  };
  if (!a.name.empty()) {
    const auto at = u.by_name.find(key_of(a.name));
    if (at == u.by_name.end()) return nullptr;
    const Variable& v = u.variables[at->second];
    return (a.output ? v.section == Section::output : is_input(v)) ? &v : nullptr;
  }
  std::size_t seen = 0;
  for (const Variable& v : u.variables)
    if (!is_enable(v) && (is_input(v) || (with_outputs && v.section == Section::output)) &&
        seen++ == position)
      return &v;
  return nullptr;
}

// Pairs actual with formal parameters; false when something was reported. A list without names gives either
// the inputs, or inputs and outputs as they are declared (IEC 61131-3:2013, 6.6.1.4.2).
bool Analyzer::check_arguments(const Expression& e, int unit, std::vector<const Variable*>& matched) {
  const UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  const std::size_t errors = report_.errors();
  std::size_t positional = 0, named = 0, inputs_known = 0, all_known = 0, position = 0;
  std::set<const Variable*> given;
  for (const Variable& v : u.variables) {
    if (is_enable(v)) continue;
    const bool input = v.section == Section::input || v.section == Section::in_out;
    inputs_known += input;
    all_known += input || v.section == Section::output;
  }
  for (const syntax::Argument& a : e.arguments)
    if (a.name.empty())
      ++positional;
    else if (!a.output)
      ++named;
  const bool with_outputs = positional > inputs_known && positional == all_known;
  for (const syntax::Argument& a : e.arguments) {
    const Variable* v = match(a, a.name.empty() ? position++ : 0, unit, with_outputs);
    if (v == nullptr && !a.name.empty()) {
      std::vector<std::string> names;
      for (const Variable& w : u.variables)
        if (a.output ? w.section == Section::output
                     : w.section == Section::input || w.section == Section::in_out)
          names.push_back(w.name);
      report_.error(
          a.location, texts::kNoParameter,
          {u.source->name, a.output ? "VAR_OUTPUT" : "VAR_INPUT", a.name, syntax::suggestion(a.name, names)});
    }
    if (v != nullptr && !given.insert(v).second) report_.error(a.location, texts::kTwice, {v->name});
    matched.push_back(v);
  }
  if (positional > 0 && named > 0) report_.error(e.location, texts::kMixed);
  if (!with_outputs && positional > 0 &&
      (positional > inputs_known || (named == 0 && positional < inputs_known)))
    report_.error(e.location, texts::kCount,
                  {u.source->name, std::to_string(inputs_known), std::to_string(positional)});
  for (const Variable& v : u.variables)
    if (v.bound() && !given.contains(&v) && report_.errors() == errors)
      report_.error(e.location, v.section == Section::input ? texts::kInputMissing : texts::kInOutMissing,
                    {u.source->name, v.name});
  return report_.errors() == errors;
}

// The variable that a parameter is bound to.
std::optional<ir::Place> Analyzer::bound_argument(const syntax::Argument& a, const Variable& v) {
  const bool input = v.section == Section::input;
  auto target = place(*a.value, !input);
  if (!target) return target;
  if (target->bit >= 0) {
    report_.error(a.location, texts::kBitReference);
    return std::nullopt;
  }
  if (!binds(*target->type, *v.type)) {
    report_.error(a.value->location, input ? texts::kInputType : texts::kInOutType,
                  {v.name, v.type->name, target->type->name});
    return std::nullopt;
  }
  constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  for (const Type* t = target->type; v.type->open && t->kind == Kind::array && !t->open; t = t->base)
    if (t->range.low < kLeast || t->range.high > kMost) {  // LOWER_BOUND is a DINT
      report_.error(a.value->location, texts::kOpenLimits, {v.name, target->type->name});
      return std::nullopt;
    }
  if (target->root == ir::Root::shared) program_.places[target->cell].referenced = true;
  return target;
}

// The limits of an array that is bound to an ARRAY[*]: those it was given itself, or constants in memory.
ir::Place Analyzer::actual_limits(const ir::Place& array) {
  if (array.type->open) return limits_of(array);
  ir::Place out;
  out.type = limits_type();
  const auto known = limits_.find(array.type);
  if (known != limits_.end()) {
    out.cell = known->second;
    return out;
  }
  std::vector<ir::Limits> all;
  for (const Type* t = array.type; t->kind == Kind::array; t = t->base)
    all.push_back({t->range.low, t->range.high, t->base->size});
  const Type* block = types_->array(limits_type(), {1, static_cast<std::int64_t>(all.size())});
  out.cell = limits_[array.type] = allocate(*block);
  std::memcpy(program_.memory.data() + out.cell, all.data(), all.size() * sizeof(ir::Limits));
  return out;
}

ir::Parameter Analyzer::limits_parameter(const Variable& v, const ir::Place& actual) {
  ir::Parameter p;
  p.offset = v.cell + 4;
  p.type = limits_type();
  p.section = v.section;
  p.place = actual_limits(actual);
  return p;
}

ExprPtr Analyzer::truth(const Location& at) {
  Constant one;
  one.i = 1;
  return make_constant(elementary(Kind::boolean), one, at);
}

// What an input begins with; of a structure or an array a copy that nothing writes.
ExprPtr Analyzer::initial_value(const Variable& v, int unit, const Location& at) {
  std::vector<std::uint8_t> bytes = v.initial.empty() ? v.type->image : v.initial;
  bytes.resize(v.type->size);
  if (is_elementary(v.type->kind)) return make_constant(v.type, stored_constant(*v.type, bytes.data()), at);
  const auto [known, fresh] = initial_values_.try_emplace({unit, v.cell}, 0);
  if (fresh) {
    known->second = allocate(*v.type);
    std::copy(bytes.begin(), bytes.end(), program_.memory.begin() + known->second);
  }
  ir::Place p;
  p.cell = known->second;
  p.type = v.type;
  return load(std::move(p), at);
}

ExprPtr Analyzer::function_call(const Expression& e, int unit) {
  lay_out(unit);
  if (current_ >= 0) here().calls.insert(unit);
  UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  std::vector<const Variable*> matched;
  if (!check_arguments(e, unit, matched)) return bad(e.location);
  ExprPtr out = node(ExprKind::call, u.result, e.location);
  out->unit = unit;
  bool good = true;
  for (std::size_t i = 0; i < e.arguments.size(); ++i) {
    const syntax::Argument& a = e.arguments[i];
    const Variable& v = *matched[i];
    ir::Parameter p;
    p.offset = v.cell;
    p.type = v.type;
    p.section = v.section;
    if (v.bound()) {
      auto target = bound_argument(a, v);
      good = good && target;
      if (!target) continue;
      if (v.type->open) out->parameters.push_back(limits_parameter(v, *target));
      p.place = std::move(*target);
    } else if (v.section == Section::input) {
      p.value = assignable(expression(*a.value, v.type), v.type);
      good = good && p.value->type->kind != Kind::error;
    } else if (a.value) {
      auto target = inverts(a, *v.type) ? place(*a.value, true) : std::nullopt;
      // Outputs of the standard's functions are ANY_INT: a value that does not fit is a fault.
      const bool any = u.from_library && target && is_integer(target->type->kind) && !target->type->bounded &&
                       is_integer(v.type->kind);
      if (target && !any && !takes_output(*target->type, *v.type)) {
        report_.error(a.value->location, texts::kOutputType, {v.name, v.type->name, target->type->name});
        target.reset();
      }
      good = good && target;
      p.inverted = a.inverted;
      if (target) p.place = std::move(*target);
    } else {
      continue;
    }
    out->parameters.push_back(std::move(p));
  }
  const std::set<const Variable*> given(matched.begin(), matched.end());
  for (const Variable& v : u.variables) {  // inputs that are not given take their initial value
    if (v.section != Section::input || v.bound() || v.type->kind == Kind::error || given.contains(&v))
      continue;
    ir::Parameter p;
    p.offset = v.cell;
    p.type = v.type;
    p.value = is_enable(v) ? truth(e.location) : initial_value(v, unit, e.location);
    out->parameters.push_back(std::move(p));
  }
  if (!good) return bad(e.location);
  if (u.result_variable >= 0) out->result = u.variables[static_cast<std::size_t>(u.result_variable)].cell;
  return out;
}

// NOT before an output needs one that NOT applies to.
bool Analyzer::inverts(const syntax::Argument& a, const Type& output) {
  const Kind k = output.kind;
  const bool good = !a.inverted || k == Kind::boolean || is_bits(k) || is_integer(k) || k == Kind::error;
  if (!good) report_.error(a.location, texts::kOperand, {"NOT", output.name});
  return good;
}

void Analyzer::output_argument(const syntax::Argument& a, const ir::Place& from, ir::Block& out) {
  if (!a.value || !inverts(a, *from.type)) return;
  auto target = place(*a.value, true);
  if (!target) return;
  ExprPtr value = load(from.copy(), a.location);
  if (a.inverted) {
    ExprPtr inverse = node(ExprKind::unary, value->type, a.location);
    inverse->op = Op::not_;
    inverse->args.push_back(std::move(value));
    value = std::move(inverse);
  }
  value->at = a.value->location;
  assign(std::move(*target), std::move(value), a.location, out);
}

bool Analyzer::axis_of_programs(const Expression& e, const Type& wanted) {
  bool global = false;
  const bool letter = e.kind == ExpressionKind::name && same_name(wanted.name, "AXIS_REF") &&
                      find_variable(e.name, global) == nullptr &&
                      symbol(e.name + ".home_switch") != nullptr && symbol(e.name + ".mc_taken") == nullptr;
  if (letter) report_.error(e.location, texts::kNotAuxiliary, {e.name});
  return letter;
}

void Analyzer::block_input(const syntax::Argument& a, const Variable& v, const ir::Place& instance,
                           ir::Block& out) {
  ir::Place formal = instance.copy();
  formal.offset += v.cell;
  formal.type = v.type;
  if (!v.bound()) {
    assign(std::move(formal), expression(*a.value, v.type), a.location, out);
    return;
  }
  if (axis_of_programs(*a.value, *v.type)) return;
  auto target = bound_argument(a, v);
  if (!target) return;
  formal.type = elementary(Kind::udint);
  const auto bind = [&](ir::Place cell, ir::Place to) {
    ir::Stmt s;
    s.kind = ir::StmtKind::bind;
    s.at = a.location;
    s.reads = v.section == Section::input;
    s.place = std::move(cell);
    s.other = std::move(to);
    out.push_back(std::move(s));
  };
  if (v.type->open) {
    ir::Place limits = formal.copy();
    limits.offset += 4;
    bind(std::move(limits), actual_limits(*target));
  }
  bind(std::move(formal), std::move(*target));
}

// What ENO gets after the call: the output of that name where the unit declares one, else TRUE.
ExprPtr Analyzer::enabled_value(const Expression& e) {
  ExprPtr yes = truth(e.enabled->location);
  const Expression& callee = *e.operands[0];
  bool global = false;
  const Variable* v = callee.kind == ExpressionKind::name ? find_variable(callee.name, global) : nullptr;
  const int unit = unit_named(callee.name);
  const bool function = callee.kind == ExpressionKind::name && v == nullptr && unit >= 0;
  ir::Place from;
  int index = -1;
  if (function) {
    index = unit;
    from.cell = static_cast<std::uint32_t>(
        std::max<std::int64_t>(0, program_.units[static_cast<std::size_t>(index)].fixed_base));
  } else if (callee.kind != ExpressionKind::name || v != nullptr) {
    auto instance = place(callee, false);
    if (!instance || instance->type->kind != Kind::block) return yes;
    index = instance->type->block;
    from = std::move(*instance);
  }
  if (index < 0) return yes;
  const UnitScope& u = scopes_[static_cast<std::size_t>(index)];
  const auto eno = u.by_name.find("ENO");
  if (eno == u.by_name.end() || u.variables[eno->second].section != Section::output) return yes;
  from.offset += u.variables[eno->second].cell;
  from.type = u.variables[eno->second].type;
  return load(std::move(from), e.enabled->location);
}

// EN and ENO (6.6.1.5): with EN false nothing is called, assigned or stored, and ENO is false.
bool Analyzer::guarded(const syntax::Statement& s, ir::Block& out) {
  if (s.value == nullptr || s.value->kind != ExpressionKind::call || guarded_ == s.value.get()) return false;
  const Expression& e = *s.value;
  if (!e.enable && !e.enabled) return false;
  const Expression* outer = guarded_;
  guarded_ = &e;
  ir::Stmt test;
  test.kind = ir::StmtKind::if_;
  test.at = s.location;
  ir::Branch yes;
  yes.condition = e.enable ? condition(*e.enable) : truth(s.location);
  statement(s, yes.body);
  guarded_ = outer;
  if (e.enabled) {
    auto first = place(*e.enabled, true), second = place(*e.enabled, true);
    if (first && second) {
      ExprPtr done = enabled_value(e);
      Constant otherwise;
      otherwise.i = e.enabled_inverted;
      if (e.enabled_inverted) {
        ExprPtr inverse = node(ExprKind::unary, done->type, e.enabled->location);
        inverse->op = Op::not_;
        inverse->args.push_back(std::move(done));
        done = fold(std::move(inverse));
      }
      assign(std::move(*first), std::move(done), e.enabled->location, yes.body);
      assign(std::move(*second), make_constant(elementary(Kind::boolean), otherwise, e.enabled->location),
             e.enabled->location, test.body);
    }
  }
  test.branches.push_back(std::move(yes));
  out.push_back(std::move(test));
  return true;
}

// An editor names a block twice, by its type and by its instance; both have to say the same. A name of a
// library may stand before that of the type.
bool Analyzer::drawn_as(const Expression& e, const Type& instance) {
  const std::string name = e.name.substr(e.name.rfind('.') + 1);
  if (name.empty() || same_name(name, instance.name)) return true;
  const UnitScope& u = scopes_[static_cast<std::size_t>(instance.block)];
  if (same_name(name, u.source->name)) return true;
  const auto declared = declared_types_.find(key_of(name));
  if (declared != declared_types_.end() && resolve_declared(declared->second)->block == instance.block)
    return true;
  std::string shown;
  if (!dotted_symbol(*e.operands[0], shown)) shown = "(...)";
  report_.error(e.location, texts::kBlockType, {name, shown, instance.name});
  return false;
}

void Analyzer::block_call(const Expression& e, const ir::Place& named, int unit, ir::Block& out) {
  if (current_ >= 0) here().calls.insert(unit);
  std::vector<const Variable*> matched;
  if (!check_arguments(e, unit, matched)) return;
  if (named.root == ir::Root::instance && !named.computed())
    called_.insert({current_, named.cell + named.offset});
  ir::Place instance = named.copy();
  if (named.computed()) {  // subscripts and references are computed once, whatever the call changes
    ir::Stmt choose;
    choose.kind = ir::StmtKind::bind;
    choose.at = e.location;
    choose.place.cell = allocate(*elementary(Kind::udint));
    choose.place.type = elementary(Kind::udint);
    instance = {};
    instance.root = ir::Root::pointer;
    instance.cell = choose.place.cell;
    instance.type = named.type;
    choose.other = named.copy();
    out.push_back(std::move(choose));
  }
  for (std::size_t i = 0; i < e.arguments.size(); ++i)
    if (matched[i]->section != Section::output) block_input(e.arguments[i], *matched[i], instance, out);
  for (const Variable& v : scopes_[static_cast<std::size_t>(unit)].variables) {
    if (v.section != Section::input || !is_enable(v)) continue;
    ir::Place enable = instance.copy();
    enable.offset += v.cell;
    enable.type = v.type;
    assign(std::move(enable), truth(e.location), e.location, out);
  }
  ir::Stmt invoke;
  invoke.kind = ir::StmtKind::invoke;
  invoke.at = e.location;
  invoke.place = instance.copy();
  invoke.unit = unit;
  out.push_back(std::move(invoke));
  for (std::size_t i = 0; i < e.arguments.size(); ++i) {
    if (matched[i]->section != Section::output) continue;
    ir::Place from = instance.copy();
    from.offset += matched[i]->cell;
    from.type = matched[i]->type;
    output_argument(e.arguments[i], from, out);
  }
}

}  // namespace servogate::plc::sema
