// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using ir::ExprKind;

namespace {

bool listed(std::string_view key, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), key) != names.end();
}
struct RealFunction {
  std::string_view name;
  Native native;
};
constexpr RealFunction kReal[] = {{"SQRT", Native::sqrt}, {"LN", Native::ln},     {"LOG", Native::log},
                                  {"EXP", Native::exp},   {"SIN", Native::sin},   {"COS", Native::cos},
                                  {"TAN", Native::tan},   {"ASIN", Native::asin}, {"ACOS", Native::acos},
                                  {"ATAN", Native::atan}};
struct OperatorFunction {
  std::string_view name;
  Op op;
  bool extensible;
};
constexpr OperatorFunction kOperators[] = {
    {"ADD", Op::add, true},  {"MUL", Op::mul, true},  {"SUB", Op::sub, false}, {"DIV", Op::div, false},
    {"MOD", Op::mod, false}, {"AND", Op::and_, true}, {"OR", Op::or_, true},   {"XOR", Op::xor_, true},
    {"GT", Op::gt, true},    {"GE", Op::ge, true},    {"EQ", Op::eq, true},    {"LE", Op::le, true},
    {"LT", Op::lt, true},    {"NE", Op::ne, false},   {"MAX", Op::max, true},  {"MIN", Op::min, true},
};
struct TimeFunction {
  std::string_view name;
  Op op;
};
constexpr TimeFunction kTimes[] = {
    {"ADD_TIME", Op::add},      {"ADD_LTIME", Op::add},       {"ADD_TOD_TIME", Op::add},
    {"ADD_DT_TIME", Op::add},   {"SUB_TIME", Op::sub},        {"SUB_LTIME", Op::sub},
    {"SUB_DATE_DATE", Op::sub}, {"SUB_TOD_TIME", Op::sub},    {"SUB_TOD_TOD", Op::sub},
    {"SUB_DT_TIME", Op::sub},   {"SUB_DT_DT", Op::sub},       {"MUL_TIME", Op::mul},
    {"MULTIME", Op::mul},       {"MUL_LTIME", Op::mul},       {"DIV_TIME", Op::div},
    {"DIVTIME", Op::div},       {"DIV_LTIME", Op::div},       {"ADD_LTOD_LTIME", Op::add},
    {"ADD_LDT_LTIME", Op::add}, {"SUB_LDATE_LDATE", Op::sub}, {"SUB_LTOD_LTIME", Op::sub},
    {"SUB_LTOD_LTOD", Op::sub}, {"SUB_LDT_LTIME", Op::sub},   {"SUB_LDT_LDT", Op::sub},
};
// TO_BIG_ENDIAN and its like (table 38): a number here lies with its low byte first.
struct OrderFunction {
  std::string_view name;
  bool turns;
};
constexpr OrderFunction kOrders[] = {{"TO_BIG_ENDIAN", true},
                                     {"BIG_ENDIAN_TO", true},
                                     {"TO_LITTLE_ENDIAN", false},
                                     {"LITTLE_ENDIAN_TO", false}};

bool any_elementary(Kind k) { return is_elementary(k); }

}  // namespace

bool Analyzer::is_standard(std::string_view key) const {
  for (const auto& f : kReal)
    if (f.name == key) return true;
  for (const auto& f : kOperators)
    if (f.name == key) return true;
  for (const auto& f : kTimes)
    if (f.name == key) return true;
  for (const auto& f : kOrders)
    if (f.name == key) return true;
  return listed(key, {"ABS",
                      "ATAN2",
                      "EXPT",
                      "MOVE",
                      "NOT",
                      "SEL",
                      "LIMIT",
                      "MUX",
                      "SHL",
                      "SHR",
                      "ROL",
                      "ROR",
                      "LEN",
                      "LEFT",
                      "RIGHT",
                      "MID",
                      "CONCAT",
                      "INSERT",
                      "DELETE",
                      "REPLACE",
                      "FIND",
                      "TIME",
                      "LTIME",
                      "CONCAT_DATE_TOD",
                      "CONCAT_DATE_LTOD",
                      "LOWER_BOUND",
                      "UPPER_BOUND"}) ||
         conversion_name(key);
}

