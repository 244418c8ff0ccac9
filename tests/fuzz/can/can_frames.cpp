// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes as CAN frames, through every decoder and through a running segment.
//
// Input: records of 10 bytes: low byte of the identifier, a byte with its upper 3 bits, length and remote
// flag, 8 data bytes. A second byte of FFh ends the cycle; with an odd first byte the transmit queue is full
// in the next one. corpus/boot.bin is what a master hears while two drives boot and move.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/master/segment.hpp"

namespace {

using namespace servogate;
using namespace servogate::canopen;

constexpr std::size_t kRecord = 10;
constexpr std::size_t kFramesPerCycle = 8;
constexpr std::uint8_t kEndOfCycle = 0xFF;

void require(bool condition) {
  if (!condition) std::abort();
}

image::CanFrame frame_of(std::span<const std::uint8_t> record) {
  image::CanFrame frame;
  frame.id = record[0] | (record[1] & 7u) << 8;
  frame.length = (record[1] >> 3) & 15;
  frame.remote = record[1] & 0x80;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = record[2 + i];
  return frame;
}

/// Gives the frames of the input to whoever receives, a few a cycle.
class FuzzedBus final : public image::CanBus {
 public:
  explicit FuzzedBus(std::span<const std::uint8_t> input) : input_(input) {}
  bool send(const image::CanFrame&) noexcept override { return !refuse_; }
  bool receive(image::CanFrame& frame) noexcept override {
    if (left_ == 0 || input_.size() < kRecord) return false;
    --left_;
    const auto record = input_.first(kRecord);
    input_ = input_.subspan(kRecord);
    if (record[1] == kEndOfCycle) {
      left_ = 0;
      refuse_ = record[0] & 1;
    }
    frame = frame_of(record);
    return record[1] != kEndOfCycle;
  }
  image::CanState state() const noexcept override { return image::CanState::error_active; }
  std::uint32_t bit_rate() const noexcept override { return 1'000'000; }
  bool next_cycle() {
    left_ = kFramesPerCycle;
    return input_.size() >= kRecord;
  }

 private:
  std::span<const std::uint8_t> input_;
  std::size_t left_ = 0;
  bool refuse_ = false;
};

void decode(const image::CanFrame& frame) {
  const std::span bytes(frame.data.data(), frame.length);
  for (const SdoFrame& sdo : {parse_sdo_request(bytes), parse_sdo_response(bytes)}) {
    require(sdo.size <= sdo.data.size());
    require(!abort_text(sdo.abort).english.empty());
  }
  parse_nmt(frame);
  parse_heartbeat(frame);
  if (const auto emcy = parse_emcy(frame)) {
    require(emcy_frame(1, *emcy).data == frame.data || frame.length != 8);
    require(!error_code_text(emcy->error_code).english.empty());
  }
  const auto word = static_cast<std::uint16_t>(load_le(bytes.first(bytes.size() < 2 ? bytes.size() : 2)));
  if (const auto state = decode_state(word))
    require((word & 0x4F & encode_state(*state)) == (encode_state(*state) & 0x4F));
}

SegmentConfig two_drives() {
  SegmentConfig config;
  for (int i = 0; i < 2; ++i) {
    NodeConfig node;
    node.node = static_cast<NodeId>(i + 1);
    node.target_index = i;
    i == 0 ? use_short_position_map(node.profile) : use_full_position_map(node.profile);
    config.nodes.push_back(node);
  }
  config.sdo_timeout_ms = 5;
  config.boot_timeout_ms = 20;
  config.boot_pause_ms = 2;
  config.heartbeat_ms = 10;
  config.heartbeat_timeout_ms = 30;
  return config;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span input(data, size);
  for (std::size_t at = 0; at + kRecord <= size; at += kRecord) decode(frame_of(input.subspan(at, kRecord)));

  static const SegmentConfig config = two_drives();
  FuzzedBus bus(input);
  Segment segment(bus, config);
  const auto image = std::make_unique<image::ProcessImage>();
  BusEvent event;
  while (bus.next_cycle()) {
    segment.open_cycle(*image);
    segment.receive(*image);
    for (auto& axis : image->axes) {
      axis.drive_command.power = image->now.number % 64 > 8;
      axis.drive_command.reset_fault = image->now.number % 16 > 8;
      axis.drive_command.latch_arm = image->now.number % 32 > 4;
    }
    segment.send(*image);
    while (segment.events().pop(event))
      require(!describe(event, "n", nullptr, text::Language::english).empty());
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
  }
  return 0;
}
