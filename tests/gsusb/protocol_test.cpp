// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "drivers/gsusb/adapter_clock.hpp"
#include "tests/property_seed.hpp"

namespace servogate::gsusb {
namespace {

using Bytes = std::vector<std::uint8_t>;
using image::CanState;

Bytes encoded(const image::CanFrame& frame, std::uint32_t echo, std::uint32_t features = 0) {
  std::array<std::uint8_t, kStampedBytes> out{};
  const std::size_t size = encode(frame, echo, 0, features, out);
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST(GsUsbProtocol, a_frame_to_the_adapter_has_20_bytes_with_tag_identifier_length_and_data) {
  image::CanFrame f;
  f.id = 0x60A;
  f.length = 3;
  f.data = {0x40, 0x41, 0x60};
  EXPECT_EQ(encoded(f, 7),
            (Bytes{7, 0, 0, 0, 0x0A, 0x06, 0, 0, 3, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
}

TEST(GsUsbProtocol, identifiers_of_29_bits_and_remote_frames_are_marked_in_the_highest_bits) {
  image::CanFrame f;
  f.id = 0x18FF1234;
  f.extended = true;
  EXPECT_EQ(encoded(f, 0)[7], 0x98);
  f.remote = true;
  f.length = 8;
  f.data.fill(0xAA);
  const Bytes remote = encoded(f, 0);
  EXPECT_EQ(remote[7], 0xD8);
  EXPECT_EQ(remote[8], 8);
  EXPECT_EQ(remote[12], 0) << "a remote frame carries no data";
}

TEST(GsUsbProtocol, an_adapter_that_loses_full_packets_gets_one_byte_more) {
  EXPECT_EQ(encoded({}, 0, feature::kOneByteMore).size(), 21u);
}

Bytes received(std::uint32_t id, std::uint8_t length, std::uint8_t flags = 0) {
  Bytes b = {0xFF, 0xFF, 0xFF, 0xFF};
  for (int i = 0; i < 4; ++i) b.push_back(static_cast<std::uint8_t>(id >> 8 * i));
  b.insert(b.end(), {length, 0, flags, 0, 1, 2, 3, 4, 5, 6, 7, 8});
  return b;
}

TEST(GsUsbProtocol, a_frame_from_the_bus_is_taken_apart_with_and_without_time) {
  HostFrame in;
  Bytes b = received(0x181, 4);
  ASSERT_TRUE(decode(b, false, in));
  EXPECT_EQ(in.echo, HostFrame::kReceived);
  EXPECT_EQ(in.frame.id, 0x181u);
  EXPECT_EQ(in.frame.length, 4);
  EXPECT_EQ(in.frame.data[3], 4);
  EXPECT_EQ(in.frame.data[4], 0) << "what stands behind the data is no data";
  EXPECT_FALSE(in.timestamp_us);
  EXPECT_FALSE(decode(b, true, in)) << "a stamped transfer has 24 bytes";
  b.insert(b.end(), {0x10, 0x27, 0, 0});
  ASSERT_TRUE(decode(b, true, in));
  EXPECT_EQ(in.timestamp_us, 10'000u);
}

TEST(GsUsbProtocol, a_frame_from_the_bus_may_end_with_its_data) {
  HostFrame in;
  Bytes b = received(0x181, 2);
  b.resize(14);
  EXPECT_TRUE(decode(b, false, in));
  b.resize(13);
  EXPECT_FALSE(decode(b, false, in));
}

TEST(GsUsbProtocol, what_is_no_frame_is_refused) {
  HostFrame in;
  EXPECT_FALSE(decode(Bytes{}, false, in));
  EXPECT_FALSE(decode(Bytes(11), false, in));
  EXPECT_FALSE(decode(received(0x181, 9), false, in)) << "nine bytes";
  EXPECT_FALSE(decode(received(0x181, 8, 1u << 1), false, in)) << "a CAN FD frame nobody asked for";
}

TEST(GsUsbProtocol, error_frames_tell_the_state_and_an_overflow_does_not_change_it) {
  HostFrame in;
  Bytes b = received(0x20000004, 8);
  const auto state = [&](std::uint8_t controller, CanState before) {
    b[13] = controller;
    EXPECT_TRUE(decode(b, false, in));
    EXPECT_TRUE(in.frame.error);
    return state_after(in.frame, before);
  };
  EXPECT_EQ(state(0x08, CanState::error_active), CanState::error_warning);
  EXPECT_EQ(state(0x10, CanState::error_warning), CanState::error_passive);
  EXPECT_EQ(state(0x01, CanState::error_passive), CanState::error_passive);
  EXPECT_EQ(state(0x40, CanState::error_passive), CanState::error_active);
  EXPECT_EQ(state(0x00, CanState::error_warning), CanState::error_active);
  b = received(0x20000040, 8);
  ASSERT_TRUE(decode(b, false, in));
  EXPECT_EQ(state_after(in.frame, CanState::error_active), CanState::bus_off);
  EXPECT_EQ(state_after(restarted(), CanState::bus_off), CanState::error_active);
}

TEST(GsUsbProtocol, short_answers_to_requests_are_no_answers) {
  EXPECT_FALSE(parse_limits(Bytes(39)));
  EXPECT_FALSE(parse_device_config(Bytes(11)));
  EXPECT_FALSE(parse_state(Bytes(11)));
  EXPECT_FALSE(parse_state(Bytes(12, 0xFF))) << "a state that there is not";
  EXPECT_FALSE(parse_timestamp(Bytes(3)));
  EXPECT_FALSE(parse_device_config(Bytes(12, 0xFF))) << "256 channels";
}

TEST(GsUsbProtocol, whatever_bytes_an_adapter_sends_a_frame_that_is_taken_is_a_frame) {
  std::mt19937_64 random(test::property_seed());
  int taken = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(random() % 30);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    // Half of them are likely ones: from the bus, with a length that there is.
    if (i % 2 == 0 && bytes.size() > 10)
      std::fill_n(bytes.begin(), 4, std::uint8_t{0xFF}), bytes[8] %= 10, bytes[10] = 0;
    HostFrame in;
    if (!decode(bytes, i % 3 == 0, in)) continue;
    ++taken;
    ASSERT_LE(in.frame.length, 8);
    ASSERT_LT(in.frame.id, 1u << (in.frame.extended || in.frame.error ? 29 : 11));
    ASSERT_FALSE(in.frame.fd);
    ASSERT_EQ(in.timestamp_us.has_value(), i % 3 == 0);
  }
  EXPECT_GT(taken, 1000);
}

TEST(GsUsbProtocol, a_frame_that_goes_out_comes_back_as_it_was) {
  std::mt19937_64 random(test::property_seed());
  for (int i = 0; i < 5000; ++i) {
    image::CanFrame f;
    f.extended = random() % 2 == 0;
    f.id = static_cast<std::uint32_t>(random()) & (f.extended ? 0x1FFF'FFFFu : 0x7FFu);
    f.remote = random() % 8 == 0;
    f.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t n = 0; n < f.length && !f.remote; ++n) f.data[n] = static_cast<std::uint8_t>(random());
    HostFrame in;
    ASSERT_TRUE(decode(encoded(f, HostFrame::kReceived), false, in));
    ASSERT_EQ(in.frame.id, f.id);
    ASSERT_EQ(in.frame.extended, f.extended);
    ASSERT_EQ(in.frame.remote, f.remote);
    ASSERT_EQ(in.frame.length, f.length);
    ASSERT_EQ(in.frame.data, f.data);
  }
}

TEST(AdapterClock, a_stamp_is_never_after_its_arrival_and_keeps_the_distance_of_frames) {
  AdapterClock clock;
  const image::Nanoseconds ms = image::kMillisecond;
  // The first frame took 3 ms through USB, the second 1 ms.
  EXPECT_EQ(clock.to_host(4'000'000'000u, 103 * ms), 103 * ms);
  const image::Nanoseconds second = clock.to_host(4'000'010'000u, 111 * ms);
  EXPECT_EQ(second, 111 * ms);
  const image::Nanoseconds third = clock.to_host(4'000'020'000u, 125 * ms);
  EXPECT_NEAR(static_cast<double>(third), 121.0 * ms, 3000.0) << "10 ms after the second, whatever USB did";
}

TEST(AdapterClock, wraps_after_71_minutes_and_follows_a_crystal_of_100_ppm) {
  AdapterClock clock;
  std::uint32_t us = 0xFFFFFFFFu - 5'000'000;
  image::Nanoseconds host = 1'000'000'000;
  for (int i = 0; i < 1000; ++i) {
    us += 10'000;
    host += 10 * image::kMillisecond + 1000;  // the adapter is slow by 100 ppm
    const image::Nanoseconds stamp = clock.to_host(us, host + 100'000);
    EXPECT_LE(stamp, host + 100'000);
    EXPECT_GE(stamp, host - 200'000) << i;
  }
}

}  // namespace
}  // namespace servogate::gsusb
