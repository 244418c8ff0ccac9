// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <utility>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using syntax::Section;
using syntax::UnitKind;

Analyzer::Analyzer(const syntax::Source& source, const std::vector<image::Symbol>& symbols,
                   const Options& options, int library_file, syntax::Report& report)
    : source_(source), symbols_(symbols), options_(options), library_file_(library_file), report_(report) {
  program_.types = std::make_shared<TypeTable>();
  types_ = program_.types.get();
  program_.files = report.files();
  program_.memory.assign(16, 0);
  for (std::size_t i = 0; i < symbols.size(); ++i) symbols_by_name_.emplace(key_of(symbols[i].name), i);
}

ir::Program Analyzer::run() {
  declare_names();
  part_resources();
  declare_globals(true);  // limits of types may be global constants
  resolve_types();
  declare_globals(false);
  for (std::size_t u = 0; u < scopes_.size(); ++u) lay_out(static_cast<int>(u));
  if (source_.configurations.empty())
    default_task();
  else
    configured_tasks();
  for (std::size_t u = 0; u < scopes_.size(); ++u)
    if (scopes_[u].source != nullptr) body(static_cast<int>(u));
  check_locations();
  check_references();
  check_block_tasks();
  check_recursion();
  check_writers();
  check_usage();
  lay_out_places();
  bind_locations();
  bind_references();
  return std::move(program_);
}

// Where something stands: its line, with the file where that is another one.
std::string Analyzer::seen_at(const Location& there, const Location& here) const {
  const std::string line = std::to_string(there.line);
  if (there.file == here.file) return text::both("line " + line, "строке " + line);
  return program_.files[static_cast<std::size_t>(there.file)] + ":" + line;
}

namespace {
// An enumeration whose names a standard one has as well, and that gives them no numbers of its own.
bool within_standard(const syntax::TypeReference& own, const syntax::TypeReference& standard) {
  return !own.values.empty() && std::all_of(own.values.begin(), own.values.end(), [&](const auto& v) {
    return v.second == nullptr && std::any_of(standard.values.begin(), standard.values.end(),
                                              [&](const auto& w) { return same_name(v.first, w.first); });
  });
}
}  // namespace

void Analyzer::declare_names() {
  for (std::size_t i = 0; i < source_.types.size(); ++i) {
    const auto& d = source_.types[i];
    if (types_->find(d.name) != nullptr)
      report_.error(d.location, texts::kReserved, {d.name});
    else if (const auto [at, fresh] = declared_types_.emplace(key_of(d.name), i); fresh)
      continue;
    else if (d.location.file == library_file_ && within_standard(source_.types[at->second].type, d.type)) {
      report_.warning(source_.types[at->second].location, texts::kStandardTaken, {d.name});
      at->second = i;
    } else if (d.location.file == library_file_) {
      report_.error(source_.types[at->second].location, texts::kReserved, {d.name});
      at->second = i;  // what follows speaks of the standard one
    } else
      report_.error(d.location, texts::kDuplicate,
                    {d.name, seen_at(source_.types[at->second].location, d.location)});
  }
  resolved_.resize(source_.types.size());
  resolving_.resize(source_.types.size());
  for (std::size_t i = 0; i < source_.units.size(); ++i) {
    const syntax::Unit& s = source_.units[i];
    UnitScope u;
    u.source = &s;
    u.from_library = s.location.file == library_file_;
    const auto known = units_by_name_.find(key_of(s.name));
    if (types_->find(s.name) != nullptr) {
      report_.error(s.location, texts::kReserved, {s.name});
    } else if (declared_types_.contains(key_of(s.name))) {
      report_.error(s.location, texts::kDuplicate,
                    {s.name, seen_at(source_.types[declared_types_[key_of(s.name)]].location, s.location)});
    } else if (known != units_by_name_.end() && !u.from_library) {
      report_.error(
          s.location, texts::kDuplicate,
          {s.name, seen_at(source_.units[static_cast<std::size_t>(known->second)].location, s.location)});
    } else if (known == units_by_name_.end()) {
      units_by_name_[key_of(s.name)] = static_cast<int>(i);
    }
    scopes_.push_back(std::move(u));
    ir::Unit unit;
    unit.kind = s.kind;
    unit.name = s.name;
    unit.at = s.location;
    program_.units.push_back(std::move(unit));
  }
  instances_.assign(scopes_.size(), 0);
}

std::uint32_t Analyzer::allocate(const Type& type) {
  const std::uint32_t address =
      aligned(static_cast<std::uint32_t>(program_.memory.size()), std::max<std::uint32_t>(type.align, 1));
  if (address + type.size > 4 * kMaxBytes) {
    report_.error({}, texts::kTooLarge,
                  {type.name, std::to_string(address + type.size), std::to_string(4 * kMaxBytes)});
    return 0;
  }
  program_.memory.resize(address + type.size);
  std::copy(type.image.begin(), type.image.end(), program_.memory.begin() + address);
  return address;
}

