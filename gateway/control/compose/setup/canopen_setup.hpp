// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/canopen/302/segment_config.hpp"
#include "machine/load.hpp"

/// The machine file's buses and device files in the terms of the CANopen master. Not real-time safe.
namespace servogate::gateway {

/// Segment `index` with the axes and spindles that its nodes drive and the stations that they carry.
canopen::SegmentConfig segment_config(const machine::LoadResult& loaded, int index);

}  // namespace servogate::gateway
