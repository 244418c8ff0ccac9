// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "bench/scenario/scenario.hpp"
#include "machine/keys/reader.hpp"

namespace servogate::scenario {

/// A step of [[given]] (`given`), [[step]] or an action of [[random.action]] (`drawn`).
enum class StepKind : std::uint8_t { given, step, drawn };
Step read_step(const machine::Element& table, StepKind kind, machine::Reading& reading);
Condition read_condition(const machine::Element& table, machine::Reading& reading);

}  // namespace servogate::scenario
