// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/report.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/pendant/makes.hpp"
#include "tests/property_seed.hpp"

namespace servogate::pendant {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Reports that the LinuxCNC project shows for a WHB04B-6 (src/hal/user_comps/xhc-whb04b-6/README.md, "USB and
// key press events").
TEST(PendantReport, ADocumentedReportIsReadAsDocumented) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  const auto axis_y = reader.read(Bytes{0x04, 0xd3, 0x00, 0x00, 0x0e, 0x12, 0x00, 0xd2});
  ASSERT_TRUE(axis_y);
  EXPECT_EQ(*axis_y, (Reading{.axis = 1, .step = 1}));
  const auto reset = reader.read(Bytes{0x04, 0x82, 0x01, 0x00, 0x0e, 0x12, 0x00, 0x81});
  ASSERT_TRUE(reset);
  EXPECT_EQ(reset->buttons, 1u << layout.button("reset"));
  const auto turned = reader.read(Bytes{0x04, 0x9d, 0x00, 0x00, 0x0e, 0x12, 0x01, 0x9c});
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->counts, 1);
}

TEST(PendantReport, TwoKeysAreReadTogetherInAnyOrder) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  const std::uint32_t both = 1u << layout.button("fn") | 1u << layout.button("macro");
  EXPECT_EQ(reader.read(Bytes{4, 0, 0x0c, 0x10, 0x0e, 0x11, 0, 0})->buttons, both);
  EXPECT_EQ(reader.read(Bytes{4, 0, 0x10, 0x0c, 0x0e, 0x11, 0, 0})->buttons, both);
}

TEST(PendantReport, AWheelTurnedBackCountsDown) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  EXPECT_EQ(reader.read(Bytes{4, 0, 0, 0, 0x0e, 0x11, 0xfd, 0})->counts, -3);
}

TEST(PendantReport, WhatIsNoReportOfThisPendantIsRefused) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  EXPECT_FALSE(reader.read(Bytes{}));
  EXPECT_FALSE(reader.read(Bytes{4, 0, 0, 0, 0x0e, 0x11, 1})) << "a byte is missing";
  EXPECT_FALSE(reader.read(Bytes{4, 0, 0, 0, 0x0e, 0x11, 1, 0, 0})) << "a byte too many";
  EXPECT_FALSE(reader.read(Bytes{5, 0, 0, 0, 0x0e, 0x11, 1, 0})) << "another number";
  EXPECT_FALSE(reader.read(Bytes{4, 0, 0x77, 0, 0x0e, 0x11, 1, 0})) << "a key that there is not";
}

TEST(PendantReport, IsAsleepWhenNoSelectorStandsAnywhereWhateverElseItSays) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  const auto asleep = reader.read(Bytes{4, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_TRUE(asleep);
  EXPECT_TRUE(asleep->asleep);
  EXPECT_TRUE(reader.read(Bytes{4, 0, 0x77, 3, 0, 0, 9, 0})->asleep) << "keys that there are not";
  EXPECT_FALSE(reader.read(Bytes{4, 0, 0, 0, 0x1b, 0x06, 0, 0})->asleep);
}

TEST(PendantReport, ASelectorInAPlaceThatNobodyKnowsIsOff) {
  const Layout layout = test::with_selectors();
  ReportReader reader(layout);
  EXPECT_EQ(reader.read(Bytes{4, 0, 0, 0, 0x1b, 0x06, 0, 0})->axis, -1);
}

TEST(PendantReport, ACounterThatRunsRoundGivesItsDifference) {
  const Layout layout = test::with_ring();
  ReportReader reader(layout);
  EXPECT_EQ(reader.read(Bytes{0, 250, 0, 0, 0})->counts, 0) << "where it stood before is not known";
  EXPECT_EQ(reader.read(Bytes{0, 255, 0, 0, 0})->counts, 5);
  EXPECT_EQ(reader.read(Bytes{0, 1, 0, 0, 0})->counts, 2);
  EXPECT_EQ(reader.read(Bytes{0, 254, 0, 0, 0})->counts, -3);
  reader.restart();
  EXPECT_EQ(reader.read(Bytes{0, 100, 0, 0, 0})->counts, 0) << "plugged in anew";
}

TEST(PendantReport, ButtonsOfARingAreBits) {
  const Layout layout = test::with_ring();
  ReportReader reader(layout);
  const auto read = reader.read(Bytes{0xf9, 0, 0, 0x10, 0x01});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->ring, -7);
  EXPECT_EQ(read->buttons, 1u << layout.button("b1") | 1u << layout.button("b5"));
  EXPECT_FALSE(reader.read(Bytes{8, 0, 0, 0, 0})) << "the ring does not go so far";
}

