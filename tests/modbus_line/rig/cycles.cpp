// SPDX-License-Identifier: Apache-2.0
#include "tests/modbus_line/rig/cycles.hpp"

#include <gtest/gtest.h>

#include "tests/comes.hpp"

namespace servogate::modbus_line {

namespace {

using image::Place;

Place bit(std::size_t unit, int n) {
  return {image::Packet::a, image::Format::bl, static_cast<std::uint32_t>(32 * unit + n), 1};
}
Place word(std::size_t unit, int n) {
  return {image::Packet::a, image::Format::in, static_cast<std::uint32_t>(128 + 6 * unit + n), 1};
}

}  // namespace

modbus::Map map_of(const std::vector<std::uint8_t>& units, image::Nanoseconds period) {
  using modbus::Function;
  modbus::Map map;
  for (std::size_t u = 0; u < units.size(); ++u) {
    const std::size_t first = map.blocks.size();
    map.blocks.push_back({units[u], Function::read_discrete_inputs, 0, 16, period});
    map.blocks.push_back({units[u], Function::write_multiple_coils, 0, 16, period});
    map.blocks.push_back({units[u], Function::read_input_registers, 0, 4, period});
    map.blocks.push_back({units[u], Function::write_multiple_registers, 0, 2, period});
    const auto add = [&](std::size_t block, int n, const Place& place) {
      modbus::Point p;
      p.block = first + block;
      p.offset = static_cast<std::uint16_t>(n);
      p.rule.place = place;
      p.rule.hold = block == 1 && n == 15;
      map.points.push_back(p);
    };
    for (int n = 0; n < 16; ++n) add(0, n, bit(u, n));
    for (int n = 0; n < 16; ++n) add(1, n, bit(u, 16 + n));
    for (int n = 0; n < 4; ++n) add(2, n, word(u, n));
    for (int n = 0; n < 2; ++n) add(3, n, word(u, 4 + n));
  }
  return map;
}

modbus::LineSettings tcp(const Units& units, image::Nanoseconds timeout) {
  modbus::LineSettings settings;
  settings.link.peer = modbus::TcpAddress{"127.0.0.1", units.port()};
  settings.link.answer_timeout_ns = timeout;
  return settings;
}

modbus::LineSettings rtu(const std::string& device, image::Nanoseconds timeout) {
  modbus::LineSettings settings;
  settings.link.peer =
      modbus::SerialPort{device, 115'200, modbus::Parity::none, 2};  // pseudo terminals have no parity
  settings.link.answer_timeout_ns = timeout;
  return settings;
}

Cycles::Cycles(const modbus::LineSettings& settings, const std::vector<std::uint8_t>& units,
               image::Nanoseconds period) {
  std::vector<modbus::Unit> sources;
  for (std::size_t u = 0; u < units.size(); ++u)
    sources.push_back({units[u], u < image::kMaxSources ? static_cast<int>(u) : -1});
  drivers::Notice why;
  line_ = modbus::ModbusLine::open(settings, map_of(units, period), sources, why);
  EXPECT_NE(line_, nullptr) << why.str(text::Language::english);
  image_->now.number = -1;
}

Cycles::~Cycles() = default;

void Cycles::step() {
  image::CycleTime& now = image_->now;
  now = {now.number + 1, (now.number + 1) * image::kMillisecond, image::kMillisecond};
  line_->receive(*image_, notices_);
  line_->send(*image_);
  if (watch) watch();
}

bool Cycles::until(const std::function<bool()>& met) {
  return tests::comes(
      [&] {
        step();
        return met();
      },
      std::chrono::milliseconds(1));
}

bool Cycles::input(std::size_t unit, int n) const { return image_->packets.bit(bit(unit, n)); }
double Cycles::analog(std::size_t unit, int n) const { return image_->packets.number(word(unit, n)); }
void Cycles::set_coil(std::size_t unit, int n, bool on) { image_->packets.set_bit(bit(unit, 16 + n), on); }
void Cycles::set_analog(std::size_t unit, int n, double value) {
  image_->packets.set_number(word(unit, 4 + n), value);
}

}  // namespace servogate::modbus_line
