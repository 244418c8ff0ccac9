// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"

namespace servogate::mock {

/// A drive on a segment with a master that knows nothing but frames: what the tests send are the bytes that
/// the standard prints. Times in milliseconds.
class DriveBench {
 public:
  static constexpr std::uint8_t kNode = 5;
  using Bytes = std::vector<std::uint8_t>;

  explicit DriveBench(SimulatedDriveConfig config = {}) : drive(with_node(config)) {
    segment.attach(drive);
    run(20);
    seen.clear();
  }

  void send(std::uint32_t id, const Bytes& bytes) {
    CanFrame frame;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
    master.send(frame);
  }
  /// Advances in steps of 1 ms and keeps everything received in `seen`.
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      now += image::kMillisecond;
      segment.advance_to(now);
      CanFrame frame;
      while (master.receive(frame)) seen.push_back(frame);
    }
  }
  /// Removes and returns the oldest frame with this identifier.
  std::optional<CanFrame> take(std::uint32_t id) {
    for (auto it = seen.begin(); it != seen.end(); ++it) {
      if (it->id != id) continue;
      const CanFrame frame = *it;
      seen.erase(it);
      return frame;
    }
    return std::nullopt;
  }
  int count(std::uint32_t id) const {
    int n = 0;
    for (const CanFrame& f : seen) n += f.id == id;
    return n;
  }

  /// One SDO request; its answer's eight bytes, empty when none comes within 5 ms.
  Bytes sdo(const Bytes& request) {
    send(0x600 + kNode, request);
    for (int i = 0; i < 5; ++i) {
      run(1);
      if (const auto f = take(0x580 + kNode)) return {f->data.begin(), f->data.begin() + f->length};
    }
    return {};
  }
  /// Expedited download; 0 or the abort code.
  std::uint32_t write(std::uint16_t index, std::uint8_t sub, std::int64_t value, int size) {
    Bytes b{static_cast<std::uint8_t>(0x23 | (4 - size) << 2),
            static_cast<std::uint8_t>(index),
            static_cast<std::uint8_t>(index >> 8),
            sub,
            0,
            0,
            0,
            0};
    for (int i = 0; i < size; ++i)
      b[static_cast<std::size_t>(4 + i)] = static_cast<std::uint8_t>(value >> (8 * i));
    const Bytes a = sdo(b);
    if (a.size() != 8) return 0xFFFFFFFF;
    return a[0] == 0x80 ? word(a) : 0;
  }
  /// Expedited upload as an unsigned number; with an abort its code and `aborted`.
  std::uint32_t read(std::uint16_t index, std::uint8_t sub = 0) {
    const Bytes a =
        sdo({0x40, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0});
    aborted = a.size() != 8 || a[0] == 0x80;
    return a.size() == 8 ? word(a) : 0xFFFFFFFF;
  }
  std::int32_t read_signed(std::uint16_t index, std::uint8_t sub = 0) {
    return static_cast<std::int32_t>(read(index, sub));
  }
  static std::uint32_t word(const Bytes& a) {
    return a[4] | static_cast<std::uint32_t>(a[5]) << 8 | static_cast<std::uint32_t>(a[6]) << 16 |
           static_cast<std::uint32_t>(a[7]) << 24;
  }
  void nmt(std::uint8_t command, std::uint8_t node = kNode) {
    send(0x000, {command, node});
    run(3);
  }
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

  CanSegment segment;
  image::CanBus& master = segment.add_endpoint("master");
  SimulatedDrive drive;
  Nanoseconds now = 0;
  std::vector<CanFrame> seen;
  bool aborted = false;

 private:
  static SimulatedDriveConfig with_node(SimulatedDriveConfig config) {
    config.node_id = kNode;
    return config;
  }
};

}  // namespace servogate::mock
