// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "gateway/compose/control.hpp"
#include "gateway/server/socket/line.hpp"

namespace servogate::gateway {

/// The answer to `sdo_read` on a socket: an object of a node, read by the control that holds its bus. The
/// keys of the request: bus, node, index, subindex. Waits as long as an SDO transfer may take.
Reply sdo_read(Control& control, const nlohmann::json& request, text::Language language);

}  // namespace servogate::gateway
