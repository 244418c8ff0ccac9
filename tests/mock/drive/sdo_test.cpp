// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/mock/drive/drive_bench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

using Bytes = DriveBench::Bytes;

Bytes upload(std::uint16_t index, std::uint8_t sub) {
  return {0x40, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0};
}
Bytes aborted(std::uint16_t index, std::uint8_t sub, std::uint32_t code) {
  return {0x80,
          static_cast<std::uint8_t>(index),
          static_cast<std::uint8_t>(index >> 8),
          sub,
          static_cast<std::uint8_t>(code),
          static_cast<std::uint8_t>(code >> 8),
          static_cast<std::uint8_t>(code >> 16),
          static_cast<std::uint8_t>(code >> 24)};
}

TEST(DriveSdo, the_device_type_is_a_servo_drive_of_profile_402) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}),
            (Bytes{0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));
}

TEST(DriveSdo, short_values_say_their_length_in_the_answer) {
  DriveBench b;
  EXPECT_EQ(b.sdo(upload(0x1001, 0)), (Bytes{0x4F, 0x01, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(b.sdo(upload(0x6007, 0)), (Bytes{0x4B, 0x07, 0x60, 0, 1, 0, 0, 0}));
}

TEST(DriveSdo, an_expedited_download_is_confirmed_and_reads_back) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}), (Bytes{0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(b.read(0x1017), 1000u);
}

TEST(DriveSdo, a_download_without_a_given_size_takes_the_objects_own) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0x22, 0x17, 0x10, 0x00, 0xE8, 0x03, 0xFF, 0xFF})[0], 0x60);
  EXPECT_EQ(b.read(0x1017), 1000u);
}

TEST(DriveSdo, a_string_comes_in_segments_with_alternating_toggle) {
  SimulatedDriveConfig config;
  config.name = "Axis X drive";  // 12 characters
  DriveBench b(config);
  EXPECT_EQ(b.sdo(upload(0x1008, 0)), (Bytes{0x41, 0x08, 0x10, 0x00, 12, 0, 0, 0}));
  EXPECT_EQ(b.sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x00, 'A', 'x', 'i', 's', ' ', 'X', ' '}));
  EXPECT_EQ(b.sdo({0x70, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x15, 'd', 'r', 'i', 'v', 'e', 0, 0}));
}

TEST(DriveSdo, a_segmented_download_of_a_string_reads_back) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0x21, 0x00, 0x21, 0x00, 9, 0, 0, 0})[0], 0x60);
  EXPECT_EQ(b.sdo({0x00, 'l', 'a', 't', 'h', 'e', ' ', 'Z'})[0], 0x20);
  EXPECT_EQ(b.sdo({0x1B, 'a', 'x', 0, 0, 0, 0, 0})[0], 0x30);
  EXPECT_EQ(b.sdo(upload(0x2100, 0))[4], 9);
  EXPECT_EQ(b.sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x00, 'l', 'a', 't', 'h', 'e', ' ', 'Z'}));
}

TEST(DriveSdo, a_number_may_come_in_segments_too) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0x21, 0x81, 0x60, 0x00, 4, 0, 0, 0})[0], 0x60);
  EXPECT_EQ(b.sdo({0x07, 0x10, 0x27, 0, 0, 0, 0, 0})[0], 0x20);
  EXPECT_EQ(b.read(0x6081), 10000u);
}

