// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/notice.hpp"

namespace servogate::usercan {

/// Where a bus server listens: a TCP port, or a Unix socket.
struct Address {
  std::string host;        ///< empty: a Unix socket
  std::uint16_t port = 0;  ///< 0: the system chooses one
  std::string path;

  /// "HOST:PORT" or "unix:PATH", as parse_address() reads it.
  std::string str() const;
};

/// "HOST:PORT" or "unix:PATH"; nullopt: neither. Not real-time safe.
std::optional<Address> parse_address(std::string_view text);
/// The same address with its host in numbers, as connect_to() would reach it; a host that nobody knows stays
/// as it is. Not real-time safe.
Address in_numbers(const Address& address);
/// A listening socket that does not wait, -1: refused, `why` says it. Other computers are never let in: a
/// host that is not loopback is refused. Gives `address` the port that the system chose. Not real-time safe.
int listen_on(Address& address, drivers::Notice& why);
/// A connected socket, -1: refused. Not real-time safe.
int connect_to(const Address& address, drivers::Notice& why);
/// What has just been read is acknowledged now: a peer that gathers what it sends until then (Nagle) would
/// wait up to 40 ms otherwise. The kernel forgets it, so it follows every read; of a Unix socket it does
/// nothing. real-time safe.
void acknowledge_at_once(int socket) noexcept;

}  // namespace servogate::usercan
