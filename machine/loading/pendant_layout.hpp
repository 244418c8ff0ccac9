// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "firmware_if/pendant/hands.hpp"
#include "machine/keys/reader.hpp"
#include "machine/load.hpp"

namespace servogate::machine {

/// A text of a device or machine file that has not the form that it should have: path of the key, text, and
/// what it should be in both languages.
using BadText =
    std::function<void(const std::string& path, const std::string& text, const std::string& form)>;

/// The layout that a device file of kind `pendant` describes; `bad` hears of texts that are none.
pendant::Layout pendant_layout(const DeviceConfig& device, const BadText& bad = {});

/// The same with the meanings that the machine file gives its buttons.
pendant::Layout pendant_layout(const DeviceConfig& device, const PendantConfig& pendant,
                               const BadText& bad = {});

/// What this pendant may do at this machine.
pendant::Rules pendant_rules(const MachineConfig& machine, const PendantConfig& pendant,
                             const pendant::Layout& layout);

/// Where a pendant is looked for, of its url without "hid:".
struct HidPlace {
  std::string serial, path;  ///< both empty: any
};
/// nullopt: no such url.
std::optional<HidPlace> hid_place(std::string_view url);

void check_pendant_device(const DeviceConfig& device, Reading& reading);

}  // namespace servogate::machine
