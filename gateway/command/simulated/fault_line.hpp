// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::gateway::command {

/// What somebody does to simulated drives.
struct DriveDeed {
  enum class Kind { fault, clear, clear_all, input, load, status } kind = Kind::fault;
  int node = 0;               ///< node-ID; 0: all of this process
  std::string device = {};    ///< of `sim`: a name of its machine file instead of drives; empty: drives
  image::Nanoseconds at = 0;  ///< after the start; of a script and of `at=`
  fault::Fault fault;         ///< of fault and clear (its kind)
  mock::DriveSwitch::Input input = mock::DriveSwitch::Input::home;
  bool on = false;       ///< of input
  double load_nm = 0.0;  ///< of load
  std::string words;     ///< as they were said
};

/// Reads a line: KIND [KEY=VALUE...], clear [KIND], input NAME on|off, load NM, status; each with node=N and
/// at=S; of `sim` faults and clear with device=NAME instead of node. Durations are seconds, or a number with
/// ms. nullopt: `why` says what is wrong, in both languages. Kinds and the parameters that each takes are
/// those of fault::kinds() that happen to a drive, with device= of all of them.
std::optional<DriveDeed> parse_deed(std::string_view line, std::string& why);
/// A script: lines SECONDS DEED in any order; empty ones and what follows # are comments. nullopt: `why` says
/// what is wrong with line `number`, in both languages.
std::optional<std::vector<DriveDeed>> parse_script(std::string_view text, int& number, std::string& why);
/// Inputs of a drive: "home", "negative_limit" ...; nullopt: no such input.
std::optional<mock::DriveSwitch::Input> drive_input(std::string_view name);
/// Their names, for a message.
std::string drive_input_names();

}  // namespace servogate::gateway::command