TEST(DriveSdo, a_toggle_that_does_not_alternate_is_aborted) {
  DriveBench b;
  b.sdo(upload(0x1008, 0));
  b.sdo({0x60, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(b.sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0x1008, 0, 0x05030000));
  EXPECT_EQ(b.sdo({0x70, 0, 0, 0, 0, 0, 0, 0})[0], 0x80) << "the transfer is over";
}

TEST(DriveSdo, a_string_comes_in_a_block_to_a_client_that_asks_for_one) {
  SimulatedDriveConfig config;
  config.name = "Axis X drive";  // 12 characters
  DriveBench b(config);
  EXPECT_EQ(b.sdo({0xA4, 0x08, 0x10, 0x00, 127, 0, 0, 0}), (Bytes{0xC6, 0x08, 0x10, 0x00, 12, 0, 0, 0}));
  EXPECT_EQ(b.sdo({0xA3, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x01, 'A', 'x', 'i', 's', ' ', 'X', ' '}));
  b.run(2);
  const auto second = b.take(0x585);
  ASSERT_TRUE(second);
  EXPECT_EQ(Bytes(second->data.begin(), second->data.begin() + 8),
            (Bytes{0x82, 'd', 'r', 'i', 'v', 'e', 0, 0}));
  const Bytes end = b.sdo({0xA2, 2, 127, 0, 0, 0, 0, 0});
  EXPECT_EQ(end[0], 0xC1 | 2 << 2) << "two bytes of the last segment are no data";
  b.send(0x605, {0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(b.read(0x1000), 0x00020192u) << "and the server is free again";
}

TEST(DriveSdo, a_name_is_written_in_a_block) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0xC2, 0x00, 0x21, 0x00, 9, 0, 0, 0}), (Bytes{0xA4, 0x00, 0x21, 0x00, 127, 0, 0, 0}));
  b.send(0x605, {0x01, 'T', 'u', 'r', 'n', 't', 'a', 'b'});
  EXPECT_EQ(b.sdo({0x82, 'l', 'e', 0, 0, 0, 0, 0}), (Bytes{0xA2, 2, 127, 0, 0, 0, 0, 0}));
  EXPECT_EQ(b.sdo({0xD5, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0xA1, 0, 0, 0, 0, 0, 0, 0})) << "without a checksum";
  EXPECT_EQ(b.sdo(upload(0x2100, 0)), (Bytes{0x41, 0x00, 0x21, 0x00, 9, 0, 0, 0}));
}

TEST(DriveSdo, an_unknown_command_is_refused_with_0504_0001) {
  DriveBench b;
  EXPECT_EQ(b.sdo({0xE0, 0x08, 0x10, 0x00, 0, 0, 0, 0}), aborted(0x1008, 0, 0x05040001));
}

TEST(DriveSdo, each_wrong_access_has_the_abort_code_of_the_standard) {
  DriveBench b;
  struct Case {
    Bytes request;
    std::uint32_t code;
    const char* why;
  };
  const Case cases[] = {
      {upload(0x5555, 0), 0x06020000, "object does not exist"},
      {upload(0x1018, 9), 0x06090011, "sub-index does not exist"},
      {{0x2F, 0x55, 0x55, 0, 0, 0, 0, 0}, 0x06020000, "download to no object"},
      {{0x2F, 0x18, 0x10, 9, 0, 0, 0, 0}, 0x06090011, "download to no sub-index"},
      {{0x2B, 0x41, 0x60, 0, 0, 0, 0, 0}, 0x06010002, "statusword is read only"},
      {{0x23, 0x00, 0x10, 0, 0, 0, 0, 0}, 0x06010002, "device type is constant"},
      {{0x23, 0x17, 0x10, 0, 0, 0, 0, 0}, 0x06070012, "four bytes into two"},
      {{0x2F, 0x17, 0x10, 0, 0, 0, 0, 0}, 0x06070013, "one byte into two"},
      {{0x2B, 0x5E, 0x60, 0, 5, 0, 0, 0}, 0x06090031, "fault reaction 5"},
      {{0x2B, 0x5E, 0x60, 0, 0xFF, 0xFF, 0, 0}, 0x06090032, "fault reaction -1"},
      {{0x2F, 0x60, 0x60, 0, 5, 0, 0, 0}, 0x06090030, "a mode that 6502h does not have"},
      {{0x2F, 0x98, 0x60, 0, 16, 0, 0, 0}, 0x06090030, "a reserved homing method"},
      {{0x2F, 0x03, 0x10, 0, 1, 0, 0, 0}, 0x06090030, "error history takes only 0"},
      {upload(0x1003, 1), 0x08000024, "no error yet"},
      {{0x23, 0x10, 0x10, 1, 'e', 'v', 'a', 's'}, 0x08000020, "store with the wrong signature"},
      {{0x23, 0x11, 0x10, 1, 'x', 'o', 'a', 'd'}, 0x08000020, "restore with the wrong signature"},
      {{0x23, 0x7D, 0x60, 1, 0xFF, 0xFF, 0xFF, 0x7F}, 0, "lower limit equal to the upper one"},
      {{0x23, 0x7D, 0x60, 2, 0, 0, 0, 0}, 0x06090036, "upper limit below the lower one"},
      {{0x21, 0x00, 0x21, 0, 100, 0, 0, 0}, 0x06070012, "a string longer than its room"},
      {{0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0x40}, 0x06090030, "a consumer cannot produce SYNC"},
      {{0x2F, 0x19, 0x10, 0, 1, 0, 0, 0}, 0x06090030, "SYNC counter overflow 1 is reserved"},
  };
  for (const Case& c : cases) {
    const Bytes answer = b.sdo(c.request);
    ASSERT_EQ(answer.size(), 8u) << c.why;
    EXPECT_EQ(answer[0] == 0x80 ? DriveBench::word(answer) : 0u, c.code)
        << c.why << std::hex << DriveBench::word(answer);
  }
}

