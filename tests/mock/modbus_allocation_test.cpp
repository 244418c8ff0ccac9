// SPDX-License-Identifier: Apache-2.0
// receive() and send() of the simulated I/O run inside the cycle and may not allocate.
#include <gtest/gtest.h>

#include <memory>

#include "drivers/mock/gpio/mock_gpio.hpp"
#include "drivers/mock/modbus/modbus_line.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::mock {
namespace {

TEST(SimulatedIo, receives_and_sends_without_allocating) {
  modbus::Map map;
  map.blocks = {{1, modbus::Function::read_discrete_inputs, 0, 16},
                {1, modbus::Function::write_multiple_coils, 0, 16}};
  for (std::uint16_t n = 0; n < 16; ++n) {
    modbus::Point in, out;
    in.offset = out.offset = n;
    in.rule.place = {image::Packet::a, image::Format::bl, n, 1};
    out.block = 1;
    out.rule.place = {image::Packet::a, image::Format::bl, 64u + n, 1};
    map.points.insert(map.points.end(), {in, out});
  }
  MockModbusLine line({}, map, {StationSettings{}});
  image::PointRule home, lamp;
  home.place = {image::Packet::a, image::Format::bl, 200, 1};
  lamp.place = {image::Packet::a, image::Format::bl, 201, 1};
  MockGpio chip({{"home", HomeSwitch{0, 1.0, 2.0}, home, {}}}, {{"lamp", lamp}}, [](int) { return 1.5; });
  auto image = std::make_unique<image::ProcessImage>();
  image::Notices notices;
  std::uint64_t inside = 0;
  for (std::int64_t n = 0; n < 2000; ++n) {
    image->now = {n, n * image::kMillisecond, image::kMillisecond};
    line.advance_to(image->now.t_ns);
    chip.advance_to(image->now.t_ns);
    const counting::Tally tally(inside);
    line.receive(*image, notices);
    chip.receive(*image, notices);
    image->packets.set_bit(map.points[1].rule.place, n / 100 % 2 == 1);
    line.send(*image);
    chip.send(*image);
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_GT(counting::allocations(), 0u) << "the counter itself works";
  EXPECT_GT(line.transactions(), 100u);
}

}  // namespace
}  // namespace servogate::mock
