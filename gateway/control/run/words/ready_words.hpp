// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "gateway/control/compose/control.hpp"

namespace servogate::gateway {

/// One condition that is missing for the drives to be on, in words.
struct MissingCondition {
  std::string_view reason;  ///< "emergency_stop", "alarm", "power_on", "drive", "enable", "starting",
                            ///< "not_asked", "switching_off"
  std::string text;         ///< "the emergency-stop chain is open: estop_chain_ok (SA17.BL) is FALSE"
  std::string remedy;       ///< who has to do what
  std::string axes;         ///< letters of the axes that it keeps off, "X, Z"; empty: of all
};

/// What keeps the drives of the axes that programs move from being on, the cause before what follows from it;
/// empty: they are on. An open emergency-stop chain is named alone with the drives that do not answer: what
/// the PLC withholds then follows from it. Not for the cycle.
std::vector<MissingCondition> missing_for_power(Control& control, const image::ProcessImage& image,
                                                const cycle::AlarmSnapshot& alarms, text::Language language);

}  // namespace servogate::gateway
