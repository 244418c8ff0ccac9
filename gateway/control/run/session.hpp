// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "report/html.hpp"
#include "report/recorded_run.hpp"
#include "report/report.hpp"
#include "report/statistics.hpp"
#include "report/trace.hpp"

namespace servogate::gateway {

/// What is kept of a run beside the machine itself: statistics, trace, picture.
struct Outputs {
  std::string trace, report, html;
};

/// Watches a Control cycle by cycle and makes trace, statistics, report and HTML page of it.
class Session {
 public:
  Session(Control& control, const Outputs& outputs, bool realtime);
  ~Session();

  /// Before a cycle of virtual time: waits until the writer has room.
  void wait_for_room();
  /// After every cycle. real-time safe.
  void after_cycle(image::Nanoseconds late_ns) noexcept;
  /// Ends the writers; the rest only after this. Returns what went wrong while writing, empty: nothing.
  std::string close();

  /// The report of the run so far, without provenance of files.
  report::Report make_report(double wall_s, std::int64_t overruns) const;
  const report::RecordedRun* picture() const;
  const report::CycleTimes& times() const noexcept { return times_; }

 private:
  void time_sync() noexcept;

  Control& control_;
  report::TraceLayout layout_;
  report::TraceLayout sampled_;  ///< what a row is filled with: signals only where somebody records them
  bool realtime_;
  report::RunStatistics statistics_;
  report::ThreadLog threads_;
  report::CycleTimes times_;
  std::vector<report::Histogram> sync_late_;  ///< by bus; real time only
  report::Histogram sync_skew_;
  report::TraceRow row_;
  std::unique_ptr<report::TraceRecorder> recorder_;
  report::RunRecorder* picture_ = nullptr;  ///< one of the recorder's sinks
};

/// Signals of a machine that trace and report follow: all digital points, and the interface places a person
/// looks for.
std::vector<report::TraceSignal> trace_signals(const machine::MachineConfig& machine);

/// The columns of a machine's trace.
report::TraceLayout trace_layout(const machine::MachineConfig& machine);

}  // namespace servogate::gateway
