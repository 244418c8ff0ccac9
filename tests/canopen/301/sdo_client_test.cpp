// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_client.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::ScriptedBus;
using Bytes = std::vector<std::uint8_t>;
using Lines = std::vector<std::string>;

constexpr image::Nanoseconds kTimeout = 50 * image::kMillisecond;

/// A client of node 1, its bus and its clock.
struct SdoClientTest : ::testing::Test {
  void poll() { client.poll(now, bus); }
  void wait(image::Nanoseconds time) {
    now += time;
    poll();
  }
  void answer(std::initializer_list<int> bytes) { client.on_frame(frame(0x581, bytes)); }
  Bytes data() const { return {client.data().begin(), client.data().end()}; }

  ScriptedBus bus;
  SdoClient client{1, kTimeout, 1};
  image::Nanoseconds now = 0;
};

TEST_F(SdoClientTest, reads_a_small_object_in_one_exchange) {
  ASSERT_TRUE(client.upload(0x1000, 0));
  EXPECT_FALSE(client.upload(0x1001, 0)) << "one transfer at a time";
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 40 00 10 00 00 00 00 00"});
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().size, 4u);
  EXPECT_EQ(client.value(), 0x00020192u);
  wait(10 * kTimeout);
  EXPECT_TRUE(bus.take_sent().empty()) << "nothing more to say";
}

