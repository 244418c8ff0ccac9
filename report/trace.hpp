// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/process_image.hpp"

namespace servogate::report {

inline constexpr int kMaxTraceSignals = 256;

/// A bit of packet A or K that trace and report follow, under the name people know it by.
struct TraceSignal {
  std::string name;
  image::Place place;  ///< a BL place; any other format counts as on when its number is not 0
};

/// A coordinate of a program: offset + the sum of share[a] * machine coordinate of axis a; mm or degrees, as
/// programs write it (a diameter on a diameter axis).
struct WorkAxis {
  double offset = 0.0;
  std::array<double, image::kMaxAxes> share{};
  friend bool operator==(const WorkAxis&, const WorkAxis&) = default;
};
/// By axis of the machine.
using WorkFrame = std::array<WorkAxis, image::kMaxAxes>;
/// The frame that a process (from 0) has in a block of a run, image::ProcessStatus::run and blocks_done;
/// false: not known. Called by the recorder's thread.
using FrameOf = std::function<bool(int process, std::uint32_t run, std::int64_t blocks, WorkFrame& frame)>;

/// What one row holds; the same for a whole run.
struct TraceLayout {
  image::Nanoseconds period_ns = image::kMillisecond;
  std::vector<std::string> axes;     ///< letters in the machine file's order, at most image::kMaxAxes
  int spindles = 0;                  ///< at most image::kMaxSpindles
  int processes = 1;                 ///< at most image::kMaxProcesses
  std::vector<TraceSignal> signals;  ///< at most kMaxTraceSignals; the rest is ignored
  FrameOf frame_of;                  ///< none: places in machine coordinates only
};

/// One axis in one cycle; mm or degrees, seconds.
struct TraceAxis {
  double command = 0.0;          ///< set-point before compensation
  double actual = 0.0;           ///< measured
  double following_error = 0.0;  ///< compared at equal times
  double velocity = 0.0;         ///< of the set-point, as the kernel gives it
  double acceleration = 0.0;
  bool enabled =
      false;           ///< the drive follows; while it does not, the set-point may jump to the measured place
  bool homed = false;  ///< a change means new coordinates, hence a jump that is no motion
  std::int8_t process = -1;  ///< from 0, whose programs move it; -1: none does
};
struct TraceSpindle {
  double command_rpm = 0.0;
  double actual_rpm = 0.0;
  double angle_deg = 0.0;  ///< measured, 0 - 360
};

/// A process beside the first one.
struct TraceProcess {
  double feed_mm_s = 0.0;
  std::int32_t line = 0, tool = 0;
  std::uint32_t run = 0;    ///< image::ProcessStatus::run
  std::int64_t blocks = 0;  ///< image::ProcessStatus::blocks_done
};

/// One cycle of the machine as plain data.
struct TraceRow {
  std::int64_t cycle = 0;
  image::Nanoseconds t_ns = 0;
  double feed_mm_s = 0.0;       ///< speed of the set-point along the path
  std::int32_t line = 0;        ///< line of the block in motion, 0: none
  bool rapid = false;           ///< the block in motion is a rapid
  std::int32_t tool = 0;        ///< number of the tool in process 1, 0: none
  std::uint32_t alarms = 0;     ///< not acknowledged
  std::uint32_t run = 0;        ///< of process 1, image::ProcessStatus::run
  std::int64_t blocks = 0;      ///< of process 1, image::ProcessStatus::blocks_done
  double off_spindle_mm = 0.0;  ///< of process 1, image::ProcessStatus::off_spindle_mm
  std::array<TraceAxis, image::kMaxAxes> axes{};
  std::array<TraceSpindle, image::kMaxSpindles> spindles{};
  std::array<TraceProcess, image::kMaxProcesses - 1> further{};  ///< processes 2 and up
  std::array<std::uint64_t, kMaxTraceSignals / 64> signals{};    ///< bit n = layout signal n

  bool signal(std::size_t n) const noexcept { return ((signals[n / 64] >> (n % 64)) & 1u) != 0; }
};

/// Fills a row from the image as it stands at the end of a cycle (process 1 gives feed, line, rapid and
/// tool; `further` has those of the others). real-time safe.
void sample(const image::ProcessImage& image, const TraceLayout& layout, TraceRow& row) noexcept;

/// Takes rows in order, on the recorder's own thread. Errors are kept, never thrown: a full disk stops a
/// file, not the machine.
class TraceSink {
 public:
  virtual ~TraceSink() = default;
  virtual void begin(const TraceLayout& layout) = 0;
  virtual void row(const TraceRow& row) = 0;
  /// After the last row. `dropped` rows were lost on the way.
  virtual void end(std::uint64_t dropped) = 0;
  /// What went wrong, empty when nothing did. Read it after TraceRecorder::close().
  virtual std::string error() const { return {}; }
};

/// What a trace file carries beside its fixed first columns.
struct CsvColumns {
  bool following_error = true;  ///< X.error ...
  bool signals = true;          ///< one column of 0 and 1 per signal
  bool work = true;             ///< X.work ..., where the layout has frames
};

/// The trace as CSV:
/// `t,feed,line,X.cmd,X.act,Y.cmd,...,spindle.cmd,spindle.act,spindle.angle,X.error,...,<signal>...,feed2,
/// line2,tool2,...,X.work,...` (feed2 ... of processes 2 and up), one row a cycle; t in seconds, feed in
/// mm/s, positions in mm or degrees with 12 decimals, spindles in rpm and degrees. Equal rows give equal
/// bytes.
class CsvSink final : public TraceSink {
 public:
  explicit CsvSink(std::string path, CsvColumns columns = {});
  ~CsvSink() override;
  void begin(const TraceLayout& layout) override;
  void row(const TraceRow& row) override;
  void end(std::uint64_t dropped) override;
  std::string error() const override;

  /// The header line without its end, for tests and documents.
  static std::string header(const TraceLayout& layout, CsvColumns columns = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Carries rows from the cycle to the sinks: a bounded lock-free queue (one producer), emptied by a thread of
/// its own. Virtual time loses nothing: the owner of the loop calls wait_for_room() before each cycle. Real
/// time never waits: rows that find the queue full are dropped and counted.
class TraceRecorder {
 public:
  /// Starts the writer thread. `capacity` in rows (each about 1 kB).
  TraceRecorder(TraceLayout layout, std::vector<std::unique_ptr<TraceSink>> sinks,
                std::size_t capacity = 8192);
  ~TraceRecorder();
  TraceRecorder(const TraceRecorder&) = delete;
  TraceRecorder& operator=(const TraceRecorder&) = delete;

  const TraceLayout& layout() const noexcept;
  /// Hands one row over. False: the queue was full, the row is lost and counted. real-time safe.
  bool record(const TraceRow& row) noexcept;
  /// Blocks until the next record() is sure to succeed. For the loop's owner, outside the cycle, in virtual
  /// time.
  void wait_for_room();
  /// Writes what is queued, ends the sinks and the thread; later calls do nothing. Not real-time safe.
  void close();
  std::uint64_t recorded() const noexcept;
  std::uint64_t dropped() const noexcept;
  /// The sinks, to read results and errors from after close().
  const std::vector<std::unique_ptr<TraceSink>>& sinks() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::report
