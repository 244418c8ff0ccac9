// SPDX-License-Identifier: Apache-2.0
// `servogate bench compare`: kept runs, opened again.
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/run_page.hpp"
#include "gateway/control/run/exit_code.hpp"
#include "machine/files/read_file.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kNoRun{"bench.no-run", "{0} is no run of the bench: {1}", "{0} — не прогон стенда: {1}"};

struct Run {
  std::string name;
  json meta;
  std::map<std::string, std::vector<double>> columns;  ///< numbers of samples.csv
};

std::optional<Run> open_run(const std::string& path) {
  Run run{path, {}, {}};
  std::string why;
  const auto meta = files::read_file(path + "/meta.json", files::kMostOfSource, why);
  if (meta) run.meta = json::parse(*meta, nullptr, false);
  if (meta && !run.meta.is_object()) why = "meta.json";
  if (!meta || !run.meta.is_object()) {
    complain(kNoRun, {path, why});
    return std::nullopt;
  }
  const auto csv = files::read_file(path + "/samples.csv", files::kMostOfProgram, why);
  if (!csv) return run;  // a tuning has them in its parts
  std::istringstream lines(*csv);
  std::string line, cell;
  std::vector<std::string> heads;
  for (bool first = true; std::getline(lines, line); first = false) {
    std::istringstream cells(line);
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (first) {
        heads.push_back(cell);
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      if (i < heads.size() && end != cell.c_str() && *end == '\0') run.columns[heads[i]].push_back(value);
    }
  }
  return run;
}

/// Every number and text of a record by its path of keys.
void flatten(const json& object, const std::string& prefix, std::map<std::string, json>& out) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object())
      flatten(value, prefix + key + ".", out);
    else if (!value.is_array())
      out[prefix + key] = value;
  }
}

Series course_from(const Run& run, const std::string& column) {
  const auto time = run.columns.find("time_s"), value = run.columns.find(column);
  Series s;
  if (time != run.columns.end() && value != run.columns.end() && time->second.size() == value->second.size())
    s = course_of(time->second, value->second);
  s.name = run.name;
  return s;
}

std::vector<Plot> plots_of(const std::vector<Run>& runs) {
  std::vector<Plot> plots;
  for (const char* key : {"closed_loop", "open_loop", "response"}) {
    Plot gain{std::string(key) + ": gain in dB over Hz", {}, true};
    for (const Run& run : runs) {
      if (!run.meta.contains(key) || !run.meta[key].is_array()) continue;
      gain.series.push_back(json_column(run.meta[key], "hz", "db"));
      gain.series.back().name = run.name;
    }
    if (!gain.series.empty()) plots.push_back(std::move(gain));
  }
  for (const char* column : {"set_point", "position_rev", "torque_nm"}) {
    Plot plot{std::string(column) + " over s", {}};
    for (const Run& run : runs) plot.series.push_back(course_from(run, column));
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace

int bench_compare(const BenchCompareOptions& options) {
  std::vector<Run> runs;
  for (const std::string& path : options.runs) {
    auto run = open_run(path);
    if (!run) return kWrongUse;
    runs.push_back(std::move(*run));
  }
  std::map<std::string, std::vector<json>> rows;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::map<std::string, json> figures;
    flatten(runs[i].meta, "", figures);
    for (auto& [key, value] : figures) {
      rows[key].resize(runs.size());
      rows[key][i] = std::move(value);
    }
  }
  // What all have in common tells nothing.
  std::erase_if(rows, [](const auto& row) {
    for (const json& value : row.second)
      if (value != row.second.front()) return false;
    return true;
  });
  json facts = json::object();
  for (const auto& [key, values] : rows)
    for (std::size_t i = 0; i < runs.size(); ++i) facts[key][runs[i].name] = values[i];
  if (!options.out.empty())
    if (const std::string why =
            report::write_file(options.out, plot_page("servogate bench compare", facts, plots_of(runs)));
        !why.empty()) {
      complain(kCannotWrite, {options.out, why});
      return kInfrastructure;
    }
  if (options.json) {
    print_exact(json({{"schema", 1}, {"runs", options.runs}, {"differ", facts}})
                    .dump(1, ' ', false, json::error_handler_t::replace));
    return kDone;
  }
  for (const auto& [key, values] : rows) {
    std::string line = key + ":";
    for (const json& value : values) line += " " + value.dump();
    print_line(line);
  }
  return kDone;
}

}  // namespace servogate::gateway::command
