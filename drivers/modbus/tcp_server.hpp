// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "drivers/modbus/line_address.hpp"
#include "drivers/modbus/link.hpp"

namespace servogate::modbus {

struct ServerSettings {
  TcpAddress listen;  ///< numeric host
  std::vector<std::string>
      clients;  ///< numeric addresses of other computers that are served; this one always is
  std::size_t most_clients = 16;  ///< of connections at once; more are closed again
};

/// What happened on a server since it was opened.
struct ServerCounters {
  std::uint64_t connections = 0, refused = 0, requests = 0, exceptions = 0;
  std::uint64_t malformed = 0;  ///< connections that were closed because what came was no Modbus
};

/// A Modbus TCP server: a thread of its own takes connections and gives each request to a handler, one after
/// the other. What is no Modbus closes its connection. Ends in its destructor.
class TcpServer {
 public:
  /// The answer to a well-formed request, or an exception; `client`: "127.0.0.1:50312". On the server's
  /// thread.
  using Handler = std::function<Response(const Request& request, const std::string& client)>;

  /// nullptr: the address cannot be listened on, `why` says what is wrong. Not real-time safe.
  static std::unique_ptr<TcpServer> open(const ServerSettings& settings, Handler handler,
                                         drivers::Notice& why);
  ~TcpServer();
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  std::uint16_t port() const noexcept { return port_; }
  /// From any thread.
  ServerCounters counters() const noexcept;

 private:
  struct Client {
    int descriptor = -1;
    std::string name;
    std::vector<std::uint8_t> received;
  };
  TcpServer(ServerSettings settings, Handler handler, int listening, std::uint16_t port);
  void work();
  void take_client();
  bool serve(Client& client);
  bool answer(Client& client, std::size_t size);
  bool may_come(const std::string& host) const;

  ServerSettings settings_;
  Handler handler_;
  int listening_;
  std::uint16_t port_;
  drivers::Waker waker_;
  std::vector<Client> clients_;  ///< of the thread
  std::atomic<std::uint64_t> connections_{0}, refused_{0}, requests_{0}, exceptions_{0}, malformed_{0};
  std::thread thread_;
};

}  // namespace servogate::modbus