// The actual inputs in the order of the formal ones. Extensible functions take IN1, IN2 ... without names.
std::vector<const Expression*> Analyzer::inputs(const Expression& e, std::string_view name,
                                                std::initializer_list<const char*> names, std::size_t least,
                                                std::size_t most) {
  std::vector<const Expression*> out;
  const bool named = !e.arguments.empty() && !e.arguments[0].name.empty();
  if (std::any_of(e.arguments.begin(), e.arguments.end(),
                  [&](const syntax::Argument& a) { return !a.output && a.name.empty() == named; })) {
    report_.error(e.location, texts::kMixed);
    return out;
  }
  if (e.arguments.size() < least || e.arguments.size() > most) {
    report_.error(e.location, texts::kCount,
                  {std::string(name), least == most ? std::to_string(least) : std::to_string(least) + "+",
                   std::to_string(e.arguments.size())});
    return out;
  }
  if (named && names.size() == e.arguments.size()) {
    for (const char* formal : names) {
      const auto at = std::find_if(e.arguments.begin(), e.arguments.end(),
                                   [&](const syntax::Argument& a) { return same_name(a.name, formal); });
      if (at == e.arguments.end() || at->output) {
        report_.error(e.location, texts::kExpected,
                      {"'" + std::string(formal) + " :='", "'" + e.arguments[0].name + "'"});
        return {};
      }
      out.push_back(at->value.get());
    }
    return out;
  }
  if (named && names.size() == 0) return numbered_inputs(e, name);
  for (const syntax::Argument& a : e.arguments) {
    if (!a.value || a.output) {
      report_.error(a.location, texts::kNoParameter, {std::string(name), "VAR_OUTPUT", a.name, ""});
      return {};
    }
    out.push_back(a.value.get());
  }
  return out;
}

// IN1, IN2 ... of an extensible function in any order; MUX counts from IN0 and has K before them.
std::vector<const Expression*> Analyzer::numbered_inputs(const Expression& e, std::string_view name) {
  const bool mux = name == "MUX";
  std::vector<const Expression*> out(e.arguments.size());
  for (const syntax::Argument& a : e.arguments) {
    const std::string key = key_of(a.name);
    std::size_t at = out.size();
    if (mux && key == "K") {
      at = 0;
    } else if (key.size() > 2 && key.size() < 6 && key.starts_with("IN") &&
               key.find_first_not_of("0123456789", 2) == std::string::npos) {
      const std::size_t number = std::stoul(key.substr(2));
      at = mux ? number + 1 : number - 1;
    }
    if (a.output || at >= out.size()) {
      report_.error(a.location, texts::kNoParameter,
                    {std::string(name), a.output ? "VAR_OUTPUT" : "VAR_INPUT", a.name, ""});
      return {};
    }
    if (out[at] != nullptr) {
      report_.error(a.location, texts::kTwice, {a.name});
      return {};
    }
    out[at] = a.value.get();
  }
  return out;
}

std::vector<ExprPtr> Analyzer::typed_inputs(const std::vector<const Expression*>& in,
                                            const std::vector<const Type*>& types) {
  std::vector<ExprPtr> out;
  const Type* text = nullptr;
  bool good = true;
  auto type = types.begin();
  for (const Expression* e : in) {
    const Type* t = *type++;
    ExprPtr value = expression(*e, t);
    if (t->kind == Kind::string) {  // ANY_STRING: the first text decides
      if (text == nullptr && value->type->kind != Kind::error)
        text = elementary(is_wide(value->type->kind) ? Kind::wide_string : Kind::string);
      if (text != nullptr) t = text;
    }
    if (!is_text(t->kind) || value->type->kind != t->kind) value = assignable(std::move(value), t);
    good = good && value->type->kind != Kind::error;
    out.push_back(std::move(value));
  }
  if (!good) out.clear();
  return out;
}

std::vector<ExprPtr> Analyzer::common_inputs(const std::vector<const Expression*>& in, std::string_view name,
                                             const Type* hint, bool (*accepts)(Kind), const char* wanted) {
  std::vector<ExprPtr> out;
  const Type* common = nullptr;
  for (const Expression* e : in) {
    ExprPtr v = expression(*e, common != nullptr && !common->values.empty() ? common : hint);
    if (v->type->kind == Kind::error) return {};
    const Type* with = common == nullptr   ? v->type
                       : v->type == common ? common
                       : is_elementary(v->type->kind) && is_elementary(common->kind)
                           ? types_->common(*common, *v->type)
                           : nullptr;
    if (with == nullptr) {
      report_.error(v->at, texts::kOperands, {std::string(name), common->name, v->type->name});
      return {};
    }
    common = with;
    out.push_back(std::move(v));
  }
  if (common != nullptr && is_untyped(common->kind)) {
    const bool usable =
        hint != nullptr && (common->kind == Kind::untyped_int ? is_number(hint->kind) || is_bits(hint->kind)
                                                              : is_real(hint->kind));
    common = usable ? (hint->bounded ? hint->base : hint)
                    : elementary(common->kind == Kind::untyped_int ? Kind::dint : Kind::lreal);
  }
  if (common != nullptr && !accepts(common->kind)) {
    report_.error(in[0]->location, texts::kMismatch, {wanted, common->name, ""});
    return {};
  }
  for (ExprPtr& v : out) {
    v = convert(std::move(v), common);
    if (v->type->kind == Kind::error) return {};
  }
  return out;
}

