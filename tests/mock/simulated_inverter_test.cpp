// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/modbus/simulated_inverter.hpp"

#include <gtest/gtest.h>

#include "drivers/mock/modbus/station.hpp"

namespace servogate::mock {
namespace {

using image::kMillisecond;
using image::kSecond;
using modbus::Exception;
using modbus::Function;

/// 100 Hz a second, at most 60 Hz; registers as a Delta's.
SimulatedInverterSettings delta() {
  SimulatedInverterSettings s;
  s.registers.command = 0x2000;
  s.registers.frequency = 0x2001;
  s.registers.forward = 0x12;
  s.registers.reverse = 0x22;
  s.registers.stop = 0x01;
  s.registers.reset_address = 0x2002;
  s.registers.reset = 2;
  s.registers.status = 0x2101;
  s.registers.running = {3, 3};
  s.registers.reversed = {0x18, 0x18};
  s.registers.at_speed = {0x100, 0x100};
  s.registers.output = 0x2103;
  s.registers.fault = 0x2100;
  s.registers.required = {{0x0903, 1, 20}};
  s.max_hz = 60.0;
  s.silence_trip = 58;
  return s;
}

class Bench {
 public:
  Bench() {
    StationSettings s;
    s.inverter = delta();
    s.watchdog_ns = kSecond;
    station.emplace(s);
  }
  modbus::Response ask(Function function, std::uint16_t address, std::uint16_t count,
                       std::uint16_t value = 0) {
    modbus::Request request;
    request.function = function;
    request.address = address;
    request.count = count;
    request.data.words[0] = value;
    modbus::Pdu pdu, answer;
    EXPECT_TRUE(encode(request, pdu));
    modbus::Response response;
    if (station->serve(t, pdu, answer)) {
      EXPECT_EQ(decode_response(answer.view(), request, response), modbus::AnswerFault::none);
    }
    return response;
  }
  void write(std::uint16_t address, std::uint16_t value) {
    EXPECT_EQ(ask(Function::write_single_register, address, 1, value).exception, Exception::none);
  }
  std::uint16_t word(std::uint16_t address) {
    return ask(Function::read_holding_registers, address, 1).data.words[0];
  }
  /// Milliseconds in which it is asked all the time.
  void run(int ms) {
    for (int n = 0; n < ms; ++n) {
      t += kMillisecond;
      station->advance_to(t);
      if (n % 100 == 0) word(0x2101);
    }
  }
  std::optional<ModbusStation> station;
  image::Nanoseconds t = 0;
};

TEST(SimulatedInverter, runs_up_on_its_ramp_is_at_speed_and_comes_down_when_it_is_stopped) {
  Bench bench;
  bench.write(0x2001, 5000);
  bench.run(100);
  EXPECT_EQ(bench.word(0x2103), 0) << "no command";
  bench.write(0x2000, 0x12);
  bench.run(250);
  EXPECT_NEAR(bench.word(0x2103), 2500, 20);
  EXPECT_EQ(bench.word(0x2101), 0x03) << "runs, forward, not yet at speed";
  bench.run(300);
  EXPECT_EQ(bench.word(0x2103), 5000);
  EXPECT_EQ(bench.word(0x2101), 0x103);
  bench.write(0x2000, 0x01);
  bench.run(250);
  EXPECT_NEAR(bench.word(0x2103), 2500, 20);
  bench.run(300);
  EXPECT_EQ(bench.word(0x2101), 0x00);
}

TEST(SimulatedInverter, reverses_through_standstill_and_cuts_a_frequency_that_is_too_high) {
  Bench bench;
  bench.write(0x2001, 9000);
  bench.write(0x2000, 0x12);
  bench.run(1000);
  EXPECT_EQ(bench.word(0x2103), 6000);
  bench.write(0x2000, 0x22);
  bench.run(600);
  EXPECT_NEAR(bench.station->inverter()->output_hz(), 0.0, 1.0);
  bench.run(700);
  EXPECT_NEAR(bench.station->inverter()->output_hz(), -60.0, 0.01);
  EXPECT_EQ(bench.word(0x2101) & 0x18, 0x18);
}

TEST(SimulatedInverter, trips_to_a_coasting_motor_and_runs_again_only_after_a_reset_and_a_new_command) {
  Bench bench;
  bench.write(0x2001, 5000);
  bench.write(0x2000, 0x12);
  bench.run(800);
  EXPECT_TRUE(bench.station->inject({.kind = fault::Kind::trip, .error_code = 1}));
  bench.run(1);
  EXPECT_EQ(bench.word(0x2100), 1);
  EXPECT_EQ(bench.word(0x2103), 0);
  EXPECT_GT(bench.station->inverter()->motor_hz(), 49.0) << "it coasts";
  bench.write(0x2000, 0x12);
  bench.run(300);
  EXPECT_EQ(bench.word(0x2103), 0);
  bench.write(0x2002, 2);
  bench.write(0x2002, 0);
  EXPECT_EQ(bench.word(0x2100), 0);
  bench.run(300);
  EXPECT_EQ(bench.word(0x2103), 0) << "the old command counts no more";
  bench.write(0x2000, 0x12);
  bench.run(300);
  EXPECT_GT(bench.word(0x2103), 2000);
}

TEST(SimulatedInverter, that_nobody_asks_any_more_trips_by_its_watchdog_and_stands) {
  Bench bench;
  bench.write(0x2001, 5000);
  bench.write(0x2000, 0x12);
  bench.run(800);
  bench.t += 1500 * kMillisecond;
  bench.station->advance_to(bench.t);
  EXPECT_EQ(bench.station->inverter()->tripped(), 58);
  EXPECT_FALSE(bench.station->inverter()->runs());
}

TEST(SimulatedInverter, has_the_registers_of_its_manual_and_no_others) {
  Bench bench;
  EXPECT_EQ(bench.ask(Function::read_holding_registers, 0x2100, 4).exception, Exception::none)
      << "a hole is 0";
  EXPECT_EQ(bench.ask(Function::read_holding_registers, 0x2104, 1).exception,
            Exception::illegal_data_address);
  EXPECT_EQ(bench.ask(Function::write_single_register, 0x2101, 1, 1).exception,
            Exception::illegal_data_address);
  EXPECT_EQ(bench.ask(Function::read_discrete_inputs, 0, 1).exception, Exception::illegal_function);
  EXPECT_EQ(bench.word(0x0903), 1) << "a parameter";
  bench.station->inverter()->set_register(0x0903, 0);
  EXPECT_EQ(bench.word(0x0903), 0);
  ModbusStation none{StationSettings{}};
  EXPECT_FALSE(none.inject({.kind = fault::Kind::trip})) << "no inverter";
}

}  // namespace
}  // namespace servogate::mock
