// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_block.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::ScriptedBus;
using Bytes = std::vector<std::uint8_t>;
using Lines = std::vector<std::string>;

constexpr image::Nanoseconds kTimeout = 50 * image::kMillisecond;

Bytes counting(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i + 1);
  return bytes;
}

TEST(SdoCrc, of_the_check_string_is_that_of_the_standard) {
  constexpr std::string_view kCheck = "123456789";
  const Bytes bytes(kCheck.begin(), kCheck.end());
  EXPECT_EQ(sdo_crc(bytes), 0x31C3);
  EXPECT_EQ(sdo_crc(std::span(bytes).subspan(4), sdo_crc(std::span(bytes).first(4))), 0x31C3)
      << "in pieces it is the same";
  EXPECT_EQ(sdo_crc({}), 0);
}

struct SdoBlockClient : ::testing::Test {
  void poll(int times = 1) {
    for (int i = 0; i < times; ++i) client.poll(now, bus);
  }
  void answer(std::initializer_list<int> bytes) { client.on_frame(frame(0x581, bytes)); }

  ScriptedBus bus;
  SdoClient client{1, kTimeout, 1};
  image::Nanoseconds now = 0;
  Bytes memory = Bytes(100);
  const Bytes thirty = counting(30), forty = counting(40);
};

TEST_F(SdoBlockClient, writes_a_long_object_in_blocks_of_the_size_that_the_device_names) {
  const Bytes data = counting(30);
  ASSERT_TRUE(client.download_from(0x1F50, 1, data));
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 C6 50 1F 01 1E 00 00 00"});
  answer({0xA4, 0x50, 0x1F, 0x01, 3, 0, 0, 0});
  poll(5);
  EXPECT_EQ(bus.take_sent(), (Lines{"601 01 01 02 03 04 05 06 07", "601 02 08 09 0A 0B 0C 0D 0E",
                                    "601 03 0F 10 11 12 13 14 15"}))
      << "and then waits";
  answer({0xA2, 3, 127, 0, 0, 0, 0, 0});
  poll(5);
  EXPECT_EQ(bus.take_sent(), (Lines{"601 01 16 17 18 19 1A 1B 1C", "601 82 1D 1E 00 00 00 00 00"}));
  answer({0xA2, 2, 127, 0, 0, 0, 0, 0});
  poll(2);
  char end[40];
  const std::uint16_t crc = sdo_crc(data);
  std::snprintf(end, sizeof end, "601 D5 %02X %02X 00 00 00 00 00", crc & 0xFF, crc >> 8);
  EXPECT_EQ(bus.take_sent(), Lines{end}) << "five bytes of the last segment are no data";
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().size, 30u);
}

TEST_F(SdoBlockClient, repeats_what_follows_a_lost_segment) {
  ASSERT_TRUE(client.download_from(0x1F50, 1, thirty));
  poll();
  answer({0xA4, 0x50, 0x1F, 0x01, 127, 0, 0, 0});
  poll(6);
  bus.take_sent();
  answer({0xA2, 1, 2, 0, 0, 0, 0, 0});
  poll(6);
  EXPECT_EQ(bus.take_sent(), (Lines{"601 01 08 09 0A 0B 0C 0D 0E", "601 02 0F 10 11 12 13 14 15"}))
      << "numbers begin anew, the new block has two segments";
}

TEST_F(SdoBlockClient, reads_a_long_object_in_blocks) {
  ASSERT_TRUE(client.upload_into(0x1021, 0, memory));
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 A4 21 10 00 7F 1C 00 00"});
  answer({0xC6, 0x21, 0x10, 0x00, 30, 0, 0, 0});
  poll(2);
  EXPECT_EQ(bus.take_sent(), Lines{"601 A3 00 00 00 00 00 00 00"});
  answer({0x01, 1, 2, 3, 4, 5, 6, 7});
  answer({0x02, 8, 9, 10, 11, 12, 13, 14});
  answer({0x03, 15, 16, 17, 18, 19, 20, 21});
  answer({0x03, 15, 16, 17, 18, 19, 20, 21});
  answer({0x04, 22, 23, 24, 25, 26, 27, 28});
  poll();
  EXPECT_TRUE(bus.take_sent().empty());
  answer({0x85, 29, 30, 0, 0, 0, 0, 0});
  poll(2);
  EXPECT_EQ(bus.take_sent(), Lines{"601 A2 05 7F 00 00 00 00 00"});
  const std::uint16_t crc = sdo_crc(counting(30));
  answer({0xD5, crc & 0xFF, crc >> 8, 0, 0, 0, 0, 0});
  poll(2);
  EXPECT_EQ(bus.take_sent(), Lines{"601 A1 00 00 00 00 00 00 00"});
  ASSERT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(Bytes(client.data().begin(), client.data().end()), thirty);
  EXPECT_EQ(client.data().data(), memory.data()) << "it lies in the caller's memory";
}