TEST(PendantReport, WhatIsWrittenIsReadBack) {
  std::mt19937_64 random(servogate::test::property_seed());
  const auto draw = [&random](int from, int to) {
    return std::uniform_int_distribution<int>(from, to)(random);
  };
  for (const Layout& layout : {test::with_selectors(), test::with_ring()}) {
    ReportReader reader(layout);
    ReportWriter writer(layout);
    ASSERT_TRUE(reader.read(writer.write({}).view()));
    for (int n = 0; n < 20'000; ++n) {
      Reading reading;
      const int most = layout.bits >= 0 ? static_cast<int>(layout.buttons.size()) : 2;
      for (int k = draw(0, most); k > 0; --k)
        reading.buttons |= 1u << draw(0, static_cast<int>(layout.buttons.size()) - 1);
      if (layout.axis >= 0) reading.axis = draw(-1, static_cast<int>(layout.axes.size()) - 1);
      if (layout.step >= 0) reading.step = draw(-1, static_cast<int>(layout.steps.size()) - 1);
      if (layout.ring >= 0) reading.ring = draw(-7, 7);
      reading.counts = draw(-128, 127);
      const auto read = reader.read(writer.write(reading).view());
      ASSERT_TRUE(read) << layout.name;
      ASSERT_EQ(*read, reading) << layout.name;
    }
  }
}

TEST(PendantReport, BytesByChanceAreReadOrRefusedAndNeverMore) {
  std::mt19937_64 random(servogate::test::property_seed());
  for (const Layout& layout : {test::with_selectors(), test::with_ring()}) {
    ReportReader reader(layout);
    for (int n = 0; n < 50'000; ++n) {
      Bytes bytes(random() % 12);
      for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
      if (!bytes.empty() && n % 2 == 0) bytes[0] = static_cast<std::uint8_t>(layout.report_number);
      const auto read = reader.read(bytes);
      if (!read) continue;
      ASSERT_EQ(bytes.size(), static_cast<std::size_t>(layout.report_bytes));
      ASSERT_LT(read->axis, static_cast<int>(layout.axes.size()));
      ASSERT_LT(read->step, static_cast<int>(layout.steps.size()));
      ASSERT_EQ(read->buttons >> layout.buttons.size(), 0u);
      ASSERT_LE(std::abs(read->ring), layout.ring_range);
    }
  }
}

TEST(PendantWords, WhatIsNoFormOfADeviceFileIsRefused) {
  const Layout layout = test::with_selectors();
  for (const char* text : {"", "fn", "0x0C", "0x100 fn", "0x0C Fn", "x fn", "0x0Cfn"})
    EXPECT_FALSE(parse_button(text)) << text;
  for (const char* text : {"", "0x11", "X", "0x11 x", "0x11 XY"}) EXPECT_FALSE(parse_axis(text)) << text;
  for (const char* text : {"", "0", "-1", "0x0D 0", "0x0D x", "0.001 = x", "1 2 3"})
    EXPECT_FALSE(parse_step(text)) << text;
  for (const char* text : {"", "work", "work 0", "work 7", "feed 1", "0xFFF", "12"})
    EXPECT_FALSE(parse_field(text)) << text;
  for (const char* text : {"", "reset", "reset:", "nobody: reset", "reset: fly", "reset: reset 1",
                           "home: select", "home: select x", "home: override_by", "home: override_by 0",
                           "home: mdi", "fn + fn: mdi M8", "nobody + home: mdi M8", "home: hold_axis XY"})
    EXPECT_FALSE(parse_binding(text, layout)) << text;
}

TEST(PendantWords, AMachineGivesAButtonAnotherMeaning) {
  Layout layout = test::with_selectors();
  const std::size_t before = layout.bindings.size();
  bind(layout, parse_binding("fn + macro: mdi G0 Z50", layout).value());
  EXPECT_EQ(layout.bindings.size(), before);
  EXPECT_EQ(layout.bindings.back().text, "G0 Z50");
}

}  // namespace
}  // namespace servogate::pendant
