// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes as an NC-110 program, on a machine that the first byte chooses. It must end,
// throw nothing, keep every axis inside of its travel, and write JSON for every command. fuzz_program
// [-dict=tests/fuzz/program/nc110.dict] [CORPUS]
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>

#include "kernel/program/canon.hpp"
#include "kernel/program/check.hpp"

using namespace servogate::program;

namespace {

/// A mill, machines that lack axes of the planes, lathes, five axes.
constexpr const char* kAxes[] = {"XYZC", "X", "C", "XZ", "XZC", "XY", "XYZAC", "XYZUVWABC"};

MachineModel machine(const std::string& axes) {
  MachineModel model;
  for (const char letter : axes)
    model.axes.push_back(
        {std::string(1, letter), letter >= 'A' && letter <= 'C', false, false, -300.0, 300.0, 500.0});
  if (axes.size() == 4) model.axes[1].diameter = true;
  if (axes.starts_with("XZ")) model.axes[0].diameter = true;
  model.spindle_min_rpm = 50.0;
  model.spindle_max_rpm = 6000.0;
  model.tool_places = 99;
  model.power_on = {"G94", "G97", "G90", "G71", "G27"};
  model.variables = {{"ERF", 0.01}, {"MCD", 2.0}};
  return model;
}

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::size_t chosen = size == 0 ? 0 : data[0] % std::size(kAxes);
  const MachineModel model = machine(kAxes[chosen]);
  std::vector<std::string> letters;
  for (const auto& axis : model.axes) letters.push_back(axis.letter);
  const std::string text(reinterpret_cast<const char*>(data), size);
  Tables tables;
  tables.origins[1] = {{"X", 10.0}, {"Y", 20.0}};
  tables.correctors[1].length["Z"] = 50.0;
  const auto loader = [&](std::string_view name) -> std::optional<std::string> {
    if (name == "SUB") return text;
    return std::nullopt;
  };
  Interpreter run("nc110", model, tables, "fuzz.nc", text, loader, Position{});
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
  return 0;
}
