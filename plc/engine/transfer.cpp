// SPDX-License-Identifier: Apache-2.0
#include "plc/engine/transfer.hpp"

#include <algorithm>
#include <map>

namespace servogate::plc {

namespace {

/// A variable of elementary type with its full name.
struct Leaf {
  std::string name;
  const Type* type;
  std::uint32_t address;
  std::int32_t place;
};

void leaves(const std::string& name, const Type& type, std::uint32_t address, std::vector<Leaf>& out) {
  if (type.kind == Kind::structure || type.kind == Kind::block) {
    for (const Field& f : type.fields)
      if (!f.reference && !f.constant) leaves(name + "." + f.name, *f.type, address + f.offset, out);
  } else if (type.kind == Kind::array) {
    for (std::int64_t i = 0; i < type.range.count(); ++i)
      leaves(name + "[" + std::to_string(type.range.low + i) + "]", *type.base,
             address + static_cast<std::uint32_t>(i) * type.base->size, out);
  } else {
    out.push_back({name, &type, address, -1});
  }
}

std::vector<Leaf> variables(const Image& image, bool all) {
  std::vector<Leaf> out;
  if (!all) {
    for (const Image::RetainedCell& c : image.retained) out.push_back({c.name, c.type, c.address, c.place});
    return out;
  }
  for (const ir::Global& g : image.globals)
    if (g.place < 0 && !g.constant) leaves(g.name, *g.type, g.address, out);
  for (const ir::Global& p : image.programs) leaves(p.name, *p.type, p.address, out);
  return out;
}

/// The same values mean the same: also the names of an enumeration and the limits of a subrange.
bool same_type(const Type& a, const Type& b) {
  if (a.kind != b.kind || a.size != b.size || !same_name(a.name, b.name) || a.bounded != b.bounded)
    return false;
  if (a.bounded && (a.limits.low != b.limits.low || a.limits.high != b.limits.high)) return false;
  return std::equal(
      a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
      [](const EnumValue& x, const EnumValue& y) { return same_name(x.name, y.name) && x.value == y.value; });
}

void add_move(Transfer& t, std::uint32_t from, std::uint32_t to, std::uint32_t size) {
  if (!t.moves.empty()) {
    Transfer::Move& last = t.moves.back();
    if (from == last.from + last.size && to == last.to + last.size) {
      last.size += size;
      return;
    }
  }
  t.moves.push_back({from, to, size});
}

// A retained variable whose address is another one now: what it held goes there. Others mean what lies there.
void keep_moved_places(const Image& from, const Image& to, Transfer& t) {
  for (const Image::RetainedCell& now : to.retained)
    for (const Image::RetainedCell& old : from.retained) {
      if (now.place < 0 || old.place < 0 || !same_name(now.name, old.name)) continue;
      const auto place = static_cast<std::uint32_t>(now.place);
      if (same_type(*now.type, *old.type) &&
          !(to.places[place].place == from.places[static_cast<std::size_t>(old.place)].place))
        t.places.push_back({old.address, place, now.type->size});
    }
}

}  // namespace

Transfer plan_transfer(const Image& from, const Image& to, bool all) {
  Transfer t;
  t.running = all;
  std::map<std::string, Leaf> before;
  for (Leaf& leaf : variables(from, all)) before.emplace(key_of(leaf.name), std::move(leaf));
  for (const Leaf& leaf : variables(to, all)) {
    const auto old = before.find(key_of(leaf.name));
    const bool refers = leaf.type->kind == Kind::reference;  // addresses are others in another program
    if (old == before.end() || refers || !same_type(*old->second.type, *leaf.type)) {
      t.fresh.push_back(leaf.name);
      if (refers && old != before.end()) before.erase(old);
      continue;
    }
    ++t.kept;
    if (leaf.place >= 0)
      t.places.push_back({old->second.address, static_cast<std::uint32_t>(leaf.place), leaf.type->size});
    else
      add_move(t, old->second.address, leaf.address, leaf.type->size);
    before.erase(old);
  }
  if (all) keep_moved_places(from, to, t);
  for (const auto& [key, leaf] : before) t.given_up.push_back(leaf.name);
  if (all)
    for (std::uint32_t i = 0; i < from.tasks.size(); ++i)
      for (std::uint32_t k = 0; k < to.tasks.size(); ++k)
        if (same_name(from.tasks[i].name, to.tasks[k].name) && from.tasks[i].interval == to.tasks[k].interval)
          t.tasks.emplace_back(i, k);
  return t;
}

}  // namespace servogate::plc
