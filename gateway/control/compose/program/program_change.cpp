// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_change.hpp"

namespace servogate::gateway {

channel::InterpreterFactory interpreter_factory(const ProgramChange& change, ProgramChangeTap* tap) {
  // It shares the file: the program may be replaced while an interpreter of the old one still exists.
  program::ProgramLoader loader = change.file->loader;
  if (tap != nullptr && loader)
    loader = [file = change.file, tap](std::string_view name) {
      std::optional<program::LoadedProgram> loaded = file->loader(name);
      if (loaded) tap->take_subprogram(name, loaded->text);
      return loaded;
    };
  return [file = change.file, tables = change.tables, loader](const program::Position& start) {
    return program::Interpreter(file->dialect, file->model, tables, file->path.empty() ? "MDI" : file->path,
                                file->text, loader, start, file->process);
  };
}

}  // namespace servogate::gateway
