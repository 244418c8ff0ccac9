// SPDX-License-Identifier: Apache-2.0
#include "tests/report/demo_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace servogate::report {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kPeriod = 0.001;

/// A stretch from here to there in a given time, by a smooth law (quintic): line when radius is 0, else a
/// helix turn.
struct Stretch {
  std::array<double, 3> to;
  double seconds;
  bool rapid;
  double turns = 0.0;
  const char* block;
};

constexpr Stretch kStretches[] = {
    {{60, 40, 50}, 0.8, true, 0, "N10 G00 X60 Y40 Z50"},
    {{60, 40, 50}, 0.8, false, 0, "N20 M3 S3000"},
    {{60, 40, 2}, 0.7, true, 0, "N30 G00 Z2"},
    {{60, 40, -4}, 0.6, false, 0, "N40 G01 Z-4 F600"},
    {{160, 40, -4}, 1.6, false, 0, "N50 X160"},
    {{160, 100, -4}, 1.0, false, 0, "N60 Y100"},
    {{60, 100, -4}, 1.6, false, 0, "N70 X60"},
    {{60, 40, -4}, 1.0, false, 0, "N80 Y40"},
    {{60, 40, 10}, 0.6, true, 0, "N90 G00 Z10"},
    {{130, 70, 10}, 0.95, true, 0, "N100 X130 Y70"},
    {{130, 70, 0}, 0.45, true, 0, "N110 Z0"},
    {{130, 70, -12}, 7.2, false, 4, "N120 G03 I-20 J0 K3 Z-12"},
    {{130, 70, 50}, 0.9, true, 0, "N130 G00 Z50"},
    {{0, 0, 50}, 1.0, true, 0, "N140 X0 Y0"},
    {{0, 0, 50}, 0.6, false, 0, "N150 M5"},
};

double smooth(double s) { return s * s * s * (10 + s * (-15 + 6 * s)); }

std::array<double, 3> place(const Stretch& s, const std::array<double, 3>& from, double ratio) {
  const double k = smooth(std::clamp(ratio, 0.0, 1.0));
  std::array<double, 3> at;
  for (std::size_t a = 0; a < 3; ++a) at[a] = from[a] + k * (s.to[a] - from[a]);
  if (s.turns > 0) {
    at[0] = from[0] - 20 + 20 * std::cos(2 * kPi * s.turns * k);
    at[1] = from[1] + 20 * std::sin(2 * kPi * s.turns * k);
  }
  return at;
}

struct Machine {
  DemoRun& demo;
  std::array<double, 3> last{}, actual{};
  double spindle = 0.0;

  void cycle(const std::array<double, 3>& at, int line, bool rapid, bool spindle_on) {
    TraceRow row;
    row.cycle = static_cast<std::int64_t>(demo.rows.size());
    row.t_ns = row.cycle * demo.layout.period_ns;
    row.line = line;
    row.rapid = rapid;
    row.tool = line <= 9 ? 1 : 2;
    row.alarms = row.cycle >= 9000 ? 1 : 0;
    double speed2 = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double v = (at[a] - last[a]) / kPeriod;
      speed2 += v * v;
      actual[a] += (at[a] - actual[a]) * 0.25;
      row.axes[a] = {at[a], actual[a], at[a] - actual[a], v, 0.0, true, true};
    }
    last = at;
    row.feed_mm_s = std::sqrt(speed2);
    spindle += ((spindle_on ? 3000.0 : 0.0) - spindle) * 0.006;
    row.spindles[0] = {spindle_on ? 3000.0 : 0.0, spindle};
    const bool bits[] = {
        true,  spindle_on, std::fabs(spindle - 3000) < 60, line >= 4 && line <= 12, rapid, line % 5 == 2,
        false, true};
    for (std::size_t n = 0; n < std::size(bits); ++n)
      if (bits[n]) row.signals[0] |= std::uint64_t{1} << n;
    demo.rows.push_back(row);
  }
};

}  // namespace

DemoRun demo_run(double seconds) {
  DemoRun demo;
  demo.layout.axes = {"X", "Y", "Z"};
  demo.layout.spindles = 1;
  for (const char* name :
       {"MC.power_on", "S.run", "S.at_speed", "coolant", "NC.rapid", "NC.m_strobe", "door_open", "estop_ok"})
    demo.layout.signals.push_back(
        {name, *image::parse_place("SA" + std::to_string(demo.layout.signals.size()))});
  for (const Stretch& s : kStretches) demo.program += std::string(s.block) + "\n";
  demo.program += "N160 M30\n";
  Machine machine{demo};
  machine.last = machine.actual = {0, 0, 50};
  std::array<double, 3> from{0, 0, 50};
  while (static_cast<double>(demo.rows.size()) * kPeriod < seconds) {
    int line = 0;
    bool spindle_on = false;
    for (const Stretch& s : kStretches) {
      ++line;
      if (line == 2) spindle_on = true;
      if (line == 15) spindle_on = false;
      const int cycles = static_cast<int>(s.seconds / kPeriod);
      for (int n = 1; n <= cycles; ++n)
        machine.cycle(place(s, from, static_cast<double>(n) / cycles), line, s.rapid, spindle_on);
      from = place(s, from, 1.0);
    }
  }
  return demo;
}

