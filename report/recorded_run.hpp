// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report/record/every_cycle.hpp"
#include "report/trace.hpp"

namespace servogate::report {

/// One quantity over time: least and greatest value of each bucket.
struct Series {
  std::string name;  ///< "X.velocity", "path.speed", "spindle.cmd" ...
  std::string unit;  ///< "mm/s", "deg/s", "rpm" ...
  std::vector<float> low, high;
};

/// The path of the set-points as a polyline that keeps within RecordedRun::path_tolerance of every set-point.
struct PathLine {
  std::vector<float> x, y, z;  ///< the three view axes, 0 where there is none
  std::vector<float> t;        ///< seconds
  std::vector<float> speed;    ///< mm/s at the vertex
  std::vector<std::int32_t> line;
  /// The stretch that ends at this vertex: 0 feed, 1 rapid or motion outside the program (homing, jog), 2 a
  /// jump of the coordinates (homing, drives off) that is no motion.
  std::vector<std::uint8_t> rapid;
  /// Largest following error across the direction of motion on that stretch, mm; along it the tool is late,
  /// not off the path.
  std::vector<float> deviation;
  std::vector<std::int32_t> tool;
};

/// From here on these coordinates are those of the program in motion.
struct FrameChange {
  double t_s = 0.0;
  std::vector<std::optional<WorkAxis>> axes;  ///< none: no program has moved that axis yet
};

/// On/off signal: the state before cycle 0, and the times at which it turned over.
struct SignalTrack {
  std::string name;
  bool initial = false;
  std::vector<float> toggles;  ///< seconds
  double truncated_s = -1.0;   ///< from here on it changed too often to be kept; -1: complete
};

/// Time that the machine spent on a line of the program.
struct LineTime {
  double first_s = 0.0;
  double total_s = 0.0;
};

/// A run in bounded memory, however long: what the HTML report draws.
struct RecordedRun {
  double period_s = 0.001;
  std::int64_t first_cycle = 0;
  double start_s = 0.0;  ///< of the first cycle
  double duration_s = 0.0;
  double bucket_s = 0.001;                   ///< length of a bucket of every series
  std::vector<std::string> axes;             ///< letters
  std::array<int, 3> view_axes{-1, -1, -1};  ///< axes behind x, y, z of the path; -1: none
  std::vector<Series> series;                ///< all of equal length
  std::vector<std::int32_t> line;            ///< line in motion at the end of each bucket
  PathLine path;
  double path_tolerance = 0.0;  ///< mm
  /// Every cycle, the whole run or its newest part and what is around alarms: X.position, X.error, X.derived
  /// (how many derivatives of the position are valid, 0 to 3), path.speed, spindle.cmd, spindle.act ..., and
  /// with a spindle thread.off (how far a thread or tap was off its angle, mm).
  std::vector<Channel> channels;
  std::vector<CycleStretch> stretches;
  std::vector<SignalTrack> signals;
  std::vector<FrameChange> frames;  ///< the newest 10 000
  std::map<std::int32_t, LineTime> line_times;
};

/// How much a RunRecorder keeps.
struct RunRecorderOptions {
  std::size_t max_buckets = 6000;      ///< then pairs of buckets are merged
  std::size_t max_vertices = 200'000;  ///< of the path; then the tolerance is doubled
  std::size_t max_toggles = 4000;      ///< per signal
  std::size_t max_bytes = 3'000'000;   ///< of every cycle, packed; then the oldest stretches go
  double path_tolerance = 0.001;       ///< mm, to start with
  std::array<int, 3> view_axes{0, 1,
                               2};      ///< plan: x to the right, y up; a lathe draws Z to the right and X up
  std::vector<std::string> axis_units;  ///< "mm" or "deg" per axis; missing: "mm"
};

/// Collects a run for the HTML report; a sink beside the CSV file. Read run() after TraceRecorder::close().
class RunRecorder final : public TraceSink {
 public:
  explicit RunRecorder(RunRecorderOptions options = {});
  ~RunRecorder() override;
  void begin(const TraceLayout& layout) override;
  void row(const TraceRow& row) override;
  void end(std::uint64_t dropped) override;
  const RecordedRun& run() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::report
