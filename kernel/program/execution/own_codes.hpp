// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "kernel/program/execution/state/block_words.hpp"
#include "kernel/program/execution/state/machine.hpp"

namespace servogate::program {

/// The language with the own G and M words of the machine among its tables; null: the machine has none.
std::shared_ptr<const Dialect> with_own_codes(const Dialect& language, const MachineModel& machine);

/// Throws where a row of the machine's own codes is none that the language can take.
void check_own_code(const Dialect& language, const Parameters& parameters, const MachineModel::OwnCode& row);

/// Runs a block with such a word: its words become parameters, and the program is called.
void run_own_code(Execution& run, const BlockWords& words);

}  // namespace servogate::program
