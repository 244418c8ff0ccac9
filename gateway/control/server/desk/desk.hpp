// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "gateway/control/server/desk/desk_thread.hpp"
#include "gateway/control/server/desk/shut_down.hpp"
#include "gateway/control/server/desk/subscriptions.hpp"
#include "gateway/control/server/desk/urgent_desk.hpp"

namespace servogate::gateway {

/// The desk of a running control. Whoever is its client - a connection of the socket, a pendant, a page, a
/// Modbus server, a scenario - asks in types and is given its own answers. What is urgent is posted by who
/// asks; everything else waits its turn on the desk's thread. What a client holds (jogs, forces, the PLC)
/// ends with it. Any thread, unless it says otherwise.
class Desk {
 public:
  /// Takes the answer to a client's question, by its number. It returns at once and asks nothing.
  using Give = std::function<void(std::uint64_t question, Reply)>;

  explicit Desk(Resident& resident);
  ~Desk() { stop(); }
  Desk(const Desk&) = delete;

  /// Starts its threads; what is asked before waits.
  void start();
  /// Ends them; whoever still waits is answered. Once it has returned nothing is carried out any more.
  void stop();

  /// A new client; its number.
  std::uint64_t open(Give give);
  /// It is gone: once this has returned its `give` is not called any more.
  void close(std::uint64_t client);
  /// Asks. `question`: the client's own number for it; the answer comes by `give`, once, maybe before this
  /// returns. `caller.connection` is set here.
  void ask(std::uint64_t client, std::uint64_t question, ask::Command command, Caller caller);

  /// Snapshots of the machine for clients in this process.
  Subscriptions& subscriptions() noexcept { return subscriptions_; }

  /// A client asked the control to end.
  bool down_requested() const noexcept { return down_.load(); }
  /// Begins the end of the control: its axes and spindles come to rest, while clients may look on.
  void shut_down() noexcept;
  /// They rest, or were waited for long enough.
  bool at_rest() const noexcept { return at_rest_.load(); }
  /// After at_rest(): nothing turns or is on, as far as can be seen.
  bool rests() const noexcept { return shut_down_.rests(); }

 private:
  struct Client {
    std::mutex giving;
    Give give;  ///< none: it is gone
    std::shared_ptr<std::atomic<bool>> gone = std::make_shared<std::atomic<bool>>(false);
  };
  std::shared_ptr<std::atomic<bool>> gone_of(std::uint64_t client);
  void give(const Ticket& ticket, Reply reply);
  void watch();
  std::chrono::milliseconds pause() const;

  Resident& resident_;
  std::mutex mutex_;  ///< of all up to end_
  std::condition_variable wake_;
  std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
  std::uint64_t last_client_ = 0;
  UrgentDesk urgent_;
  bool asked_ = false;  ///< something came since the last look
  bool end_ = false;
  std::atomic<bool> down_{false}, shuts_down_{false}, at_rest_{false};
  ShutDown shut_down_;  ///< the watching thread's
  DeskThread desk_;
  Subscriptions subscriptions_;
  std::thread watching_;
};

}  // namespace servogate::gateway
