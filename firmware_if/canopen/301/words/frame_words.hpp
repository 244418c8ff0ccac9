// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {

/// A frame in words, as the pre-defined connection set has it, with what it says where a person wants to
/// know: "SYNC (080h)", "NMT command stop to node 2 (000h)", "RPDO 1 of node 5 (205h)", "SDO request of node
/// 5, write 6040h:00 (605h)"; in both languages (text::both). Not real-time safe.
std::string frame_words(const image::CanFrame& frame);

/// Whether only a master sends such a frame: NMT, SYNC, TIME, RPDOs, SDO requests, layer setting, guarding.
/// real-time safe.
bool sent_by_masters(const image::CanFrame& frame) noexcept;

/// Whether a frame shows that somebody leads nodes at this moment: NMT, SYNC, an RPDO, node guarding, a
/// controlword by SDO, the heartbeat of a master whose node-ID is `master`. Nodes that a master left behind
/// in Operational send nothing of it. real-time safe.
bool leads_nodes(const image::CanFrame& frame, NodeId master) noexcept;

}  // namespace servogate::canopen
