// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>

#include "drivers/mock/drive/device_objects.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "tests/mock/drive/drive_bench.hpp"
#include "tests/property_seed.hpp"

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

using Bytes = NodeBench::Bytes;

/// A drive of a data sheet and a client that reads and writes any object of it.
class SheetBench {
 public:
  SheetBench(const std::string& objects, bool blocks) : bench_(with(objects)) {
    client_.allow_blocks(blocks);
  }

  Bytes read(std::uint16_t index) {
    EXPECT_TRUE(client_.upload_into(index, 0, memory_));
    EXPECT_EQ(run(), canopen::AbortCode::none) << std::hex << index;
    return {client_.data().begin(), client_.data().end()};
  }
  canopen::AbortCode write(std::uint16_t index, const Bytes& bytes) {
    EXPECT_TRUE(client_.download_from(index, 0, bytes));
    return run();
  }

 private:
  canopen::AbortCode run() {
    for (int ms = 0; client_.busy() && ms < 100'000; ++ms) {
      while (client_.poll(bench_.now, bench_.master)) {
      }
      bench_.run(1);
      while (const auto frame = bench_.take(0x580 + NodeBench::kNode)) client_.on_frame(*frame);
    }
    return client_.result().abort;
  }

  DriveBench bench_;
  canopen::SdoClient client_{NodeBench::kNode, 200 * image::kMillisecond, 2};
  Bytes memory_ = Bytes(200'000);
};

/// A value of a data type: `length` bytes where the type is a string or domain.
Bytes random_value(int type, std::size_t length, std::mt19937_64& random) {
  const std::size_t size = canopen::size_of(static_cast<canopen::DataType>(type));
  Bytes value(size > 0 ? size : length);
  for (auto& b : value) b = static_cast<std::uint8_t>(random());
  if (type == 0x01) value[0] &= 1;
  if (type == 0x09)
    for (auto& b : value) b = static_cast<std::uint8_t>('!' + random() % 90);
  if (type == 0x08) value[3] = 0x41;  // no NaN, which has many bit patterns and one text
  if (type == 0x11) value[7] = 0x40, value[6] &= 0x7F;
  return value;
}

TEST(DataSheetDrive, has_every_data_type_and_gives_back_every_byte_of_its_values) {
  std::mt19937_64 random(test::property_seed());
  for (const bool blocks : {false, true}) {
    for (const std::size_t length : {1u, 3u, 4u, 5u, 63u, 64u, 65u, 500u, 1000u}) {
      std::string objects;
      std::map<std::uint16_t, std::pair<int, Bytes>> wanted;
      for (int type = 1; type < 0x1C; ++type) {
        if (!canopen::eds_type_known(static_cast<std::uint16_t>(type))) continue;
        const auto index = static_cast<std::uint16_t>(0x3000 + type);
        const Bytes value = random_value(type, length, random);
        const auto text = canopen::eds_value_text(value, static_cast<std::uint16_t>(type));
        ASSERT_TRUE(text) << type;
        objects += entry(canopen::address_text(index, 0).substr(0, 4), "Value", type, "rw", *text);
        wanted[index] = {type, value};
      }
      EXPECT_EQ(wanted.size(), 25u);
      SheetBench bench(objects, blocks);
      for (auto& [index, place] : wanted) {
        SCOPED_TRACE(::testing::Message() << "type " << place.first << ", " << length << " bytes");
        EXPECT_EQ(bench.read(index), place.second) << "the default of the sheet";
        place.second = random_value(place.first, 1 + random() % 1024, random);
        EXPECT_EQ(bench.write(index, place.second), canopen::AbortCode::none);
      }
      for (const auto& [index, place] : wanted) EXPECT_EQ(bench.read(index), place.second) << place.first;
    }
  }
}

TEST(DataSheetDrive, has_room_for_long_strings_and_domains_and_refuses_what_is_longer) {
  std::mt19937_64 random(test::property_seed());
  const Bytes octets = random_value(0x0A, 5000, random), domain = random_value(0x0F, 70'000, random);
  SheetBench bench(
      entry("3001", "Text", 9, "rw", "short") + entry("3002", "Octets", 10, "rw", canopen::hex_text(octets)) +
          entry("3003", "Domain", 15, "rw") + entry("3004", "Domain", 15, "ro", canopen::hex_text(domain)),
      true);
  EXPECT_EQ(bench.read(0x3002), octets);
  EXPECT_EQ(bench.read(0x3004), domain);
  EXPECT_EQ(bench.read(0x3003), Bytes{});
  const Bytes full = random_value(0x0F, 65'536, random);
  EXPECT_EQ(bench.write(0x3003, full), canopen::AbortCode::none);
  EXPECT_EQ(bench.write(0x3003, Bytes(65'537)), canopen::AbortCode::length_too_high);
  EXPECT_EQ(bench.read(0x3003), full) << "as it was";
  EXPECT_EQ(bench.write(0x3001, Bytes(1024, 'x')), canopen::AbortCode::none);
  EXPECT_EQ(bench.write(0x3001, Bytes(1025, 'y')), canopen::AbortCode::length_too_high);
  EXPECT_EQ(bench.read(0x3001), Bytes(1024, 'x'));
  EXPECT_EQ(bench.write(0x3002, Bytes{}), canopen::AbortCode::none);
  EXPECT_EQ(bench.read(0x3002), Bytes{}) << "an empty string";
  EXPECT_EQ(bench.write(0x3004, Bytes{1}), canopen::AbortCode::read_only);
}

TEST(DataSheetDrive, compares_reals_with_their_limits_as_numbers) {
  const std::string limits = "LowLimit=-10.5\nHighLimit=2\n";
  SheetBench bench(
      entry("3001", "Real", 8, "rw", "-3") + limits + entry("3002", "Real", 17, "rw", "1.5") + limits, false);
  for (const auto& [value, code] : {std::pair{-10.5, canopen::AbortCode::none},
                                    {1.0, canopen::AbortCode::none},
                                    {2.5, canopen::AbortCode::value_too_high},
                                    {-11.0, canopen::AbortCode::value_too_low}}) {
    Bytes narrow(4), wide(8);
    canopen::store_le(std::bit_cast<std::uint32_t>(static_cast<float>(value)), narrow);
    canopen::store_le(std::bit_cast<std::uint64_t>(value), wide);
    EXPECT_EQ(bench.write(0x3001, narrow), code) << value;
    EXPECT_EQ(bench.write(0x3002, wide), code) << value;
  }
}

}  // namespace
}  // namespace servogate::mock
