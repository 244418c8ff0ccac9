// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

/// Global variables of one name in several resources (IEC 61131-3:2013, 6.8.2): each is its own, called
/// `Resource.name` from outside. A unit that uses one of them, itself or by what it calls, is compiled once
/// for each resource that runs it.
namespace servogate::plc::sema {

namespace {

/// Every name that declarations and bodies mention, by key.
class Mentions {
 public:
  explicit Mentions(std::set<std::string>& out) : out_(out) {}

  void type(const syntax::TypeReference& t) {
    out_.insert(key_of(t.name));
    if (t.element) type(*t.element);
    for (const auto& [low, high] : t.ranges) optional(low), optional(high);
    for (const syntax::ExpressionPtr* e : {&t.length, &t.low, &t.high}) optional(*e);
    for (const auto& [name, value] : t.values) optional(value);
    for (const syntax::Variable& m : t.members) variable(m);
  }
  void variable(const syntax::Variable& v) {
    if (v.section == syntax::Section::external) out_.insert(key_of(v.name));
    if (v.type) type(*v.type);
    if (v.initial) expression(*v.initial);
  }
  void block(const syntax::Block& b) {
    for (const syntax::StatementPtr& s : b) statement(*s);
  }

 private:
  void optional(const syntax::ExpressionPtr& e) {
    if (e) expression(*e);
  }
  void expression(const Expression& e) {
    if (e.kind == syntax::ExpressionKind::name || e.kind == syntax::ExpressionKind::typed)
      out_.insert(key_of(e.name));
    for (const syntax::ExpressionPtr& o : e.operands) optional(o);
    for (const syntax::Argument& a : e.arguments) optional(a.value);
    optional(e.enable);
    optional(e.enabled);
  }
  void statement(const syntax::Statement& s) {
    for (const syntax::ExpressionPtr* e : {&s.target, &s.value, &s.to, &s.by}) optional(*e);
    if (s.alternative) statement(*s.alternative);
    for (const syntax::Branch& b : s.branches) {
      optional(b.condition);
      for (const syntax::Label& l : b.labels) optional(l.low), optional(l.high);
      block(b.body);
    }
    block(s.body);
  }

  std::set<std::string>& out_;
};

}  // namespace

std::string Analyzer::resource_here() const {
  return key_of(current_ >= 0 ? scopes_[static_cast<std::size_t>(current_)].resource : resource_);
}

// Under which name a global variable is kept.
std::string Analyzer::global_key(std::string_view name) const {
  const std::string key = key_of(name);
  return shared_names_.contains(key) ? resource_here() + "." + key : key;
}

// The unit of that name, in the form that it has in the resource; -1: there is none.
int Analyzer::unit_named(std::string_view name) const {
  const auto at = units_by_name_.find(key_of(name));
  if (at == units_by_name_.end()) return -1;
  const auto own = by_resource_.find({at->second, resource_here()});
  return own == by_resource_.end() ? at->second : own->second;
}

// For every unit and type the units that it may come to, over whatever lies between.
std::vector<std::set<std::string>> Analyzer::all_mentions() const {
  std::map<std::string, std::set<std::string>> below;
  std::vector<std::set<std::string>> out(source_.units.size());
  for (const syntax::TypeDeclaration& d : source_.types) Mentions(below[key_of(d.name)]).type(d.type);
  for (std::size_t u = 0; u < out.size(); ++u) {
    Mentions mentions(out[u]);
    for (const syntax::Variable& v : source_.units[u].variables) mentions.variable(v);
    if (source_.units[u].result) mentions.type(*source_.units[u].result);
    mentions.block(source_.units[u].body);
    below[key_of(source_.units[u].name)].insert(out[u].begin(), out[u].end());
  }
  for (const syntax::Variable& g : source_.globals) Mentions(below[key_of(g.name)]).variable(g);
  for (std::set<std::string>& names : out) {
    std::vector<std::string> open(names.begin(), names.end());
    while (!open.empty()) {
      const auto at = below.find(open.back());
      open.pop_back();
      if (at == below.end()) continue;
      for (const std::string& n : at->second)
        if (names.insert(n).second) open.push_back(n);
    }
  }
  return out;
}

void Analyzer::part_resources() {
  std::map<std::string, std::set<std::string>> owners;
  for (const syntax::Variable& g : source_.globals) owners[key_of(g.name)].insert(key_of(g.resource));
  for (const auto& [name, resources] : owners)
    if (resources.size() > 1 && !resources.contains("")) shared_names_.insert(name);
  if (shared_names_.empty()) return;
  const std::vector<std::set<std::string>> mentions = all_mentions();
  const auto uses = [&](std::size_t unit) {
    return std::any_of(shared_names_.begin(), shared_names_.end(),
                       [&](const std::string& n) { return mentions[unit].contains(n); });
  };
  std::map<std::string, std::set<std::string>> run;  // resource -> names that its programs come to
  for (const syntax::Configuration& c : source_.configurations)
    for (const syntax::ProgramInstance& p : c.programs)
      if (const auto at = units_by_name_.find(key_of(p.type)); at != units_by_name_.end()) {
        const auto& all = mentions[static_cast<std::size_t>(at->second)];
        std::set<std::string>& names = run[key_of(p.resource)];
        names.insert(all.begin(), all.end());
        names.insert(key_of(p.type));
      }
  for (std::size_t unit = 0; unit < source_.units.size(); ++unit) {
    if (!uses(unit)) continue;
    const std::string key = key_of(source_.units[unit].name);
    bool first = true;
    for (const auto& [resource, names] : run) {
      if (!names.contains(key)) continue;
      by_resource_[{static_cast<int>(unit), resource}] = first ? static_cast<int>(unit) : copy_unit(unit);
      scopes_[first ? unit : scopes_.size() - 1].resource = resource;
      first = false;
    }
  }
  refuse_shared_types();
}

int Analyzer::copy_unit(std::size_t unit) {
  const syntax::Unit& source = source_.units[unit];
  UnitScope scope;
  scope.source = &source;
  scopes_.push_back(std::move(scope));
  ir::Unit copy;
  copy.kind = source.kind;
  copy.name = source.name;
  copy.at = source.location;
  program_.units.push_back(std::move(copy));
  instances_.push_back(0);
  return static_cast<int>(scopes_.size()) - 1;
}

// A TYPE is the same in all resources: it cannot hold instances of blocks that are not.
void Analyzer::refuse_shared_types() {
  for (const syntax::TypeDeclaration& d : source_.types) {
    std::set<std::string> names;
    Mentions(names).type(d.type);
    for (const auto& [unit, copy] : by_resource_) {
      const std::string& block = source_.units[static_cast<std::size_t>(unit.first)].name;
      if (copy != unit.first && names.contains(key_of(block)))
        report_.error(d.location, texts::kResourceType, {d.name, block});
    }
  }
}

}  // namespace servogate::plc::sema
