// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What the two halves of PlcDesk say in the same way.
namespace servogate::gateway::plc_answers {

inline const text::Entry kNoVariable{"plc.no-variable", "there is no variable or place '{0}'",
                                     "переменной или места «{0}» нет"};

}  // namespace servogate::gateway::plc_answers
