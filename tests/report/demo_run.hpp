// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "report/html.hpp"

namespace servogate::report {

/// A made-up but smooth run of a three-axis mill: rapids, a rounded rectangle, a helix, dwells, spindle and
/// signals.
struct DemoRun {
  TraceLayout layout;
  std::vector<TraceRow> rows;
  std::string program;
};
DemoRun demo_run(double seconds = 20.0);
/// The rows through a RunRecorder.
RecordedRun recorded(const DemoRun& demo, const RunRecorderOptions& options = {});
/// A report with every kind of entry filled; `alarms` of them.
Report demo_report(const DemoRun& demo, int alarms = 0);

}  // namespace servogate::report
