// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "drivers/mock/modbus/modbus_line.hpp"
#include "firmware_if/image/interface_map.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

using image::kMillisecond;
using image::kSecond;
using image::Nanoseconds;
using image::Quality;
using modbus::Function;

image::Place place(const std::string& text) { return *image::parse_place(text); }

/// 16 DI at SA0, 16 DO at SA64, 4 AI at SK0.RE, 2 AO at SK8.RE, each block every 20 ms.
modbus::Map example_map(std::uint8_t unit = 1) {
  modbus::Map map;
  map.blocks = {{unit, Function::read_discrete_inputs, 0, 16},
                {unit, Function::write_multiple_coils, 0, 16},
                {unit, Function::read_input_registers, 0, 4},
                {unit, Function::write_multiple_registers, 0, 2}};
  const auto add = [&](std::size_t block, std::uint16_t n, const std::string& at) {
    modbus::Point p;
    p.block = block;
    p.offset = n;
    p.rule.place = place(at);
    p.rule.hold = true;
    map.points.push_back(p);
  };
  for (std::uint16_t n = 0; n < 16; ++n) add(0, n, "SA" + std::to_string(n));
  for (std::uint16_t n = 0; n < 16; ++n) add(1, n, "SA" + std::to_string(64 + n));
  for (std::uint16_t n = 0; n < 4; ++n) add(2, n, "SK" + std::to_string(n) + ".RE");
  for (std::uint16_t n = 0; n < 2; ++n) add(3, n, "SK" + std::to_string(8 + n) + ".RE");
  return map;
}

/// The owner of the loop: 1 ms cycles as Cycle::step() will run them.
struct Loop {
  explicit Loop(MockModbusLine& bus) : line(bus) {}
  void run(Nanoseconds duration) {
    for (const Nanoseconds end = t + duration; t < end; t += kMillisecond) {
      line.advance_to(t);
      image.now.t_ns = t;
      line.receive(image, notices);
      line.send(image);
    }
  }
  bool bit(const std::string& at) const { return image.packets.bit(place(at)); }
  double number(const std::string& at) const { return image.packets.number(place(at)); }
  const image::IoSource& source(std::size_t n = 0) const { return image.sources[n]; }

  MockModbusLine& line;
  image::ProcessImage image;
  image::Notices notices;
  Nanoseconds t = 0;
};

TEST(MockModbusLine, brings_initial_inputs_into_packet_A_within_one_round_of_the_poll) {
  StationSettings station;
  station.initial_inputs = {true, false, true};
  station.initial_analog = {100, 0, 0, 4095};
  MockModbusLine line({}, example_map(), {station});
  Loop loop(line);
  loop.run(kMillisecond);
  EXPECT_EQ(loop.source().quality, Quality::never);
  loop.run(25 * kMillisecond);
  EXPECT_TRUE(loop.bit("SA0"));
  EXPECT_FALSE(loop.bit("SA1"));
  EXPECT_TRUE(loop.bit("SA2"));
  EXPECT_EQ(loop.number("SK0.RE"), 100.0);
  EXPECT_EQ(loop.number("SK3.RE"), 4095.0);
  EXPECT_EQ(loop.source().quality, Quality::good);
  EXPECT_EQ(loop.source().errors, 0u);
}

