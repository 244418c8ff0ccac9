// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/master/events/bus_event.hpp"
#include "firmware_if/image/alarm.hpp"

namespace servogate::canopen {

/// The alarm that an event of a segment is; nullopt: none. It carries what the event says (DriveReport,
/// BootDetail or FrameDetail as its detail) and the reaction that the segment's configuration wants to the
/// loss of a node. real-time safe.
std::optional<image::AlarmRecord> alarm_of(const BusEvent& event, const SegmentConfig& config) noexcept;

/// So many events of the segment found no place. real-time safe.
image::AlarmRecord reports_lost(const SegmentConfig& config, std::uint32_t count) noexcept;

}  // namespace servogate::canopen
