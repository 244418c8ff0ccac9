// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/channel/process.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "kernel/cycle/executive.hpp"

namespace servogate::channel::test {

inline constexpr int kAxes = 3;
inline constexpr axis::MotionLimits kLimits{500.0, 1000.0, 10000.0};
inline constexpr double kSpindleMax = 4000.0;  ///< rpm

/// Drives that follow each command exactly two cycles later, like a fast bus.
class IdealDrives final : public image::CycleDevice {
 public:
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  void send(image::ProcessImage& image) noexcept override;
  std::array<bool, kAxes> fault{};  ///< falls out of Operation enabled
  std::array<bool, kAxes> stuck{};  ///< does not move any more, and says so
  double slip = 0.0;               ///< share of its speed that the spindle loses under load, 0.2 % each cycle
  bool spindle_fault = false;      ///< its drive has tripped
  bool spindle_stuck = false;      ///< it stands still, whatever it is told
  bool spindle_backwards = false;  ///< it turns the other way round, whatever it is told
  bool second_stuck = false;       ///< the second one stands still
  bool spindle_silent = false;     ///< its readings do not come any more
  bool spindle_coasts = false;     ///< it turns on as it does, whatever it is told
  bool spindle_one_way = false;    ///< it stops, but does not turn counter-clockwise
  double turns = 0.0;              ///< true revolutions of the spindle one period ago
  /// Of the probe to the part, mm: it is deflected from 0 down. Without it there is no part.
  std::function<double(const std::array<double, kAxes>&)> clearance;
  void surface_at(double z) {
    clearance = [z](const std::array<double, kAxes>& at) { return at[2] - z; };
  }
  bool edges = true;                                  ///< its input tells its edges with times
  std::array<bool, kAxes> latches{true, true, true};  ///< drives whose input 1 it is wired to, too
  int bounce_cycles = 0;  ///< so long its contacts close and open every second cycle behind an edge

 private:
  std::array<std::array<std::int64_t, 2>, kAxes> pipe_{};
  std::array<image::DriveCommand, kAxes> commands_{};
  std::array<bool, kAxes> latched_{};
  std::array<std::int64_t, kAxes> counts_{}, counts_before_{};
  void probe(image::ProcessImage& image);
  double clear_before_ = 1.0, slipped_ = 0.0;
  int since_edge_ = 1000000;
  void second_spindle(image::ProcessImage& image);
  void lead_spindle(image::DriveFeedback& s, double period_s);
  image::DriveCommand spindle_, second_;
  std::array<std::int64_t, 2> led_{};
  bool led_on_ = false;
  double second_turns_ = 0.0;
};

/// One strobe as the PLC saw it.
struct Strobe {
  char word;  ///< M S T H
  double code;
  double value;  ///< corrector of T
  double x;      ///< set-point of X at that moment
  bool moving;   ///< some axis was
  std::int64_t cycle;
  double acknowledged_s = 0.0;  ///< how long the strobe stood
};

/// The machine builder's logic: permits everything and acknowledges what it is told to.
class TestLogic final : public image::Logic {
 public:
  void scan(image::ProcessImage& image, cycle::Notices& notices) noexcept override;
  int delay_cycles = 3;      ///< from strobe to acknowledge
  std::set<double> never;    ///< M codes that are never acknowledged
  std::set<double> unknown;  ///< M codes that are acknowledged as unknown
  bool acknowledge_s = true, acknowledge_t = true, acknowledge_h = true;
  bool estop_ok = true, power_on = true, feed_enable = true, read_in_enable = true, optional_stop = false,
       dry_run = false;
  std::array<bool, kAxes> axis_feed_enable{true, true, true}, axis_enable{true, true, true};
  std::array<bool, kAxes> limit_plus{};
  int feed_override = 0, spindle_override = 0, skip_levels = 0;
  bool spindle_enable = true;
  bool start_bit = false, stop_bit = false, reset_bit = false;
  int external_alarm = 0;
  std::vector<Strobe> strobes;
  std::function<void()> during;  ///< in every scan: between what the cycle has looked at and what it does

