// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gateway/control/run/words/alarm_entries.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::gateway {

namespace {

constexpr std::string_view kFollowed[] = {
    "running", "held",     "m_strobe", "m_ack",       "s_strobe",      "s_ack",          "t_strobe",
    "t_ack",   "enabled",  "homed",    "in_position", "on_limit_plus", "on_limit_minus", "brake_release",
    "run",     "at_speed", "estop_ok", "power_on",    "ready",         "alarm"};

std::vector<std::string> phase_names() {
  std::vector<std::string> names;
  for (int p = 0; p < cycle::kPhases; ++p) names.emplace_back(cycle::name(static_cast<cycle::Phase>(p)));
  return names;
}

report::RunRecorderOptions picture_options(const machine::MachineConfig& m) {
  report::RunRecorderOptions options;
  const int x = m.axis_index("X"), z = m.axis_index("Z");
  if (x >= 0 && z >= 0 && m.axes[static_cast<std::size_t>(x)].diameter) options.view_axes = {z, x, -1};
  for (const machine::AxisConfig& a : m.axes) options.axis_units.emplace_back(a.unit());
  return options;
}

/// By process the spindle whose angle its threads follow: its first one; -1: it has none.
std::vector<int> leading_spindles(const machine::MachineConfig& machine) {
  std::vector<int> spindles(static_cast<std::size_t>(machine.control.processes), -1);
  for (std::size_t s = machine.spindles.size(); s-- > 0;)
    if (const auto p = static_cast<std::size_t>(machine.spindles[s].process - 1); p < spindles.size())
      spindles[p] = static_cast<int>(s);
  return spindles;
}

/// A frame is affine: where it takes the machine's zero and a step along each axis says it all.
report::WorkFrame work_frame(const machine::MachineConfig& machine, const program::Frame& frame) {
  report::WorkFrame out;
  const std::size_t axes = std::min(machine.program_axes(), out.size());
  for (std::size_t a = 0; a < axes; ++a) {
    const double shown = machine.axes[a].diameter ? 2.0 : 1.0;
    const int axis = static_cast<int>(a);
    const double zero = frame.to_programmed({}, axis);
    out[a].offset = zero * shown;
    for (std::size_t b = 0; b < axes; ++b) {
      program::Position step{};
      step[b] = 1.0;
      const double share = frame.to_programmed(step, axis) - zero;
      out[a].share[b] = std::abs(share) < 1e-12 ? 0.0 : share * shown;
    }
  }
  return out;
}

}  // namespace

std::vector<report::TraceSignal> trace_signals(const machine::MachineConfig& machine) {
  std::vector<report::TraceSignal> signals;
  for (const machine::StationConfig& station : machine.stations)
    for (const machine::PointConfig& p : station.points)
      if (!p.is_analog()) signals.push_back({p.name, p.place});
  for (const image::Symbol& s : machine.symbol_table()) {
    const std::size_t dot = s.name.find('.');
    if (dot == std::string::npos || s.place.format != image::Format::bl) continue;
    const std::string_view field = std::string_view(s.name).substr(dot + 1);
    if (std::find(std::begin(kFollowed), std::end(kFollowed), field) != std::end(kFollowed))
      signals.push_back({s.name, s.place});
  }
  if (signals.size() > report::kMaxTraceSignals) signals.resize(report::kMaxTraceSignals);
  return signals;
}

report::TraceLayout trace_layout(const machine::MachineConfig& machine) {
  report::TraceLayout layout;
  layout.period_ns = machine.cycle_ns();
  layout.axes = machine.letters();
  layout.spindles = static_cast<int>(machine.spindles.size());
  layout.processes = machine.control.processes;
  layout.signals = trace_signals(machine);
  return layout;
}

