// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/usercan/server/participant.hpp"

namespace servogate::usercan {

/// One bus of a server: a simulated wire with exact frame timing, a place on it for every participant, and a
/// listener that acknowledges, so that a lone participant can send. Part of BusServer.
class Bus final : private mock::CanMonitor {
 public:
  static constexpr std::size_t kPlaces = 63;  ///< participants at a time

  Bus(std::string name, std::uint32_t bit_rate);
  ~Bus() override;

  const std::string& name() const noexcept { return name_; }
  mock::CanSegment& segment() noexcept { return segment_; }
  /// Somebody who sees the wire besides; nullptr: nobody.
  void set_monitor(mock::CanMonitor* monitor) noexcept { outside_ = monitor; }

  /// Gives the participant a place. False: all are taken.
  bool join(Participant& who);
  void leave(Participant& who);
  /// Puts a frame into a mailbox of its sender. False: not now, there is no room, or somebody else's frame of
  /// the same identifier is waiting, which would collide with it.
  bool offer(Participant& who, const image::CanFrame& frame);

 private:
  class Place final : public mock::CanNode {
   public:
    void connect(image::CanBus& bus, Nanoseconds) override { bus_ = &bus; }
    void on_frame(const image::CanFrame& frame) noexcept override {
      if (who != nullptr) who->hear(frame);
    }
    void advance_to(Nanoseconds) noexcept override {}
    Nanoseconds next_action_ns() const noexcept override;
    image::CanBus& bus() noexcept { return *bus_; }

    Participant* who = nullptr;
    int endpoint = -1;

   private:
    image::CanBus* bus_ = nullptr;
  };

  void on_wire(const image::CanFrame& frame, int sender, Nanoseconds start, Nanoseconds end,
               Outcome outcome) noexcept override;

  std::string name_;
  mock::CanSegment segment_;
  Place listener_;
  std::vector<std::unique_ptr<Place>> places_;
  mock::CanMonitor* outside_ = nullptr;
};

}  // namespace servogate::usercan
