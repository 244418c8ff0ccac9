// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/compose/control.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "gateway/control/server/protocol/reply.hpp"

namespace servogate::gateway {

/// Reads an object of a node through the control that holds its bus. Waits as long as an SDO transfer may
/// take.
Reply sdo_read(Control& control, const ask::SdoRead& wanted, text::Language language);

}  // namespace servogate::gateway
