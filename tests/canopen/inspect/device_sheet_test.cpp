// SPDX-License-Identifier: Apache-2.0
// Data sheets written of devices that have none.
#include "firmware_if/canopen/inspect/device_sheet.hpp"

#include <gtest/gtest.h>

#include "drivers/mock/drive/device_objects.hpp"

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

ReadObject read(std::uint16_t index, std::uint8_t subindex, Bytes data, bool record = false) {
  return {index, subindex, {SdoStatus::done, AbortCode::none, std::move(data)}, record};
}
ReadObject refused(std::uint16_t index, std::uint8_t subindex, AbortCode code, bool record = false) {
  return {index, subindex, {SdoStatus::aborted, code, {}}, record};
}

SheetOrigin origin_of(NodeId node) {
  SheetOrigin origin;
  origin.file = "drive.eds";
  origin.date = "11-25-2026";
  origin.time = "03:04PM";
  origin.command = "servogate od";
  origin.node = node;
  origin.bit_rate = 500'000;
  origin.ranges = {{0x1000, 0x10FF}, {0x2000, 0x5FFF}};
  return origin;
}

std::string story(const std::vector<text::Finding>& findings) {
  std::string all;
  for (const auto& f : findings) all += f.str(text::Language::english) + "\n";
  return all;
}
/// What the file says when it is read again, without a word of complaint.
Eds through_a_file(const DeviceSheet& sheet) {
  const EdsResult back = read_eds(write_eds(sheet.eds), "drive.eds");
  EXPECT_EQ(story(back.findings), "");
  return back.eds;
}
std::string default_of(const Eds& eds, std::uint16_t index, std::uint8_t subindex = 0) {
  const EdsEntry* e = eds.find(index, subindex);
  return e == nullptr ? "no entry" : e->default_value ? e->default_value->text : "no default";
}

const std::vector<ReadObject> kDrive{
    read(0x1000, 0, {0x92, 0x01, 0x02, 0x00}),
    read(0x1001, 0, {0x81}),
    read(0x1008, 0, {'A', 'x', 'i', 's'}),
    read(0x1014, 0, {0x85, 0, 0, 0}),
    read(0x1018, 0, {4}, true),
    read(0x1018, 1, {0x2E, 1, 0, 0}, true),
    read(0x1018, 4, {7, 0, 0, 0}, true),
    read(0x1400, 0, {2}, true),
    read(0x1400, 1, {0x05, 0x02, 0, 0}, true),
    read(0x1017, 0, {1, 0, 0, 0}),  // four bytes where the standard has two
    read(0x2001, 0, {1, 2}),
    read(0x2002, 0, {'t', 'w', 'o', '\n', 'l', 'i', 'n', 'e', 's'}),
    read(0x2003, 0, {0xE9, ' ', 1, 2, 3}),
    refused(0x2004, 0, AbortCode::write_only),
    refused(0x60C4, 6, AbortCode::write_only, true),
    read(0x6040, 0, {0x0F, 0}),
    read(0x6064, 0, {1, 2, 3, 4}),
    read(0x6065, 0, {0, 0, 1, 0}),
};

TEST(DeviceSheet, of_a_reading_has_what_the_standards_know_and_says_what_was_guessed) {
  const DeviceSheet sheet = sheet_of_device(kDrive, nullptr, origin_of(5));
  const Eds eds = through_a_file(sheet);
  EXPECT_EQ(sheet.guessed, (std::vector<std::string>{"1017h:00", "2001h:00", "2002h:00", "2003h:00"}));
  EXPECT_EQ(sheet.left_out, std::vector<std::string>{"2004h:00"});
  EXPECT_EQ(sheet.entries, static_cast<int>(kDrive.size()) - 1);
  EXPECT_EQ(default_of(eds, 0x1000), "0x20192");
  EXPECT_EQ(default_of(eds, 0x1008), "Axis");
  EXPECT_EQ(default_of(eds, 0x1014), "$NODEID+0x80");
  EXPECT_EQ(default_of(eds, 0x1400, 1), "$NODEID+0x200");
  EXPECT_EQ(default_of(eds, 0x6065), "0x10000");
  for (const std::uint16_t living : {0x1001, 0x6040, 0x6064})
    EXPECT_EQ(default_of(eds, living), "no default");
  EXPECT_EQ(default_of(eds, 0x1018, 4), "no default") << "the serial number of one device";
  EXPECT_EQ(eds.find(0x6064, 0)->data_type, 0x04);
  EXPECT_EQ(eds.find(0x6064, 0)->access, EdsAccess::ro);
  EXPECT_TRUE(eds.find(0x6064, 0)->pdo_mapping);
  EXPECT_EQ(eds.find(0x1017, 0)->data_type, 0x07);
  EXPECT_EQ(eds.find(0x2001, 0)->data_type, 0x06);
  EXPECT_EQ(eds.find(0x60C4, 6)->access, EdsAccess::wo);
  EXPECT_EQ(eds.find(0x2004, 0), nullptr);
  EXPECT_EQ(eds.device("VendorNumber"), "0x0000012E");
  EXPECT_EQ(eds.device("ProductName"), "Axis");
  EXPECT_EQ(eds.device("BaudRate_500"), "1");
  EXPECT_EQ(eds.device("BaudRate_1000"), "0");
  EXPECT_EQ(eds.device("NrOfRXPDO"), "1");
  std::string comments;
  for (const auto& [key, value] : eds.comments) comments += value + "\n";
  EXPECT_NE(comments.find("Guessed: "), std::string::npos) << comments;
  EXPECT_NE(comments.find("\n1017h:00 2001h:00 2002h:00 2003h:00\n"), std::string::npos) << comments;
  EXPECT_NE(comments.find("1000h-10FFh, 2000h-5FFFh"), std::string::npos) << comments;
  EXPECT_NE(comments.find("\n2004h:00\n"), std::string::npos) << comments;
}

