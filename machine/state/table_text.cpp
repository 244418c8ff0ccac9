// SPDX-License-Identifier: Apache-2.0
#include "machine/state/table_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "machine/keys/findings.hpp"
#include "machine/state/state_text.hpp"

namespace servogate::machine {

namespace {

/// A bare TOML key where the name is one.
std::string key(const std::string& name) {
  const bool bare = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  return bare ? name : quoted(name);
}

std::string entries(const std::map<std::string, double>& values) {
  std::string out = "{";
  for (const auto& [name, value] : values)
    out += (out.size() == 1 ? " " : ", ") + key(name) + " = " + toml_real(value);
  return out + (out.size() == 1 ? "}" : " }");
}

void write_origins(const MachineState& s, std::string& out) {
  out +=
      "# Number of the origin = { axis = machine coordinate of its zero }, in mm or degrees; of a diameter "
      "axis "
      "the\n# radius. Edit it while the control is down.\n[origins]\n";
  for (const auto& [number, axes] : s.tables.origins)
    out += std::to_string(number) + " = " + entries(axes) + "\n";
}

void write_tools(const MachineState& s, std::string& out) {
  out +=
      "# Lengths by axis, radius and wear in mm; wear is added. Edit it while the control is down.\n"
      "tool_in_spindle = " +
      std::to_string(s.tool_in_spindle) + "\n";
  for (const auto& [number, c] : s.tables.correctors) {
    out += "\n[[tool]]\nnumber = " + std::to_string(number) + "\n";
    if (!c.name.empty()) out += "name = " + quoted(c.name) + "\n";
    out += "length = " + entries(c.length) + "\nradius = " + toml_real(c.radius) + "\n";
    if (!c.wear.empty()) out += "wear = " + entries(c.wear) + "\n";
    if (c.radius_wear != 0.0) out += "radius_wear = " + toml_real(c.radius_wear) + "\n";
    if (!c.wear_limit.empty()) out += "wear_limit = " + entries(c.wear_limit) + "\n";
    if (c.radius_wear_limit != 0.0) out += "radius_wear_limit = " + toml_real(c.radius_wear_limit) + "\n";
    if (c.quadrant != 0) out += "quadrant = " + std::to_string(c.quadrant) + "\n";
    if (c.life_min != 0.0) out += "life_min = " + toml_real(c.life_min) + "\n";
    if (c.used_min != 0.0) out += "used_min = " + toml_real(c.used_min) + "\n";
    if (c.alternate != 0) out += "alternate = " + std::to_string(c.alternate) + "\n";
  }
}

/// One table being read; the first error of a value keeps the others from being said of it.
class TableReader {
 public:
  TableReader(const std::string& file, const std::vector<std::string>& axes, MachineState& state)
      : file_(file), axes_(axes), state_(state) {}
  std::vector<text::Finding> findings;

  void origins(const Element& root) {
    state_.tables.origins.clear();
    known(root, {"checksum", "schema", "part", "origins"});
    const Element* rows = root.find("origins");
    if (rows == nullptr) return;
    if (rows->kind != Element::Kind::table)
      return wrong(*rows, "origins", "a table number = { axis = mm }", "таблица номер = { ось = мм }");
    for (const Element& row : rows->children) {
      int number = -1;
      const char* const end = row.key.data() + row.key.size();
      const auto [at, error] = std::from_chars(row.key.data(), end, number);
      if (error != std::errc{} || at != end || number < 0) {
        said(row.key_at, finding::kStateValue,
             {row.key, text::both("a number of an origin", "номер начала отсчёта")});
        continue;
      }
      state_.tables.origins[number] = by_axis(row, row.key);
    }
  }

  void tools(const Element& root) {
    state_.tables.correctors.clear();
    known(root, {"checksum", "schema", "part", "tool_in_spindle", "tool"});
    state_.tool_in_spindle = 0;
    if (const Element* e = root.find("tool_in_spindle"))
      state_.tool_in_spindle = static_cast<std::int32_t>(whole(*e, "tool_in_spindle", 0, kMostTool));
    const Element* rows = root.find("tool");
    if (rows == nullptr) return;
    if (rows->kind != Element::Kind::array) return wrong(*rows, "tool", "[[tool]]", "[[tool]]");
    for (const Element& row : rows->children) {
      if (row.kind != Element::Kind::table)
        wrong(row, "tool", "[[tool]]", "[[tool]]");
      else
        tool(row);
    }
  }

 private:
  static constexpr std::int64_t kMostTool = std::numeric_limits<std::int32_t>::max();

