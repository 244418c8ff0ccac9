// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/notice.hpp"
#include "drivers/usercan/address.hpp"
#include "drivers/usercan/server/bus.hpp"

namespace servogate::usercan {

struct BusServerConfig {
  Address listen;
  std::vector<std::string> buses = {"can0"};
  std::uint32_t bit_rate = 1'000'000;  ///< bit/s of every bus
  /// Participants in lockstep for whom time waits before it begins; 0: time is the computer's.
  int lockstep = 0;
  Nanoseconds until = 0;           ///< lockstep: time ends here; 0: when the last participant has left
  std::size_t backlog = 8u << 20;  ///< bytes that may wait for a participant that does not read
};

/// CAN buses for processes of this computer, over TCP on loopback or a Unix socket, in the words of
/// socketcand (rawmode). Each bus is a simulated wire: frames of different participants compete by identifier
/// when it falls idle, those of one participant keep their order, none is lost: whoever sends faster than the
/// bus carries is read later, whoever does not read for `backlog` bytes is thrown out and named.
///
/// In lockstep the server grants time: all participants hear what has happened until then, answer when they
/// are done, and only then time goes on, to the next frame's end or to the earliest time that one of them
/// wants. Same participants, same bytes, whatever the computer does besides.
///
/// Belongs to one thread. Not real-time safe.
class BusServer {
 public:
  using Report = std::function<void(const drivers::Notice&)>;

  /// nullptr: refused, `why` says it. `report` hears who comes to grief later.
  static std::unique_ptr<BusServer> open(BusServerConfig config, Report report, drivers::Notice& why);
  ~BusServer();
  BusServer(const BusServer&) = delete;
  BusServer& operator=(const BusServer&) = delete;

  /// Where it listens, with the port that the system chose.
  const Address& address() const noexcept { return config_.listen; }
  /// Waits for something to do, at most so long, and does it. False: lockstep has come to its end.
  bool serve(Nanoseconds at_most);

  /// Somebody who sees the wire of a bus, by its place in the configuration.
  void set_monitor(std::size_t bus, mock::CanMonitor* monitor) { buses_[bus]->set_monitor(monitor); }
  std::size_t participants() const noexcept { return participants_.size(); }
  /// Time of the buses, from 0; and when that was, since 1970 (in lockstep 0).
  Nanoseconds now() const noexcept { return now_; }
  Nanoseconds epoch() const noexcept { return epoch_; }
  const mock::CanStatistics& statistics(std::size_t bus) const { return buses_[bus]->segment().statistics(); }

 private:
  BusServer(BusServerConfig config, int socket, Report report);

  void wait(Nanoseconds at_most);
  void accept_new();
  void advance(Nanoseconds t);
  void carry_out();
  bool carry_out_next(Participant& who);
  void hear_word(Participant& who, std::string_view element);
  bool send_frame(Participant& who, std::string_view words, bool remote);
  void open_bus(Participant& who, std::string_view name);
  void flush();
  void bury();
  void refuse(Participant& who, std::string_view text);

  // Lockstep.
  void join_lockstep(Participant& who, std::string_view name);
  bool all_done() const;
  void begin_lockstep();
  bool go_on();
  void grant();
  bool wakes(const Participant& who) const noexcept;
  void watch_wish(Participant& who);
  Nanoseconds next_time();
  void end_lockstep();
  void watch_for_stall();

  BusServerConfig config_;
  int socket_;
  Report report_;
  std::vector<std::unique_ptr<Bus>> buses_;
  std::vector<std::unique_ptr<Participant>> participants_;  ///< in lockstep by name, then as they came
  std::uint64_t next_number_ = 1;
  Nanoseconds start_ = 0;  ///< monotonic time at which now_ was 0
  Nanoseconds epoch_ = 0;  ///< wall-clock time at which now_ was 0
  Nanoseconds now_ = 0;
  bool begun_ = false, ended_ = false;
  Nanoseconds stalled_since_ = 0;  ///< monotonic; when the last grant was given
  bool stall_said_ = false;
};

}  // namespace servogate::usercan
