// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "drivers/mock/drive/simulated_drive.hpp"

/// `--switch` of `servogate drive`. Not real-time safe.
namespace servogate::gateway::command {

/// A switch on an input of a drive, in revolutions of its shaft from where the plant has its zero.
struct SwitchPlace {
  mock::DriveSwitch::Input input = mock::DriveSwitch::Input::home;
  std::optional<double> from_rev, to_rev;  ///< nullopt: no end on this side

  mock::DriveSwitch at(std::int64_t counts_per_rev) const;
};

/// Reads INPUT=FROM..TO, where one end may be left out; nullopt: it is something else, or FROM is not below
/// TO.
std::optional<SwitchPlace> parse_switch(std::string_view words);

}  // namespace servogate::gateway::command
