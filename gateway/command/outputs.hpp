// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/files/output_files.hpp"
#include "gateway/machine/load.hpp"

namespace servogate::gateway::command {

/// Before anything moves: kDone when the outputs can be written and overwrite nothing that the command reads,
/// the machine's files and `others`; otherwise the exit code, after saying why. `state`: folder, empty: none.
int check_outputs(const std::vector<files::NamedPath>& outputs, const std::string& state,
                  const machine::LoadResult& machine, const std::vector<files::NamedPath>& others);

}  // namespace servogate::gateway::command
