// SPDX-License-Identifier: Apache-2.0
// `servogate bench positioning` and `bench circle`: figures of ISO 230 of what was measured.
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/drive/response/positioning.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/run_page.hpp"
#include "gateway/command/bench/session.hpp"
#include "machine/files/read_file.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kNoColumns{"bench.no-columns", "{0} has no columns {1}", "в {0} нет столбцов {1}"};
const text::Entry kTooFew{
    "bench.too-few",
    "{0}: each target needs at least two approaches in both directions (ISO 230-2 asks for five)",
    "{0}: каждой точке нужно не меньше двух подходов в обе стороны (ISO 230-2 требует пять)"};
const text::Entry kNoCircle{"bench.no-circle", "{0}: no circle lies near these points",
                            "{0}: вблизи этих точек нет окружности"};

/// Columns of numbers of a CSV file, by their heads; what is no number is left out with its row.
std::optional<std::map<std::string, std::vector<double>>> columns_of(const std::string& path,
                                                                     const std::vector<std::string>& wanted) {
  std::string why;
  const auto bytes = files::read_file(path, files::kMostOfProgram, why);
  if (!bytes) {
    complain(kCannotRead, {path, why});
    return std::nullopt;
  }
  std::istringstream lines(*bytes);
  std::string line, cell;
  std::vector<std::string> heads;
  std::map<std::string, std::vector<double>> out;
  for (bool first = true; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    std::istringstream cells(line);
    std::map<std::string, double> row;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (first) {
        heads.push_back(cell);
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      if (i < heads.size() && end != cell.c_str() && *end == '\0') row[heads[i]] = value;
    }
    first = false;
    bool whole = !row.empty();
    for (const std::string& name : wanted) whole = whole && row.contains(name);
    if (whole)
      for (const std::string& name : wanted) out[name].push_back(row[name]);
  }
  if (out.empty()) {
    std::string names;
    for (const std::string& name : wanted) names += (names.empty() ? "" : ", ") + name;
    complain(kNoColumns, {path, names});
    return std::nullopt;
  }
  return out;
}

int show(const std::string& title, const json& facts, const std::vector<Plot>& plots,
         const BenchIsoOptions& o) {
  if (!o.out.empty())
    if (const std::string why = report::write_file(o.out, plot_page(title, facts, plots)); !why.empty()) {
      complain(kCannotWrite, {o.out, why});
      return kInfrastructure;
    }
  if (o.json)
    print_exact(facts.dump(1));
  else
    for (const auto& [key, value] : facts["figures"].items()) print_line(key + " = " + value.dump());
  return kDone;
}

}  // namespace

int bench_positioning(const BenchIsoOptions& o) {
  const auto columns = columns_of(o.files.front(), {"target", "actual", "direction"});
  if (!columns) return kWrongUse;
  std::vector<bench::Approach> approaches;
  for (std::size_t i = 0; i < columns->at("target").size(); ++i)
    approaches.push_back(
        {columns->at("target")[i], columns->at("actual")[i], columns->at("direction")[i] > 0.0});
  const auto p = bench::positioning(approaches);
  if (!p) {
    complain(kTooFew, {o.files.front()});
    return kAlarm;
  }
  Plot plot{"Deviation over target, up and down", {{}, {}}};
  plot.series[0].name = "up";
  plot.series[1].name = "down";
  json targets = json::array();
  for (const auto& t : p->targets) {
    for (const int k : {0, 1}) {
      plot.series[static_cast<std::size_t>(k)].x.push_back(t.target);
      plot.series[static_cast<std::size_t>(k)].y.push_back(k == 0 ? t.mean_up : t.mean_down);
    }
    targets.push_back(
        {{"target", t.target}, {"mean_up", t.mean_up}, {"mean_down", t.mean_down}, {"B", t.reversal}});
  }
  return show("ISO 230-2",
              {{"schema", 1},
               {"figures",
                {{"A", p->accuracy},
                 {"R", p->repeatability},
                 {"R_up", p->repeatability_up},
                 {"R_down", p->repeatability_down},
                 {"E", p->systematic},
                 {"M", p->mean_bidirectional},
                 {"B", p->reversal},
                 {"B_mean", p->mean_reversal}}},
               {"targets", targets}},
              {plot}, o);
}

int bench_circle(const BenchIsoOptions& o) {
  std::vector<std::map<std::string, std::vector<double>>> paths;
  const std::size_t comma = o.columns.find(',');
  const std::string x = o.columns.substr(0, comma),
                    y = comma == std::string::npos ? "" : o.columns.substr(comma + 1);
  for (const std::string& file : o.files) {
    auto columns = columns_of(file, {x, y});
    if (!columns) return kWrongUse;
    paths.push_back(std::move(*columns));
  }
  json figures = json::object();
  Plot plot{"Path", {}};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto c = bench::circularity(paths[i][x], paths[i][y], o.radius);
    if (!c) {
      complain(kNoCircle, {o.files[i]});
      return kAlarm;
    }
    const std::string of = paths.size() == 1 ? "" : i == 0 ? "_1" : "_2";
    figures["G" + of] = c->deviation;
    figures["F_max" + of] = c->greatest;
    figures["F_min" + of] = c->least;
    figures["radius" + of] = c->radius;
    figures["centre_x" + of] = c->centre_x;
    figures["centre_y" + of] = c->centre_y;
    plot.series.push_back({paths[i][x], paths[i][y], true, o.files[i]});
  }
  if (paths.size() == 2)
    if (const auto both = bench::circle_reversal(paths[0][x], paths[0][y], paths[1][x], paths[1][y])) {
      figures["G_b"] = both->bidirectional;
      figures["H"] = both->hysteresis;
    }
  return show("ISO 230-4", {{"schema", 1}, {"figures", figures}}, {plot}, o);
}

}  // namespace servogate::gateway::command
