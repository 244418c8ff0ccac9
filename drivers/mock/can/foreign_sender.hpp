// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"

namespace servogate::mock {

/// A device that does not belong to the machine: a second master, a tool, or one that floods the wire. It
/// sends the frames of fault::Kind::foreign, hears nothing, and acknowledges frames while a fault is on.
class ForeignSender final : public CanNode {
 public:
  static constexpr std::size_t kMost = 16;

  ForeignSender() { streams_.reserve(kMost); }
  /// From `now` on. False: kMost are on already. real-time safe.
  bool begin(const fault::Fault& fault, Nanoseconds now) noexcept;
  /// Ends the oldest one that is equal to this. real-time safe.
  void end(const fault::Fault& fault) noexcept;
  void end_all() noexcept { streams_.clear(); }

  void connect(image::CanBus& bus, Nanoseconds now) override;
  const CanFilter* filter() const noexcept override;
  void on_frame(const CanFrame&) noexcept override {}
  void advance_to(Nanoseconds t) noexcept override;
  Nanoseconds next_action_ns() const noexcept override;
  bool alive() const noexcept override { return !streams_.empty(); }

 private:
  struct Stream {
    fault::Fault fault;
    CanFrame frame;
    Nanoseconds period = 0, next = 0;
    std::uint32_t sent = 0;
    bool ended() const noexcept { return fault.count != 0 && sent >= fault.count; }
  };

  image::CanBus* bus_ = nullptr;
  std::vector<Stream> streams_;
};

}  // namespace servogate::mock
