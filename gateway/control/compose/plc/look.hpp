// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>

#include "plc/logic/logic.hpp"

namespace servogate::gateway {

/// Has the next scan fill a sample, and waits for it by the wall clock. False: no scan came within the time.
/// Not for the cycle.
bool look(plc::Logic& logic, plc::LogicSample& sample, std::chrono::milliseconds patience);
/// The same for whoever steps the machine: `step` moves it by a cycle, false: it cannot.
bool look(plc::Logic& logic, plc::LogicSample& sample, const std::function<bool()>& step);

}  // namespace servogate::gateway
