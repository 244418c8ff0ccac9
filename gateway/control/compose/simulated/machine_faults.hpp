// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/mock/world/world.hpp"
#include "firmware_if/fault/fault.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// Faults on what a machine simulates, by the names of its machine file: a node ("can.x"), a bus ("can"), a
/// station, a digital input, or the control itself. Where a fault goes is decided here; what it does, in the
/// device.
class MachineFaults {
 public:
  /// Name of what controls the machine, where nothing of the machine file is called so.
  static constexpr std::string_view kControl = "control";

  /// Both outlive it. `controlled`: a cycle of this process drives the machine, and can be late.
  MachineFaults(const machine::MachineConfig& machine, mock::World& world, bool controlled);

  /// From any thread; it happens with the next advance_to(). A lasting fault replaces the same kind on the
  /// same device; of a bus several stay side by side. False: `why` says why it cannot, in both languages.
  bool inject(std::string_view device, const fault::Fault& fault, std::string& why);
  /// The same without doing it; `fault` nullptr: an end. False as above.
  bool possible(std::string_view device, const fault::Fault* fault, std::string& why) const;
  /// Ends a lasting fault, nullopt: all of the device, in the same way.
  bool clear(std::string_view device, std::optional<fault::Kind> kind, std::string& why);
  /// What is wished and what is over, at time t; before the world goes on to it.
  void advance_to(image::Nanoseconds t);
  /// How late the cycle at hand comes, told once; 0: on time.
  image::Nanoseconds take_lateness() noexcept { return std::exchange(lateness_ns_, 0); }

 private:
  /// What a name means; pointers to what it is not are nullptr.
  struct Target {
    std::string name;
    unsigned devices = 0;  ///< bits of fault::Device
    mock::CanSegment* wire = nullptr;
    int endpoint = -1;
    mock::SimulatedDrive* drive = nullptr;
    mock::SimulatedEncoder* encoder = nullptr;
    mock::SimulatedIoModule* module = nullptr;
    mock::ModbusStation* station = nullptr;
    mock::MockGpio* chip = nullptr;
    mock::SimulatedBoard* board = nullptr;
    mock::MockPendant* pendant = nullptr;
    std::string button = {};  ///< of that pendant
    mock::World::Contact contact = {};
  };
  struct Wish {
    Target target;
    std::optional<fault::Fault> fault;  ///< nullopt: an end
    std::optional<fault::Kind> ends;    ///< nullopt: of all
  };
  struct Active {
    Target target;
    fault::Fault fault;
    image::Nanoseconds until = 0;  ///< 0: until cleared
  };
  std::optional<Wish> meant(std::string_view device, const fault::Fault& fault, std::string& why) const;
  std::optional<Target> find(std::string_view device) const;
  std::optional<Target> find_on_bus(std::string_view device) const;
  std::optional<Target> find_pendant(std::string_view device) const;
  std::string names() const;
  bool has_control(std::string_view name) const { return controlled_ && name == kControl; }
  void wish(Wish wish);
  void begin(const Target& target, const fault::Fault& fault, image::Nanoseconds t);
  void end(const Active& active);
  void end_all(const Target& target, std::optional<fault::Kind> kind);
  static void apply(const Target& target, const fault::Fault& fault, bool begins);
  void settle(mock::ModbusStation& station) const;
  static void apply_to_wire(const Target& target, const fault::Fault& fault, bool begins);
  int endpoint_of(const Target& bus, int node) const;

  const machine::MachineConfig& machine_;
  mock::World& world_;
  bool controlled_;
  image::Nanoseconds lateness_ns_ = 0;
  std::vector<Active> active_;
  std::mutex wishes_lock_;
  std::vector<Wish> wishes_;
  std::atomic<bool> wished_{false};
};

}  // namespace servogate::gateway
