// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <random>
#include <vector>

#include "firmware_if/modbus/pdu.hpp"
#include "tests/property_seed.hpp"

namespace servogate::modbus {
namespace {

constexpr Function kAll[] = {
    Function::read_coils,           Function::read_discrete_inputs,    Function::read_holding_registers,
    Function::read_input_registers, Function::write_single_coil,       Function::write_single_register,
    Function::write_multiple_coils, Function::write_multiple_registers};

std::vector<std::uint8_t> bytes(const Pdu& pdu) {
  return {pdu.bytes.begin(), pdu.bytes.begin() + static_cast<long>(pdu.size)};
}
using Bytes = std::vector<std::uint8_t>;

void fill(Data& data, std::mt19937_64& random) {
  for (auto& b : data.bits) b = static_cast<std::uint8_t>(random());
  for (auto& w : data.words) w = static_cast<std::uint16_t>(random());
}

void expect_same(Function f, std::uint16_t count, const Data& a, const Data& b) {
  for (std::size_t i = 0; i < count; ++i) {
    if (carries_bits(f))
      ASSERT_EQ(a.bit(i), b.bit(i)) << "bit " << i;
    else
      ASSERT_EQ(a.words[i], b.words[i]) << "word " << i;
  }
}

Request random_request(std::mt19937_64& random) {
  Request r;
  r.function = kAll[random() % 8];
  r.count = static_cast<std::uint16_t>(1 + random() % max_count(r.function));
  r.address = static_cast<std::uint16_t>(random() % (0x10000u - r.count + 1));
  fill(r.data, random);
  return r;
}

TEST(ModbusPdu, encodes_the_examples_of_the_specification) {
  Pdu pdu;
  Request r{Function::read_coils, 0x13, 0x13, {}};
  ASSERT_TRUE(encode(r, pdu));
  EXPECT_EQ(bytes(pdu), (Bytes{1, 0x00, 0x13, 0x00, 0x13}));

  r = {Function::write_single_coil, 0xAC, 1, {}};
  r.data.set_bit(0, true);
  ASSERT_TRUE(encode(r, pdu));
  EXPECT_EQ(bytes(pdu), (Bytes{5, 0x00, 0xAC, 0xFF, 0x00}));

  r = {Function::write_multiple_coils, 0x13, 10, {}};
  r.data.bits[0] = 0xCD;
  r.data.bits[1] = 0xFD;  // bits above the tenth are not the request's and go out as zero
  ASSERT_TRUE(encode(r, pdu));
  EXPECT_EQ(bytes(pdu), (Bytes{15, 0x00, 0x13, 0x00, 0x0A, 0x02, 0xCD, 0x01}));

  r = {Function::write_multiple_registers, 1, 2, {}};
  r.data.words[0] = 10;
  r.data.words[1] = 0x0102;
  ASSERT_TRUE(encode(r, pdu));
  EXPECT_EQ(bytes(pdu), (Bytes{16, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0A, 0x01, 0x02}));
}

TEST(ModbusPdu, brings_every_request_and_its_answer_round) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const Request r = random_request(random);
    Pdu pdu;
    ASSERT_TRUE(encode(r, pdu));
    ASSERT_EQ(pdu.size, request_size(r.function, r.count));
    Request back;
    ASSERT_EQ(decode_request(pdu.view(), back), Exception::none);
    ASSERT_EQ(back.function, r.function);
    ASSERT_EQ(back.address, r.address);
    ASSERT_EQ(back.count, r.count);
    if (writes(r.function)) expect_same(r.function, r.count, back.data, r.data);

    Response answer{r.function, Exception::none, r.address, r.count, r.data};
    if (!writes(r.function)) fill(answer.data, random);
    ASSERT_TRUE(encode(answer, pdu));
    ASSERT_EQ(pdu.size, response_size(r.function, r.count));
    Response heard;
    ASSERT_EQ(decode_response(pdu.view(), r, heard), AnswerFault::none);
    ASSERT_EQ(heard.exception, Exception::none);
    if (!writes(r.function)) expect_same(r.function, r.count, heard.data, answer.data);
  }
}

