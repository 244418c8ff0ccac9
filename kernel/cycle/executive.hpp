// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/logic.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/coupling/electronic_gear.hpp"
#include "kernel/axis/homing_sequence.hpp"
#include "kernel/axis/spindle.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "kernel/cycle/boundary/inputs.hpp"
#include "kernel/cycle/boundary/participants.hpp"
#include "kernel/cycle/boundary/snapshot.hpp"
#include "kernel/cycle/gate/gate.hpp"
#include "kernel/cycle/plc_orders/gear_order.hpp"
#include "kernel/cycle/plc_orders/handwheel.hpp"
#include "kernel/cycle/plc_orders/path_wheel.hpp"
#include "kernel/cycle/plc_orders/plc_motion.hpp"

namespace servogate::cycle {

/// The phases of a cycle, in their order; their times are kept apart so that a late cycle names its phase.
enum class Phase : std::uint8_t { receive, logic, interpolate, axes, send, publish };
inline constexpr int kPhases = 6;
const char* name(Phase phase) noexcept;

/// A source of points as the cycle sees it.
struct SourceInCycle {
  bool watched = false;    ///< a stale or bad one is an alarm; otherwise its device tells
  image::PartPlace place;  ///< the part of a device that it is: an alarm of that part stays while it is gone
};

/// What a cycle is made of. All pointers outlive the cycle.
struct CycleParts {
  image::Nanoseconds period_ns = image::kMillisecond;
  std::vector<image::CycleDevice*> devices;  ///< received from and sent to in this order
  image::Logic* logic = nullptr;
  std::vector<ProcessInCycle*> processes;  ///< in number order
  std::vector<axis::AxisConfig> axes;
  std::vector<axis::SpindleConfig> spindles;
  /// What each alarm does; outlives the cycle. nullptr: every alarm stops the axes.
  const image::AlarmTable* alarms = nullptr;
  std::uint32_t k_bytes = image::kPacketKDefaultSize;
  std::uint32_t syvar_bytes = image::kSyvarDefaultSize;
  const image::Clock* stopwatch = nullptr;  ///< measures the phases; nullptr: phases are not measured
  std::array<SourceInCycle, image::kMaxSources> sources{};
  std::optional<image::Place>
      estop_place;  ///< emergency-stop chain: FALSE opens MC.estop_ok whatever the logic says
  std::optional<image::Place> alive_place;  ///< output that toggles as MC.control_alive does
  std::optional<image::Place> start_place;  ///< operator's start button: its rising edge asks for cycle start
  std::array<PathWheelConfig, image::kMaxProcesses> path_wheels{};
  /// No ring of them (machine/check). The PLC knows those of an axis by their order here, from 1.
  std::vector<axis::ElectronicGearConfig> gears;
  /// By which the age of requests is judged; nullptr: CLOCK_MONOTONIC, which a stopped process does not stop.
  const image::Clock* request_clock = nullptr;
};

/// Of one posted request, for Cycle::withdraw(). 0: it was not posted.
using Claim = std::uint32_t;

/// Drive counts at each axis' home position, meaningful while the axis is homed.
using References = std::array<std::int64_t, image::kMaxAxes>;

/// One function of the image and the clock: step() takes in what the buses brought, runs logic, processes and
/// axes, and sends the commands (docs/architecture.md, rule 1). The real-time thread calls it at absolute
/// times; tests and virtual time call it in a plain loop.
///
/// Thread contract: construction, attach_*() and history() outside the running cycle; step() on one thread
/// only; post(), take_answer() on one other thread (or under the caller's lock); read() on any.
class Cycle {
 public:
  explicit Cycle(CycleParts parts);
  ~Cycle();
  Cycle(const Cycle&) = delete;
  Cycle& operator=(const Cycle&) = delete;

  /// One cycle at its nominal time. real-time safe. False: a replayed record has ended, nothing was done.
  bool step() noexcept;

