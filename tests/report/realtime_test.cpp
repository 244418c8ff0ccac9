// SPDX-License-Identifier: Apache-2.0
// What the cycle calls of this room may not allocate: every operator new of this program is counted per
// thread.
#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <memory>

#include "report/statistics.hpp"
#include "report/trace.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

TEST(RealTime, the_guard_of_this_test_sees_an_allocation) {
  const std::uint64_t before = counting::allocations();
  auto value = std::make_unique<int>(1);
  EXPECT_EQ(*value + static_cast<int>(counting::allocations() - before), 2);
}

TEST(RealTime, a_cycle_samples_counts_and_records_without_allocating) {
  auto image = std::make_unique<image::ProcessImage>();
  const DemoRun demo = demo_run(1.0);
  TraceRecorder recorder(demo.layout, {}, 1024);
  RunStatistics statistics(demo.layout);
  CycleTimes times({"receive", "plc", "axes"});
  const std::int64_t phases[] = {100, 200, 300};
  TraceRow row;
  const std::uint64_t before = counting::allocations();
  for (int n = 0; n < 5000; ++n) {  // more than fits, so that dropping is covered too
    image->now.number = n;
    image->axes[0].command = n * 1e-3;
    sample(*image, demo.layout, row);
    statistics.add(row);
    times.add(3000 + n, n, phases);
    recorder.record(row);
  }
  EXPECT_EQ(counting::allocations(), before);
  EXPECT_EQ(recorder.recorded() + recorder.dropped(), 5000u);
}

TEST(RealTime, says_what_a_cycle_pays_for_its_trace) {
  auto image = std::make_unique<image::ProcessImage>();
  const DemoRun demo = demo_run(1.0);
  RunStatistics statistics(demo.layout);
  TraceRow row;
  constexpr int kCycles = 100'000;
  const auto begin = std::chrono::steady_clock::now();
  for (int n = 0; n < kCycles; ++n) {
    image->now.number = n;
    sample(*image, demo.layout, row);
    statistics.add(row);
  }
  const double ns =
      std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() / kCycles;
  std::cout << ns << " ns a cycle for sample and statistics of three axes and eight signals\n";
  EXPECT_EQ(statistics.cycles(), static_cast<std::uint64_t>(kCycles));
}

TEST(RealTime, says_what_the_writer_pays_for_the_page) {
  const DemoRun demo = demo_run(60.0);
  RunRecorder recorder;
  recorder.begin(demo.layout);
  const auto begin = std::chrono::steady_clock::now();
  for (const TraceRow& row : demo.rows) recorder.row(row);
  recorder.end(0);
  const double us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  std::cout << us / static_cast<double>(demo.rows.size()) << " us a row for the page's record\n";
  EXPECT_FALSE(recorder.run().series.empty());
}

}  // namespace
}  // namespace servogate::report
