// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/boundary/inputs.hpp"
#include "tests/property_seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>
#include <span>

namespace servogate::cycle {
namespace {

template <typename T>
bool same(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

bool same_inputs(const CycleInputs& a, const CycleInputs& b) {
  bool good = a.number == b.number && a.packet_a == b.packet_a && a.visible == b.visible &&
              a.request_count == b.request_count && a.notice_count == b.notice_count;
  for (std::size_t i = 0; i < a.axes.size(); ++i) good = good && same(a.axes[i], b.axes[i]);
  for (std::size_t i = 0; i < a.spindles.size(); ++i) good = good && same(a.spindles[i], b.spindles[i]);
  for (std::size_t i = 0; i < a.sources.size(); ++i) good = good && same(a.sources[i], b.sources[i]);
  good = good && a.edges.lost() == b.edges.lost() && a.edges.list().size() == b.edges.list().size();
  for (std::size_t i = 0; good && i < a.edges.list().size(); ++i) {
    const image::Edge &one = a.edges.list()[i], &other = b.edges.list()[i];
    good = one.place == other.place && one.level == other.level && one.t_ns == other.t_ns;
  }
  for (std::size_t i = 0; i < a.request_count; ++i) good = good && same(a.requests[i], b.requests[i]);
  for (std::size_t i = 0; i < a.notice_count; ++i) good = good && same(a.notices[i], b.notices[i]);
  return good;
}

/// Changes a few things at random, as a cycle does.
void next(CycleInputs& in, std::mt19937_64& random) {
  ++in.number;
  for (image::DriveFeedback& a : in.axes)
    if (random() % 3 == 0) {
      a.online = random() % 2 == 0;
      a.state = static_cast<image::DriveState>(random() % 9);
      a.position_counts = static_cast<std::int64_t>(random());
      a.velocity_counts_s = static_cast<double>(random()) / 3.0;
      a.statusword = static_cast<std::uint16_t>(random());
      a.latch_sequence += random() % 2;
    }
  if (random() % 4 == 0) in.spindles[random() % in.spindles.size()].position_counts += 17;
  for (std::uint64_t n = random() % 8; n > 0; --n)
    in.packet_a[random() % in.packet_a.size()] = static_cast<std::uint8_t>(random());
  if (random() % 5 == 0) in.sources[random() % in.sources.size()].updated_ns = in.number * 1000000;
  in.edges.clear();
  for (std::uint64_t n = random() % 5 == 0 ? random() % 40 : 0; n > 0; --n)
    in.edges.add({{image::Packet::a, image::Format::bl, static_cast<std::uint32_t>(random() % 8192), 1},
                  random() % 2 == 0,
                  static_cast<image::Nanoseconds>(random())});
  for (std::uint64_t& v : in.visible) v += random() % 3 == 0 ? random() % 100000 : 0;
  in.request_count = static_cast<std::uint8_t>(random() % 7 == 0 ? random() % (kRequestsPerCycle + 1) : 0);
  for (std::size_t i = 0; i < in.request_count; ++i) {
    in.requests[i].id = random();
    in.requests[i].kind = static_cast<image::RequestKind>(random() % 20);
    in.requests[i].value = static_cast<double>(random() % 1000) / 7.0;
  }
  in.notice_count = static_cast<std::uint8_t>(random() % 9 == 0 ? random() % (kNoticesPerCycle + 1) : 0);
  for (std::size_t i = 0; i < in.notice_count; ++i)
    in.notices[i].number = static_cast<std::uint16_t>(random());
}

TEST(Inputs, come_back_from_their_record_as_they_went_in) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  for (unsigned run = 0; run < 20; ++run) {
    std::mt19937_64 random(seed + run);
    InputEncoder encoder;
    std::vector<std::uint8_t> bytes;
    std::vector<CycleInputs> sent;
    CycleInputs in;
    for (int i = 0; i < 100; ++i) {
      encoder.append(in, bytes);
      sent.push_back(in);
      next(in, random);
    }
    InputDecoder decoder(bytes);
    CycleInputs got;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      ASSERT_TRUE(decoder.give(got)) << "seed " << seed + run;
      ASSERT_TRUE(same_inputs(got, sent[i])) << "cycle " << i << " seed " << seed + run;
    }
    EXPECT_TRUE(decoder.at_end());
    EXPECT_FALSE(decoder.give(got));
    EXPECT_FALSE(decoder.damaged());
  }
}

TEST(Inputs, that_do_not_change_cost_few_bytes) {
  InputEncoder encoder;
  std::vector<std::uint8_t> bytes;
  CycleInputs in;
  encoder.append(in, bytes);
  bytes.clear();
  ++in.number;
  encoder.append(in, bytes);
  EXPECT_LT(bytes.size(), 32u);
}

TEST(Inputs, cut_inside_a_cycle_are_damaged_and_at_its_end_are_not) {
  std::mt19937_64 random(5);
  InputEncoder encoder;
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> ends{0};
  CycleInputs in;
  for (int i = 0; i < 10; ++i) {
    encoder.append(in, bytes);
    ends.push_back(bytes.size());
    next(in, random);
  }
  for (std::size_t length = 0; length <= bytes.size(); ++length) {
    InputDecoder decoder(std::span<const std::uint8_t>(bytes).first(length));
    CycleInputs got;
    std::size_t cycles = 0;
    while (decoder.give(got)) ++cycles;
    const bool at_border = std::find(ends.begin(), ends.end(), length) != ends.end();
    ASSERT_EQ(decoder.damaged(), !at_border) << length;
    ASSERT_LT(cycles, ends.size());
    ASSERT_LE(ends[cycles], length);
  }
}

TEST(Inputs, of_random_bytes_never_reach_beyond_their_arrays) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> bytes(random() % 400);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : random() % 3);
    InputDecoder decoder(bytes);
    const auto got = std::make_unique<CycleInputs>();
    while (decoder.give(*got)) {
      ASSERT_LE(got->request_count, kRequestsPerCycle) << "seed " << seed;
      ASSERT_LE(got->notice_count, kNoticesPerCycle) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace servogate::cycle
