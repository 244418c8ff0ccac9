// SPDX-License-Identifier: Apache-2.0
// Threads and taps in the report: which cycles are one pass, which lead was cut, how far off the spindle.
#include "report/threads.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "report/report.hpp"

namespace servogate::report {
namespace {

/// A lathe in which Z follows the spindle at a lead; 1 ms cycles.
class ThreadTest : public testing::Test {
 protected:
  void SetUp() override {
    image_->now.period_ns = 1'000'000;
    image_->axis_count = 2;
    image_->spindle_count = 1;
    image_->processes[0].run = 1;
  }

  /// The spindle turns for so many cycles; Z goes `lead` in a revolution from where it stands.
  void turn(int cycles, double rpm, double lead, double off_mm = 0.0) {
    image::SpindleImage& spindle = image_->spindles[0];
    for (int n = 0; n < cycles; ++n) {
      const double step = rpm / 60.0 * 1e-3;
      angle_ += step;
      spindle.actual_rpm = rpm;
      spindle.angle_deg = 360.0 * (angle_ - std::floor(angle_));
      image_->axes[1].actual -= lead * step;
      image_->processes[0].off_spindle_mm = off_mm;
      image_->now.t_ns += image_->now.period_ns;
      log_.add(*image_);
    }
  }
  void thread(int line) {
    image_->processes[0].by_spindle = line > 0;
    image_->processes[0].line = line;
  }

  std::unique_ptr<image::ProcessImage> image_ = std::make_unique<image::ProcessImage>();
  ThreadLog log_{2, {0}};
  double angle_ = 0.3;
};

TEST_F(ThreadTest, is_the_cycles_in_which_the_path_goes_by_the_spindle_and_each_block_is_its_own) {
  turn(100, 600, 0.0);
  EXPECT_TRUE(log_.passes().empty());
  thread(10);
  turn(1000, 600, 1.5);
  thread(11);
  turn(500, 600, 2.0);
  thread(0);
  turn(100, 600, 1.0);
  thread(10);
  turn(1000, 600, 1.5);
  const std::vector<ThreadPass> passes = log_.passes();
  ASSERT_EQ(passes.size(), 3u) << "the last one is under way";
  EXPECT_EQ(passes[0].line, 10);
  EXPECT_EQ(passes[0].axis, 1);
  EXPECT_NEAR(passes[0].lead, 1.5, 1e-9);
  EXPECT_NEAR(passes[0].begin_s, 0.101, 1e-9);
  EXPECT_NEAR(passes[0].duration_s, 1.0, 1e-9);
  EXPECT_NEAR(passes[0].revolutions, 999 * 0.01, 1e-9) << "from its first cycle to its last";
  EXPECT_EQ(passes[1].line, 11);
  EXPECT_NEAR(passes[1].lead, 2.0, 1e-9);
  EXPECT_EQ(passes[2].line, 10);
}

TEST_F(ThreadTest, has_the_lead_that_was_cut_however_the_speed_of_the_spindle_changes) {
  thread(10);
  for (const double rpm : {600.0, 540.0, 630.0, 1200.0, 45'000.0}) turn(200, rpm, 1.25);
  const ThreadPass pass = log_.passes().at(0);
  EXPECT_NEAR(pass.lead, 1.25, 1e-9);
  EXPECT_EQ(pass.speed_min_rpm, 540.0);
  EXPECT_EQ(pass.speed_max_rpm, 45'000.0);
}

TEST_F(ThreadTest, of_a_tap_goes_in_and_out_at_one_lead) {
  thread(20);
  turn(500, 300, 0.8);
  turn(500, -300, 0.8);
  const ThreadPass pass = log_.passes().at(0);
  EXPECT_NEAR(pass.lead, 0.8, 1e-9);
  EXPECT_NEAR(pass.revolutions, 999 * 0.005, 1e-9);
  EXPECT_EQ(pass.speed_min_rpm, 300.0);
}

TEST_F(ThreadTest, shows_how_far_it_was_off_over_its_length_in_at_most_32_parts) {
  thread(10);
  turn(600, 600, 1.5, 0.001);
  turn(600, 600, 1.5, -0.003);
  const ThreadPass pass = log_.passes().at(0);
  EXPECT_NEAR(pass.off_mean, -0.001, 1e-12);
  EXPECT_EQ(pass.off_least, -0.003);
  EXPECT_EQ(pass.off_greatest, 0.001);
  ASSERT_GT(pass.profile.size(), ThreadPass::kParts / 2);
  ASSERT_LE(pass.profile.size(), ThreadPass::kParts);
  EXPECT_FLOAT_EQ(pass.profile.front().least, 0.001f);
  EXPECT_FLOAT_EQ(pass.profile.front().greatest, 0.001f);
  EXPECT_FLOAT_EQ(pass.profile.back().least, -0.003f);
  EXPECT_FLOAT_EQ(pass.profile.back().greatest, -0.003f);
  const auto middle = pass.profile[600 / 64];
  EXPECT_FLOAT_EQ(middle.least, -0.003f) << "of both halves";
  EXPECT_FLOAT_EQ(middle.greatest, 0.001f);
}

TEST_F(ThreadTest, is_kept_as_one_of_the_first_500_and_not_where_the_spindle_hardly_turned) {
  for (int n = 0; n < 600; ++n) {
    thread(n + 1);
    turn(n == 0 ? 2 : 20, 600, 1.5);
  }
  const std::vector<ThreadPass> passes = log_.passes();
  ASSERT_EQ(passes.size(), 499u);
  EXPECT_EQ(passes.front().line, 2);
  EXPECT_EQ(passes.back().line, 500);
}

TEST_F(ThreadTest, is_not_looked_for_in_a_process_without_a_spindle) {
  ThreadLog none(2, {-1});
  thread(10);
  for (int n = 0; n < 100; ++n) none.add(*image_);
  EXPECT_TRUE(none.passes().empty());
}

TEST(Threads, stand_in_the_report_and_a_run_without_any_says_nothing_of_them) {
  Report report;
  EXPECT_FALSE(nlohmann::json::parse(to_json(report)).contains("threads"));
  ThreadPass pass;
  pass.line = 10;
  pass.letter = "Z";
  pass.lead = 1.5;
  pass.off_least = -0.002;
  pass.profile = {{-0.5f, 0.25f}};
  report.threads = {pass};
  const nlohmann::json thread = nlohmann::json::parse(to_json(report))["threads"][0];
  EXPECT_EQ(thread["line"], 10);
  EXPECT_EQ(thread["axis"], "Z");
  EXPECT_EQ(thread["lead_mm"], 1.5);
  EXPECT_EQ(thread["off_mm"]["least"], -0.002);
  EXPECT_EQ(thread["profile_mm"], nlohmann::json::parse("[[-0.5, 0.25]]"));
  EXPECT_FALSE(thread.contains("file"));
}

}  // namespace
}  // namespace servogate::report
