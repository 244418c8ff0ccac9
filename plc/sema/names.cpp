// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <limits>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using syntax::ExpressionKind;
using syntax::Section;

Variable* Analyzer::find_variable(std::string_view name, bool& global) {
  const std::string key = key_of(name);
  global = false;
  if (current_ >= 0) {
    UnitScope& u = here();
    if (const auto at = u.by_name.find(key); at != u.by_name.end() && at->second < u.variables.size()) {
      Variable& v = u.variables[at->second];
      if (v.section != Section::external || v.type->kind == Kind::error) return &v;
      v.used = true;
    }
  }
  if (const auto at = globals_by_name_.find(global_key(name));
      at != globals_by_name_.end() && at->second < globals_.size()) {
    global = true;
    return &globals_[at->second];
  }
  return nullptr;
}

// "NC.m_strobe": the longest chain of names that is a symbol of the machine, unless a local variable with
// members has the first name.
bool Analyzer::dotted_symbol(const Expression& e, std::string& name) const {
  if (e.kind == ExpressionKind::name) {
    name = e.name;
    return true;
  }
  if (e.kind != ExpressionKind::member || !dotted_symbol(*e.operands[0], name)) return false;
  name += "." + e.name;
  return true;
}

// A suggestion is a courtesy: with very many names not every mistake gets one.
std::vector<std::string> Analyzer::names_in_scope() {
  std::vector<std::string> out;
  constexpr std::size_t kMostNames = 2'000'000;
  names_offered_ += globals_.size() + symbols_.size() + (current_ >= 0 ? here().variables.size() : 0);
  if (report_.full() || names_offered_ > kMostNames) return out;
  if (current_ >= 0)
    for (const Variable& v : scopes_[static_cast<std::size_t>(current_)].variables) out.push_back(v.name);
  for (const Variable& v : globals_) out.push_back(v.name);
  for (const image::Symbol& s : symbols_) out.push_back(s.name);
  return out;
}

void Analyzer::note_write(Variable& v, bool global, const Location& at) {
  v.written = true;
  const std::string own = key_of(v.name.substr(v.name.rfind('.') + 1));  // without a resource
  const bool constant = global && current_ >= 0 && here().by_name.contains(own) &&
                        here().variables[here().by_name[own]].constant;  // VAR_EXTERNAL CONSTANT
  if (v.constant || constant) {
    report_.error(at, texts::kWriteConstant, {v.name});
    return;
  }
  for (const Variable* f : for_variables_)
    if (f == &v) report_.error(at, texts::kWriteFor, {v.name});
  if (!global && v.section == Section::input && v.bound())
    report_.error(at, texts::kWriteBoundInput, {v.name});
  else if (!global && v.section == Section::input)
    report_.warning(at, texts::kWriteInput, {v.name});
  if (global) v.writers.insert(current_);
  if (v.root == ir::Root::shared) check_place_writer(v.cell, at, v.name);
  if (v.area == "%I*") report_.error(at, texts::kWritePlaceInput, {v.name});
}

// "GVL.speed": the name of a list of global variables before one of them.
bool Analyzer::leads_global(const Expression& e) {
  bool global = false;
  return e.kind == ExpressionKind::name && source_.global_lists.contains(key_of(e.name)) &&
         find_variable(e.name, global) == nullptr;
}

std::optional<ir::Place> Analyzer::place(const Expression& e, bool write) {
  switch (e.kind) {
    case ExpressionKind::name:
      return place_of_name(e, write);
    case ExpressionKind::member:
      return place_of_member(e, write);
    case ExpressionKind::index:
      return place_of_index(e, write);
    case ExpressionKind::bit:
      return place_of_bit(e, write);
    case ExpressionKind::dereference:
      return place_of_dereference(e);
    case ExpressionKind::held: {
      const auto held = held_.find(e.literal.magnitude);
      if (held == held_.end()) return std::nullopt;  // reported where it was to be kept
      return held->second.copy();
    }
    case ExpressionKind::direct: {
      if (bool global = false; find_variable(e.name, global) != nullptr) return place_of_name(e, write);
      const auto p = parse_address(e.name, e.location);
      if (!p) return std::nullopt;
      ir::Place out;
      out.root = ir::Root::shared;
      out.type = type_of(*p);
      const Kind bits[] = {Kind::boolean, Kind::byte, Kind::word, Kind::dword, Kind::real, Kind::lword};
      out.type = elementary(bits[static_cast<int>(p->format)]);
      out.cell = shared(key_of(e.name), *p, out.type, e.location);
      if (direct_.insert(key_of(e.name)).second) warn_overlaps(e.name, *p, e.location, true);
      if (key_of(e.name).starts_with("%I")) read_only_places_.insert(out.cell);
      if (write) check_place_writer(out.cell, e.location, e.name);
      return out;
    }
    default:
      report_.error(e.location, texts::kNotVariable);
      return std::nullopt;
  }
}