TEST(MockModbusLine, takes_the_time_that_the_characters_take) {
  MockModbusLine line({}, example_map(), {StationSettings{}});
  const modbus::Block& inputs = line.map().blocks[0];
  // 8 characters out, 7 back at 115200 baud and 11 bit, 2 ms of thinking, 1.75 ms of silence.
  EXPECT_EQ(line.transaction_ns(inputs, 2 * kMillisecond),
            8 * 11 * kSecond / 115200 + 7 * 11 * kSecond / 115200 + 3'750'000);
  EXPECT_GT(line.planned_load(), 0.9);
  EXPECT_LT(line.planned_load(), 1.2);
  LineSettings tcp;
  tcp.baud = 0;
  tcp.latency_ns = 500'000;
  EXPECT_EQ(MockModbusLine(tcp, example_map(), {StationSettings{}}).transaction_ns(inputs, 0), 500'000);
}

TEST(MockModbusLine, never_delivers_an_input_before_its_transaction_can_be_over) {
  LineSettings settings;
  settings.baud = 9600;
  MockModbusLine line(settings, {{{1, Function::read_discrete_inputs, 0, 16}}, {example_map().points[0]}},
                      {StationSettings{}});
  line.station(0).set_input(0, true);
  const Nanoseconds needed = line.transaction_ns(line.map().blocks[0], StationSettings{}.answer_delay_ns);
  Loop loop(line);
  loop.run(needed / kMillisecond * kMillisecond);
  EXPECT_FALSE(loop.bit("SA0"));
  loop.run(2 * kMillisecond);
  EXPECT_TRUE(loop.bit("SA0"));
  EXPECT_NEAR(static_cast<double>(loop.source().updated_ns), static_cast<double>(needed), 1000.0);
}

TEST(MockModbusLine, sends_a_changed_output_at_once_and_an_unchanged_one_at_its_period) {
  LineSettings tcp;
  tcp.baud = 0;
  modbus::Map map = example_map();
  for (auto& block : map.blocks) block.period_ns = 200 * kMillisecond;
  MockModbusLine line(tcp, map, {StationSettings{}});
  Loop loop(line);
  loop.run(50 * kMillisecond);
  const auto before = line.transactions();
  loop.image.packets.set_bit(place("SA69"), true);
  loop.image.packets.set_number(place("SK9.RE"), 1234.0);
  loop.run(8 * kMillisecond);
  EXPECT_TRUE(line.station(0).output(5));
  EXPECT_EQ(line.station(0).analog_output(1), 1234);
  EXPECT_EQ(line.transactions(), before + 2);
  loop.run(kSecond);
  EXPECT_NEAR(static_cast<double>(line.transactions() - before), 2 + 5 * 4, 4);
}

TEST(MockModbusLine, a_loop_back_wire_answers_after_its_delay) {
  MockModbusLine line({}, example_map(), {StationSettings{}});
  line.station(0).add_loopback({3, 7, 40 * kMillisecond, false});
  line.station(0).add_loopback({3, 8, 0, true});
  Loop loop(line);
  loop.run(60 * kMillisecond);
  EXPECT_FALSE(loop.bit("SA7"));
  EXPECT_TRUE(loop.bit("SA8"));
  loop.image.packets.set_bit(place("SA67"), true);
  loop.run(35 * kMillisecond);
  EXPECT_FALSE(loop.bit("SA7"));
  loop.run(60 * kMillisecond);
  EXPECT_TRUE(loop.bit("SA7"));
  EXPECT_FALSE(loop.bit("SA8"));
}

TEST(MockModbusLine, a_silent_station_turns_stale_then_bad_and_its_points_take_their_loss_values) {
  modbus::Map map = example_map();
  map.points[0].rule.hold = false;  // SA0 falls to 0, SA1 holds
  LineSettings settings;
  settings.answer_timeout_ns = 30 * kMillisecond;
  MockModbusLine line(settings, map, {StationSettings{}});
  line.station(0).set_input(0, true);
  line.station(0).set_input(1, true);
  Loop loop(line);
  loop.run(100 * kMillisecond);
  ASSERT_EQ(loop.source().quality, Quality::good);
  const Nanoseconds last = loop.source().updated_ns;
  line.station(0).inject({.kind = fault::Kind::silent});
  loop.run(80 * kMillisecond);
  EXPECT_EQ(loop.source().quality, Quality::stale);
  EXPECT_TRUE(loop.bit("SA0"));
  loop.run(80 * kMillisecond);
  EXPECT_EQ(loop.source().quality, Quality::bad);
  EXPECT_FALSE(loop.bit("SA0"));
  EXPECT_TRUE(loop.bit("SA1"));
  EXPECT_LE(loop.source().updated_ns, last + 20 * kMillisecond);
  EXPECT_GE(loop.source().errors, 2u);
  line.station(0).clear_fault();
  loop.run(700 * kMillisecond);
  EXPECT_EQ(loop.source().quality, Quality::good);
  EXPECT_TRUE(loop.bit("SA0"));
}

TEST(MockModbusLine, an_exception_is_counted_and_kept_by_its_code) {
  MockModbusLine line({}, example_map(), {StationSettings{}});
  Loop loop(line);
  loop.run(50 * kMillisecond);
  line.station(0).inject({.kind = fault::Kind::exception, .exception = 6});
  loop.run(300 * kMillisecond);
  EXPECT_EQ(line.last_exception(0), modbus::Exception::server_device_busy);
  EXPECT_GT(line.errors(0), 5u);
  EXPECT_EQ(loop.source().quality, Quality::bad);
}

TEST(MockModbusLine, a_request_past_the_end_of_the_station_is_refused_by_address) {
  StationSettings small;
  small.digital_inputs = 8;
  MockModbusLine line({}, example_map(), {small});
  Loop loop(line);
  loop.run(200 * kMillisecond);
  EXPECT_EQ(line.last_exception(0), modbus::Exception::illegal_data_address);
}

TEST(MockModbusLine, a_slow_answer_within_patience_arrives_and_one_beyond_it_is_thrown_away) {
  LineSettings settings;
  settings.answer_timeout_ns = 50 * kMillisecond;
  settings.stale_after_periods = 20;
  MockModbusLine line(settings, example_map(), {StationSettings{}});
  Loop loop(line);
  line.station(0).set_input(2, true);
  line.station(0).inject({.kind = fault::Kind::slow, .delay_ns = 40 * kMillisecond});
  loop.run(40 * kMillisecond);
  EXPECT_FALSE(loop.bit("SA2"));
  loop.run(200 * kMillisecond);
  EXPECT_TRUE(loop.bit("SA2"));
  EXPECT_EQ(line.errors(0), 0u);
  line.station(0).inject({.kind = fault::Kind::slow, .delay_ns = 60 * kMillisecond});
  line.station(0).set_input(2, false);
  loop.run(300 * kMillisecond);
  EXPECT_TRUE(loop.bit("SA2"));
  EXPECT_GT(line.errors(0), 0u);
}

TEST(MockModbusLine, a_garbled_answer_is_repeated_before_it_counts_as_lost) {
  MockModbusLine line({}, example_map(), {StationSettings{}});
  Loop loop(line);
  loop.run(40 * kMillisecond);
  line.station(0).inject({.kind = fault::Kind::corrupt});
  loop.run(4 * kMillisecond);
  line.station(0).clear_fault();
  loop.run(100 * kMillisecond);
  EXPECT_GE(line.errors(0), 1u);
  EXPECT_EQ(loop.source().quality, Quality::good);
}

TEST(MockModbusLine, a_dead_station_does_not_slow_its_neighbour) {
  modbus::Map map = example_map(1);
  modbus::Map second = example_map(2);
  for (auto& p : second.points) {
    p.block += 4;
    p.rule.place = image::at(p.rule.place, p.rule.place.packet == image::Packet::a ? 32 : 128);
    map.points.push_back(p);
  }
  map.blocks.insert(map.blocks.end(), second.blocks.begin(), second.blocks.end());
  ASSERT_TRUE(check(map, image::Packets{}).empty());
  StationSettings two;
  two.unit = 2;
  LineSettings settings;
  settings.baud = 1'000'000;
  settings.answer_timeout_ns = 20 * kMillisecond;
  settings.poll.retries = 0;
  StationSettings one;
  one.answer_delay_ns = two.answer_delay_ns = 200'000;
  MockModbusLine line(settings, map, {one, two}, {4, 5});
  line.station(0).inject({.kind = fault::Kind::silent});
  Loop loop(line);
  int good = 0;
  loop.run(200 * kMillisecond);
  for (int i = 0; i < 1000; ++i) {
    loop.run(kMillisecond);
    good += loop.source(5).quality == Quality::good;
  }
  EXPECT_EQ(loop.source(4).quality, Quality::bad);
  EXPECT_EQ(good, 1000);
}

TEST(MockModbusLine, a_block_without_a_station_is_refused_by_its_unit) {
  try {
    MockModbusLine line({}, example_map(9), {StationSettings{}});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "a block names Modbus unit 9, which no station has");
  }
}

