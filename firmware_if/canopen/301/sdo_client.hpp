// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/sdo_block.hpp"
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

/// Client of the default SDO of one node: one transfer at a time, expedited, segmented or in blocks. Driven
/// by frames and time only; all members are real-time safe. Source: CiA 301, 7.2.4.3.
///
/// A lost answer repeats the whole transfer, `retries` times; a segment lost within a block repeats what
/// follows it only. Answers of another object, exact repetitions of a frame (CAN may deliver one twice) and
/// answers nobody waits for are ignored.
///
/// Blocks are used for transfers of the caller's own memory that are longer than kBlockThreshold. A device
/// that refuses a block transfer as such, or does not answer its first one, is served in segments; the former
/// is remembered.
class SdoClient {
 public:
  /// Longest transfer that uses the client's own buffer.
  static constexpr std::size_t kBuffer = 128;
  /// Up to this many bytes segments need no more frames than a block.
  static constexpr std::uint8_t kBlockThreshold = 28;

  SdoClient() = default;
  SdoClient(NodeId node, image::Nanoseconds timeout_ns, std::uint32_t retries) noexcept
      : node_(node), timeout_ns_(timeout_ns), retries_(retries) {}

  /// Starts writing at most kBuffer bytes, which are copied; none at all is the empty string. False when busy
  /// or when the size does not fit.
  bool download(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data) noexcept;
  /// The same for a little-endian integer of 1, 2, 4 or 8 bytes.
  bool download(std::uint16_t index, std::uint8_t subindex, std::uint64_t value, std::uint8_t bytes) noexcept;
  /// Starts writing any number of bytes out of the caller's memory, which must stay as it is until the
  /// transfer has ended. False when busy.
  bool download_from(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data) noexcept;
  /// Starts reading. False when busy. A longer object than kBuffer ends with AbortCode::out_of_memory.
  bool upload(std::uint16_t index, std::uint8_t subindex) noexcept;
  /// Starts reading into the caller's memory, which must stay until data() is no longer needed. False when
  /// busy. A longer object ends with AbortCode::out_of_memory.
  bool upload_into(std::uint16_t index, std::uint8_t subindex, std::span<std::uint8_t> memory) noexcept;
  /// The transfer that has just been started: the device may take so long for each of its answers, where that
  /// is longer than the client's own time-out.
  void wait_for(image::Nanoseconds answer_ns) noexcept { patience_ns_ = std::max(timeout_ns_, answer_ns); }
  /// Breaks a running transfer off; the abort frame is sent by the next poll. The status becomes idle.
  void cancel() noexcept;

  /// Segments that this client takes in one sub-block of an upload, 1-127.
  void set_block_size(std::uint8_t segments) noexcept { own_block_size_ = segments; }
  /// FALSE: this device is never offered a block transfer.
  void allow_blocks(bool allowed) noexcept { blocks_allowed_ = allowed; }
  /// The device has refused a block transfer, or blocks are not allowed.
  bool blocks_allowed() const noexcept { return blocks_allowed_; }

  bool busy() const noexcept { return result_.status == SdoStatus::busy; }
  const SdoResult& result() const noexcept { return result_; }
  /// What was read; valid until the next transfer starts.
  std::span<const std::uint8_t> data() const noexcept { return {memory(), result_.size}; }
  /// What was read as a little-endian unsigned integer (first 8 bytes).
  std::uint64_t value() const noexcept { return load_le(data()); }
  /// Bytes transferred so far, for a display.
  std::uint32_t position() const noexcept { return position_; }
  /// Bytes of the object: of a download always, of an upload once the device has told; 0: not known.
  std::uint32_t length() const noexcept { return length_; }

  /// Sends what is due: a request, a segment, a repetition or an abort. True when a frame was given to the
  /// bus.
  bool poll(image::Nanoseconds now, image::CanBus& bus) noexcept;
  /// Takes a frame with the identifier 580h + node; any other is ignored. True when it belonged to the
  /// transfer.
  bool on_frame(const image::CanFrame& frame) noexcept;

