// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "firmware_if/pendant/report.hpp"

namespace servogate::drivers {

/// What comes from a pendant.
struct PendantNews {
  enum class Kind : std::uint8_t {
    plugged,      ///< it is there; `words`: where, for people
    unplugged,    ///< it was there and has gone
    not_allowed,  ///< it is there, and this program may not open it; `words`: what, and the system's words
    report,
  };
  Kind kind = Kind::report;
  pendant::ReportWriter::Bytes report{};
  std::string words{};
};

/// A pendant that comes and goes, real or simulated. Not real-time safe; any thread.
class PendantPort {
 public:
  virtual ~PendantPort() = default;
  /// The oldest news that nobody has taken; false: there is none.
  bool take(PendantNews& news) {
    const std::scoped_lock lock(mutex_);
    if (news_.empty()) return false;
    news = std::move(news_.front());
    news_.pop_front();
    return true;
  }
  /// Until there is news, at most so long.
  void wait(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, time, [this] { return !news_.empty(); });
  }
  /// Feature reports for its display, each with its number in front; newer ones replace those that wait.
  virtual void show(std::vector<std::vector<std::uint8_t>> reports) = 0;

 protected:
  /// Nobody takes them any more where so many wait: what the pendant jogs is to end, as if it were unplugged.
  static constexpr std::size_t kMost = 1000;
  void put(PendantNews news) {
    const std::scoped_lock lock(mutex_);
    if (news_.size() >= kMost) {
      news_.clear();
      news_.push_back({PendantNews::Kind::unplugged});
      news_.push_back({PendantNews::Kind::plugged});
    }
    news_.push_back(std::move(news));
    came_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<PendantNews> news_;
};

}  // namespace servogate::drivers
