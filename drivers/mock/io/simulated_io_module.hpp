// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/device/io/io_objects.hpp"

namespace servogate::mock {

/// What stands on the module's name plate.
struct SimulatedIoConfig {
  canopen::NodeId node_id = 1;
  canopen::IoTerminals terminals;
  std::string name = "Servogate simulated I/O module";  ///< 1008h, at most 64 characters
  std::uint32_t vendor_id = 0;                          ///< 1018h:01
  std::uint32_t product_code = 0x0001'0191;
  std::uint32_t revision = 0x0001'0000;
  std::uint32_t serial_number = 1;
  double boot_time_s = 0.01;  ///< from power-on to the boot-up message
  double filter_s = 0.005;    ///< of an input whose filter 6003h switches on
  /// Has 6206h, 6207h, 6443h and 6444h; false: it takes its outputs to 0, and nobody can change that.
  bool error_states = true;
};

/// A complete CiA 301/401 I/O module in simulated time: digital and analogue terminals, change of state,
/// filter, polarity, error values. Attach it to a CanSegment, or poll it on any image::CanBus.
///
/// Everything but construction and connect() is real-time safe. Not thread-safe.
class SimulatedIoModule final : public CanNode {
 public:
  explicit SimulatedIoModule(const SimulatedIoConfig& config);
  ~SimulatedIoModule() override;
  SimulatedIoModule(const SimulatedIoModule&) = delete;
  SimulatedIoModule& operator=(const SimulatedIoModule&) = delete;

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
  canopen::NmtState nmt_state() const noexcept;
  /// Levels from the world; lines and channels count from 0.
  void set_digital(std::uint8_t line, bool level) noexcept;
  void set_analogue(std::uint8_t channel, std::int16_t value) noexcept;
  /// Levels on the output terminals.
  bool digital(std::uint8_t line) const noexcept;
  std::int16_t analogue(std::uint8_t channel) const noexcept;
  /// A value of the object dictionary, 0 when there is none.
  std::int64_t object(std::uint16_t index, std::uint8_t subindex = 0) const noexcept;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace servogate::mock
