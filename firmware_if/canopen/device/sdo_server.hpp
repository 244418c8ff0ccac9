// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/canopen/device/object_dictionary.hpp"

namespace servogate::canopen {

/// The objects behind an SDO server.
class SdoObjects {
 public:
  virtual ~SdoObjects() = default;
  /// Bytes of an object; `bytes` holds kMaxText. real-time safe.
  virtual AbortCode read(std::uint16_t index, std::uint8_t subindex, std::span<std::uint8_t> bytes,
                         std::size_t& size) noexcept = 0;
  /// real-time safe.
  virtual AbortCode write(std::uint16_t index, std::uint8_t subindex,
                          std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Whether a download may begin: object, sub-index and access. `size` of a number, 0 of a string. real-time
  /// safe.
  virtual AbortCode may_write(std::uint16_t index, std::uint8_t subindex, std::size_t& size) noexcept = 0;
};

/// SDO server of one channel: expedited and segmented transfers; a block transfer is refused with 0504 0001h,
/// after which a client falls back to segments. A pure function of requests; no time-out of its own: a new
/// initiate frame ends a transfer that was left. Source: CiA 301, 7.2.4.3. real-time safe.
class SdoServer {
 public:
  explicit SdoServer(SdoObjects& objects) : objects_(objects) {}

  /// Serves one request of eight bytes. False: no answer is due (an abort of the client, a wrong length).
  bool handle(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept;
  /// Forgets a transfer under way.
  void reset() noexcept { transfer_ = Transfer::none; }

 private:
  enum class Transfer : std::uint8_t { none, download, upload };
  SdoBytes begin_download(const SdoFrame& f) noexcept;
  SdoBytes continue_download(const SdoFrame& f) noexcept;
  SdoBytes begin_upload(const SdoFrame& f) noexcept;
  SdoBytes continue_upload(const SdoFrame& f) noexcept;
  SdoBytes refuse(AbortCode code) noexcept;

  SdoObjects& objects_;
  Transfer transfer_ = Transfer::none;
  std::uint16_t index_ = 0;
  std::uint8_t subindex_ = 0;
  bool toggle_ = false;
  bool size_known_ = false;
  std::size_t total_ = 0;
  std::size_t done_ = 0;
  std::array<std::uint8_t, kMaxText> buffer_{};
};

}  // namespace servogate::canopen
