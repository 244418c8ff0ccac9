// SPDX-License-Identifier: Apache-2.0
#include "report/trace.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include <unistd.h>

#include "firmware_if/image/interface_map.hpp"
#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("servogate-" + std::to_string(::getpid()) + "-" + name))
      .string();
}
std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream out;
  out << file.rdbuf();
  return out.str();
}

/// Keeps cycle numbers; can be told to be slow.
struct Keeper final : TraceSink {
  std::vector<std::int64_t> cycles;
  std::uint64_t dropped = 99;
  bool begun = false;
  std::atomic<bool> hold{false};
  void begin(const TraceLayout&) override { begun = true; }
  void row(const TraceRow& row) override {
    while (hold) std::this_thread::yield();
    cycles.push_back(row.cycle);
  }
  void end(std::uint64_t d) override { dropped = d; }
};

std::vector<std::unique_ptr<TraceSink>> only(std::unique_ptr<TraceSink> sink) {
  std::vector<std::unique_ptr<TraceSink>> out;
  out.push_back(std::move(sink));
  return out;
}

TEST(TraceRecorder, loses_nothing_when_the_loop_waits_for_room) {
  auto keeper = std::make_unique<Keeper>();
  Keeper& kept = *keeper;
  TraceRecorder recorder({}, only(std::move(keeper)), 64);
  constexpr std::int64_t kRows = 50'000;
  for (std::int64_t n = 0; n < kRows; ++n) {
    recorder.wait_for_room();
    TraceRow row;
    row.cycle = n;
    ASSERT_TRUE(recorder.record(row));
  }
  recorder.close();
  EXPECT_TRUE(kept.begun);
  EXPECT_EQ(kept.dropped, 0u);
  ASSERT_EQ(kept.cycles.size(), static_cast<std::size_t>(kRows));
  for (std::int64_t n = 0; n < kRows; ++n) ASSERT_EQ(kept.cycles[static_cast<std::size_t>(n)], n);
}

TEST(TraceRecorder, never_waits_in_real_time_and_counts_what_it_drops) {
  auto keeper = std::make_unique<Keeper>();
  Keeper& kept = *keeper;
  kept.hold = true;
  TraceRecorder recorder({}, only(std::move(keeper)), 100);
  std::uint64_t refused = 0;
  for (int n = 0; n < 1000; ++n) {
    TraceRow row;
    row.cycle = n;
    refused += !recorder.record(row);
  }
  EXPECT_EQ(refused, 900u);
  EXPECT_EQ(recorder.dropped(), 900u);
  EXPECT_EQ(recorder.recorded(), 100u);
  kept.hold = false;
  recorder.close();
  EXPECT_EQ(kept.dropped, 900u);
  EXPECT_EQ(kept.cycles.size(), 100u);
  EXPECT_EQ(kept.cycles.back(), 99);
}

TEST(TraceRecorder, closes_twice_and_by_its_destructor) {
  auto keeper = std::make_unique<Keeper>();
  {
    TraceRecorder recorder({}, only(std::move(keeper)), 4);
    recorder.record({});
    recorder.close();
    recorder.close();
    EXPECT_EQ(static_cast<const Keeper&>(*recorder.sinks()[0]).cycles.size(), 1u);
  }
}

TEST(CsvSink, has_the_columns_of_the_contract_first) {
  TraceLayout layout;
  layout.axes = {"X", "Y"};
  layout.spindles = 1;
  layout.signals = {{"door", {}}, {"a,b", {}}};
  EXPECT_EQ(CsvSink::header(layout),
            "t,feed,line,X.cmd,X.act,Y.cmd,Y.act,spindle.cmd,spindle.act,spindle.angle,X.error,Y.error,door,"
            "\"a,b\"");
  EXPECT_EQ(CsvSink::header(layout, {false, false}),
            "t,feed,line,X.cmd,X.act,Y.cmd,Y.act,spindle.cmd,spindle.act,spindle.angle");
}

