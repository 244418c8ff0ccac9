// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::files {

/// A path with the words a person knows it by: "--trace", "the machine file" (text::both).
struct NamedPath {
  std::string name;
  std::string path;  ///< empty: not asked for
};

/// Why outputs cannot be written as they are asked for: a sentence and its arguments.
struct OutputProblem {
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  bool wrong_use = false;  ///< the paths contradict one another; false: the system refuses
};

/// Looks, before a machine moves, whether every output can be written: two outputs are not one file, none of
/// them is an input, its folder exists and may be written to. nullopt: all is well. Leaves no trace behind;
/// devices and pipes are only asked for their permissions. Not real-time safe.
std::optional<OutputProblem> problem_of_outputs(const std::vector<NamedPath>& outputs,
                                                const std::vector<NamedPath>& inputs);
/// The same for a folder that is made when it does not exist yet.
std::optional<OutputProblem> problem_of_folder(const std::string& path);

/// A file without a name that goes when its last user does, in the folder of `beside` or else among the
/// temporary ones. Returns the path that opens it, good while this process keeps it; empty: `error` says why.
std::string nameless_file(const std::string& beside, std::string& error);

}  // namespace servogate::files
