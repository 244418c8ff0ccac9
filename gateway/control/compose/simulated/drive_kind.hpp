// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/mock/drive/simulated_drive.hpp"

/// Kinds of simulated drives, and what of their motor and load can be set. Not real-time safe.
namespace servogate::gateway {

/// "servo", "stepper" or "spindle"; nullopt: no such kind.
std::optional<mock::SimulatedDriveConfig> drive_kind(std::string_view name, int node);
/// All names, for a message.
std::string drive_kinds();
/// A drive with the objects of a data sheet, its encoder, rated torque and speed from there where they are
/// said.
mock::SimulatedDriveConfig drive_of_sheet(std::shared_ptr<const canopen::Eds> sheet, int node);

/// What of a plant a person can set: KEY=VALUE.
struct PlantKey {
  std::string_view key;
  double min, max;
  std::string_view unit;
  std::string_view meaning;
  void (*set)(mock::PlantConfig& plant, double value);
};
/// nullptr: no such key.
const PlantKey* plant_key(std::string_view key);
/// "inertia, load-inertia, ...", for a message.
std::string plant_keys();

}  // namespace servogate::gateway
