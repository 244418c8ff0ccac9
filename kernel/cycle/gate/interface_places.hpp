// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/interface_map.hpp"

/// Places of packet K that the executive reads and writes, found at compile time in the interface tables.
namespace servogate::cycle::places {

inline constexpr image::Place kEstopOk = image::field(image::kMachineFields, "estop_ok", image::kMachineBase);
inline constexpr image::Place kControlAlive =
    image::field(image::kMachineFields, "control_alive", image::kMachineBase);
inline constexpr image::Place kReady = image::field(image::kMachineFields, "ready", image::kMachineBase);
inline constexpr image::Place kPowerRequest =
    image::field(image::kMachineFields, "power_request", image::kMachineBase);
/// Of a process: add its base with image::at().
inline constexpr image::Place kStart = image::field(image::kProcessFields, "start");
inline constexpr image::Place kReset = image::field(image::kProcessFields, "reset");
inline constexpr image::Place kExternalAlarm = image::field(image::kProcessFields, "external_alarm");

/// Cycles between two changes of kControlAlive.
inline constexpr std::int64_t kAliveCycles = 50;

}  // namespace servogate::cycle::places
