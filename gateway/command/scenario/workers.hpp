// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace servogate::gateway::command {

/// Does `count` pieces of work in up to `jobs` processes, each forked from this one, which has no other
/// thread. `work` runs in the child and gives the answer of piece n as bytes; `take` gets it here, in the
/// order in which they end. A child that dies gives its piece `dead` (by signal, or exit code). False: ended
/// by a signal of the operator.
bool work_beside(std::size_t count, int jobs, const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, std::string)>& take,
                 const std::function<void(std::size_t, const std::string& how)>& dead);

}  // namespace servogate::gateway::command
