// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/notices.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/spindle.hpp"
#include "kernel/cycle/boundary/inputs.hpp"

namespace servogate::cycle {

using image::Notices;

/// What a process sees of the machine in one cycle.
struct ProcessContext {
  image::ProcessImage& image;
  std::span<axis::Axis> axes;
  std::span<axis::Spindle> spindles;
  std::span<const std::uint64_t> visible;  ///< how far its own crossing queues may be read in this cycle
  image::Reaction reaction;                ///< the strongest one in force
  bool drives_wanted;                      ///< the operator has asked for the drives to be on
  image::Asker drives_asker;               ///< whose request that was, or the one that they be off
  Notices& notices;
};

/// What may be done beside a program that is held or waits for the operator, its path at rest.
struct Beside {
  bool possible = false;     ///< its axes may be jogged, and functions executed
  bool away = false;         ///< axes were jogged away from the path: RequestKind::reposition leads back
  bool returns = false;      ///< they are on the way back
  bool full = false;         ///< the way has as many legs as are remembered: only its last axis can move on
  bool retraced = false;     ///< it stands back on its path: reposition leads forward when no axis is away
  double retraced_mm = 0.0;  ///< by so much path
  bool functions = false;    ///< a function is under way
  bool functions_full = false;  ///< no more of them can be kept
  std::int8_t axis = -1;        ///< of the last leg of the way
  double distance = 0.0;        ///< of that axis from where the leg begins
  std::int8_t spindle = -1;  ///< index of a spindle that is not ordered as it was when the program was held
  double spindle_rpm = 0.0;  ///< as it was then, + clockwise
  std::int32_t tool = -1;    ///< was in the spindle then, and another one is now; -1: the same
};

/// A part-program process as the cycle sees it. Everything real-time safe.
class ProcessInCycle {
 public:
  static constexpr int kCrossingsEach = cycle::kCrossingsEach;
  virtual ~ProcessInCycle() = default;
  /// How far its crossing queues are filled at this moment, kCrossingsEach numbers. They speak of the run
  /// under way and begin at 0 with it, so that what was read of a run given up leaves no trace in a record.
  virtual void published(std::span<std::uint64_t> counts) const noexcept = 0;
  /// One cycle: handshakes, path, set-points of the axes that the process owns.
  virtual void interpolate(ProcessContext& context) noexcept = 0;
  /// Carries out a request that the gate has let pass (start, step, hold, resume, stop, reset, override,
  /// mode, reposition, retrace, function).
  /// False: it cannot start because an axis is not at rest or belongs to somebody else.
  virtual bool order(const image::Request& request, ProcessContext& context) noexcept = 0;
  /// A program is loaded and may be started.
  virtual bool loaded() const noexcept = 0;
  /// What may be done beside its program at this moment.
  virtual Beside beside(const ProcessContext&) const noexcept { return {}; }
  /// The axis is about to be jogged, which the gate has let pass: while a program is held, it leaves the path
  /// here.
  virtual void leave_path(int /*axis*/, ProcessContext&) noexcept {}
  /// What its program asks of another process: decided as any request is, before its next cycle, and answered
  /// at once. True: `request` is set.
  virtual bool wish(image::Request&) noexcept { return false; }
  virtual void answered(const image::Answer&) noexcept {}
  /// The program has been ended, and its path is not at rest yet. For any thread.
  virtual bool stopping() const noexcept { return false; }
  /// The program slows down on its path to be held. In the cycle's thread.
  virtual bool holding() const noexcept { return false; }
};

}  // namespace servogate::cycle
