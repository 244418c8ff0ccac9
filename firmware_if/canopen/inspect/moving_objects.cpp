// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/moving_objects.hpp"

#include <algorithm>
#include <iterator>

namespace servogate::canopen {

bool can_move(std::uint16_t index) {
  constexpr std::uint16_t kObjects[] = {0x6040, 0x6042, 0x6060, 0x6071, 0x607A, 0x60B0,
                                        0x60B1, 0x60B2, 0x60C1, 0x60FE, 0x60FF};
  if (index == 0x1F82 || index == 0x1F51) return true;
  if (index < 0x6000 || index >= 0xA000) return false;
  const auto own = static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  // Outputs of a CiA 401 module, digital and analogue, with their polarity: valves and brakes hang on them.
  if ((own >= 0x6200 && own < 0x6400) || (own >= 0x6410 && own < 0x6420)) return true;
  return std::find(std::begin(kObjects), std::end(kObjects), own) != std::end(kObjects);
}

bool takes_energy_away(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data) {
  constexpr std::uint8_t kEnableVoltage = 1 << 1, kNoQuickStop = 1 << 2, kFaultReset = 1 << 7;
  const bool controlword = index >= 0x6000 && index < 0xA000 && (index - 0x6000) % 0x800 == 0x40;
  if (!controlword || subindex != 0 || data.size() != 2 || (data[0] & kFaultReset) != 0) return false;
  return (data[0] & kEnableVoltage) == 0 || (data[0] & kNoQuickStop) == 0;
}

}  // namespace servogate::canopen
