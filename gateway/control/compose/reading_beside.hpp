// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>

#include "firmware_if/image/time.hpp"
#include "kernel/channel/process.hpp"

namespace servogate::gateway {

/// Does one piece of work at a time for the owner of a loop.
class RoundWorker {
 public:
  virtual ~RoundWorker() = default;
  /// Begins `work`, which outlives it; the one before is done.
  virtual void start(const std::function<void()>& work) = 0;
  /// Until the last one is done. Any thread.
  virtual void wait() = 0;
  /// Throws here what the last one has thrown, once. The owner's thread, behind wait().
  virtual void rethrow() {}
};

/// Does it at once.
class WorksAtOnce final : public RoundWorker {
 public:
  void start(const std::function<void()>& work) override { work(); }
  void wait() override {}
};

/// Does it on a thread of its own, which lives from the first work on.
class WorksBeside final : public RoundWorker {
 public:
  ~WorksBeside() override;
  void start(const std::function<void()>& work) override;
  void wait() override;
  void rethrow() override;

 private:
  enum class State : std::uint8_t { idle, working, over };
  void live();

  std::atomic<State> state_{State::idle};
  const std::function<void()>* work_ = nullptr;
  std::exception_ptr failed_;
  std::thread thread_;
};

/// On its own thread where the computer has a processor for it.
std::unique_ptr<RoundWorker> round_worker();

/// Reading ahead in virtual time, in all processes. What the next cycle needs is read before it. While the
/// motion has enough ahead, rounds are read beside the cycles: each sees what the cycle had given back when
/// it began, and the cycle sees what it has published at a time of the machine that is fixed when it begins,
/// the later the more lies ahead, or as soon as a process orders something. So no result depends on how long
/// a round takes or on who does it. Not real-time safe.
class ReadingBeside {
 public:
  /// `reading` is held while processes read ahead. All of them outlive it.
  ReadingBeside(std::span<const std::unique_ptr<channel::Process>> processes, std::mutex& reading,
                image::Nanoseconds period_ns, std::unique_ptr<RoundWorker> worker);
  ~ReadingBeside();

  /// The owner of the loop, before cycle number `cycle`.
  void before_cycle(std::int64_t cycle);
  /// Until a round that is under way is done; the cycle sees no more for it. Any thread.
  void wait() { worker_->wait(); }

 private:
  void begin_round(std::int64_t cycle);
  void end_round();
  bool ordered() const;
  channel::Reading needed() const;

  std::span<const std::unique_ptr<channel::Process>> processes_;
  std::mutex& reading_;
  double period_s_;
  double round_s_ = 0.0;  ///< of the machine, for the round under way
  std::function<void()> round_;
  bool under_way_ = false;
  std::int64_t ends_ = 0;  ///< before this cycle
  std::unique_ptr<RoundWorker> worker_;
};

}  // namespace servogate::gateway
