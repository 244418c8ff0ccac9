// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/sdo/sdo_server.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::ScriptedBus;
using Bytes = std::vector<std::uint8_t>;

/// One domain 2000h of any length and one that can only be read.
class Domain final : public SdoObjects {
 public:
  Bytes stored;
  Bytes memory = Bytes(70'000);
  int writes = 0;

  AbortCode read(std::uint16_t index, std::uint8_t, std::span<std::uint8_t> bytes,
                 std::size_t& size) noexcept override {
    if (index != 0x2000) return AbortCode::object_does_not_exist;
    size = std::min<std::size_t>(stored.size(), kMaxText);
    std::copy_n(stored.begin(), size, bytes.begin());
    return AbortCode::none;
  }
  AbortCode write(std::uint16_t, std::uint8_t, std::span<const std::uint8_t> bytes) noexcept override {
    stored.assign(bytes.begin(), bytes.end());
    ++writes;
    return AbortCode::none;
  }
  AbortCode may_write(std::uint16_t index, std::uint8_t, std::size_t& size) noexcept override {
    size = 0;
    return index == 0x2000 ? AbortCode::none : AbortCode::read_only;
  }
  std::span<std::uint8_t> room(std::uint16_t, std::uint8_t) noexcept override { return memory; }
  std::span<const std::uint8_t> content(std::uint16_t, std::uint8_t) noexcept override { return stored; }
};

struct SdoServerTest : ::testing::Test {
  /// The answer to a request; empty: none.
  Bytes ask(const Bytes& request) {
    SdoBytes answer{};
    if (!server.handle(request, now, answer)) return {};
    return {answer.begin(), answer.end()};
  }
  Bytes segment() {
    SdoBytes bytes{};
    if (!server.segment(bytes)) return {};
    server.segment_sent();
    return {bytes.begin(), bytes.end()};
  }
  Domain domain;
  SdoServer server{domain};
  image::Nanoseconds now = 0;
};

const Bytes kTen{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

TEST_F(SdoServerTest, takes_an_object_in_blocks) {
  server.set_block_size(2);
  EXPECT_EQ(ask({0xC6, 0x00, 0x20, 0, 10, 0, 0, 0}), (Bytes{0xA4, 0x00, 0x20, 0, 2, 0, 0, 0}));
  EXPECT_EQ(ask({0x01, 1, 2, 3, 4, 5, 6, 7}), Bytes{});
  EXPECT_EQ(ask({0x82, 8, 9, 10, 0, 0, 0, 0}), (Bytes{0xA2, 2, 2, 0, 0, 0, 0, 0}));
  const std::uint16_t crc = sdo_crc(kTen);
  EXPECT_EQ(ask({0xD1, static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8), 0, 0, 0, 0, 0}),
            (Bytes{0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(domain.stored, kTen);
}

TEST_F(SdoServerTest, takes_an_empty_string) {
  domain.stored = kTen;
  EXPECT_EQ(ask({0x21, 0x00, 0x20, 0, 0, 0, 0, 0}), (Bytes{0x60, 0x00, 0x20, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x0F, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(domain.writes, 1);
  EXPECT_TRUE(domain.stored.empty());
}

TEST_F(SdoServerTest, a_wrong_checksum_or_length_leaves_the_object_as_it_was) {
  for (const bool wrong_crc : {true, false}) {
    ask({0xC6, 0x00, 0x20, 0, 10, 0, 0, 0});
    ask({0x01, 1, 2, 3, 4, 5, 6, 7});
    ask({0x82, 8, 9, 10, 0, 0, 0, 0});
    const Bytes code = wrong_crc ? Bytes{0x04, 0x00, 0x04, 0x05} : Bytes{0x13, 0x00, 0x07, 0x06};
    const Bytes answer = ask({static_cast<std::uint8_t>(wrong_crc ? 0xD1 : 0xD5), 0x12, 0x34, 0, 0, 0, 0, 0});
    EXPECT_EQ(answer, (Bytes{0x80, 0x00, 0x20, 0, code[0], code[1], code[2], code[3]}));
  }
  EXPECT_EQ(domain.writes, 0);
}

TEST_F(SdoServerTest, a_gap_is_confirmed_up_to_where_it_begins) {
  ask({0xC6, 0x00, 0x20, 0, 30, 0, 0, 0});
  ask({0x01, 1, 2, 3, 4, 5, 6, 7});
  ask({0x03, 15, 16, 17, 18, 19, 20, 21});
  ask({0x04, 22, 23, 24, 25, 26, 27, 28});
  EXPECT_EQ(ask({0x85, 29, 30, 0, 0, 0, 0, 0}), (Bytes{0xA2, 1, 127, 0, 0, 0, 0, 0}));
}

TEST_F(SdoServerTest, silence_within_a_block_is_answered_with_what_came_and_then_with_an_abort) {
  ask({0xC6, 0x00, 0x20, 0, 30, 0, 0, 0});
  ask({0x01, 1, 2, 3, 4, 5, 6, 7});
  SdoBytes answer{};
  EXPECT_FALSE(server.tick(SdoServer::kSilence - 1, answer));
  ASSERT_TRUE(server.tick(SdoServer::kSilence, answer));
  EXPECT_EQ(answer, (SdoBytes{0xA2, 1, 127}));
  EXPECT_FALSE(server.tick(2 * SdoServer::kSilence, answer)) << "never a second time without a new segment";
  ASSERT_TRUE(server.tick(3 * SdoServer::kSilence, answer));
  EXPECT_EQ(answer, (SdoBytes{0x80, 0x00, 0x20, 0, 0x00, 0x00, 0x04, 0x05}));
}

TEST_F(SdoServerTest, gives_an_object_in_blocks_of_the_size_that_the_client_asks_for) {
  domain.stored = kTen;
  EXPECT_EQ(ask({0xA4, 0x00, 0x20, 0, 1, 0, 0, 0}), (Bytes{0xC6, 0x00, 0x20, 0, 10, 0, 0, 0}));
  EXPECT_EQ(segment(), Bytes{}) << "not before the start";
  EXPECT_EQ(ask({0xA3, 0, 0, 0, 0, 0, 0, 0}), Bytes{});
  EXPECT_EQ(segment(), (Bytes{0x01, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(segment(), Bytes{});
  EXPECT_EQ(ask({0xA2, 1, 5, 0, 0, 0, 0, 0}), Bytes{});
  EXPECT_EQ(segment(), (Bytes{0x81, 8, 9, 10, 0, 0, 0, 0}));
  EXPECT_EQ(segment(), Bytes{});
  const std::uint16_t crc = sdo_crc(kTen);
  EXPECT_EQ(ask({0xA2, 1, 5, 0, 0, 0, 0, 0}), (Bytes{0xD1, static_cast<std::uint8_t>(crc),
                                                     static_cast<std::uint8_t>(crc >> 8), 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0xA1, 0, 0, 0, 0, 0, 0, 0}), Bytes{});
}

TEST_F(SdoServerTest, an_object_at_the_switch_threshold_comes_without_blocks) {
  domain.stored = kTen;
  EXPECT_EQ(ask({0xA0, 0x00, 0x20, 0, 10, 10, 0, 0}), (Bytes{0x41, 0x00, 0x20, 0, 10, 0, 0, 0}));
  EXPECT_EQ(ask({0xA0, 0x00, 0x20, 0, 10, 9, 0, 0})[0], 0xC6);
}

TEST_F(SdoServerTest, aborts_name_what_is_against_the_protocol) {
  domain.stored = kTen;
  const Bytes block_size{0x80, 0x00, 0x20, 0, 0x02, 0x00, 0x04, 0x05};
  EXPECT_EQ(ask({0xA4, 0x00, 0x20, 0, 0, 0, 0, 0}), block_size);
  EXPECT_EQ(ask({0xA4, 0x00, 0x20, 0, 128, 0, 0, 0}), block_size);
  ask({0xA4, 0x00, 0x20, 0, 5, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  segment();
  EXPECT_EQ(ask({0xA2, 2, 5, 0, 0, 0, 0, 0}), (Bytes{0x80, 0x00, 0x20, 0, 0x03, 0x00, 0x04, 0x05}))
      << "confirmed more than was sent";
  EXPECT_EQ(ask({0xC6, 0x01, 0x20, 0, 10, 0, 0, 0}), (Bytes{0x80, 0x01, 0x20, 0, 0x02, 0x00, 0x01, 0x06}));
  server.allow_blocks(false);
  EXPECT_EQ(ask({0xC6, 0x00, 0x20, 0, 10, 0, 0, 0}), (Bytes{0x80, 0x00, 0x20, 0, 0x01, 0x00, 0x04, 0x05}));
}

/// Client and server over a wire that loses and doubles frames, with block sizes that change.
struct Line {
  std::mt19937 random;
  unsigned lost_of_1000 = 0, doubled_of_1000 = 0;
  Domain domain;
  SdoServer server{domain};
  SdoClient client{1, 600 * image::kMillisecond, 8};
  ScriptedBus bus;
  image::Nanoseconds now = 0;

  bool passes() { return random() % 1000 >= lost_of_1000; }
  void to_client(const SdoBytes& bytes) {
    image::CanFrame f = make_frame(0x581, bytes);
    if (passes()) client.on_frame(f);
    if (random() % 1000 < doubled_of_1000) client.on_frame(f);
  }
  void to_server(const image::CanFrame& f) {
    SdoBytes answer{};
    if (passes() && server.handle(std::span(f.data).first(f.length), now, answer)) to_client(answer);
    if (random() % 1000 < doubled_of_1000 && server.handle(std::span(f.data).first(f.length), now, answer))
      to_client(answer);
  }
  void run() {
    for (int i = 0; client.busy() && i < 200'000; ++i) {
      now += image::kMillisecond;
      for (int n = 0; n < 4; ++n) client.poll(now, bus);
      const auto sent = std::move(bus.sent);
      bus.sent.clear();
      for (const auto& f : sent) to_server(f);
      SdoBytes bytes{};
      if (server.tick(now, bytes)) to_client(bytes);
      for (int n = 0; n < 4 && server.segment(bytes); ++n) {
        server.segment_sent();
        to_client(bytes);
      }
    }
  }
};

struct Wire {
  const char* name;
  unsigned lost, doubled;
};

class SdoOverAWire : public ::testing::TestWithParam<Wire> {};

TEST_P(SdoOverAWire, brings_every_byte_of_every_length_or_says_that_it_did_not) {
  constexpr unsigned kSeed = 77;
  std::mt19937 random(kSeed);
  int done = 0;
  constexpr int kCases = 1500;
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    Line line;
    line.random.seed(random());
    line.lost_of_1000 = GetParam().lost;
    line.doubled_of_1000 = GetParam().doubled;
    line.server.set_block_size(static_cast<std::uint8_t>(1 + random() % 127));
    line.client.set_block_size(static_cast<std::uint8_t>(1 + random() % 127));
    Bytes content(1 + random() % (i % 10 == 0 ? 5000 : 300));
    for (auto& b : content) b = static_cast<std::uint8_t>(random());
    Bytes memory(content.size() + random() % 3);
    const bool download = random() % 2;
    if (download) {
      ASSERT_TRUE(line.client.download_from(0x2000, 0, content));
    } else {
      line.domain.stored = content;
      ASSERT_TRUE(line.client.upload_into(0x2000, 0, memory));
    }
    line.run();
    ASSERT_FALSE(line.client.busy());
    if (line.client.result().status != SdoStatus::done) continue;
    ++done;
    ASSERT_EQ(download ? line.domain.stored : Bytes(line.client.data().begin(), line.client.data().end()),
              content);
  }
  if (GetParam().lost == 0 && GetParam().doubled == 0) {
    EXPECT_EQ(done, kCases);
  }
  EXPECT_GT(done, kCases * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Wires, SdoOverAWire,
                         ::testing::Values(Wire{"perfect", 0, 0}, Wire{"lossy", 10, 0},
                                           Wire{"doubling", 0, 10}, Wire{"bad", 20, 20}),
                         [](const auto& p) { return std::string(p.param.name); });

TEST(SdoOverAWireAlone, a_lost_segment_costs_segments_and_not_the_transfer) {
  Line line;
  const Bytes content(20'000, 0x5A);
  ASSERT_TRUE(line.client.download_from(0x2000, 0, content));
  line.lost_of_1000 = 5;
  line.run();
  EXPECT_EQ(line.client.result().status, SdoStatus::done);
  EXPECT_EQ(line.domain.stored, content);
  EXPECT_LE(line.client.result().retries, 2u) << "some 14 of 2858 segments were lost";
}

}  // namespace
}  // namespace servogate::canopen
