// SPDX-License-Identifier: Apache-2.0
#include "drivers/modbus/tcp_server.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "firmware_if/text/system_words.hpp"

namespace servogate::modbus {

namespace {

const text::Entry kNotListening{"modbus.not-listening", "cannot listen on {0}: {1}",
                                "не удаётся слушать {0}: {1}"};

constexpr std::size_t kHeader = 7;  // MBAP with the unit; Modbus Messaging on TCP/IP V1.0b, 3.1.3
constexpr std::size_t kFrame = kHeader - 1 + 1 + kMaxPdu;

std::string name_of(const sockaddr_storage& peer, socklen_t size, std::string& port) {
  char host[NI_MAXHOST] = {}, service[NI_MAXSERV] = {};
  getnameinfo(reinterpret_cast<const sockaddr*>(&peer), size, host, sizeof host, service, sizeof service,
              NI_NUMERICHOST | NI_NUMERICSERV);
  port = service;
  std::string name = host;
  constexpr std::string_view kMapped = "::ffff:";  // IPv4 on a socket of IPv6
  return name.starts_with(kMapped) ? name.substr(kMapped.size()) : name;
}

std::uint16_t port_of(int descriptor) {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size);
  return ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&own)->sin6_port
                                         : reinterpret_cast<sockaddr_in*>(&own)->sin_port);
}

}  // namespace

std::unique_ptr<TcpServer> TcpServer::open(const ServerSettings& settings, Handler handler,
                                           drivers::Notice& why) {
  const std::string place = settings.listen.host + ":" + settings.listen.port;
  addrinfo hints{}, *found = nullptr;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  if (const int error =
          getaddrinfo(settings.listen.host.c_str(), settings.listen.port.c_str(), &hints, &found);
      error != 0) {
    why = {&kNotListening, {place, gai_strerror(error)}};
    return nullptr;
  }
  const int listening = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool listens = bind(listening, found->ai_addr, found->ai_addrlen) == 0 && ::listen(listening, 8) == 0;
  const int error = errno;
  freeaddrinfo(found);
  if (!listens) {
    why = {&kNotListening, {place, text::words_of(error)}};
    ::close(listening);
    return nullptr;
  }
  return std::unique_ptr<TcpServer>(
      new TcpServer(settings, std::move(handler), listening, port_of(listening)));
}

TcpServer::TcpServer(ServerSettings settings, Handler handler, int listening, std::uint16_t port)
    : settings_(std::move(settings)), handler_(std::move(handler)), listening_(listening), port_(port) {
  thread_ = std::thread([this] { work(); });
}

TcpServer::~TcpServer() {
  waker_.end();
  thread_.join();
  for (const Client& c : clients_) ::close(c.descriptor);
  ::close(listening_);
}

ServerCounters TcpServer::counters() const noexcept {
  return {connections_, refused_, requests_, exceptions_, malformed_};
}

bool TcpServer::may_come(const std::string& host) const {
  return host.starts_with("127.") || host == "::1" ||
         std::ranges::find(settings_.clients, host) != settings_.clients.end();
}

void TcpServer::work() {
  pthread_setname_np(pthread_self(), "modbus-server");
  std::vector<pollfd> wanted;
  while (!waker_.ended()) {
    wanted.assign({{waker_.descriptor(), POLLIN, 0}, {listening_, POLLIN, 0}});
    for (const Client& c : clients_) wanted.push_back({c.descriptor, POLLIN, 0});
    if (poll(wanted.data(), wanted.size(), -1) < 0 && errno != EINTR) return;
    for (std::size_t n = 2; n < wanted.size(); ++n) {
      if (wanted[n].revents == 0) continue;
      const auto c = std::ranges::find(clients_, wanted[n].fd, &Client::descriptor);
      if (c == clients_.end() || serve(*c)) continue;
      ::close(c->descriptor);
      clients_.erase(c);
    }
    if (wanted[1].revents != 0) take_client();
  }
}

void TcpServer::take_client() {
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  const int descriptor =
      accept4(listening_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) return;
  std::string port;
  const std::string host = name_of(peer, size, port);
  if (!may_come(host) || clients_.size() >= settings_.most_clients) {
    ++refused_;
    ::close(descriptor);
    return;
  }
  const int yes = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  setsockopt(descriptor, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
  ++connections_;
  clients_.push_back({descriptor, host + ":" + port, {}});
}

/// False: the connection has ended, or is to be ended.
bool TcpServer::serve(Client& client) {
  std::uint8_t bytes[4 * kFrame];
  const ssize_t got = recv(client.descriptor, bytes, sizeof bytes, 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got == 0) return false;
  client.received.insert(client.received.end(), bytes, bytes + got);
  while (client.received.size() >= kHeader) {
    const std::vector<std::uint8_t>& in = client.received;
    const std::size_t size = kHeader - 1 + static_cast<std::size_t>(in[4] << 8 | in[5]);
    if (in[2] != 0 || in[3] != 0 || size < kHeader + 1 || size > kFrame) {
      ++malformed_;
      return false;
    }
    if (in.size() < size) return true;
    if (!answer(client, size)) return false;
    client.received.erase(client.received.begin(),
                          client.received.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return true;
}

bool TcpServer::answer(Client& client, std::size_t size) {
  const std::vector<std::uint8_t>& in = client.received;
  ++requests_;
  Request request;
  Response response;
  response.exception = decode_request({in.data() + kHeader, size - kHeader}, request);
  if (response.exception == Exception::none)
    response = handler_(request, client.name);
  else
    response.function = static_cast<Function>(in[kHeader] & 0x7F);
  if (response.exception != Exception::none) ++exceptions_;
  Pdu pdu;
  if (!encode(response, pdu)) return false;
  std::array<std::uint8_t, kFrame> out{};
  std::copy_n(in.begin(), kHeader, out.begin());
  out[4] = static_cast<std::uint8_t>((pdu.size + 1) >> 8);
  out[5] = static_cast<std::uint8_t>(pdu.size + 1);
  std::copy_n(pdu.bytes.begin(), pdu.size, out.begin() + kHeader);
  const std::size_t whole = kHeader + pdu.size;
  // A client that does not read its answers has to live without them.
  return send(client.descriptor, out.data(), whole, MSG_NOSIGNAL) == static_cast<ssize_t>(whole);
}

}  // namespace servogate::modbus
