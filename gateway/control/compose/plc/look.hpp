// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "plc/logic/logic.hpp"

namespace servogate::gateway {

/// Has the next scan fill a sample, and waits for it by the wall clock. False: no scan came within the time.
/// Not for the cycle.
bool look(plc::Logic& logic, plc::LogicSample& sample, std::chrono::milliseconds patience);

}  // namespace servogate::gateway
