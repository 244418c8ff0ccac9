// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::gsusb {

/// A USB-CAN adapter of the gs_usb class as its firmware sees the wire: vendor requests, bulk pipes and a CAN
/// controller on a bus. Written from the protocol, without a line of drivers/gsusb, and checked by the
/// kernel's own driver in the laboratory. Not thread-safe.
class SimulatedAdapter {
 public:
  using Bytes = std::vector<std::uint8_t>;

  struct Config {
    std::uint32_t clock_hz = 48'000'000;
    bool timestamps = true;
    bool tells_state = true;
    std::uint8_t channels = 1;
    /// What the others on the bus speak; 0: whatever the computer sets. Another rate destroys every frame.
    std::uint32_t bus_rate = 0;
    std::size_t frames_to_host = 64;  ///< more are lost, and the next frame says so
  };

  SimulatedAdapter(image::CanBus& bus, Config config) : bus_(bus), config_(config) {}

  /// A vendor request with data from the computer. False: the adapter stalls it.
  bool take_request(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data);
  /// A vendor request for data; nullopt: the adapter stalls it. `now_us` is its clock.
  std::optional<Bytes> answer_request(std::uint8_t request, std::uint16_t value, std::uint32_t now_us);
  /// A transfer of the out pipe.
  void take_bulk(std::span<const std::uint8_t> bytes);
  /// Moves frames from and to the bus.
  void step(std::uint32_t now_us);
  /// The next transfer for the in pipe; nullopt: none.
  std::optional<Bytes> give_bulk();

  void go_bus_off(std::uint32_t now_us);
  bool started() const { return started_; }
  /// Frames of the computer that are not on the bus yet.
  std::size_t waiting() const { return from_host_.size(); }
  bool listens_only() const { return (flags_ & 1u) != 0; }
  /// bit/s that the computer has set.
  double bit_rate() const;
  double sample_point() const;

 private:
  enum class State : std::uint32_t { active = 0, warning, passive, bus_off, stopped };

  bool wrong_rate() const;
  void count(std::uint32_t& errors, std::uint32_t by, std::uint32_t now_us);
  void error_frame(std::uint32_t now_us);
  void queue(std::uint32_t echo, std::uint32_t id, std::uint8_t length, const std::uint8_t* data,
             std::uint32_t now_us);

  image::CanBus& bus_;
  Config config_;
  bool started_ = false, lost_ = false;
  std::uint32_t flags_ = 0;
  std::uint32_t timing_[5] = {1, 1, 1, 1, 1};
  State state_ = State::stopped;
  std::uint32_t transmit_errors_ = 0, receive_errors_ = 0;
  std::deque<Bytes> from_host_, to_host_;
};

}  // namespace servogate::gsusb
