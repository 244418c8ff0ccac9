// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "kernel/cycle/executive.hpp"

namespace servogate::gateway {

/// How many stops clients have asked for so far. What was asked for before one of them begins nothing behind
/// it, however long it had to wait its turn.
struct Stops {
  std::uint64_t all = 0;   ///< stop, quick stop, hold, power off
  std::uint64_t jogs = 0;  ///< jog_stop
};

/// The one way of clients' requests to the gate of a cycle, for any number of threads: each answer goes to
/// who asked. Nothing here waits but ask().
class RequestDesk {
 public:
  explicit RequestDesk(cycle::Cycle& cycle) : cycle_(cycle) {}
  RequestDesk(const RequestDesk&) = delete;

  /// Sees every request that history::kept() with its answer, under the desk's lock: it must not wait. Set
  /// before anybody asks.
  using Witness = std::function<void(const image::Request&, const image::Answer&)>;
  void set_witness(Witness witness) { witness_ = std::move(witness); }
  /// Hears answers that nobody waits for. Now and then.
  void look_after();

  Stops stops() const;
  /// Posts a request whose answer take() gives; its number. 0: the cycle's queue is full.
  std::uint64_t post(image::Request request);
  /// Posts a request whose answer nobody waits for. False: the cycle's queue is full.
  bool tell(image::Request request);
  /// The answer to a posted request, once.
  std::optional<image::Answer> take(std::uint64_t id);
  /// Its answer is not waited for any longer.
  void forget(std::uint64_t id);

  enum class Outcome {
    answered,
    silent,    ///< the cycle did not answer in time
    overtaken  ///< it would have moved something behind a stop that came later; it was not posted
  };
  /// Posts and waits. `asked_at`: stops() when the client asked.
  Outcome ask(image::Request request, image::Answer& answer, const Stops& asked_at, int patience_ms);

 private:
  std::uint64_t post_locked(image::Request& request);
  void collect();
  bool overtaken(const image::Request& request, const Stops& asked_at) const;

  cycle::Cycle& cycle_;
  mutable std::mutex mutex_;
  Stops stops_;
  std::uint64_t next_id_ = 1;
  std::map<std::uint64_t, std::optional<image::Answer>> awaited_;
  Witness witness_;
  std::map<std::uint64_t, image::Request> witnessed_;  ///< not answered yet
};

}  // namespace servogate::gateway
