// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/usercan/rig/process.hpp"

namespace servogate::usercan {

using Changes = std::vector<std::pair<std::string, std::string>>;  ///< what stands there, and what instead

/// The example mill with its bus behind another url, as a file. Switches and panel stay mocks.
std::string mill(const std::string& url, const Changes& changes = {});
/// What lets it run in real time on a busy computer: nothing real on its bus, 4 ms, late answers are waited
/// for, and a drive whose process came late does not trip on its own following error.
Changes patience();
/// Its four drives in three processes.
std::vector<std::unique_ptr<Process>> mill_drives(const std::string& machine);

}  // namespace servogate::usercan
