// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/drive/measurement/guard.hpp"

namespace servogate::gateway::command {

/// The report of a run: one page without scripts and without the network, its plots as SVG. What stands in
/// `meta` cannot break out of it. Not real-time safe.
std::string run_page(const bench::Guard& guard, const nlohmann::json& meta);

}  // namespace servogate::gateway::command
