// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace servogate::program {

/// Another program, and where people find it.
struct LoadedProgram {
  LoadedProgram(std::string text_, std::string path_ = {}) : text(std::move(text_)), path(std::move(path_)) {}
  std::string text;
  std::string path;  ///< as findings name it; empty: the name by which it was called
};
/// Gives another program by its name (a subprogram), nullopt when there is none.
using ProgramLoader = std::function<std::optional<LoadedProgram>(std::string_view name)>;

}  // namespace servogate::program
