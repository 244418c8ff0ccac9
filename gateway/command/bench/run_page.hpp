// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/drive/measurement/guard.hpp"

/// Reports: pages without scripts and without the network, their plots as SVG. What stands in `facts` cannot
/// break out of them. Not real-time safe.
namespace servogate::gateway::command {

struct Series {
  std::vector<double> x, y;
  bool dots = false;
  std::string name = {};  ///< empty: it is the only one
};
struct Plot {
  std::string title;
  std::vector<Series> series;
  bool logarithmic = false;  ///< its x axis
};
/// A page with a table of the facts, all but arrays, and these plots.
std::string plot_page(const std::string& title, const nlohmann::json& facts, const std::vector<Plot>& plots);
/// A course of many values: least and greatest of each column of the picture, so that no peak is lost.
Series course_of(const std::vector<double>& x, const std::vector<double>& y);
/// Two keys of the rows of an array.
Series json_column(const nlohmann::json& rows, const char* x, const char* y, bool dots = false);

/// The report of a run.
std::string run_page(const bench::Guard& guard, const nlohmann::json& meta);

}  // namespace servogate::gateway::command