TEST(DriveSdo, an_abort_of_the_client_gets_no_answer) {
  DriveBench b;
  b.sdo(upload(0x1008, 0));
  EXPECT_TRUE(b.sdo(aborted(0x1008, 0, 0x05040000)).empty());
}

TEST(DriveSdo, the_server_is_deaf_while_stopped_and_answers_again_afterwards) {
  DriveBench b;
  b.nmt(0x02);
  EXPECT_TRUE(b.sdo(upload(0x1000, 0)).empty());
  b.nmt(0x80);
  EXPECT_FALSE(b.sdo(upload(0x1000, 0)).empty());
}

TEST(DriveSdo, stored_parameters_survive_a_reset_and_restoring_brings_the_defaults_back) {
  DriveBench b;
  const auto reset = [&b] {
    b.nmt(0x81);
    b.run(20);
  };
  b.write(0x6085, 0, 12345, 4);
  b.write(0x1017, 0, 500, 2);
  reset();
  EXPECT_NE(b.read(0x6085), 12345u) << "nothing was stored";
  b.write(0x6085, 0, 12345, 4);
  b.write(0x1017, 0, 500, 2);
  EXPECT_EQ(b.write(0x1010, 1, 0x65766173, 4), 0u);
  reset();
  EXPECT_EQ(b.read(0x6085), 12345u);
  EXPECT_EQ(b.read(0x1017), 500u);
  EXPECT_EQ(b.write(0x1011, 2, 0x64616F6C, 4), 0u);
  EXPECT_EQ(b.read(0x1017), 500u) << "defaults act after the reset";
  reset();
  EXPECT_EQ(b.read(0x1017), 0u);
  EXPECT_EQ(b.read(0x6085), 12345u) << "only the communication part was restored";
}

TEST(DriveSdo, commands_and_targets_are_not_stored_with_the_parameters) {
  DriveBench b;
  b.write(0x6060, 0, 3, 1);
  b.write(0x60FF, 0, 500'000, 4);
  b.write(0x6071, 0, 300, 2);
  b.control(0x0F);
  ASSERT_EQ(b.write(0x1010, 1, 0x65766173, 4), 0u);
  EXPECT_EQ(b.read(0x60FF), 500'000u) << "now it acts as before";
  b.nmt(0x81);
  b.run(20);
  EXPECT_EQ(b.read(0x6060), 3u);
  EXPECT_EQ(b.read(0x60FF), 0u);
  EXPECT_EQ(b.read(0x6071), 0u);
  EXPECT_EQ(b.read(0x6040), 0u);
}

TEST(DriveSdo, random_requests_get_well_formed_answers_and_never_stop_the_server) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  DriveBench b;
  for (int i = 0; i < 4000; ++i) {
    Bytes request(8);
    for (auto& x : request) x = static_cast<std::uint8_t>(random());
    if (random() % 2) {  // half of them aim at objects that exist
      const std::uint16_t known[] = {0x1000, 0x1008, 0x1017, 0x1400, 0x1600,
                                     0x1A00, 0x2100, 0x6040, 0x607A, 0x60C2};
      const std::uint16_t index = known[random() % 10];
      request[1] = static_cast<std::uint8_t>(index);
      request[2] = static_cast<std::uint8_t>(index >> 8);
      request[3] = static_cast<std::uint8_t>(random() % 3);
    }
    b.send(0x605, request);
    b.run(1);
    // One answer; within a block none, or as many segments as a millisecond takes.
    ASSERT_LE(b.count(0x585), 3);
    while (const auto answer = b.take(0x585)) ASSERT_EQ(answer->length, 8);
    b.seen.clear();
  }
  b.send(0x605, {0x80, 0, 0, 0, 0, 0, 0, 0});
  b.run(1);
  EXPECT_EQ(b.read(0x1000), 0x00020192u);
}

}  // namespace
}  // namespace servogate::mock
