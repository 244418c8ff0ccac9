// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

/// The paths of VAR_ACCESS and VAR_CONFIG, and AT %I*, %Q*, %M* (IEC 61131-3:2013, 6.5.5.3 and 6.8.2): each
/// instance holds the address of its place, which VAR_CONFIG names. None is ever without: a missing location
/// does not compile.
namespace servogate::plc::sema {

using image::Packet;
using image::Writer;

bool Analyzer::declare_unlocated(UnitScope& u, Variable& v, const syntax::Variable& s) {
  if (!s.address.ends_with("*")) return false;
  if (s.section != syntax::Section::local || u.source->kind == syntax::UnitKind::function) {
    v.type = elementary(Kind::error);  // reported
    return true;
  }
  v.area = key_of(s.address);
  if (!is_elementary(v.type->kind) || is_text(v.type->kind) || v.type->kind == Kind::enumeration) {
    report_.error(s.address_location, texts::kLocationType, {s.name, v.type->name, v.area});
    v.type = elementary(Kind::error);
    return true;
  }
  v.root = ir::Root::reference;
  v.cell = append(*u.frame, {s.name, v.type, 0, false, true, s.constant, true}, s.location);
  return true;
}

// From a variable to one of its members or elements.
bool Analyzer::path_step(const syntax::PathDeclaration& p, std::size_t part, Reached& out) {
  const std::string& name = p.path[part];
  const Type& t = *out.type;
  const bool subscript = name[0] == '[';
  const std::int64_t i = subscript ? std::strtoll(name.c_str() + 1, nullptr, 10) : 0;
  const Field* f = subscript ? nullptr : t.field(name);
  const bool last = part + 1 == p.path.size();
  const bool element = subscript && t.kind == Kind::array && i >= t.range.low && i <= t.range.high;
  const bool member = f != nullptr && (!f->reference || (f->located && last));
  if (!element && !member) {
    report_.error(p.path_location, texts::kNoMember, {t.name, name, ""});
    return false;
  }
  if (element) {
    out.cell += static_cast<std::uint32_t>(i - t.range.low) * t.base->size;
    out.type = t.base;
  } else {
    if (f->located) out.owner = &t;
    out.cell += f->offset;
    out.type = f->type;
  }
  out.name += (subscript ? "" : ".") + name;
  return true;
}

// A variable of a configured program, or a global one, by its path; the name of the resource may lead it.
std::optional<Analyzer::Reached> Analyzer::reach_path(const syntax::Configuration& c,
                                                      const syntax::PathDeclaration& p) {
  std::size_t at = 0;
  for (const std::string& r : c.resources)
    if (p.path.size() > 1 && same_name(p.path[0], r)) at = 1;
  const auto programs =
      std::find_if(program_.programs.begin(), program_.programs.end(), [&](const ir::Global& g) {
        return same_name(g.name, p.path[at]) || (at == 1 && same_name(g.name, p.path[0] + "." + p.path[1]));
      });
  const auto globals =
      std::find_if(program_.globals.begin(), program_.globals.end(), [&](const ir::Global& g) {
        return g.place < 0 &&
               (same_name(g.name, p.path[at]) || (at == 1 && same_name(g.name, p.path[0] + "." + p.path[1])));
      });
  const bool program = programs != program_.programs.end();
  if (!program && globals == program_.globals.end()) {
    report_.error(p.path_location, texts::kUnknownName, {p.path[at], ""});
    return std::nullopt;
  }
  const ir::Global& first = program ? *programs : *globals;
  Reached out{first.address, first.type, nullptr, first.name};
  for (++at; at < p.path.size(); ++at)
    if (!path_step(p, at, out)) return std::nullopt;
  const Type* declared = resolve(p.type);
  if (declared->kind == Kind::error) return std::nullopt;
  if (conversion(*declared, *out.type) != Conversion::same) {
    report_.error(p.path_location, texts::kExternalType, {p.path.back(), out.type->name, declared->name});
    return std::nullopt;
  }
  return out;
}

// VAR_CONFIG gives one instance an initial value or a location; VAR_ACCESS a variable a second name.
void Analyzer::configured_paths(const syntax::Configuration& c) {
  current_ = -1;
  for (const syntax::PathDeclaration& p : c.paths) {
    if (!p.name.empty()) continue;
    const std::size_t errors = report_.errors();
    const auto found = reach_path(c, p);
    if (!found) {
      // reported
    } else if (!p.address.empty() && found->owner == nullptr) {
      report_.error(p.address_location, texts::kNotLocatable, {found->name});
    } else if (!p.address.empty()) {
      locate(p, *found);
    } else if (p.initial && found->owner == nullptr) {  // without a location: reported later
      const std::vector<std::uint8_t> bytes = initial_bytes(*p.initial, *found->type);
      std::copy(bytes.begin(), bytes.end(), program_.memory.begin() + found->cell);
    }
    // What it was meant for has no location then, which is no second mistake.
    misplaced_ = misplaced_ || (report_.errors() != errors && !p.address.empty());
  }
  for (const syntax::PathDeclaration& p : c.paths) {
    if (p.name.empty()) continue;
    const auto found = reach_path(c, p);
    if (!found) continue;
    const auto located = locations_.find(found->cell);
    if (found->owner == nullptr)
      program_.globals.push_back({p.name, found->type, found->cell, -1, false});
    else if (located != locations_.end())
      program_.globals.push_back(
          {p.name, found->type, 0, static_cast<std::int32_t>(located->second.place), false});
  }
}

// %I, %Q and %M by their letter; a point of the machine by who writes it, other places by their half of A.
bool Analyzer::lies_in(const std::string& area, const image::Place& place, const std::string& address) const {
  if (address[0] == '%') return key_of(address)[1] == area[1];
  if (place.packet != Packet::a) return area == "%M*";
  for (const image::Symbol& s : symbols_)
    if (s.place.overlaps(place) && s.writer != Writer::program)
      return area == (s.writer == Writer::plc ? "%Q*" : "%I*");
  return area == (place.byte() < image::kPacketASize / 2 ? "%I*" : "%Q*");
}

// The cell lies in the instance of the block or program that declares the variable.
void Analyzer::locate(const syntax::PathDeclaration& p, const Reached& found) {
  const UnitScope& u = scopes_[static_cast<std::size_t>(found.owner->block)];
  const Variable& v = u.variables[u.by_name.at(key_of(p.path.back()))];
  if (locations_.contains(found.cell)) {
    report_.error(p.path_location, texts::kTwice, {found.name});
    return;
  }
  Configured& c = locations_[found.cell];
  c = {&v, found.owner->block, -1, found.name, p.address_location};
  syntax::Variable given;
  given.name = found.name;
  given.location = p.path_location;
  given.address = p.address;
  given.address_location = p.address_location;
  for (const syntax::Variable& s : u.source->variables)
    if (same_name(s.name, v.name)) {
      given.retain = s.retain;
      if (s.initial) given.initial = syntax::copy(*s.initial);
    }
  if (p.initial) given.initial = syntax::copy(*p.initial);
  if (v.area == "%I*") given.initial = nullptr;
  Variable out;
  out.type = v.type;
  declare_located(out, given, true);
  if (out.type->kind == Kind::error) return;
  ir::SharedPlace& s = program_.places[out.cell];
  s.configured = true;
  if (!lies_in(v.area, s.place, p.address)) {
    report_.error(p.address_location, texts::kLocationArea, {found.name, v.area, p.address});
    return;
  }
  for (const auto& [cell, other] : locations_) {  // several blocks may look at one input
    if (other.place < 0 || (v.area == "%I*" && other.variable->area == v.area)) continue;
    const ir::SharedPlace& taken = program_.places[static_cast<std::size_t>(other.place)];
    if (taken.place.overlaps(s.place))
      report_.error(p.address_location, texts::kLocationOverlap, {p.address, found.name, other.name});
  }
  c.place = static_cast<std::int32_t>(out.cell);
}

// Instances that do not last (of functions, VAR_TEMP) cannot have a location.
void Analyzer::find_missing(const std::string& name, const Type& type, std::uint32_t address, bool lasting,
                            Missing& out) {
  if (!type.holds_location) return;
  report_.go_on();
  if (type.kind == Kind::array) {
    for (std::int64_t i = type.range.low; i <= type.range.high; ++i)
      find_missing(name + "[" + std::to_string(i) + "]", *type.base,
                   address + static_cast<std::uint32_t>(i - type.range.low) * type.base->size, lasting, out);
    return;
  }
  for (const Field& f : type.fields) {
    const Variable* v = nullptr;
    if (type.kind == Kind::block) {
      const UnitScope& u = scopes_[static_cast<std::size_t>(type.block)];
      if (const auto at = u.by_name.find(key_of(f.name)); at != u.by_name.end()) v = &u.variables[at->second];
    }
    const bool lasts = lasting && (v == nullptr || v->section != syntax::Section::temp);
    const std::string path = name + "." + f.name;
    if (!f.located && !f.reference)
      find_missing(path, *f.type, address + f.offset, lasts, out);
    else if (f.located && !lasts)
      report_.error(v->at, texts::kNoLasting, {path, v->area});
    else if (f.located && !locations_.contains(address + f.offset))
      out[v].push_back(path);
  }
}

// After all bodies: what one of them writes is written at every place that its instances have.
void Analyzer::check_locations() {
  Missing missing;
  for (const ir::Global& p : program_.programs) find_missing(p.name, *p.type, p.address, true, missing);
  for (const Variable& g : globals_)
    if (g.root == ir::Root::fixed) find_missing(g.name, *g.type, g.cell, true, missing);
  for (const UnitScope& u : scopes_)
    if (u.frame != nullptr && u.source->kind == syntax::UnitKind::function)
      find_missing(u.source->name, *u.frame, 0, false, missing);
  if (misplaced_) missing.clear();
  constexpr std::size_t kShown = 4;
  for (const auto& [v, paths] : missing) {  // one message for each declaration, with those it is missing for
    std::string shown;
    for (std::size_t i = 0; i < std::min(paths.size(), kShown); ++i)
      shown += (i == 0 ? "'" : ", '") + paths[i] + "'";
    if (paths.size() > kShown) shown += ", ... (" + std::to_string(paths.size()) + ")";
    report_.error(v->at, texts::kNoLocation, {shown, paths[0], v->area.substr(0, 2)});
  }
  current_ = -1;
  for (const auto& [cell, c] : locations_) {
    if (c.place < 0 || !c.variable->written || c.variable->area == "%I*") continue;
    const auto place = static_cast<std::uint32_t>(c.place);
    check_place_writer(place, c.at, c.name);
    if (!place_writers_[place].empty()) place_writers_[place].insert(c.unit);  // others write it by its name
  }
}

void Analyzer::bind_locations() {
  for (const auto& [cell, c] : locations_)
    if (c.place >= 0)
      std::memcpy(program_.memory.data() + cell, &program_.places[static_cast<std::size_t>(c.place)].address,
                  sizeof(std::uint32_t));
}

}  // namespace servogate::plc::sema
