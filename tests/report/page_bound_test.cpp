// SPDX-License-Identifier: Apache-2.0
// What the page says of the limit that binds at each place of a path.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/places/places.hpp"
#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

using Json = nlohmann::json;

constexpr double kPeriod = 0.001, kVelocity = 500.0, kAcceleration = 1000.0, kJerk = 10000.0;

/// X speeds up to its velocity with all of its jerk and acceleration, slows down to a feed of 100 mm/s, and
/// goes on with a speed that rises a little. In between lies what the page is to say.
struct Driven {
  Driven() {
    demo.layout.axes = {"X", "Y", "Z"};
    go(0.1, kJerk, "jerk");
    go(0.4, 0.0, "acceleration");
    go(0.1, -kJerk, "jerk");
    go(0.5, 0.0, "velocity");
    go(0.1, -kJerk, "jerk");
    go(0.3, 0.0, "acceleration");
    go(0.1, kJerk, "jerk");
    go(0.5, 0.0, "feed");
    go(0.4, 1000.0, "tolerance");
  }
  void go(double seconds, double jerk, const char* what) {
    const bool axis = std::string(what) != "feed" && std::string(what) != "tolerance";
    const auto cycles = static_cast<int>(std::lround(seconds / kPeriod));
    bounds.push_back({{"t", (static_cast<double>(demo.rows.size()) + 0.5 * cycles) * kPeriod},
                      {"what", what},
                      {"letter", axis ? "X" : ""}});
    for (int k = 0; k < cycles; ++k) {
      a += jerk * kPeriod;
      v += a * kPeriod;
      x += v * kPeriod;
      TraceRow row;
      row.cycle = static_cast<std::int64_t>(demo.rows.size());
      row.t_ns = row.cycle * demo.layout.period_ns;
      row.line = 1;
      row.feed_mm_s = v;
      row.axes[0] = {x, x, 0.0, v, a, true, true};
      for (std::size_t n = 1; n < 3; ++n) row.axes[n].enabled = row.axes[n].homed = true;
      demo.rows.push_back(row);
    }
  }
  DemoRun demo;
  Json bounds = Json::array();
  double x = 0.0, v = 0.0, a = 0.0;
};

TEST(PageBound, names_feed_tolerance_and_velocity_acceleration_and_jerk_of_the_axis) {
  if (std::system("node --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "no node here; install nodejs to run the page's script in this test";
  const Driven run;
  Report report = demo_report(run.demo);
  for (AxisReport& axis : report.axes) {
    axis.limit_velocity = kVelocity;
    axis.limit_acceleration = kAcceleration;
    axis.limit_jerk = kJerk;
  }
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("page_bound." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const Json expected{{"tolerance", 0},          {"start", 0},
                      {"card", "No alarms"},     {"samples", Json::array()},
                      {"peaks", Json::object()}, {"shown", {"limited by"}},
                      {"bounds", run.bounds}};
  ASSERT_EQ(write_file((folder / "page.html").string(), to_html(report, recorded(run.demo), {})), "");
  ASSERT_EQ(write_file((folder / "expected.json").string(), expected.dump()), "");
  EXPECT_EQ(std::system(("node " + tests::source_dir() + "/tests/report/page_smoke.js " +
                         (folder / "page.html").string() + " " + (folder / "expected.json").string())
                            .c_str()),
            0);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace servogate::report