 private:
  void word(image::ProcessImage& image, int n);
  std::array<int, 4> waited_{};
};

/// What the axes are: X, Y, Z; or X is programmed in diameter and the radius for G96; or Y is a rotary B; or
/// X, Y, Z planned at twice their limits, so that no law through short blocks is found that keeps them.
/// Or a mill whose spindle has no encoder, and that has no probe; or one on which a hold leaves a thread, or whose
/// threads go by the set-point of its spindle.
/// Or one whose tool leaves a thread to where it came from. Or one whose drives latch the touch. Or one whose
/// programs speak the ISO dialect, or Fenix. Or a lathe in the ISO dialect whose second spindle may follow
/// the first one. Or one whose second axis is an endless C that the spindle becomes, by M70 and back by M71.
enum class RigKind {
  mill,
  lathe,
  rotary,
  lawless,
  blind,
  retracting,
  infeed,
  setpoint,
  latching,
  iso,
  fenix,
  polygon,
  c_axis
};

/// A process with its cycle, three ideal axes and a test's PLC. Homed and powered, in AUTO, standing at 0, 0,
/// 0.
class Rig {
 public:
  explicit Rig(std::string_view program, std::string_view power_on = "G27", double handshake_timeout_s = 0.5,
               RigKind kind = RigKind::mill, std::string_view dialect = "nc110");

  /// Loads another program, as between two runs.
  void load(std::string_view program);
  void run(double seconds);
  bool until(const std::function<bool()>& met, double patience_s = 30.0);
  cycle::Refusal ask(image::RequestKind kind, double value = 0.0, int axis = -1);
  cycle::Refusal ask(image::Request request);
  void start() { started_ = ask(image::RequestKind::start); }
  /// Starts the program and runs it to its end: true when it ends by itself.
  bool finish(double patience_s = 60.0);

  const image::ProcessImage& image() const { return cycle->image(); }
  const image::ProcessStatus& status() const { return image().processes[0]; }
  image::ProcessState state() const { return status().state; }
  double x(int axis = 0) const { return image().axes[static_cast<std::size_t>(axis)].command; }
  double now() const { return image().now.seconds(); }
  bool moving() const;
  int alarms(image::AlarmNumber number) const;
  const image::AlarmRecord* alarm(image::AlarmNumber number);
  std::string alarm_list() const;
  bool bit(image::Place place) const { return image().packets.bit(place); }
  /// What of the limits has been exceeded so far; empty: nothing.
  const std::string& violations() const { return violations_; }
  cycle::Refusal started() const { return started_; }

  IdealDrives drives;
  TestLogic logic;
  std::unique_ptr<Process> process;
  std::unique_ptr<cycle::Cycle> cycle;
  std::function<void()> each;                   ///< after every cycle
  std::function<void()> read;                   ///< takes the place of one Process::work() before each cycle
  std::vector<std::array<double, kAxes>> path;  ///< set-points of all cycles

 private:
  void step();
  std::string violations_;
  InterpreterFactory factory(std::string_view program) const;
  std::string dialect_;
  program::MachineModel model_;
  std::vector<image::AlarmRecord> history_;
  std::uint64_t next_id_ = 1;
  cycle::Refusal started_ = cycle::Refusal::none;
};

/// Where the probe of the rig is.
inline constexpr image::Place kProbePlace{image::Packet::a, image::Format::bl, 40, 1};

/// A place of packet K or A from its format and index.
inline image::Place sk(std::uint32_t index, image::Format format = image::Format::bl) {
  return {image::Packet::k, format, index, 1};
}
inline image::Place sa(std::uint32_t index) { return {image::Packet::a, image::Format::bl, index, 1}; }

/// Distance of a point to the straight line from a to b in the plane of X and Y.
double off_line(const std::array<double, kAxes>& p, double ax, double ay, double bx, double by);

}  // namespace servogate::channel::test
