// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/server/desk/outcome.hpp"
#include "gateway/server/desk/question.hpp"

namespace servogate::gateway {

class Resident;

/// Carries out one question; what is_urgent() has a road of its own (UrgentDesk). For the desk's thread.
/// Never throws on bad input.
Outcome dispatch(Resident& resident, const Question& question);

}  // namespace servogate::gateway
