// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "drivers/mock/world/world.hpp"
#include "machine/load.hpp"

namespace servogate::gateway {

/// Everything simulated that a machine file asks for, in the order of the file: its mock buses with their
/// nodes, mock chips and lines, what is wired to nodes, and the wires and turrets of [[simulation]]. Not
/// real-time safe.
std::unique_ptr<mock::World> simulated_world(const machine::LoadResult& loaded);

}  // namespace servogate::gateway
