// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "report/record/path_thinning.hpp"
#include "report/recorded_run.hpp"
#include "report/statistics.hpp"
#include "report/work_places.hpp"

namespace servogate::report {

namespace {

constexpr std::size_t kMaxLines = 200'000;
constexpr std::size_t kPerAxis = 5;
constexpr std::size_t kMaxFrames = 10'000;

template <typename T, typename Merge>
void halve(std::vector<T>& v, Merge merge) {
  for (std::size_t n = 0; n < v.size(); n += 2) v[n / 2] = n + 1 < v.size() ? merge(v[n], v[n + 1]) : v[n];
  v.resize((v.size() + 1) / 2);
}

float least(float a, float b) { return std::min(a, b); }
float greatest(float a, float b) { return std::max(a, b); }

}  // namespace

struct RunRecorder::Impl {
  RunRecorderOptions options;
  RecordedRun run;
  TraceLayout layout;
  BoundedPath path;
  std::vector<AxisStatistics> axes;
  std::vector<float> values;  ///< of the present cycle, in the order of run.series
  std::optional<EveryCycle> every;
  std::optional<WorkPlaces> places;
  std::vector<double> cycle_values;  ///< of the present cycle, in the order of its channels
  std::uint32_t alarms = 0;
  std::vector<bool> signal_states;
  std::array<bool, 2 * image::kMaxAxes> axis_states{};  ///< enabled and homed of the last row
  bool started = false;
  std::int64_t first_cycle = 0, last_cycle = 0, stride = 1;
  std::map<std::int32_t, LineTime>::iterator line_time;
  bool line_known = false;

  explicit Impl(RunRecorderOptions o)
      : options(std::move(o)), path(options.max_vertices, options.path_tolerance) {
    options.max_buckets = std::max<std::size_t>(options.max_buckets, 16);
  }

  void name_series();
  void name_channels();
  void keep_cycle(const TraceRow& row);
  float deviation(const TraceRow& row) const;
  void measure(const TraceRow& row);
  void store(std::int64_t cycle, std::int32_t line);
  void halve_all();
  StretchKind kind(const TraceRow& row);
  void follow_path(const TraceRow& row);
  void follow_signals(const TraceRow& row);
  void follow_line(const TraceRow& row);
  void follow_frame(const TraceRow& row);
};

void RunRecorder::Impl::name_series() {
  for (std::size_t a = 0; a < run.axes.size(); ++a) {
    const std::string unit = a < options.axis_units.size() ? options.axis_units[a] : "mm";
    const std::string& letter = run.axes[a];
    run.series.push_back({letter + ".position", unit, {}, {}});
    run.series.push_back({letter + ".velocity", unit + "/s", {}, {}});
    run.series.push_back({letter + ".acceleration", unit + "/s²", {}, {}});
    run.series.push_back({letter + ".jerk", unit + "/s³", {}, {}});
    run.series.push_back({letter + ".error", unit, {}, {}});
  }
  run.series.push_back({"path.speed", "mm/s", {}, {}});
  for (int s = 0; s < layout.spindles; ++s) {
    const std::string name = s == 0 ? "spindle" : "spindle" + std::to_string(s + 1);
    run.series.push_back({name + ".cmd", "rpm", {}, {}});
    run.series.push_back({name + ".act", "rpm", {}, {}});
  }
  if (layout.spindles > 0) run.series.push_back({"thread.off", "mm", {}, {}});
  values.resize(run.series.size());
}

void RunRecorder::Impl::name_channels() {
  // A jerk is a third difference: at short cycles a position has to be finer for the same jerk.
  const double ratio = std::min(1.0, run.period_s / 1e-3);
  const double position = std::max(1e-12, 1e-9 * ratio * ratio * ratio);
  for (const std::string& letter : run.axes) {
    run.channels.push_back({letter + ".position", position, 3});
    run.channels.push_back({letter + ".error", 1e-6, 2});
    run.channels.push_back({letter + ".derived", 1, 1});
  }
  run.channels.push_back({"path.speed", 1e-4, 2});
  for (std::size_t n = kPerAxis * run.axes.size() + 1; n < run.series.size(); ++n)
    run.channels.push_back({run.series[n].name, run.series[n].unit == "mm" ? 1e-6 : 1e-2, 1});
  every.emplace(run.channels, options.max_bytes);
  cycle_values.resize(run.channels.size());
}

void RunRecorder::Impl::keep_cycle(const TraceRow& row) {
  std::size_t n = 0;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    cycle_values[n++] = row.axes[a].command;
    cycle_values[n++] = row.axes[a].enabled ? row.axes[a].following_error : 0.0;
    cycle_values[n++] = axes[a].derived();
  }
  cycle_values[n++] = row.feed_mm_s;
  for (std::size_t s = 0; s < static_cast<std::size_t>(layout.spindles); ++s) {
    cycle_values[n++] = row.spindles[s].command_rpm;
    cycle_values[n++] = row.spindles[s].actual_rpm;
  }
  if (layout.spindles > 0) cycle_values[n] = row.off_spindle_mm;
  every->add(row.cycle, cycle_values, row.alarms > alarms);
  alarms = row.alarms;
}

