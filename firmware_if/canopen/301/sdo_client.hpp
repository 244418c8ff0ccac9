// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// How a transfer stands or ended.
enum class SdoStatus : std::uint8_t {
  idle,
  busy,
  done,
  aborted,       ///< by the device: `abort` says why
  no_answer,     ///< after all repetitions
  bad_protocol,  ///< the device's answer is against CiA 301; `abort` is the code we sent
};

/// Result of the last transfer.
struct SdoResult {
  SdoStatus status = SdoStatus::idle;
  AbortCode abort = AbortCode::none;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  bool download = false;
  std::uint32_t size = 0;     ///< bytes read or written
  std::uint32_t retries = 0;  ///< repetitions this transfer needed
};

/// Client of the default SDO of one node: one transfer at a time, expedited or segmented. Driven by frames
/// and time only; all members are real-time safe. Block transfer (CiA 301, 7.2.4.3.9) has its place in the
/// codec's commands.
///
/// A lost answer repeats the whole transfer, `retries` times. Answers of another object, exact repetitions of
/// a frame (CAN may deliver one twice) and answers nobody waits for are ignored.
class SdoClient {
 public:
  /// Longest transfer that uses the client's own buffer.
  static constexpr std::size_t kBuffer = 128;

  SdoClient() = default;
  SdoClient(NodeId node, image::Nanoseconds timeout_ns, std::uint32_t retries) noexcept
      : node_(node), timeout_ns_(timeout_ns), retries_(retries) {}

  /// Starts writing at most kBuffer bytes, which are copied. False when busy or when the size does not fit (0
  /// does not).
  bool download(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data) noexcept;
  /// The same for a little-endian integer of 1, 2, 4 or 8 bytes.
  bool download(std::uint16_t index, std::uint8_t subindex, std::uint64_t value, std::uint8_t bytes) noexcept;
  /// Starts reading. False when busy. A longer object than kBuffer ends with AbortCode::out_of_memory.
  bool upload(std::uint16_t index, std::uint8_t subindex) noexcept;
  /// Breaks a running transfer off; the abort frame is sent by the next poll. The status becomes idle.
  void cancel() noexcept;

  bool busy() const noexcept { return result_.status == SdoStatus::busy; }
  const SdoResult& result() const noexcept { return result_; }
  /// What was read; valid until the next transfer starts.
  std::span<const std::uint8_t> data() const noexcept { return {buffer_.data(), result_.size}; }
  /// What was read as a little-endian unsigned integer (first 8 bytes).
  std::uint64_t value() const noexcept { return load_le(data()); }

  /// Sends what is due: a request, a repetition or an abort. True when a frame was given to the bus.
  bool poll(image::Nanoseconds now, image::CanBus& bus) noexcept;
  /// Takes a frame with the identifier 580h + node; any other is ignored. True when it belonged to the
  /// transfer.
  bool on_frame(const image::CanFrame& frame) noexcept;

 private:
  enum class Phase : std::uint8_t { idle, initiate, segments };

  bool start(bool is_download, std::uint16_t index, std::uint8_t subindex) noexcept;
  void restart() noexcept;
  SdoBytes initiate_request() const noexcept;
  SdoBytes segment_request() const noexcept;
  void finish(SdoStatus status, AbortCode abort) noexcept;
  void break_off(AbortCode code) noexcept;
  void on_initiate(const SdoFrame& answer) noexcept;
  void on_segment(const SdoFrame& answer) noexcept;
  bool expects(const SdoFrame& answer) const noexcept;

  NodeId node_ = 0;
  image::Nanoseconds timeout_ns_ = 200 * image::kMillisecond;
  std::uint32_t retries_ = 2;

  SdoResult result_;
  Phase phase_ = Phase::idle;
  bool request_due_ = false;
  bool abort_due_ = false;
  AbortCode abort_code_ = AbortCode::none;
  bool toggle_ = false;
  image::Nanoseconds deadline_ns_ = 0;
  std::uint32_t length_ = 0;    ///< of the object: known for a download, announced (0: not) for an upload
  std::uint32_t position_ = 0;  ///< bytes transferred
  SdoBytes last_answer_{};
  std::array<std::uint8_t, kBuffer> buffer_{};
};

}  // namespace servogate::canopen
