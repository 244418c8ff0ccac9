// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <utility>

#include "plc/sema/analyzer.hpp"
#include "plc/texts.hpp"

namespace servogate::plc::sema {

using syntax::Section;
using syntax::UnitKind;

namespace {
constexpr std::uint32_t kMaxBytes = 16u << 20;

std::uint32_t aligned(std::uint32_t at, std::uint32_t to) { return (at + to - 1) / to * to; }
}  // namespace

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

void Analyzer::resolve_types() {
  for (const auto& [key, index] : declared_types_) resolve_declared(index);
}

const Type* Analyzer::resolve_declared(std::size_t index) {
  if (resolved_[index] != nullptr) return resolved_[index];
  const syntax::TypeDeclaration& d = source_.types[index];
  if (resolving_[index]) {
    report_.error(d.location, texts::kTypeCycle, {d.name});
    return elementary(Kind::error);
  }
  resolving_[index] = true;
  const Type* t = resolve(d.type, d.name);
  if (d.initial && t->kind != Kind::error) {
    // Own identity, so that the initial value belongs to the name only.
    const std::vector<std::uint8_t> bytes = initial_bytes(*d.initial, *t);
    Type* own = types_->add(t->kind, d.name);
    const std::string name = own->name;
    *own = *t;
    own->name = name;
    own->image = bytes;
    if (!t->values.empty())
      for (auto& [value, owners] : enumerations_)
        std::replace(owners.begin(), owners.end(), t, static_cast<const Type*>(own));
    t = is_elementary(own->kind) && own->kind != Kind::enumeration && !own->bounded ? own : own;
  }
  resolved_[index] = t;
  return t;
}

const Type* Analyzer::resolve(const syntax::TypeReference& t, const std::string& name) {
  // What has no name of its own is one type for all variables of its list: x, y : (on, off);
  const bool nameless = name.empty() && (!t.values.empty() || key_of(t.name) == "STRUCT");
  // A structure may hold instances that are others in each resource; values are the same everywhere.
  const std::pair key(&t, t.values.empty() ? resource_here() : std::string());
  if (const auto known = nameless_.find(key); nameless && known != nameless_.end()) return known->second;
  const Type* type = resolve_written(t, name);
  if (nameless) nameless_[key] = type;
  return type;
}

const Type* Analyzer::resolve_written(const syntax::TypeReference& t, const std::string& name) {
  if (!t.values.empty()) return resolve_enumeration(t, name);
  if (key_of(t.name) == "ARRAY") return resolve_array(t);
  if (key_of(t.name) == "STRUCT") return resolve_structure(t, name);
  if (key_of(t.name) == "REF_TO" && t.element) return resolve_reference(t);
  const Type* named = resolve_named(t);
  if (t.low) return resolve_subrange(t, named, name);
  if (t.length && is_text(named->kind)) {
    const auto n = constant_integer(*t.length);
    if (!n) return elementary(Kind::error);
    if (*n >= 1 && *n <= kMaxStringCapacity)
      return types_->string(static_cast<std::uint32_t>(*n), named->kind);
    report_.error(t.location, texts::kStringLength, {std::to_string(*n), named->name});
    return elementary(Kind::error);
  }
  return named;
}

const Type* Analyzer::resolve_named(const syntax::TypeReference& t) {
  if (const Type* found = types_->find(t.name)) return found;
  const std::string key = key_of(t.name);
  if (const auto at = declared_types_.find(key); at != declared_types_.end())
    return resolve_declared(at->second);
  if (const int unit = unit_named(t.name);
      unit >= 0 && scopes_[static_cast<std::size_t>(unit)].source->kind == UnitKind::function_block) {
    UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
    if (u.laying_out) {
      report_.error(t.location, texts::kTypeCycle, {u.source->name});
      return elementary(Kind::error);
    }
    const int outer = current_;
    lay_out(unit);
    current_ = outer;
    return u.frame;
  }
  std::vector<std::string> names = {"BOOL",  "SINT", "INT",  "DINT",   "LINT",    "USINT", "UINT",  "UDINT",
                                    "ULINT", "BYTE", "WORD", "DWORD",  "LWORD",   "REAL",  "LREAL", "TIME",
                                    "DATE",  "TOD",  "DT",   "STRING", "WSTRING", "CHAR",  "WCHAR"};
  for (const auto& d : source_.types) names.push_back(d.name);
  for (const auto& u : source_.units)
    if (u.kind == UnitKind::function_block) names.push_back(u.name);
  report_.error(t.location, texts::kUnknownType, {t.name, syntax::suggestion(t.name, names)});
  return elementary(Kind::error);
}

const Type* Analyzer::resolve_array(const syntax::TypeReference& t) {
  const bool allowed = std::exchange(open_arrays_, false);
  const Type* element = resolve(*t.element);
  if (element->kind == Kind::error) return element;
  if (std::any_of(t.ranges.begin(), t.ranges.end(), [](const auto& r) { return r.first == nullptr; }))
    return resolve_open_array(t, element, allowed);
  for (auto r = t.ranges.rbegin(); r != t.ranges.rend(); ++r) {
    const auto low = constant_integer(*r->first), high = constant_integer(*r->second);
    if (!low || !high) return elementary(Kind::error);
    if (*high < *low) {
      report_.error(r->first->location, texts::kEmptyRange, {std::to_string(*low), std::to_string(*high)});
      return elementary(Kind::error);
    }
    const double bytes = (static_cast<double>(*high) - static_cast<double>(*low) + 1) * element->size;
    if (bytes > kMaxBytes) {
      report_.error(t.location, texts::kTooLarge,
                    {"ARRAY", text::number(bytes, 0), std::to_string(kMaxBytes)});
      return elementary(Kind::error);
    }
    element = types_->array(element, {*low, *high});
  }
  return element;
}

// ARRAY[*, *]: either all dimensions are open or none (6.5.3.4).
const Type* Analyzer::resolve_open_array(const syntax::TypeReference& t, const Type* element, bool allowed) {
  const bool all = std::all_of(t.ranges.begin(), t.ranges.end(), [](const auto& r) { return !r.first; });
  if (!all || !allowed) {
    report_.error(t.location, all ? texts::kOpenArrayPlace : texts::kOpenArrayMixed);
    return elementary(Kind::error);
  }
  for (std::size_t i = 0; i < t.ranges.size(); ++i) element = types_->open_array(element);
  return element;
}

const Type* Analyzer::limits_type() {
  if (limits_type_ != nullptr) return limits_type_;
  Type* t = types_->add(Kind::structure, "$limits");
  for (const char* name : {"low$", "high$", "stride$"}) append(*t, {name, elementary(Kind::lint)}, {});
  return limits_type_ = t;
}

std::uint32_t Analyzer::append(Type& owner, Field field, const Location& at) {
  const std::uint32_t align = field.reference ? 4 : std::max<std::uint32_t>(1, field.type->align);
  const std::uint32_t size = field.reference ? 4 : field.type->size;
  field.offset = aligned(owner.size, align);
  owner.size = field.offset + size;
  owner.align = std::max(owner.align, align);
  if (owner.size > kMaxBytes) {
    report_.error(at, texts::kTooLarge, {owner.name, std::to_string(owner.size), std::to_string(kMaxBytes)});
    field.offset = 0;
    owner.size = 0;
    owner.kind = Kind::error;  // whoever holds one of it is not the mistake
  }
  const std::uint32_t offset = field.offset;
  if (!field.reference) place_initial(owner.image, offset, *field.type, field.type->image);
  owner.add(std::move(field));
  return offset;
}

void Analyzer::place_initial(std::vector<std::uint8_t>& image, std::uint32_t offset, const Type& type,
                             const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return;
  if (image.size() < offset + type.size) image.resize(offset + type.size);
  std::copy(bytes.begin(), bytes.end(), image.begin() + offset);
}

// Relative places of members (table 11) say nothing that a program could see as long as none shares its bits
// with another: memory is laid out as here is usual.
void Analyzer::check_member_place(const syntax::Variable& m, const Type& type,
                                  std::vector<MemberBits>& taken) {
  const std::string& a = m.address;
  constexpr std::string_view sizes = "XBWDL";
  const std::size_t size = a.size() > 2 && a[0] == '%' ? sizes.find(a[1]) : std::string_view::npos;
  const std::size_t dot = std::min(a.find('.'), a.size());
  const auto number = [&](std::size_t from, std::size_t to) -> std::int64_t {
    const std::string digits = a.substr(from, to - from);
    const bool good =
        !digits.empty() && digits.size() < 7 && digits.find_first_not_of("0123456789") == std::string::npos;
    return good ? std::stoll(digits) : -1;
  };
  const std::int64_t index = size == std::string_view::npos ? -1 : number(2, dot);
  const std::int64_t bit = dot == a.size() ? 0 : number(dot + 1, a.size());
  if (index < 0 || bit < 0 || bit > 7 || (size != 0 && dot != a.size())) {
    report_.error(m.address_location, texts::kAddressMember, {a});
    return;
  }
  const std::int64_t low = (size < 2 ? index : index << (size - 1)) * 8 + bit;
  const std::int64_t bits = type.kind == Kind::boolean ? 1 : static_cast<std::int64_t>(type.size) * 8;
  for (const MemberBits& other : taken)
    if (low < other.high && other.low < low + bits)
      report_.error(m.address_location, texts::kAddressOverlap,
                    {a, other.member->address, other.member->name,
                     seen_at(other.member->address_location, m.address_location)});
  taken.push_back({low, low + bits, &m});
}

const Type* Analyzer::resolve_structure(const syntax::TypeReference& t, const std::string& name) {
  Type* s = types_->add(Kind::structure, name.empty() ? "STRUCT" : name);
  const auto declared = declared_types_.find(key_of(name));
  if (declared != declared_types_.end() && !source_.types[declared->second].initial)
    open_types_[key_of(name)] = s;
  std::vector<MemberBits> taken;
  for (const syntax::Variable& m : t.members) {
    if (s->field(m.name) != nullptr) {
      report_.error(m.location, texts::kDuplicate, {m.name, seen_at(t.location, m.location)});
      continue;
    }
    const Type* type = resolve(*m.type);
    if (!m.address.empty()) check_member_place(m, *type, taken);
    const std::uint32_t offset = append(*s, {m.name, type, 0, false, false}, m.location);
    if (m.initial && type->kind != Kind::error)
      place_initial(s->image, offset, *type, initial_bytes(*m.initial, *type));
  }
  s->size = std::max<std::uint32_t>(1, aligned(s->size, s->align));
  if (!s->image.empty()) s->image.resize(s->size);
  open_types_.erase(key_of(name));
  return s;
}

const Type* Analyzer::resolve_enumeration(const syntax::TypeReference& t, const std::string& name) {
  const Type* base = elementary(Kind::int_);
  if (!t.name.empty()) base = resolve_named(t);
  const bool counts = is_integer(base->kind) || is_bits(base->kind);
  if (!counts && !is_real(base->kind) && !is_temporal(base->kind) && base->kind != Kind::error) {
    report_.error(t.location, texts::kNamedBase, {base->name});
    return elementary(Kind::error);
  }
  if (base->kind == Kind::error) return base;
  // With a base it is that type, with names for some of its values (6.4.4.3); without one it has no others.
  Type* e = types_->add(t.name.empty() ? Kind::enumeration : base->kind, name.empty() ? "enumeration" : name);
  e->base = elementary(base->kind);
  e->size = e->align = base->size;
  std::int64_t next = 0;
  for (std::size_t i = 0; i < t.values.size(); ++i) {
    const auto& [value_name, value] = t.values[i];
    if (e->value_named(value_name) != nullptr)
      report_.error(t.value_locations[i], texts::kDuplicate,
                    {value_name, seen_at(t.location, t.value_locations[i])});
    if (!counts) {  // each has a value of its own
      const auto given = value ? constant(*value, e->base, e) : std::nullopt;
      if (!value) report_.error(t.value_locations[i], texts::kNamedValue, {value_name, base->name});
      next = 0;
      if (given) store_constant(*base, *given, reinterpret_cast<std::uint8_t*>(&next));
      e->add(EnumValue{value_name, next});
      enumerations_[key_of(value_name)].push_back(e);
      continue;
    }
    if (value && !t.name.empty()) {
      if (const auto given = constant(*value, e->base, e)) next = given->i;
    } else if (value) {
      if (const auto given = constant_integer(*value)) next = *given;
    }
    std::int64_t low = 0;
    std::uint64_t high = 0;
    integer_limits(base->kind, low, high);
    if (next < low || (next > 0 && static_cast<std::uint64_t>(next) > high))
      report_.error(t.value_locations[i], texts::kLiteralRange,
                    {std::to_string(next), base->name, std::to_string(low), std::to_string(high)});
    e->add(EnumValue{value_name, next++});
    enumerations_[key_of(value_name)].push_back(e);
  }
  // The initial value of an enumeration is its first one (IEC 61131-3, 6.4.4.2).
  if (!e->values.empty() && e->values[0].value != 0) {
    e->image.resize(e->size);
    std::memcpy(e->image.data(), &e->values[0].value, e->size);
  }
  return e;
}

const Type* Analyzer::resolve_subrange(const syntax::TypeReference& t, const Type* base,
                                       const std::string& name) {
  const auto low = constant_integer(*t.low), high = constant_integer(*t.high);
  if (base->kind == Kind::error || !low || !high) return elementary(Kind::error);
  if (!is_integer(base->kind)) {
    report_.error(t.location, texts::kSubrangeBase, {base->name});
    return elementary(Kind::error);
  }
  if (*high < *low) {
    report_.error(t.low->location, texts::kEmptyRange, {std::to_string(*low), std::to_string(*high)});
    return elementary(Kind::error);
  }
  const std::string shown = base->name + "(" + std::to_string(*low) + ".." + std::to_string(*high) + ")";
  std::int64_t least = 0;
  std::uint64_t most = 0;
  integer_limits(base->kind, least, most);
  for (const std::int64_t v : {*low, *high})
    if (v < least || (v > 0 && static_cast<std::uint64_t>(v) > most)) {
      report_.error(t.low->location, texts::kLiteralRange,
                    {std::to_string(v), base->name, std::to_string(least), std::to_string(most)});
      return elementary(Kind::error);
    }
  Type* s = types_->add(base->kind, name.empty() ? shown : name);
  s->size = s->align = base->size;
  s->bounded = true;
  s->limits = {*low, *high};
  s->base = elementary(base->kind);
  if (*low > 0 || *high < 0) {  // the initial value is the lower limit (6.4.4.4)
    s->image.resize(s->size);
    std::memcpy(s->image.data(), &s->limits.low, s->size);
  }
  return s;
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
