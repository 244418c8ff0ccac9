// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::program {

struct Dialect;

/// The dialect of a name, nullptr when this build does not read it.
const Dialect* find_dialect(std::string_view name);
/// All dialects of this build.
std::span<const Dialect* const> all_dialects();

/// Names of the dialects that this build reads: "nc110", ...
std::vector<std::string> dialects();

/// Letters that name an axis in programs of `dialect`, in alphabetical order; empty for one that this build
/// does not read. Not real-time safe.
std::string axis_letters(std::string_view dialect);

}  // namespace servogate::program
