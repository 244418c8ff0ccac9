// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using ir::ExprKind;

namespace {

// A TIME counts milliseconds in a number, a date seconds since 1970-01-01.
std::int64_t unit_ns(Kind k) { return k == Kind::time || k == Kind::tod ? 1'000'000 : 1'000'000'000; }

bool same_bits(Kind a, Kind b) {
  return (a == Kind::dword && b == Kind::real) || (a == Kind::real && b == Kind::dword) ||
         (a == Kind::lword && b == Kind::lreal) || (a == Kind::lreal && b == Kind::lword);
}

bool numeric(Kind k) {
  return is_integer(k) || is_bits(k) || is_real(k) || k == Kind::boolean || is_character(k);
}

}  // namespace

ExprPtr Analyzer::scaled_time(ExprPtr e, const Type* to, const Location& at) {
  const bool from_time = is_temporal(e->type->kind);
  const Kind other = from_time ? to->kind : e->type->kind;
  const Type* as = elementary(is_real(other) ? Kind::lreal : Kind::lint);
  const std::int64_t unit = unit_ns(from_time ? e->type->kind : to->kind);
  Constant c;
  c.i = unit;
  c.r = static_cast<double>(unit);
  ExprPtr scaled = node(ExprKind::binary, as, at);
  scaled->op = from_time ? Op::div : Op::mul;
  ExprPtr inner = node(ExprKind::convert, as, at);
  inner->args.push_back(std::move(e));
  scaled->args.push_back(fold_conversion(std::move(inner)));
  scaled->args.push_back(make_constant(as, c, at));
  ExprPtr out = node(ExprKind::convert, to, at);
  out->args.push_back(fold(std::move(scaled)));
  return fold_conversion(std::move(out));
}

// Between STRING, CHAR and WSTRING, WCHAR (table 27): texts from UTF-8 to UTF-16 and back, characters by
// their number.
ExprPtr Analyzer::recoded(ExprPtr e, const Type* to, const Location& at) {
  const bool text = is_text(e->type->kind), to_text = is_text(to->kind);
  if (text != to_text) {  // by way of the wide one of the same form
    const bool as_text = is_wide(to->kind) ? text : to_text;
    const Type* between = elementary(as_text ? Kind::wide_string : Kind::wide_character);
    return explicit_conversion(explicit_conversion(std::move(e), between, false, at), to, false, at);
  }
  if (!text && is_wide(to->kind)) return convert(std::move(e), to);
  std::vector<ExprPtr> one;
  one.push_back(std::move(e));
  return native(text ? Native::to_text : Native::from_text, to, at, std::move(one));
}

ExprPtr Analyzer::explicit_conversion(ExprPtr e, const Type* to, bool truncate, const Location& at) {
  if (e->type->kind == Kind::error) return e;
  if (is_untyped(e->type->kind)) {
    if (is_real(to->kind) || (e->type->kind == Kind::untyped_int && is_integer(to->kind)))
      return convert(std::move(e), to);
    e = settle(std::move(e), nullptr);
  }
  if (e->type->kind == Kind::enumeration) {
    ExprPtr base = node(ExprKind::reinterpret, e->type->base, at);
    base->args.push_back(std::move(e));
    e = fold_conversion(std::move(base));
  }
  const Kind from = e->type->kind;
  if (from == to->kind) return e;
  std::vector<ExprPtr> one;
  if (from == Kind::dt && (to->kind == Kind::date || to->kind == Kind::tod)) {
    one.push_back(std::move(e));
    return native(to->kind == Kind::date ? Native::day_part : Native::clock_part, to, at, std::move(one));
  }
  if (same_bits(from, to->kind) || (from == Kind::date && to->kind == Kind::dt)) {
    ExprPtr out = node(ExprKind::reinterpret, to, at);
    out->args.push_back(std::move(e));
    return fold_conversion(std::move(out));
  }
  if ((is_temporal(from) && numeric(to->kind)) || (numeric(from) && is_temporal(to->kind)))
    return scaled_time(std::move(e), to, at);
  const auto textual = [](Kind k) { return is_text(k) || is_character(k); };
  if (textual(from) && textual(to->kind) && is_wide(from) != is_wide(to->kind))
    return recoded(std::move(e), to, at);
  if (is_character(from) && is_text(to->kind)) return convert(std::move(e), to);
  if (is_text(to->kind) || is_text(from)) {
    const bool possible =
        is_text(to->kind) ? is_elementary(from) : is_elementary(to->kind) && to->kind != Kind::enumeration;
    if (possible) {
      one.push_back(std::move(e));
      return native(is_text(to->kind) ? Native::to_text : Native::from_text, to, at, std::move(one));
    }
  }
  if (is_bits(from) && to->kind == Kind::boolean) {  // the rightmost bit (table 25)
    Constant lowest;
    lowest.i = 1;
    ExprPtr bit = node(ExprKind::binary, e->type, at);
    bit->op = Op::and_;
    bit->args.push_back(std::move(e));
    bit->args.push_back(make_constant(bit->type, lowest, at));
    e = fold(std::move(bit));
  }
  if (numeric(from) && numeric(to->kind)) {
    ExprPtr out = node(truncate ? ExprKind::truncate : ExprKind::convert, to, at);
    out->args.push_back(std::move(e));
    return fold_conversion(std::move(out));
  }
  report_.error(at, texts::kMismatch, {to->name, e->type->name, ""});
  return bad(at);
}

// Elementary types by every name that they have, and enumerations.
bool Analyzer::conversion_name(std::string_view key) const {
  if (key == "TRUNC") return true;
  const auto known = [&](std::string_view n) {
    const Type* t = types_->find(n);
    if (t != nullptr) return is_elementary(t->kind);
    const auto declared = declared_types_.find(std::string(n));
    return declared != declared_types_.end() && !source_.types[declared->second].type.values.empty();
  };
  if (key.starts_with("BCD_TO_")) return known(key.substr(7));
  if (key.starts_with("TO_BCD_")) return known(key.substr(7));
  if (key.starts_with("TO_")) return known(key.substr(3));
  if (key.starts_with("TRUNC_")) return known(key.substr(6));
  for (const std::string_view mark : {"_BCD_TO_", "_TO_BCD_", "_TRUNC_", "_TO_"})
    if (const std::size_t at = key.find(mark); at != std::string_view::npos)
      return known(key.substr(0, at)) && known(key.substr(at + mark.size()));
  return false;
}

const Type* Analyzer::converted_type(std::string_view name) {
  if (name.empty()) return nullptr;
  if (const Type* t = types_->find(name)) return t;
  return resolve_declared(declared_types_.at(std::string(name)));
}

// A number becomes the value of an enumeration that it is; one that is none is a fault.
ExprPtr Analyzer::to_enumeration(ExprPtr e, const Type* to, const Location& at) {
  if (e->type == to || e->type->kind == Kind::error) return e;
  if (e->type->kind == Kind::enumeration) e = explicit_conversion(std::move(e), e->type->base, false, at);
  if (!is_integer(e->type->kind) && !is_bits(e->type->kind)) {
    report_.error(at, texts::kMismatch, {"ANY_INT", e->type->name, ""});
    return bad(at);
  }
  const Type* lint = elementary(Kind::lint);
  const auto number = [&](std::int64_t v) {
    Constant c;
    c.i = v;
    return make_constant(lint, std::move(c), at);
  };
  if (cell_of(*e->type) == Cell::u64 && e->kind != ExprKind::constant) {  // stays too large
    ExprPtr cut = node(ExprKind::binary, e->type, at);
    cut->op = Op::min;
    cut->args.push_back(std::move(e));
    cut->args.push_back(number(std::numeric_limits<std::int64_t>::max()));
    cut->args.back()->type = cut->type;
    e = std::move(cut);
  }
  e = convert(std::move(e), lint);
  if (e->kind == ExprKind::constant) {
    for (const EnumValue& v : to->values)
      if (v.value == e->value.i) return make_constant(to, named_constant(*to, v), at);
    report_.error(at, texts::kNotEnumValue, {to->name, std::to_string(e->value.i), ""});
    return bad(at);
  }
  std::vector<std::int64_t> values;
  for (const EnumValue& v : to->values) values.push_back(v.value);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  Kept kept;
  e = once(std::move(e), kept);
  ExprPtr one_of_them;
  for (std::size_t i = 0; i < values.size();) {  // one test for each run of values without a gap
    std::size_t last = i;
    while (last + 1 < values.size() && values[last + 1] == values[last] + 1) ++last;
    ExprPtr inside = combine(Op::and_, combine(Op::ge, e->copy(), number(values[i]), at, ">="),
                             combine(Op::le, e->copy(), number(values[last]), at, "<="), at, "AND");
    one_of_them = one_of_them ? combine(Op::or_, std::move(one_of_them), std::move(inside), at, "OR")
                              : std::move(inside);
    i = last + 1;
  }
  // What no integer holds: converting it is the fault.
  Constant beyond;
  beyond.r = 1e300;
  ExprPtr fault = node(ExprKind::convert, to->base, at);
  fault->args.push_back(make_constant(elementary(Kind::lreal), beyond, at));
  ExprPtr choice = node(ExprKind::choose, to->base, at);
  choice->args.push_back(std::move(one_of_them));
  choice->args.push_back(convert(std::move(e), to->base));
  choice->args.push_back(std::move(fault));
  ExprPtr out = node(ExprKind::reinterpret, to, at);
  out->args.push_back(std::move(choice));
  return around(std::move(out), std::move(kept));
}

// X_TO_Y, TO_Y, TRUNC, X_TRUNC_Y, TRUNC_Y, X_BCD_TO_Y, X_TO_BCD_Y (IEC 61131-3:2013, tables 22 to 27).
ExprPtr Analyzer::conversion_call(std::string_view key, const Expression& e) {
  std::string from_name, to_name;
  bool truncate = false, from_bcd = false, to_bcd = false;
  const auto split = [&](std::string_view mark) {
    const std::size_t at = key.find(mark);
    if (at == std::string_view::npos) return false;
    from_name = key.substr(0, at);
    to_name = key.substr(at + mark.size());
    return true;
  };
  if (key == "TRUNC") {
    truncate = true;
    to_name = "DINT";
  } else if (key.starts_with("BCD_TO_")) {
    from_bcd = true;
    to_name = key.substr(7);
  } else if (key.starts_with("TO_BCD_")) {
    to_bcd = true;
    to_name = key.substr(7);
  } else if (key.starts_with("TO_")) {
    to_name = key.substr(3);
  } else if (key.starts_with("TRUNC_")) {
    truncate = true;
    to_name = key.substr(6);
  } else if (split("_BCD_TO_")) {
    from_bcd = true;
  } else if (split("_TO_BCD_")) {
    to_bcd = true;
  } else if (split("_TRUNC_")) {
    truncate = true;
  } else {
    split("_TO_");
  }
  const Type* from = converted_type(from_name);
  const Type* to = converted_type(to_name);
  if (to->kind == Kind::error) return bad(e.location);
  const auto in = inputs(e, key, {"IN"}, 1, 1);
  if (in.empty()) return bad(e.location);
  ExprPtr value = expression(*in[0], from);
  if (value->type->kind == Kind::error) return value;
  if (from != nullptr)
    value = assignable(std::move(value), from);
  else if (is_untyped(value->type->kind))
    value = settle(std::move(value), nullptr);
  if (value->type->kind == Kind::error) return value;
  if (truncate && !is_real(value->type->kind)) {
    report_.error(in[0]->location, texts::kMismatch, {"ANY_REAL", value->type->name, ""});
    return bad(e.location);
  }
  if (from_bcd || to_bcd) {
    const auto fits = [&](const Type& t, bool bcd) { return bcd ? is_bits(t.kind) : is_unsigned(t.kind); };
    const bool given = fits(*value->type, from_bcd);
    if (!given || !fits(*to, to_bcd)) {
      report_.error(given ? e.location : in[0]->location, texts::kMismatch,
                    {(given ? to_bcd : from_bcd) ? "ANY_BIT" : "ANY_UNSIGNED",
                     given ? to->name : value->type->name, ""});
      return bad(e.location);
    }
    std::vector<ExprPtr> one;
    ExprPtr wide = node(ExprKind::convert, elementary(Kind::ulint), e.location);
    wide->args.push_back(std::move(value));
    one.push_back(fold_conversion(std::move(wide)));
    if (to_bcd) {  // a number of more digits than there is place for is a fault
      Constant bits;
      bits.i = to->size * 8;
      one.push_back(make_constant(elementary(Kind::ulint), bits, e.location));
    }
    ExprPtr bcd = native(from_bcd ? Native::from_bcd : Native::to_bcd, elementary(Kind::ulint), e.location,
                         std::move(one));
    ExprPtr out = node(ExprKind::convert, to, e.location);
    out->args.push_back(std::move(bcd));
    return fold_conversion(std::move(out));
  }
  const Kind real = value->type->kind;
  if (is_real(real) && is_bits(to->kind)) {
    const bool wide = real == Kind::lreal;
    if (same_bits(real, to->kind))
      report_.warning(e.location, texts::kBitsCopied,
                      {value->type->name, wide ? "3FF0000000000000" : "3F800000", wide ? "ULINT" : "UDINT"});
    else
      report_.warning(e.location, texts::kNumberToBits, {value->type->name, wide ? "LWORD" : "DWORD"});
  }
  if (to->kind == Kind::enumeration) return to_enumeration(std::move(value), to, e.location);
  return explicit_conversion(std::move(value), to, truncate, e.location);
}

}  // namespace servogate::plc::sema