 private:
  enum class Phase : std::uint8_t {
    idle,
    initiate,
    segments,
    block_initiate,  ///< a block transfer was asked for
    block_segments,  ///< a sub-block is going out or coming in
    block_confirm,   ///< download: the sub-block is out; upload: ours is to be sent
    block_end,       ///< download: end sent; upload: the server's end awaited
    block_done,      ///< upload: everything is right, which is to be said
  };
  bool in_block() const noexcept { return phase_ >= Phase::block_initiate; }

  bool start(bool is_download, std::uint16_t index, std::uint8_t subindex) noexcept;
  void restart() noexcept;
  bool repeat() noexcept;
  void on_timeout() noexcept;
  bool send_abort(image::CanBus& bus) noexcept;
  SdoBytes request() noexcept;
  /// A download in one frame. No data at all, the empty string, go in a segment: a frame holds one to four.
  bool expedited() const noexcept { return length_ >= 1 && length_ <= 4; }
  SdoBytes initiate_request() const noexcept;
  SdoBytes segment_request() const noexcept;
  void finish(SdoStatus status, AbortCode abort) noexcept;
  void break_off(AbortCode code) noexcept;
  void on_abort(AbortCode code) noexcept;
  void on_initiate(const SdoFrame& answer) noexcept;
  void on_segment(const SdoFrame& answer) noexcept;
  bool expects(const SdoFrame& answer) const noexcept;
  bool on_plain_frame(const SdoBytes& bytes) noexcept;

  // Block transfer, in sdo_client_block.cpp.
  bool wants_blocks() const noexcept;
  SdoBytes block_request() noexcept;
  void block_sent() noexcept;
  bool on_block_frame(const SdoBytes& bytes) noexcept;
  bool on_block_initiate(const SdoBytes& bytes) noexcept;
  bool on_download_confirm(const SdoBytes& bytes) noexcept;
  bool on_upload_segment(const SdoBytes& bytes) noexcept;
  bool on_upload_end(const SdoBytes& bytes) noexcept;
  bool block_stalled() noexcept;
  void take_into_crc(std::uint32_t to) noexcept;

  const std::uint8_t* memory() const noexcept {
    return source_ ? source_ : target_ ? target_ : buffer_.data();
  }
  std::uint8_t* writable() noexcept { return target_ ? target_ : buffer_.data(); }

  NodeId node_ = 0;
  image::Nanoseconds timeout_ns_ = 200 * image::kMillisecond;
  image::Nanoseconds patience_ns_ = timeout_ns_;  ///< of this transfer
  std::uint32_t retries_ = 2;
  std::uint8_t own_block_size_ = kMaxBlockSize;
  bool blocks_allowed_ = true;
  bool blocks_known_ = false;  ///< the device has done a block transfer

  SdoResult result_;
  Phase phase_ = Phase::idle;
  bool request_due_ = false;
  bool abort_due_ = false;
  AbortCode abort_code_ = AbortCode::none;
  bool toggle_ = false;
  bool progress_ = false;  ///< something came since the last poll: the deadline begins anew
  image::Nanoseconds deadline_ns_ = 0;
  std::uint32_t capacity_ = kBuffer;
  std::uint32_t length_ = 0;    ///< of the object: known for a download, announced (0: not) for an upload
  std::uint32_t position_ = 0;  ///< bytes transferred; within blocks: confirmed
  SdoBytes last_answer_{};

  bool blocks_refused_ = false;  ///< of this transfer
  bool crc_used_ = false, last_segment_ = false;
  std::uint8_t block_size_ = 0, sequence_ = 0;  ///< segments of the sub-block; those sent or come in order
  std::uint16_t crc_ = 0;
  std::uint32_t crc_position_ = 0, stalls_ = 0;

  const std::uint8_t* source_ = nullptr;  ///< caller's memory of a download
  std::uint8_t* target_ = nullptr;        ///< caller's memory of an upload
  std::array<std::uint8_t, kBuffer> buffer_{};
};

}  // namespace servogate::canopen
