// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "machine/config.hpp"
#include "plc/compile/compile.hpp"

namespace servogate::gateway {

/// How the PLC programs of a machine are compiled.
inline plc::Options logic_options(const machine::MachineConfig& machine) {
  plc::Options options;
  options.k_bytes = static_cast<std::uint32_t>(machine.control.k_size);
  options.v_bytes = static_cast<std::uint32_t>(machine.control.syvar_size);
  options.cycle_ns = machine.cycle_ns();
  options.instruction_budget = machine.plc.instruction_budget;
  return options;
}

}  // namespace servogate::gateway
