// SPDX-License-Identifier: Apache-2.0
#include "plc/code/references.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace servogate::plc::code {

namespace {

using Reference = Image::Reference;

class Walk {
 public:
  explicit Walk(const ir::Program& program) : program_(program) {}
  std::vector<Reference> run();

 private:
  void block(const ir::Block& b) {
    for (const ir::Stmt& s : b) statement(s);
  }
  void statement(const ir::Stmt& s);
  void expression(const ir::Expr& e);
  void optional(const ir::ExprPtr& e) {
    if (e) expression(*e);
  }
  void place(const ir::Place& p, const syntax::Location& at, bool write);
  bool root(const ir::Place& p, Reference& out, std::uint32_t& offset) const;

  const ir::Program& program_;
  std::vector<Reference> found_;
  std::map<std::uint32_t, const ir::Global*> owners_;  ///< of the memory from an address on
  int unit_ = -1;
  std::string unit_name_;  ///< of its only instance, where it is a program
};

/// Goes from a variable to the member at `offset`, as far as the way is the same in every scan.
void descend(Reference& out, std::uint32_t offset, const ir::Place& p) {
  for (;;) {
    const Type& t = *out.type;
    if (&t == p.type && p.steps.empty() && offset == 0) return;
    if (t.kind == Kind::array) {
      if (!p.steps.empty() || t.base->size == 0) return;
      const std::uint32_t i = offset / t.base->size;
      out.name += "[" + std::to_string(t.range.low + i) + "]";
      out.cell += i * t.base->size;
      offset -= i * t.base->size;
      out.type = t.base;
      continue;
    }
    if (t.kind != Kind::structure && t.kind != Kind::block) return;
    const Field* field = t.field_at(offset);
    if (field == nullptr) return;
    out.name += "." + field->name;
    out.cell += field->offset;
    offset -= field->offset;
    out.type = field->type;
    out.bound = field->reference;
    if (out.bound) return;
  }
}

bool Walk::root(const ir::Place& p, Reference& out, std::uint32_t& offset) const {
  if (p.root == ir::Root::shared) {
    const ir::SharedPlace& s = program_.places[p.cell];
    out.name = s.name;
    out.type = s.type;
    out.base = Reference::Base::place;
    out.cell = p.cell;
    return true;
  }
  if (p.root == ir::Root::fixed) {
    const std::uint32_t address = p.cell + p.offset;
    const auto behind = owners_.upper_bound(address);
    if (behind == owners_.begin()) return false;
    const ir::Global& owner = *std::prev(behind)->second;
    if (address - owner.address >= owner.type->size) return false;
    out.name = owner.name;
    out.type = owner.type;
    out.base = Reference::Base::fixed;
    out.cell = owner.address;
    offset = address - owner.address;
    return true;
  }
  if (p.root == ir::Root::pointer || p.pointer || unit_ < 0) return false;
  const ir::Unit& u = program_.units[static_cast<std::size_t>(unit_)];
  out.name = unit_name_;
  out.type = u.frame;
  out.base = Reference::Base::unit;
  out.cell = 0;
  offset = p.root == ir::Root::reference ? p.cell : p.cell + p.offset;
  return u.frame != nullptr;
}

void Walk::place(const ir::Place& p, const syntax::Location& at, bool write) {
  for (const ir::Step& s : p.steps) optional(s.index);
  optional(p.pointer);
  Reference r;
  std::uint32_t offset = 0;
  if (at.line <= 0 || !root(p, r, offset)) return;
  if (r.base != Reference::Base::place) descend(r, offset, p);
  if (r.name.find('$') != std::string::npos || r.type == nullptr || r.name.find('.') == r.name.npos) {
    if (r.base == Reference::Base::unit) return;  // an unnamed part of the body's own memory
  }
  if (r.name.find('$') != std::string::npos) return;
  r.unit = unit_;
  r.file = at.file;
  r.line = at.line;
  r.column = at.column;
  r.write = write;
  found_.push_back(std::move(r));
}

void Walk::expression(const ir::Expr& e) {
  if (e.kind == ir::ExprKind::load) place(e.place, e.at, false);
  if (e.kind == ir::ExprKind::address) place(e.place, e.at, true);
  for (const ir::ExprPtr& a : e.args) optional(a);
  for (const ir::Parameter& p : e.parameters) {
    optional(p.value);
    if (!p.value && p.place.type != nullptr) place(p.place, e.at, p.section != syntax::Section::input);
  }
}

void Walk::statement(const ir::Stmt& s) {
  switch (s.kind) {
    case ir::StmtKind::assign:
    case ir::StmtKind::for_:
      place(s.place, s.at, true);
      break;
    case ir::StmtKind::bind:
      place(s.other, s.at, !s.reads);
      break;
    default:
      break;
  }
  optional(s.value);
  optional(s.to);
  optional(s.by);
  for (const ir::Branch& b : s.branches) {
    optional(b.condition);
    block(b.body);
  }
  block(s.body);
}

std::vector<Reference> Walk::run() {
  const int library = static_cast<int>(program_.files.size()) - 1;
  for (const auto* list : {&program_.programs, &program_.globals})
    for (const ir::Global& g : *list)
      if (g.place < 0) owners_.emplace(g.address, &g);
  std::map<const Type*, std::string> instances;
  for (const ir::Global& g : program_.programs) instances[g.type] = g.name;
  for (std::size_t u = 0; u < program_.units.size(); ++u) {
    const ir::Unit& unit = program_.units[u];
    if (unit.at.file >= library) continue;
    unit_ = static_cast<int>(u);
    const auto instance = instances.find(unit.frame);
    unit_name_ = instance == instances.end() ? unit.name : instance->second;
    block(program_.units[u].body);
  }
  std::erase_if(found_, [&](const Reference& r) { return r.file >= library; });
  const auto key = [](const Reference& r) { return std::tie(r.file, r.line, r.column, r.name, r.write); };
  std::sort(found_.begin(), found_.end(),
            [&](const Reference& a, const Reference& b) { return key(a) < key(b); });
  found_.erase(std::unique(found_.begin(), found_.end(),
                           [&](const Reference& a, const Reference& b) { return key(a) == key(b); }),
               found_.end());
  return std::move(found_);
}

}  // namespace

std::vector<Image::Reference> references(const ir::Program& program) {
  return Walk(program).run();
}

}  // namespace servogate::plc::code
