// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_change.hpp"

namespace servogate::gateway {

namespace {

/// What cannot be told any more gives an error instead of a motion.
program::Interpreter from_its_middle(program::Interpreter fresh, const ProgramRestart& wanted,
                                     const program::Position& start, const image::Packets& packets) {
  auto found = program::restart(fresh, wanted.at, packets);
  if (const auto* wrong = std::get_if<text::Finding>(&found)) {
    fresh.begin_with({}, *wrong);
    return fresh;
  }
  auto& point = std::get<program::RestartPoint>(found);
  point.interpreter.begin_with(program::approach(point, start, wanted.feed_mm_min, wanted.confirm));
  return std::move(point.interpreter);
}

}  // namespace

std::optional<program::LoadedProgram> load_for(const ProgramFile& file, std::string_view name,
                                               ProgramChangeTap* tap) {
  std::optional<program::LoadedProgram> loaded = file.loader(name);
  if (loaded && tap != nullptr) tap->take_subprogram(file.process, name, loaded->text);
  return loaded;
}

channel::InterpreterFactory interpreter_factory(const ProgramChange& change, ProgramChangeTap* tap) {
  // It shares the file: the program may be replaced while an interpreter of the old one still exists.
  program::ProgramLoader loader = change.file->loader;
  if (tap != nullptr && loader)
    loader = [file = change.file, tap](std::string_view name) { return load_for(*file, name, tap); };
  return [file = change.file, tables = change.tables, loader](const program::Position& start) {
    return program::Interpreter(file->dialect, file->model, tables, file->path.empty() ? "MDI" : file->path,
                                file->text, loader, start, file->process);
  };
}

channel::RestartFactory restart_factory(const ProgramChange& change, ProgramChangeTap* tap) {
  return [fresh = interpreter_factory(change, tap), restart = change.restart.value()](
             const program::Position& start, const image::Packets& packets) {
    return from_its_middle(fresh(start), restart, start, packets);
  };
}

}  // namespace servogate::gateway
