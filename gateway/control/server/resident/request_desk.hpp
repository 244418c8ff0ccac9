// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
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

/// When something was asked for, and by whom.
struct Asked {
  Stops stops;  ///< stops() then
  std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  std::shared_ptr<const std::atomic<bool>> gone;  ///< true: its client is gone; none: nobody can go
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
  /// A request that is not cycle::never_too_old() is refused when it has lain for longer, from Asked::since
  /// to the cycle that comes to it. Before anybody asks; without it there is no limit, as in virtual time,
  /// whose machine knows no wall clock.
  static constexpr std::chrono::milliseconds kLongestWait{100};
  void set_longest_wait(std::chrono::milliseconds limit) { longest_wait_ = limit; }
  /// What is done while an answer is waited for: whoever waits is the thread that steps the machine, and
  /// moves it by a cycle; false: it cannot. Then nothing here looks at the wall clock. Before anybody asks;
  /// without it the waiting thread sleeps.
  void set_pause(std::function<bool()> pause) { pause_ = std::move(pause); }
  /// Waits a little, or steps; false: the machine has come to its end.
  bool pause() const;
  /// The waiting thread steps the machine.
  bool stepped() const noexcept { return pause_ != nullptr; }
  /// Hears answers that nobody waits for. Now and then.
  void look_after();

  Stops stops() const;
  /// Posts a request whose answer take() gives; its number. 0: the cycle's queue is full.
  std::uint64_t post(image::Request request);
  /// Posts a request whose answer nobody waits for. False: the cycle's queue is full.
  bool tell(image::Request request);
  /// The request has lain too long, or its client is gone, and it is not cycle::never_too_old(): the answer
  /// that refuses it. Not for the desk's own requests.
  std::optional<image::Answer> stale(const image::Request& request, const Asked& asked) const;
  /// The answer to a posted request, once.
  std::optional<image::Answer> take(std::uint64_t id);
  /// Its answer is not waited for any longer.
  void forget(std::uint64_t id);

  enum class Outcome {
    answered,   ///< by the cycle, or it was stale()
    silent,     ///< the cycle did not come to it in time; it was withdrawn, so that none ever does
    taken,      ///< the cycle did not answer, but has taken it, or a stop is left to it
    overtaken,  ///< it would have moved something behind a stop that came later; it was not posted
  };
  /// Posts and waits. What is not cycle::never_too_old() is withdrawn when its client goes meanwhile.
  Outcome ask(image::Request request, image::Answer& answer, const Asked& asked, int patience_ms);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kAnyTime{-1};
  struct Post {
    std::uint64_t id = 0;  ///< 0: the cycle's queue is full
    cycle::Claim claim = 0;
  };
  Post post_locked(image::Request& request, const Asked* asked = nullptr);
  Outcome wait(const Post& post, const image::Request& request, image::Answer& answer, const Asked& asked,
               Clock::time_point end);
  bool withdraw(const Post& post);
  Outcome refused(const image::Request& request, cycle::Refusal why, image::Answer& answer);
  void tell_witness(const image::Request& request, const image::Answer& answer) const;
  void collect();
  bool overtaken(const image::Request& request, const Stops& asked_at) const;

  cycle::Cycle& cycle_;
  mutable std::mutex mutex_;
  Stops stops_;
  std::chrono::milliseconds longest_wait_ = kAnyTime;
  std::uint64_t next_id_ = 1;
  std::map<std::uint64_t, std::optional<image::Answer>> awaited_;
  std::function<bool()> pause_;
  Witness witness_;
  std::map<std::uint64_t, image::Request> witnessed_;  ///< not answered yet
};

}  // namespace servogate::gateway