TEST(MockModbusLine, the_watchdog_of_a_station_drops_its_outputs_when_nobody_asks) {
  StationSettings station;
  station.watchdog_ns = 200 * kMillisecond;
  ModbusStation s(station);
  modbus::Request write{Function::write_single_coil, 2, 1, {}};
  write.data.set_bit(0, true);
  modbus::Pdu request, answer;
  ASSERT_TRUE(encode(write, request));
  ASSERT_TRUE(s.serve(10 * kMillisecond, request, answer));
  s.advance_to(210 * kMillisecond);
  EXPECT_TRUE(s.output(2));
  s.advance_to(211 * kMillisecond);
  EXPECT_FALSE(s.output(2));
}

/// What a station answers to a request of so many items at an address.
modbus::Response asked(ModbusStation& station, Function function, std::uint16_t address,
                       std::uint16_t count) {
  modbus::Request request{function, address, count, {}};
  if (modbus::writes(function)) request.data.set_bit(0, true), request.data.words[0] = 777;
  modbus::Pdu question, answer;
  modbus::Response response;
  EXPECT_TRUE(encode(request, question));
  EXPECT_TRUE(station.serve(kMillisecond, question, answer));
  EXPECT_EQ(decode_response(answer.view(), request, response), modbus::AnswerFault::none);
  return response;
}

