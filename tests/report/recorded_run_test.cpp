// SPDX-License-Identifier: Apache-2.0
#include "report/recorded_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "report/record/path_thinning.hpp"
#include "report/statistics.hpp"
#include "tests/property_seed.hpp"
#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

const Series& series(const RecordedRun& run, const std::string& name) {
  const auto found =
      std::find_if(run.series.begin(), run.series.end(), [&](const Series& s) { return s.name == name; });
  if (found == run.series.end()) throw std::runtime_error(name);
  return *found;
}

/// Distance of a point from the recorded polyline.
double off(const PathLine& p, double x, double y, double z) {
  double best = 1e300;
  for (std::size_t i = 1; i < p.x.size(); ++i) {
    const double dx = p.x[i] - p.x[i - 1], dy = p.y[i] - p.y[i - 1], dz = p.z[i] - p.z[i - 1];
    const double l2 = dx * dx + dy * dy + dz * dz;
    const double px = x - p.x[i - 1], py = y - p.y[i - 1], pz = z - p.z[i - 1];
    const double s = l2 > 0 ? std::clamp((px * dx + py * dy + pz * dz) / l2, 0.0, 1.0) : 0.0;
    best = std::min(best, std::hypot(px - s * dx, py - s * dy, pz - s * dz));
  }
  return best;
}

TEST(RunRecorder, keeps_every_cycle_while_there_is_room) {
  const DemoRun demo = demo_run(5.0);
  RunRecorderOptions options;
  options.max_buckets = demo.rows.size();
  const RecordedRun run = recorded(demo, options);
  EXPECT_EQ(run.bucket_s, 0.001);
  EXPECT_EQ(run.line.size(), demo.rows.size());
  const Series& x = series(run, "X.position");
  for (std::size_t n = 0; n < demo.rows.size(); ++n) {
    ASSERT_EQ(x.low[n], static_cast<float>(demo.rows[n].axes[0].command));
    ASSERT_EQ(x.high[n], x.low[n]);
    ASSERT_EQ(run.line[n], demo.rows[n].line);
  }
}

TEST(RunRecorder, merges_buckets_and_never_loses_an_extreme) {
  const DemoRun demo = demo_run(30.0);
  RunRecorderOptions options;
  options.max_buckets = 500;
  const RecordedRun run = recorded(demo, options);
  RunStatistics truth(demo.layout);
  for (const TraceRow& row : demo.rows) truth.add(row);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto most = [&](const char* kind) {
      const Series& s = series(run, demo.layout.axes[a] + kind);
      EXPECT_LE(s.low.size(), 500u);
      float m = 0;
      for (std::size_t n = 0; n < s.low.size(); ++n)
        m = std::max({m, std::fabs(s.low[n]), std::fabs(s.high[n])});
      return m;
    };
    EXPECT_EQ(most(".velocity"), static_cast<float>(truth.axes()[a].max_velocity()));
    EXPECT_EQ(most(".acceleration"), static_cast<float>(truth.axes()[a].max_acceleration()));
    EXPECT_EQ(most(".jerk"), static_cast<float>(truth.axes()[a].max_jerk()));
    EXPECT_EQ(most(".error"), static_cast<float>(truth.axes()[a].max_following_error()));
  }
  EXPECT_NEAR(run.bucket_s * static_cast<double>(run.line.size()), run.duration_s, run.bucket_s);
}

