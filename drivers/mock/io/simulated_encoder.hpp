// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/canopen/device/encoder/encoder_profile.hpp"

namespace servogate::mock {

/// What stands on the encoder's name plate.
struct SimulatedEncoderConfig {
  canopen::NodeId node_id = 1;
  canopen::EncoderResolution resolution;
  std::string name = "Servogate simulated encoder";  ///< 1008h, at most 64 characters
  std::uint32_t vendor_id = 0;                       ///< 1018h:01
  std::uint32_t product_code = 0x0001'0196;
  std::uint32_t revision = 0x0001'0000;
  std::uint32_t serial_number = 1;
  double boot_time_s = 0.01;  ///< from power-on to the boot-up message
};

/// A complete CiA 301/406 absolute encoder in simulated time. Attach it to a CanSegment, or poll it on any
/// image::CanBus.
///
/// Everything but construction and connect() is real-time safe. Not thread-safe.
class SimulatedEncoder final : public CanNode {
 public:
  explicit SimulatedEncoder(const SimulatedEncoderConfig& config);
  ~SimulatedEncoder() override;
  SimulatedEncoder(const SimulatedEncoder&) = delete;
  SimulatedEncoder& operator=(const SimulatedEncoder&) = delete;

  void connect(image::CanBus& bus, Nanoseconds now) override;
  const CanFilter* filter() const noexcept override;
  void on_frame(const CanFrame& frame) noexcept override;
  void advance_to(Nanoseconds t) noexcept override;
  Nanoseconds next_action_ns() const noexcept override;
  bool alive() const noexcept override;

  /// Takes its supply away (false), or gives it back: it starts as after power-on.
  void supply(bool present) noexcept;
  /// Another device takes its place, with this product code (1018h:02; 0: the next one); nullopt: the device
  /// itself is back.
  void swap(std::optional<std::uint32_t> product) noexcept;
  /// Where the shaft stands, counts of the disc from its zero over any number of turns.
  void set_position(std::int64_t counts) noexcept;
  std::int64_t position() const noexcept;
  /// The disc cannot be read: alarm "position error", the value stands still.
  void set_unreadable(bool unreadable) noexcept;
  /// A value of the object dictionary, 0 when there is none.
  std::int64_t object(std::uint16_t index, std::uint8_t subindex = 0) const noexcept;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace servogate::mock