TEST(ModbusStation, lives_at_its_addresses_and_has_nothing_outside_them) {
  using modbus::Exception;
  StationSettings settings;
  settings.digital_inputs_at = 1000, settings.digital_outputs_at = 2000;
  settings.analog_inputs_at = 3000, settings.analog_outputs_at = 4000;
  settings.initial_inputs = {false, true};
  settings.initial_analog = {11, 12, 13, 14};
  ModbusStation s(settings);
  const struct {
    Function function;
    std::uint16_t first, count;
  } spaces[] = {{Function::read_discrete_inputs, 1000, 16},  {Function::read_coils, 2000, 16},
                {Function::write_multiple_coils, 2000, 16},  {Function::read_input_registers, 3000, 4},
                {Function::read_holding_registers, 4000, 2}, {Function::write_multiple_registers, 4000, 2}};
  for (const auto& space : spaces) {
    EXPECT_EQ(asked(s, space.function, space.first, space.count).exception, Exception::none) << space.first;
    for (const int address : {0, space.first - 1, space.first + 1})
      EXPECT_EQ(asked(s, space.function, static_cast<std::uint16_t>(address), space.count).exception,
                Exception::illegal_data_address)
          << address;
  }
  EXPECT_TRUE(asked(s, Function::read_discrete_inputs, 1001, 1).data.bit(0));
  EXPECT_EQ(asked(s, Function::read_input_registers, 3003, 1).data.words[0], 14);
  EXPECT_TRUE(s.output(0)) << "the channels of the station itself count from 0";
  EXPECT_EQ(s.analog_output(0), 777);
}

TEST(ModbusStation, packs_its_digital_inputs_into_registers_beside_the_analog_ones) {
  using modbus::Exception;
  StationSettings settings;
  settings.inputs_in_registers = true;
  settings.digital_inputs = 20;
  settings.digital_inputs_at = 8;
  settings.analog_inputs_at = 10;
  settings.initial_analog = {500};
  ModbusStation s(settings);
  for (const std::uint16_t on : {0, 15, 16, 19}) s.set_input(on, true);
  const modbus::Response all = asked(s, Function::read_input_registers, 8, 6);
  EXPECT_EQ(all.exception, Exception::none);
  EXPECT_EQ(all.data.words[0], 0x8001);
  EXPECT_EQ(all.data.words[1], 0x0009);
  EXPECT_EQ(all.data.words[2], 500);
  EXPECT_EQ(asked(s, Function::read_input_registers, 7, 1).exception, Exception::illegal_data_address);
  EXPECT_EQ(asked(s, Function::read_input_registers, 8, 7).exception, Exception::illegal_data_address);
  EXPECT_EQ(asked(s, Function::read_discrete_inputs, 8, 1).exception, Exception::illegal_data_address);
}

TEST(ModbusStation, puts_lost_outputs_where_each_of_them_is_to_be) {
  StationSettings settings;
  settings.watchdog_ns = 200 * kMillisecond;
  settings.coil_loss = {{false, 1}, {true, 0}};
  settings.holding_loss = {{false, 42}, {true, 0}};
  ModbusStation s(settings);
  modbus::Request write{Function::write_multiple_coils, 0, 3, {}};
  for (std::size_t n = 1; n < 3; ++n) write.data.set_bit(n, true);
  modbus::Pdu request, answer;
  ASSERT_TRUE(encode(write, request));
  ASSERT_TRUE(s.serve(10 * kMillisecond, request, answer));
  modbus::Request words{Function::write_multiple_registers, 0, 2, {}};
  words.data.words = {300, 400};
  ASSERT_TRUE(encode(words, request));
  ASSERT_TRUE(s.serve(10 * kMillisecond, request, answer));
  s.advance_to(211 * kMillisecond);
  EXPECT_TRUE(s.output(0)) << "its loss value is on";
  EXPECT_TRUE(s.output(1)) << "it is to hold";
  EXPECT_FALSE(s.output(2)) << "off, as nothing was said";
  EXPECT_EQ(s.analog_output(0), 42);
  EXPECT_EQ(s.analog_output(1), 400);
}

TEST(MockModbusLine, every_output_pattern_comes_back_through_its_wires) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  LineSettings settings;
  settings.baud = 57600;
  MockModbusLine line(settings, example_map(), {StationSettings{}});
  std::uint64_t inverted = random();
  for (std::uint16_t n = 0; n < 16; ++n)
    line.station(0).add_loopback({n, static_cast<std::uint16_t>(15 - n),
                                  static_cast<Nanoseconds>(random() % 30'000'000), (inverted >> n & 1) != 0});
  Loop loop(line);
  for (int i = 0; i < 200; ++i) {
    const std::uint64_t pattern = random();
    for (int n = 0; n < 16; ++n)
      loop.image.packets.set_bit(place("SA" + std::to_string(64 + n)), (pattern >> n & 1) != 0);
    loop.run(120 * kMillisecond);
    for (int n = 0; n < 16; ++n)
      ASSERT_EQ(loop.bit("SA" + std::to_string(15 - n)), (pattern >> n & 1) != (inverted >> n & 1))
          << "output " << n;
  }
  EXPECT_EQ(line.errors(0), 0u);
}

}  // namespace
}  // namespace servogate::mock