TEST(ModbusPdu, survives_random_bytes_and_only_accepts_what_it_can_encode_again) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  int accepted = 0;
  for (int i = 0; i < 200000; ++i) {
    Bytes noise(random() % 24);
    for (auto& b : noise) b = static_cast<std::uint8_t>(random());
    if (!noise.empty() && random() % 2) noise[0] = static_cast<std::uint8_t>(kAll[random() % 8]);
    Request r;
    if (decode_request(noise, r) == Exception::none) {
      Pdu pdu;
      ASSERT_TRUE(encode(r, pdu));
      ASSERT_EQ(pdu.size, noise.size());
      ++accepted;
    }
    const Request asked = random_request(random);
    Response heard;
    decode_response(noise, asked, heard);
  }
  EXPECT_GT(accepted, 100);
}

TEST(ModbusPdu, refuses_to_encode_a_count_that_the_function_cannot_carry) {
  Pdu pdu;
  for (const Function f : kAll) {
    EXPECT_FALSE(encode(Request{f, 0, 0, {}}, pdu));
    EXPECT_TRUE(encode(Request{f, 0, max_count(f), {}}, pdu));
    EXPECT_FALSE(encode(Request{f, 0, static_cast<std::uint16_t>(max_count(f) + 1), {}}, pdu));
  }
  EXPECT_TRUE(encode(Request{Function::read_coils, 65535, 1, {}}, pdu));
  EXPECT_FALSE(encode(Request{Function::read_coils, 65535, 2, {}}, pdu));
}

TEST(ModbusPdu, a_server_names_the_exception_that_a_bad_request_deserves) {
  Request r;
  EXPECT_EQ(decode_request(Bytes{}, r), Exception::illegal_function);
  EXPECT_EQ(decode_request(Bytes{7, 0, 0, 0, 1}, r), Exception::illegal_function);
  EXPECT_EQ(decode_request(Bytes{1, 0, 0, 0}, r), Exception::illegal_data_value);
  EXPECT_EQ(decode_request(Bytes{1, 0, 0, 0, 0}, r), Exception::illegal_data_value);
  EXPECT_EQ(decode_request(Bytes{3, 0, 0, 0, 126}, r), Exception::illegal_data_value);
  EXPECT_EQ(decode_request(Bytes{3, 0xFF, 0xFF, 0, 2}, r), Exception::illegal_data_address);
  EXPECT_EQ(decode_request(Bytes{5, 0, 0, 0x12, 0x34}, r), Exception::illegal_data_value);
  EXPECT_EQ(decode_request(Bytes{15, 0, 0, 0, 9, 1, 0xFF}, r), Exception::illegal_data_value);
  EXPECT_EQ(decode_request(Bytes{16, 0, 0, 0, 1, 2, 0}, r), Exception::illegal_data_value);
}

TEST(ModbusPdu, a_client_tells_an_exception_from_a_broken_answer) {
  const Request asked{Function::read_holding_registers, 4, 2, {}};
  Response heard;
  EXPECT_EQ(decode_response(Bytes{0x83, 2}, asked, heard), AnswerFault::none);
  EXPECT_EQ(heard.exception, Exception::illegal_data_address);
  EXPECT_EQ(decode_response(Bytes{3}, asked, heard), AnswerFault::too_short);
  EXPECT_EQ(decode_response(Bytes{4, 4, 0, 1, 0, 2}, asked, heard), AnswerFault::wrong_function);
  EXPECT_EQ(decode_response(Bytes{3, 4, 0, 1, 0}, asked, heard), AnswerFault::wrong_length);
  EXPECT_EQ(decode_response(Bytes{3, 2, 0, 1, 0, 2}, asked, heard), AnswerFault::wrong_length);
  Request write{Function::write_single_register, 9, 1, {}};
  write.data.words[0] = 500;
  EXPECT_EQ(decode_response(Bytes{6, 0, 9, 1, 0xF4}, write, heard), AnswerFault::none);
  EXPECT_EQ(decode_response(Bytes{6, 0, 8, 1, 0xF4}, write, heard), AnswerFault::wrong_echo);
}

}  // namespace
}  // namespace servogate::modbus