void Analyzer::check_sections(const UnitScope& u, const syntax::Variable& v) {
  const char* names[] = {"PROGRAM", "FUNCTION", "FUNCTION_BLOCK"};
  const char* kind = names[static_cast<int>(u.source->kind)];
  if (!v.address.empty() && v.section != Section::local)
    report_.error(v.address_location, texts::kAddressSection);
  if (u.source->kind == UnitKind::function && v.retain)
    report_.error(v.location, texts::kSectionPlace, {"RETAIN", kind});
  if (u.source->kind == UnitKind::function && !v.address.empty())
    report_.error(v.address_location, texts::kSectionPlace, {"AT", kind});
}

void Analyzer::declare_variable(UnitScope& u, const syntax::Variable& s) {
  report_.go_on();
  const auto [at, fresh] = u.by_name.emplace(key_of(s.name), u.variables.size());
  if (!fresh) {
    report_.error(s.location, texts::kDuplicate, {s.name, seen_at(u.variables[at->second].at, s.location)});
    return;
  }
  check_sections(u, s);
  Variable v;
  v.name = s.name;
  v.at = s.location;
  v.section = s.section;
  v.constant = s.constant;
  v.retain = s.retain;
  v.edge = s.edge;
  const bool function = u.source->kind == UnitKind::function;
  open_arrays_ = s.section == Section::in_out || (s.section == Section::input && function);
  v.type = s.type ? resolve(*s.type) : elementary(Kind::error);
  open_arrays_ = false;
  if (v.retain && v.type->holds_reference) report_.error(s.location, texts::kReferenceRetain, {s.name});
  const bool alias = s.section == Section::external;
  if (alias) {
    const auto g = globals_by_name_.find(global_key(s.name));
    const image::Symbol* sym = g == globals_by_name_.end() ? symbol(s.name) : nullptr;
    if (g == globals_by_name_.end() && sym == nullptr) {
      report_.error(s.location, texts::kNoExternal, {s.name});
      v.type = elementary(Kind::error);
    } else {
      const Type* real = sym != nullptr ? type_of(sym->place) : globals_[g->second].type;
      if (real != v.type && v.type->kind != Kind::error && real->kind != Kind::error) {
        report_.error(s.location, texts::kExternalType, {s.name, real->name, v.type->name});
        v.type = elementary(Kind::error);  // whichever was meant, uses of it are not the mistake
        v.used = true;
        if (sym == nullptr) globals_[g->second].used = true;
      } else {
        v.type = real;
      }
    }
  } else if (v.type->kind != Kind::error) {
    if (s.edge != 0 && (s.section != Section::input || v.type->kind != Kind::boolean))
      report_.error(s.location, texts::kEdgeType);
    if (s.initial) v.initial = initial_bytes(s, *v.type, !function);
    if (v.constant && is_elementary(v.type->kind) && s.initial) v.value = constant(*s.initial, v.type);
    if (!s.address.empty()) {
      if (!declare_unlocated(u, v, s)) declare_located(v, s);
    } else {
      const bool instance = s.section == Section::input && v.type->kind == Kind::block;
      const bool reference = s.section == Section::in_out || v.type->open || instance;
      v.root = reference ? ir::Root::reference : ir::Root::instance;
      v.cell = append(*u.frame, {s.name, v.type, 0, s.retain, reference, s.constant, false, s.non_retain},
                      s.location);
      if (!reference) place_initial(u.frame->image, v.cell, *v.type, v.initial);
      keep_references(u.frame, v.cell);
      if (v.type->open) append(*u.frame, {s.name + "$limits", limits_type(), 0, false, true}, s.location);
    }
  }
  if (v.constant && !s.initial && !alias && v.type->kind != Kind::error) {
    report_.warning(s.location, texts::kNoValueGiven, {s.name});
    if (is_elementary(v.type->kind)) {
      std::vector<std::uint8_t> bytes = v.type->image;
      bytes.resize(v.type->size);
      v.value = stored_constant(*v.type, bytes.data());
    }
  }
  u.variables.push_back(std::move(v));
}

// R_EDGE and F_EDGE: the value of the last call, beside the input (6.5.3).
void Analyzer::declare_edge(UnitScope& u, const syntax::Variable& s) {
  if (s.edge == 0 || s.section != Section::input) return;
  Variable v;
  v.name = s.name + "$last";
  v.at = s.location;
  v.type = elementary(Kind::boolean);
  v.used = v.written = true;
  u.by_name[key_of(v.name)] = u.variables.size();
  v.cell = append(*u.frame, {v.name, v.type, 0, false, false}, v.at);
  // As F_TRIG, an F_EDGE input that is FALSE at the first call has fallen (table 44).
  if (s.edge < 0) place_initial(u.frame->image, v.cell, *v.type, {1});
  u.variables.push_back(std::move(v));
}

