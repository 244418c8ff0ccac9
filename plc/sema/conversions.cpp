// SPDX-License-Identifier: Apache-2.0
#include "plc/sema/analyzer.hpp"
#include "plc/texts.hpp"

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
  const Type* from = from_name.empty() ? nullptr : types_->find(from_name);
  const Type* to = types_->find(to_name);
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
    ExprPtr bcd = native(from_bcd ? Native::from_bcd : Native::to_bcd, elementary(Kind::ulint), e.location,
                         std::move(one));
    ExprPtr out = node(ExprKind::convert, to, e.location);
    out->args.push_back(std::move(bcd));
    return fold_conversion(std::move(out));
  }
  return explicit_conversion(std::move(value), to, truncate, e.location);
}

}  // namespace servogate::plc::sema
