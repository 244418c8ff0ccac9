// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/plc/plc_view.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>

#include "firmware_if/image/packets.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/vm/image.hpp"

namespace servogate::gateway {

namespace {

using plc::Image;

std::vector<PlcSymbol> rows_of(const Image& image) {
  std::vector<PlcSymbol> programs, rows;
  const auto members = [&](std::vector<PlcSymbol>& out, const std::string& owner, const plc::Type& frame) {
    for (const plc::Field& f : frame.fields)
      if (f.name.find('$') == std::string::npos)
        out.push_back({owner + "." + f.name, f.type->name, "", f.retain, {}, {}, {}});
  };
  for (const plc::ir::Global& p : image.programs) {
    members(programs, p.name, *p.type);
    for (PlcSymbol& r : programs)  // AT %Q* has its place through VAR_CONFIG
      if (const auto h = plc::find_variable(image, r.name); r.place.empty() && h && h->place >= 0)
        r.place = image::to_string(image.places[static_cast<std::size_t>(h->place)].place);
  }
  for (const Image::Shared& s : image.places)
    if (std::none_of(programs.begin(), programs.end(),
                     [&](const PlcSymbol& r) { return plc::same_name(r.name, s.name); }))
      rows.push_back({s.name, s.type->name, image::to_string(s.place), false, {}, {}, {}});
  for (const plc::ir::Global& g : image.globals)
    if (g.place < 0) rows.push_back({g.name, g.type->name, "", g.retain, {}, {}, {}});
  std::move(programs.begin(), programs.end(), std::back_inserter(rows));
  for (const Image::Unit& u : image.units)
    if (!u.from_library && u.kind != plc::syntax::UnitKind::program && u.frame != nullptr)
      members(rows, u.name, *u.frame);
  return rows;
}

/// The declared variable that a reference belongs to: the longest row that its name begins with.
PlcSymbol* owner_of(std::map<std::string, PlcSymbol*>& rows, const std::string& name) {
  std::string key = plc::key_of(name);
  for (;;) {
    const auto at = rows.find(key);
    if (at != rows.end()) return at->second;
    const std::size_t cut = key.find_last_of(".[");
    if (cut == std::string::npos) return nullptr;
    key.resize(cut);
  }
}

std::string line_of(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int n = 1; n < line && begin != std::string::npos; ++n) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (begin == std::string::npos) return {};
  std::string out = text.substr(begin, text.find('\n', begin) - begin);
  if (!out.empty() && out.back() == '\r') out.pop_back();
  return out;
}

/// Where a body runs: its unit, and the address of the instance.
bool find_body(const plc::LogicProgram& program, const std::string& name, int& unit, std::uint32_t& base) {
  const Image& image = program.engine.image();
  const plc::Type* frame = nullptr;
  for (const plc::ir::Global& p : image.programs)
    if (plc::same_name(p.name, name)) {
      frame = p.type;
      base = p.address;
    }
  if (frame == nullptr)
    if (const auto handle = program.engine.find(name); handle && handle->type->kind == plc::Kind::block) {
      frame = handle->type;
      base = handle->address;
    }
  for (std::size_t u = 0; u < image.units.size(); ++u)
    if (frame != nullptr && image.units[u].frame == frame) {
      unit = static_cast<int>(u);
      return !image.units[u].from_library;
    }
  return false;
}

}  // namespace

std::vector<PlcSymbol> list_symbols(const Image& image) {
  std::vector<PlcSymbol> rows = rows_of(image);
  std::map<std::string, PlcSymbol*> by_name;
  for (PlcSymbol& r : rows) by_name.emplace(plc::key_of(r.name), &r);
  for (const Image::Reference& r : image.references) {
    PlcSymbol* row = owner_of(by_name, r.name);
    if (row == nullptr) continue;
    std::vector<std::string>& list = r.write ? row->written : row->read;
    const std::string where = image.files[static_cast<std::size_t>(r.file)] + ":" + std::to_string(r.line);
    if (std::find(list.begin(), list.end(), where) == list.end()) list.push_back(where);
  }
  return rows;
}

WatchedBody watched_body(const plc::LogicProgram& program, const std::string& name) {
  const Image& image = program.engine.image();
  WatchedBody body;
  int unit = -1, first = 0, last = 0, file = -1;
  std::uint32_t base = 0;
  if (!find_body(program, name, unit, base)) return body;
  std::map<int, std::vector<WatchedValue>> by_line;
  for (const Image::Reference& r : image.references) {
    if (r.unit != unit) continue;
    if (file < 0) file = r.file;
    if (r.file != file) continue;
    first = first == 0 ? r.line : std::min(first, r.line);
    last = std::max(last, r.line);
    if (!plc::is_elementary(r.type->kind)) continue;
    std::uint32_t address = r.cell;
    if (r.base == Image::Reference::Base::unit) address += base;
    if (r.bound) {  // its cell holds an address: AT %Q* always the same, VAR_IN_OUT one for each call
      std::memcpy(&address, image.memory.data() + address, sizeof address);
      if (address == 0) continue;
    }
    if (r.base == Image::Reference::Base::place) {
      if (image.places[r.cell].raw && r.type->kind == plc::Kind::boolean) continue;
      address = image.places[r.cell].address;
    }
    std::vector<WatchedValue>& values = by_line[r.line];
    const bool known =
        std::any_of(values.begin(), values.end(), [&](const auto& v) { return v.address == address; });
    // Inside a body its own members go without its name.
    const std::size_t dot = r.base == Image::Reference::Base::unit ? r.name.find('.') : std::string::npos;
    if (!known)
      values.push_back({dot == std::string::npos ? r.name : r.name.substr(dot + 1), r.type, address});
  }
  if (file < 0 || static_cast<std::size_t>(file) >= program.sources.size()) return body;
  const plc::SourceFile& source = program.sources[static_cast<std::size_t>(file)];
  body.file = source.name;
  for (int n = first; n <= last; ++n)
    body.lines.push_back({n, line_of(source.text, n), std::move(by_line[n])});
  return body;
}

std::vector<std::string> program_names(const Image& image) {
  std::vector<std::string> names;
  for (const plc::ir::Global& p : image.programs) names.push_back(p.name);
  return names;
}

}  // namespace servogate::gateway