  /// Posts a request; false: the queue is full. Answers come in order. real-time safe.
  bool post(const image::Request& request) noexcept { return post_for(request, 0, kForAnyTime) != 0; }
  /// The same of one that has lain for `lain_ns` already and is refused (too_old) where it has lain for more
  /// than `limit_ns` of the request clock when a cycle comes to it, unless it is never_too_old(). A record
  /// holds nothing of what was refused for its age or withdrawn. 0: the queue is full. real-time safe.
  Claim post_for(const image::Request& request, image::Nanoseconds lain_ns,
                 image::Nanoseconds limit_ns) noexcept;
  static constexpr image::Nanoseconds kForAnyTime = -1;
  /// Takes a posted request back, for the thread that posts. True: no cycle takes it, and no answer comes;
  /// false: one has taken it. Never both. real-time safe.
  bool withdraw(Claim claim) noexcept;
  /// Takes the oldest answer. real-time safe.
  bool take_answer(image::Answer& answer) noexcept;
  /// Copies the newest published image and alarms. Not for the cycle.
  void read(image::ProcessImage& image) const noexcept { image_snapshot_.read(image); }
  void read(AlarmSnapshot& alarms) const noexcept { alarm_snapshot_.read(alarms); }
  void read(References& references) const noexcept { reference_snapshot_.read(references); }
  /// Publishes snapshots every `cycles` cycles; 0: never (a virtual run whose owner looks at image() itself).
  void publish_every(int cycles) noexcept { publish_every_ = cycles; }

  /// Where the owner of the loop reports faults between two cycles; devices are given it in receive().
  Notices& notices() noexcept { return notices_; }
  /// Machine seconds in a second of the wall clock where time is scaled (virtual time with --speed): what is
  /// asked of a living hand, the keep-alive of a jog, is judged by it. Before the first step.
  void set_time_scale(double scale) noexcept;
  double time_scale() const noexcept { return time_scale_; }
  /// Hands every cycle's inputs to a tap (record), or takes them from a source (replay) instead of the
  /// devices.
  void attach(InputTap* tap) noexcept { tap_ = tap; }
  void attach(InputSource* source) noexcept { source_ = source; }

  /// The image as the last step() left it; only for the thread that steps.
  const image::ProcessImage& image() const noexcept { return image_; }
  /// For composition before the first step (initial values of simulated inputs, retained words).
  image::ProcessImage& initial_image() noexcept { return image_; }
  const AlarmList& alarms() const noexcept { return alarms_; }
  std::span<const axis::Axis> axes() const noexcept { return axes_; }
  /// Takes over a kept reference before the first step.
  void set_reference(int axis, std::int64_t counts) noexcept {
    axes_[static_cast<std::size_t>(axis)].set_reference(counts);
  }
  bool homing_failed() const noexcept { return homing_.state() == axis::HomingSequence::State::failed; }
  /// Measures every n-th cycle only, n >= 1: in virtual time the stopwatch would cost as much as a phase.
  void measure_every(int cycles) noexcept { measure_every_ = cycles; }
  /// The last cycle was measured: phase_ns() and duration_ns() are its own, otherwise of one before.
  bool measured() const noexcept { return measuring_; }
  const std::array<image::Nanoseconds, kPhases>& phase_ns() const noexcept { return phase_ns_; }
  image::Nanoseconds duration_ns() const noexcept { return duration_ns_; }
  /// Number of cycles done.
  std::int64_t count() const noexcept { return count_; }
  image::Nanoseconds period_ns() const noexcept { return parts_.period_ns; }
  /// The owner of the loop reports a cycle that began late; past a limit this is an alarm. It names the
  /// longest phase of a cycle before that was too long, but in virtual time (`by_clock` false), where what
  /// the computer took means nothing. real-time safe.
  void note_overrun(image::Nanoseconds late_ns, bool by_clock = true) noexcept;
  /// The owner of the loop asks, after a step that was measured, whether the logic has taken longer than
  /// this, or was `ended` from outside after it; then it is an alarm. In virtual time nobody asks. real-time
  /// safe.
  void watch_logic(image::Nanoseconds limit_ns, bool ended = false) noexcept;

 private:
  struct Queues;
  struct Forced {
    image::Place place;
    double value = 0.0;
  };

