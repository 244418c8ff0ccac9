// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace servogate::modbus {

/// What came of a request.
enum class Heard : std::uint8_t {
  answer,             ///< one that fits the request, perhaps an exception
  silence,            ///< nothing in time
  half,               ///< it began, and did not end in time
  wrong_transaction,  ///< TCP: an answer to another request
  wrong_unit,         ///< of another unit than was asked
  malformed,          ///< checksum, function, length or echo do not fit
  broken,             ///< the connection has ended, or the device is gone
  given_up,           ///< whoever waited was told to end
};
inline constexpr std::size_t kHeard = 8;

/// What happened on a line since it was opened.
struct LineCounters {
  std::uint64_t openings = 0;         ///< of the link, the first one, too
  std::uint64_t failed_openings = 0;  ///< host not reachable, device gone
  std::uint64_t requests = 0;
  std::uint64_t repeats = 0;                  ///< requests that were sent again for want of an answer
  std::uint64_t exceptions = 0;               ///< answers that are exceptions; also in heard[answer]
  std::array<std::uint64_t, kHeard> heard{};  ///< by Heard
  std::uint64_t of(Heard h) const noexcept { return heard[static_cast<std::size_t>(h)]; }
  /// Requests to which nobody answered, or not in time.
  std::uint64_t timeouts() const noexcept { return of(Heard::silence) + of(Heard::half); }
  /// Answers to something else than what was asked, or damaged on the way.
  std::uint64_t wrong() const noexcept {
    return of(Heard::wrong_transaction) + of(Heard::wrong_unit) + of(Heard::malformed);
  }
};

/// A line, real or simulated, that counts.
class CountedLine {
 public:
  virtual ~CountedLine() = default;
  /// From any thread.
  virtual LineCounters counters() const noexcept = 0;
};

/// The counters of one thread for all others. real-time safe.
class LineTally {
 public:
  void opened() noexcept { add(openings_); }
  void not_opened() noexcept { add(failed_openings_); }
  void asked(bool repeat) noexcept {
    add(requests_);
    if (repeat) add(repeats_);
  }
  void heard(Heard h, bool exception = false) noexcept {
    add(heard_[static_cast<std::size_t>(h)]);
    if (exception) add(exceptions_);
  }
  LineCounters counters() const noexcept {
    LineCounters c{openings_, failed_openings_, requests_, repeats_, exceptions_, {}};
    for (std::size_t h = 0; h < kHeard; ++h) c.heard[h] = heard_[h];
    return c;
  }

 private:
  using Counter = std::atomic<std::uint64_t>;
  static void add(Counter& counter) noexcept { counter.fetch_add(1, std::memory_order_relaxed); }
  Counter openings_{0}, failed_openings_{0}, requests_{0}, repeats_{0}, exceptions_{0};
  std::array<Counter, kHeard> heard_{};
};

}  // namespace servogate::modbus
