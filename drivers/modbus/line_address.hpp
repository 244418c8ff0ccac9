// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace servogate::modbus {

/// A TCP peer.
struct TcpAddress {
  std::string host, port;
};

/// "HOST:PORT" or "[IPv6]:PORT", the port 1-65535; nullopt: it is none. Not real-time safe.
std::optional<TcpAddress> parse_tcp(std::string_view text);

}  // namespace servogate::modbus
