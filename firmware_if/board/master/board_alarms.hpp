// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/board/master/session.hpp"
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::board {

/// A board that refused its configuration, or speaks another protocol: kBoardRefused of this source. The
/// session is refused. real-time safe.
image::AlarmRecord refused_alarm(const Session& session, int source) noexcept;

/// The alarms that boards raise, with their words. Not real-time safe.
const image::AlarmRoom& alarm_room();

}  // namespace servogate::board