ExprPtr Analyzer::standard_call(const Expression& e, std::string_view key, const Type* hint) {
  if (conversion_name(key)) return conversion_call(key, e);
  if (listed(key, {"SEL", "LIMIT", "MUX", "MOVE"})) return selection_call(key, e, hint);
  if (listed(key, {"SHL", "SHR", "ROL", "ROR"})) return shift_call(key, e, hint);
  if (listed(key, {"LEN", "LEFT", "RIGHT", "MID", "CONCAT", "INSERT", "DELETE", "REPLACE", "FIND"}))
    return text_call(key, e);
  for (const auto& f : kTimes)
    if (f.name == key) return time_call(key, e);
  if (listed(key, {"TIME", "LTIME", "CONCAT_DATE_TOD", "CONCAT_DATE_LTOD"})) return time_call(key, e);
  if (key == "LOWER_BOUND" || key == "UPPER_BOUND") return bound_call(key, e);
  for (const auto& f : kOrders)
    if (f.name == key) return order_call(key, e, hint, f.turns);
  for (const auto& f : kOperators)
    if (f.name == key) return operator_call(key, e, hint);
  return numeric_call(key, e, hint);
}

ExprPtr Analyzer::numeric_call(std::string_view key, const Expression& e, const Type* hint) {
  if (key == "EXPT" || key == "ATAN2") {
    const auto in = key == "EXPT" ? inputs(e, key, {"IN1", "IN2"}, 2, 2) : inputs(e, key, {"Y", "X"}, 2, 2);
    if (in.empty()) return bad(e.location);
    if (key == "EXPT") {
      ExprPtr a = settle(expression(*in[0], hint), hint != nullptr && is_real(hint->kind) ? hint : nullptr);
      return power(std::move(a), expression(*in[1], hint), e.location);
    }
    auto args = common_inputs(in, key, hint, is_real, "ANY_REAL");
    if (args.empty()) return bad(e.location);
    const Type* t = args[0]->type;
    return native(Native::atan2, t, e.location, std::move(args));
  }
  const auto in = inputs(e, key, {"IN"}, 1, 1);
  if (in.empty()) return bad(e.location);
  if (key == "ABS") {
    auto args = common_inputs(in, key, hint, is_number, "ANY_NUM");
    if (args.empty()) return bad(e.location);
    ExprPtr out = node(ExprKind::unary, args[0]->type, e.location);
    out->op = Op::abs;
    out->args = std::move(args);
    return fold(std::move(out));
  }
  if (key == "NOT") return unary(syntax::Operator::not_, expression(*in[0], hint), e, hint);
  ExprPtr value = settle(expression(*in[0], hint),
                         hint != nullptr && is_real(hint->kind) ? hint : elementary(Kind::lreal));
  if (value->type->kind == Kind::error) return value;
  if (is_integer(value->type->kind)) {
    const Type* real = elementary(
        conversion(*value->type, *elementary(Kind::real)) == Conversion::widening ? Kind::real : Kind::lreal);
    value = convert(std::move(value), real);
  }
  if (!is_real(value->type->kind)) {
    report_.error(value->at, texts::kMismatch, {"ANY_REAL", value->type->name, ""});
    return bad(e.location);
  }
  const auto* f =
      std::find_if(std::begin(kReal), std::end(kReal), [&](const RealFunction& r) { return r.name == key; });
  const Type* t = value->type;
  std::vector<ExprPtr> args;
  args.push_back(std::move(value));
  return native(f->native, t, e.location, std::move(args));
}

// Stands for `e` as often as it is copied; what must not be computed again goes to `kept`.
ExprPtr Analyzer::once(ExprPtr e, Kept& kept) {
  if (e->kind == ExprKind::constant || e->type->kind == Kind::error) return e;
  ExprPtr stands = node(ExprKind::kept, e->type, e->at);
  stands->value.i = ++lets_;
  kept.emplace_back(lets_, std::move(e));
  return stands;
}

