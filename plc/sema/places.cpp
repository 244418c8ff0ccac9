// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"
#include "plc/types/direct_place.hpp"

namespace servogate::plc::sema {

using image::Format;
using image::Packet;

std::optional<image::Place> Analyzer::parse_address(const std::string& text, const Location& at) {
  const bool input = key_of(text).starts_with("%I");
  std::optional<image::Place> p =
      text.starts_with("%") ? direct_place(text) : image::parse_place(key_of(text));
  if (const image::Symbol* s = p ? nullptr : symbol(text)) p = s->place;
  if (!p) {
    // Hierarchical addresses (IEC 61131-3:2013, 6.5.5.2) end in nothing here: there are no racks.
    const auto points = std::count(text.begin(), text.end(), '.');
    if (text.starts_with("%") && points > 1)
      report_.error(at, texts::kAddressNumbers, {text, std::to_string(points + 1)});
    else
      report_.error(at, texts::kBadAddress, {text});
    return std::nullopt;
  }
  std::uint32_t limit = p->packet == Packet::a   ? image::kPacketASize
                        : p->packet == Packet::k ? options_.k_bytes
                                                 : options_.v_bytes;
  if (input) limit = kOutputBase;
  if (p->byte() + p->bytes() > limit) {
    report_.error(at, texts::kAddressRange, {text, std::to_string(limit)});
    return std::nullopt;
  }
  return p;
}

const Type* Analyzer::type_of(const image::Place& place) {
  switch (place.format) {
    case Format::bl:
      return elementary(Kind::boolean);
    case Format::by:
      return elementary(Kind::usint);
    case Format::in:
      return elementary(Kind::int_);
    case Format::li:
      return elementary(Kind::dint);
    case Format::re:
      return elementary(Kind::real);
    case Format::lr:
      return elementary(Kind::lreal);
    case Format::ch:
      return types_->string(place.length);
  }
  return elementary(Kind::error);
}

const image::Symbol* Analyzer::symbol(std::string_view name) const {
  const auto at = symbols_by_name_.find(key_of(name));
  return at == symbols_by_name_.end() ? nullptr : &symbols_[at->second];
}

std::uint32_t Analyzer::shared(const std::string& name, const image::Place& place, const Type* type,
                               const Location& at) {
  const auto known = shared_by_name_.find(key_of(name));
  if (known != shared_by_name_.end()) return known->second;
  auto index = static_cast<std::uint32_t>(program_.places.size());
  for (std::uint32_t i = 0; i < index; ++i)
    if (program_.places[i].place == place && program_.places[i].type == type) {
      shared_by_name_[key_of(name)] = i;
      return i;
    }
  ir::SharedPlace s;
  s.name = name;
  s.place = place;
  s.type = type;
  s.at = at;
  program_.places.push_back(std::move(s));
  place_writers_.emplace_back();
  shared_by_name_[key_of(name)] = index;
  return index;
}

// `configured`: by VAR_CONFIG, whose locations are compared with one another.
void Analyzer::declare_located(Variable& out, const syntax::Variable& v, bool configured) {
  const auto place = parse_address(v.address, v.address_location);
  if (!place) {
    out.type = elementary(Kind::error);
    return;
  }
  const Type& t = *out.type;
  const bool text = place->format == Format::ch;
  const bool fits = text ? t.kind == Kind::string && t.capacity() == place->length
                         : is_elementary(t.kind) && !is_text(t.kind) && t.kind != Kind::enumeration &&
                               t.size == image::format_size(place->format) &&
                               (place->format == Format::bl) == (t.kind == Kind::boolean);
  if (!fits) {
    report_.error(v.address_location, texts::kAddressType, {v.address, type_of(*place)->name, t.name});
    out.type = elementary(Kind::error);
    return;
  }
  const std::string unit = current_ >= 0 ? here().source->name + "." : "";
  out.root = ir::Root::shared;
  out.cell = shared(unit + v.name, *place, out.type, v.location);
  ir::SharedPlace& s = program_.places[out.cell];
  s.retain = s.retain || v.retain;
  if (v.address.starts_with("%I") || v.address.starts_with("%i")) read_only_places_.insert(out.cell);
  if (v.initial && !read_only_places_.contains(out.cell)) {
    if (const auto c = constant(*v.initial, out.type)) {
      s.initial = *c;
      s.initialised = true;
      check_place_writer(out.cell, v.address_location, v.name);
    }
  }
  if (configured) return;
  warn_overlaps(v.address, *place, v.address_location);
  located_.push_back({v.name, v.address, *place, v.location});
  if (current_ < 0)
    program_.globals.push_back({v.name, out.type, 0, static_cast<std::int32_t>(out.cell), false});
}

// `direct`: an address in a body, where the place of a variable may be named once more.
void Analyzer::warn_overlaps(const std::string& address, const image::Place& place, const Location& at,
                             bool direct) {
  for (const Located& l : located_)
    if (l.place.overlaps(place) && !(direct && l.place == place))
      report_.warning(at, texts::kAddressOverlap, {address, l.text, l.name, seen_at(l.at, at)});
  for (const image::Symbol& symbol : symbols_)
    if (symbol.place.overlaps(place)) {
      report_.warning(at, texts::kSymbolOverlap, {address, symbol.name, image::to_string(symbol.place)});
      break;
    }
}

// The letter of an auxiliary axis: its places as one AXIS_REF. What the PLC writes of it goes back after
// every scan, whichever block wrote.
std::optional<ir::Place> Analyzer::axis_reference(const std::string& name, const Location& at) {
  if (symbol(name + "." + std::string(image::kMotionFields[0].name)) == nullptr) return std::nullopt;
  ir::Place out;
  for (const image::InterfaceField& f : image::kMotionFields) {
    const image::Symbol* s = symbol(name + "." + std::string(f.name));
    const auto part = s == nullptr ? std::nullopt : place_of_symbol(s->name, at, false);
    if (!part) return std::nullopt;
    ir::SharedPlace& place = program_.places[part->cell];
    place.written = place.written || f.writer == image::Writer::plc;
    if (f.byte != 0) continue;
    place.extent = image::kMotionBlock;
    out = part->copy();
  }
  out.type = resolve_declared(declared_types_.at("AXIS_REF"));
  return out;
}

// A place that the NC or an input writes is read-only here (one declared writer for each place).
void Analyzer::check_place_writer(std::uint32_t index, const Location& at, const std::string& shown) {
  ir::SharedPlace& s = program_.places[index];
  s.written = true;
  if (current_ >= 0) place_writers_[index].insert(current_);
  if (read_only_places_.contains(index)) {
    report_.error(at, texts::kWritePlaceInput, {shown});
    return;
  }
  for (const image::Symbol& symbol : symbols_) {
    if (symbol.writer != image::Writer::nc && symbol.writer != image::Writer::input) continue;
    if (!symbol.place.overlaps(s.place)) continue;
    report_.error(at, symbol.writer == image::Writer::nc ? texts::kWritePlaceNc : texts::kWritePlaceInput,
                  {symbol.name});
    return;
  }
}

// Places that share memory are laid out as they lie in the packet; all others get a cell of their own type.
void Analyzer::lay_out_places() {
  std::vector<ir::SharedPlace>& places = program_.places;
  for (const auto& [key, index] : shared_by_name_) {
    const ir::SharedPlace& s = places[index];
    program_.globals.push_back(
        {same_name(key, s.name) ? s.name : key, s.type, 0, static_cast<std::int32_t>(index), false});
  }
  std::vector<std::size_t> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const image::Place &p = places[a].place, &q = places[b].place;
    return std::tuple(p.packet, p.byte(), a) < std::tuple(q.packet, q.byte(), b);
  });
  for (std::size_t i = 0; i < order.size();) {
    const image::Place& first = places[order[i]].place;
    const auto end_of = [&](std::size_t k) {
      const ir::SharedPlace& s = places[order[k]];
      return s.place.byte() + std::max(s.place.bytes(), s.extent);
    };
    std::uint32_t end = end_of(i);
    std::size_t j = i + 1;
    bool overlapping = places[order[i]].extent > 0;
    for (; j < order.size(); ++j) {
      const image::Place& p = places[order[j]].place;
      if (p.packet != first.packet || p.byte() >= end) break;
      end = std::max(end, end_of(j));
      overlapping = overlapping || places[order[j]].extent > 0;
      for (std::size_t k = i; k < j; ++k)
        overlapping = overlapping || (p.overlaps(places[order[k]].place) && p.format != Format::ch &&
                                      places[order[k]].place.format != Format::ch);
    }
    if (overlapping) {
      program_.memory.resize((program_.memory.size() + 7) / 8 * 8);
      const auto base = static_cast<std::uint32_t>(program_.memory.size());
      program_.memory.resize(base + (end - first.byte()));
      for (std::size_t k = i; k < j; ++k) {
        ir::SharedPlace& s = places[order[k]];
        s.address = s.place.format == Format::ch ? allocate(*s.type) : base + s.place.byte() - first.byte();
        s.raw = s.place.format != Format::ch;
        if (s.raw && s.place.format == Format::bl && s.configured)
          report_.error(s.at, texts::kSharedBit, {s.name});
        else if (s.raw && s.referenced && s.place.format == Format::bl)
          report_.error(s.at, texts::kBitReference);
      }
    } else {
      for (std::size_t k = i; k < j; ++k) places[order[k]].address = allocate(*places[order[k]].type);
    }
    i = j;
  }
}

}  // namespace servogate::plc::sema
