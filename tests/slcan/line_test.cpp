// SPDX-License-Identifier: Apache-2.0
// The lines of an adapter, and what is none.
#include "drivers/slcan/line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/property_seed.hpp"

namespace servogate::slcan {
namespace {

using image::CanFrame;
using Kind = Answer::Kind;

std::string line_of(const CanFrame& frame) {
  std::array<char, kLongestFrame> out{};
  return {out.data(), encode(frame, out)};
}

std::vector<Answer> read(std::string_view text) {
  Reader reader;
  std::vector<Answer> answers;
  for (const char c : text)
    if (const auto a = reader.put(c)) answers.push_back(*a);
  return answers;
}

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data, bool extended = false) {
  CanFrame f;
  f.id = id;
  f.extended = extended;
  f.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), f.data.begin());
  return f;
}

TEST(SlcanLine, writes_frames_as_the_manual_shows_them) {
  EXPECT_EQ(line_of(frame(0x100, {})), "t1000\r");
  EXPECT_EQ(line_of(frame(0x456, {0x11, 0x22, 0x33})), "t4563112233\r");
  EXPECT_EQ(line_of(frame(0x456, {0x11, 0x22, 0x33}, true)), "T000004563112233\r");
  CanFrame remote = frame(0x123, {});
  remote.remote = true;
  remote.length = 2;
  EXPECT_EQ(line_of(remote), "r1232\r");
  remote.extended = true;
  EXPECT_EQ(line_of(remote), "R000001232\r");
}

TEST(SlcanLine, has_none_for_error_and_fd_frames) {
  CanFrame f = frame(1, {1});
  f.error = true;
  EXPECT_EQ(line_of(f), "");
  f.error = false;
  f.fd = true;
  EXPECT_EQ(line_of(f), "");
}

TEST(SlcanLine, of_a_random_frame_comes_back_as_that_frame_with_and_without_a_time_stamp) {
  std::mt19937_64 random(test::property_seed());
  for (int n = 0; n < 2000; ++n) {
    CanFrame f;
    f.extended = random() % 2 == 0;
    f.remote = random() % 4 == 0;
    f.id = static_cast<std::uint32_t>(random() & (f.extended ? 0x1FFF'FFFFu : 0x7FFu));
    f.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t i = 0; i < f.length && !f.remote; ++i) f.data[i] = static_cast<std::uint8_t>(random());
    std::string line = line_of(f);
    if (random() % 2 == 0) line.insert(line.size() - 1, "0A1F");
    const auto got = read(line);
    ASSERT_EQ(got.size(), 1u) << line;
    ASSERT_EQ(got[0].kind, Kind::frame) << line;
    EXPECT_EQ(got[0].frame.id, f.id);
    EXPECT_EQ(got[0].frame.extended, f.extended);
    EXPECT_EQ(got[0].frame.remote, f.remote);
    EXPECT_EQ(got[0].frame.length, f.length);
    EXPECT_EQ(got[0].frame.data, f.data);
  }
}

TEST(SlcanLine, answers_are_told_apart) {
  const auto got = read("\r\az\rZ\rF24\rV1013\r");
  ASSERT_EQ(got.size(), 6u);
  EXPECT_EQ(got[0].kind, Kind::done);
  EXPECT_EQ(got[1].kind, Kind::refused);
  EXPECT_EQ(got[2].kind, Kind::sent);
  EXPECT_EQ(got[3].kind, Kind::sent);
  EXPECT_EQ(got[4].kind, Kind::flags);
  EXPECT_EQ(got[4].flags, flag::kPassive | flag::kWarning);
  EXPECT_EQ(got[5].kind, Kind::other);
}

TEST(SlcanLine, that_is_none_is_nothing_known) {
  for (const char* line : {"t1", "t12391122334455667788FF", "t8001FF", "T200000000", "t1232112", "t123211223",
                           "t12x0", "F", "F123", "Fxy", "zz", "t123111223", "hello"}) {
    const auto got = read(std::string(line) + "\r");
    ASSERT_EQ(got.size(), 1u) << line;
    EXPECT_EQ(got[0].kind, Kind::other) << line;
  }
  const auto long_line = read(std::string(100'000, 't').append("\rt1000\r"));
  ASSERT_EQ(long_line.size(), 2u);
  EXPECT_EQ(long_line[0].kind, Kind::other);
  EXPECT_EQ(long_line[1].kind, Kind::frame) << "the next one counts again";
}

TEST(SlcanLine, of_random_bytes_never_becomes_a_frame_out_of_range) {
  std::mt19937_64 random(test::property_seed());
  Reader reader;
  constexpr std::string_view kLikely = "tTrRzZF0123456789ABCDEFabcdef\r\r\a";
  for (int n = 0; n < 400'000; ++n) {
    const char c = random() % 50 == 0 ? static_cast<char>(random()) : kLikely[random() % kLikely.size()];
    const auto a = reader.put(c);
    if (!a || a->kind != Kind::frame) continue;
    EXPECT_LE(a->frame.id, a->frame.extended ? 0x1FFF'FFFFu : 0x7FFu);
    EXPECT_LE(a->frame.length, 8);
  }
}

TEST(SlcanLine, bit_rates_are_those_of_the_manual) {
  EXPECT_EQ(rate_digit(10'000), '0');
  EXPECT_EQ(rate_digit(500'000), '6');
  EXPECT_EQ(rate_digit(1'000'000), '8');
  EXPECT_FALSE(rate_digit(333'000));
}

}  // namespace
}  // namespace servogate::slcan
