// SPDX-License-Identifier: Apache-2.0
#include "plc/variables/lookup.hpp"

#include <algorithm>
#include <cstring>

#include "plc/syntax/parser.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {

namespace {

using syntax::Expression;
using syntax::ExpressionKind;

/// One part of a path: a name, a subscript or a bit.
struct Part {
  std::string name;
  std::int64_t number = 0;
  bool index = false, bit = false;
};

bool take_apart(const Expression& e, std::vector<Part>& out) {
  Part p;
  switch (e.kind) {
    case ExpressionKind::name:
    case ExpressionKind::direct:
      p.name = e.name;
      out.push_back(p);
      return true;
    case ExpressionKind::member:
      if (!take_apart(*e.operands[0], out)) return false;
      p.name = e.name;
      out.push_back(p);
      return true;
    case ExpressionKind::bit:
      if (!take_apart(*e.operands[0], out)) return false;
      p.bit = true;
      p.number = static_cast<std::int64_t>(e.literal.magnitude);
      out.push_back(p);
      return true;
    case ExpressionKind::index:
      if (!take_apart(*e.operands[0], out)) return false;
      for (std::size_t i = 1; i < e.operands.size(); ++i) {
        const syntax::Literal& l = e.operands[i]->literal;
        if (e.operands[i]->kind != ExpressionKind::literal || l.kind != Kind::untyped_int) return false;
        Part index;
        index.index = true;
        index.number = static_cast<std::int64_t>(l.negative ? 0 - l.magnitude : l.magnitude);
        out.push_back(index);
      }
      return true;
    default:
      return false;
  }
}

// The place whose address stands in the cell of a variable AT %Q*.
Handle located(const Image& image, std::uint32_t cell, const Type* type) {
  Handle h;
  std::memcpy(&h.address, image.memory.data() + cell, sizeof h.address);
  h.type = type;
  for (std::size_t i = 0; i < image.places.size(); ++i)
    if (image.places[i].address == h.address && image.places[i].type == type)
      h.place = static_cast<std::int32_t>(i);
  return h;
}

std::optional<Handle> find_global(const Image& image, const std::string& prefix,
                                  const std::vector<Part>& parts);

// Follows the rest of a path from a variable.
std::optional<Handle> follow(const Image& image, Handle h, const std::vector<Part>& parts, std::size_t at) {
  for (; at < parts.size(); ++at) {
    const Part& p = parts[at];
    const Type& t = *h.type;
    if (h.bit >= 0) return std::nullopt;
    if (p.index) {
      if (t.kind != Kind::array || p.number < t.range.low || p.number > t.range.high) return std::nullopt;
      h.address += static_cast<std::uint32_t>(p.number - t.range.low) * t.base->size;
      h.type = t.base;
    } else if (p.bit) {
      if (!(is_bits(t.kind) || is_integer(t.kind)) || p.number >= t.size * 8) return std::nullopt;
      h.address += static_cast<std::uint32_t>(p.number / 8);
      h.bit = static_cast<std::int8_t>(p.number % 8);
      h.type = image.types->elementary(Kind::boolean);
      return at + 1 == parts.size() ? std::optional(h) : std::nullopt;
    } else {
      const Field* f = t.field(p.name);
      if (f == nullptr && t.kind == Kind::block && at > 0)  // AT an address, the same for all instances
        return find_global(image, t.name + ".",
                           {parts.begin() + static_cast<std::ptrdiff_t>(at), parts.end()});
      if (f == nullptr || (f->reference && !f->located)) return std::nullopt;
      h.address += f->offset;
      h.type = f->type;
      if (f->located) h = located(image, h.address, f->type);
    }
  }
  return h;
}

Handle handle_of(const Image& image, const ir::Global& g) {
  Handle h;
  h.address = g.address;
  h.place = g.place;
  h.type = g.type;
  if (g.place >= 0) {
    const Image::Shared& s = image.places[static_cast<std::size_t>(g.place)];
    if (s.raw && s.place.format == image::Format::bl) h.bit = static_cast<std::int8_t>(s.place.bit());
  }
  return h;
}

std::optional<Handle> find_global(const Image& image, const std::string& prefix,
                                  const std::vector<Part>& parts) {
  std::string dotted = prefix + parts[0].name;
  std::vector<std::string> names = {dotted};
  for (std::size_t i = 1; i < parts.size() && !parts[i].index && !parts[i].bit; ++i)
    names.push_back(dotted += "." + parts[i].name);
  for (std::size_t n = names.size(); n-- > 0;)
    for (const ir::Global& g : image.globals)
      if (same_name(g.name, names[n])) return follow(image, handle_of(image, g), parts, n + 1);
  return std::nullopt;
}

// The path below `type` that ends at an address.
bool path_to(const Type& type, std::uint32_t base, const Handle& h, std::string& out) {
  if (h.bit < 0 && base == h.address && &type == h.type) return true;
  if (type.kind != Kind::structure && type.kind != Kind::block && type.kind != Kind::array) {
    if (h.bit >= 0) out += "." + std::to_string((h.address - base) * 8 + static_cast<std::uint32_t>(h.bit));
    return h.bit >= 0 || base == h.address;
  }
  if (h.address < base || h.address >= base + type.size) return false;
  if (type.kind == Kind::array) {
    const std::uint32_t i = (h.address - base) / type.base->size;
    out += "[" + std::to_string(type.range.low + i) + "]";
    return path_to(*type.base, base + i * type.base->size, h, out);
  }
  for (const Field& f : type.fields)
    if (!f.reference && h.address >= base + f.offset && h.address < base + f.offset + f.type->size) {
      out += "." + f.name;
      return path_to(*f.type, base + f.offset, h, out);
    }
  return false;
}

}  // namespace