  void said(const Where& at, const text::Entry& entry, std::vector<std::string> arguments) {
    findings.push_back({text::Severity::error, file_, at.line, at.column, &entry, std::move(arguments)});
  }
  void wrong(const Element& e, const std::string& name, const std::string& english,
             const std::string& russian) {
    said(e.at, finding::kStateValue, {name, text::both(english, russian)});
  }
  void known(const Element& table, std::initializer_list<std::string_view> keys) {
    for (const Element& e : table.children) {
      if (std::find(keys.begin(), keys.end(), e.key) != keys.end()) continue;
      std::string list;
      for (const std::string_view k : keys)
        if (k != "checksum") list += (list.empty() ? "" : ", ") + std::string(k);
      said(e.key_at, finding::kUnknownKeyList, {e.key, list});
    }
  }
  std::int64_t whole(const Element& e, const std::string& name, std::int64_t min, std::int64_t max) {
    if (e.kind == Element::Kind::integer && e.integer >= min && e.integer <= max) return e.integer;
    const std::string range = std::to_string(min) + ".." + std::to_string(max);
    wrong(e, name, "a whole number, " + range, "целое число, " + range);
    return min;
  }
  double length(const Element& e, const std::string& name, bool signless = false) {
    if (e.numeric() && std::isfinite(e.number()) && (!signless || e.number() >= 0.0)) return e.number();
    wrong(e, name, signless ? "a number of 0 or more" : "a finite number",
          signless ? "число от 0" : "конечное число");
    return 0.0;
  }
  std::map<std::string, double> by_axis(const Element& e, const std::string& name) {
    std::map<std::string, double> out;
    if (e.kind != Element::Kind::table) {
      wrong(e, name, "{ axis = mm }", "{ ось = мм }");
      return out;
    }
    for (const Element& child : e.children) {
      if (!axes_.empty() && std::find(axes_.begin(), axes_.end(), child.key) == axes_.end()) {
        std::string letters;
        for (const std::string& a : axes_) letters += (letters.empty() ? "" : ", ") + a;
        said(child.key_at, finding::kTableAxis, {child.key, letters});
        continue;
      }
      out[child.key] = length(child, name + "." + child.key);
    }
    return out;
  }
  void tool(const Element& row) {
    known(row, {"number", "name", "length", "radius", "wear", "radius_wear", "wear_limit",
                "radius_wear_limit", "quadrant", "life_min", "used_min", "alternate"});
    const Element* number = row.find("number");
    if (number == nullptr) return wrong(row, "number", "a tool's number", "номер инструмента");
    const auto n = static_cast<int>(whole(*number, "number", 0, kMostTool));
    if (state_.tables.correctors.contains(n))
      return said(number->at, finding::kTableTwice, {std::to_string(n)});
    program::Tables::Corrector c;
    if (const Element* e = row.find("name")) {
      if (e->kind == Element::Kind::string)
        c.name = e->string;
      else
        wrong(*e, "name", "a string", "строка");
    }
    if (const Element* e = row.find("length")) c.length = by_axis(*e, "length");
    if (const Element* e = row.find("wear")) c.wear = by_axis(*e, "wear");
    if (const Element* e = row.find("radius")) c.radius = length(*e, "radius", true);
    if (const Element* e = row.find("radius_wear")) c.radius_wear = length(*e, "radius_wear");
    if (const Element* e = row.find("wear_limit")) c.wear_limit = by_axis(*e, "wear_limit");
    if (const Element* e = row.find("radius_wear_limit"))
      c.radius_wear_limit = length(*e, "radius_wear_limit", true);
    if (const Element* e = row.find("quadrant")) c.quadrant = static_cast<int>(whole(*e, "quadrant", 0, 9));
    if (const Element* e = row.find("life_min")) c.life_min = length(*e, "life_min", true);
    if (const Element* e = row.find("used_min")) c.used_min = length(*e, "used_min", true);
    if (const Element* e = row.find("alternate"))
      c.alternate = static_cast<int>(whole(*e, "alternate", 0, kMostTool));
    state_.tables.correctors[n] = std::move(c);
  }

  const std::string& file_;
  const std::vector<std::string>& axes_;
  MachineState& state_;
};

}  // namespace

std::string write_table(const MachineState& state, StatePart part) {
  std::string out;
  if (part == StatePart::origins)
    write_origins(state, out);
  else
    write_tools(state, out);
  return out + std::string(kTableEnd) + "\n";
}

std::vector<text::Finding> read_table(const Document& document, const std::string& file, StatePart part,
                                      const std::vector<std::string>& axes, MachineState& state) {
  TableReader reader(file, axes, state);
  if (part == StatePart::origins)
    reader.origins(document.root);
  else
    reader.tools(document.root);
  return std::move(reader.findings);
}

}  // namespace servogate::machine
