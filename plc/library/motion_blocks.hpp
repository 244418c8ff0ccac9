// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::plc::library {

/// Structured Text of AXIS_REF and the MC_ blocks after PLCopen, function blocks for motion control, part 1,
/// for auxiliary axes. They write and read image::kMotionFields; the kernel is at the other end.
std::string motion_blocks();

}  // namespace servogate::plc::library
