// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstdio>
#include <deque>
#include <initializer_list>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::canopen::testing {

inline image::CanFrame frame(std::uint32_t id, std::initializer_list<int> bytes) {
  image::CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(bytes.size());
  std::size_t i = 0;
  for (const int byte : bytes) f.data[i++] = static_cast<std::uint8_t>(byte);
  return f;
}

/// "601 40 18 10 01 00 00 00 00": identifier and data, as a record of a bus shows them.
inline std::string show(const image::CanFrame& f) {
  char text[8];
  std::snprintf(text, sizeof text, "%03X", f.id);
  std::string out = text;
  for (std::size_t i = 0; i < f.length; ++i) {
    std::snprintf(text, sizeof text, " %02X", f.data[i]);
    out += text;
  }
  return out;
}

/// A bus whose far end is the test itself: what the master sends is kept, what it receives is queued by hand.
class ScriptedBus final : public image::CanBus {
 public:
  bool send(const image::CanFrame& f) noexcept override {
    if (refuse_sending) return false;
    sent.push_back(f);
    return true;
  }
  bool receive(image::CanFrame& f) noexcept override {
    if (waiting.empty()) return false;
    f = waiting.front();
    waiting.pop_front();
    return true;
  }
  image::CanState state() const noexcept override { return bus_state; }
  std::uint32_t bit_rate() const noexcept override { return 1'000'000; }

  /// Everything sent since the last call, one string a frame.
  std::vector<std::string> take_sent() {
    std::vector<std::string> out;
    for (const auto& f : sent) out.push_back(show(f));
    sent.clear();
    return out;
  }

  bool refuse_sending = false;
  image::CanState bus_state = image::CanState::error_active;
  std::vector<image::CanFrame> sent;
  std::deque<image::CanFrame> waiting;
};

}  // namespace servogate::canopen::testing