TEST_F(SdoClientTest, writes_a_small_object_in_one_exchange) {
  ASSERT_TRUE(client.download(0x1017, 0, 100, 2));
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 2B 17 10 00 64 00 00 00"});
  answer({0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().size, 2u);
}

TEST_F(SdoClientTest, reads_a_string_in_segments) {
  client.upload(0x1008, 0);
  poll();
  answer({0x41, 0x08, 0x10, 0x00, 10, 0, 0, 0});
  poll();
  answer({0x00, 'S', 'e', 'r', 'v', 'o', 'g', 'a'});
  poll();
  answer({0x19, 't', 'e', '!', 0, 0, 0, 0});
  EXPECT_EQ(bus.take_sent(), (Lines{"601 40 08 10 00 00 00 00 00", "601 60 00 00 00 00 00 00 00",
                                    "601 70 00 00 00 00 00 00 00"}));
  ASSERT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(data(), (Bytes{'S', 'e', 'r', 'v', 'o', 'g', 'a', 't', 'e', '!'}));
}

TEST_F(SdoClientTest, writes_a_record_in_segments) {
  ASSERT_TRUE(client.download(0x2000, 3, Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  poll();
  answer({0x60, 0x00, 0x20, 0x03, 0, 0, 0, 0});
  poll();
  answer({0x20, 0, 0, 0, 0, 0, 0, 0});
  poll();
  answer({0x30, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(bus.take_sent(), (Lines{"601 21 00 20 03 09 00 00 00", "601 00 01 02 03 04 05 06 07",
                                    "601 1B 08 09 00 00 00 00 00"}));
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().size, 9u);
}

TEST_F(SdoClientTest, an_abort_of_the_device_ends_the_transfer_with_its_code) {
  client.download(0x6040, 0, 6, 2);
  poll();
  answer({0x80, 0x40, 0x60, 0x00, 0x22, 0x00, 0x00, 0x08});
  EXPECT_EQ(client.result().status, SdoStatus::aborted);
  EXPECT_EQ(client.result().abort, AbortCode::device_state);
  EXPECT_TRUE(client.data().empty());
}

TEST_F(SdoClientTest, retries_a_lost_answer_once_and_then_names_the_object) {
  client.upload(0x6064, 0);
  poll();
  wait(kTimeout - 1);
  EXPECT_EQ(bus.take_sent().size(), 1u);
  wait(1);
  poll();
  EXPECT_EQ(bus.take_sent(), (Lines{"601 80 64 60 00 00 00 04 05", "601 40 64 60 00 00 00 00 00"}));
  EXPECT_TRUE(client.busy());
  wait(kTimeout);
  EXPECT_EQ(bus.take_sent(), Lines{"601 80 64 60 00 00 00 04 05"});
  EXPECT_EQ(client.result().status, SdoStatus::no_answer);
  EXPECT_EQ(client.result().index, 0x6064);
  EXPECT_EQ(client.result().retries, 1u);
  EXPECT_EQ(client.result().abort, AbortCode::timed_out);
}

TEST_F(SdoClientTest, waits_longer_for_one_transfer_where_it_is_told_to_and_never_shorter) {
  client.download(0x1010, 1, 0x65766173, 4);
  client.wait_for(5 * kTimeout);
  poll();
  wait(4 * kTimeout);
  EXPECT_EQ(bus.take_sent().size(), 1u) << "no repetition";
  answer({0x60, 0x10, 0x10, 0x01, 0, 0, 0, 0});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().retries, 0u);
  client.upload(0x6064, 0);
  poll();
  wait(kTimeout);
  EXPECT_EQ(client.result().retries, 1u) << "the next transfer has the usual time";
  poll();
  answer({0x43, 0x64, 0x60, 0x00, 1, 0, 0, 0});
  client.upload(0x6064, 0);
  client.wait_for(1);
  poll();
  wait(kTimeout - 1);
  EXPECT_EQ(client.result().retries, 0u);
}

TEST_F(SdoClientTest, an_answer_to_the_repetition_is_as_good) {
  client.upload(0x6064, 0);
  poll();
  wait(kTimeout);
  poll();
  answer({0x43, 0x64, 0x60, 0x00, 1, 0, 0, 0});
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().retries, 1u);
}

TEST_F(SdoClientTest, an_answer_of_another_object_or_node_or_length_is_not_ours) {
  client.upload(0x6064, 0);
  poll();
  answer({0x43, 0x63, 0x60, 0x00, 1, 0, 0, 0});
  answer({0x43, 0x64, 0x60, 0x01, 1, 0, 0, 0});
  answer({0x60, 0x64, 0x60, 0x00, 0, 0, 0, 0});
  answer({0x80, 0x63, 0x60, 0x00, 0, 0, 0, 8});
  answer({0x43, 0x64, 0x60, 0x00, 1});
  EXPECT_FALSE(client.on_frame(frame(0x582, {0x43, 0x64, 0x60, 0, 9, 0, 0, 0})));
  EXPECT_TRUE(client.busy());
  answer({0x43, 0x64, 0x60, 0x00, 2, 0, 0, 0});
  EXPECT_EQ(client.value(), 2u);
}

TEST_F(SdoClientTest, an_answer_before_the_request_left_is_old) {
  bus.refuse_sending = true;
  client.upload(0x6064, 0);
  poll();
  answer({0x43, 0x64, 0x60, 0x00, 1, 0, 0, 0});
  EXPECT_TRUE(client.busy());
  bus.refuse_sending = false;
  wait(10 * kTimeout);
  EXPECT_EQ(bus.take_sent(), Lines{"601 40 64 60 00 00 00 00 00"}) << "time counts from the sending";
}

TEST_F(SdoClientTest, a_segment_delivered_twice_counts_once) {
  client.upload(0x1008, 0);
  poll();
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  poll();
  answer({0x00, 1, 2, 3, 4, 5, 6, 7});
  answer({0x00, 1, 2, 3, 4, 5, 6, 7});
  poll();
  answer({0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_TRUE(client.busy());
  answer({0x1B, 8, 9, 0, 0, 0, 0, 0});
  EXPECT_EQ(data(), (Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(SdoClientTest, a_wrong_toggle_breaks_the_transfer_off) {
  client.upload(0x1008, 0);
  poll();
  answer({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  poll();
  answer({0x10, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(client.result().status, SdoStatus::bad_protocol);
  bus.take_sent();
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 80 08 10 00 00 00 03 05"});
}

TEST_F(SdoClientTest, a_length_other_than_announced_breaks_the_transfer_off) {
  client.upload(0x1008, 0);
  poll();
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  poll();
  answer({0x01, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(client.result().status, SdoStatus::bad_protocol);
  EXPECT_EQ(client.result().abort, AbortCode::length_mismatch);
}

TEST_F(SdoClientTest, an_object_longer_than_the_buffer_breaks_the_transfer_off) {
  client.upload(0x1F50, 1);
  poll();
  answer({0x41, 0x50, 0x1F, 0x01, 0x81, 0, 0, 0});
  EXPECT_EQ(client.result().abort, AbortCode::out_of_memory);
  poll();
  client.upload(0x1F50, 1);
  poll();
  answer({0x40, 0x50, 0x1F, 0x01, 0, 0, 0, 0});
  for (int i = 0; client.busy() && i < 100; ++i) {
    poll();
    answer({i % 2 ? 0x10 : 0x00, i, 1, 2, 3, 4, 5, 6});
  }
  EXPECT_EQ(client.result().abort, AbortCode::out_of_memory);
}

TEST_F(SdoClientTest, empty_segments_without_end_are_not_waited_for) {
  client.upload(0x1008, 0);
  poll();
  answer({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  poll();
  answer({0x0E, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.result().status, SdoStatus::bad_protocol);
}

TEST_F(SdoClientTest, cancel_tells_the_device_and_frees_the_client) {
  client.upload(0x1008, 0);
  poll();
  bus.take_sent();
  client.cancel();
  EXPECT_FALSE(client.busy());
  poll();
  EXPECT_EQ(bus.take_sent(), Lines{"601 80 08 10 00 00 00 00 08"});
  answer({0x43, 0x08, 0x10, 0x00, 1, 2, 3, 4});
  EXPECT_EQ(client.result().status, SdoStatus::idle);
}

TEST_F(SdoClientTest, an_empty_string_is_written_in_a_segment_without_data) {
  ASSERT_TRUE(client.download(0x2000, 3, Bytes{}));
  poll();
  answer({0x60, 0x00, 0x20, 0x03, 0, 0, 0, 0});
  poll();
  answer({0x20, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(bus.take_sent(), (Lines{"601 21 00 20 03 00 00 00 00", "601 0F 00 00 00 00 00 00 00"}));
  EXPECT_EQ(client.result().status, SdoStatus::done);
  EXPECT_EQ(client.result().size, 0u);
}

TEST_F(SdoClientTest, too_much_cannot_be_written) {
  EXPECT_FALSE(client.download(0x2000, 0, Bytes(SdoClient::kBuffer + 1)));
  EXPECT_FALSE(client.download(0x2000, 0, 1, 9));
  EXPECT_TRUE(client.download(0x2000, 0, Bytes(SdoClient::kBuffer)));
}

/// The far end of random transfers: one object, byte by byte after CiA 301, 7.2.4.3. The wire between loses,
/// delays and doubles frames.
class LossyServer {
 public:
  Bytes object;

  void on_request(const image::CanFrame& f, std::vector<image::CanFrame>& answers) {
    const int specifier = f.data[0] >> 5;
    if (specifier == 4) {
      segments_ = false;
    } else if (specifier == 1) {
      initiate_download(f, answers);
    } else if (specifier == 0 && segments_) {
      download_segment(f, answers);
    } else if (specifier == 2) {
      initiate_upload(f, answers);
    } else if (specifier == 3 && segments_) {
      upload_segment(f, answers);
    }
  }

 private:
  static image::CanFrame reply(int command, const image::CanFrame& f) {
    return frame(0x581, {command, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0});
  }
  void initiate_download(const image::CanFrame& f, std::vector<image::CanFrame>& answers) {
    if (f.data[0] & 2) {
      const int count = 4 - (f.data[0] >> 2 & 3);
      object.assign(f.data.begin() + 4, f.data.begin() + 4 + count);
      segments_ = false;
    } else {
      incoming_.clear();
      segments_ = true;
      toggle_ = 0;
    }
    answers.push_back(reply(0x60, f));
  }
  void download_segment(const image::CanFrame& f, std::vector<image::CanFrame>& answers) {
    if ((f.data[0] & 0x10) != toggle_) return;
    incoming_.insert(incoming_.end(), f.data.begin() + 1, f.data.begin() + 8 - (f.data[0] >> 1 & 7));
    answers.push_back(frame(0x581, {0x20 | toggle_, 0, 0, 0, 0, 0, 0, 0}));
    toggle_ ^= 0x10;
    if (f.data[0] & 1) {
      object = incoming_;
      segments_ = false;
    }
  }
  void initiate_upload(const image::CanFrame& f, std::vector<image::CanFrame>& answers) {
    segments_ = object.size() > 4;
    auto answer = reply(segments_ ? 0x41 : 0x43 | static_cast<int>(4 - object.size()) << 2, f);
    if (segments_) {
      answer.data[4] = static_cast<std::uint8_t>(object.size());
    } else {
      std::copy(object.begin(), object.end(), answer.data.begin() + 4);
    }
    toggle_ = 0;
    position_ = 0;
    answers.push_back(answer);
  }
  void upload_segment(const image::CanFrame& f, std::vector<image::CanFrame>& answers) {
    if ((f.data[0] & 0x10) != toggle_) return;
    const std::size_t count = std::min<std::size_t>(7, object.size() - position_);
    auto answer = frame(0x581, {toggle_ | static_cast<int>(7 - count) << 1, 0, 0, 0, 0, 0, 0, 0});
    std::copy_n(object.begin() + static_cast<std::ptrdiff_t>(position_), count, answer.data.begin() + 1);
    position_ += count;
    if (position_ == object.size()) answer.data[0] |= 1;
    toggle_ ^= 0x10;
    answers.push_back(answer);
  }

  Bytes incoming_;
  bool segments_ = false;
  int toggle_ = 0;
  std::size_t position_ = 0;
};

/// Runs one transfer over a wire that loses one frame in 20, doubles one in 20 and delays one in 20 beyond
/// the time-out.
void run_transfer(std::mt19937& random, SdoClient& client, LossyServer& server) {
  struct Late {
    image::Nanoseconds at;
    image::CanFrame frame;
  };
  ScriptedBus bus;
  std::vector<Late> wire;
  for (image::Nanoseconds now = 0; client.busy() && now < 100 * kTimeout; now += image::kMillisecond) {
    client.poll(now, bus);
    std::vector<image::CanFrame> answers;
    for (const auto& request : bus.sent)
      if (random() % 20) server.on_request(request, answers);
    bus.sent.clear();
    for (const auto& answer : answers) {
      const auto fate = random() % 20;
      if (fate == 0) continue;
      wire.push_back({now + (fate == 1 ? kTimeout + image::kMillisecond : image::kMillisecond), answer});
      if (fate == 2) wire.push_back({now + image::kMillisecond, answer});
    }
    for (const auto& late : wire)
      if (late.at == now) client.on_frame(late.frame);
  }
}

TEST(SdoClientOnABadWire, never_takes_wrong_data_for_right) {
  constexpr unsigned kSeed = 1411;
  std::mt19937 random(kSeed);
  int done = 0;
  constexpr int kCases = 4000;
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    SdoClient client(1, kTimeout, 5);
    LossyServer server;
    Bytes content(1 + random() % 60);
    for (auto& b : content) b = static_cast<std::uint8_t>(random());
    const bool download = random() % 2;
    if (download) {
      ASSERT_TRUE(client.download(0x2000, 1, content));
    } else {
      server.object = content;
      ASSERT_TRUE(client.upload(0x2000, 1));
    }
    run_transfer(random, client, server);
    ASSERT_FALSE(client.busy());
    if (client.result().status != SdoStatus::done) continue;
    ++done;
    ASSERT_EQ(download ? server.object : Bytes(client.data().begin(), client.data().end()), content);
  }
  EXPECT_GT(done, kCases * 9 / 10) << "five repetitions are enough for most";
}

TEST(SdoClientOnABadWire, survives_any_bytes) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  ScriptedBus bus;
  SdoClient client(1, kTimeout, 1);
  for (int i = 0; i < 200'000; ++i) {
    if (!client.busy()) {
      random() % 2 ? client.upload(0x2000, 1) : client.download(0x2000, 1, Bytes(1 + random() % 30, 7));
    }
    client.poll(i * image::kMillisecond, bus);
    auto f = frame(0x581, {0, 0, 0x20, 1, 0, 0, 0, 0});
    f.data[0] = static_cast<std::uint8_t>(random());
    f.data[4] = static_cast<std::uint8_t>(random());
    client.on_frame(f);
    ASSERT_LE(client.data().size(), SdoClient::kBuffer);
    bus.sent.clear();
  }
}

}  // namespace
}  // namespace servogate::canopen
