// SPDX-License-Identifier: Apache-2.0
// `servogate latency`: what is counted and concluded. How late a thread wakes is the computer's affair.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/command/latency/cyclictest.hpp"
#include "gateway/command/latency/this_computer.hpp"
#include "gateway/command/latency/wake_up.hpp"
#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

using namespace gateway::command;

TEST(Latency, fits_a_cycle_by_its_worst_wake_up) {
  EXPECT_EQ(fit_of(200'000, 1'000'000), Fit::good);
  EXPECT_EQ(fit_of(200'001, 1'000'000), Fit::doubtful);
  EXPECT_EQ(fit_of(500'000, 1'000'000), Fit::doubtful);
  EXPECT_EQ(fit_of(500'001, 1'000'000), Fit::no);
}

TEST(Latency, reads_the_last_figures_of_cyclictest) {
  const auto read = read_cyclictest(
      "# /dev/cpu_dma_latency set to 0us\nT: 0 ( 4711) P:80 I:1000 C:     10 Min:      9 Act:   12 Avg:   11 "
      "Max:      20\n"
      "T: 0 ( 4711) P:80 I:1000 C:   1000 Min:      2 Act:    5 Avg:    4 Max:      31\n");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->min_us, 2.0);
  EXPECT_EQ(read->mean_us, 4.0);
  EXPECT_EQ(read->max_us, 31.0);
  EXPECT_FALSE(read_cyclictest("sh: cyclictest: not found\n"));
}

/// A computer of files.
class Computer {
 public:
  void has(const std::string& path, const std::string& line) const {
    const std::filesystem::path file = desk_.path("root") + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << line << "\n";
  }
  bool advises(const std::string& part) const {
    for (const Advice& a : advice_for(desk_.path("root")))
      if (text::in_language(a.what, text::Language::english).find(part) != std::string::npos) return true;
    return false;
  }
  std::size_t advices() const { return advice_for(desk_.path("root")).size(); }

 private:
  Desk desk_;
};

TEST(Latency, advises_nothing_on_a_computer_that_is_set_up_for_it) {
  const Computer c;
  c.has("/sys/kernel/realtime", "1");
  c.has("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  c.has("/sys/devices/system/cpu/isolated", "3");
  c.has("/proc/sys/kernel/sched_rt_runtime_us", "-1");
  c.has("/sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc");
  c.has("/sys/devices/system/cpu/smt/active", "0");
  EXPECT_EQ(c.advices(), 0u);
}

TEST(Latency, names_each_thing_that_costs_time) {
  const Computer c;
  c.has("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave");
  c.has("/proc/sys/kernel/sched_rt_runtime_us", "950000");
  c.has("/sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet");
  c.has("/sys/devices/system/cpu/smt/active", "1");
  for (const char* part : {"PREEMPT_RT", "powersave", "no processor", "950000", "hpet", "SMT"})
    EXPECT_TRUE(c.advises(part)) << part;
}

TEST(Latency, counts_every_cycle_once_and_ends_when_it_is_told_to) {
  WakeUpPlan plan;
  plan.seconds = 0.05;
  plan.realtime.best_effort = true;
  int worked = 0;
  const WakeUp whole = measure_wake_up(
      plan, [] { return false; },
      [&](image::Nanoseconds) {
        ++worked;
        return true;
      });
  EXPECT_EQ(whole.late.count(), 50u);
  EXPECT_EQ(worked, 50);
  EXPECT_LE(whole.missed, 50);
  plan.seconds = 86'400.0;
  const WakeUp part = measure_wake_up(plan, [] { return true; });
  EXPECT_LT(part.late.count(), 86'400'000u);
}

TEST(Latency, of_the_program_is_a_histogram_with_a_verdict_for_each_cycle) {
  const Desk desk;
  const Ended ended = desk.line("$SG latency --seconds 0.2 --json");
  EXPECT_TRUE(ended.code == 0 || ended.code == 1) << ended.err;  // a busy computer is not good enough
  const auto facts = nlohmann::json::parse(ended.out, nullptr, false);
  ASSERT_TRUE(facts.is_object()) << ended.out;
  EXPECT_EQ(facts["wake_up"]["count"], 200);
  EXPECT_GE(facts["wake_up"]["max_us"], facts["wake_up"]["p50_us"]);
  for (const char* cycle : {"1000", "500", "250"}) EXPECT_TRUE(facts["fit"].contains(cycle)) << facts;
  EXPECT_EQ(desk.line("$SG latency socketcan:can0").code, 2) << "a bus needs a node";
}

TEST(Latency, of_a_machine_shows_every_phase_of_its_cycle) {
  const Desk desk;
  const Ended ended = desk.line("$SG latency --machine $MILL --seconds 0.5 --load --json");
  EXPECT_TRUE(ended.code == 0 || ended.code == 1) << ended.err;  // a busy computer is not good enough
  const auto facts = nlohmann::json::parse(ended.out, nullptr, false);
  ASSERT_TRUE(facts.is_object()) << ended.out << ended.err;
  EXPECT_EQ(facts["load"], true);
  EXPECT_GT(facts["machine"]["cycle"]["count"], 0);
  std::vector<std::string> phases;
  for (const auto& phase : facts["machine"]["phases"]) {
    phases.push_back(phase["phase"]);
    EXPECT_EQ(phase["count"], facts["machine"]["cycle"]["count"]) << phase;
  }
  EXPECT_EQ(phases, (std::vector<std::string>{"receive", "logic", "interpolate", "axes", "send", "publish"}));
  EXPECT_EQ(desk.line("$SG latency socketcan:can0 5 --machine $MILL").code, 2) << "either or";
}

}  // namespace
}  // namespace servogate::shell
