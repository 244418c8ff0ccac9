// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "gateway/control/server/protocol/reply.hpp"

namespace servogate::gateway {

/// Reads an object of a node through the control that holds its bus. Waits as long as an SDO transfer may
/// take.
/// `pause`: waits a little, or moves a machine that whoever asks steps (RequestDesk::pause); none: it sleeps.
Reply sdo_read(Control& control, const ask::SdoRead& wanted, text::Language language,
               const std::function<bool()>& pause = {});

}  // namespace servogate::gateway