TEST(DeviceSheet, with_a_given_one_has_its_words_for_what_the_device_has) {
  const Eds given = read_eds(
                        "[DeviceInfo]\nVendorName=Maker\n"
                        "[2001]\nParameterName=Gain\nObjectType=7\nDataType=3\nAccessType=rww\nPDOMapping=1\n"
                        "DefaultValue=12\nLowLimit=-5\nHighLimit=100\n"
                        "[2003]\nParameterName=Key\nObjectType=7\nDataType=10\nAccessType=rw\n"
                        "[2009]\nParameterName=Option\nObjectType=7\nDataType=7\nAccessType=rw\n",
                        "given.eds")
                        .eds;
  const std::vector<ReadObject> objects{read(0x2001, 0, {1, 2}), read(0x2003, 0, {0xAB, 0xCD, 1}),
                                        refused(0x2009, 0, AbortCode::object_does_not_exist)};
  const DeviceSheet sheet = sheet_of_device(objects, &given, origin_of(5));
  const Eds eds = through_a_file(sheet);
  EXPECT_TRUE(sheet.guessed.empty());
  EXPECT_EQ(eds.objects.size(), 2u);
  EXPECT_EQ(default_of(eds, 0x2001), "0xC") << "the sheet's, not the reading's";
  EXPECT_EQ(eds.find(0x2001, 0)->name, "Gain");
  EXPECT_EQ(eds.find(0x2001, 0)->access, EdsAccess::rww);
  EXPECT_EQ(eds.find(0x2001, 0)->low_limit->number->value, -5);
  EXPECT_EQ(default_of(eds, 0x2003), "ABCD01") << "the sheet has none";
  EXPECT_EQ(eds.device("VendorName"), "Maker");
}

/// The PDO map 1600h and the error history 1003h, with two places in use and one unused, or none.
class Counted final : public SdoAccess {
 public:
  SdoOutcome read(NodeId, std::uint16_t index, std::uint8_t subindex) override {
    if (index != 0x1600 && index != 0x1003) return {SdoStatus::aborted, AbortCode::object_does_not_exist, {}};
    if (subindex > 3) return {SdoStatus::aborted, AbortCode::subindex_does_not_exist, {}};
    const bool map = index == 0x1600;
    if (subindex == 0) return {SdoStatus::done, AbortCode::none, {static_cast<std::uint8_t>(map ? 2 : 0)}};
    if (!map) return {SdoStatus::aborted, AbortCode::no_data_available, {}};
    return {SdoStatus::done, AbortCode::none, {0x10, 0, 0x40, 0x60}};
  }
  SdoOutcome write(NodeId, std::uint16_t, std::uint8_t, std::span<const std::uint8_t>) override { return {}; }
};

TEST(DeviceSheet, has_the_places_of_maps_and_errors_that_are_not_in_use) {
  Counted device;
  const auto never = [] { return false; };
  std::vector<ReadObject> objects = walk(device, 5, {{0x1003, 0x1003}, {0x1600, 0x1600}}, never);
  read_unused_places(device, 5, objects, never);
  const Eds eds = through_a_file(sheet_of_device(objects, nullptr, origin_of(5)));
  for (const std::uint16_t index : {0x1003, 0x1600}) {
    ASSERT_TRUE(eds.objects.contains(index));
    EXPECT_EQ(eds.objects.at(index).subs.size(), 4u) << std::hex << index;
  }
  EXPECT_EQ(default_of(eds, 0x1600), "0x2");
  EXPECT_EQ(default_of(eds, 0x1600, 3), "0x60400010");
  EXPECT_EQ(eds.find(0x1003, 2)->data_type, 0x07);
}