Session::Session(Control& control, const Outputs& outputs, bool realtime)
    : control_(control),
      layout_(trace_layout(control.machine())),
      sampled_(layout_),
      realtime_(realtime),
      statistics_(layout_),
      threads_(static_cast<int>(control.machine().axes.size()), leading_spindles(control.machine())),
      times_(phase_names()) {
  if (realtime) sync_late_.resize(control.suppliers().size());
  sampled_.signals.clear();
  std::vector<std::unique_ptr<report::TraceSink>> sinks;
  if (!outputs.trace.empty()) sinks.push_back(std::make_unique<report::CsvSink>(outputs.trace));
  if (!outputs.html.empty()) {
    auto picture = std::make_unique<report::RunRecorder>(picture_options(control.machine()));
    picture_ = picture.get();
    sinks.push_back(std::move(picture));
  }
  if (sinks.empty()) return;
  sampled_.signals = layout_.signals;
  layout_.frame_of = [this](int process, std::uint32_t run, std::int64_t blocks, report::WorkFrame& frame) {
    const auto found = control_.process(process).texts().frame(run, blocks);
    if (found) frame = work_frame(control_.machine(), *found);
    return found.has_value();
  };
  recorder_ = std::make_unique<report::TraceRecorder>(layout_, std::move(sinks));
}

Session::~Session() = default;

void Session::wait_for_room() {
  if (recorder_ != nullptr) recorder_->wait_for_room();
}

void Session::after_cycle(image::Nanoseconds late_ns) noexcept {
  const cycle::Cycle& cycle = control_.cycle();
  report::sample(cycle.image(), sampled_, row_);
  statistics_.add(row_);
  threads_.add(cycle.image());
  if (cycle.measured()) times_.add(cycle.duration_ns(), late_ns, cycle.phase_ns().data());
  time_sync();
  if (recorder_ != nullptr) recorder_->record(row_);
}

// How late each SYNC was against the absolute time of its cycle, and how far apart those of several buses.
void Session::time_sync() noexcept {
  const auto due = control_.due_ns();
  if (!due || sync_late_.empty()) return;
  image::Nanoseconds first = std::numeric_limits<image::Nanoseconds>::max(), last = 0;
  for (std::size_t b = 0; b < sync_late_.size(); ++b) {
    const image::Nanoseconds sent = control_.suppliers()[b]->sync_ns();
    sync_late_[b].add(sent - *due);
    first = std::min(first, sent);
    last = std::max(last, sent);
  }
  sync_skew_.add(last - first);
}

std::string Session::close() {
  if (recorder_ == nullptr) return {};
  recorder_->close();
  for (const auto& sink : recorder_->sinks())
    if (std::string error = sink->error(); !error.empty()) return error;
  return {};
}

const report::RecordedRun* Session::picture() const {
  return picture_ != nullptr ? &picture_->run() : nullptr;
}

namespace {

/// Each touch of all processes, for every axis that its motion moved.
std::vector<report::Touch> touches_of(Control& control) {
  constexpr double kMoves = 1e-6;
  std::vector<report::Touch> touches;
  const std::size_t axes = control.machine().axes.size();
  for (int p = 0; p < control.machine().control.processes; ++p)
    for (const channel::TouchPlace& t : control.process(p).feeder().touch_log().all()) {
      const auto moves = [&t](std::size_t a) { return std::abs(t.to[a] - t.from[a]) > kMoves; };
      report::Touch touch;
      touch.feed_mm_min = t.feed_mm_min;
      for (std::size_t a = 0; a < axes; ++a) touch.beside[a] = moves(a) ? t.at[a] : t.from[a];
      for (std::size_t a = 0; a < axes; ++a) {
        if (!moves(a)) continue;
        report::Touch of_axis = touch;
        of_axis.axis = static_cast<int>(a);
        of_axis.direction = t.to[a] > t.from[a] ? 1 : -1;
        of_axis.at = std::exchange(of_axis.beside[a], 0.0);
        touches.push_back(of_axis);
      }
    }
  return touches;
}

std::vector<report::TouchGroup> touch_groups(Control& control) {
  std::vector<report::TouchGroup> groups = report::grouped(touches_of(control));
  for (report::TouchGroup& g : groups) {
    const machine::AxisConfig& axis = control.machine().axes[static_cast<std::size_t>(g.axis)];
    g.letter = axis.letter;
    g.unit = axis.unit();
    g.diameter = axis.diameter;
  }
  return groups;
}

std::vector<report::ThreadPass> thread_passes(Control& control, const report::ThreadLog& log) {
  std::vector<report::ThreadPass> passes = log.passes();
  for (report::ThreadPass& pass : passes) {
    if (pass.axis >= 0) pass.letter = control.machine().axes[static_cast<std::size_t>(pass.axis)].letter;
    if (pass.file != 0) pass.file_name = control.process(pass.process).texts().file(pass.run, pass.file);
  }
  return passes;
}

}  // namespace

