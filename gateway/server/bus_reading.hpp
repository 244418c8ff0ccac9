// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "gateway/compose/control.hpp"

namespace servogate::gateway {

/// What came of reading an object of a node through the control that holds its bus.
struct ReadThrough {
  /// `bus` is no bus of the machine, or it has no such node: what the question names wrongly.
  bool unknown = false;
  /// Another question is under way, or the cycle does not come to it.
  bool no_answer = false;
  nlohmann::json answer;  ///< status, abort, data; null without an answer
};

/// Reads an object; waits as long as an SDO transfer may take. The keys of the request: bus, node, index,
/// subindex.
ReadThrough read_object(Control& control, const nlohmann::json& request);

}  // namespace servogate::gateway