TEST(CsvSink, writes_one_row_a_cycle_with_twelve_decimals) {
  const std::string path = temporary("row.csv");
  TraceLayout layout;
  layout.axes = {"X"};
  layout.spindles = 1;
  layout.signals = {{"door", {}}};
  CsvSink sink(path);
  sink.begin(layout);
  TraceRow row;
  row.feed_mm_s = 33.25;
  row.line = 7;
  row.axes[0].command = 1.0 / 3.0;
  row.axes[0].actual = -0.25;
  row.axes[0].following_error = 0.5;
  row.spindles[0] = {1500.0, 1499.5, 271.25};
  sink.row(row);
  row.t_ns = image::kMillisecond;
  row.signals[0] = 1;
  sink.row(row);
  sink.end(0);
  EXPECT_EQ(sink.error(), "");
  EXPECT_EQ(
      content(path),
      "t,feed,line,X.cmd,X.act,spindle.cmd,spindle.act,spindle.angle,X.error,door\n"
      "0.000000,33.250000000,7,0.333333333333,-0.250000000000,1500.000000,1499.500000,271.250,0.500000000,0\n"
      "0.001000,33.250000000,7,0.333333333333,-0.250000000000,1500.000000,1499.500000,271.250,0.500000000,"
      "1\n");
  std::filesystem::remove(path);
}

TEST(CsvSink, two_runs_through_the_recorder_give_equal_bytes_and_say_how_fast) {
  const DemoRun demo = demo_run(40.0);
  std::string first;
  for (int run = 0; run < 2; ++run) {
    const std::string path = temporary("equal.csv");
    const auto begin = std::chrono::steady_clock::now();
    {
      TraceRecorder recorder(demo.layout, only(std::make_unique<CsvSink>(path)));
      for (const TraceRow& row : demo.rows) {
        recorder.wait_for_room();
        ASSERT_TRUE(recorder.record(row));
      }
    }
    const double us =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
    std::cout << us / static_cast<double>(demo.rows.size()) << " us a row through the recorder\n";
    const std::string text = content(path);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<long>(demo.rows.size() + 1));
    if (run == 0)
      first = text;
    else
      EXPECT_TRUE(text == first);
    std::filesystem::remove(path);
  }
}

TEST(CsvSink, a_place_that_cannot_be_written_is_an_error_and_not_a_crash) {
  CsvSink sink("/nowhere/at/all.csv");
  sink.begin({});
  for (int n = 0; n < 10000; ++n) sink.row({});
  sink.end(0);
  EXPECT_EQ(text::in_language(sink.error(), text::Language::english),
            "/nowhere/at/all.csv: cannot create: No such file or directory");
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  CsvSink full("/dev/full");
  full.begin({});
  for (int n = 0; n < 100000; ++n) full.row({});
  full.end(0);
  EXPECT_EQ(text::in_language(full.error(), text::Language::english),
            "/dev/full: cannot write: No space left on device");
}

TEST(Sample, takes_the_image_as_it_stands) {
  auto image = std::make_unique<image::ProcessImage>();
  image->now = {42, 42 * image::kMillisecond, image::kMillisecond};
  image->processes[0].feed_mm_s = 12.5;
  image->processes[0].line = 9;
  image->axes[1].command = 3.0;
  image->axes[1].actual = 2.5;
  image->axes[1].following_error = 0.5;
  image->axes[1].homed = image->axes[1].enabled = true;
  image->spindles[0].command_rpm = 800;
  image->spindles[0].angle_deg = 271.25;
  image->processes[0].off_spindle_mm = -0.004;
  image->packets.set_bit(*image::parse_place("SA70"), true);
  image->packets.set_bit(image::field(image::kProcessFields, "rapid", image::process_base(0)), true);
  TraceLayout layout;
  layout.axes = {"X", "Y"};
  layout.spindles = 1;
  for (int n = 0; n < 80; ++n) layout.signals.push_back({"s", *image::parse_place("SA" + std::to_string(n))});
  TraceRow row;
  sample(*image, layout, row);
  EXPECT_EQ(row.cycle, 42);
  EXPECT_EQ(row.t_ns, 42 * image::kMillisecond);
  EXPECT_EQ(row.line, 9);
  EXPECT_TRUE(row.rapid);
  EXPECT_EQ(row.feed_mm_s, 12.5);
  EXPECT_EQ(row.axes[1].command, 3.0);
  EXPECT_EQ(row.axes[1].following_error, 0.5);
  EXPECT_TRUE(row.axes[1].homed);
  EXPECT_EQ(row.spindles[0].command_rpm, 800.0);
  EXPECT_EQ(row.spindles[0].angle_deg, 271.25);
  EXPECT_EQ(row.off_spindle_mm, -0.004);
  for (std::size_t n = 0; n < 80; ++n) EXPECT_EQ(row.signal(n), n == 70);
  EXPECT_FALSE(row.axes[0].enabled);
}

}  // namespace
}  // namespace servogate::report
