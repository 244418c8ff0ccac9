// SPDX-License-Identifier: Apache-2.0
#include "machine/device.hpp"

#include <gtest/gtest.h>

#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

DeviceConfig device(const std::string& name) {
  DeviceResult r = load_device(test::source("devices/" + name + ".toml"));
  EXPECT_TRUE(r.ok()) << test::lines_of(r.findings, text::Language::english);
  return r.device;
}

TEST(DeviceFiles, all_of_the_product_read_without_a_finding) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::source("devices"))) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const DeviceResult r = load_device(entry.path().string());
    EXPECT_EQ(test::lines_of(r.findings, text::Language::english), "");
    for (const DeviceError& e : r.device.errors) EXPECT_NE(e.english, e.russian);
  }
  EXPECT_GE(count, 7);
}

TEST(DeviceFiles, servo_becomes_the_masters_profile) {
  NodeConfig node;
  node.device = "servo-cia402";
  const canopen::DriveProfile p = drive_profile(device("servo-cia402"), node, 262144);
  EXPECT_EQ(p.name, "servo-cia402");
  EXPECT_EQ(p.counts_per_rev, 262144);
  EXPECT_EQ(p.modes, canopen::supported_bit(canopen::OperationMode::cyclic_sync_position));
  EXPECT_EQ(p.rpdo[0].transmission_type, 1);
  ASSERT_EQ(p.rpdo[0].mapping.count, 2);
  EXPECT_EQ(p.rpdo[0].mapping.entries[1], (canopen::MappingEntry{0x607A, 0, 32}));
  EXPECT_EQ(p.tpdo[0].mapping.entries[0], (canopen::MappingEntry{0x6041, 0, 16}));
  EXPECT_FALSE(p.rpdo[1].used());
  EXPECT_EQ(p.brake_bit, -1);
  EXPECT_FALSE(p.vendor_id.has_value());
}

TEST(DeviceFiles, brake_drive_maps_its_output_every_tenth_cycle_and_closes_its_brake_with_its_power) {
  const canopen::DriveProfile p = drive_profile(device("servo-cia402-brake"), {}, 1000);
  EXPECT_EQ(p.brake_bit, 0);
  EXPECT_FALSE(p.brake_bit_releases);
  const auto sets = [&p](std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
    return std::any_of(p.settings.begin(), p.settings.end(), [&](const canopen::SdoSetting& s) {
      return s.index == index && s.subindex == subindex && s.value == value;
    });
  };
  EXPECT_EQ(p.settings.size(), 3u);
  EXPECT_TRUE(sets(0x60FE, 2, 1));
  EXPECT_TRUE(sets(0x605A, 0, 2)) << "ramps down before its torque goes";
  EXPECT_TRUE(sets(0x605E, 0, 2)) << "in a fault, too";
  EXPECT_EQ(p.abort_connection_option, 1);
  EXPECT_EQ(p.rpdo[1].transmission_type, 10);
  EXPECT_EQ(p.rpdo[1].mapping.entries[0], (canopen::MappingEntry{0x60FE, 1, 32}));
}

TEST(DeviceFiles, stepper_declares_its_gaps) {
  const canopen::DriveProfile p = drive_profile(device("stepper-cia402"), {}, 0);
  EXPECT_EQ(p.counts_per_rev, 10000);
  EXPECT_FALSE(p.interpolation_base.has_value());
  EXPECT_DOUBLE_EQ(p.velocity_unit_counts_s, 10000 / 60.0);
  EXPECT_EQ(p.abort_connection_option, std::optional<std::int16_t>(2));
  EXPECT_EQ(p.fault_reset_hold_ms, 50);
  EXPECT_EQ(p.command_delay_cycles, 2);
}

TEST(DeviceFiles, objects_of_the_node_come_after_those_of_the_device) {
  DeviceConfig d = device("servo-cia402");
  d.objects = {{"6065:00/32", 1000.0}};
  NodeConfig node;
  node.objects = {{"6060:00/8", -1.0}, {"2000:1F/16", 65535.0}};
  const canopen::DriveProfile p = drive_profile(d, node, 1);
  ASSERT_EQ(p.settings.size(), 3u);
  EXPECT_EQ(p.settings[0].index, 0x6065);
  EXPECT_EQ(p.settings[0].value, 1000u);
  EXPECT_EQ(p.settings[1].index, 0x2000);
  EXPECT_EQ(p.settings[1].subindex, 0x1F);
  EXPECT_EQ(p.settings[1].bytes, 2);
  EXPECT_EQ(p.settings[2].bytes, 1);
  EXPECT_EQ(p.settings[2].value & 0xFFu, 0xFFu);
}

TEST(DeviceFiles, error_codes_have_words_in_both_languages) {
  const DeviceConfig d = device("servo-cia402");
  EXPECT_EQ(d.error_text(0x8611, text::Language::english), "following error too large");
  EXPECT_EQ(d.error_text(0x8611, text::Language::russian), "рассогласование превышает допустимое");
  EXPECT_EQ(d.error_text(0x1234, text::Language::english), "");
  const canopen::DriveProfile p = drive_profile(d, {}, 1);
  EXPECT_EQ(p.error_texts.size(), d.errors.size());
}

TEST(DeviceFiles, a_drive_without_csp_and_heartbeat_is_declared_and_not_coded) {
  const DeviceResult r = parse_device(
      "schema = 1\nname = \"old\"\nkind = \"servo\"\n[behaviour]\nmodes = [\"ip\"]\nposition_mode = \"ip\"\n"
      "guard_time = \"50 ms\"\nlife_time_factor = 4\n"
      "[[rpdo]]\nnumber = 1\nobjects = [\"6040:00/16\", \"60C1:01/32\"]\n"
      "[[tpdo]]\nnumber = 1\nobjects = [\"6041:00/16\", \"6064:00/32\"]\n",
      "old.toml");
  EXPECT_EQ(test::lines_of(r.findings, text::Language::english), "");
  const canopen::DriveProfile p = drive_profile(r.device, {}, 1000);
  EXPECT_EQ(p.position_mode, canopen::OperationMode::interpolated_position);
  EXPECT_EQ(p.guard_time_ms, 50);
  EXPECT_EQ(p.life_time_factor, 4);
}

TEST(ObjectText, reads_index_subindex_and_bits) {
  const auto full = parse_object("60FE:01/32");
  ASSERT_TRUE(full.has_value());
  EXPECT_EQ(full->index, 0x60FE);
  EXPECT_EQ(full->subindex, 1);
  EXPECT_EQ(full->bits, 32);
  EXPECT_EQ(parse_object("6040")->subindex, 0);
  EXPECT_EQ(parse_object("1018:1F")->subindex, 0x1F);
  for (const char* bad :
       {"", "60", "6040:", "6040:00/", "6040:00/0", "6040:00/16x", "G040", "60400", "6040:100", "6040 "})
    EXPECT_FALSE(parse_object(bad).has_value()) << bad;
}

}  // namespace
}  // namespace servogate::machine
