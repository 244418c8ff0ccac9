// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/axis.hpp"
#include "tests/property_seed.hpp"

namespace servogate::axis::test {

inline unsigned fresh_seed() {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  return seed;
}

/// Judges a motion by the finite differences of its positions alone.
class Judge {
 public:
  Judge(double x, double dt) : dt_(dt), x_{x, x, x, x} {}
  void add(double x) {
    x_ = {x_[1], x_[2], x_[3], x};
    velocity = std::max(velocity, std::abs(x_[3] - x_[2]) / dt_);
    acceleration = std::max(acceleration, std::abs(x_[3] - 2 * x_[2] + x_[1]) / (dt_ * dt_));
    jerk = std::max(jerk, std::abs(x_[3] - 3 * x_[2] + 3 * x_[1] - x_[0]) / (dt_ * dt_ * dt_));
  }
  /// The machine's coordinates were set anew: no motion.
  void seat(double x) { x_ = {x, x, x, x}; }
  bool within(const MotionLimits& m) const {
    const bool good =
        velocity <= m.velocity * 1.001 && acceleration <= m.acceleration * 1.001 && jerk <= m.jerk * 1.001;
    if (!good)
      std::printf("v %g of %g, a %g of %g, j %g of %g\n", velocity, m.velocity, acceleration, m.acceleration,
                  jerk, m.jerk);
    return good;
  }
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;

 private:
  double dt_;
  std::array<double, 4> x_;
};

/// A drive whose position is the command of `delay` cycles ago (optionally lagging behind it), with a zero
/// mark each revolution, and switches that follow its true position. It may be dragged while it is off.
class FakeDrive {
 public:
  int delay = 2;
  double lag = 0.0;                ///< part of the way to the target left each cycle
  std::int64_t revolution = 5000;  ///< counts
  std::int64_t mark = 1234;        ///< zero mark at mark + n * revolution
  int enable_cycles = 5;
  std::int64_t counts = 0;
  bool fault = false;
  bool lost = false;
  bool mute = false;              ///< its process data do not come: the old ones stand
  bool torque_off = false;        ///< somebody took its torque: it cannot be enabled
  std::int64_t coast_counts = 0;  ///< moves so far each cycle while it does not follow
  std::uint32_t sequence = 0;
  std::int64_t captured = 0;

  void start_at(std::int64_t c) {
    counts = c;
    pipe_.clear();
  }
  /// Takes the command computed in the last cycle and gives the feedback read in this one.
  void cycle(const image::DriveCommand& c, image::DriveFeedback& f) {
    power_cycles_ = c.power && !fault ? power_cycles_ + 1 : 0;
    if (c.reset_fault) fault = false;
    const bool on = power_cycles_ > enable_cycles && !c.quick_stop && !torque_off;
    pipe_.push_back(c.position_counts);
    while (static_cast<int>(pipe_.size()) > delay) pipe_.pop_front();
    const std::int64_t before = counts;
    if (on && static_cast<int>(pipe_.size()) == delay) {
      exact_ = lag > 0.0 ? exact_ + (static_cast<double>(pipe_.front()) - exact_) * (1.0 - lag)
                         : static_cast<double>(pipe_.front());
      counts = std::llround(exact_);
    } else {
      counts += coast_counts;
      exact_ = static_cast<double>(counts);
    }
    latch(before, c.latch_arm);
    f.missed = mute ? f.missed + 1 : 0;
    if (mute) return;
    f.online = !lost;
    f.state = fault          ? image::DriveState::fault
              : torque_off   ? image::DriveState::switch_on_disabled
              : c.quick_stop ? image::DriveState::quick_stop_active
              : on           ? image::DriveState::operation_enabled
                             : image::DriveState::switch_on_disabled;
    f.position_counts = counts;
    f.latch_counts = captured;
    f.latch_sequence = sequence;
  }

