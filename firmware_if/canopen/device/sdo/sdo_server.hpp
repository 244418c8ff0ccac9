// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/sdo_block.hpp"
#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// The objects behind an SDO server.
class SdoObjects {
 public:
  virtual ~SdoObjects() = default;
  /// Bytes of an object; `bytes` holds kMaxText, of a longer one what fits. real-time safe.
  virtual AbortCode read(std::uint16_t index, std::uint8_t subindex, std::span<std::uint8_t> bytes,
                         std::size_t& size) noexcept = 0;
  /// `bytes` lie in room(), where that gave some. real-time safe.
  virtual AbortCode write(std::uint16_t index, std::uint8_t subindex,
                          std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Whether a download may begin: object, sub-index and access. `size` of a number, 0 of a string. real-time
  /// safe.
  virtual AbortCode may_write(std::uint16_t index, std::uint8_t subindex, std::size_t& size) noexcept = 0;

  /// Memory for a download that may be longer than kMaxText; write() is given it at the end. Empty: there is
  /// none, and the server's own kMaxText bytes are used. real-time safe.
  virtual std::span<std::uint8_t> room(std::uint16_t, std::uint8_t) noexcept { return {}; }
  /// Content of a text or domain that may be longer than kMaxText, which stays until the transfer has ended;
  /// asked for after read() allowed the access. Empty: what read() gave counts. real-time safe.
  virtual std::span<const std::uint8_t> content(std::uint16_t, std::uint8_t) noexcept { return {}; }
};

/// SDO server of one channel: expedited, segmented and block transfers with CRC. A state machine on requests
/// and time. Segmented transfers have no time-out: a new initiate frame ends one that was left. A block
/// download that falls silent has what came confirmed after kSilence, so that only what was lost is repeated,
/// and is aborted after twice that. Source: CiA 301, 7.2.4.3. real-time safe.
class SdoServer {
 public:
  static constexpr image::Nanoseconds kSilence = 250 * image::kMillisecond;

  explicit SdoServer(SdoObjects& objects) : objects_(objects) {}

  /// Segments of one sub-block of a download, 1-127.
  void set_block_size(std::uint8_t segments) noexcept { own_block_size_ = segments; }
  /// FALSE: block transfers are refused with 0504 0001h, as a small device does; clients fall back to
  /// segments.
  void allow_blocks(bool allowed) noexcept { blocks_allowed_ = allowed; }

  /// Serves one request of eight bytes. False: no answer is due (an abort of the client, a wrong length, a
  /// segment within a block).
  bool handle(std::span<const std::uint8_t> request, image::Nanoseconds now, SdoBytes& answer) noexcept;
  /// Time passes. True: `answer` is due.
  bool tick(image::Nanoseconds now, SdoBytes& answer) noexcept;
  /// The next segment of a block upload. False: none is due. It is due again until segment_sent().
  bool segment(SdoBytes& frame) const noexcept;
  void segment_sent() noexcept { ++sequence_; }
  /// Forgets a transfer under way.
  void reset() noexcept { transfer_ = Transfer::none; }

 private:
  enum class Transfer : std::uint8_t {
    none,
    download,
    upload,
    block_download,      ///< segments come
    block_download_end,  ///< all have come; the end request is awaited
    block_upload_start,  ///< announced; the start request is awaited
    block_upload,        ///< segments go out, then the confirmation is awaited
    block_upload_end,    ///< end said; the client's word is awaited
  };
  SdoBytes begin_download(const SdoFrame& f) noexcept;
  SdoBytes continue_download(const SdoFrame& f) noexcept;
  SdoBytes begin_upload(const SdoFrame& f) noexcept;
  SdoBytes continue_upload(const SdoFrame& f) noexcept;
  AbortCode open_download(bool size_known, std::size_t total) noexcept;
  AbortCode open_upload() noexcept;
  SdoBytes plain_upload() noexcept;
  SdoBytes refuse(AbortCode code) noexcept;

  // In sdo_server_block.cpp.
  SdoBytes begin_block_download(std::span<const std::uint8_t> request) noexcept;
  bool take_segment(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept;
  SdoBytes confirm_block() noexcept;
  SdoBytes end_block_download(std::span<const std::uint8_t> request) noexcept;
  bool block_upload_request(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept;
  SdoBytes begin_block_upload(const BlockFrame& f) noexcept;
  bool upload_confirmed(const BlockFrame& f, SdoBytes& answer) noexcept;
  void take_into_crc(std::size_t to) noexcept;

  SdoObjects& objects_;
  std::uint8_t own_block_size_ = kMaxBlockSize;
  bool blocks_allowed_ = true;
  Transfer transfer_ = Transfer::none;
  std::uint16_t index_ = 0;
  std::uint8_t subindex_ = 0;
  bool toggle_ = false;
  bool size_known_ = false;
  std::size_t total_ = 0;  ///< announced, or to be read
  std::size_t done_ = 0;   ///< bytes; within blocks: confirmed
  bool crc_used_ = false, last_ = false;
  std::uint8_t block_size_ = 0, sequence_ = 0;  ///< segments of the sub-block; those sent or come in order
  std::uint16_t crc_ = 0;
  std::size_t crc_position_ = 0;
  SdoBytes last_segment_{};  ///< of a block download: CAN may deliver it twice
  image::Nanoseconds heard_ = 0;
  std::span<std::uint8_t> target_;        ///< memory of a download
  std::span<const std::uint8_t> source_;  ///< content of an upload
  std::array<std::uint8_t, kMaxText> buffer_{};
};

}  // namespace servogate::canopen
