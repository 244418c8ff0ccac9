// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "machine/device.hpp"

/// Channels of stations of kind "canopen": which object of the node they are.
namespace servogate::machine {

/// The object behind a channel.
struct ChannelObject {
  PdoObject object;
  std::int8_t bit = -1;  ///< of the object; -1: the whole object is a number
};

/// A module of CiA 401: diN and dqN are bit N % 8 of 6000h and 6200h, sub-index N / 8 + 1; aiN and aqN are
/// 6401h and 6411h, sub-index N + 1. An encoder of CiA 406: ai0 is its position 6004h, ai1 its speed
/// 6030h:01, diN bit N of its alarms 6503h. nullopt: the kind of device has no such channel.
std::optional<ChannelObject> channel_object(DeviceKind kind, ChannelKind channel, int number);

/// The PDO of the list that has this object, nullptr: none has it.
const PdoConfig* pdo_with(const std::vector<PdoConfig>& pdos, const PdoObject& object);

/// Sub-indices of an array that a list maps, as the highest one; 0: none.
int mapped_subindices(const std::vector<PdoConfig>& pdos, std::uint16_t index);

}  // namespace servogate::machine
