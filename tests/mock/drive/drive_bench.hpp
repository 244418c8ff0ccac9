// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "drivers/mock/drive/simulated_drive.hpp"
#include "tests/mock/node_bench.hpp"

namespace servogate::mock {

/// A drive on a NodeBench.
class DriveBench : public NodeBench {
 public:
  explicit DriveBench(SimulatedDriveConfig config = {}) : drive(with_node(config)) { plug_in(drive); }

  void control(std::uint16_t word, int ms = 3) {
    write(0x6040, 0, word, 2);
    run(ms);
  }
  std::uint16_t status() { return static_cast<std::uint16_t>(read(0x6041)); }
  void enable() {
    control(0x0006);
    control(0x0007);
    control(0x000F, 80);
  }
  /// Maps 6040+607A into RPDO1 and 6041+6064 into TPDO1, both synchronous, and starts the node.
  void start_cyclic_position() {
    write(0x1400, 1, 0x80000205, 4);
    write(0x1800, 1, 0xC0000185, 4);
    write(0x1600, 0, 0, 1);
    write(0x1600, 1, 0x60400010, 4);
    write(0x1600, 2, 0x607A0020, 4);
    write(0x1600, 0, 2, 1);
    write(0x1A00, 0, 0, 1);
    write(0x1A00, 1, 0x60410010, 4);
    write(0x1A00, 2, 0x60640020, 4);
    write(0x1A00, 0, 2, 1);
    write(0x1400, 2, 1, 1);
    write(0x1800, 2, 1, 1);
    write(0x1400, 1, 0x205, 4);
    write(0x1800, 1, 0x40000185, 4);
    write(0x60C2, 1, 1, 1);
    write(0x6060, 0, 8, 1);
    nmt(0x01);
  }
  /// One cycle: SYNC, then the RPDO that acts at the next SYNC.
  void cycle(std::uint16_t control_word, std::int32_t target) {
    const auto t = static_cast<std::uint32_t>(target);
    send(0x080, {});
    send(0x205, {static_cast<std::uint8_t>(control_word), static_cast<std::uint8_t>(control_word >> 8),
                 static_cast<std::uint8_t>(t), static_cast<std::uint8_t>(t >> 8),
                 static_cast<std::uint8_t>(t >> 16), static_cast<std::uint8_t>(t >> 24)});
    run(1);
  }
  /// Position in the newest TPDO1 of start_cyclic_position().
  std::int32_t tpdo_position() {
    CanFrame newest;
    while (const auto f = take(0x185)) newest = *f;
    return static_cast<std::int32_t>(newest.data[2] | static_cast<std::uint32_t>(newest.data[3]) << 8 |
                                     static_cast<std::uint32_t>(newest.data[4]) << 16 |
                                     static_cast<std::uint32_t>(newest.data[5]) << 24);
  }

  SimulatedDrive drive;

 private:
  static SimulatedDriveConfig with_node(SimulatedDriveConfig config) {
    config.node_id = kNode;
    return config;
  }
};

}  // namespace servogate::mock
