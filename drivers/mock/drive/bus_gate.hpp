// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/device/node/slave.hpp"
#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::mock {

/// Stands between a simulated drive and its bus and spoils what it sends, after the faults in force. What a
/// frame is, it knows from the device's own objects: a TPDO is one under whatever COB-ID its master gave it.
/// real-time safe.
class BusGate final : public image::CanBus {
 public:
  explicit BusGate(const canopen::Slave& device) noexcept : device_(device) {}

  /// Settings of the faults of transmission; everything off passes frames through.
  struct Spoil {
    bool silent = false, heartbeat_lost = false, sdo_silent = false, pdo_repeated = false;
    std::uint32_t pdo_dropped_every = 0;  ///< 0: none
    image::Nanoseconds pdo_delay_ns = 0, sdo_delay_ns = 0;
    std::uint64_t pdo_flip = 0;
    /// The TPDO (1-4, 1800h-1803h) that each of these means; 0: any.
    std::uint32_t dropped_number = 0, late_number = 0, flipped_number = 0, repeated_number = 0;
  };

  void connect(image::CanBus& bus) noexcept { bus_ = &bus; }
  Spoil& spoil() noexcept { return spoil_; }
  /// Every n-th TPDO is counted from the next one on.
  void count_pdos_anew() noexcept { pdos_ = 0; }
  /// What was kept back is not sent any more.
  void forget_late() noexcept { late_count_ = 0; }
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
  bool send_pdo(image::CanFrame frame, std::uint32_t number) noexcept;
  bool send_later(const image::CanFrame& frame, image::Nanoseconds delay) noexcept;

  const canopen::Slave& device_;
  image::CanBus* bus_ = nullptr;
  Spoil spoil_;
  image::Nanoseconds now_ = 0;
  std::uint32_t pdos_ = 0;
  std::array<image::CanFrame, canopen::kPdos> last_{};  ///< of each TPDO; length 0: none yet
  std::array<Late, kLate> late_{};
  std::size_t late_count_ = 0;
};

}  // namespace servogate::mock
