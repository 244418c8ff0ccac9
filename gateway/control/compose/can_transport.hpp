// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/gsusb/gsusb_bus.hpp"
#include "drivers/notice.hpp"
#include "drivers/socketcan/socketcan_bus.hpp"
#include "drivers/usercan/socketcand_bus.hpp"
#include "drivers/usercan/udp_bus.hpp"

namespace servogate::gateway {

/// A bus that a url of the machine file or the command line names, opened. Which scheme is which transport is
/// one table in can_transport.cpp; docs/can.md tells people.
struct CanTransport {
  std::unique_ptr<image::CanBus> bus;
  usercan::SocketcandBus* lockstep = nullptr;  ///< the same bus where its time is granted
  gsusb::GsUsbBus* adapter = nullptr;          ///< the same bus where it is a USB adapter
  int descriptor = -1;                         ///< for poll(2)
  bool nothing_real = false;                   ///< no real bus can be behind it
};

struct CanTransportOptions {
  /// bit/s; 0: that of the interface, 1 Mbit/s on a bus without a wire. An adapter has none of its own.
  std::uint32_t bit_rate = 1'000'000;
  bool listen_only = false;                ///< acknowledges nothing, sends nothing; where the transport can
  std::vector<socketcan::Filter> filters;  ///< where the transport has them; empty: everything
  std::string participant;                 ///< name in lockstep
};

/// nullopt: refused, `why` says what is wrong and what mends it. mock: urls are no transport of their own:
/// they live inside one control. Not real-time safe.
std::optional<CanTransport> open_can(std::string_view url, const CanTransportOptions& options,
                                     drivers::Notice& why);

/// What a CANopen master has to hear of a bus with these nodes: all services of them, and of everybody what
/// shows that a node is there or that somebody else plays master. Not real-time safe.
std::vector<socketcan::Filter> master_filters(const std::vector<int>& nodes);

}  // namespace servogate::gateway