TEST(RunRecorder, the_thinned_path_stays_within_its_tolerance_of_every_set_point) {
  const DemoRun demo = demo_run(15.0);
  for (const std::size_t most : {100u, 400u, 40'000u}) {
    RunRecorderOptions options;
    options.max_vertices = most;
    const RecordedRun run = recorded(demo, options);
    ASSERT_LE(run.path.x.size(), most);
    for (std::size_t n = 0; n < demo.rows.size(); n += 7) {
      const auto& axes = demo.rows[n].axes;
      ASSERT_LE(off(run.path, axes[0].command, axes[1].command, axes[2].command), run.path_tolerance + 2e-5)
          << n;
    }
    EXPECT_TRUE(std::is_sorted(run.path.t.begin(), run.path.t.end()));
    std::cout << run.path.x.size() << " vertices for " << demo.rows.size() << " cycles, tolerance "
              << run.path_tolerance << " mm\n";
  }
}

TEST(EveryCycle, forgets_the_oldest_first_and_what_is_around_an_alarm_last) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> noise(-1.0, 1.0);
  EveryCycle every({{"a", 1e-6, 0}}, 100'000);
  const std::int64_t alarm = 60'000;
  for (std::int64_t n = 0; n < 400'000; ++n) every.add(n, {noise(random)}, n == alarm);
  every.finish();
  std::size_t bytes = 0;
  bool around = false;
  for (const CycleStretch& s : every.stretches()) {
    bytes += s.bytes;
    const auto rows = static_cast<std::int64_t>(s.columns[0].count);
    around |= s.first <= alarm && alarm < s.first + rows;
  }
  EXPECT_LE(bytes, 100'000u);
  EXPECT_TRUE(around) << "the alarm's stretch is older than others that went";
  const CycleStretch& last = every.stretches().back();
  EXPECT_EQ(last.first + static_cast<std::int64_t>(last.columns[0].count), 400'000)
      << "the end of the run stays";
  EXPECT_EQ(std::count_if(every.stretches().begin(), every.stretches().end(),
                          [](const CycleStretch& s) { return s.first < 50'000; }),
            0)
      << "the oldest went";
}

TEST(EveryCycle, a_lost_cycle_begins_a_stretch_without_a_past) {
  EveryCycle every({{"a", 1, 1}}, 100'000);
  for (const std::int64_t n : {5, 6, 7, 9, 10}) every.add(n, {static_cast<double>(n)}, false);
  every.finish();
  ASSERT_EQ(every.stretches().size(), 2u);
  EXPECT_EQ(every.stretches()[0].first, 5);
  EXPECT_EQ(every.stretches()[1].first, 9);
  EXPECT_EQ(every.stretches()[1].lead, 0);
}

TEST(RunRecorder, a_deviation_lies_across_the_path_and_survives_thinning) {
  TraceLayout layout;
  layout.axes = {"X", "Y", "Z"};
  RunRecorder recorder;
  recorder.begin(layout);
  for (int n = 0; n < 3000; ++n) {  // along X at 100 mm/s, late by 5 mm, and once off the path by 0.03 mm
    TraceRow row;
    row.cycle = n;
    row.t_ns = n * image::kMillisecond;
    row.line = 1;
    row.feed_mm_s = 100;
    for (std::size_t a = 0; a < 3; ++a) row.axes[a].enabled = row.axes[a].homed = true;
    row.axes[0].command = 0.1 * n;
    row.axes[0].following_error = 5.0;
    row.axes[1].following_error = n == 1234 ? 0.03 : 0.001;
    recorder.row(row);
  }
  recorder.end(0);
  const PathLine& path = recorder.run().path;
  EXPECT_LT(path.x.size(), 20u) << "a straight line";
  float most = 0;
  for (std::size_t i = 0; i < path.x.size(); ++i)
    if (path.t[i] > 0.01f) most = std::max(most, path.deviation[i]);
  EXPECT_NEAR(most, 0.03, 1e-6) << "being late is no deviation";
}

TEST(BoundedPath, random_walks_stay_within_tolerance_and_length) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  std::normal_distribution<float> turn(0.0f, 0.2f);
  for (int round = 0; round < 20; ++round) {
    BoundedPath path(64, 0.001);
    std::vector<PathVertex> all;
    float x = 0, y = 0, heading = 0;
    for (int n = 0; n < 1500; ++n) {
      heading += turn(random);
      x += 0.1f * std::cos(heading);
      y += 0.1f * std::sin(heading);
      all.push_back({x, y, 0, static_cast<float>(n) * 0.001f, 100.0f, n / 50,
                     n / 400 % 2 == 1 ? StretchKind::rapid : StretchKind::feed});
      path.add(all.back());
    }
    path.finish();
    ASSERT_LE(path.vertices().size(), 64u);
    PathLine line;
    for (const PathVertex& v : path.vertices()) {
      line.x.push_back(v.x);
      line.y.push_back(v.y);
      line.z.push_back(v.z);
    }
    for (const PathVertex& v : all) ASSERT_LE(off(line, v.x, v.y, v.z), path.tolerance());
    ASSERT_EQ(path.vertices().back().x, x);
  }
}

TEST(BoundedPath, a_path_of_any_length_keeps_to_its_memory) {
  BoundedPath path(200, 0.001);
  std::size_t most = 0;
  for (int n = 0; n < 300'000; ++n) {
    const float a = static_cast<float>(n) * 0.01f;
    path.add({10 * std::cos(a), 10 * std::sin(a * 1.001f), static_cast<float>(n) * 1e-3f,
              static_cast<float>(n) * 1e-3f, 100, n, StretchKind::feed});
    most = std::max(most, path.vertices().size());
  }
  path.finish();
  EXPECT_LE(most, 5u * 200u);
  EXPECT_LE(path.vertices().size(), 200u);
}

TEST(RunRecorder, shows_homing_as_no_cut_and_the_change_of_coordinates_as_no_motion) {
  TraceLayout layout;
  layout.axes = {"X"};
  RunRecorder recorder;
  recorder.begin(layout);
  for (int n = 0; n < 3000; ++n) {
    TraceRow row;
    row.cycle = n;
    row.t_ns = n * image::kMillisecond;
    row.line = n < 2000 ? 0 : 5;
    // A homing move towards 20, where the axis learns that it stands at 0; then a cut towards 10.
    row.axes[0].command = n < 1000 ? n * 0.02 : n < 2000 ? 0.0 : (n - 2000) * 0.01;
    row.axes[0].enabled = true;
    row.axes[0].homed = n >= 1000;
    recorder.row(row);
  }
  recorder.end(0);
  const PathLine& path = recorder.run().path;
  double rapid = 0, feed = 0, jump = 0;
  for (std::size_t i = 1; i < path.x.size(); ++i)
    (path.rapid[i] == 0 ? feed : path.rapid[i] == 1 ? rapid : jump) += std::fabs(path.x[i] - path.x[i - 1]);
  EXPECT_NEAR(rapid, 19.98, 1e-3);
  EXPECT_NEAR(jump, 19.98, 1e-3);
  EXPECT_NEAR(feed, 9.99, 0.011);
}

TEST(RunRecorder, keeps_signals_as_changes_and_says_where_it_stopped) {
  TraceLayout layout;
  layout.signals = {{"slow", {}}, {"fast", {}}, {"steady", {}}};
  RunRecorderOptions options;
  options.max_toggles = 100;
  RunRecorder recorder(options);
  recorder.begin(layout);
  for (int n = 0; n < 1000; ++n) {
    TraceRow row;
    row.cycle = n;
    row.t_ns = n * image::kMillisecond;
    row.signals[0] = (n >= 250 && n < 700 ? 1u : 0u) | (n % 2 ? 2u : 0u) | 4u;
    recorder.row(row);
  }
  recorder.end(0);
  const auto& signals = recorder.run().signals;
  EXPECT_EQ(signals[0].toggles, (std::vector<float>{0.25f, 0.7f}));
  EXPECT_LT(signals[0].truncated_s, 0.0);
  EXPECT_EQ(signals[1].toggles.size(), 100u);
  EXPECT_NEAR(signals[1].truncated_s, 0.101, 1e-9);
  EXPECT_TRUE(signals[2].initial);
  EXPECT_TRUE(signals[2].toggles.empty());
}

TEST(RunRecorder, adds_up_the_time_of_each_line_to_the_time_of_the_run) {
  const DemoRun demo = demo_run(10.0);
  const RecordedRun run = recorded(demo);
  double total = 0.0;
  for (const auto& [line, time] : run.line_times) total += time.total_s;
  EXPECT_NEAR(total, run.duration_s, 1e-6);
  EXPECT_EQ(run.line_times.begin()->first, 1);
  EXPECT_EQ(run.line_times.begin()->second.first_s, 0.0);
}

TEST(RunRecorder, a_gap_of_lost_rows_keeps_time_right) {
  const DemoRun demo = demo_run(4.0);
  RunRecorderOptions options;
  options.max_buckets = demo.rows.size();
  RunRecorder recorder(options);
  recorder.begin(demo.layout);
  for (std::size_t n = 0; n < demo.rows.size(); ++n)
    if (n < 1000 || n >= 2000) recorder.row(demo.rows[n]);
  recorder.end(1000);
  const RecordedRun& run = recorder.run();
  ASSERT_EQ(run.line.size(), demo.rows.size());
  const Series& x = series(run, "X.position");
  EXPECT_EQ(x.low[1500], static_cast<float>(demo.rows[999].axes[0].command));
  EXPECT_EQ(x.low[2500], static_cast<float>(demo.rows[2500].axes[0].command));
}

}  // namespace
}  // namespace servogate::report
