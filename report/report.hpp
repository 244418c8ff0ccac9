// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/alarms/alarm_table.hpp"
#include "firmware_if/text/finding.hpp"
#include "report/statistics.hpp"
#include "report/threads.hpp"
#include "report/touches.hpp"

namespace servogate::report {

inline constexpr int kReportSchema = 1;

/// A file that took part, and the SHA-256 of its bytes (64 hex digits; empty when it could not be read).
struct FileIdentity {
  std::string path;
  std::string sha256;
};

/// One bus as it was wired: a CAN segment, a Modbus station, a GPIO chip.
struct BusProvenance {
  std::string name;       ///< as in the machine file
  std::string transport;  ///< "mock:can0", "socketcan:can0", "tcp:10.0.0.7:502", "chip:gpiochip0" ...
  bool mock = true;
  std::string protocol = "canopen";  ///< "canopen", "modbus", "gpio"
};

/// Identity object 1018h of a node, or its like.
struct NodeIdentity {
  std::string bus;
  int node = 0;
  std::string name;
  std::uint32_t vendor = 0, product = 0, revision = 0, serial = 0;
};

/// Where a report comes from (docs/architecture.md, rule 12).
struct Provenance {
  std::string version;  ///< see build_identity()
  std::string commit;
  std::optional<FileIdentity> machine;
  std::optional<FileIdentity> program;
  std::vector<FileIdentity> plc;
  std::string dialect;
  std::uint64_t seed = 0;
  std::string clock;  ///< "virtual", "realtime", "realtime=best-effort"
  std::vector<BusProvenance> buses;
  std::string kernel;  ///< see fill_host()
  std::string processor;
  std::vector<NodeIdentity> nodes;
  std::vector<std::string> command_line;
};

/// An alarm with the words of the one table; a run's report has them in both languages (text::both()).
struct AlarmEntry {
  image::AlarmRecord record;
  std::string id;
  std::string text;
  std::string remedy;
  std::string axis;                          ///< letter, empty: none
  std::vector<image::AlarmFact> facts = {};  ///< what its device and its room say of it
  bool consequence = false;                  ///< stands behind its first fault
  std::optional<text::Finding> finding;      ///< of a program error: file, line, column and words
};

/// What the program waited for when the run was given up because nothing moved any more.
struct WaitEntry {
  std::string reason;
  std::string text;
  std::string remedy;
  std::string file;
  int line = 0;
  double for_s = 0.0;
};

/// Why there was no run, or the control refused it: code and words.
struct ErrorEntry {
  std::string code, text;
};

/// A variable or place that was held at a value.
struct ForceEntry {
  std::string name, value;
};

/// One axis: what was met, and what the machine file allows (0: no limit known).
struct AxisReport {
  std::string letter;
  std::string unit = "mm";  ///< "mm" or "deg"
  bool diameter = false;    ///< people read and write diameters; all values here are of the radius
  double max_velocity = 0.0, max_acceleration = 0.0, max_jerk = 0.0, max_following_error = 0.0;
  double limit_velocity = 0.0, limit_acceleration = 0.0, limit_jerk = 0.0, limit_following_error = 0.0;
  double travel_min = 0.0, travel_max = 0.0;  ///< both 0: without end
};

/// Quantiles of a histogram in microseconds.
struct Quantiles {
  double p50 = 0.0, p99 = 0.0, p999 = 0.0, max = 0.0;
};
Quantiles quantiles_us(const Histogram& histogram);

struct PhaseReport {
  std::string name;
  Quantiles us;
};

/// How late the SYNC of a segment was handed to its bus, against the absolute time of its cycle.
struct SyncReport {
  Quantiles us;
  /// So many were at least `from` and less than `to` late; `to` is twice `from`, but for the first band.
  struct Band {
    double from_us = 0.0, to_us = 0.0;
    std::uint64_t count = 0;
  };
  std::vector<Band> bands;
};
SyncReport sync_report(const Histogram& lateness);

/// Load of one bus segment; ratios 0-1.
struct SegmentReport {
  std::string name;
  double load = 0.0;
  double load_worst_cycle = 0.0;
  std::uint64_t frames_sent = 0, frames_received = 0, errors = 0;
  std::optional<SyncReport> sync;  ///< real time only
};

/// One run, from the first cycle to the last.
struct Report {
  Provenance provenance;
  bool finished = false;  ///< the program came to its end (M02, M30, last line)
  bool stopped = false;   ///< whoever ran it ended it
  double time_s = 0.0;    ///< machine time from cycle 0
  std::int64_t cycles = 0;
  std::int64_t overruns = 0;
  std::int64_t starved = 0;
  std::int64_t blocks = 0;           ///< executed, each time they ran, up to the one in motion at the end
  std::int64_t blocks_expected = 0;  ///< of a dry run, whose branches may differ; 0: not known
  std::optional<WaitEntry> wait;
  std::optional<ErrorEntry> error;  ///< no cycle ran (a bad file, a bus that does not open, missing rights),
                                    ///< or the control refused it, or its axes did not become ready
  std::vector<text::Finding> findings;  ///< errors for which the program was not begun
  std::vector<AlarmEntry> alarms;
  std::vector<ForceEntry> forces;  ///< held from before the first motion to the end
  std::vector<AxisReport> axes;
  std::vector<TouchGroup> touches;  ///< of probes
  std::vector<ThreadPass> threads;  ///< and taps, in the order in which they began
  double virtual_speed = 0.0;       ///< simulated seconds per second
  Quantiles cycle_us;
  std::optional<Quantiles> lateness_us;  ///< real time only
  std::vector<PhaseReport> phases;
  std::vector<SegmentReport> segments;
  std::optional<Quantiles>
      sync_skew_us;  ///< between the first and the last SYNC of a cycle, of several segments
  std::uint64_t trace_dropped = 0;
};

/// Copies the maxima of a run into report.axes (same order, at least as many axes as `statistics` has are
/// made).
void fill_axes(Report& report, const TraceLayout& layout, const RunStatistics& statistics);
/// Copies durations, lateness and phases into the report. `realtime` false leaves lateness out.
void fill_cycle_times(Report& report, const CycleTimes& times, bool realtime);

/// What came of a run and why: what page and JSON say first.
struct Verdict {
  std::string_view
      outcome;  ///< "finished", "refused", "not_begun", "waited", "alarm", "stopped", "unfinished"
  std::string text;
  std::string remedy;  ///< empty: none is known
};
Verdict verdict_of(const Report& report, text::Language language = text::user_language());

/// The report as JSON in the user's language, `schema` first, indented, ended by a newline. Numbers that are
/// not finite become null.
std::string to_json(const Report& report);

/// SHA-256 as 64 hex digits.
std::string sha256(std::string_view bytes);
/// The same of a file; nullopt when it cannot be read.
std::optional<std::string> sha256_of_file(const std::string& path);
/// Path and hash together; the hash is empty when the file cannot be read.
FileIdentity identify(const std::string& path);

/// Version and commit of this build; a commit ends with "+" when the tree was changed beside it, and is empty
/// for a build outside version control.
struct BuildIdentity {
  std::string_view version;
  std::string_view commit;
};
BuildIdentity build_identity();

/// Fills version, commit, kernel and processor from this build and this computer.
void fill_host(Provenance& provenance);

}  // namespace servogate::report