  bool receive() noexcept;
  void capture(CycleInputs& in) noexcept;
  bool take_request(image::Request& request) noexcept;
  const image::Clock& request_clock() const noexcept;
  void apply(const CycleInputs& in) noexcept;
  void run_logic() noexcept;
  void watch_machine() noexcept;
  void watch_sources() noexcept;
  void handle_requests() noexcept;
  void handle_plc_requests() noexcept;
  image::Answer handle(const image::Request& request) noexcept;
  // What the gate has let pass, a part of the requests each. What it cannot know (an axis not yet quite at
  // rest) makes a late refusal.
  Refusal carry_out(const image::Request& request) noexcept;
  Refusal carry_out_manual(const image::Request& request) noexcept;
  Refusal along_path(const image::Request& request) noexcept;
  Refusal carry_out_motion(const image::Request& request, axis::Axis& axis) noexcept;
  Refusal order(int process, const image::Request& request) noexcept;
  Refusal end_or_hold(const image::Request& request) noexcept;
  void switch_power(const image::Request& request) noexcept;
  void reset(const image::Request& request) noexcept;
  Refusal write_place(const image::Request& request) noexcept;
  void change_mode(int process, image::Mode mode) noexcept;
  bool hold_logic(const image::Request& request) noexcept;
  void keep_alive(axis::Axis& axis, const image::Hand& hand) noexcept;
  void keep_alive(const image::Request& request) noexcept;
  void stop_jogs(const image::Request& request) noexcept;
  void watch_forces() noexcept;
  void jog_of_plc(axis::Axis& axis) noexcept;
  void follow_handwheel(Handwheel& wheel, axis::Axis& axis) noexcept;
  void follow_path_wheel(PathWheel& wheel) noexcept;
  // executive_gears.cpp
  void configure_gears();
  axis::ElectronicGear::Machine geared_machine() noexcept { return {axes_, spindles_}; }
  axis::ElectronicGear* gear_of(int axis, double number) noexcept;
  int gears_of(int axis) const noexcept;
  void follow_gear(GearOrder& order, axis::Axis& axis) noexcept;
  bool gear_awaited(const GearOrder& order, const axis::Axis& a) noexcept;
  bool engage_gear(const image::Request& request) noexcept;
  void disengage_gears(int axis) noexcept;
  void look_at_masters() noexcept;
  std::uint32_t followers_now() const noexcept;
  void command_followers(std::uint32_t followers) noexcept;
  void show_gears() noexcept;
  void move_auxiliary(PlcMotion& motion, axis::Axis& axis) noexcept;
  void stop_manual(bool with_plc) noexcept;
  void run_processes() noexcept;
  void run_axes() noexcept;
  void collect_events() noexcept;
  void note_rest() noexcept;
  void write_machine_places() noexcept;
  void force() noexcept;
  void publish() noexcept;
  ProcessContext context(int process) noexcept;
  void raise(const image::AlarmRecord& record) noexcept;
  void raise(image::AlarmNumber number) noexcept;
  bool still_present(const image::AlarmRecord& record) const noexcept;
  bool part_missing(const image::AlarmRecord& record) const noexcept;
  void begin_measuring() noexcept;
  void stamp(Phase phase) noexcept;

  CycleParts parts_;
  image::ProcessImage image_;
  std::vector<axis::Axis> axes_;
  std::vector<axis::Spindle> spindles_;
  std::vector<axis::ElectronicGear> gears_;
  std::vector<std::uint8_t> masters_first_;  ///< all axes
  axis::HomingSequence homing_;
  AlarmList alarms_;
  Notices notices_;
  CycleInputs inputs_;
  InputTap* tap_ = nullptr;
  InputSource* source_ = nullptr;
  std::unique_ptr<Queues> queues_;
  Snapshot<image::ProcessImage> image_snapshot_;
  Snapshot<AlarmSnapshot> alarm_snapshot_;
  Snapshot<References> reference_snapshot_;
  AlarmSnapshot alarm_copy_;
  int publish_every_ = 0;
  std::array<Forced, 256> forced_{};
  int forced_count_ = 0;

  image::Reaction reaction_ = image::Reaction::none;
  bool power_request_ = false;
  image::Asker power_asker_ = image::Asker::command_line;  ///< of the last request for power
  bool estop_seen_ok_ = false;
  bool start_pressed_ = false;
  bool manual_held_ = false;
  image::Asker holder_ = image::Asker::command_line;
  std::array<std::uint8_t, image::kMaxProcesses> plc_edges_{};
  std::array<std::int8_t, image::kMaxAxes> plc_jogs_{};
  std::array<PlcMotion, image::kMaxAxes> plc_motion_{};
  std::array<Handwheel, image::kMaxAxes> handwheels_{};
  std::array<PathWheel, image::kMaxProcesses> path_wheels_{};
  std::array<GearOrder, image::kMaxAxes> gear_orders_{};
  bool logic_held_ = false;  ///< for single scans
  std::array<std::int16_t, image::kMaxProcesses> external_alarm_{};
  std::array<image::Quality, image::kMaxSources> source_quality_{};
  std::uint32_t overruns_ = 0;

  std::int64_t count_ = 0;
  std::array<image::Nanoseconds, kPhases> phase_ns_{};
  image::Nanoseconds duration_ns_ = 0;
  image::Nanoseconds stamp_ns_ = 0;
  int measure_every_ = 1;
  double time_scale_ = 1.0;
  bool measuring_ = false;
};

}  // namespace servogate::cycle
