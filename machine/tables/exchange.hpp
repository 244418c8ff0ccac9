// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "kernel/program/execution/state/machine.hpp"

/// Tables of origins and tools as files of other programs. mm or degrees, radius on diameter axes, as in the
/// machine's own files. Not real-time safe.
namespace servogate::machine {

enum class TableKind : std::uint8_t { origins, tools };

/// CSV by RFC 4180 with a header: `origin,X,Y,Z`, or
/// `tool,name,radius,radius_wear,quadrant,life_min,used_min,alternate,X,Z,wear_X,wear_Z` with one column an
/// axis of the machine. An empty field is a value that the row does not name.
std::string to_csv(const program::Tables& tables, TableKind kind, const std::vector<std::string>& axes);
/// The tools as LinuxCNC keeps them, a line each: `T1 P1 Z+85.000000 D10.000000 Q3 ;face mill`. Wear is added
/// to the lengths and the radius, since that file has none.
/// Source: LinuxCNC documentation, "Tool table format".
std::string to_linuxcnc(const program::Tables& tables, const std::vector<std::string>& axes);

/// Reads a file of one of the two forms into `tables`, where its rows replace those of their numbers. The
/// form is that of LinuxCNC where `file` ends in .tbl or .tool, else CSV. False: `findings` say what is wrong
/// and where, and `tables` is unchanged.
bool read_exchange(std::string_view text, const std::string& file, TableKind kind,
                   const std::vector<std::string>& axes, program::Tables& tables,
                   std::vector<text::Finding>& findings);
/// "used for 12.5 of 60 min, alternate T4": the life of a tool in words; empty: it is not limited.
std::string life_words(double life_min, double used_min, int alternate);
/// The name of a file is one of LinuxCNC's form.
bool names_linuxcnc(std::string_view file);

}  // namespace servogate::machine
