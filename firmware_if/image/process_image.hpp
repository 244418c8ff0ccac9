// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>

#include "firmware_if/image/drive_link.hpp"
#include "firmware_if/image/edges.hpp"
#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/request.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::image {

inline constexpr int kMaxAxes = 16;
inline constexpr int kMaxPathAxes = 9;
inline constexpr int kMaxSpindles = 2;
inline constexpr int kMaxProcesses = 5;
inline constexpr int kMaxSources = 32;
inline constexpr int kMaxSegments = 4;

/// Who may command an axis; exactly one at a time, hand-over at standstill only (docs/architecture.md,
/// "Owners").
enum class AxisOwner : std::uint8_t { none, process, manual, homing, plc, bench, gear };

/// How the last jog of an axis ended.
enum class JogEnd : std::uint8_t {
  none,     ///< there was none, or one is under way
  arrived,  ///< at the place that was asked for
  asked,    ///< by a request: jog_stop, stop, reset
  silent,   ///< its keep-alive was missed
  feed,     ///< the PLC took the axis' feed enable away
  travel,   ///< at the end of the travel
  alarm,    ///< an alarm took the motion away
  power,    ///< the drive was switched off
};
inline constexpr int kJogEnds = static_cast<int>(JogEnd::power) + 1;

/// How far an electronic gear has an axis, in the order of the K place `<axis>.gear_state`.
enum class GearState : std::uint8_t {
  none,
  engaging,     ///< it follows, and is not in step yet
  in_step,      ///< inside its window
  disengaging,  ///< it comes to rest
  refused,      ///< the last order to engage was refused: AxisGear::refusal
};
inline constexpr int kGearStates = static_cast<int>(GearState::refused) + 1;

/// The electronic gear by which an axis follows a master ([[gear]] of the machine file).
struct AxisGear {
  GearState state = GearState::none;
  std::uint8_t number = 0;    ///< in force or asked for last, of the gears of this axis from 1; 0: none
  std::uint16_t refusal = 0;  ///< of the last order, as Answer::refusal; 0: it was accepted
  double refused_value = 0.0, refused_limit = 0.0;  ///< of that, as Answer has them
  double phase_error = 0.0;  ///< how far its measured place is behind that of its master's, + behind; or 0
};

/// One axis as everybody sees it. Units: mm or degrees, seconds. A lathe's X is a radius.
struct AxisImage {
  double command = 0.0;  ///< set-point before compensation, machine coordinates
  double command_velocity = 0.0;
  double command_acceleration = 0.0;
  double actual = 0.0;           ///< measured position read in this cycle
  double following_error = 0.0;  ///< command minus actual compared at equal times
  double distance_to_go = 0.0;
  double beside = 0.0;  ///< how far it was jogged away from the path of a held program, with its sign
  AxisOwner owner = AxisOwner::none;
  JogEnd jog_end = JogEnd::none;
  std::int8_t process = 0;  ///< whose programs move it
  AxisGear gear;
  Hand hand;             ///< that began its last jog; meaningful while it jogs
  bool enabled = false;  ///< drive in Operation enabled and following
  bool homed = false;
  bool in_position = false;
  bool moving = false;
  bool limit_plus = false;  ///< on the hard limit switch
  bool limit_minus = false;
  bool home_switch = false;
  bool brake_released = false;
  DriveCommand drive_command;
  DriveFeedback drive;
};

/// A spindle; angle is measured, 0-360 degrees, where an encoder exists.
struct SpindleImage {
  double command_rpm = 0.0;  ///< signed: + clockwise (M3)
  double actual_rpm = 0.0;
  double angle_deg = 0.0;
  bool running = false;
  bool at_speed = false;
  bool is_axis = false;          ///< its drive is its rotary axis', whose image has the same feedback
  bool coupled = false;          ///< it is held to the angle of the spindle that it follows
  double phase_error_deg = 0.0;  ///< of one that is coupled: how far it is behind that angle, + behind; or 0
  DriveCommand drive_command;
  DriveFeedback drive;
};

/// Health of one source of points (a Modbus station, a GPIO chip, a drive's inputs).
enum class Quality : std::uint8_t { never, good, stale, bad };
struct IoSource {
  Quality quality = Quality::never;
  Nanoseconds updated_ns = 0;  ///< time of the newest data of the group that is worst
  std::uint32_t errors = 0;
};

/// One node of a CAN bus as its master sees it.
struct BusNodeStatus {
  bool online = false;                        ///< booted, and its process data come
  static constexpr std::uint8_t kSilent = 1;  ///< no NMT state
  std::uint8_t nmt_state = kSilent;           ///< as last heard (CiA 301, 7.2.8.3.2.2: 4, 5, 127), or kSilent
};

/// Load and health of one bus segment, for reports.
struct SegmentStatus {
  double load = 0.0;  ///< 0-1, over the last second
  double load_worst_cycle = 0.0;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t errors = 0;
  bool operational = false;
  std::array<BusNodeStatus, 128> nodes{};  ///< by node-ID
};

/// Modes of a process, in the order of the K place `NC.mode`.
enum class Mode : std::uint8_t { off, mdi, automatic, step, manual, increment, profile, home };
/// States of a process, in the order of the K place `NC.state`.
enum class ProcessState : std::uint8_t {
  idle,
  running,
  held,
  waiting,
  stopped_by_alarm,
  ended,
  stopped,  ///< before its end and without an alarm: ProcessStatus::stop says why
};