report::Report Session::make_report(double wall_s, std::int64_t overruns) const {
  report::Report r;
  const cycle::Cycle& cycle = control_.cycle();
  const machine::MachineConfig& m = control_.machine();
  const image::ProcessImage& image = cycle.image();
  r.cycles = cycle.count();
  r.time_s = static_cast<double>(cycle.count() * cycle.period_ns()) / 1e9;
  r.overruns = overruns;
  bool began = false, open = false;
  for (int p = 0; p < image.process_count; ++p) {
    const image::ProcessStatus& status = image.processes[static_cast<std::size_t>(p)];
    r.starved += status.starved;
    r.blocks += status.blocks_done;
    began = began || status.run != 0;
    open = open || (status.run != 0 && status.state != image::ProcessState::ended);
  }
  r.finished = began && !open;
  r.virtual_speed = wall_s > 0.0 ? r.time_s / wall_s : 0.0;
  // In both languages: the page has a switch.
  r.alarms = alarm_entries(control_, cycle.alarms().history(), text::Language::english);
  const auto russian = alarm_entries(control_, cycle.alarms().history(), text::Language::russian);
  for (std::size_t n = 0; n < r.alarms.size(); ++n) {
    r.alarms[n].text = text::both(r.alarms[n].text, russian[n].text);
    r.alarms[n].remedy = text::both(r.alarms[n].remedy, russian[n].remedy);
  }
  report::fill_axes(r, layout_, statistics_);
  for (std::size_t a = 0; a < r.axes.size() && a < m.axes.size(); ++a) {
    const machine::AxisConfig& axis = m.axes[a];
    r.axes[a].unit = axis.unit();
    r.axes[a].diameter = axis.diameter;
    r.axes[a].limit_velocity = axis.max_velocity;
    r.axes[a].limit_acceleration = axis.max_acceleration;
    r.axes[a].limit_jerk = axis.max_jerk;
    if (!axis.endless()) {
      r.axes[a].travel_min = axis.travel_min;
      r.axes[a].travel_max = axis.travel_max;
    }
    r.axes[a].limit_following_error =
        axis.following_error_stop + axis.following_error_velocity * axis.max_velocity;
  }
  r.touches = touch_groups(control_);
  r.threads = thread_passes(control_, threads_);
  report::fill_cycle_times(r, times_, realtime_);
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const image::SegmentStatus& s = image.segments[b];
    r.segments.push_back(
        {m.buses[b].name, s.load, s.load_worst_cycle, s.frames_sent, s.frames_received, s.errors, {}});
    if (b < sync_late_.size() && sync_late_[b].count() > 0)
      r.segments.back().sync = report::sync_report(sync_late_[b]);
    r.provenance.buses.push_back({m.buses[b].name, m.buses[b].url, m.buses[b].mock()});
  }
  if (sync_late_.size() > 1) r.sync_skew_us = report::quantiles_us(sync_skew_);
  for (const machine::StationConfig& s : m.stations)  // what comes over a segment is in its nodes
    if (!s.over_bus())
      r.provenance.buses.push_back(
          {s.name, s.url, s.mock(),
           std::string(machine::choices_of<machine::StationKind>()[static_cast<std::size_t>(s.kind)])});
  for (std::size_t s = 0; s < control_.suppliers().size(); ++s) {
    const canopen::Segment& segment = control_.suppliers()[s]->segment();
    for (std::size_t n = 0; n < segment.config().nodes.size(); ++n) {
      const canopen::NodeStatus status = segment.node_status(n);
      r.provenance.nodes.push_back({segment.config().name, status.node, segment.config().nodes[n].name,
                                    status.vendor_id, status.product_code, status.revision, status.serial});
    }
  }
  if (recorder_ != nullptr) r.trace_dropped = recorder_->dropped();
  return r;
}

}  // namespace servogate::gateway