 private:
  void latch(std::int64_t before, bool arm) {
    if (!arm) armed_ = true;
    if (!arm || !armed_ || before == counts) return;
    auto at = [&](std::int64_t c) {
      const std::int64_t d = c - mark;
      return d >= 0 ? d / revolution : -((-d + revolution - 1) / revolution);
    };
    const std::int64_t a = at(before), b = at(counts);
    if (a == b) return;
    captured = mark + (b > a ? a + 1 : a) * revolution;
    ++sequence;
    armed_ = false;
  }
  std::deque<std::int64_t> pipe_;
  double exact_ = 0.0;
  int power_cycles_ = 0;
  bool armed_ = true;
};

inline constexpr SwitchPlace kPlusSwitch{{image::Packet::a, image::Format::bl, 0, 1}, true};
inline constexpr SwitchPlace kMinusSwitch{{image::Packet::a, image::Format::bl, 1, 1}, true};
inline constexpr SwitchPlace kHomeSwitch{{image::Packet::a, image::Format::bl, 2, 1}, false};
inline constexpr SwitchPlace kBrakePlace{{image::Packet::a, image::Format::bl, 9, 1}, false};

/// 1000 counts a mm, 5 mm a revolution, travel -300..300 about a home position that the test's drive has at
/// count 0 plus the zero mark; limits at -310 and +310 mm, home switch from -250 mm down (true coordinates).
inline AxisConfig mill_axis() {
  AxisConfig c;
  c.limit_plus = kPlusSwitch;
  c.limit_minus = kMinusSwitch;
  c.home_switch = kHomeSwitch;
  c.homing.position = -251.0;
  c.homing.direction = -1;
  c.homing.release_direction = 1;
  c.homing.fast = 50.0;
  c.homing.slow = 3.0;
  c.homing.final_move = false;
  c.slow_velocity = 5.0;
  return c;
}

/// One axis with its fake drive, its switches and a PLC that permits everything.
class Rig {
 public:
  explicit Rig(AxisConfig config = mill_axis()) {
    axis.configure(config, 0);
    drive.delay = config.feedback_delay;
    image.axis_count = 1;
    plc("enable", true);
    plc("feed_enable", true);
    power_on(true);
  }
  void plc(std::string_view name, bool value) {
    for (const auto& f : image::kAxisFields)
      if (f.name == name)
        image.packets.set_bit(
            {image::Packet::k, image::Format::bl, (image::axis_base(0) + f.byte) * 8 + f.bit, 1}, value);
  }
  double plc(std::string_view name) const {
    for (const auto& f : image::kAxisFields)
      if (f.name == name) {
        const std::uint32_t byte = image::axis_base(0) + f.byte;
        return image.packets.number(
            {image::Packet::k, f.format,
             f.format == image::Format::bl ? byte * 8 + f.bit : byte / image::format_size(f.format), 1});
      }
    return -1e99;
  }
  void power_on(bool value) {
    image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), value);
  }
  /// True position of the slide, mm; the switches know nothing of homing.
  double true_mm() const {
    return static_cast<double>(drive.counts) * axis.config().count_direction / 1000.0;
  }
  void set_switches() {
    const double x = true_mm();
    image.packets.set_bit(kPlusSwitch.place, !(x >= plus_switch));
    image.packets.set_bit(kMinusSwitch.place, !(x <= minus_switch));
    const bool home = x <= home_from && x >= home_to;
    if (home != home_was) bounce_left = bounce_cycles;
    image.edges.clear();
    if (home_edges && home != home_was) tell_edge(home, x);
    x_was = x;
    home_was = home;
    const bool bounced = bounce_left > 0 && (--bounce_left % 3) == 1;
    image.packets.set_bit(kHomeSwitch.place, home != bounced);
  }
  /// With the time at which the slide passed the upper end of the switch: it stands at `x` one cycle ago, as
  /// it is read in this one.
  void tell_edge(bool home, double x) {
    const image::Nanoseconds period = image.now.period_ns;
    const double left = (x - home_from) / (x - x_was);
    const image::Nanoseconds at =
        image.now.t_ns - period - static_cast<image::Nanoseconds>(left * static_cast<double>(period));
    for (int n = 0; n <= 2 * edge_bounces; ++n)
      image.edges.add({kHomeSwitch.place, home == (n % 2 == 0), at + n * image::kMillisecond / 10});
  }
  void cycle() {
    image.now.number += 1;
    image.now.t_ns = image.now.number * image.now.period_ns;
    drive.cycle(shared().drive_command, shared().drive);
    set_switches();
    axis.read(image);
    if (setpoint) axis.set_process(*setpoint);
    axis.react(reaction);
    if (before_command) before_command();
    axis.command(image);
    for (const Event& e : axis.events()) events.push_back(e);
  }
  void run(int cycles) {
    while (cycles-- > 0) cycle();
  }
  template <typename Until>
  bool run_until(Until&& until, int cycles = 60'000) {
    while (cycles-- > 0) {
      cycle();
      if (until()) return true;
    }
    return false;
  }
  bool enable() {
    axis.request_power(true);
    return run_until([&] { return axis.motion_permitted(); }, 2000);
  }
  /// Homed without a search: count 0 is position 0.
  void reference_here() {
    AxisConfig c = axis.config();
    c.homing.position = 0.0;
    axis.configure(c, 0);
    axis.set_reference(0);
  }
  bool raised(image::AlarmNumber n) const {
    for (const Event& e : events)
      if (e.number == n) return true;
    return false;
  }
  image::AxisImage& shared() { return image.axes[0]; }

  image::ProcessImage image;
  Axis axis;
  FakeDrive drive;
  image::Reaction reaction = image::Reaction::none;
  std::optional<Setpoint> setpoint;
  std::function<void()> before_command;
  std::vector<Event> events;
  int bounce_cycles = 0;  ///< after each change of the home switch
  int bounce_left = 0;
  bool home_was = false;
  bool home_edges = false;  ///< the home switch tells its edges; only its upper end is passed
  int edge_bounces = 0;     ///< of each of them
  double x_was = 0.0;
  double plus_switch = 310.0, minus_switch = -310.0, home_from = -250.0, home_to = -1e9;
};

}  // namespace servogate::axis::test
