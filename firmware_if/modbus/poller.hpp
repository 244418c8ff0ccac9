// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_if/modbus/map.hpp"

namespace servogate::modbus {

struct PollSettings {
  int retries = 1;  ///< repeats of an unanswered transaction before its unit counts as lost
  /// How often a lost unit is tried again, once and one block, so that it does not slow its neighbours.
  image::Nanoseconds lost_retry_ns = 500 * image::kMillisecond;
  /// Where an answer does not say which request it answers (a serial line): blocks of a unit whose answers
  /// look the same are left alone so long after one of them got none and was repeated. Until then a late
  /// answer comes to nobody who could take it for his.
  image::Nanoseconds late_ns = 0;
};

/// What came of a transaction.
struct Outcome {
  std::size_t block = 0;
  bool good = false;
  Exception exception = Exception::none;  ///< that the unit answered
  image::Nanoseconds end_ns = 0;
  Data data;  ///< of a good read, and of an answer of a coding whose writes tell something
};

/// Takes the new content of writing blocks.
class WriteSink {
 public:
  virtual ~WriteSink() = default;
  /// To be written as soon as the line is free. real-time safe.
  virtual void write(std::size_t block, const Data& data, image::Nanoseconds t) noexcept = 0;
};

/// Which transaction is next on a line with one master, as pure state: blocks at their periods, changed
/// outputs at once, repeats, and units that are lost and left alone for a while. It knows neither wire nor
/// clock: whoever carries it says what time it is and what the units answered. One thread; real-time safe but
/// for the constructor.
class Poller final : public WriteSink {
 public:
  Poller(PollSettings settings, std::vector<Block> blocks);
  /// All blocks are due at `t`. Before everything else.
  void start_at(image::Nanoseconds t) noexcept;

  struct Next {
    std::size_t block = 0;
    int attempt = 0;
    image::Nanoseconds start_ns = 0;  ///< not before
  };
  /// The next transaction of a line that is free from `idle_since` on. nullopt: there is nothing to do.
  std::optional<Next> next(image::Nanoseconds idle_since) const noexcept;
  /// Begins it; the request lives until the next begin(). One of answered() and unanswered() follows.
  const Request& begin(const Next& next) noexcept;
  /// An answer that fits the request (decode_response()), perhaps an exception. A late one is none.
  Outcome answered(const Response& response, image::Nanoseconds end) noexcept;
  /// Silence, or an answer that does not fit.
  Outcome unanswered(image::Nanoseconds end) noexcept;
  void write(std::size_t block, const Data& data, image::Nanoseconds t) noexcept override;

  const std::vector<Block>& blocks() const noexcept { return blocks_; }
  std::uint64_t transactions() const noexcept { return transactions_; }
  /// Of a unit by its address: failed transactions, the last exception, and whether it is left alone.
  std::uint32_t errors(std::uint8_t unit) const noexcept { return health_[unit].errors; }
  Exception last_exception(std::uint8_t unit) const noexcept { return health_[unit].last_exception; }
  bool lost(std::uint8_t unit) const noexcept { return health_[unit].lost; }

 private:
  struct State {
    Data data;  ///< next to write
    image::Nanoseconds due_ns = 0;
    image::Nanoseconds awaited_ns = -1;  ///< an answer to it may come as late as that
    bool armed = false;                  ///< there is something to write
    bool changed = false;                ///< since it last went out
    std::vector<std::size_t> alike;      ///< other blocks whose answers could be taken for its own
  };
  struct Health {
    std::uint32_t errors = 0;
    bool lost = false;
    image::Nanoseconds retry_ns = 0;  ///< a lost unit is left alone until then
    Exception last_exception = Exception::none;
  };
  Health& health_of(std::size_t block) noexcept { return health_[blocks_[block].unit]; }
  image::Nanoseconds ready_ns(std::size_t block) const noexcept;
  Outcome failed(image::Nanoseconds end) noexcept;

  PollSettings settings_;
  std::vector<Block> blocks_;
  std::vector<State> states_;
  std::vector<Health> health_;  ///< by unit
  Next now_;
  std::optional<Next> repeat_;
  Request request_;
  std::size_t last_block_ = 0;
  std::uint64_t transactions_ = 0;
};

}  // namespace servogate::modbus
