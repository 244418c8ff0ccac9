// SPDX-License-Identifier: Apache-2.0
// Touches of a probe in the report: which are of the same place, and how well they agree.
#include "report/touches.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "report/report.hpp"

namespace servogate::report {
namespace {

TEST(Repeatability, is_mean_spread_and_the_standard_deviation_of_the_sample) {
  const Repeatability none = repeatability({});
  EXPECT_EQ(none.mean, 0.0);
  EXPECT_EQ(none.spread, 0.0);
  const std::vector<double> once{7.25};
  EXPECT_EQ(repeatability(once).mean, 7.25);
  EXPECT_EQ(repeatability(once).deviation, 0.0) << "of a single one nothing is known";
  const std::vector<double> places{2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0};
  const Repeatability r = repeatability(places);
  EXPECT_DOUBLE_EQ(r.mean, 5.0);
  EXPECT_DOUBLE_EQ(r.spread, 7.0);
  EXPECT_NEAR(r.deviation, 2.138089935, 1e-9) << "the root of 32 / 7";
}

/// Along Z at X = `x`.
Touch along_z(double at, double x = 10.0, double feed = 100.0, int direction = -1) {
  Touch t;
  t.axis = 2;
  t.direction = direction;
  t.feed_mm_min = feed;
  t.at = at;
  t.beside[0] = x;
  return t;
}

TEST(Touches, of_one_place_are_those_of_the_same_axis_direction_and_feed_that_lie_together) {
  Touch along_x = along_z(-20.0, 0.0);
  along_x.axis = 0;
  const std::vector<Touch> all{
      along_z(-20.001), along_z(-20.0, 11.0),      along_z(-19.999), along_z(-20.002),
      along_z(-25.0),   along_z(-20.0, 10.0, 500), along_x,          along_z(-20.0, 10.0, 100.0, 1)};
  const std::vector<TouchGroup> groups = grouped(all);
  ASSERT_EQ(groups.size(), 6u);
  EXPECT_EQ(groups[0].places, (std::vector{-20.001, -19.999, -20.002}));
  EXPECT_EQ(groups[0].axis, 2);
  EXPECT_EQ(groups[0].direction, -1);
  EXPECT_EQ(groups[0].feed_mm_min, 100.0);
  for (std::size_t n = 1; n < groups.size(); ++n) EXPECT_EQ(groups[n].places.size(), 1u) << n;
  EXPECT_TRUE(grouped({}).empty());
}

TEST(Touches, stand_in_the_report_with_their_spread_and_a_run_without_any_says_nothing_of_them) {
  Report report;
  EXPECT_FALSE(nlohmann::json::parse(to_json(report)).contains("touches"));
  report.touches = {{2, "Z", "mm", false, -1, 100.0, {-20.001, -19.999, -20.0}}};
  const nlohmann::json touch = nlohmann::json::parse(to_json(report))["touches"][0];
  EXPECT_EQ(touch["axis"], "Z");
  EXPECT_EQ(touch["direction"], -1);
  EXPECT_EQ(touch["feed_mm_min"], 100.0);
  EXPECT_NEAR(touch["mean"].get<double>(), -20.0, 1e-9);
  EXPECT_NEAR(touch["spread"].get<double>(), 0.002, 1e-9);
  EXPECT_NEAR(touch["deviation"].get<double>(), 0.001, 1e-9);
  EXPECT_EQ(touch["places"], nlohmann::json::parse("[-20.001, -19.999, -20.0]"));
}

}  // namespace
}  // namespace servogate::report