std::optional<Handle> find_variable(const Image& image, std::string_view path) {
  const syntax::ExpressionPtr e = syntax::parse_path(path);
  std::vector<Part> parts;
  if (!e || !take_apart(*e, parts)) return std::nullopt;
  const ir::Global* only = image.programs.size() == 1 ? image.programs.data() : nullptr;
  if (only != nullptr) {  // bare names belong to the single program, as inside it
    if (auto found = follow(image, {only->address, -1, -1, only->type}, parts, 0)) return found;
    if (auto found = find_global(image, only->type->name + ".", parts)) return found;  // AT an address
  }
  if (auto found = find_global(image, "", parts)) return found;
  for (const ir::Global& p : image.programs) {
    std::size_t n = 1;
    std::string name = parts[0].name;
    if (p.name.find('.') != std::string::npos && parts.size() > 1) name += "." + parts[n++].name;  // resource
    if (!same_name(p.name, name) || parts.size() <= n) continue;
    if (auto found = follow(image, {p.address, -1, -1, p.type}, parts, n)) return found;
    const std::vector<Part> rest(parts.begin() + static_cast<std::ptrdiff_t>(n), parts.end());
    if (auto found = find_global(image, p.type->name + ".", rest)) return found;  // declared AT an address
  }
  return std::nullopt;
}

std::string variable_name(const Image& image, const Handle& h) {
  if (h.place >= 0)
    for (const ir::Global& g : image.globals)
      if (g.place == h.place) return g.name;
  for (const auto* list : {&image.globals, &image.programs})
    for (const ir::Global& g : *list) {
      std::string out = g.name;
      const bool inside = h.address >= g.address && h.address < g.address + g.type->size;
      if (g.place < 0 && inside && path_to(*g.type, g.address, h, out)) return out;
    }
  return {};
}

std::string value_text(const Image& image, const Type& type, const std::uint8_t* at, int bit) {
  if (type.kind != Kind::reference) return to_json(type, at, bit);
  std::uint32_t address = 0;
  std::memcpy(&address, at, sizeof address);
  if (address == 0 || type.base == nullptr) return "\"NULL\"";
  for (const ir::Global& g : image.globals)
    if (g.place >= 0 && g.address == address && g.type == type.base) return "\"" + g.name + "\"";
  for (const auto* list : {&image.globals, &image.programs})
    for (const ir::Global& g : *list) {
      std::string out = g.name;
      const bool inside = address >= g.address && address < g.address + g.type->size;
      if (g.place < 0 && inside && path_to(*g.type, g.address, {address, -1, -1, type.base}, out))
        return "\"" + out + "\"";
    }
  return "\"REF\"";
}

std::vector<std::string> variable_names(const Image& image) {
  std::vector<std::string> out;
  const Type* only = image.programs.size() == 1 ? image.programs[0].type : nullptr;
  const auto hidden = [&](const std::string& name) {  // by a variable of the single program
    if (only == nullptr) return false;
    const Field* f = only->field(name);
    return (f != nullptr && !f->reference) ||
           std::any_of(image.globals.begin(), image.globals.end(),
                       [&](const ir::Global& g) { return same_name(g.name, only->name + "." + name); });
  };
  for (const ir::Global& g : image.globals)
    if (g.name.find('%') == std::string::npos && !hidden(g.name)) out.push_back(g.name);
  for (const ir::Global& p : image.programs)
    for (const Field& f : p.type->fields)
      if (!f.reference && f.name.find('$') == std::string::npos)
        out.push_back(image.programs.size() == 1 ? f.name : p.name + "." + f.name);
  return out;
}

}  // namespace servogate::plc
