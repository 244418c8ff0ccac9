// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/run_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
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

std::string formatted(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

struct Series {
  std::vector<double> x, y;
  bool dots = false;
};

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
  std::string out = "<h3>" + text::escaped(title) +
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
    const std::string name = "s" + std::to_string(k);
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

/// Least and greatest value of each column, so that no peak is lost.
Series course(const bench::Guard& guard, const std::function<double(const bench::Sample&)>& value) {
  Series s;
  const auto& samples = guard.samples();
  const std::size_t step = std::max<std::size_t>(1, 2 * samples.size() / kColumns);
  for (std::size_t at = 0; at < samples.size(); at += step) {
    const std::size_t end = std::min(at + step, samples.size());
    std::size_t low = at, high = at;
    for (std::size_t i = at; i < end; ++i) {
      if (value(samples[i]) < value(samples[low])) low = i;
      if (value(samples[i]) > value(samples[high])) high = i;
    }
    for (const std::size_t i : {std::min(low, high), std::max(low, high)}) {
      s.x.push_back(samples[i].time_s);
      s.y.push_back(value(samples[i]));
    }
  }
  return s;
}

Series column(const nlohmann::json& rows, const char* x, const char* y, bool dots) {
  Series s;
  s.dots = dots;
  for (const auto& row : rows) {
    s.x.push_back(row.at(x).get<double>());
    s.y.push_back(row.at(y).get<double>());
  }
  return s;
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

std::string run_page(const bench::Guard& guard, const nlohmann::json& meta) {
  std::string out =
      "<!doctype html><html><head><meta charset='utf-8'><title>servogate bench</title><meta "
      "http-equiv='Content-Security-Policy' content=\"default-src 'none'; style-src 'unsafe-inline'\"><style>"
      "body{font:15px sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color-scheme:light dark}"
      "svg{width:100%}rect{fill:none;stroke:#8888}text{font-size:11px;fill:currentColor}"
      "polyline{fill:none;stroke-width:1.2}td{padding:1px 1em 1px 0}"
      ".s0{stroke:#2878b5}.s1{stroke:#d95319}circle.s0{fill:#2878b5}circle.s1{fill:#d95319}"
      "</style></head><body><h1>servogate bench</h1><table>";
  table(meta, "", out);
  out += "</table>";
  if (meta.contains("friction_points"))
    out += plot("Friction: torque in N m over speed in rev/s",
                {column(meta["friction_points"], "speed_rev_s", "torque_nm", true)}, false);
  if (meta.contains("response")) {
    out +=
        plot("Speed by torque: gain in dB over Hz, measured and model",
             {column(meta["response"], "hz", "db", true), column(meta["response"], "hz", "model_db", false)},
             true);
    out += plot("Its phase in degrees", {column(meta["response"], "hz", "deg", true)}, true);
    out += plot("Its coherence", {column(meta["response"], "hz", "coherence", false)}, true);
  }
  out += plot("Position in rev over s",
              {course(guard, [](const bench::Sample& s) { return s.position_rad / kTurn; })}, false);
  out += plot("Torque in N m over s", {course(guard, [](const bench::Sample& s) { return s.torque_nm; })},
              false);
  return out + "</body></html>\n";
}

}  // namespace servogate::gateway::command
