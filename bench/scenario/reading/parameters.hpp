// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "machine/keys/reader.hpp"

namespace servogate::scenario {

/// Values by name, of a case or drawn by chance.
using Parameters = std::vector<std::pair<std::string, machine::Element>>;

/// A value as it stands in a text: 50, 0.5, true, as written; of a table "device=can.x kind=silent".
std::string words_of(const machine::Element& value);

/// "$name" becomes the value of that name, in a longer text its words; "$$" is one "$". A name that is not
/// there is a finding.
void substitute(machine::Element& element, const Parameters& parameters, machine::Reading& reading);

}  // namespace servogate::scenario
