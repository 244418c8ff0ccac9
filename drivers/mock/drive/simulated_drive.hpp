// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/plant.hpp"
#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/device/drive/drive_objects.hpp"
#include "firmware_if/canopen/device/node/pdo_channel.hpp"
#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/simulated.hpp"

namespace servogate::mock {

/// A switch on the drive's own inputs that follows the shaft: active at positions from `from` to `to`
/// inclusive, true counts from the world's zero.
struct DriveSwitch {
  enum class Input : std::uint8_t {
    negative_limit,
    positive_limit,
    home,
    probe_1,
    probe_2
  } input = Input::home;
  std::int64_t from = std::numeric_limits<std::int64_t>::min();
  std::int64_t to = std::numeric_limits<std::int64_t>::max();
};

/// An object, by index and sub-index.
struct ObjectPlace {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  bool operator==(const ObjectPlace&) const = default;
};

/// What stands on the drive's name plate and how it is mounted.
struct SimulatedDriveConfig {
  canopen::NodeId node_id = 1;  ///< canopen::kUnconfiguredNode: to be given by layer setting services
  std::uint32_t device_type = 0x0002'0192;         ///< 1000h; CiA 402-1: a servo drive
  std::uint32_t modes = 0;                         ///< 6502h; 0: all that the simulation has
  std::string name = "Servogate simulated drive";  ///< 1008h, at most 64 characters
  std::uint32_t vendor_id = 0;                     ///< 1018h:01
  std::uint32_t product_code = 0x0001'0192;
  std::uint32_t revision = 0x0001'0000;
  std::uint32_t serial_number = 1;
  PlantConfig plant;
  bool absolute_encoder = false;                 ///< false: 6064h is 0 at power-on wherever the shaft stands
  bool main_voltage = true;                      ///< the DC link is charged
  double boot_time_s = 0.01;                     ///< from power-on to the boot-up message
  image::Nanoseconds servo_period_ns = 250'000;  ///< of loops and plant
  std::vector<DriveSwitch> switches;
  std::size_t program_memory = 0;  ///< bytes for a program download (1F50h); 0: the device has none
  std::uint32_t program_identification = 0x0001'0000;  ///< 1F56h of the program that it comes with
  canopen::DriveQuirks quirks = {};
  /// What a master may change of the PDO maps. Maps that it may not change are `maps` where there are any,
  /// else those of the data sheet, else those of CiA 402-3.
  canopen::MapAccess map_access = canopen::MapAccess::variable;
  struct PdoMap {
    bool transmit = false;  ///< 1A00h, else 1600h
    int number = 1;         ///< 1-4
    canopen::PdoMapping mapping;
  };
  std::vector<PdoMap> maps;  ///< of the others nothing is mapped
  /// EDS or DCF: the device has the objects of this sheet with their values, and shows no others. What the
  /// sheet says no value of keeps the simulation's. nullptr: it has all objects of the simulation.
  std::shared_ptr<const canopen::Eds> data_sheet;
};

/// A complete CiA 301/402 servo drive with its motor, load and encoder, in simulated time. Attach it to a
/// CanSegment, or to any image::CanBus with PolledDrive.
///
/// Everything but construction and connect() is real-time safe. Not thread-safe: it belongs to the thread
/// that advances its bus.
class SimulatedDrive final : public CanNode {
 public:
  explicit SimulatedDrive(const SimulatedDriveConfig& config);
  ~SimulatedDrive() override;
  SimulatedDrive(const SimulatedDrive&) = delete;
  SimulatedDrive& operator=(const SimulatedDrive&) = delete;

  /// Switches the device on; its boot-up message comes boot_time_s later.
  void connect(image::CanBus& bus, Nanoseconds now) override;
  const CanFilter* filter() const noexcept override;
  void on_frame(const CanFrame& frame) noexcept override;
  void advance_to(Nanoseconds t) noexcept override;
  Nanoseconds next_action_ns() const noexcept override;
  bool alive() const noexcept override;

  /// As it is now; layer setting services can change it.
  canopen::NodeId node_id() const noexcept;
  image::DriveState state() const noexcept;
  canopen::NmtState nmt_state() const noexcept;
  std::uint16_t statusword() const noexcept;
  /// 603Fh.
  std::uint16_t error_code() const noexcept;
  bool brake_released() const noexcept;

  /// Where the shaft really is, from the world's zero: what switches and gauges see.
  double revolutions() const noexcept;
  std::int64_t position_counts() const noexcept;
  double velocity_counts_s() const noexcept;
  double torque_permille() const noexcept;
  /// Heat of the motor, 1: what its rated torque leads to in the end. Above it the drive faults with 2350h.
  double thermal() const noexcept;
  /// Position as the drive reports it in 6064h, without the wrap to 32 bits.
  std::int64_t reported_position() const noexcept;

  /// Objects of the data sheet that the simulation cannot have: PDOs beyond the fourth, types that it does
  /// not know.
  const std::vector<ObjectPlace>& left_out() const noexcept;

  /// Levels of the drive's inputs from the world. A switch of the configuration is OR-ed with it.
  void set_input(DriveSwitch::Input input, bool active) noexcept;
  /// Bit 3 of 60FDh.
  void set_interlock(bool active) noexcept;
  /// General purpose inputs, bits 16-31 of 60FDh.
  void set_general_inputs(std::uint16_t bits) noexcept;
  /// 60FEh:01 masked by 60FEh:02.
  std::uint32_t digital_outputs() const noexcept;
  void set_load_torque(double nm) noexcept;
  void set_main_voltage(bool present) noexcept;
  /// Safe torque off: true lets the drive have torque, false takes it at once.
  void set_safe_torque_off(bool torque_allowed) noexcept;

  /// Faults on command. inject() replaces a lasting fault of the same kind.
  void inject(const fault::Fault& fault) noexcept;
  void clear(fault::Kind kind) noexcept;
  void clear_faults() noexcept;
  /// The next program that is written ends with this error of 1F57h. Nothing without program memory.
  void spoil_next_program(std::uint8_t flash_error) noexcept;
  bool faulted_with(fault::Kind kind) const noexcept;

  /// A value of the object dictionary, 0 when there is none; for tests and displays.
  std::int64_t object(std::uint16_t index, std::uint8_t subindex = 0) noexcept;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

/// Lets a drive live on any bus that is polled (SocketCAN, a polled mock endpoint): call poll() often with a
/// rising time, once a servo period at best.
class PolledDrive final : public image::Simulated {
 public:
  PolledDrive(SimulatedDrive& drive, image::CanBus& bus, Nanoseconds now) : drive_(drive), bus_(bus) {
    drive.connect(bus, now);
  }
  /// Takes in what has come and brings the drive to time t.
  void advance_to(Nanoseconds t) override;

 private:
  SimulatedDrive& drive_;
  image::CanBus& bus_;
};

}  // namespace servogate::mock
