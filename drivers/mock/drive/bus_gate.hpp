// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "drivers/mock/drive/drive_fault.hpp"
#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::mock {

/// Stands between a simulated drive and its bus and spoils what it sends, after the faults in force.
/// real-time safe.
class BusGate final : public image::CanBus {
 public:
  /// Settings of the faults of transmission; everything off passes frames through.
  struct Spoil {
    bool silent = false, heartbeat_lost = false, sdo_silent = false, pdo_repeated = false;
    std::uint32_t pdo_dropped_every = 0;  ///< 0: none
    image::Nanoseconds pdo_delay_ns = 0, sdo_delay_ns = 0;
    std::uint64_t pdo_flip = 0;
    /// The TPDO (1-4 by its predefined identifier) that each of these means; 0: any.
    std::uint32_t dropped_number = 0, late_number = 0, flipped_number = 0, repeated_number = 0;
  };

  void set_node(canopen::NodeId node) noexcept { node_ = node; }
  void connect(image::CanBus& bus, canopen::NodeId node) noexcept {
    bus_ = &bus;
    node_ = node;
  }
  Spoil& spoil() noexcept { return spoil_; }
  /// Sends what was kept back until now.
  void advance_to(image::Nanoseconds now) noexcept;

  bool send(const image::CanFrame& frame) noexcept override;
  bool receive(image::CanFrame&) noexcept override { return false; }
  image::CanState state() const noexcept override { return bus_ ? bus_->state() : image::CanState::down; }
  std::uint32_t bit_rate() const noexcept override { return bus_ ? bus_->bit_rate() : 0; }

 private:
  static constexpr std::size_t kLate = 32;
  struct Late {
    image::CanFrame frame;
    image::Nanoseconds at = 0;
  };
  bool send_pdo(image::CanFrame frame) noexcept;
  bool send_later(const image::CanFrame& frame, image::Nanoseconds delay) noexcept;

  image::CanBus* bus_ = nullptr;
  canopen::NodeId node_ = 1;
  Spoil spoil_;
  image::Nanoseconds now_ = 0;
  std::uint32_t pdos_ = 0;
  std::array<image::CanFrame, 4> last_{};  ///< of up to four TPDO identifiers
  std::array<Late, kLate> late_{};
  std::size_t late_count_ = 0;
};

}  // namespace servogate::mock
