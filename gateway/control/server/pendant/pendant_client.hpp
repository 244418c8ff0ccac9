// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/notice.hpp"
#include "gateway/control/server/desk/desk_client.hpp"
#include "gateway/control/server/pendant/pendant_session.hpp"

namespace servogate::gateway {

/// A pendant of a running control, a client of its desk by the pendant's name. It need not be plugged in. Not
/// from a cycle.
class PendantClient {
 public:
  /// nullptr: `why` says what is wrong with the computer. Starts a thread. Before the desk ends it has to.
  static std::unique_ptr<PendantClient> open(Control& control, const machine::PendantConfig& pendant,
                                             Desk& desk, const Announce& announce, drivers::Notice& why);
  ~PendantClient();
  PendantClient(const PendantClient&) = delete;

 private:
  PendantClient(Control& control, const machine::PendantConfig& pendant, Desk& desk, const Announce& announce,
                drivers::PendantPort& port);
  void run();

  std::unique_ptr<drivers::PendantPort> own_;  ///< a real one; a simulated one is the world's
  drivers::PendantPort& port_;
  std::mutex seen_lock_;
  std::unique_ptr<image::ProcessImage> seen_, image_;
  bool any_ = false;  ///< a snapshot has come
  std::atomic<bool> end_{false};
  DeskClient client_;
  PendantSession session_;
  std::thread thread_;
};

}  // namespace servogate::gateway