/// A simulated drive, the sheet that it writes of itself, and one made of that sheet: the same rows.
void expect_same_rows(const mock::SimulatedDriveConfig& config) {
  const mock::DeviceObjects original = mock::device_objects(config);
  const DeviceSheet sheet =
      sheet_of_rows(original.rows, original.hidden, config.data_sheet.get(), origin_of(config.node_id));
  EXPECT_TRUE(sheet.no_value.empty());
  mock::SimulatedDriveConfig again;
  again.node_id = config.node_id;
  again.serial_number = config.serial_number;
  again.data_sheet = std::make_shared<const Eds>(through_a_file(sheet));
  const mock::DeviceObjects copy = mock::device_objects(again);
  EXPECT_TRUE(copy.left_out.empty());
  ObjectDictionary first({original.rows}), second({copy.rows});
  for (const ObjectSpec& row : original.hidden) first.hide(first.find(row.index, row.subindex));
  for (const ObjectSpec& row : copy.hidden) second.hide(second.find(row.index, row.subindex));
  int compared = 0;
  for (int slot = 0; slot < first.size(); ++slot) {
    const ObjectSpec& row = first.spec(slot);
    SCOPED_TRACE(address_text(row.index, row.subindex));
    const auto other = second.find_visible(row.index, row.subindex);
    const bool visible = first.find_visible(row.index, row.subindex) != ObjectDictionary::kNone;
    ASSERT_EQ(visible, other != ObjectDictionary::kNone);
    if (!visible) continue;
    ++compared;
    const ObjectSpec& got = second.spec(other);
    EXPECT_EQ(got.type, row.type);
    EXPECT_EQ(got.access, row.access);
    EXPECT_EQ(second.value(other), first.value(slot));
    EXPECT_EQ(second.text(other), first.text(slot));
    // An object that can only be read has no other PDO than a TPDO, whatever the row says.
    EXPECT_EQ(got.mappable,
              row.access == Access::rw || row.mappable == Mappable::no ? row.mappable : got.mappable);
    EXPECT_EQ(got.mappable == Mappable::no, row.mappable == Mappable::no);
    if (size_of(row.type) == 0) continue;  // a text has no range
    for (const std::int64_t value : {0, 1, 8, 100})
      EXPECT_EQ(second.check_range(other, value), first.check_range(slot, value)) << value;
  }
  EXPECT_EQ(compared, sheet.entries);
}

TEST(DeviceSheet, of_a_simulated_drive_makes_the_same_drive_again) {
  mock::SimulatedDriveConfig config;
  config.node_id = 5;
  expect_same_rows(config);
  config.node_id = 100;
  config.device_type = 0x0004'0192;
  config.product_code = 0x1234'5678;
  config.modes = 0x81;
  config.plant.counts_per_rev = 4000;
  expect_same_rows(config);
}

TEST(DeviceSheet, of_a_simulated_drive_with_a_sheet_has_all_of_that_sheet) {
  std::string text = "[DeviceInfo]\nVendorName=x\n";
  const struct {
    int type;
    const char *access, *value;
  } rows[] = {{1, "rw", "1"},         {2, "ro", "-5"},
              {3, "rwr", "-300"},     {0x10, "rww", "-8388608"},
              {0x12, "rw", "-1"},     {0x1A, "rw", "0xFFFFFF"},
              {0x08, "rw", "1.5"},    {0x11, "rw", "-0.1"},
              {9, "const", "Text"},   {10, "rw", "00FF"},
              {11, "wo", "41040000"}, {12, "rw", "010203040506"},
              {15, "rw", "DEAD"},     {0x1B, "rw", "0xFFFFFFFFFFFFFFFF"}};
  int index = 0x3000;
  for (const auto& row : rows) {
    char lines[200];
    std::snprintf(lines, sizeof lines,
                  "[%04X]\nParameterName=Own %d\nObjectType=%d\nDataType=%d\nAccessType=%s\nPDOMapping=%d\n"
                  "DefaultValue=%s\n",
                  index++, row.type, row.type == 15 ? 2 : 7, row.type, row.access, row.type < 9, row.value);
    text += lines;
  }
  const EdsResult sheet = read_eds(text, "own.eds");
  ASSERT_EQ(story(sheet.findings), "");
  mock::SimulatedDriveConfig config;
  config.data_sheet = std::make_shared<const Eds>(sheet.eds);
  expect_same_rows(config);
}

}  // namespace
}  // namespace servogate::canopen
