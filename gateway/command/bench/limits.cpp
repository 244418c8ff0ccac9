// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/limits.hpp"

#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/toml_file.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kNone{"bench.limits-none", "expected a table [limits] with at least one figure",
                        "нужна таблица [limits] хотя бы с одной величиной"};
const text::Entry kForm{
    "bench.limits-form",
    "{0}: expected {min = NUMBER, max = NUMBER} with one of both at least, or {is = \"TEXT\"}",
    "{0}: нужно {min = ЧИСЛО, max = ЧИСЛО}, хотя бы одно из двух, или {is = \"ТЕКСТ\"}"};
const text::Entry kTable{"bench.limits-table",
                         "{0} is no table of a file of limits: [limits] is the only one",
                         "{0} — не таблица файла допусков: есть только [limits]"};
const text::Entry kNever{"bench.limits-never", "{0}: min is {1} and max {2}, so nothing can pass",
                         "{0}: min = {1}, max = {2}: годным не будет ничто"};
const text::Entry kPass{"bench.pass", "pass  {0} = {1} ({2})", "годно     {0} = {1} ({2})"};
const text::Entry kFail{"bench.fail", "FAIL  {0} = {1} ({2})", "НЕ ГОДНО  {0} = {1} ({2})"};

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

/// nullopt: it has another form.
std::optional<RunLimit> read_limit(const machine::Element& e) {
  RunLimit row{e.key, {}, {}, {}};
  if (e.kind != machine::Element::Kind::table) return std::nullopt;
  for (const machine::Element& c : e.children) {
    if (c.key == "min" && c.numeric())
      row.min = c.number();
    else if (c.key == "max" && c.numeric())
      row.max = c.number();
    else if (c.key == "is" && c.kind == machine::Element::Kind::string)
      row.is = c.string;
    else
      return std::nullopt;
  }
  const bool range = row.min || row.max;
  return range != row.is.has_value() ? std::optional(row) : std::nullopt;
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
  const auto document = read_toml(path);
  if (!document) return std::nullopt;
  for (const machine::Element& e : document->root.children)
    if (e.key != "limits") return wrong_line(path, e.key_at.line, kTable, {e.key});
  const machine::Element* table = document->root.find("limits");
  if (table == nullptr || table->kind != machine::Element::Kind::table || table->children.empty())
    return wrong_line(path, 1, kNone, {});
  RunLimits limits{path, {}};
  for (const machine::Element& e : table->children) {
    const auto row = read_limit(e);
    if (!row) return wrong_line(path, e.key_at.line, kForm, {e.key});
    // Written so that a bound that is no number is none, either.
    if (row->min && row->max && !(*row->min <= *row->max))
      return wrong_line(path, e.key_at.line, kNever,
                        {e.key, text::number(*row->min, 9), text::number(*row->max, 9)});
    limits.rows.push_back(*row);
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