ExprPtr Analyzer::around(ExprPtr e, Kept kept) {
  if (e->type->kind == Kind::error) return e;
  while (!kept.empty()) {
    ExprPtr let = node(ExprKind::let, e->type, e->at);
    let->value.i = kept.back().first;
    let->args.push_back(std::move(kept.back().second));
    let->args.push_back(std::move(e));
    e = std::move(let);
    kept.pop_back();
  }
  return e;
}

ExprPtr Analyzer::chain(Op op, std::vector<ExprPtr> args, const Location& at, std::string_view shown) {
  if (args.empty()) return bad(at);
  if (op >= Op::eq && op <= Op::ge) {  // GT(a, b, c) is (a > b) AND (b > c), each computed once
    Kept kept;
    if (args.size() > 2)
      for (ExprPtr& a : args) a = once(std::move(a), kept);
    ExprPtr all;
    for (std::size_t i = 0; i + 1 < args.size(); ++i) {
      ExprPtr pair = combine(op, args[i]->copy(), args[i + 1]->copy(), at, shown);
      all = all ? combine(Op::and_, std::move(all), std::move(pair), at, "AND") : std::move(pair);
    }
    return around(std::move(all), std::move(kept));
  }
  ExprPtr out = std::move(args[0]);
  for (std::size_t i = 1; i < args.size(); ++i)
    out = combine(op, std::move(out), std::move(args[i]), at, shown);
  return out;
}

ExprPtr Analyzer::operator_call(std::string_view key, const Expression& e, const Type* hint) {
  const auto* f = std::find_if(std::begin(kOperators), std::end(kOperators),
                               [&](const OperatorFunction& o) { return o.name == key; });
  const auto in = f->extensible ? inputs(e, key, {}, 2, 100) : inputs(e, key, {"IN1", "IN2"}, 2, 2);
  if (in.empty()) return bad(e.location);
  if (f->op == Op::min || f->op == Op::max) {
    auto args = common_inputs(in, key, hint, any_elementary, "ANY_ELEMENTARY");
    if (args.empty()) return bad(e.location);
    ExprPtr out = std::move(args[0]);
    for (std::size_t i = 1; i < args.size(); ++i) {
      ExprPtr pair = node(ExprKind::binary, out->type, e.location);
      pair->op = f->op;
      pair->args.push_back(std::move(out));
      pair->args.push_back(std::move(args[i]));
      out = fold(std::move(pair));
    }
    return out;
  }
  std::vector<ExprPtr> args;
  for (const Expression* i : in)
    args.push_back(expression(*i, f->op >= Op::eq && f->op <= Op::ge ? nullptr : hint));
  return chain(f->op, std::move(args), e.location, key);
}

ExprPtr Analyzer::order_call(std::string_view key, const Expression& e, const Type* hint, bool turns) {
  const auto in = inputs(e, key, {"IN"}, 1, 1);
  if (in.empty()) return bad(e.location);
  ExprPtr value = settle(expression(*in[0], hint), hint);
  const Type* t = value->type;
  if (t->kind == Kind::error) return value;
  if (!is_elementary(t->kind) || is_text(t->kind) || t->kind == Kind::enumeration) {
    report_.error(in[0]->location, texts::kMismatch, {"ANY_ELEMENTARY", t->name, ""});
    return bad(e.location);
  }
  if (!turns || t->size == 1) return value;
  std::vector<ExprPtr> args;
  args.push_back(std::move(value));
  return native(Native::turn_bytes, t, e.location, std::move(args));
}