std::optional<ir::Place> Analyzer::place_of_symbol(const std::string& name, const Location& at, bool write) {
  const image::Symbol* s = symbol(name);
  if (s == nullptr) return std::nullopt;
  image::Packets sizes;
  sizes.resize(options_.k_bytes, options_.v_bytes);
  if (!sizes.contains(s->place)) {
    report_.error(at, texts::kAddressRange, {s->name, std::to_string(sizes.size(s->place.packet))});
    return std::nullopt;
  }
  ir::Place out;
  out.root = ir::Root::shared;
  out.type = type_of(s->place);
  out.cell = shared(s->name, s->place, out.type, at);
  if (write) check_place_writer(out.cell, at, s->name);
  return out;
}

std::optional<ir::Place> Analyzer::place_of_name(const Expression& e, bool write) {
  bool global = false;
  Variable* v = find_variable(e.name, global);
  if (v == nullptr) {
    if (auto p = place_of_symbol(e.name, e.location, write)) return p;
    if (auto p = axis_reference(e.name, e.location)) return p;
    if (current_ >= 0 && here().by_name.contains(key_of(e.name)))
      return std::nullopt;  // VAR_EXTERNAL: reported
    if (unknown_.insert(key_of(e.name)).second && symbol(e.name) == nullptr)
      report_.error(e.location, texts::kUnknownName, {e.name, syntax::suggestion(e.name, names_in_scope())});
    return std::nullopt;
  }
  if (!no_marks_) v->used = true;
  if (write) note_write(*v, global, e.location);
  if (v->type->kind == Kind::error) return std::nullopt;
  ir::Place out;
  out.root = v->root;
  out.cell = v->cell;
  out.type = v->type;
  return out;
}

std::optional<ir::Place> Analyzer::place_of_member(const Expression& e, bool write) {
  if (leads_global(*e.operands[0])) {
    Expression plain;
    plain.kind = ExpressionKind::name;
    plain.location = e.location;
    plain.name = e.name;
    return place_of_name(plain, write);
  }
  std::string name;
  if (dotted_symbol(e, name)) {
    const Expression* first = &e;
    while (first->kind == ExpressionKind::member) first = first->operands[0].get();
    bool global = false;
    const Variable* v = find_variable(first->name, global);
    const bool structured = (v != nullptr && !v->type->fields.empty()) || leads_global(*first);
    if (!structured) {
      if (auto p = place_of_symbol(name, first->location, write)) return p;
      if (symbol(name) != nullptr) return std::nullopt;  // reported
      if (v == nullptr) {
        if (unknown_.insert(key_of(name)).second)
          report_.error(first->location, texts::kUnknownName,
                        {name, syntax::suggestion(name, names_in_scope())});
        return std::nullopt;
      }
    }
  }
  const bool through_block = write;
  auto base = place(*e.operands[0], false);
  if (!base) return std::nullopt;
  const Type& t = *base->type;
  if (t.kind != Kind::structure && t.kind != Kind::block) {
    std::string shown;
    if (!dotted_symbol(*e.operands[0], shown)) shown = "[...]";
    report_.error(e.location, texts::kNotStructured, {shown, t.name});
    return std::nullopt;
  }
  const Field* f = t.field(e.name);
  if (f == nullptr || f->name.find('$') != std::string::npos) {
    std::vector<std::string> names;
    for (const Field& g : t.fields) names.push_back(g.name);
    report_.error(e.location, texts::kNoMember, {t.name, e.name, syntax::suggestion(e.name, names)});
    return std::nullopt;
  }
  if (t.kind == Kind::block) {
    UnitScope& u = scopes_[static_cast<std::size_t>(t.block)];
    const Variable& v = u.variables[u.by_name.at(key_of(e.name))];
    if ((v.section != Section::input && v.section != Section::output) || v.bound()) {
      report_.error(e.location, texts::kPrivate, {v.name, t.name});
      return std::nullopt;
    }
    if (through_block && v.section == Section::output) {
      report_.error(e.location, texts::kWriteOutput, {v.name, t.name});
      return std::nullopt;
    }
    if (through_block && !changeable(*e.operands[0])) return std::nullopt;
  } else if (write) {
    place(*e.operands[0], true);  // a member of a constant or an input is one itself
  }
  base->offset += f->offset;
  base->type = f->type;
  return base;
}

