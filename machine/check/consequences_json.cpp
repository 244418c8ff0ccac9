// SPDX-License-Identifier: Apache-2.0
// Consequences and findings for --json.
#include "machine/consequences.hpp"
#include "machine/keys/json.hpp"

namespace servogate::machine {

std::string to_json(const LoadResult& loaded, const std::vector<Consequence>& lines,
                    text::Language language) {
  Json out{{"schema", 1}, {"machine", loaded.machine.name}, {"consequences", Json::array()}};
  for (const Consequence& line : lines) {
    Json figures = Json::object();
    for (const auto& [name, value] : line.figures) figures[name] = json_number(value);
    out["consequences"].push_back({{"subject", line.subject},
                                   {"id", line.entry->id},
                                   {"text", line.str(language)},
                                   {"figures", std::move(figures)}});
  }
  return written(out);
}

std::string to_json(const std::vector<text::Finding>& findings, text::Language language) {
  Json out = Json::array();
  for (const text::Finding& f : findings)
    out.push_back({{"file", f.file},
                   {"line", f.line},
                   {"column", f.column},
                   {"severity", f.severity == text::Severity::error ? "error" : "warning"},
                   {"code", f.entry->id},
                   {"text", text::render(*f.entry, f.arguments, language)}});
  return written(out);
}

}  // namespace servogate::machine
