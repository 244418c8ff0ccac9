// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenario/scenario.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::scenario {

/// The scenarios of a file: one, or one for each of its cases and random runs. `path` is what findings are
/// named by and relative paths start from; `seed`: of what is drawn by chance. With an error among `findings`
/// none is given.
std::vector<Scenario> read_scenarios(const std::string& path, std::string_view text, std::uint64_t seed,
                                     std::vector<text::Finding>& findings);

/// One step from a table of its own, as another program hands it in; nullopt: `findings` says why.
std::optional<Step> read_step(const machine::Element& table, std::vector<text::Finding>& findings);

}  // namespace servogate::scenario