/// What stopped a program before its end where it was no alarm.
enum class StopCause : std::uint8_t {
  none,
  drives_off,        ///< `asker` had the drives switched off
  enable_withdrawn,  ///< the PLC took the enable of `axis`, or of all drives, away while they stood
};
struct Stop {
  StopCause cause = StopCause::none;
  Asker asker = Asker::command_line;
  std::int8_t axis = -1;
};

/// How two numbers compare.
enum class Compare : std::uint8_t { eq, ne, lt, le, gt, ge };

/// What keeps a program from going on while its path is at rest.
enum class WaitReason : std::uint8_t {
  none,
  signal,         ///< a wait of the program: until `place` compares with `value`
  m_acknowledge,  ///< the PLC has not acknowledged M `code`; ends by its own time-out, as the next three
  s_acknowledge,  ///< `value` rpm
  t_acknowledge,  ///< tool `code`
  h_acknowledge,
  dwell,             ///< `value` seconds in all; ends by itself
  in_position,       ///< of `axis`
  program_stop,      ///< M00: the operator's start
  optional_stop,     ///< M01: the same
  block_end,         ///< STEP mode: the operator's next step
  read_in_enable,    ///< until the PLC sets `place`
  operator_hold,     ///< feed hold of the operator
  plc_hold,          ///< until the PLC takes `place` back
  feed_enable,       ///< until the PLC sets `place`
  axis_feed_enable,  ///< the same, of `axis`
  override_zero,     ///< the operator's feed override is 0
  spindle_stands,    ///< the feed is per revolution, and the spindle is not commanded to turn
  path_wheel,        ///< the handwheel that drives the path stands, turns back or is lost
};
inline constexpr int kWaitReasons = static_cast<int>(WaitReason::path_wheel) + 1;

/// A wait of a process as plain data; words come from outside the cycle.
struct Wait {
  WaitReason reason = WaitReason::none;
  Compare compare = Compare::eq;
  std::int8_t axis = -1;
  std::int32_t line = 0;  ///< of the block that waits, in ProcessStatus::file
  std::int32_t code = 0;
  double value = 0.0;
  Place place{};
  Nanoseconds since_ns = 0;  ///< machine time at which this wait began

  bool operator==(const Wait&) const = default;
};

/// The handwheel that drives a program along its path ([[path_wheel]] of the machine file).
struct PathWheel {
  bool chosen = false;  ///< the path follows it
  bool lost = false;    ///< it says nothing: pulled out, or its encoder is not healthy
  bool leads = false;   ///< it has driven the path back: only it, or a request that ends this, leads on
  bool rests = false;   ///< the path rests for it alone, so that it may be driven back
  double turned = 0.0;  ///< its speed as a share of `full_speed`, + forward, not limited
  /// Share of the programmed feed, -1 to 1. real-time safe.
  double rate() const noexcept { return turned > 1.0 ? 1.0 : turned < -1.0 ? -1.0 : turned; }
};

/// One process (part program) as everybody sees it.
struct ProcessStatus {
  Mode mode = Mode::off;
  ProcessState state = ProcessState::idle;
  std::uint32_t run = 0;  ///< rises with every start; 0: none yet
  std::int32_t line = 0;  ///< line of the block in motion; 0: none, also after a reset and a new program
  std::int32_t file = 0;  ///< 0: main program; names by run and number in channel::ProgramTexts
  std::int64_t blocks_done = 0;  ///< blocks of this run up to the one in motion, each time it runs
  std::int32_t message = 0;      ///< number of the program's last message in channel::ProgramTexts; 0: none
  Wait wait;
  Stop stop;                    ///< of the last run, where `state` is stopped
  bool typed = false;           ///< the run is a block typed by hand (MDI), not the loaded program
  double feed_mm_s = 0.0;       ///< speed of the set-point along the path
  double override_ratio = 1.0;  ///< 0-1.5
  bool rapid = false;           ///< the block in motion is a rapid
  std::uint16_t tool = 0;
  std::uint32_t starved = 0;      ///< cycles in which planning was late and the path law ran into its rest
  bool retraced = false;          ///< a held program stands, or moves, back on its path
  bool retracing = false;         ///< a way along its path, back or forward, is asked for or under way
  double retraced_mm = 0.0;       ///< path from there to where it was held
  bool by_spindle = false;        ///< a thread or tap goes with the spindle's angle, behind its lead-in
  bool holds_later = false;       ///< held at the end of the thread, or when the tap has left its hole
  double off_spindle_mm = 0.0;    ///< path that it was off the measured angle of the same time
  double tap_overshoot_mm = 0.0;  ///< that the tap in motion, or the last one, went beyond its depth
  PathWheel wheel;
};

/// Everything the machine knows, written only inside Cycle::step() in the order: driver inputs, force, PLC,
/// program, kernel, force. Trivially copyable, so a whole-cycle snapshot is a copy.
struct ProcessImage {
  CycleTime now;
  Packets packets;
  int axis_count = 0;
  int spindle_count = 0;
  int process_count = 1;
  std::array<AxisImage, kMaxAxes> axes;
  std::array<SpindleImage, kMaxSpindles> spindles;
  std::array<ProcessStatus, kMaxProcesses> processes;
  std::array<IoSource, kMaxSources> sources;
  Edges edges;  ///< of this cycle
  std::array<SegmentStatus, kMaxSegments> segments;
  std::uint32_t alarms_active = 0;  ///< number of unacknowledged alarms
  bool homing = false;              ///< an order to home is under way, between two of its axes, too
  std::uint32_t homing_left = 0;    ///< axes, as bits, that the last order to home has not brought to its end
};
static_assert(std::is_trivially_copyable_v<ProcessImage>);

}  // namespace servogate::image
