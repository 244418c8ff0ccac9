// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "drivers/socketcan/link.hpp"

namespace servogate::gateway::command {

/// What listening at the usual rates found.
struct DetectedRate {
  std::optional<std::uint32_t> bit_rate;  ///< nullopt: frames came at none of them
  std::string problem;                    ///< why it could not be tried, in the system's words; empty: it was
};

/// Listens at every usual bit rate, without driving the bus, until frames come without errors. The interface
/// is down before and after, with the bit rate that it had. Needs CAP_NET_ADMIN and a controller that can
/// listen only. `tell` hears each rate before it is tried; it stops the search by returning false. Not
/// real-time safe.
DetectedRate detect_bit_rate(const socketcan::LinkInfo& link, const std::function<bool(std::uint32_t)>& tell);

/// The same with a USB adapter, which is started anew for every rate; `url` is gsusb:SERIAL. Not real-time
/// safe.
DetectedRate detect_bit_rate(const std::string& url, const std::function<bool(std::uint32_t)>& tell);

}  // namespace servogate::gateway::command
