// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "machine/load.hpp"

namespace servogate::machine {

/// The greatest n of "every n-th SYNC" of the PDOs that carry one of the objects; 1: none is slower.
int slowest(const std::vector<PdoConfig>& pdos, const std::vector<int>& objects);
/// The device of a node ("bus.node"); nullptr: there is none.
const DeviceConfig* device_of(const LoadResult& loaded, const std::string& reference);

}  // namespace servogate::machine