// An instance that is an input, or an output of another block, can be read here, not called or given inputs.
bool Analyzer::changeable(const Expression& instance) {
  if (instance.kind == ExpressionKind::index) return changeable(*instance.operands[0]);
  if (instance.kind == ExpressionKind::name) {
    bool global = false;
    const Variable* v = find_variable(instance.name, global);
    const bool input = v != nullptr && !global && v->section == Section::input && v->bound();
    if (input) report_.error(instance.location, texts::kWriteBoundInput, {v->name});
    return !input;
  }
  if (instance.kind != ExpressionKind::member || leads_global(*instance.operands[0])) return true;
  const auto base = place(*instance.operands[0], false);
  if (!base || base->type->kind != Kind::block) return changeable(*instance.operands[0]);
  const UnitScope& u = scopes_[static_cast<std::size_t>(base->type->block)];
  const Variable& v = u.variables[u.by_name.at(key_of(instance.name))];
  if (v.section == Section::output)
    report_.error(instance.location, texts::kWriteOutput, {v.name, base->type->name});
  return v.section != Section::output && changeable(*instance.operands[0]);
}

std::optional<ir::Place> Analyzer::place_of_index(const Expression& e, bool write) {
  auto base = place(*e.operands[0], write);
  if (!base) {
    for (std::size_t i = 1; i < e.operands.size(); ++i) expression(*e.operands[i]);
    return std::nullopt;
  }
  std::size_t dimensions = 0;
  for (const Type* t = base->type; t->kind == Kind::array; t = t->base) ++dimensions;
  const std::size_t given = e.operands.size() - 1;
  if (is_text(base->type->kind) && given == 1 && base->root != ir::Root::shared)
    return character_of(std::move(*base), *e.operands[1]);
  if (dimensions == 0) {
    report_.error(e.operands[1]->location, texts::kNotArray, {base->type->name});
    return std::nullopt;
  }
  if (given > dimensions) {
    report_.error(e.operands[1]->location, texts::kDimensions,
                  {std::to_string(dimensions), std::to_string(given)});
    return std::nullopt;
  }
  for (std::size_t i = 1; i <= given; ++i) {
    const Type& t = *base->type;
    ExprPtr index = settle(expression(*e.operands[i], elementary(Kind::dint)), elementary(Kind::dint));
    base->type = t.base;
    if (index->type->kind == Kind::error) return std::nullopt;
    if (is_bits(index->type->kind)) index = convert(std::move(index), elementary(Kind::ulint));
    if (!is_integer(index->type->kind)) {
      report_.error(e.operands[i]->location, texts::kIndexType, {index->type->name});
      return std::nullopt;
    }
    if (t.open) {
      base->steps.push_back(open_step(*base, std::move(index)));
    } else if (index->kind == ir::ExprKind::constant) {
      if (index->value.i < t.range.low || index->value.i > t.range.high) {
        report_.error(
            e.operands[i]->location, texts::kIndexRange,
            {std::to_string(index->value.i), std::to_string(t.range.low), std::to_string(t.range.high)});
        return std::nullopt;
      }
      base->offset += static_cast<std::uint32_t>(index->value.i - t.range.low) * t.base->size;
    } else {
      base->steps.push_back({std::move(index), t.range.low, t.range.high, t.base->size});
    }
  }
  return base;
}

// The limits of the first dimension of an ARRAY[*]: behind its address, one for each dimension.
ir::Place Analyzer::limits_of(const ir::Place& array) {
  ir::Place out;
  out.root = ir::Root::reference;
  out.cell = array.cell + 4;
  out.offset = static_cast<std::uint32_t>(array.steps.size() * sizeof(ir::Limits));
  out.type = limits_type();
  return out;
}

