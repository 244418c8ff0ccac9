// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "machine/keys/reader.hpp"
#include "machine/keys/sections.hpp"
#include "machine/load.hpp"
#include "machine/published/published.hpp"

namespace servogate::machine {

namespace {

std::string english(const std::string& both) { return text::in_language(both, text::Language::english); }

/// A cell of a Markdown table.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

std::string type_of(const Key& key) {
  switch (key.kind) {
    case KeyKind::boolean:
      return "boolean";
    case KeyKind::integer:
    case KeyKind::long_integer:
      return "integer";
    case KeyKind::number:
      return "number";
    case KeyKind::text:
      return "string";
    case KeyKind::choice: {
      std::string out;
      for (std::string_view c : key.choices) out += (out.empty() ? "" : ", ") + ("`" + std::string(c) + "`");
      return out;
    }
    case KeyKind::place:
      return "place";
    case KeyKind::texts:
      return "list of strings";
    case KeyKind::numbers:
      return "table name = number";
    case KeyKind::ratio:
      return "pair of integers";
    case KeyKind::pairs:
      return "list of pairs";
    case KeyKind::table:
      return "table";
    case KeyKind::tables:
      return "list of tables";
  }
  return {};
}

std::string type_cell(const Key& key) {
  std::string out = type_of(key);
  const bool ranged = std::isfinite(key.rule.min) || std::isfinite(key.rule.max);
  const std::string unit = unit_name(key.rule.unit, AxisUnits::either);
  if (ranged)
    out += ", " + english(range_text(key.rule, AxisUnits::either));
  else if (!unit.empty())
    out += ", " + unit;
  return out;
}

std::string default_cell(const Key& key, void* defaults) {
  if (key.rule.required) return "**required**";
  if (key.rule.computed) return "computed";
  void* member = key.member(defaults);
  switch (key.kind) {
    case KeyKind::boolean:
      return *static_cast<bool*>(member) ? "true" : "false";
    case KeyKind::integer:
      return std::to_string(*static_cast<int*>(member));
    case KeyKind::long_integer:
      return std::to_string(*static_cast<std::int64_t*>(member));
    case KeyKind::number:
      return std::isfinite(*static_cast<double*>(member)) ? text::number(*static_cast<double*>(member), 9)
                                                          : "none";
    case KeyKind::text:
      return static_cast<std::string*>(member)->empty() ? "none" : *static_cast<std::string*>(member);
    case KeyKind::choice:
      return std::string(key.choices[*static_cast<std::uint8_t*>(member)]);
    case KeyKind::ratio:
      return "[1, 1]";
    default:
      return "none";
  }
}

void write_section(const Section& section, const std::string& heading, std::string& out) {
  if (!heading.empty()) out += "### " + heading + "\n\n";
  out += std::string(section.english) + " · " + std::string(section.russian) + "\n\n";
  out += "| key | type, unit, range | default | meaning | значение |\n|---|---|---|---|---|\n";
  for (const Key& key : section.keys)
    out += "| `" + std::string(key.name) + "` | " + cell(type_cell(key)) + " | " +
           cell(default_cell(key, section.defaults())) + " | " + cell(key.english) + " | " +
           cell(key.russian) + " |\n";
  out += "\n";
}

void write_all(const Section& section, const std::string& path, bool list, std::string& out) {
  write_section(section, path.empty() ? "" : list ? "`[[" + path + "]]`" : "`[" + path + "]`", out);
  for (const Key& key : section.keys)
    if (key.child != nullptr)
      write_all(key.child(), path.empty() ? std::string(key.name) : path + "." + std::string(key.name),
                key.kind == KeyKind::tables, out);
}

void write_units(std::string& out) {
  out += "| kept in | spellings |\n|---|---|\n";
  for (int u = static_cast<int>(Unit::none) + 1; u <= static_cast<int>(Unit::bytes); ++u) {
    const auto unit = static_cast<Unit>(u);
    out +=
        "| " + unit_name(unit, AxisUnits::either) + " | " + unit_spellings(unit, AxisUnits::either) + " |\n";
  }
  out += "\n";
}

constexpr std::string_view kIntroduction = R"(# The machine file, all keys

Generated from the table of keys that reads the files (`machine/keys/`); do not edit. The same table gives
[machine.schema.json](machine.schema.json), which editors with a TOML language server understand.

- A quantity is a number in the unit named here, or a string with a unit: `500`, `"500 mm/s"`, `"0.5 m/s"`. A wrong unit
  is an error. A rotary axis (`type = "rotary"`) has degrees where a linear one has mm.
- An axis in diameter is described in radii; only programs and displays show the diameter.
- A place is written as in part programs: `SA16` (bit 16 of packet A), `SA16.IN` (word 16: bytes 32 and 33), `SK8.RE`.
- `[[name]]` is a list: write the heading once for every element.
- The file is never rewritten; what the machine learns stands in the state directory.

## Units

)";

}  // namespace

std::string markdown_of(const Section& section) {
  std::string out;
  write_all(section, {}, false, out);
  return out;
}

std::string reference_markdown() {
  std::string out(kIntroduction);
  write_units(out);
  out += "## Machine file\n\n" + markdown_of(section_of<MachineConfig>());
  out += "## Device file\n\n" + markdown_of(section_of<DeviceConfig>());
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace servogate::machine
