// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/machine/config.hpp"

namespace servogate::gateway {

/// A refusal of the gate as an answer: `ok` false, `code`, `text` in the units that people write (of a
/// diameter axis the diameter), `exit`.
nlohmann::json refusal_json(image::Answer answer, const machine::MachineConfig& machine,
                            text::Language language);

}  // namespace servogate::gateway
