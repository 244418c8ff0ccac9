// SPDX-License-Identifier: Apache-2.0
#include "machine/state/state_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "machine/keys/document.hpp"

namespace servogate::machine {

namespace {

// ---- writing

/// A double that TOML reads back as the same bits, with a point so that it stays a float.
std::string real(double value) {
  if (!std::isfinite(value)) return value > 0 ? "inf" : value < 0 ? "-inf" : "nan";
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string out(buffer, result.ptr);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

std::string reals(const std::map<std::string, double>& values) {
  std::string out = "{";
  for (const auto& [name, value] : values)
    out += (out.size() == 1 ? " " : ", ") + quoted(name) + " = " + real(value);
  return out + (out.size() == 1 ? "}" : " }");
}

void write_origins(const MachineState& s, std::string& out) {
  out += "# number of the origin (UAO): axis = mm\n[origins]\n";
  for (const auto& [number, axes] : s.tables.origins)
    out += quoted(std::to_string(number)) + " = " + reals(axes) + "\n";
}

void write_tools(const MachineState& s, std::string& out) {
  out += "tool_in_spindle = " + std::to_string(s.tool_in_spindle) + "\n";
  for (const auto& [number, c] : s.tables.correctors)
    out += "\n[[corrector]]\nnumber = " + std::to_string(number) + "\nlength = " + reals(c.length) +
           "\ndiameter = " + real(c.diameter) + "\n";
}

void write_homing(const MachineState& s, std::string& out) {
  for (const auto& [letter, h] : s.homing)
    out += "\n[[axis]]\nletter = " + quoted(letter) + "\nvalid = " + (h.valid ? "true" : "false") +
           "\noffset_counts = " + std::to_string(h.offset_counts) +
           "\nswitch_to_index = " + real(h.switch_to_index) + "\n";
}

void write_counters(const MachineState& s, std::string& out) {
  out += "[counters]\n";
  for (const auto& [name, value] : s.counters) out += quoted(name) + " = " + std::to_string(value) + "\n";
}

void write_gains(const MachineState& s, std::string& out) {
  out += "[gains]\n";
  for (const auto& [name, value] : s.gains) out += quoted(name) + " = " + real(value) + "\n";
}

void write_retained(const MachineState& s, std::string& out) {
  out += "generation = " + std::to_string(s.retained_generation) + "\n";
  for (const RetainedVariable& v : s.retained)
    out += "\n[[variable]]\nname = " + quoted(v.name) + "\ntype = " + quoted(v.type) +
           "\nvalue = " + quoted(v.value) + "\n";
}

// ---- reading

/// One file being read into a copy of the state.
class PartReader {
 public:
  PartReader(const std::string& file, MachineState& state) : file_(file), state_(state) {}

  void read(const Element& root, StatePart part) {
    switch (part) {
      case StatePart::origins:
        return origins(root);
      case StatePart::tools:
        return tools(root);
      case StatePart::homing:
        return homing(root);
      case StatePart::counters:
        return counters(root);
      case StatePart::gains:
        return gains(root);
      case StatePart::retained:
        return retained(root);
    }
  }
  std::vector<text::Finding> findings;

 private:
  void wrong(const Element& e, const std::string& name, std::string_view english, std::string_view russian) {
    findings.push_back({text::Severity::error,
                        file_,
                        e.at.line,
                        e.at.column,
                        &finding::kStateValue,
                        {name, text::both(english, russian)}});
  }
  const Element* table(const Element& root, const std::string& name) {
    const Element* e = root.find(name);
    if (e != nullptr && e->kind == Element::Kind::table) return e;
    wrong(e == nullptr ? root : *e, name, "a table", "таблица");
    return nullptr;
  }
  /// Tables of a list; a missing list is an empty one.
  std::vector<const Element*> list(const Element& root, const std::string& name) {
    std::vector<const Element*> out;
    const Element* e = root.find(name);
    if (e == nullptr) return out;
    if (e->kind != Element::Kind::array) wrong(*e, name, "a list of tables", "список таблиц");
    for (const Element& child : e->children) {
      if (child.kind == Element::Kind::table)
        out.push_back(&child);
      else
        wrong(child, name, "a table", "таблица");
    }
    return out;
  }
  std::int64_t integer(const Element& around, const std::string& name, std::int64_t min, std::int64_t max) {
    const Element* e = around.find(name);
    if (e != nullptr && e->kind == Element::Kind::integer && e->integer >= min && e->integer <= max)
      return e->integer;
    wrong(e == nullptr ? around : *e, name, "an integer", "целое число");
    return 0;
  }
  double finite(const Element& around, const std::string& name) {
    const Element* e = around.find(name);
    if (e != nullptr && e->numeric() && std::isfinite(e->number())) return e->number();
    wrong(e == nullptr ? around : *e, name, "a finite number", "конечное число");
    return 0.0;
  }
  std::string string(const Element& around, const std::string& name) {
    const Element* e = around.find(name);
    if (e != nullptr && e->kind == Element::Kind::string) return e->string;
    wrong(e == nullptr ? around : *e, name, "a string", "строка");
    return {};
  }
  std::map<std::string, double> lengths(const Element& e, const std::string& name) {
    std::map<std::string, double> out;
    if (e.kind != Element::Kind::table) wrong(e, name, "a table axis = mm", "таблица ось = мм");
    for (const Element& child : e.children) {
      if (child.numeric() && std::isfinite(child.number()))
        out[child.key] = child.number();
      else
        wrong(child, name + "." + child.key, "a finite number", "конечное число");
    }
    return out;
  }

  void origins(const Element& root) {
    state_.tables.origins.clear();
    const Element* e = table(root, "origins");
    if (e == nullptr) return;
    for (const Element& child : e->children) {
      int number = 0;
      const auto [end, error] =
          std::from_chars(child.key.data(), child.key.data() + child.key.size(), number);
      if (error != std::errc{} || end != child.key.data() + child.key.size())
        wrong(child, child.key, "a number of an origin", "номер начала отсчёта");
      else
        state_.tables.origins[number] = lengths(child, child.key);
    }
  }
  void tools(const Element& root) {
    state_.tables.correctors.clear();
    state_.tool_in_spindle = static_cast<std::int32_t>(integer(root, "tool_in_spindle", 0, kMaxInt));
    for (const Element* e : list(root, "corrector")) {
      const auto number = static_cast<int>(integer(*e, "number", 0, kMaxInt));
      program::Tables::Corrector corrector;
      if (const Element* length = e->find("length")) corrector.length = lengths(*length, "length");
      corrector.diameter = finite(*e, "diameter");
      state_.tables.correctors[number] = std::move(corrector);
    }
  }
  void homing(const Element& root) {
    state_.homing.clear();
    for (const Element* e : list(root, "axis")) {
      HomingRecord& h = state_.homing[string(*e, "letter")];
      const Element* valid = e->find("valid");
      if (valid == nullptr || valid->kind != Element::Kind::boolean)
        wrong(*e, "valid", "true or false", "true или false");
      else
        h.valid = valid->boolean;
      h.offset_counts = integer(*e, "offset_counts", kMinLong, kMaxLong);
      h.switch_to_index = finite(*e, "switch_to_index");
    }
  }
  void counters(const Element& root) {
    state_.counters.clear();
    if (const Element* e = table(root, "counters"))
      for (const Element& child : e->children)
        state_.counters[child.key] = integer(*e, child.key, kMinLong, kMaxLong);
  }
  void gains(const Element& root) {
    state_.gains.clear();
    if (const Element* e = table(root, "gains"))
      for (const Element& child : e->children) state_.gains[child.key] = finite(*e, child.key);
  }
  void retained(const Element& root) {
    state_.retained.clear();
    state_.retained_generation = integer(root, "generation", 0, kMaxLong);
    for (const Element* e : list(root, "variable"))
      state_.retained.push_back({string(*e, "name"), string(*e, "type"), string(*e, "value")});
  }

  static constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();
  static constexpr std::int64_t kMaxLong = std::numeric_limits<std::int64_t>::max();
  static constexpr std::int64_t kMinLong = std::numeric_limits<std::int64_t>::min();
  const std::string& file_;
  MachineState& state_;
};

constexpr std::string_view kHead = "checksum = \"";

std::string checksum_of(std::string_view body) {
  char buffer[24];
  std::snprintf(buffer, sizeof buffer, "crc32:%08x", crc32(body));
  return buffer;
}

text::Finding at_line(const std::string& file, int line, const text::Entry& entry,
                      std::vector<std::string> arguments) {
  return {text::Severity::error, file, line, 1, &entry, std::move(arguments)};
}

/// Errors of the head: checksum, schema, part.
std::vector<text::Finding> check_head(std::string_view whole, const Document& document,
                                      const std::string& file, StatePart part) {
  std::vector<text::Finding> out;
  const std::size_t end = whole.find('\n');
  const std::string_view first = whole.substr(0, end);
  if (end == std::string_view::npos || !first.starts_with(kHead) || !first.ends_with('"') ||
      first.size() <= kHead.size())
    return {at_line(file, 1, finding::kStateHead, {})};
  const std::string said(first.substr(kHead.size(), first.size() - kHead.size() - 1));
  const std::string found = checksum_of(whole.substr(end + 1));
  if (said == "none") {
    out.push_back(at_line(file, 1, finding::kEdited, {}));
    out.back().severity = text::Severity::warning;
  } else if (said != found) {
    return {at_line(file, 1, finding::kChecksum, {said, found})};
  }
  if (!document.ok()) {
    out.push_back(at_line(file, document.error_at.line, finding::kStateSyntax, {document.error}));
    out.back().column = document.error_at.column;
    return out;
  }
  const Element* schema = document.root.find("schema");
  if (schema == nullptr || schema->kind != Element::Kind::integer || schema->integer != 1)
    out.push_back(at_line(file, schema == nullptr ? 1 : schema->at.line, finding::kStateSchema,
                          {schema == nullptr ? "-" : std::to_string(schema->integer)}));
  const Element* name = document.root.find("part");
  if (name == nullptr || name->string != part_name(part))
    out.push_back(at_line(file, name == nullptr ? 1 : name->at.line, finding::kStatePart,
                          {name == nullptr ? "-" : name->string, std::string(part_name(part))}));
  return out;
}

bool any_error(const std::vector<text::Finding>& findings) {
  for (const text::Finding& f : findings)
    if (f.severity == text::Severity::error) return true;
  return false;
}

}  // namespace

std::string_view part_name(StatePart part) {
  static constexpr std::string_view kNames[] = {"origins",  "tools", "homing",
                                                "counters", "gains", "retained"};
  return kNames[static_cast<std::size_t>(part)];
}

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

std::string write_part(const MachineState& state, StatePart part) {
  std::string body = "schema = 1\npart = " + quoted(part_name(part)) + "\n";
  switch (part) {
    case StatePart::origins:
      write_origins(state, body);
      break;
    case StatePart::tools:
      write_tools(state, body);
      break;
    case StatePart::homing:
      write_homing(state, body);
      break;
    case StatePart::counters:
      write_counters(state, body);
      break;
    case StatePart::gains:
      write_gains(state, body);
      break;
    case StatePart::retained:
      write_retained(state, body);
      break;
  }
  return std::string(kHead) + checksum_of(body) + "\"\n" + body;
}

std::vector<text::Finding> read_part(std::string_view text, const std::string& file, StatePart part,
                                     MachineState& state) {
  const Document document = read_document(text);
  std::vector<text::Finding> findings = check_head(text, document, file, part);
  if (any_error(findings)) return findings;
  MachineState copy = state;
  PartReader reader(file, copy);
  reader.read(document.root, part);
  findings.insert(findings.end(), reader.findings.begin(), reader.findings.end());
  if (!any_error(findings)) state = std::move(copy);
  return findings;
}

}  // namespace servogate::machine
