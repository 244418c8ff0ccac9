// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <utility>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using syntax::UnitKind;

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

}  // namespace servogate::plc::sema
