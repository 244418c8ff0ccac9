// SPDX-License-Identifier: Apache-2.0
// A Modbus RTU line against units on a pseudo terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/modbus_line/rig/cycles.hpp"

namespace servogate::modbus_line {
namespace {

using image::kMillisecond;
using image::Quality;
using modbus::Heard;

constexpr std::uint8_t kReadInputs = 2;

TEST(ModbusRtu, brings_inputs_into_the_image_and_outputs_to_the_units) {
  Units units(Units::Wire::rtu, {1, 17});
  units.with(17, [](mock::ModbusStation& s) {
    s.set_input(3, true);
    s.set_analog_input(2, 4711);
  });
  Cycles cycles(rtu(units.device()), {1, 17}, 50 * kMillisecond);
  cycles.set_coil(0, 5, true);
  cycles.set_coil(1, 6, true);
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(1); }));
  EXPECT_TRUE(cycles.until([&] { return cycles.input(1, 3) && cycles.analog(1, 2) == 4711; }));
  EXPECT_TRUE(cycles.until([&] { return units.output(1, 5) && units.output(17, 6); }));
  EXPECT_FALSE(cycles.input(0, 3));
  EXPECT_EQ(cycles.counters().openings, 1u);
}

TEST(ModbusRtu, a_wrong_checksum_is_no_answer_and_the_device_is_opened_anew) {
  Units units(Units::Wire::rtu);
  int left = 3;
  units.bend([&](const Asked& asked, const Bytes& good) {
    Reply reply{units.frame(asked, good)};
    if (asked.function() == kReadInputs && left > 0) {
      --left;
      reply.bytes = units.frame(asked, {kReadInputs, 2, 0xFF, 0xFF});
      reply.bytes.back() ^= 1;
    }
    return reply;
  });
  Cycles cycles(rtu(units.device()), {1}, 50 * kMillisecond);
  cycles.watch = [&] { EXPECT_FALSE(cycles.input(0, 0)); };
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().of(Heard::malformed) == 3; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0); }));
  EXPECT_GE(cycles.counters().openings, 4u);
}

TEST(ModbusRtu, an_answer_of_another_unit_is_not_taken) {
  Units units(Units::Wire::rtu, {1, 2});
  bool done = false;
  units.bend([&](const Asked& asked, const Bytes& good) {
    Asked other = asked;
    if (asked.unit == 1 && asked.function() == kReadInputs && !done) {
      done = true;
      other.unit = 2;
      return Reply{units.frame(other, {kReadInputs, 2, 0xFF, 0xFF})};
    }
    return Reply{units.frame(asked, good)};
  });
  Cycles cycles(rtu(units.device()), {1, 2}, 50 * kMillisecond);
  cycles.watch = [&] {
    EXPECT_FALSE(cycles.input(0, 0));
    EXPECT_FALSE(cycles.input(1, 0));
  };
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(1); }));
  EXPECT_EQ(cycles.counters().of(Heard::wrong_unit), 1u);
}