void Analyzer::lay_out(int index) {
  UnitScope& u = scopes_[static_cast<std::size_t>(index)];
  if (u.ready || u.laying_out || u.source == nullptr) return;
  u.laying_out = true;
  const int outer = current_;
  current_ = index;
  u.frame = types_->add(Kind::block, u.source->name);
  u.frame->block = index;
  ir::Unit& unit = program_.units[static_cast<std::size_t>(index)];
  unit.frame = u.frame;
  const bool function = u.source->kind == UnitKind::function;
  // Limits of arrays and values may name constants that stand further down.
  // (REF, lists and records may name variables instead.)
  const auto is_constant = [](const syntax::Variable& v) {
    using syntax::ExpressionKind;
    const ExpressionKind kind = v.initial ? v.initial->kind : ExpressionKind::literal;
    return v.constant && v.section == Section::local && kind != ExpressionKind::call &&
           kind != ExpressionKind::list && kind != ExpressionKind::record;
  };
  for (const bool constants : {true, false})
    for (const syntax::Variable& v : u.source->variables) {
      if (is_constant(v) != constants) continue;
      declare_variable(u, v);
      declare_edge(u, v);
    }
  if (function) {
    u.result = u.source->result ? resolve(*u.source->result) : elementary(Kind::none);
    if (u.result->kind == Kind::block) {
      report_.error(u.source->result->location, texts::kInstanceCopy, {u.result->name});
      u.result = elementary(Kind::error);
    }
    if (u.result->kind != Kind::none) {
      u.result_variable = static_cast<int>(u.variables.size());
      Variable r;
      r.name = u.source->name;
      r.at = u.source->location;
      r.type = u.result;
      r.used = true;
      const auto [at, fresh] = u.by_name.emplace(key_of(r.name), u.variables.size());
      if (!fresh) {
        report_.error(
            u.variables[at->second].at, texts::kDuplicate,
            {u.variables[at->second].name, seen_at(u.source->location, u.variables[at->second].at)});
        at->second = u.variables.size();
      }
      r.cell = append(*u.frame, {r.name, r.type, 0, false, false}, r.at);
      u.variables.push_back(std::move(r));
    }
  }
  u.frame->size = std::max<std::uint32_t>(1, aligned(u.frame->size, u.frame->align));
  if (!u.frame->image.empty()) u.frame->image.resize(u.frame->size);
  for (const Variable& v : u.variables) {
    const bool own = v.section == Section::temp ||
                     (function && (v.section == Section::local || v.section == Section::output));
    if (own && v.root == ir::Root::instance && !v.constant && v.type->kind != Kind::error)
      unit.resets.push_back({v.cell, v.type->size});
  }
  if (function) unit.fixed_base = allocate(*u.frame);
  u.laying_out = false;
  u.ready = true;
  current_ = outer;
}

void Analyzer::declare_globals(bool constants) {
  current_ = -1;
  for (syntax::Variable s : source_.globals) {
    if (s.constant != constants) continue;
    report_.go_on();
    resource_ = s.resource;
    if (shared_names_.contains(key_of(s.name))) s.name = s.resource + "." + s.name;
    const auto [at, fresh] = globals_by_name_.emplace(key_of(s.name), globals_.size());
    if (!fresh) {
      const bool resources = s.resource != globals_[at->second].resource;
      report_.error(s.location, resources ? texts::kGlobalTwice : texts::kDuplicate,
                    {s.name, seen_at(globals_[at->second].at, s.location)});
      continue;
    }
    Variable v;
    v.name = s.name;
    v.at = s.location;
    v.resource = s.resource;
    v.section = Section::global;
    v.constant = s.constant;
    v.retain = s.retain;
    v.root = ir::Root::fixed;
    v.type = resolve(*s.type);
    if (v.retain && v.type->holds_reference) report_.error(s.location, texts::kReferenceRetain, {s.name});
    if (v.type->kind != Kind::error) {
      if (s.initial) v.initial = initial_bytes(s, *v.type, true);
      if (v.constant && is_elementary(v.type->kind) && s.initial) v.value = constant(*s.initial, v.type);
      if (s.address.ends_with("*")) {
        report_.error(s.address_location, texts::kUnlocatedGlobal, {s.address});
        v.type = elementary(Kind::error);
      } else if (!s.address.empty()) {
        declare_located(v, s);
      } else {
        v.cell = allocate(*v.type);
        keep_references(nullptr, v.cell);
        std::copy(v.initial.begin(), v.initial.end(), program_.memory.begin() + v.cell);
        program_.globals.push_back({v.name, v.type, v.cell, -1, v.retain, v.constant});
      }
    }
    globals_.push_back(std::move(v));
  }
  resource_.clear();
}

}  // namespace servogate::plc::sema
