// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/slcan/pseudo_terminal.hpp"

namespace servogate::slcan {

/// How an adapter behaves.
struct Mood {
  bool answers = true;       ///< to anything at all
  bool acknowledges = true;  ///< what it takes for sending
  bool has_flags = true;
  char refuses = 0;            ///< a command that it refuses
  int frames_until_full = -1;  ///< it takes so many frames and refuses the rest
};

/// An adapter at the far end of a pseudo-terminal.
class SimulatedAdapter {
 public:
  explicit SimulatedAdapter(Mood mood = {}) : mood_(mood) {
    thread_ = std::thread([this] { work(); });
  }
  ~SimulatedAdapter() { unplug(); }

  const std::string& path() const { return line_.path(); }
  void unplug() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    line_.close();
  }
  /// Something comes from the bus.
  void say(const std::string& text) {
    for (std::string_view rest = text; !rest.empty();) {
      const ssize_t n = ::write(line_.far(), rest.data(), rest.size());
      if (n > 0) rest.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  void set_flags(const std::string& digits) {
    const std::scoped_lock lock(mutex_);
    flags_ = digits;
  }
  /// It answers to nothing any more until it is let go.
  void hold(bool held) { held_ = held; }
  /// The commands it has got, in their order, but those that ask for flags.
  std::vector<std::string> commands() const {
    const std::scoped_lock lock(mutex_);
    return commands_;
  }
  std::vector<std::string> frames() const { return frames_from(0); }
  /// The frames behind the first `n`; cheap, for whoever asks often.
  std::vector<std::string> frames_from(std::size_t n) const {
    const std::scoped_lock lock(mutex_);
    return {frames_.begin() + static_cast<std::ptrdiff_t>(std::min(n, frames_.size())), frames_.end()};
  }

 private:
  void work() {
    std::string line;
    while (!ending_) {
      pollfd ready{line_.far(), POLLIN, 0};
      if (::poll(&ready, 1, 2) <= 0 || held_) {
        if (held_) std::this_thread::yield();
        continue;
      }
      char c = 0;
      if (::read(line_.far(), &c, 1) != 1) continue;
      if (c != '\r') {
        line += c;
        continue;
      }
      obey(std::exchange(line, {}));
    }
  }
  void obey(const std::string& command) {
    std::string flags;
    {
      const std::scoped_lock lock(mutex_);
      if (command != "F") commands_.push_back(command);
      if (!command.empty() && std::string_view("tTrR").find(command.front()) != std::string_view::npos)
        frames_.push_back(command);
      flags = flags_;
    }
    if (!mood_.answers) return;
    const char first = command.empty() ? '\r' : command.front();
    if (first == mood_.refuses) return say("\a");
    switch (first) {
      case 't':
      case 'T':
      case 'r':
      case 'R':
        if (mood_.frames_until_full == 0) return say("\a");
        if (mood_.frames_until_full > 0) --mood_.frames_until_full;
        if (mood_.acknowledges) say(first == 't' || first == 'r' ? "z\r" : "Z\r");
        return;
      case 'V':
        return say("V1013\r");
      case 'F':
        return say(mood_.has_flags ? "F" + flags + "\r" : "\a");
      default:
        return say("\r");
    }
  }

  Mood mood_;
  PseudoTerminal line_;
  std::atomic<bool> ending_{false}, held_{false};
  mutable std::mutex mutex_;
  std::vector<std::string> commands_, frames_;
  std::string flags_ = "00";
  std::thread thread_;
};

}  // namespace servogate::slcan
