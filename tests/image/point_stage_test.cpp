// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/points/point_stage.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace servogate::image {
namespace {

Place at(const char* text) { return *parse_place(text); }

PointRule digital(const char* place) {
  PointRule rule;
  rule.place = at(place);
  return rule;
}
PointRule analog(const char* place) {
  PointRule rule = digital(place);
  rule.digital = false;
  return rule;
}

/// A stage of one group, its source 2, in cycles of a millisecond.
struct Bench {
  explicit Bench(std::vector<PointRule> rules, AgeLimits limits = {})
      : stage(std::move(rules), 2, {limits}) {}
  /// The device has read these.
  void read(std::initializer_list<double> raws) {
    std::size_t n = 0;
    for (const double raw : raws) stage.take(n++, raw);
    stage.fresh(0, image->now.t_ns);
    settle();
  }
  void settle() {
    stage.settle(*image);
    image->now.t_ns += kMillisecond;
  }
  bool bit(const char* place) const { return image->packets.bit(at(place)); }
  double number(const char* place) const { return image->packets.number(at(place)); }
  const IoSource& source() const { return image->sources[2]; }

  PointStage stage;
  std::unique_ptr<ProcessImage> image = std::make_unique<ProcessImage>();
};

TEST(PointStage, inverts_and_scales_both_ways) {
  PointRule door = digital("SA0"), air = digital("SA1"), pressure = analog("SA10.RE");
  air.inverted = true;
  pressure.scale = 0.1;
  pressure.shift = -20.0;
  PointRule valve = digital("SA2"), speed = analog("SA12.RE");
  valve.input = speed.input = false;
  valve.inverted = true;
  speed.scale = 0.5;
  speed.shift = 10.0;
  Bench b({door, air, pressure, valve, speed});
  b.read({1, 1, 250});
  EXPECT_TRUE(b.bit("SA0"));
  EXPECT_FALSE(b.bit("SA1"));
  EXPECT_DOUBLE_EQ(b.number("SA10.RE"), 5.0);
  b.image->packets.set_number(at("SA12.RE"), 60.0);
  EXPECT_EQ(b.stage.raw(3, b.image->packets), 1.0);
  EXPECT_DOUBLE_EQ(b.stage.raw(4, b.image->packets), 100.0);
  EXPECT_FALSE(b.bit("SA2")) << "outputs are read only";
}

TEST(PointStage, shows_a_change_after_it_has_lasted) {
  PointRule door = digital("SA0");
  door.debounce_ns = 5 * kMillisecond;
  Bench b({door});
  b.read({0});
  for (int ms = 0; ms < 4; ++ms) b.read({1});
  b.read({0});
  for (int ms = 0; ms < 5; ++ms) b.read({1});
  EXPECT_FALSE(b.bit("SA0")) << "the pulse of 4 ms began it anew";
  b.read({1});
  EXPECT_TRUE(b.bit("SA0"));
}

TEST(PointStage, holds_back_changes_below_the_hysteresis) {
  PointRule pressure = analog("SA10.RE");
  pressure.hysteresis = 2.0;
  Bench b({pressure});
  b.read({100});
  for (const double raw : {101.9, 98.1, 100.5}) {
    b.read({raw});
    EXPECT_EQ(b.number("SA10.RE"), 100.0) << raw;
  }
  b.read({102});
  EXPECT_EQ(b.number("SA10.RE"), 102.0);
}

TEST(PointStage, puts_values_of_loss_into_the_packet_at_once_and_errors_into_the_source) {
  PointRule chain = digital("SA0"), kept = digital("SA1"), open = digital("SA2"), level = analog("SA10.RE");
  chain.debounce_ns = 50 * kMillisecond;
  chain.inverted = true;
  kept.hold = true;
  open.loss = 1.0;
  level.loss = -1.0;
  Bench b({chain, kept, open, level});
  for (int ms = 0; ms < 60; ++ms) b.read({0, 1, 0, 7});
  ASSERT_TRUE(b.bit("SA0"));
  EXPECT_EQ(b.source().quality, Quality::good);
  EXPECT_EQ(b.source().errors, 0u);
  b.stage.lost(0);
  b.settle();
  EXPECT_FALSE(b.bit("SA0")) << "what is lost does not wait for its debouncing, and loss is not inverted";
  EXPECT_TRUE(b.bit("SA1"));
  EXPECT_TRUE(b.bit("SA2"));
  EXPECT_EQ(b.number("SA10.RE"), -1.0);
  EXPECT_EQ(b.source().quality, Quality::bad);
  EXPECT_EQ(b.source().updated_ns, 59 * kMillisecond);
  b.stage.lost(0);
  b.settle();
  EXPECT_EQ(b.source().errors, 1u) << "one loss";
  b.read({0, 1, 0, 7});
  EXPECT_EQ(b.source().quality, Quality::good);
  EXPECT_FALSE(b.bit("SA0")) << "what comes back has to last";
  EXPECT_FALSE(b.bit("SA2"));
}

TEST(PointStage, ages_a_group_to_stale_and_then_to_bad) {
  PointRule door = digital("SA0");
  Bench b({door}, {3 * kMillisecond, 6 * kMillisecond});
  b.settle();
  EXPECT_EQ(b.source().quality, Quality::never);
  b.read({1});
  std::string seen;
  for (int ms = 1; ms <= 8; ++ms) {
    b.settle();
    seen += std::to_string(static_cast<int>(b.source().quality)) + (b.bit("SA0") ? "+ " : "- ");
  }
  EXPECT_EQ(seen, "1+ 1+ 1+ 2+ 2+ 2+ 3- 3- ");
}

TEST(PointStage, that_has_never_been_read_leaves_the_packet_alone_until_it_is_too_old) {
  PointRule door = digital("SA0");
  Bench b({door}, {0, 3 * kMillisecond});
  b.image->packets.set_bit(at("SA0"), true);
  for (int ms = 0; ms <= 3; ++ms) b.settle();
  EXPECT_EQ(b.source().quality, Quality::never);
  EXPECT_TRUE(b.bit("SA0"));
  b.settle();
  EXPECT_EQ(b.source().quality, Quality::bad);
  EXPECT_FALSE(b.bit("SA0"));
}

TEST(PointStage, a_source_is_as_good_as_its_worst_group) {
  PointRule slow = digital("SA1");
  slow.group = 1;
  PointStage stage({digital("SA0"), slow}, 0, {{0, 0}, {kMillisecond, 2 * kMillisecond}});
  auto image = std::make_unique<ProcessImage>();
  stage.fresh(0, 0);
  stage.fresh(1, 0);
  stage.settle(*image);
  EXPECT_EQ(image->sources[0].quality, Quality::good);
  image->now.t_ns = 2 * kMillisecond;
  stage.fresh(0, image->now.t_ns);
  stage.settle(*image);
  EXPECT_EQ(image->sources[0].quality, Quality::stale);
}

TEST(PointStage, tells_the_age_of_the_group_that_is_too_old_not_of_the_freshest) {
  PointRule slow = digital("SA1"), slower = digital("SA2");
  slow.group = 1;
  slower.group = 2;
  const AgeLimits limits{3 * kMillisecond, 6 * kMillisecond};
  PointStage stage({digital("SA0"), slow, slower}, 0, {limits, limits, limits});
  auto image = std::make_unique<ProcessImage>();
  image->now.t_ns = 100 * kMillisecond;
  for (std::size_t group = 0; group < 3; ++group) stage.fresh(group, (100 + group) * kMillisecond);
  stage.settle(*image);
  image->now.t_ns = 105 * kMillisecond;
  stage.fresh(0, image->now.t_ns);
  stage.settle(*image);
  EXPECT_EQ(image->sources[0].quality, Quality::stale);
  EXPECT_EQ(image->sources[0].updated_ns, 101 * kMillisecond) << "4 ms old, 0 ms and 3 ms are not";
  image->now.t_ns = 107 * kMillisecond + 1;
  stage.fresh(0, image->now.t_ns);
  stage.settle(*image);
  EXPECT_EQ(image->sources[0].quality, Quality::bad) << "the slow one, while the slower one is stale";
  EXPECT_EQ(image->sources[0].updated_ns, 101 * kMillisecond);
  stage.fresh(1, image->now.t_ns);
  stage.settle(*image);
  EXPECT_EQ(image->sources[0].quality, Quality::stale);
  EXPECT_EQ(image->sources[0].updated_ns, 102 * kMillisecond);
}

TEST(PointStage, tells_of_a_group_that_never_came_how_long_it_is_awaited) {
  PointStage stage({digital("SA0")}, 0, {{3 * kMillisecond, 6 * kMillisecond}});
  auto image = std::make_unique<ProcessImage>();
  for (const int ms : {1000, 1007}) {
    image->now.t_ns = ms * kMillisecond;
    stage.settle(*image);
  }
  EXPECT_EQ(image->sources[0].quality, Quality::bad);
  EXPECT_EQ(image->sources[0].updated_ns, 1000 * kMillisecond);
}

TEST(PointStage, tells_edges_with_their_times_and_counts_those_without_room) {
  PointRule probe = digital("SA0");
  probe.inverted = true;
  PointStage stage({probe}, -1);
  auto image = std::make_unique<ProcessImage>();
  stage.edge(0, true, 10);
  stage.edge(0, true, 20);
  stage.edge(0, false, 30);
  stage.fresh(0, 30);
  stage.settle(*image);
  ASSERT_EQ(image->edges.list().size(), 1u) << "the first level and an unchanged one are no edges";
  EXPECT_EQ(image->edges.list()[0].place, at("SA0"));
  EXPECT_TRUE(image->edges.list()[0].level);
  EXPECT_EQ(image->edges.list()[0].t_ns, 30);
  image->edges.clear();
  for (int n = 0; n < 40; ++n) stage.edge(0, n % 2 == 0, 100 + n);
  stage.settle(*image);
  EXPECT_EQ(image->edges.list().size(), Edges::kCapacity);
  EXPECT_EQ(image->edges.lost(), 40 - Edges::kCapacity);
}

}  // namespace
}  // namespace servogate::image