ir::Step Analyzer::open_step(const ir::Place& array, ExprPtr index) {
  const Location at = index->at;
  const Type* lint = elementary(Kind::lint);
  if (cell_of(*index->type) == Cell::u64 && index->kind != ir::ExprKind::constant) {  // stays too large
    ExprPtr cut = node(ir::ExprKind::binary, index->type, at);
    cut->op = Op::min;
    Constant most;
    most.i = std::numeric_limits<std::int64_t>::max();
    cut->args.push_back(std::move(index));
    cut->args.push_back(make_constant(cut->type, most, at));
    index = std::move(cut);
  }
  ir::Step s;
  s.index = convert(std::move(index), lint);
  s.limits = load(limits_of(array), at);
  return s;
}

// One character of a string, counted from 1 (6.3.3); beyond the capacity is an index fault.
std::optional<ir::Place> Analyzer::character_of(ir::Place base, const Expression& subscript) {
  const std::int64_t last = base.type->capacity();
  ExprPtr index = settle(expression(subscript, elementary(Kind::dint)), elementary(Kind::dint));
  if (index->type->kind == Kind::error) return std::nullopt;
  if (!is_integer(index->type->kind)) {
    report_.error(subscript.location, texts::kIndexType, {index->type->name});
    return std::nullopt;
  }
  base.type = elementary(base.type->kind == Kind::wide_string ? Kind::wide_character : Kind::character);
  const std::uint32_t stride = base.type->size;
  base.offset += stride;  // the length
  if (index->kind != ir::ExprKind::constant) {
    base.steps.push_back({std::move(index), 1, last, stride});
    return base;
  }
  if (index->value.i < 1 || index->value.i > last) {
    report_.error(subscript.location, texts::kIndexRange,
                  {std::to_string(index->value.i), "1", std::to_string(last)});
    return std::nullopt;
  }
  base.offset += static_cast<std::uint32_t>(index->value.i - 1) * stride;
  return base;
}

std::optional<ir::Place> Analyzer::place_of_bit(const Expression& e, bool write) {
  auto base = place(*e.operands[0], write);
  if (!base) return std::nullopt;
  const Type& t = *base->type;
  if (!(is_bits(t.kind) || is_integer(t.kind)) || base->bit >= 0) {
    report_.error(e.location, texts::kOperand, {".", t.name});
    return std::nullopt;
  }
  std::uint64_t bit = e.literal.magnitude;
  if (e.name.starts_with("%")) {  // .%X3, .%B1, .%W0, .%D0 (6.5.2.2, partial access)
    constexpr std::string_view kSizes = "XBWD";
    constexpr Kind kParts[] = {Kind::boolean, Kind::byte, Kind::word, Kind::dword};
    const std::string key = key_of(e.name);
    const std::size_t part = kSizes.find(key[1]);
    const bool number = key.size() > 2 && key.size() <= 4 && std::isdigit(static_cast<unsigned char>(key[2]));
    if (part == std::string_view::npos || !number || key.find('.') != std::string::npos) {
      report_.error(e.location, texts::kUnsupported, {e.name});
      return std::nullopt;
    }
    bit = static_cast<std::uint64_t>(std::stoi(key.substr(2)));
    if (part > 0) {
      const Type* type = elementary(kParts[part]);
      if (type->size >= t.size || (bit + 1) * type->size > t.size) {
        report_.error(e.location, texts::kNoMember, {t.name, e.name, ""});
        return std::nullopt;
      }
      base->offset += static_cast<std::uint32_t>(bit) * type->size;
      base->type = type;
      return base;
    }
  }
  if (bit >= t.size * 8) {
    report_.error(e.location, texts::kBitRange, {t.name, std::to_string(t.size * 8 - 1)});
    return std::nullopt;
  }
  base->offset += static_cast<std::uint32_t>(bit / 8);
  base->bit = static_cast<std::int8_t>(bit % 8);
  base->type = elementary(Kind::boolean);
  return base;
}

ExprPtr Analyzer::enumeration_value(std::string_view name, const Location& at, const Type* hint) {
  if (hint != nullptr)
    if (const EnumValue* v = hint->value_named(name))
      return make_constant(hint, named_constant(*hint, *v), at);
  const auto found = enumerations_.find(key_of(name));
  if (found == enumerations_.end()) return nullptr;
  const Type* t = found->second.front();
  return make_constant(t, named_constant(*t, *t->value_named(name)), at);
}

}  // namespace servogate::plc::sema
