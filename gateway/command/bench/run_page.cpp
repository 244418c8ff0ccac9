// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/run_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "firmware_if/text/markup.hpp"

namespace servogate::gateway::command {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kWidth = 860.0, kHeight = 220.0, kLeft = 70.0, kBottom = 24.0;
/// A plot of this many points shows all that its pixels can.
constexpr std::size_t kColumns = 1500;
constexpr std::size_t kColours = 6;

std::string formatted(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

/// One plot with its least and greatest values at its axes.
std::string plot(const std::string& title, const std::vector<Series>& all, bool logarithmic) {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  const auto place = [&](double x) { return logarithmic ? std::log10(std::max(x, 1e-12)) : x; };
  for (const Series& s : all)
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      x0 = std::min(x0, place(s.x[i]));
      x1 = std::max(x1, place(s.x[i]));
      y0 = std::min(y0, s.y[i]);
      y1 = std::max(y1, s.y[i]);
    }
  if (!(x1 > x0)) return {};
  if (!(y1 > y0)) y1 = y0 + 1.0;
  const auto px = [&](double x) { return kLeft + (place(x) - x0) / (x1 - x0) * (kWidth - kLeft - 8.0); };
  const auto py = [&](double y) { return 8.0 + (y1 - y) / (y1 - y0) * (kHeight - kBottom - 8.0); };
  std::string names;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!all[k].name.empty())
      names +=
          " <small class='n" + std::to_string(k % kColours) + "'>" + text::escaped(all[k].name) + "</small>";
  std::string out = "<h3>" + text::escaped(title) + names +
                    "</h3><svg viewBox='0 0 860 220'><rect x='70' y='8' width='782' height='188'/>";
  const auto label = [&](double x, double y, const char* anchor, double value) {
    out += "<text x='" + formatted("%.0f", x) + "' y='" + formatted("%.0f", y) + "' text-anchor='" + anchor +
           "'>" + formatted("%.4g", value) + "</text>";
  };
  label(kLeft - 6.0, 18.0, "end", y1);
  label(kLeft - 6.0, kHeight - kBottom, "end", y0);
  label(kLeft, kHeight - 6.0, "start", logarithmic ? std::pow(10.0, x0) : x0);
  label(kWidth - 8.0, kHeight - 6.0, "end", logarithmic ? std::pow(10.0, x1) : x1);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Series& s = all[k];
    const std::string name = "s" + std::to_string(k % kColours);
    if (s.dots) {
      for (std::size_t i = 0; i < s.x.size(); ++i)
        out += "<circle class='" + name + "' r='2.5' cx='" + formatted("%.1f", px(s.x[i])) + "' cy='" +
               formatted("%.1f", py(s.y[i])) + "'/>";
      continue;
    }
    out += "<polyline class='" + name + "' points='";
    for (std::size_t i = 0; i < s.x.size(); ++i)
      out += formatted("%.1f", px(s.x[i])) + "," + formatted("%.1f ", py(s.y[i]));
    out += "'/>";
  }
  return out + "</svg>";
}

void table(const nlohmann::json& object, const std::string& prefix, std::string& out) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object())
      table(value, prefix + key + ".", out);
    else if (!value.is_array())
      out += "<tr><td>" + text::escaped(prefix + key) + "</td><td>" +
             text::escaped(value.is_string() ? value.get<std::string>() : value.dump()) + "</td></tr>";
  }
}

}  // namespace

std::string plot_page(const std::string& title, const nlohmann::json& facts, const std::vector<Plot>& plots) {
  std::string out =
      "<!doctype html><html><head><meta charset='utf-8'><title>" + text::escaped(title) +
      "</title><meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; style-src "
      "'unsafe-inline'\"><style>"
      "body{font:15px sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color-scheme:light dark}"
      "svg{width:100%}rect{fill:none;stroke:#8888}text{font-size:11px;fill:currentColor}"
      "polyline{fill:none;stroke-width:1.2}td{padding:1px 1em 1px 0}";
  constexpr const char* kPalette[kColours] = {"#2878b5", "#d95319", "#2e8b57",
                                              "#8e44ad", "#b8860b", "#777777"};
  for (std::size_t k = 0; k < kColours; ++k) {
    const std::string n = std::to_string(k), colour = kPalette[k];
    out += ".s" + n + "{stroke:" + colour + "}circle.s" + n + "{fill:" + colour + "}.n" + n +
           "{color:" + colour + "}";
  }
  out += "</style></head><body><h1>" + text::escaped(title) + "</h1><table>";
  table(facts, "", out);
  out += "</table>";
  for (const Plot& p : plots) out += plot(p.title, p.series, p.logarithmic);
  return out + "</body></html>\n";
}

Series course_of(const std::vector<double>& x, const std::vector<double>& y) {
  Series s;
  const std::size_t step = std::max<std::size_t>(1, 2 * y.size() / kColumns);
  for (std::size_t at = 0; at < y.size(); at += step) {
    const std::size_t end = std::min(at + step, y.size());
    const auto [low, high] = std::minmax_element(y.begin() + static_cast<std::ptrdiff_t>(at),
                                                 y.begin() + static_cast<std::ptrdiff_t>(end));
    for (const auto& place : {std::min(low, high), std::max(low, high)}) {
      s.x.push_back(x[static_cast<std::size_t>(place - y.begin())]);
      s.y.push_back(*place);
    }
  }
  return s;
}

Series json_column(const nlohmann::json& rows, const char* x, const char* y, bool dots) {
  Series s;
  s.dots = dots;
  for (const auto& row : rows) {
    s.x.push_back(row.at(x).get<double>());
    s.y.push_back(row.at(y).get<double>());
  }
  return s;
}

std::string run_page(const bench::Guard& guard, const nlohmann::json& meta) {
  std::vector<Plot> plots;
  if (meta.contains("friction_points"))
    plots.push_back({"Friction: torque in N m over speed in rev/s",
                     {json_column(meta["friction_points"], "speed_rev_s", "torque_nm", true)}});
  if (meta.contains("response")) {
    const auto& rows = meta["response"];
    plots.push_back({"Speed by torque: gain in dB over Hz, measured and model",
                     {json_column(rows, "hz", "db", true), json_column(rows, "hz", "model_db")},
                     true});
    plots.push_back({"Its phase in degrees", {json_column(rows, "hz", "deg", true)}, true});
    plots.push_back({"Its coherence", {json_column(rows, "hz", "coherence")}, true});
  }
  for (const auto& [key, name] :
       {std::pair{"closed_loop", "Closed loop"}, std::pair{"open_loop", "Open loop"}}) {
    if (!meta.contains(key)) continue;
    const std::string title(name);
    plots.push_back({title + ": gain in dB over Hz", {json_column(meta[key], "hz", "db")}, true});
    plots.push_back({title + ": phase in degrees", {json_column(meta[key], "hz", "deg", true)}, true});
    plots.push_back({title + ": coherence", {json_column(meta[key], "hz", "coherence")}, true});
  }
  std::vector<double> time, position, torque;
  for (const bench::Sample& s : guard.samples()) {
    time.push_back(s.time_s);
    position.push_back(s.position_rad / kTurn);
    torque.push_back(s.torque_nm);
  }
  plots.push_back({"Position in rev over s", {course_of(time, position)}});
  plots.push_back({"Torque in N m over s", {course_of(time, torque)}});
  return plot_page("servogate bench", meta, plots);
}

}  // namespace servogate::gateway::command
