// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

/// REF_TO, REF, ^, NULL and ?= (IEC 61131-3:2013, 6.4.4.10). A reference is the address of a variable of its
/// type, or 0. All variables lie at one place for good, so that none can lead to memory of another type; what
/// is refused here are variables whose values do not last.
namespace servogate::plc::sema {

using syntax::ExpressionKind;
using syntax::Section;
using syntax::UnitKind;

// A structure or a function block may hold references to its own kind.
const Type* Analyzer::resolve_reference(const syntax::TypeReference& t) {
  const std::string key = key_of(t.element->name);
  if (const auto open = open_types_.find(key); open != open_types_.end())
    return types_->reference(open->second);
  if (const int unit = unit_named(key); unit >= 0) {
    const UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
    if (u.laying_out && u.source->kind == UnitKind::function_block) return types_->reference(u.frame);
  }
  const Type* target = resolve(*t.element);
  return target->kind == Kind::error ? target : types_->reference(target);
}

// Whether the variable that a path begins with keeps its value, reported where not.
bool Analyzer::lasts(const Expression& variable) {
  const Expression* e = &variable;
  while (e->kind == ExpressionKind::member || e->kind == ExpressionKind::index ||
         e->kind == ExpressionKind::bit)
    e = e->operands[0].get();
  bool global = false;
  const Variable* v = e->kind == ExpressionKind::name ? find_variable(e->name, global) : nullptr;
  if (v == nullptr || global || current_ < 0) return true;
  const char* why = here().source->kind == UnitKind::function ? "FUNCTION"
                    : v->section == Section::temp             ? "VAR_TEMP"
                    : v->section == Section::in_out           ? "VAR_IN_OUT"
                    : v->bound()                              ? "VAR_INPUT"
                                                              : nullptr;
  if (why == nullptr) {
    referenced_units_.insert(current_);
    return true;
  }
  report_.error(e->location, texts::kReferenceLasts, {v->name, why});
  return false;
}

// REF(x): whoever has it may write x, so that x has to be one that may be written here.
ExprPtr Analyzer::reference_to(const Expression& e) {
  if (e.arguments.size() != 1 || !e.arguments[0].value || !e.arguments[0].name.empty()) {
    report_.error(e.location, texts::kCount, {"REF", "1", std::to_string(e.arguments.size())});
    return bad(e.location);
  }
  const Expression& variable = *e.arguments[0].value;
  const std::size_t errors = report_.errors();
  auto p = place(variable, true);
  if (!p || !lasts(variable) || report_.errors() != errors) return bad(e.location);
  if (p->bit >= 0 || p->type->open) {
    report_.error(variable.location, p->bit >= 0 ? texts::kReferenceBit : texts::kOpenArrayWhole,
                  {p->type->name});
    return bad(e.location);
  }
  if (p->root == ir::Root::shared) program_.places[p->cell].referenced = true;
  ExprPtr out = node(ir::ExprKind::address, types_->reference(p->type), e.location);
  out->place = std::move(*p);
  return out;
}

std::optional<ir::Place> Analyzer::place_of_dereference(const Expression& e) {
  ExprPtr pointer = expression(*e.operands[0]);
  const Type& t = *pointer->type;
  if (t.kind == Kind::error) return std::nullopt;
  if (t.kind != Kind::reference || t.base == nullptr) {
    report_.error(e.location, texts::kNoReference, {t.name});
    return std::nullopt;
  }
  ir::Place out;
  out.root = ir::Root::target;
  out.type = t.base;
  out.pointer = std::move(pointer);
  return out;
}

// ?= (6.4.4.10.4): without inheritance the types decide, and one that does not fit gives NULL.
ExprPtr Analyzer::attempted(ExprPtr value, const Type& to) {
  const Type& from = *value->type;
  if (from.kind == Kind::error || to.kind == Kind::error) return value;
  if (from.kind != Kind::reference || to.kind != Kind::reference) {
    const Type& other = to.kind != Kind::reference ? to : from;
    report_.error(value->at, texts::kOperand, {"?=", other.name});
    return bad(value->at);
  }
  if (conversion(from, to) != Conversion::none) return value;
  report_.warning(value->at, texts::kReferenceNever, {to.name, from.name});
  return make_constant(types_->reference(nullptr), {}, value->at);
}

// r : REF_TO INT := REF(x), also inside of lists and records: the addresses are known when everything has its
// place.
std::vector<std::uint8_t> Analyzer::initial_bytes(const syntax::Variable& s, const Type& type, bool lasting) {
  gathered_.clear();
  gather_at_ = 0;
  gathers_ = lasting && s.section != Section::temp && s.address.empty();
  std::vector<std::uint8_t> out = initial_bytes(*s.initial, type);
  gathers_ = false;
  return out;
}

// False: not REF(x), or not where it can be kept. NULL is kept as well: it may stand for another initial
// value of the block that a record belongs to.
bool Analyzer::gather_reference(const Expression& e, const Type& type) {
  if (!gathers_) return false;
  const bool takes = e.kind == ExpressionKind::call && e.operands[0]->kind == ExpressionKind::name &&
                     same_name(e.operands[0]->name, "REF");
  if (!takes) {
    gathered_.push_back({nullptr, gather_at_, std::nullopt});
    return false;
  }
  ExprPtr value = assignable(reference_to(e), &type);
  if (value->type->kind == Kind::error) return true;
  const ir::Place& p = value->place;
  if (value->kind != ir::ExprKind::address || p.computed() || p.root == ir::Root::reference)
    report_.error(e.location, texts::kNotConstant);
  else
    gathered_.push_back({nullptr, gather_at_, std::move(value->place)});
  return true;
}

// The references of one value stand for those of `times` values, `stride` bytes apart.
void Analyzer::repeat_references(std::size_t from, std::int64_t times, std::uint32_t stride) {
  const std::size_t end = gathered_.size();
  for (std::int64_t r = 1; r < times; ++r)
    for (std::size_t i = from; i < end; ++i) {
      InitialReference again{nullptr, gathered_[i].cell + static_cast<std::uint32_t>(r) * stride, {}};
      if (gathered_[i].target) again.target = gathered_[i].target->copy();
      gathered_.push_back(std::move(again));
    }
}

void Analyzer::keep_references(const Type* frame, std::uint32_t cell) {
  for (InitialReference& r : gathered_)
    initial_references_.push_back({frame, cell + r.cell, std::move(r.target)});
  gathered_.clear();
}

// The block below `type` that takes references to variables of its own, nullptr: none does.
const Type* Analyzer::gives_references(const Type& type, std::map<const Type*, const Type*>& known) const {
  if (type.kind == Kind::array) return gives_references(*type.base, known);
  if (!type.holds_instance) return nullptr;
  if (type.kind == Kind::block && referenced_units_.contains(type.block)) return &type;
  if (const auto at = known.find(&type); at != known.end()) return at->second;
  const Type* inside = nullptr;
  for (const Field& f : type.fields)
    if (inside == nullptr && !f.reference) inside = gives_references(*f.type, known);
  return known[&type] = inside;
}

// After all bodies: an instance that does not last holds no variable that somebody may have a reference to.
void Analyzer::check_references() {
  if (referenced_units_.empty()) return;
  std::map<const Type*, const Type*> known;
  for (const UnitScope& u : scopes_)
    for (const Variable& v : u.variables) {
      const bool function = u.source->kind == UnitKind::function;
      if ((!function && v.section != Section::temp) || v.root != ir::Root::instance) continue;
      if (const Type* block = gives_references(*v.type, known))
        report_.error(v.at, texts::kReferenceInstance,
                      {v.name, function ? "FUNCTION" : "VAR_TEMP", block->name});
    }
}

void Analyzer::bind_references() {
  if (initial_references_.empty()) return;
  for (const ir::Global& p : program_.programs) bind_references(*p.type, p.address);
  for (const Variable& g : globals_)
    if (g.root == ir::Root::fixed && g.type->kind != Kind::error) bind_references(*g.type, g.cell);
  for (const ir::Unit& u : program_.units)
    if (u.kind == UnitKind::function && u.frame != nullptr && u.fixed_base >= 0)
      bind_references(*u.frame, static_cast<std::uint32_t>(u.fixed_base));
  for (const InitialReference& r : initial_references_)
    if (r.frame == nullptr) bind_reference(r, 0);
}

void Analyzer::bind_reference(const InitialReference& r, std::uint32_t base) {
  std::uint32_t address = 0;
  if (r.target) {
    const ir::Place& p = *r.target;
    const std::uint32_t start = p.root == ir::Root::shared     ? program_.places[p.cell].address
                                : p.root == ir::Root::instance ? base + p.cell
                                                               : p.cell;
    address = start + p.offset;
  }
  std::memcpy(program_.memory.data() + base + r.cell, &address, sizeof address);
}

void Analyzer::bind_references(const Type& type, std::uint32_t address) {
  if (!type.holds_instance) return;
  if (type.kind == Kind::array) {
    for (std::int64_t i = 0; i < type.range.count(); ++i)
      bind_references(*type.base, address + static_cast<std::uint32_t>(i) * type.base->size);
    return;
  }
  for (const Field& f : type.fields)
    if (!f.reference) bind_references(*f.type, address + f.offset);
  // What the declaration of an instance says goes before what its block says.
  for (const InitialReference& r : initial_references_)
    if (r.frame == &type) bind_reference(r, address);
}

}  // namespace servogate::plc::sema
