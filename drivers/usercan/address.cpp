// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/address.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "firmware_if/text/system_words.hpp"

namespace servogate::usercan {
namespace {

const text::Entry kNotLoopback{
    "usercan.not-loopback",
    "{0} is not this computer: a bus server listens on loopback or a Unix socket only",
    "{0} — не этот компьютер: сервер шины слушает только loopback или сокет Unix"};
const text::Entry kCannotListen{"usercan.cannot-listen", "cannot listen on {0}: {1}",
                                "нельзя принять соединения на {0}: {1}"};
const text::Entry kCannotConnect{
    "usercan.cannot-connect",
    "no bus server at {0}: {1}. One is started with: servogate can bus can0 --listen {0}",
    "по адресу {0} нет сервера шины: {1}. Запустить: servogate can bus can0 --listen {0}"};

using Resolved = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Resolved resolve(const Address& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found) != 0)
    found = nullptr;
  return {found, &freeaddrinfo};
}

bool loopback(const addrinfo& a) {
  if (a.ai_family == AF_INET)
    return ntohl(reinterpret_cast<const sockaddr_in*>(a.ai_addr)->sin_addr.s_addr) >> 24 == 127;
  return a.ai_family == AF_INET6 &&
         IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6*>(a.ai_addr)->sin6_addr);
}

bool unix_address(const std::string& path, sockaddr_un& out) {
  out = {};
  out.sun_family = AF_UNIX;
  if (path.size() >= sizeof out.sun_path) return false;
  std::memcpy(out.sun_path, path.data(), path.size());
  return true;
}

std::uint16_t port_of(int s) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  if (getsockname(s, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return 0;
  return ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(bound).sin6_port
                                           : reinterpret_cast<const sockaddr_in&>(bound).sin_port);
}

int failed(int s) {
  const int error = errno;
  if (s >= 0) close(s);
  errno = error;
  return -1;
}

int listen_unix(const Address& address) {
  sockaddr_un where;
  if (!unix_address(address.path, where)) {
    errno = ENAMETOOLONG;
    return -1;
  }
  const int s = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (s < 0) return -1;
  const auto* a = reinterpret_cast<const sockaddr*>(&where);
  if (bind(s, a, sizeof where) != 0) {
    // A socket that nobody listens on any more is left over from a server that was killed.
    const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const bool left_over =
        errno == EADDRINUSE && connect(probe, a, sizeof where) != 0 && errno == ECONNREFUSED;
    close(probe);
    if (left_over) unlink(address.path.c_str());
    errno = EADDRINUSE;
    if (!left_over || bind(s, a, sizeof where) != 0) return failed(s);
  }
  return listen(s, 64) == 0 ? s : failed(s);
}

int listen_tcp(Address& address, const addrinfo& a) {
  const int s = socket(a.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (s < 0) return -1;
  const int on = 1;
  setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(s, a.ai_addr, a.ai_addrlen) != 0 || listen(s, 64) != 0) return failed(s);
  address.port = port_of(s);
  return s;
}

}  // namespace

std::string Address::str() const {
  if (host.empty()) return "unix:" + path;
  const bool six = host.find(':') != std::string::npos;
  return (six ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::optional<Address> parse_address(std::string_view text) {
  Address a;
  if (text.starts_with("unix:")) {
    a.path = text.substr(5);
    return a.path.empty() ? std::nullopt : std::optional(a);
  }
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  a.host = text.substr(0, colon);
  if (a.host.size() > 2 && a.host.front() == '[' && a.host.back() == ']')
    a.host = a.host.substr(1, a.host.size() - 2);
  const std::string_view port = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), a.port);
  if (error != std::errc{} || end != port.data() + port.size()) return std::nullopt;
  return a;
}

Address in_numbers(const Address& address) {
  Address numbers = address;
  if (address.host.empty()) return numbers;
  const Resolved found = resolve(address);
  char host[NI_MAXHOST];
  if (found != nullptr &&
      getnameinfo(found->ai_addr, found->ai_addrlen, host, sizeof host, nullptr, 0, NI_NUMERICHOST) == 0)
    numbers.host = host;
  return numbers;
}

int listen_on(Address& address, drivers::Notice& why) {
  int s = -1;
  if (address.host.empty()) {
    s = listen_unix(address);
  } else if (const Resolved found = resolve(address); found == nullptr) {
    errno = EADDRNOTAVAIL;
  } else if (!loopback(*found)) {
    why = {&kNotLoopback, {address.host}};
    return -1;
  } else {
    s = listen_tcp(address, *found);
  }
  if (s < 0) why = {&kCannotListen, {address.str(), text::words_of(errno)}};
  return s;
}

int connect_to(const Address& address, drivers::Notice& why) {
  int s = -1;
  errno = EADDRNOTAVAIL;
  if (address.host.empty()) {
    sockaddr_un where;
    if (unix_address(address.path, where)) {
      s = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (s >= 0 && connect(s, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0) s = failed(s);
    }
  } else if (const Resolved found = resolve(address); found != nullptr) {
    s = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (s >= 0 && connect(s, found->ai_addr, found->ai_addrlen) != 0) s = failed(s);
    const int on = 1;
    if (s >= 0) setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  if (s < 0) why = {&kCannotConnect, {address.str(), text::words_of(errno)}};
  return s;
}

void acknowledge_at_once(int socket) noexcept {
  const int on = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
}

}  // namespace servogate::usercan
