// SPDX-License-Identifier: Apache-2.0
// The master against the simulated CiA 401 module of drivers/mock, on a simulated wire.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "firmware_if/canopen/302/boot_plan.hpp"
#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/master/segment.hpp"
#include "tests/counting/allocations.hpp"

namespace servogate::canopen {
namespace {

image::Place at(const char* text) { return *image::parse_place(text); }

IoPoint digital(bool input, int number, const char* place) {
  IoPoint p;
  p.rule.input = input;
  p.index = input ? io::kReadInput8 : io::kWriteOutput8;
  p.subindex = static_cast<std::uint8_t>(number / 8 + 1);
  p.bit = static_cast<std::int8_t>(number % 8);
  p.rule.place = at(place);
  return p;
}

IoPoint analogue(bool input, int number, const char* place) {
  IoPoint p;
  p.rule.input = input;
  p.rule.digital = false;
  p.index = input ? io::kReadAnalogueInput16 : io::kWriteAnalogueOutput16;
  p.subindex = static_cast<std::uint8_t>(number + 1);
  p.rule.place = at(place);
  return p;
}

PdoWanted pdo(std::initializer_list<MappingEntry> entries, std::uint8_t type) {
  PdoWanted wanted;
  for (const MappingEntry& entry : entries) wanted.mapping.add(entry);
  wanted.transmission_type = type;
  return wanted;
}

/// 16 lines and two channels each way; digital inputs with every SYNC, analogue ones with every tenth.
NodeConfig module_node() {
  NodeConfig node;
  node.node = 5;
  node.name = "terminals";
  node.target = DriveTarget::io;
  node.target_index = 3;
  node.profile.device_type = io::kDeviceProfile;
  node.profile.tpdo[0] = pdo({{io::kReadInput8, 1, 8}, {io::kReadInput8, 2, 8}}, 1);
  node.profile.tpdo[1] = pdo({{io::kReadAnalogueInput16, 1, 16}, {io::kReadAnalogueInput16, 2, 16}}, 10);
  node.profile.rpdo[0] = pdo({{io::kWriteOutput8, 1, 8}, {io::kWriteOutput8, 2, 8}}, 255);
  node.profile.rpdo[1] = pdo({{io::kWriteAnalogueOutput16, 1, 16}, {io::kWriteAnalogueOutput16, 2, 16}}, 255);
  return node;
}

struct Bench {
  explicit Bench(std::vector<IoPoint> points) {
    config.nodes.push_back(module_node());
    config.nodes[0].io.points = std::move(points);
  }
  void start() {
    mock::SimulatedIoConfig c;
    c.node_id = 5;
    c.terminals = {16, 16, 2, 2};
    module = std::make_unique<mock::SimulatedIoModule>(c);
    wire.attach(*module, "terminals");
    segment = std::make_unique<Segment>(bus, config);
    image->now.period_ns = config.cycle_ns;
  }
  void step() {
    wire.advance_to(image->now.t_ns);
    segment->open_cycle(*image);
    segment->receive(*image);
    segment->send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    BusEvent e;
    while (segment->events().pop(e)) events.push_back(e);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  bool boot() {
    for (int i = 0; i < 3000 && !image->segments[0].operational; ++i) step();
    return image->segments[0].operational;
  }
  int count(BusEventKind kind) const {
    return static_cast<int>(std::ranges::count(events, kind, &BusEvent::kind));
  }
  bool bit(const char* place) const { return image->packets.bit(at(place)); }
  double number(const char* place) const { return image->packets.number(at(place)); }

  mock::CanSegment wire{{}};
  image::CanBus& bus = wire.add_endpoint("master");
  SegmentConfig config;
  std::unique_ptr<mock::SimulatedIoModule> module;
  std::unique_ptr<Segment> segment;
  std::unique_ptr<image::ProcessImage> image = std::make_unique<image::ProcessImage>();
  std::vector<BusEvent> events;
};

TEST(IoNode, terminals_are_places_of_packet_a_both_ways) {
  IoPoint closed = digital(true, 9, "SA1");
  closed.rule.inverted = true;
  IoPoint valve = digital(false, 15, "SA65");
  valve.rule.inverted = true;
  IoPoint pressure = analogue(true, 1, "SA10.RE");
  pressure.rule.scale = 0.5;
  pressure.rule.shift = 10.0;
  IoPoint speed = analogue(false, 0, "SA12.RE");
  speed.rule.scale = 0.1;
  Bench b({digital(true, 0, "SA0"), closed, digital(false, 0, "SA64"), valve, pressure, speed});
  b.start();
  ASSERT_TRUE(b.boot());
  EXPECT_TRUE(b.bit("SA1"));
  b.module->set_digital(0, true);
  b.module->set_digital(9, true);
  b.module->set_analogue(1, -300);
  b.image->packets.set_bit(at("SA64"), true);
  b.image->packets.set_bit(at("SA65"), true);
  b.image->packets.set_number(at("SA12.RE"), 1234.5);
  b.run(25);
  EXPECT_TRUE(b.bit("SA0"));
  EXPECT_FALSE(b.bit("SA1"));
  EXPECT_DOUBLE_EQ(b.number("SA10.RE"), -140.0);
  EXPECT_TRUE(b.module->digital(0));
  EXPECT_FALSE(b.module->digital(15)) << "inverted";
  EXPECT_EQ(b.module->analogue(0), 12345);
  b.image->packets.set_number(at("SA12.RE"), 1e6);
  b.run(5);
  EXPECT_EQ(b.module->analogue(0), 32767) << "the end of the channel's range, not a wrap";
  EXPECT_EQ(b.image->sources[3].quality, image::Quality::good);
}

TEST(IoNode, a_digital_input_is_one_cycle_old) {
  Bench b({digital(true, 3, "SA0")});
  b.start();
  ASSERT_TRUE(b.boot());
  b.run(20);
  b.module->set_digital(3, true);
  int cycles = 0;
  while (!b.bit("SA0") && cycles < 10) b.step(), ++cycles;
  EXPECT_LE(cycles, 3)
      << "filtered in the next millisecond, latched by the SYNC after, read in the cycle after";
}

TEST(IoNode, error_states_follow_the_points_and_are_written_before_any_pdo) {
  IoPoint kept = digital(false, 1, "SA65"), opens = digital(false, 10, "SA66");
  kept.rule.hold = true;
  opens.rule.loss = 1.0;
  IoPoint rest = analogue(false, 0, "SA12.IN"), stays = analogue(false, 1, "SA13.IN");
  rest.rule.loss = -5.0;
  stays.rule.hold = true;
  Bench b({kept, opens, rest, stays});
  b.start();
  ASSERT_TRUE(b.boot());
  EXPECT_EQ(b.module->object(0x1029, 1), 0);
  EXPECT_EQ(b.module->object(io::kErrorModeOutput8, 1), 0xFD);
  EXPECT_EQ(b.module->object(io::kErrorValueOutput8, 1), 0x00);
  EXPECT_EQ(b.module->object(io::kErrorModeOutput8, 2), 0xFF);
  EXPECT_EQ(b.module->object(io::kErrorValueOutput8, 2), 0x04);
  EXPECT_EQ(b.module->object(io::kErrorModeAnalogueOutput, 1), 1);
  EXPECT_EQ(b.module->object(io::kErrorValueAnalogueOutput, 1), -5 * 65536);
  EXPECT_EQ(b.module->object(io::kErrorModeAnalogueOutput, 2), 0);
  EXPECT_EQ(b.module->object(0x1016, 1), 127 << 16 | 300);

  const auto plan = boot_plan(b.config.nodes[0], b.config);
  EXPECT_TRUE(std::ranges::is_sorted(plan, {}, &BootAction::step));
  for (const BootAction& action : plan) {
    EXPECT_NE(action.index, 0x6007) << "of an I/O module that is an interrupt mask";
    EXPECT_NE(action.index, 0x6060);
    EXPECT_NE(action.index, 0x6502);
  }
}

TEST(IoNode, a_cut_cable_is_one_event_and_both_ends_bring_the_outputs_where_their_loss_says) {
  IoPoint kept = digital(false, 0, "SA64"), falls = digital(false, 1, "SA65"),
          rises = digital(false, 2, "SA66");
  kept.rule.hold = true;
  rises.rule.loss = 1.0;
  IoPoint door = digital(true, 0, "SA0"), air = digital(true, 1, "SA1"), chain = digital(true, 2, "SA2");
  air.rule.hold = true;
  door.rule.loss = 1.0;
  Bench b({kept, falls, rises, door, air, chain});
  b.start();
  ASSERT_TRUE(b.boot());
  for (const char* place : {"SA64", "SA65"}) b.image->packets.set_bit(at(place), true);
  b.module->set_digital(1, true);
  b.module->set_digital(2, true);
  b.run(20);
  EXPECT_TRUE(b.module->digital(0) && b.module->digital(1) && !b.module->digital(2));
  b.wire.set_connected(1, false);
  int cycles = 0;
  while (b.image->sources[3].quality == image::Quality::good && cycles < 50) b.step(), ++cycles;
  EXPECT_LE(cycles, 5) << "three process data objects";
  EXPECT_TRUE(b.bit("SA0") && b.bit("SA1") && !b.bit("SA2"));
  b.run(800);
  EXPECT_TRUE(b.module->digital(0));
  EXPECT_FALSE(b.module->digital(1));
  EXPECT_TRUE(b.module->digital(2));
  EXPECT_EQ(b.count(BusEventKind::pdo_missing), 1);
  EXPECT_EQ(b.image->sources[3].errors, 1u);
  b.wire.set_connected(1, true);
  ASSERT_TRUE(b.boot());
  b.run(20);
  EXPECT_TRUE(b.module->digital(1)) << "outputs follow their places again";
  EXPECT_FALSE(b.module->digital(2));
  EXPECT_FALSE(b.bit("SA0"));
}

TEST(IoNode, a_slow_process_data_object_is_missed_too) {
  Bench b({analogue(true, 0, "SA10.IN"), digital(true, 0, "SA0")});
  b.start();
  ASSERT_TRUE(b.boot());
  b.run(50);
  // Somebody switches TPDO 2 off behind our back; TPDO 1 goes on.
  image::CanBus& other = b.wire.add_endpoint("other");
  image::CanFrame write;
  write.id = 0x605;
  write.length = 8;
  write.data = {0x23, 0x01, 0x18, 0x01, 0x85, 0x02, 0x00, 0xC0};
  ASSERT_TRUE(other.send(write));
  int cycles = 0;
  while (b.count(BusEventKind::pdo_missing) == 0 && cycles < 100) b.step(), ++cycles;
  EXPECT_GE(cycles, 21);
  EXPECT_LE(cycles, 33) << "three times every tenth SYNC";
}

TEST(IoNode, configurations_that_cannot_run_are_refused) {
  const auto refused = [](const std::function<void(NodeConfig&)>& change) {
    Bench b({digital(true, 0, "SA0")});
    change(b.config.nodes[0]);
    try {
      b.start();
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  };
  EXPECT_FALSE(refused([](NodeConfig&) {}));
  EXPECT_TRUE(refused([](NodeConfig& n) { n.io.points.push_back(digital(true, 16, "SA1")); }));
  EXPECT_TRUE(refused([](NodeConfig& n) { n.profile.tpdo[1].transmission_type = 255; })) << "need never come";
  EXPECT_FALSE(refused([](NodeConfig& n) {
    n.profile.tpdo[1].transmission_type = 255;
    n.profile.tpdo[1].event_ms = 100;
  }));
  const auto deaf = [](NodeConfig& n) { n.profile.has_heartbeat_consumer = false; };
  EXPECT_TRUE(refused(deaf)) << "its outputs would stay for ever";
  EXPECT_FALSE(refused([&](NodeConfig& n) {
    deaf(n);
    n.unsupervised = true;
  }));
  EXPECT_FALSE(refused([&](NodeConfig& n) {
    deaf(n);
    n.profile.rpdo = {};
  })) << "inputs harm nobody";
}

TEST(IoNode, allocates_nothing_while_it_runs) {
  Bench b({digital(true, 0, "SA0"), digital(false, 0, "SA64"), analogue(true, 0, "SA10.IN")});
  b.start();
  ASSERT_TRUE(b.boot());
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    b.wire.advance_to(b.image->now.t_ns);
    b.segment->open_cycle(*b.image);
    b.segment->receive(*b.image);
    b.segment->send(*b.image);
    ++b.image->now.number;
    b.image->now.t_ns += b.config.cycle_ns;
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::canopen
