// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/mock/drive/bus_gate.hpp"
#include "drivers/mock/drive/device_objects.hpp"
#include "drivers/mock/drive/drive_rest.hpp"
#include "drivers/mock/drive/servo_loops.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/device/drive/servo_profile.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"

namespace servogate::mock {

inline constexpr Nanoseconds kCommunicationPeriod = image::kMillisecond;

/// The parts of a simulated drive and how time and faults pass through them.
struct SimulatedDrive::Inside {
  struct Lasting {
    fault::Fault fault;
    Nanoseconds until = 0;  ///< 0: until cleared
    bool active = false;
  };

  explicit Inside(const SimulatedDriveConfig& c);

  void power_on(Nanoseconds t) noexcept;
  void start_again() noexcept;
  void show_product(std::int64_t code) noexcept;
  void advance_to(Nanoseconds t) noexcept;
  /// advance_to() has something to do.
  bool due(Nanoseconds t) const noexcept {
    return next_servo <= t || next_communication <= t || late_count > 0;
  }
  void servo_tick() noexcept;
  void moving_tick() noexcept;
  void calm_tick() noexcept;
  /// Instead of a tick.
  void time_at_rest() noexcept {
    if (window_runs) profile.count_window();
  }
  /// Of all objects from 6000h on.
  std::span<const std::int64_t> drive_values();
  /// Something may have come from outside.
  void doubt() noexcept {
    rest.doubt();
    tuned_known = false;
  }
  const canopen::ServoCommand& by_own_gains(const canopen::ServoCommand& asked) noexcept;
  void watch_heat() noexcept;
  void read_inputs(std::int64_t before) noexcept;
  bool inside(const DriveSwitch& s) const noexcept {
    return plant.counts() >= s.from && plant.counts() <= s.to;
  }
  bool answer_with_abort(const CanFrame& frame) noexcept;
  bool spoil_rpdo(CanFrame& frame) noexcept;
  void hear_late(Nanoseconds t) noexcept;

  void inject(const fault::Fault& fault) noexcept;
  void happen(const fault::Fault& fault) noexcept;
  void clear(fault::Kind kind) noexcept;
  void begin(const fault::Fault& fault) noexcept;
  void end(Lasting& lasting_fault) noexcept;
  void set_supply(fault::Kind kind, bool present) noexcept;
  void expire(Nanoseconds t) noexcept;
  void apply_to_gate() noexcept;
  bool spoiled(fault::Kind kind) const noexcept { return lasting[static_cast<std::size_t>(kind)].active; }
  const fault::Fault& fault(fault::Kind kind) const noexcept {
    return lasting[static_cast<std::size_t>(kind)].fault;
  }

  SimulatedDriveConfig config;
  DeviceObjects objects;
  canopen::ObjectDictionary dictionary;
  canopen::ServoProfile profile;
  canopen::Slave slave;
  std::optional<canopen::ProgramStore> programs;
  Plant plant;
  BusGate gate{slave};
  canopen::ServoCommand command;
  /// The loops as a master has tuned them; as they came they are the plant's. A drive from a data sheet has
  /// no such objects: what 60F9h and 60FBh mean there is its maker's.
  struct Tuning {
    Tuning(const canopen::ObjectDictionary& dictionary, bool from_sheet);
    /// Velocity gain and integral, position gain, notch and what it leaves.
    static constexpr std::size_t kObjects = 5;
    using Values = std::array<std::int64_t, kObjects>;
    Values values(const canopen::ObjectDictionary& dictionary) const noexcept;
    std::array<canopen::ObjectDictionary::Slot, kObjects> slots;
    bool there = false;
    Values own{};  ///< as they came
    double integral = 0.0;
    NotchFilter notch;
    canopen::ServoCommand command;  ///< of the tuned loops
  };
  Tuning tuning{dictionary, config.data_sheet != nullptr};
  bool tuned = false, tuned_known = false;  ///< a master has tuned them; looked at since he could have
  canopen::DriveInputs inputs;
  std::array<bool, canopen::kDriveInputs> outside_level{};
  std::int64_t lost_encoder_position = 0;
  std::int64_t own_product = 0;  ///< 1018h:02 of the device itself
  std::array<Lasting, fault::kKinds> lasting{};
  bool any_lasting = false;
  std::uint32_t rpdos_dropped_of = 0;  ///< RPDOs since the fault began
  std::array<CanFrame, 32> late{};     ///< RPDOs on their way, with the time at which they arrive
  std::size_t late_count = 0;
  /// Of all that servo_tick() goes by and changes while no fault lasts.
  DriveRest rest{{DriveRest::part(plant), profile.inner_state(), DriveRest::part(command),
                  DriveRest::part(inputs), DriveRest::part(outside_level), DriveRest::part(tuning),
                  std::as_bytes(drive_values())}};
  bool calm = false;         ///< the last tick left position and torque as they were
  bool window_runs = false;  ///< the one thing that goes on at rest: ServoProfile::count_window()
  bool hot = false;          ///< I2t: too hot, until it has cooled down
  Nanoseconds now = 0;
  Nanoseconds next_servo = 0;
  Nanoseconds next_communication = 0;
};

}  // namespace servogate::mock
