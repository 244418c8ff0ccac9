// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace spdlog {
class logger;
namespace details {
class thread_pool;
}
}  // namespace spdlog

namespace servogate::gateway::history {

/// One thing that happened to a control, as it is kept: for people years later, in both languages.
struct Event {
  std::string time;        ///< UTC, "2026-11-23T20:15:07.250Z"; note() sets it where it is empty
  double machine_s = 0.0;  ///< time of the machine since its control came up
  std::string kind;  ///< "up", "down", "request", "refused", "alarm", "cleared", "program", "drives", "axis"
  std::string id;    ///< of its sentence: "history.drives-on", "axis.following_error"
  int number = 0;    ///< of an alarm; 0: none
  std::string who;   ///< who asked, in English; empty: nobody
  std::string english, russian;

  const std::string& text(text::Language language) const noexcept {
    return language == text::Language::russian ? russian : english;
  }
};

/// An event of this sentence.
Event event(std::string kind, const text::Entry& entry, const std::vector<std::string>& arguments,
            double machine_s);

/// The history of one machine: `events.jsonl` in its state directory, one JSON object a line, three
/// generations of 2 MB (events.1.jsonl is the one before); and one line an event on standard error, which the
/// journal of the system keeps. Any thread but the cycle's; note() never waits for a disk: where one is so
/// slow that 8192 events wait, the oldest of these are lost.
class EventLog {
 public:
  /// Where the events go besides the memory.
  struct Places {
    std::string folder;   ///< state directory; empty: no file
    bool console = true;  ///< lines on standard error
  };
  static constexpr std::size_t kRemembered = 1000;

  /// Reads what earlier controls have left in the folder.
  explicit EventLog(const Places& places);
  ~EventLog();
  EventLog(const EventLog&) = delete;

  void note(Event event);
  /// The last `count` events, oldest first; at most kRemembered.
  std::vector<Event> last(std::size_t count) const;
  /// Why the file is not written any more; empty: it is.
  std::string problem() const;

 private:
  void remember(Event event);
  void read_generation(const std::string& path);

  mutable std::mutex mutex_;
  std::deque<Event> events_;
  std::string problem_;
  std::shared_ptr<spdlog::details::thread_pool> pool_;
  std::shared_ptr<spdlog::logger> file_, console_;
};

}  // namespace servogate::gateway::history