RecordedRun recorded(const DemoRun& demo, const RunRecorderOptions& options) {
  RunRecorder recorder(options);
  recorder.begin(demo.layout);
  for (const TraceRow& row : demo.rows) recorder.row(row);
  recorder.end(0);
  return recorder.run();
}

Report demo_report(const DemoRun& demo, int alarms) {
  Report r;
  fill_host(r.provenance);
  r.provenance.machine = FileIdentity{"examples/mill/machine.toml", sha256("machine")};
  r.provenance.program = FileIdentity{"examples/mill/bracket.nc", sha256(demo.program)};
  r.provenance.plc = {{"examples/mill/mill.st", sha256("plc")}};
  r.provenance.dialect = "nc110";
  r.provenance.seed = 42;
  r.provenance.clock = "virtual";
  r.provenance.buses = {{"can", "mock:can0", true}, {"io", "mock:modbus", true}};
  r.provenance.nodes = {{"can", 1, "X drive", 0x1234, 0x5678, 0x10001, 1001}};
  r.provenance.command_line = {"servogate", "run", "examples/mill/machine.toml", "examples/mill/bracket.nc"};
  r.finished = alarms == 0;
  r.forces = {{"door_closed", "TRUE"}};
  r.cycles = static_cast<std::int64_t>(demo.rows.size());
  r.time_s = static_cast<double>(r.cycles) * kPeriod;
  r.blocks = 16;
  r.virtual_speed = 412.5;
  RunStatistics statistics(demo.layout);
  for (const TraceRow& row : demo.rows) statistics.add(row);
  fill_axes(r, demo.layout, statistics);
  for (AxisReport& a : r.axes) {
    a.limit_velocity = 500;
    a.limit_acceleration = 1000;
    a.limit_jerk = 10000;
    a.limit_following_error = 2;
    a.travel_min = -300;
    a.travel_max = 300;
  }
  ThreadPass thread;
  thread.line = 120;
  thread.letter = "Z";
  thread.axis = 2;
  thread.duration_s = 2.0;
  thread.revolutions = 20.0;
  thread.speed_min_rpm = 594.0;
  thread.speed_max_rpm = 606.0;
  thread.lead = 1.50013;
  thread.off_least = -0.0023;
  thread.off_greatest = 0.0041;
  thread.profile = {{-0.0023f, 0.001f}, {0.0f, 0.0041f}, {-0.001f, 0.001f}};
  r.threads = {thread};
  r.touches = {{2, "Z", "mm", false, -1, 120.0, {-20.0013, -19.9987, -20.0}}};
  CycleTimes times({"receive", "logic", "interpolate", "axes", "send"});
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t phases[] = {400 + i % 90, 700, 800, 300, 500 + i % 40};
    times.add(2800 + i % 300, 0, phases);
  }
  fill_cycle_times(r, times, false);
  r.segments = {{"can", 0.412, 0.447, 64'000, 64'000, 0, {}}};
  Histogram late;
  for (const std::int64_t us : {0, 3, 70, 71, 72, 200}) late.add(us * 1000);
  r.segments[0].sync = sync_report(late);
  r.sync_skew_us = quantiles_us(late);
  for (int n = 0; n < alarms; ++n) {
    AlarmEntry a;
    a.record.number = static_cast<std::uint16_t>(3101 + 20 * n);
    a.record.sequence = static_cast<std::uint32_t>(n + 1);
    a.record.first_fault = 1;
    a.record.reaction = n == 0 ? image::Reaction::stop_on_path : image::Reaction::power_off;
    a.record.cycle = 9000 + 40 * n;
    a.record.t_ns = a.record.cycle * image::kMillisecond;
    a.record.axis = 0;
    a.record.line = 8;
    a.record.block = 80;
    a.record.limit = 2.0;
    a.record.value = 2.013;
    a.record.part = {0, 1};
    a.axis = "X";
    a.id = n == 0 ? "following_error" : "drive_fault";
    a.text = n == 0 ? text::both("Axis X follows its set-point with too large an error",
                                 "Ось X следует за заданием со слишком большой ошибкой")
                    : text::both("Drive of axis X reports a fault", "Привод оси X сообщает об отказе");
    a.remedy = text::both("Look for a blocked axis; check gains and limits.",
                          "Проверьте, не зажата ли ось; проверьте усиления и пределы.");
    r.alarms.push_back(a);
  }
  return r;
}

}  // namespace servogate::report
