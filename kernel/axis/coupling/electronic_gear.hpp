// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/coupling/coupling.hpp"
#include "kernel/axis/coupling/gear_law.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::axis {

/// One electronic gear of the machine file: an axis that goes with another axis or a spindle.
///
/// Engaged, the follower ramps to its master's speed, takes its place (at a phase, or where it is then) and
/// is held to it. Disengaged, it ramps to rest. Its own limits hold throughout. A master that asks for more
/// speed than the follower has, that is lost, or off which the follower is by more than the window, is an
/// alarm, and the follower ramps to rest. A spindle that leads speeds up no more than the follower can go
/// with; while it rests it leads nowhere.
///
/// In each cycle, all real-time safe:
///   look()   behind the read() of axes and spindles
///   lead()   before the command() of the spindles
///   step()   behind the command() of its master, before that of its follower
class ElectronicGear {
 public:
  struct Machine {
    std::span<Axis> axes;
    std::span<Spindle> spindles;
  };
  /// Not for the cycle.
  void configure(const ElectronicGearConfig& config, std::span<const Axis> axes);
  const ElectronicGearConfig& config() const noexcept { return config_; }

  void look(const Machine& m, const image::ProcessImage& image) noexcept;
  void lead(const Machine& m) const noexcept;
  void step(const Machine& m, const image::CycleTime& now) noexcept;

  /// Its master can be followed: it is there, and its zero is known. real-time safe.
  bool master_known() const noexcept { return master_there_ && link_.estimate().known(); }
  /// It is there and cannot be followed yet: a spindle has not passed its zero mark, or too few readings of
  /// its angle have come. real-time safe.
  bool master_awaited() const noexcept { return master_powered_ && !master_known(); }
  /// Speed of the follower that the master asks for at this moment, mm/s or degrees/s. real-time safe.
  double speed_asked(std::span<const Axis> axes, std::span<const Spindle> spindles) const noexcept;
  /// In phase with a master that never comes round, how far the follower is off its one place, with its sign;
  /// otherwise 0. real-time safe.
  double off_place(std::span<const Axis> axes) const noexcept;
  /// False: the follower moves, may not move, or is somebody else's. After the gate. real-time safe.
  bool engage(const Machine& m) noexcept;
  /// By order. real-time safe.
  void disengage(const Machine& m) noexcept;
  bool on() const noexcept { return on_; }
  bool in_step() const noexcept { return on_ && link_.synchronous(); }
  /// How far the measured place of the follower is behind that of its master at the same time; 0 while its
  /// place is not chosen. real-time safe.
  double phase_error() const noexcept { return on_ && link_.placed() ? phase_error_ : 0.0; }
  const Events& events() const noexcept { return events_; }
  void clear_events() noexcept { events_.clear(); }

 private:
  Axis& follower(const Machine& m) const noexcept {
    return m.axes[static_cast<std::size_t>(config_.follower)];
  }
  const Spindle* leading_spindle(const Machine& m) const noexcept {
    return config_.master_spindle < 0 ? nullptr
                                      : &m.spindles[static_cast<std::size_t>(config_.master_spindle)];
  }
  MotionState led_to(double turns, double turns_s, double turns_s2) const noexcept;
  bool find_target(const Machine& m, image::Nanoseconds acts_ns, image::Nanoseconds period_ns,
                   GearTarget& out) noexcept;
  bool still_led(Axis& follower) noexcept;
  void take_place(const Axis& follower, GearTarget& target) noexcept;
  void watch(Axis& follower, double asked, double dt) noexcept;
  void end(Axis& follower, Event why) noexcept;

  ElectronicGearConfig config_;
  double unit_ = 1.0, master_unit_ = 1.0;  ///< mm or degrees in a turn
  ComesRound round_ = ComesRound::neither;
  Coupling link_;
  GearLaw law_;
  Events events_;
  bool on_ = false;
  bool master_powered_ = false, master_there_ = false, rests_ = false;
  double measured_turns_ = 0.0;  ///< the master's, where the follower was last read
  double phase_error_ = 0.0;
  double rest_place_ = 0.0;  ///< where the master had it last
  double apart_s_ = 0.0;     ///< engaged and not in step
};

}  // namespace servogate::axis
