// SPDX-License-Identifier: Apache-2.0
// Any bytes as a program of a language, on a machine that the first byte chooses. It must end, throw nothing,
// keep every axis inside of its travel, and write JSON for every command.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"

namespace servogate::program::fuzz {

/// A mill, machines that lack axes of the planes, lathes, five axes.
constexpr const char* kAxes[] = {"XYZC", "X", "C", "XZ", "XZC", "XY", "XYZAC", "XYZUVWABC"};

inline MachineModel machine(const std::string& axes) {
  MachineModel model;
  for (const char letter : axes)
    model.axes.push_back(
        {std::string(1, letter), letter >= 'A' && letter <= 'C', false, false, -300.0, 300.0, 500.0});
  if (axes.size() == 4) model.axes[1].diameter = true;
  if (axes.starts_with("XZ")) model.axes[0].diameter = true;
  model.spindle_min_rpm = 50.0;
  model.spindle_max_rpm = 6000.0;
  model.tool_places = 99;
  return model;
}

inline void require(bool condition) {
  if (!condition) std::abort();
}

/// One input as a program of a language.
inline void run_program(std::string_view dialect, std::vector<std::string> power_on, const std::uint8_t* data,
                        std::size_t size) {
  const std::size_t chosen = size == 0 ? 0 : data[0] % std::size(kAxes);
  MachineModel model = machine(kAxes[chosen]);
  model.power_on = std::move(power_on);
  if (dialect == "nc110") model.variables = {{"ERF", 0.01}, {"MCD", 2.0}};
  std::vector<std::string> letters;
  for (const auto& axis : model.axes) letters.push_back(axis.letter);
  const std::string text(reinterpret_cast<const char*>(data), size);
  Tables tables;
  tables.origins[1] = {{"X", 10.0}, {"Y", 20.0}};
  tables.correctors[1].length["Z"] = 50.0;
  const auto loader = [&](std::string_view name) -> std::optional<std::string> {
    if (name == "SUB" || name == "L1") return text;
    return std::nullopt;
  };
  Interpreter run(dialect, model, tables, "fuzz.nc", text, loader, Position{});
  for (const auto& finding : run.findings()) require(finding.entry != nullptr && !finding.str().empty());
  std::string json;
  const auto on_command = [&](const Command& command) {
    json.clear();
    append_json(json, command, letters, run.files());
    require(json.front() == '{' && json.back() == '}');
    if (const auto* arc = std::get_if<Arc>(&command.what))
      require(arc->axis1 < letters.size() && arc->axis2 < letters.size() && arc->axis1 != arc->axis2);
    for (std::size_t a = 0; a < letters.size(); ++a) require(std::abs(run.position()[a]) <= 300.0 + 1e-5);
    return true;
  };
  const auto error = run_dry(run, on_command, 20'000);
  for (const auto& warning : run.warnings())
    require(warning.severity == servogate::text::Severity::warning && warning.line > 0 &&
            !warning.str().empty());
  require(run.warnings().size() <= 200);
  if (error) require(error->entry != nullptr && !error->str().empty());
}

}  // namespace servogate::program::fuzz