/// What of the following error lies across the direction of motion; all of it at rest.
float RunRecorder::Impl::deviation(const TraceRow& row) const {
  double error2 = 0.0, velocity2 = 0.0, product = 0.0;
  for (const int axis : run.view_axes) {
    if (axis < 0) continue;
    const auto a = static_cast<std::size_t>(axis);
    if (!row.axes[a].enabled) return 0.0f;
    const double e = row.axes[a].following_error, v = axes[a].derivatives()[0];
    error2 += e * e;
    velocity2 += v * v;
    product += e * v;
  }
  const double along2 = velocity2 > 1e-6 ? product * product / velocity2 : 0.0;
  return static_cast<float>(std::sqrt(std::max(0.0, error2 - along2)));
}

void RunRecorder::Impl::measure(const TraceRow& row) {
  for (std::size_t a = 0; a < axes.size(); ++a) {
    axes[a].add(row.cycle, run.period_s, row.axes[a]);
    float* v = &values[kPerAxis * a];
    v[0] = static_cast<float>(row.axes[a].command);
    for (std::size_t order = 0; order < 3; ++order)
      v[1 + order] = static_cast<float>(axes[a].derivatives()[order]);
    v[4] = static_cast<float>(row.axes[a].enabled ? row.axes[a].following_error : 0.0);
  }
  std::size_t n = kPerAxis * axes.size();
  values[n++] = static_cast<float>(row.feed_mm_s);
  for (std::size_t s = 0; s < static_cast<std::size_t>(layout.spindles); ++s) {
    values[n++] = static_cast<float>(row.spindles[s].command_rpm);
    values[n++] = static_cast<float>(row.spindles[s].actual_rpm);
  }
  if (layout.spindles > 0) values[n] = static_cast<float>(row.off_spindle_mm);
}

void RunRecorder::Impl::halve_all() {
  for (Series& s : run.series) {
    halve(s.low, least);
    halve(s.high, greatest);
  }
  halve(run.line, [](std::int32_t, std::int32_t later) { return later; });
  stride *= 2;
}

void RunRecorder::Impl::store(std::int64_t cycle, std::int32_t line) {
  auto bucket = static_cast<std::size_t>((cycle - first_cycle) / stride);
  while (bucket >= options.max_buckets) {
    halve_all();
    bucket = static_cast<std::size_t>((cycle - first_cycle) / stride);
  }
  const bool fresh = bucket >= run.line.size();
  run.line.resize(std::max(run.line.size(), bucket + 1), run.line.empty() ? line : run.line.back());
  run.line[bucket] = line;
  for (std::size_t n = 0; n < run.series.size(); ++n) {
    Series& s = run.series[n];
    const float v = values[n];
    if (fresh) {  // rows that were dropped leave the last value standing
      s.low.resize(bucket + 1, s.low.empty() ? v : s.low.back());
      s.high.resize(bucket + 1, s.high.empty() ? v : s.high.back());
      s.low[bucket] = s.high[bucket] = v;
    } else {
      s.low[bucket] = std::min(s.low[bucket], v);
      s.high[bucket] = std::max(s.high[bucket], v);
    }
  }
}

StretchKind RunRecorder::Impl::kind(const TraceRow& row) {
  bool jump = false;
  for (const int axis : run.view_axes) {
    if (axis < 0) continue;
    const auto a = static_cast<std::size_t>(axis);
    jump |= !row.axes[a].enabled || axis_states[2 * a] != row.axes[a].enabled ||
            axis_states[2 * a + 1] != row.axes[a].homed;
    axis_states[2 * a] = row.axes[a].enabled;
    axis_states[2 * a + 1] = row.axes[a].homed;
  }
  return jump ? StretchKind::jump : row.rapid || row.line <= 0 ? StretchKind::rapid : StretchKind::feed;
}

void RunRecorder::Impl::follow_path(const TraceRow& row) {
  const auto coordinate = [&](std::size_t which) {
    const int axis = run.view_axes[which];
    return axis < 0 ? 0.0f : static_cast<float>(row.axes[static_cast<std::size_t>(axis)].command);
  };
  path.add({coordinate(0), coordinate(1), coordinate(2),
            static_cast<float>(static_cast<double>(row.t_ns) * 1e-9), static_cast<float>(row.feed_mm_s),
            row.line, kind(row), deviation(row), row.tool});
}

