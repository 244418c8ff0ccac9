// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "drivers/mock/drive/device_objects.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

std::string entry(const std::string& section, const std::string& name, int type, const std::string& access,
                  const std::string& value = "") {
  char data_type[16];
  std::snprintf(data_type, sizeof data_type, "0x%04X", type);
  return "[" + section + "]\nParameterName=" + name + "\nObjectType=0x7\nDataType=" + data_type +
         "\nAccessType=" + access + "\n" + (value.empty() ? "" : "DefaultValue=" + value + "\n") +
         "PDOMapping=0\n";
}

std::shared_ptr<const canopen::Eds> sheet(const std::string& objects) {
  canopen::EdsResult result = canopen::read_eds("[DeviceInfo]\nVendorName=x\n" + objects, "sheet.eds");
  return std::make_shared<const canopen::Eds>(std::move(result.eds));
}

SimulatedDriveConfig with(const std::string& objects) {
  SimulatedDriveConfig config;
  config.data_sheet = sheet(objects);
  return config;
}

const canopen::ObjectSpec* row(const DeviceObjects& objects, std::uint16_t index, std::uint8_t subindex = 0) {
  const canopen::ObjectSpec* found = nullptr;
  for (const auto& r : objects.rows)
    if (r.index == index && r.subindex == subindex) found = &r;
  return found;
}
bool hidden(const DeviceObjects& objects, std::uint16_t index, std::uint8_t subindex = 0) {
  for (const auto& r : objects.hidden)
    if (r.index == index && r.subindex == subindex) return true;
  return false;
}

TEST(DataSheetDrive, has_the_objects_of_its_sheet_with_their_values_and_shows_no_others) {
  const SimulatedDriveConfig config =
      with(entry("1000", "Device type", 7, "ro", "0x00040192") + entry("6041", "Statusword", 6, "ro") +
           entry("6083", "Profile acceleration", 7, "rw", "4711") + entry("3000", "Gain", 6, "rw", "7"));
  const DeviceObjects objects = device_objects(config);
  EXPECT_EQ(row(objects, 0x1000)->value, 0x0004'0192);
  EXPECT_EQ(row(objects, 0x6083)->value, 4711);
  EXPECT_EQ(row(objects, 0x3000)->value, 7);
  EXPECT_FALSE(hidden(objects, 0x6083));
  EXPECT_TRUE(hidden(objects, 0x6084)) << "the simulation needs it, the sheet has it not";
  EXPECT_TRUE(hidden(objects, 0x6060));
  EXPECT_TRUE(objects.left_out.empty());
}

TEST(DataSheetDrive, keeps_the_simulations_value_where_the_sheet_says_none) {
  const SimulatedDriveConfig config = with(entry("6502", "Supported drive modes", 7, "ro"));
  EXPECT_EQ(row(device_objects(config), 0x6502)->value, 0x3EF);
}

TEST(DataSheetDrive, leaves_out_what_its_services_have_no_room_for) {
  std::string objects = entry("1010", "Store", 7, "rw");
  objects = "[1016]\nParameterName=Consumers\nObjectType=0x8\nSubNumber=3\n" +
            entry("1016sub0", "Number", 5, "ro", "9") + entry("1016sub4", "Consumer 4", 7, "rw", "0") +
            entry("1016sub9", "Consumer 9", 7, "rw", "0") +
            "[1805]\nParameterName=TPDO 6\nObjectType=0x9\nSubNumber=2\n" +
            entry("1805sub0", "Number", 5, "ro", "2") + entry("1805sub1", "COB-ID", 7, "rw", "0x80000000");
  const DeviceObjects built = device_objects(with(objects));
  EXPECT_EQ(row(built, 0x1016)->value, 4) << "no more than the simulation watches";
  EXPECT_EQ(row(built, 0x1016, 9), nullptr);
  EXPECT_EQ(row(built, 0x1805, 1), nullptr);
  EXPECT_EQ(built.left_out, (std::vector<ObjectPlace>{{0x1016, 9}, {0x1805, 0}, {0x1805, 1}}));
}

TEST(DataSheetDrive, on_the_bus_an_object_that_the_sheet_does_not_have_does_not_exist) {
  canopen::ObjectDictionary dictionary({device_objects(with(entry("6041", "Statusword", 6, "ro"))).rows});
  dictionary.hide(dictionary.find(0x6083, 0));
  EXPECT_EQ(dictionary.find_visible(0x6083, 0), canopen::ObjectDictionary::kNone);
  EXPECT_FALSE(dictionary.index_visible(0x6083));
  EXPECT_NE(dictionary.find(0x6083, 0), canopen::ObjectDictionary::kNone) << "its owner still has it";
  EXPECT_TRUE(dictionary.index_visible(0x6041));
}

}  // namespace
}  // namespace servogate::mock
