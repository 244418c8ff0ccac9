// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "gateway/control/server/desk/dispatch/dispatch.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/resident/work/workshop.hpp"
#include "gateway/control/server/resident/resident.hpp"

namespace servogate::gateway {

/// Carries out what clients ask for, one request after the other, on a thread of its own: clients take
/// turns, and of one client the next request waits for the answer of the one before. What takes long is
/// done in workshops, meanwhile others are answered.
class DeskThread {
 public:
  /// `give`: takes an answer to its client. Any thread.
  using Give = std::function<void(const Ticket&, Reply)>;

  DeskThread(Resident& resident, Give give);
  ~DeskThread() { stop(); }
  DeskThread(const DeskThread&) = delete;

  /// Starts the thread; what it is given before waits.
  void start();
  // Any thread:
  void take(Question question);
  /// The client is gone: behind what it has asked for, what it held at the PLC is let go.
  void gone(std::uint64_t client);
  /// The control comes to its end: what is being thought about is given up.
  void cancel() { thought_.cancel(); }
  /// Ends the thread behind the request under way; what is to be written is written. Once.
  void stop();

 private:
  struct Queue {
    std::deque<Question> questions;
    bool works = false;  ///< the answer to one is being worked for
    bool gone = false;
  };
  struct Done {
    Question question;
    Finish finish;
  };
  void run();
  bool turn(std::unique_lock<std::mutex>& lock);
  void settle(const Question& question, Outcome outcome);
  void answered(const Question& question, Reply reply);
  void order(Question question, Work work);

  Resident& resident_;
  PlcDesk plc_{resident_};
  Give give_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::uint64_t, Queue> queues_;  ///< by client
  std::uint64_t served_ = 0;               ///< client whose turn it was last
  std::deque<Done> done_;
  bool end_ = false;
  Workshop thought_, files_;
  std::thread thread_;
};

}  // namespace servogate::gateway
