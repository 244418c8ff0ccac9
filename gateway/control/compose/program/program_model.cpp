// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_model.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "machine/files/read_file.hpp"
#include "machine/state/state.hpp"

namespace servogate::gateway {

program::MachineModel program_model(const machine::MachineConfig& machine, int process) {
  program::MachineModel model;
  for (const machine::AxisConfig& a : machine.axes) {
    if (a.auxiliary) continue;  // behind all others
    program::MachineModel::Axis axis;
    axis.letter = a.letter;
    axis.rotary = a.type == machine::AxisType::rotary;
    axis.diameter = a.diameter;
    if (!a.endless()) {
      axis.travel_min = a.travel_min;
      axis.travel_max = a.travel_max;
    }
    axis.reference = a.endless() ? a.home.position : std::clamp(a.home.position, a.travel_min, a.travel_max);
    axis.process = a.process - 1;
    axis.endless = a.endless();
    axis.rapid = a.max_velocity;
    axis.acceleration = a.max_acceleration;
    axis.jerk = a.max_jerk;
    axis.window_max = a.following_error_stop;
    axis.window_coarse = a.coarse_window();
    model.axes.push_back(axis);
  }
  model.spindles =
      static_cast<int>(std::count_if(machine.spindles.begin(), machine.spindles.end(),
                                     [process](const auto& s) { return s.process == process + 1; }));
  if (const machine::SpindleConfig* spindle = machine.spindle_of_process(process); spindle != nullptr) {
    model.spindle_min_rpm = spindle->min_speed;
    model.spindle_max_rpm = spindle->max_speed;
    model.spindle_angle = spindle->has_encoder() && !spindle->drive.empty();
    model.spindle_axis = machine.axis_index(spindle->axis);
    model.spindle_axis_on_m = static_cast<int>(spindle->axis_m[0]);
    model.spindle_axis_off_m = static_cast<int>(spindle->axis_m[1]);
  }
  int of_process = 0;
  for (const machine::SpindleConfig& s : machine.spindles)
    if (s.process == process + 1 && ++of_process == 2 && s.coupling != machine::Coupling::none)
      model.coupled_max_rpm = s.max_speed;
  model.tool_places = machine.control.tool_places;
  model.contour_tolerance_mm = machine.control.contour_tolerance;
  model.arc_feed = static_cast<program::ArcFeed>(machine.control.arc_feed);
  model.k_bytes = static_cast<std::uint32_t>(machine.control.k_size);
  model.syvar_bytes = static_cast<std::uint32_t>(machine.control.syvar_size);
  model.kind = static_cast<program::MachineModel::Kind>(machine.control.kind);
  model.power_on = machine.control.power_on;
  model.variables = machine.control.variables;
  for (const machine::OwnCodeConfig& c : machine.own_codes)
    model.own_codes.push_back(
        {c.code, std::filesystem::absolute(machine.resolve(c.program)).string(), c.words});
  for (const image::Symbol& s : machine.symbol_table())
    if (s.writer != image::Writer::program) model.protected_places.push_back({s.place, s.name});
  return model;
}

program::Tables program_tables(const machine::MachineConfig& machine, const std::string& folder,
                               std::vector<text::Finding>& findings) {
  const machine::StateDirectory directory(folder.empty() ? machine.resolve(machine.run.state) : folder,
                                          machine.letters());
  return directory.load_tables(findings);
}

program::ProgramLoader program_loader(const std::string& main_program) {
  const std::filesystem::path folder = std::filesystem::path(main_program).parent_path();
  return [folder](std::string_view name) -> std::optional<program::LoadedProgram> {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    for (const std::string& base : {std::string(name), lower})
      for (const char* extension : {"", ".nc", ".NC", ".SPF", ".spf"}) {
        std::string ignored;
        const std::filesystem::path path = folder / (base + extension);
        if (auto content = files::read_file(path.string(), files::kMostOfProgram, ignored))
          return program::LoadedProgram{std::move(*content), path.string()};
      }
    return std::nullopt;
  };
}

}  // namespace servogate::gateway
