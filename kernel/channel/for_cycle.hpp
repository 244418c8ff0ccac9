// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "firmware_if/image/packets.hpp"
#include "kernel/channel/event.hpp"
#include "kernel/channel/motion/path_elements.hpp"
#include "kernel/channel/program_texts.hpp"

namespace servogate::channel {

/// What the cycle is to do for a command.
struct ForCycle {
  EventKind kind;
  Event event;
  bool at_once = false;  ///< not in the order of the path
};

/// A command that is no motion and concerns no other process, as an event whose place is left to the feeder;
/// nullopt: nothing is to be done in the cycle. `view` is what the interpreter sees of its own writes: a
/// write goes into it. Not real-time safe.
std::optional<ForCycle> for_cycle(const program::Command& command, PathElements& elements,
                                  ProgramTexts& texts, image::Packets& view);

}  // namespace servogate::channel
