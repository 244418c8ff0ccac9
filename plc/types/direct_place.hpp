// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware_if/image/packets.hpp"

namespace servogate::plc {

/// Half of packet A belongs to %I, the other to %Q, so that %IX0.0 and %QX0.0 are two places; %M is packet K.
inline constexpr std::uint32_t kOutputBase = image::kPacketASize / 2;

/// The place of `%IX2.3`, `%QB4`, `%MW8`, `%MD2`, `%ML1` (IEC 61131-3:2013, 6.5.5.2): index times size.
/// Without case; nullopt: it is no such address. Sizes of packets are not looked at. Not real-time safe.
std::optional<image::Place> direct_place(std::string_view text);

}  // namespace servogate::plc