void RunRecorder::Impl::follow_signals(const TraceRow& row) {
  const double t = static_cast<double>(row.t_ns) * 1e-9;
  for (std::size_t n = 0; n < run.signals.size(); ++n) {
    const bool on = row.signal(n);
    SignalTrack& track = run.signals[n];
    if (!started) track.initial = on;
    if (!started || on != signal_states[n]) {
      signal_states[n] = on;
      if (!started || track.truncated_s >= 0) continue;
      if (track.toggles.size() < options.max_toggles)
        track.toggles.push_back(static_cast<float>(t));
      else
        track.truncated_s = t;
    }
  }
}

void RunRecorder::Impl::follow_line(const TraceRow& row) {
  if (row.line <= 0) return;
  if (!line_known || line_time->first != row.line) {
    if (run.line_times.size() >= kMaxLines && !run.line_times.contains(row.line)) return;
    line_time =
        run.line_times.try_emplace(row.line, LineTime{static_cast<double>(row.t_ns) * 1e-9, 0.0}).first;
    line_known = true;
  }
  line_time->second.total_s += run.period_s;
}

void RunRecorder::Impl::follow_frame(const TraceRow& row) {
  if (!places || !places->follow(row)) return;
  FrameChange change{static_cast<double>(row.t_ns) * 1e-9, {}};
  for (std::size_t a = 0; a < run.axes.size(); ++a)
    change.axes.push_back(places->known(a) ? std::optional(places->axis(a)) : std::nullopt);
  if (!run.frames.empty() && run.frames.back().axes == change.axes) return;
  if (run.frames.size() >= kMaxFrames) run.frames.erase(run.frames.begin());
  run.frames.push_back(std::move(change));
}

RunRecorder::RunRecorder(RunRecorderOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
RunRecorder::~RunRecorder() = default;

void RunRecorder::begin(const TraceLayout& layout) {
  Impl& i = *impl_;
  i.layout = layout;
  i.layout.axes.resize(std::min<std::size_t>(layout.axes.size(), image::kMaxAxes));
  i.layout.signals.resize(std::min<std::size_t>(layout.signals.size(), kMaxTraceSignals));
  i.layout.spindles = std::clamp(layout.spindles, 0, image::kMaxSpindles);
  i.run.period_s = i.run.bucket_s = static_cast<double>(layout.period_ns) * 1e-9;
  i.run.axes = i.layout.axes;
  for (std::size_t n = 0; n < 3; ++n) {
    const int axis = i.options.view_axes[n];
    i.run.view_axes[n] = axis >= 0 && axis < static_cast<int>(i.run.axes.size()) ? axis : -1;
  }
  i.axes.resize(i.run.axes.size());
  for (const TraceSignal& s : i.layout.signals) i.run.signals.push_back({s.name, false, {}, -1.0});
  i.signal_states.resize(i.layout.signals.size());
  if (i.layout.frame_of) i.places.emplace(i.layout);
  i.name_series();
  i.name_channels();
}

void RunRecorder::row(const TraceRow& row) {
  Impl& i = *impl_;
  if (!i.started) {
    i.first_cycle = i.run.first_cycle = row.cycle;
    i.run.start_s = static_cast<double>(row.t_ns) * 1e-9;
  }
  i.measure(row);
  i.keep_cycle(row);
  i.store(row.cycle, row.line);
  i.follow_path(row);
  i.follow_signals(row);
  i.follow_line(row);
  i.follow_frame(row);
  i.last_cycle = row.cycle;
  i.started = true;
}

void RunRecorder::end(std::uint64_t) {
  Impl& i = *impl_;
  i.path.finish();
  if (i.every) {
    i.every->finish();
    i.run.stretches.assign(i.every->stretches().begin(), i.every->stretches().end());
  }
  i.run.path_tolerance = i.path.tolerance();
  i.run.bucket_s = i.run.period_s * static_cast<double>(i.stride);
  if (i.started) i.run.duration_s = static_cast<double>(i.last_cycle - i.first_cycle + 1) * i.run.period_s;
  for (const PathVertex& v : i.path.vertices()) {
    i.run.path.x.push_back(v.x);
    i.run.path.y.push_back(v.y);
    i.run.path.z.push_back(v.z);
    i.run.path.t.push_back(v.t);
    i.run.path.speed.push_back(v.speed);
    i.run.path.line.push_back(v.line);
    i.run.path.rapid.push_back(static_cast<std::uint8_t>(v.kind));
    i.run.path.deviation.push_back(v.deviation);
    i.run.path.tool.push_back(v.tool);
  }
}

const RecordedRun& RunRecorder::run() const { return impl_->run; }

}  // namespace servogate::report
