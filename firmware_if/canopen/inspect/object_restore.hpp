// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "firmware_if/canopen/inspect/object_walk.hpp"

/// Parameters of a file back into a device. Not real-time safe.
namespace servogate::canopen {

/// The download that did not succeed.
struct FailedWrite {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  SdoOutcome outcome;
};

/// Writes those parameters of the file into the node that `differing` names, in the order of their indices. A
/// PDO of which something differs is written whole, in the order that a device takes: not valid (bit 31 of
/// its COB-ID), its map emptied, the entries, their number, and the COB-ID at the end. Source: CiA 301,
/// 7.5.2.36. A parameter that the device refuses keeps the others from nothing; a node that does not answer
/// ends it. How many were written; what was refused is in `failed`.
int restore(SdoAccess& access, NodeId node, const Eds& file, const std::vector<Difference>& differing,
            std::vector<FailedWrite>& failed, const std::function<bool()>& over);

}  // namespace servogate::canopen
