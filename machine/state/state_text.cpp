// SPDX-License-Identifier: Apache-2.0
#include "machine/state/state_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "machine/keys/document.hpp"
#include "machine/state/record_text.hpp"
#include "machine/state/table_text.hpp"

namespace servogate::machine {

std::string toml_real(double value) {
  if (!std::isfinite(value)) return value > 0 ? "inf" : value < 0 ? "-inf" : "nan";
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string out(buffer, result.ptr);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

namespace {

// ---- writing

void write_homing(const MachineState& s, std::string& out) {
  for (const auto& [letter, h] : s.homing)
    out += "\n[[axis]]\nletter = " + quoted(letter) + "\nvalid = " + (h.valid ? "true" : "false") +
           "\noffset_counts = " + std::to_string(h.offset_counts) +
           "\nswitch_to_index = " + toml_real(h.switch_to_index) + "\n";
}

void write_counters(const MachineState& s, std::string& out) {
  out += "[counters]\n";
  for (const auto& [name, value] : s.counters) out += quoted(name) + " = " + std::to_string(value) + "\n";
}

void write_gains(const MachineState& s, std::string& out) {
  out += "[gains]\n";
  for (const auto& [name, value] : s.gains) out += quoted(name) + " = " + toml_real(value) + "\n";
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
      case StatePart::tools:
        return;  // read_table()
      case StatePart::records:
        return read_records(root, file_, state_.tables.record_files, findings);
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

struct Head {
  std::string said;   ///< the checksum as it stands; empty: there is none
  std::string found;  ///< of the content
};
/// nullopt: the file does not begin with a checksum.
std::optional<Head> head_of(std::string_view whole) {
  const std::size_t end = whole.find('\n');
  const std::string_view first = whole.substr(0, end);
  if (end == std::string_view::npos || !first.starts_with(kHead) || !first.ends_with('"') ||
      first.size() <= kHead.size())
    return std::nullopt;
  return Head{std::string(first.substr(kHead.size(), first.size() - kHead.size() - 1)),
              checksum_of(whole.substr(end + 1))};
}

/// People may have written behind it.
bool has_end(std::string_view whole) {
  for (std::size_t at = whole.find(kTableEnd); at != std::string_view::npos;
       at = whole.find(kTableEnd, at + 1)) {
    const std::size_t next = at + kTableEnd.size();
    if (at > 0 && whole[at - 1] == '\n' && next < whole.size() &&
        (whole[next] == '\n' || whole[next] == '\r'))
      return true;
  }
  return false;
}

/// What people have written may lack a checksum, or have one that does not fit any more.
std::vector<text::Finding> check_table_head(std::string_view whole, const std::string& file) {
  const std::optional<Head> head = head_of(whole);
  if (!head || head->said == head->found) return {};
  if (head->said != "none" && !has_end(whole)) return {at_line(file, 1, finding::kTableCut, {})};
  text::Finding edited = at_line(file, 1, finding::kTableEdited, {});
  edited.severity = text::Severity::warning;
  return {edited};
}

std::vector<text::Finding> check_checksum(std::string_view whole, const std::string& file) {
  const std::optional<Head> head = head_of(whole);
  if (!head) return {at_line(file, 1, finding::kStateHead, {})};
  if (head->said == "none") {
    text::Finding edited = at_line(file, 1, finding::kEdited, {});
    edited.severity = text::Severity::warning;
    return {edited};
  }
  if (head->said == head->found) return {};
  return {at_line(file, 1, finding::kChecksum, {head->said, head->found})};
}

/// Errors of the head: checksum, schema, part.
std::vector<text::Finding> check_head(std::string_view whole, const Document& document,
                                      const std::string& file, StatePart part) {
  const bool table = edited_by_people(part);
  std::vector<text::Finding> out = table ? check_table_head(whole, file) : check_checksum(whole, file);
  if (!out.empty() && out.back().severity == text::Severity::error) return out;
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
  if (name == nullptr && table) return out;
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
  static constexpr std::string_view kNames[] = {"origins", "tools",   "homing",  "counters",
                                                "gains",   "records", "retained"};
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
    case StatePart::tools:
      body += write_table(state, part);
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
    case StatePart::records:
      body += write_records(state.tables.record_files);
      break;
    case StatePart::retained:
      write_retained(state, body);
      break;
  }
  return std::string(kHead) + checksum_of(body) + "\"\n" + body;
}

std::vector<text::Finding> read_part(std::string_view text, const std::string& file, StatePart part,
                                     MachineState& state, const std::vector<std::string>& axes) {
  const Document document = read_document(text);
  std::vector<text::Finding> findings = check_head(text, document, file, part);
  if (any_error(findings)) return findings;
  MachineState copy = state;
  PartReader reader(file, copy);
  reader.read(document.root, part);
  if (edited_by_people(part)) reader.findings = read_table(document, file, part, axes, copy);
  findings.insert(findings.end(), reader.findings.begin(), reader.findings.end());
  if (!any_error(findings)) state = std::move(copy);
  return findings;
}

}  // namespace servogate::machine
