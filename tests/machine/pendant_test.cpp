// SPDX-License-Identifier: Apache-2.0
// The pendants of the product: their device files against the reports that their documents show.
#include <gtest/gtest.h>

#include "firmware_if/pendant/display.hpp"
#include "machine/loading/pendant_layout.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

using Bytes = std::vector<std::uint8_t>;

pendant::Layout layout(const std::string& name) {
  const DeviceResult r = load_device(test::source("devices/" + name + ".toml"));
  EXPECT_TRUE(r.ok()) << test::lines_of(r.findings, text::Language::english);
  return pendant_layout(r.device);
}

bool pressed(const pendant::Reading& reading, const pendant::Layout& of, const char* button) {
  return (reading.buttons >> of.button(button) & 1u) != 0;
}

// LinuxCNC, src/hal/user_comps/xhc-whb04b-6/README.md, "USB and key press events".
TEST(PendantFiles, whb04b_reads_what_its_document_shows) {
  const pendant::Layout l = layout("xhc-whb04b-6");
  pendant::ReportReader reader(l);
  const auto reset = reader.read(Bytes{0x04, 0x82, 0x01, 0x00, 0x0e, 0x12, 0x00, 0x81});
  ASSERT_TRUE(reset);
  EXPECT_TRUE(pressed(*reset, l, "reset"));
  EXPECT_EQ(l.axes[static_cast<std::size_t>(reset->axis)].letter, 'Y');
  EXPECT_EQ(l.steps[static_cast<std::size_t>(reset->step)].length, 0.01);
  const auto start = reader.read(Bytes{0x04, 0x47, 0x03, 0x00, 0x10, 0x12, 0x00, 0x45});
  ASSERT_TRUE(start);
  EXPECT_TRUE(pressed(*start, l, "start"));
  EXPECT_EQ(l.steps[static_cast<std::size_t>(start->step)].length, 1.0);
  EXPECT_EQ(reader.read(Bytes{0x04, 0x9d, 0x00, 0x00, 0x0e, 0x12, 0x01, 0x9c})->counts, 1);
  EXPECT_EQ(reader.read(Bytes{0x04, 0x00, 0x00, 0x00, 0x1b, 0x06, 0x00, 0x00})->step, -1) << "100 %";
}

// The same, "Transmission data structure", and usb.h: 21 bytes in three feature reports of number 6.
TEST(PendantFiles, whb04b_shows_three_axes_feed_and_spindle) {
  pendant::Shown shown;
  shown.work = {12.345, -0.5, 100.0};
  shown.feed_mm_min = 300.0;
  shown.spindle_rpm = 6000.0;
  const auto reports = pendant::show(layout("xhc-whb04b-6"), shown);
  ASSERT_EQ(reports.size(), 3u);
  for (const auto& r : reports) {
    EXPECT_EQ(r.size(), 8u);
    EXPECT_EQ(r[0], 6);
  }
  EXPECT_EQ(reports[0], (Bytes{6, 0xFE, 0xFD, 0x0C, 0x81, 12, 0, 0x7A}));
  EXPECT_EQ(reports[2], (Bytes{6, 0, 0, 0x2C, 0x01, 0x70, 0x17, 0}));
}

// LinuxCNC, src/hal/user_comps/xhc-hb04.cc: cb_response_in(), and STEPSIZE_BYTE of xhc_display_encode().
TEST(PendantFiles, hb04_reads_and_shows_what_its_document_says) {
  const pendant::Layout l = layout("xhc-hb04");
  pendant::ReportReader reader(l);
  const auto read = reader.read(Bytes{0x04, 0x17, 0x00, 0x18, 0xff, 0x00});
  ASSERT_TRUE(read);
  EXPECT_TRUE(pressed(*read, l, "reset"));
  EXPECT_EQ(l.axes[static_cast<std::size_t>(read->axis)].letter, 'A');
  EXPECT_EQ(read->counts, -1);
  EXPECT_EQ(reader.read(Bytes{0x04, 0, 0, 0x15, 5, 0})->axis, -1) << "Feed";
  pendant::Shown shown;
  shown.step = 2;
  const auto reports = pendant::show(l, shown);
  ASSERT_EQ(reports.size(), 6u);
  EXPECT_EQ(reports[5][1], 0x08) << "byte 35 is the step: 0.1 mm";
}

// LinuxCNC, src/hal/user_comps/shuttle.c: contour_dev, read_update().
TEST(PendantFiles, shuttles_read_what_their_document_says) {
  for (const auto& [name, button, bit] :
       {std::tuple("contour-shuttlexpress", "b1", 0x0010), std::tuple("contour-shuttlexpress", "b5", 0x0100),
        std::tuple("contour-shuttlepro-v2", "b1", 0x0001),
        std::tuple("contour-shuttlepro-v2", "b15", 0x4000)}) {
    const pendant::Layout l = layout(name);
    pendant::ReportReader reader(l);
    reader.read(Bytes{0, 200, 0, 0, 0});
    const auto read = reader.read(
        Bytes{0xFB, 203, 0, static_cast<std::uint8_t>(bit & 0xFF), static_cast<std::uint8_t>(bit >> 8)});
    ASSERT_TRUE(read) << name;
    EXPECT_EQ(read->ring, -5);
    EXPECT_EQ(read->counts, 3);
    EXPECT_TRUE(pressed(*read, l, button)) << name << " " << button;
  }
}

TEST(PendantFiles, every_one_names_its_document_and_what_it_was_tried_on) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::source("devices"))) {
    if (entry.path().extension() != ".toml") continue;
    const DeviceResult r = load_device(entry.path().string());
    if (r.device.kind != DeviceKind::pendant) continue;
    ++count;
    EXPECT_NE(r.device.pendant.source, "") << entry.path();
    EXPECT_NE(r.device.pendant.tested, "") << entry.path();
    const std::string page = test::read_text(test::source("docs/pendants.md"));
    EXPECT_NE(page.find("`" + entry.path().stem().string() + "`"), std::string::npos) << entry.path();
    const std::string rules = test::read_text(test::source("gateway/system/70-servogate.rules"));
    char product[8];
    std::snprintf(product, sizeof product, "%04x", static_cast<unsigned>(r.device.pendant.usb_product));
    EXPECT_NE(rules.find(product), std::string::npos) << entry.path() << " has no udev rule";
  }
  EXPECT_GE(count, 4);
}

TEST(PendantUrl, is_any_a_serial_number_or_a_path) {
  EXPECT_TRUE(hid_place("hid:any"));
  EXPECT_EQ(hid_place("hid:AB12")->serial, "AB12");
  EXPECT_EQ(hid_place("hid:/dev/hidraw3")->path, "/dev/hidraw3");
  for (const char* url : {"", "hid:", "hid", "mock:x"}) EXPECT_FALSE(hid_place(url)) << url;
}

}  // namespace
}  // namespace servogate::machine
