// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <variant>

#include "firmware_if/text/finding.hpp"
#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

/// The interpreter has to know packet places as they are when all motion before it has ended: finish it, take
/// a snapshot of the packets in the cycle, then call next() again with them.
struct NeedsSync {
  int line = 0;
};
/// A program error: the commands before it stay valid, nothing after it is read.
struct Error {
  text::Finding finding;
};
using Step = std::variant<Command, NeedsSync, Error>;

}  // namespace servogate::program
