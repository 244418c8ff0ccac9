// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::image {

/// A classic frame in the figures of an alarm record, and back: the identifier in `value`, the bytes in
/// `limit` and `detail1` (four each, little-endian), in `detail2` the length and what kind it is (0: only the
/// identifier is known). real-time safe.
void pack_frame(const CanFrame& frame, AlarmRecord& record) noexcept;
CanFrame unpack_frame(const AlarmRecord& record) noexcept;

}  // namespace servogate::image
