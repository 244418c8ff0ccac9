// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

/// Pass or fail of a production test. Not real-time safe.
namespace servogate::gateway::command {

/// What a figure of meta.json has to be.
struct RunLimit {
  std::string figure;  ///< path of keys: "figures.step.overshoot_percent"
  std::optional<double> min, max;
  std::optional<std::string> is;
};
struct RunLimits {
  std::string file;
  std::vector<RunLimit> rows;
};

/// Reads a file of limits (docs/bench.md). nullopt: it is wrong, which has been said with its line.
std::optional<RunLimits> read_limits(const std::string& path);

/// Puts "limits" into the record of a run: each row with what was measured, and "pass". A figure that the run
/// did not measure fails. True: all pass.
bool judge(const RunLimits& limits, nlohmann::json& meta);
/// The rows of "limits" for people.
void print_judgement(const nlohmann::json& meta);

}  // namespace servogate::gateway::command