TEST_F(SdoBlockClient, confirms_only_what_came_in_order) {
  client.upload_into(0x1021, 0, memory);
  poll();
  answer({0xC6, 0x21, 0x10, 0x00, 30, 0, 0, 0});
  poll();
  answer({0x01, 1, 2, 3, 4, 5, 6, 7});
  answer({0x03, 15, 16, 17, 18, 19, 20, 21});
  answer({0x85, 29, 30, 0, 0, 0, 0, 0});
  bus.take_sent();
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 A2 01 7F 00 00 00 00 00"});
  answer({0x01, 8, 9, 10, 11, 12, 13, 14});
  EXPECT_EQ(client.position(), 7u);
}

TEST_F(SdoBlockClient, a_short_object_comes_without_a_block) {
  client.upload_into(0x1000, 0, memory);
  poll();
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.value(), 0x00020192u);
}

TEST_F(SdoBlockClient, a_wrong_checksum_is_told_and_the_object_read_again) {
  client.upload_into(0x1021, 0, memory);
  for (int attempt = 0; attempt < 2; ++attempt) {
    poll(2);
    answer({0xC6, 0x21, 0x10, 0x00, 2, 0, 0, 0});
    poll();
    answer({0x81, 1, 2, 0, 0, 0, 0, 0});
    poll();
    bus.take_sent();
    answer({0xD5, 0x12, 0x34, 0, 0, 0, 0, 0});
  }
  EXPECT_EQ(client.result().status, SdoStatus::bad_protocol);
  EXPECT_EQ(client.result().abort, AbortCode::crc_error);
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 80 21 10 00 04 00 04 05"});
}

TEST_F(SdoBlockClient, a_device_without_block_transfer_gets_segments_and_is_remembered) {
  ASSERT_TRUE(client.download_from(0x2000, 0, forty));
  poll();
  answer({0x80, 0x00, 0x20, 0x00, 0x01, 0x00, 0x04, 0x05});
  bus.take_sent();
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 21 00 20 00 28 00 00 00"});
  client.cancel();
  poll();
  bus.take_sent();
  ASSERT_TRUE(client.upload_into(0x2000, 0, memory));
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 40 00 20 00 00 00 00 00"});
}

TEST_F(SdoBlockClient, a_device_that_keeps_silent_about_blocks_gets_segments) {
  ASSERT_TRUE(client.download_from(0x2000, 0, forty));
  poll();
  now += kTimeout;
  bus.take_sent();
  poll(2);
  EXPECT_EQ(bus.take_sent(), (Lines{"601 80 00 20 00 00 00 04 05", "601 21 00 20 00 28 00 00 00"}));
}

TEST_F(SdoBlockClient, an_abort_about_the_object_ends_the_transfer) {
  ASSERT_TRUE(client.download_from(0x2000, 0, forty));
  poll();
  answer({0x80, 0x00, 0x20, 0x00, 0x00, 0x00, 0x02, 0x06});
  EXPECT_EQ(client.result().status, SdoStatus::aborted);
  EXPECT_EQ(client.result().abort, AbortCode::object_does_not_exist);
}

TEST_F(SdoBlockClient, a_block_size_of_nothing_or_beyond_127_is_refused) {
  for (const int size : {0, 128}) {
    client.download_from(0x2000, 0, forty);
    poll();
    answer({0xA4, 0x00, 0x20, 0x00, size, 0, 0, 0});
    EXPECT_EQ(client.result().abort, AbortCode::block_size_invalid) << size;
    poll();
    bus.take_sent();
  }
}

TEST_F(SdoBlockClient, more_than_the_memory_holds_is_refused_before_it_comes) {
  client.upload_into(0x1021, 0, std::span(memory).first(29));
  poll();
  answer({0xC6, 0x21, 0x10, 0x00, 30, 0, 0, 0});
  EXPECT_EQ(client.result().abort, AbortCode::out_of_memory);
}

TEST_F(SdoBlockClient, never_writes_beyond_the_memory_whatever_comes) {
  Bytes guarded(64, 0xEE);
  const auto area = std::span(guarded).subspan(8, 40);
  std::uint32_t state = 7;
  const auto random = [&state] { return state = state * 1664525u + 1013904223u, state >> 16; };
  for (int i = 0; i < 300'000; ++i) {
    if (!client.busy()) client.upload_into(0x1021, 0, area);
    client.allow_blocks(true);
    client.poll(i * image::kMillisecond / 4, bus);
    bus.sent.clear();
    auto f = frame(0x581, {0, 0x21, 0x10, 0, 0, 0, 0, 0});
    const int kind = static_cast<int>(random() % 4);
    f.data[0] = static_cast<std::uint8_t>(kind == 0   ? 0xC0 + random() % 8
                                          : kind == 1 ? random()
                                                      : 1 + random() % 7);
    f.data[4] = static_cast<std::uint8_t>(random() % 50);
    client.on_frame(f);
    ASSERT_LE(client.data().size(), area.size());
  }
  for (std::size_t i = 0; i < 8; ++i) ASSERT_EQ(guarded[i], 0xEE);
  for (std::size_t i = 48; i < 64; ++i) ASSERT_EQ(guarded[i], 0xEE);
}

}  // namespace
}  // namespace servogate::canopen
