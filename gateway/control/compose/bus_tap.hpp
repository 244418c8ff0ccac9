// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::gateway {

/// Sees what a master sends and receives. Called in the cycle: real-time safe.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  virtual void passed(int bus, const image::CanFrame& frame, bool sent) noexcept = 0;
};

/// A bus with observers between it and its master; without any it costs a call a frame.
class BusTap final : public image::CanBus {
 public:
  static constexpr std::size_t kMostObservers = 2;

  /// `bus` outlives it; `number` is what observers are told.
  BusTap(image::CanBus& bus, int number) : bus_(bus), number_(number) {}

  /// Before the first cycle, or behind the last. False: there are as many as there can be.
  bool attach(FrameObserver& observer) noexcept {
    for (FrameObserver*& place : observers_)
      if (place == nullptr) {
        place = &observer;
        return true;
      }
    return false;
  }
  void detach(const FrameObserver& observer) noexcept {
    for (FrameObserver*& place : observers_)
      if (place == &observer) place = nullptr;
  }

  bool send(const image::CanFrame& frame) noexcept override {
    const bool sent = bus_.send(frame);
    if (sent) tell(frame, true);
    return sent;
  }
  bool receive(image::CanFrame& frame) noexcept override {
    const bool any = bus_.receive(frame);
    if (any) tell(frame, false);
    return any;
  }
  image::CanState state() const noexcept override { return bus_.state(); }
  std::uint32_t bit_rate() const noexcept override { return bus_.bit_rate(); }
  std::uint64_t lost() const noexcept override { return bus_.lost(); }
  bool carries_fd() const noexcept override { return bus_.carries_fd(); }

 private:
  void tell(const image::CanFrame& frame, bool sent) noexcept {
    for (FrameObserver* observer : observers_)
      if (observer != nullptr) observer->passed(number_, frame, sent);
  }

  image::CanBus& bus_;
  int number_;
  std::array<FrameObserver*, kMostObservers> observers_{};
};

}  // namespace servogate::gateway