ExprPtr Analyzer::selection_call(std::string_view key, const Expression& e, const Type* hint) {
  if (key == "MOVE") {
    const auto in = inputs(e, key, {"IN"}, 1, 1);
    return in.empty() ? bad(e.location) : expression(*in[0], hint);
  }
  if (key == "LIMIT") {
    const auto in = inputs(e, key, {"MN", "IN", "MX"}, 3, 3);
    auto args =
        in.empty() ? std::vector<ExprPtr>{} : common_inputs(in, key, hint, any_elementary, "ANY_ELEMENTARY");
    if (args.empty()) return bad(e.location);
    const Type* t = args[0]->type;
    ExprPtr low = node(ExprKind::binary, t, e.location), out = node(ExprKind::binary, t, e.location);
    // MIN(MAX(IN, MN), MX) (table 32), but MN is computed before IN.
    Kept kept;
    ExprPtr least = args[1]->kind == ExprKind::constant ? std::move(args[0]) : once(std::move(args[0]), kept);
    low->op = Op::max;
    low->args.push_back(std::move(args[1]));
    low->args.push_back(std::move(least));
    out->op = Op::min;
    out->args.push_back(fold(std::move(low)));
    out->args.push_back(std::move(args[2]));
    return around(fold(std::move(out)), std::move(kept));
  }
  const bool sel = key == "SEL";
  auto in = sel ? inputs(e, key, {"G", "IN0", "IN1"}, 3, 3) : inputs(e, key, {}, 3, 100);
  if (in.empty()) return bad(e.location);
  const Type* selector_type = elementary(sel ? Kind::boolean : Kind::lint);
  ExprPtr selector = expression(*in[0], selector_type);
  if (!sel && is_bits(selector->type->kind))
    selector = explicit_conversion(std::move(selector), selector_type, false, e.location);
  selector = assignable(std::move(selector), selector_type);
  in.erase(in.begin());
  auto args = common_inputs(in, key, hint, any_elementary, "ANY_ELEMENTARY");
  if (args.empty() || selector->type->kind == Kind::error) return bad(e.location);
  const Type* t = args[0]->type;
  if (sel) {
    ExprPtr out = node(ExprKind::choose, t, e.location);
    out->args.push_back(std::move(selector));
    out->args.push_back(std::move(args[1]));
    out->args.push_back(std::move(args[0]));
    return out;
  }
  Kept kept;
  selector = once(std::move(selector), kept);
  ExprPtr out = native(Native::select_fault, t, e.location, {});
  for (std::size_t i = args.size(); i-- > 0;) {
    ExprPtr choice = node(ExprKind::choose, t, e.location);
    Constant c;
    c.i = static_cast<std::int64_t>(i);
    choice->args.push_back(combine(Op::eq, selector->copy(),
                                   make_constant(elementary(Kind::lint), c, e.location), e.location, "="));
    choice->args.push_back(std::move(args[i]));
    choice->args.push_back(std::move(out));
    out = std::move(choice);
  }
  return around(std::move(out), std::move(kept));
}

ExprPtr Analyzer::shift_call(std::string_view key, const Expression& e, const Type* hint) {
  const auto in = inputs(e, key, {"IN", "N"}, 2, 2);
  if (in.empty()) return bad(e.location);
  ExprPtr value = expression(*in[0], hint);
  if (value->type->kind == Kind::untyped_int)
    value =
        convert(std::move(value), hint != nullptr && is_bits(hint->kind) ? hint : elementary(Kind::dword));
  ExprPtr n = assignable(settle(expression(*in[1], elementary(Kind::lint)), elementary(Kind::lint)),
                         elementary(Kind::lint));
  if (value->type->kind == Kind::error || n->type->kind == Kind::error) return bad(e.location);
  if (!is_bits(value->type->kind) && !is_integer(value->type->kind)) {
    report_.error(value->at, texts::kMismatch, {"ANY_BIT", value->type->name, ""});
    return bad(e.location);
  }
  if (!is_bits(value->type->kind)) {
    constexpr const char* kSame[] = {"BYTE", "WORD", "DWORD", "LWORD"};
    const std::uint32_t size = cell_size(cell_of(*value->type));
    report_.warning(value->at, texts::kShiftNumber,
                    {std::string(key), value->type->name, kSame[size == 8 ? 3 : size / 2]});
  }
  const Native which = key == "SHL"   ? Native::shl
                       : key == "SHR" ? Native::shr
                       : key == "ROL" ? Native::rol
                                      : Native::ror;
  const Type* t = value->type;
  std::vector<ExprPtr> args;
  args.push_back(std::move(value));
  args.push_back(std::move(n));
  return native(which, t, e.location, std::move(args));
}