TEST(ModbusRtu, a_late_answer_is_never_taken_for_that_of_a_neighbour_or_of_another_block) {
  // Two blocks of a unit whose answers look the same, and a neighbour. One unit answers too late, again and
  // again; the registers of every place have values of their own.
  Units units(Units::Wire::rtu, {1, 2});
  units.bend([&](const Asked& asked, const Bytes& good) {
    Reply reply{units.frame(asked, good)};
    if (asked.unit == 1 && asked.pdu[2] == 0) reply.delay_ns = 2 * kShort;
    return reply;
  });
  for (const std::uint8_t u : {1, 2})
    units.with(u, [u](mock::ModbusStation& s) {
      for (std::uint16_t n = 0; n < 4; ++n) s.set_analog_input(n, static_cast<std::uint16_t>(100 * u + n));
    });
  modbus::Map map;
  const auto period = 5 * kMillisecond;
  for (const auto& [unit, address] : {std::pair{1, 0}, {1, 2}, {2, 0}, {2, 2}}) {
    modbus::Point p;
    p.block = map.blocks.size();
    p.rule.place = {image::Packet::a, image::Format::in, static_cast<std::uint32_t>(map.points.size()), 1};
    map.blocks.push_back({static_cast<std::uint8_t>(unit), modbus::Function::read_input_registers,
                          static_cast<std::uint16_t>(address), 2, period});
    map.points.push_back(p);
  }
  drivers::Notice why;
  auto settings = rtu(units.device(), kShort);
  settings.poll.lost_retry_ns = kMillisecond;
  const auto line = modbus::ModbusLine::open(settings, map, {{1, 0}, {2, 1}}, why);
  ASSERT_NE(line, nullptr) << why.str(text::Language::english);
  auto image = std::make_unique<image::ProcessImage>();
  image::Notices notices;
  const double own[] = {100, 102, 200, 202};
  int seen[4] = {};
  for (std::int64_t n = 0; n < 3000 || line->counters().of(Heard::silence) < 3 || seen[2] + seen[3] == 0;
       ++n) {
    image->now = {n, n * kMillisecond, kMillisecond};
    line->receive(*image, notices);
    line->send(*image);
    for (std::size_t i = 0; i < 4; ++i) {
      const double is = image->packets.number(map.points[i].rule.place);
      ASSERT_TRUE(is == 0.0 || is == own[i]) << "block " << i << " has " << is;
      seen[i] += is != 0.0 ? 1 : 0;
    }
    usleep(1000);
  }
}

TEST(ModbusRtu, a_dead_unit_does_not_slow_its_neighbours) {
  Units units(Units::Wire::rtu, {1, 3});
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  Cycles cycles(rtu(units.device(), kShort), {1, 2, 3}, 20 * kMillisecond);
  EXPECT_TRUE(cycles.until([&] { return units.asked_of(1) > 200 && units.asked_of(3) > 200; }));
  const std::size_t asked = units.asked_of(2);  // before the time is taken
  const double took = static_cast<double>(drivers::clock_ns(CLOCK_MONOTONIC) - start) * 1e-9;
  EXPECT_LE(asked, 2 + static_cast<std::size_t>(took / 0.5) + 1);
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(1) == Quality::bad; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(2); }));
}

std::string refusal(const modbus::LineSettings& settings) {
  drivers::Notice why;
  EXPECT_EQ(modbus::ModbusLine::open(settings, map_of({1}), {{1, 0}}, why), nullptr);
  return std::string(why.entry != nullptr ? why.entry->id : "") + ": " + why.str(text::Language::english);
}

TEST(ModbusRtu, a_device_that_cannot_be_used_is_refused_with_what_mends_it) {
  EXPECT_NE(refusal(rtu("/dev/no-such-line")).find("modbus.no-device"), std::string::npos);
  EXPECT_NE(refusal(rtu("/dev/no-such-line")).find("plugged in"), std::string::npos);
  const Units units(Units::Wire::rtu);
  auto odd = rtu(units.device());
  std::get<modbus::SerialPort>(odd.link.peer).baud = 12'345;
  EXPECT_NE(refusal(odd).find("modbus.no-rate"), std::string::npos);
  const int fd = open(units.device().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(flock(fd, LOCK_EX | LOCK_NB), 0);
  EXPECT_NE(refusal(rtu(units.device())).find("modbus.busy"), std::string::npos);
  close(fd);
  drivers::Notice why;
  const auto line = modbus::ModbusLine::open(rtu(units.device()), map_of({1}), {{1, 0}}, why);
  ASSERT_NE(line, nullptr) << why.str(text::Language::english);
  const std::string second = refusal(rtu(units.device()));
  EXPECT_NE(second.find("modbus.busy"), std::string::npos) << "one master a line: " << second;
  if (getuid() == 0) return;  // whom nothing is denied
  const Units denied(Units::Wire::rtu);
  ASSERT_EQ(chmod(denied.device().c_str(), 0), 0);
  EXPECT_NE(refusal(rtu(denied.device())).find("dialout"), std::string::npos);
}

}  // namespace
}  // namespace servogate::modbus_line
