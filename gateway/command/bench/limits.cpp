// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/limits.hpp"

#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/document.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kWrong{"bench.limits", "{0}:{1}: {2}", "{0}:{1}: {2}"};
const text::Entry kSyntax{"bench.limits-syntax", "not TOML: {0}", "не TOML: {0}"};
const text::Entry kNone{"bench.limits-none", "expected a table [limits] with at least one figure",
                        "нужна таблица [limits] хотя бы с одной величиной"};
const text::Entry kForm{
    "bench.limits-form",
    "{0}: expected {min = NUMBER, max = NUMBER} with one of both at least, or {is = \"TEXT\"}",
    "{0}: нужно {min = ЧИСЛО, max = ЧИСЛО}, хотя бы одно из двух, или {is = \"ТЕКСТ\"}"};
const text::Entry kPass{"bench.pass", "pass  {0} = {1} ({2})", "годно     {0} = {1} ({2})"};
const text::Entry kFail{"bench.fail", "FAIL  {0} = {1} ({2})", "НЕ ГОДНО  {0} = {1} ({2})"};

std::optional<RunLimits> wrong(const std::string& path, int line, const text::Entry& entry,
                               const std::vector<std::string>& arguments) {
  complain(kWrong, {path, std::to_string(line), text::render(entry, arguments, text::user_language())});
  return std::nullopt;
}

/// A figure by its path of keys, or nullptr.
const json* figure_of(const json& meta, const std::string& path) {
  const json* at = &meta;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const auto next = at->is_object() ? at->find(path.substr(begin, end - begin)) : at->end();
    if (!at->is_object() || next == at->end()) return nullptr;
    at = &*next;
    begin = end + 1;
  }
  return at;
}

bool holds(const RunLimit& limit, const json* figure) {
  if (figure == nullptr) return false;
  if (limit.is) return figure->is_string() && *figure == *limit.is;
  if (!figure->is_number()) return false;
  const double value = figure->get<double>();
  return (!limit.min || value >= *limit.min) && (!limit.max || value <= *limit.max);
}

std::string range_words(const json& row) {
  if (row.contains("is")) return row["is"].get<std::string>();
  std::string out;
  if (row.contains("min")) out += ">= " + row["min"].dump();
  if (row.contains("max")) out += (out.empty() ? "" : ", ") + std::string("<= ") + row["max"].dump();
  return out;
}

}  // namespace

std::optional<RunLimits> read_limits(const std::string& path) {
  std::string why;
  const auto bytes = files::read_file(path, files::kMostOfSettings, why);
  if (!bytes) {
    complain(kCannotRead, {path, why});
    return std::nullopt;
  }
  const machine::Document document = machine::read_document(*bytes);
  if (!document.ok()) return wrong(path, document.error_at.line, kSyntax, {document.error});
  const machine::Element* table = document.root.find("limits");
  if (table == nullptr || table->kind != machine::Element::Kind::table || table->children.empty())
    return wrong(path, 1, kNone, {});
  RunLimits limits{path, {}};
  for (const machine::Element& e : table->children) {
    RunLimit row{e.key, {}, {}, {}};
    bool known = e.kind == machine::Element::Kind::table;
    for (const machine::Element& c : e.children) {
      if (c.key == "min" && c.numeric())
        row.min = c.number();
      else if (c.key == "max" && c.numeric())
        row.max = c.number();
      else if (c.key == "is" && c.kind == machine::Element::Kind::string)
        row.is = c.string;
      else
        known = false;
    }
    const bool range = row.min || row.max;
    if (!known || range == row.is.has_value()) return wrong(path, e.key_at.line, kForm, {e.key});
    limits.rows.push_back(std::move(row));
  }
  return limits;
}

bool judge(const RunLimits& limits, json& meta) {
  bool pass = true;
  json rows = json::array();
  for (const RunLimit& limit : limits.rows) {
    const json* figure = figure_of(meta, limit.figure);
    const bool ok = holds(limit, figure);
    json row{{"figure", limit.figure}, {"value", figure != nullptr ? *figure : json(nullptr)}, {"pass", ok}};
    if (limit.min) row["min"] = *limit.min;
    if (limit.max) row["max"] = *limit.max;
    if (limit.is) row["is"] = *limit.is;
    rows.push_back(std::move(row));
    pass = pass && ok;
  }
  meta["limits"] = {{"file", limits.file}, {"pass", pass}, {"rows", rows}};
  return pass;
}

void print_judgement(const json& meta) {
  for (const json& row : meta["limits"]["rows"])
    print_line(text::render(
        row["pass"] == true ? kPass : kFail,
        std::vector<std::string>{row["figure"].get<std::string>(), row["value"].dump(), range_words(row)},
        text::user_language()));
}

}  // namespace servogate::gateway::command
