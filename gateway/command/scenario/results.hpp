// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "bench/scenario/scenario.hpp"
#include "bench/scenario/time_line/run.hpp"

namespace servogate::gateway::command {

/// What came of one scenario; texts in the user's language.
struct Result {
  scenario::Outcome::Status status = scenario::Outcome::Status::infrastructure;
  std::string message, diagram;
  int line = 0;  ///< in the scenario's file
  double t_s = 0.0, virtual_s = 0.0, wall_s = 0.0;
  std::vector<std::string> findings;   ///< of an impossible one
  std::vector<std::string> artifacts;  ///< files that were written
  std::string smallest;                ///< steps of the smallest time line that fails, as TOML

  bool failed() const { return status == scenario::Outcome::Status::failed; }
};
std::string_view name_of(scenario::Outcome::Status status);

/// Of a whole run; `results` in the order of `scenarios`.
struct Results {
  std::vector<scenario::Scenario> scenarios;
  std::vector<Result> results;
  double wall_s = 0.0;
  int count(scenario::Outcome::Status status) const;
};

/// The command line that repeats a scenario.
std::string again(const scenario::Scenario& scenario);

std::string to_junit(const Results& results);
std::string to_tap(const Results& results);
std::string to_json(const Results& results);
/// Markdown: requirement, its scenarios, what came of them.
std::string trace_table(const Results& results);

}  // namespace servogate::gateway::command
