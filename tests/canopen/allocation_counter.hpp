// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::canopen::testing {

/// Calls of operator new in this program so far, of any thread.
long allocations();

}  // namespace servogate::canopen::testing
