// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"

/// The codes for the keyboard and the screen of the old apparatus: each names what stands for it
/// (specification B 16.10).
namespace servogate::program::nc110::code {

void keyboard(Execution&, const Operands& operands) {
  fail(Wrong::keyboard, operands.column, {std::string(operands.rule->name)});
}
void screen(Execution&, const Operands& operands) {
  fail(Wrong::screen, operands.column, {std::string(operands.rule->name)});
}

}  // namespace servogate::program::nc110::code
