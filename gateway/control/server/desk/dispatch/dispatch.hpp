// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/server/resident/work/outcome.hpp"
#include "gateway/control/server/resident/work/question.hpp"

namespace servogate::gateway {

class PlcDesk;
class Resident;

/// Carries out one question; what is_urgent() has a road of its own (UrgentDesk). For the desk's thread.
/// Never throws on bad input.
Outcome dispatch(Resident& resident, PlcDesk& plc, const Question& question);

}  // namespace servogate::gateway