ExprPtr Analyzer::text_call(std::string_view key, const Expression& e) {
  const Type* s = elementary(Kind::string);
  const Type* n = elementary(Kind::lint);
  std::vector<ExprPtr> args;
  Native which = Native::length;
  const Type* result = s;
  const auto take = [&](Native native_function, const std::vector<const Expression*>& in,
                        const std::vector<const Type*>& types) {
    which = native_function;
    if (!in.empty()) args = typed_inputs(in, types);
  };
  if (key == "LEN") {
    take(Native::length, inputs(e, key, {"IN"}, 1, 1), {s});
    result = elementary(Kind::int_);
  } else if (key == "LEFT" || key == "RIGHT") {
    take(key == "LEFT" ? Native::left : Native::right, inputs(e, key, {"IN", "L"}, 2, 2), {s, n});
  } else if (key == "MID") {
    take(Native::mid, inputs(e, key, {"IN", "L", "P"}, 3, 3), {s, n, n});
  } else if (key == "INSERT") {
    take(Native::insert, inputs(e, key, {"IN1", "IN2", "P"}, 3, 3), {s, s, n});
  } else if (key == "DELETE") {
    take(Native::remove, inputs(e, key, {"IN", "L", "P"}, 3, 3), {s, n, n});
  } else if (key == "REPLACE") {
    take(Native::replace, inputs(e, key, {"IN1", "IN2", "L", "P"}, 4, 4), {s, s, n, n});
  } else if (key == "FIND") {
    take(Native::find, inputs(e, key, {"IN1", "IN2"}, 2, 2), {s, s});
    result = elementary(Kind::int_);
  } else {
    const auto in = inputs(e, key, {}, 2, 100);
    take(Native::concat, in, std::vector<const Type*>(in.size(), s));
  }
  if (args.empty()) return bad(e.location);
  if (result == s) result = types_->string(kMaxStringCapacity, args[0]->type->kind);
  if (which != Native::concat) return native(which, result, e.location, std::move(args));
  ExprPtr out = std::move(args[0]);
  for (std::size_t i = 1; i < args.size(); ++i) {
    std::vector<ExprPtr> two;
    two.push_back(std::move(out));
    two.push_back(std::move(args[i]));
    out = native(Native::concat, result, e.location, std::move(two));
  }
  return out;
}

// Limits of an array: constants, but of an ARRAY[*] those of the actual one (IEC 61131-3:2013, 6.5.3.4).
ExprPtr Analyzer::bound_call(std::string_view key, const Expression& e) {
  const auto in = inputs(e, key, {"ARR", "DIM"}, 2, 2);
  if (in.empty()) return bad(e.location);
  const auto array = place(*in[0], false);
  const auto dimension = constant_integer(*in[1]);
  if (!array || !dimension) return bad(e.location);
  const Type* t = array->type;
  std::int64_t open = 0;
  for (std::int64_t i = 1; i < *dimension && t->kind == Kind::array; ++i, t = t->base) open += t->open;
  if (t->kind != Kind::array || *dimension < 1) {
    report_.error(in[0]->location, texts::kNotArray, {t->name});
    return bad(e.location);
  }
  if (t->open) {
    ir::Place limit = limits_of(*array);
    limit.offset += static_cast<std::uint32_t>(open * static_cast<std::int64_t>(sizeof(ir::Limits)));
    if (key != "LOWER_BOUND") limit.offset += offsetof(ir::Limits, high);
    limit.type = elementary(Kind::lint);
    return convert(load(std::move(limit), e.location), elementary(Kind::dint));
  }
  Constant c;
  c.i = key == "LOWER_BOUND" ? t->range.low : t->range.high;
  return make_constant(elementary(Kind::untyped_int), c, e.location);  // ANY_INT, as a literal
}

ExprPtr Analyzer::time_call(std::string_view key, const Expression& e) {
  if (key == "TIME" || key == "LTIME") {
    if (!e.arguments.empty())
      report_.error(e.location, texts::kCount, {"TIME", "0", std::to_string(e.arguments.size())});
    return native(Native::now, elementary(Kind::time), e.location, {});
  }
  const auto in = inputs(e, key, {"IN1", "IN2"}, 2, 2);
  if (in.empty()) return bad(e.location);
  if (key == "CONCAT_DATE_TOD" || key == "CONCAT_DATE_LTOD") {
    auto args = typed_inputs(in, {elementary(Kind::date), elementary(Kind::tod)});
    if (args.empty()) return bad(e.location);
    ExprPtr out = node(ExprKind::binary, elementary(Kind::dt), e.location);
    out->op = Op::add;
    out->args = std::move(args);
    return out;
  }
  const auto* f = std::find_if(std::begin(kTimes), std::end(kTimes),
                               [&](const TimeFunction& t) { return t.name == key; });
  return combine(f->op, expression(*in[0]), expression(*in[1]), e.location, key);
}

}  // namespace servogate::plc::sema
