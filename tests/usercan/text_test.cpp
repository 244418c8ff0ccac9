// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/address.hpp"
#include "drivers/usercan/socketcand_text.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

using image::CanFrame;

TEST(SocketcandText, elements_are_found_between_anything_else) {
  std::string_view bytes = " \n< ok >noise< frame 1 0.1 00 >< hal";
  std::vector<std::string> found;
  std::size_t taken = 0;
  while (const auto element = find_element(bytes, taken)) {
    found.emplace_back(*element);
    bytes = bytes.substr(taken);
  }
  EXPECT_EQ(found, (std::vector<std::string>{" ok ", " frame 1 0.1 00 "}));
  EXPECT_EQ(bytes, "< hal");
}

TEST(SocketcandText, a_frame_sent_is_the_frame_read) {
  CanFrame remote = make(0x701, {});
  remote.remote = true;
  remote.length = 8;
  for (const CanFrame& sent : {make(0, {}), make(0x7FF, {0xFF, 0, 1, 2, 3, 4, 5, 6}), make(0x12345, {1}),
                               make(0x1FFFFFFF, {}), remote}) {
    std::size_t taken = 0;
    CanFrame read;
    const Element out = send_element(sent);
    Words words(*find_element(out.view(), taken));
    const std::string_view word = words.next();
    ASSERT_TRUE(read_send(words, word == "remote", read)) << out.view();
    EXPECT_EQ(read.id, sent.id);
    EXPECT_EQ(read.extended, sent.extended);
    EXPECT_EQ(read.remote, sent.remote);
    EXPECT_EQ(read.length, sent.length);
    EXPECT_EQ(read.data, sent.data);
    const Element back = frame_element(sent, 12'000'345'000);
    Words again(*find_element(back.view(), taken));
    again.next();
    ASSERT_TRUE(read_frame(again, sent.remote, read)) << back.view();
    EXPECT_EQ(read.id, sent.id);
    EXPECT_EQ(read.length, sent.length);
    EXPECT_EQ(read.data, sent.data);
    EXPECT_EQ(read.timestamp_ns, 12'000'345'000);
  }
}

TEST(SocketcandText, an_identifier_of_eight_digits_has_29_bits) {
  CanFrame f;
  ASSERT_TRUE(read_send(Words("00000123 0"), false, f));
  EXPECT_TRUE(f.extended);
  EXPECT_EQ(f.id, 0x123u);
  ASSERT_TRUE(read_send(Words("123 0"), false, f));
  EXPECT_FALSE(f.extended);
  ASSERT_TRUE(read_send(Words("12345 0"), false, f)) << "python-can leaves the zeros out";
  EXPECT_TRUE(f.extended);
}

TEST(SocketcandText, what_is_no_frame_is_refused) {
  CanFrame f;
  for (const char* wrong :
       {"", "123", "xyz 0", "123 9 1 2 3 4 5 6 7 8 9", "123 2 1", "123 1 1 2", "123 1 100", "20000000 0",
        "800 1 AA", "FFF 0", "0123 0", "000000123 0", "123 1 -1", "123 1 1x"})
    EXPECT_FALSE(read_send(Words(wrong), false, f)) << wrong;
  for (const char* wrong :
       {"", "123", "123 1.2 123", "123 1.2 112233445566778899", "123 x 11", "123 1.1234567 11"})
    EXPECT_FALSE(read_frame(Words(wrong), false, f)) << wrong;
}

TEST(Address, is_a_host_with_port_or_a_path) {
  EXPECT_EQ(parse_address("127.0.0.1:29536")->str(), "127.0.0.1:29536");
  EXPECT_EQ(parse_address("[::1]:29536")->str(), "[::1]:29536");
  EXPECT_EQ(parse_address("unix:/run/bus")->str(), "unix:/run/bus");
  for (const char* wrong :
       {"", "localhost", ":29536", "localhost:", "localhost:99999", "localhost:12x", "unix:"})
    EXPECT_FALSE(parse_address(wrong)) << wrong;
}

}  // namespace
}  // namespace servogate::usercan
