// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/slcan/simulated_adapter.hpp"

namespace servogate::slcan {

/// A second program with slcan on the same wire: what it sends as a frame comes from the bus for the one
/// behind the adapter, and the other way round. It opens path(), which is no adapter: its commands are
/// answered by nobody.
class Relay {
 public:
  explicit Relay(SimulatedAdapter& adapter) : adapter_(adapter) {
    thread_ = std::thread([this] { work(); });
  }
  ~Relay() {
    ending_ = true;
    thread_.join();
  }
  const std::string& path() const { return line_.path(); }

 private:
  void work() {
    std::string line;
    std::size_t passed = 0;
    while (!ending_) {
      const std::vector<std::string> frames = adapter_.frames_from(passed);
      passed += frames.size();
      for (const std::string& frame : frames) {
        const std::string text = frame + "\r";
        if (::write(line_.far(), text.data(), text.size()) < 0) return;
      }
      pollfd ready{line_.far(), POLLIN, 0};
      if (::poll(&ready, 1, 1) <= 0) continue;
      char bytes[256];
      const ssize_t n = ::read(line_.far(), bytes, sizeof bytes);
      for (ssize_t i = 0; i < n; ++i) {
        if (bytes[i] != '\r') {
          line += bytes[i];
        } else if (const std::string whole = std::exchange(line, {});
                   !whole.empty() && std::string_view("tTrR").find(whole.front()) != std::string_view::npos) {
          adapter_.say(whole + "\r");
        }
      }
    }
  }

  SimulatedAdapter& adapter_;
  PseudoTerminal line_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace servogate::slcan
