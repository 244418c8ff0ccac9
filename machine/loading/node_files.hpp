// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "machine/keys/reader.hpp"
#include "machine/load.hpp"

namespace servogate::machine {

/// Reads the files that nodes name (program, DCF) into LoadResult::node_files; what is wrong with them is
/// said at the key that names them. Not real-time safe.
/// `of_files`: what the reader of a configuration finds odd in it, with its lines.
void load_node_files(LoadResult& result, Reading& reading, std::vector<text::Finding>& of_files);

/// "2026-11-22 14:30:00" (or without seconds, or the date alone) as 1020h has it. nullopt: no such day or
/// time, or before 1984.
std::optional<canopen::ConfigurationDate> parse_configuration_date(std::string_view text);

}  // namespace servogate::machine
