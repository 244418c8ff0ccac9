// SPDX-License-Identifier: Apache-2.0
// The requests of Huanyang inverters byte by byte, as they are on wires in the field; without address and
// checksum.
#include "firmware_if/modbus/huanyang.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace servogate::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Request asked(Function function, std::uint16_t address, std::uint16_t value = 0) {
  Request r;
  r.function = function;
  r.address = address;
  r.coding = Coding::huanyang;
  r.data.words[0] = value;
  return r;
}
Bytes bytes_of(const Request& request) {
  Pdu pdu;
  EXPECT_TRUE(encode(request, pdu));
  return {pdu.bytes.begin(), pdu.bytes.begin() + static_cast<std::ptrdiff_t>(pdu.size)};
}

const Request kForward = asked(Function::write_single_register, huanyang::kControl, 0x01);
const Request k25Hz = asked(Function::write_single_register, huanyang::kFrequency, 2500);
const Request kOutput = asked(Function::read_input_registers, 1);
const Request kParameter = asked(Function::read_holding_registers, 144);

TEST(Huanyang, asks_with_functions_of_its_own_and_a_count_of_bytes) {
  EXPECT_EQ(bytes_of(kForward), (Bytes{0x03, 0x01, 0x01}));
  EXPECT_EQ(bytes_of(asked(Function::write_single_register, huanyang::kControl, 0x11)),
            (Bytes{0x03, 0x01, 0x11}));
  EXPECT_EQ(bytes_of(k25Hz), (Bytes{0x05, 0x02, 0x09, 0xC4}));
  EXPECT_EQ(bytes_of(kOutput), (Bytes{0x04, 0x03, 0x01, 0x00, 0x00}));
  EXPECT_EQ(bytes_of(kParameter), (Bytes{0x01, 0x03, 0x90, 0x00, 0x00}));
}

TEST(Huanyang, has_no_other_requests) {
  Pdu pdu;
  EXPECT_FALSE(encode(asked(Function::write_single_register, 4), pdu));
  EXPECT_FALSE(encode(asked(Function::read_input_registers, 8), pdu));
  EXPECT_FALSE(encode(asked(Function::read_holding_registers, 256), pdu));
  EXPECT_FALSE(encode(asked(Function::read_coils, 0), pdu));
  Request two = kOutput;
  two.count = 2;
  EXPECT_FALSE(encode(two, pdu));
}

TEST(Huanyang, takes_the_answer_to_what_was_asked_and_no_other) {
  Response r;
  const auto fault = [&](const Request& request, const Bytes& bytes) {
    return decode_response(bytes, request, r);
  };
  EXPECT_EQ(fault(kOutput, {0x04, 0x03, 0x01, 0x09, 0xC4}), AnswerFault::none);
  EXPECT_EQ(r.data.words[0], 2500);
  EXPECT_EQ(fault(kOutput, {0x04, 0x03, 0x00, 0x09, 0xC4}), AnswerFault::wrong_echo) << "the set frequency";
  EXPECT_EQ(fault(kOutput, {0x04, 0x03, 0x01, 0x09}), AnswerFault::wrong_length);
  EXPECT_EQ(fault(kOutput, {0x03, 0x01, 0x01}), AnswerFault::wrong_function);
  EXPECT_EQ(fault(kOutput, {0x04}), AnswerFault::too_short);
  EXPECT_EQ(fault(kForward, {0x03, 0x01, 0x09}), AnswerFault::none);
  EXPECT_EQ(r.data.words[0], 0x09) << "run, running";
  EXPECT_EQ(fault(k25Hz, {0x05, 0x02, 0x09, 0xC4}), AnswerFault::none);
  EXPECT_EQ(fault(k25Hz, {0x05, 0x02, 0x09, 0xC5}), AnswerFault::wrong_echo);
  EXPECT_EQ(fault(kParameter, {0x01, 0x03, 0x90, 0x0B, 0xB8}), AnswerFault::none);
  EXPECT_EQ(r.data.words[0], 3000);
  EXPECT_EQ(fault(kParameter, {0x01, 0x02, 0x90, 0x04}), AnswerFault::none) << "a parameter of one byte";
  EXPECT_EQ(r.data.words[0], 4);
  EXPECT_EQ(fault(k25Hz, {0x85, 0x02}), AnswerFault::none);
  EXPECT_EQ(r.exception, Exception::illegal_data_address);
}

TEST(Huanyang, is_read_back_by_its_other_end) {
  for (const Request& r : {kForward, k25Hz, kOutput, kParameter}) {
    Request back;
    EXPECT_EQ(huanyang::decode_request(bytes_of(r), back), Exception::none);
    EXPECT_EQ(back.function, r.function);
    EXPECT_EQ(back.address, r.address);
    EXPECT_EQ(back.data.words[0], r.data.words[0]);
  }
  Request none;
  EXPECT_EQ(huanyang::decode_request(Bytes{0x03, 0x02, 0x01}, none), Exception::illegal_data_value);
  EXPECT_EQ(huanyang::decode_request(Bytes{0x02, 0x03, 0x05, 0x00, 0x00}, none), Exception::illegal_function);
  EXPECT_EQ(huanyang::decode_request(Bytes{0x04, 0x03, 0x08, 0x00, 0x00}, none),
            Exception::illegal_data_address);
}

}  // namespace
}  // namespace servogate::modbus
