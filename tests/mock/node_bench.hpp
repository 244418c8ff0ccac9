// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"

namespace servogate::mock {

/// A device on a segment with a master that knows nothing but frames: what the tests send are the bytes that
/// the standard prints. Times in milliseconds.
class NodeBench {
 public:
  static constexpr std::uint8_t kNode = 5;
  using Bytes = std::vector<std::uint8_t>;

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

  CanSegment segment;
  image::CanBus& master = segment.add_endpoint("master");
  Nanoseconds now = 0;
  std::vector<CanFrame> seen;
  bool aborted = false;

 protected:
  /// Attaches the device of node kNode and lets it boot.
  void plug_in(CanNode& device) {
    segment.attach(device);
    run(20);
    seen.clear();
  }
};

}  // namespace servogate::mock
