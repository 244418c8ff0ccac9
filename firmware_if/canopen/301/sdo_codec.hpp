// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// Why an SDO transfer was broken off. Source: CiA 301, 7.2.4.3.17, table "SDO abort codes". A device may
/// send others.
enum class AbortCode : std::uint32_t {
  none = 0,
  toggle_not_alternated = 0x0503'0000,
  timed_out = 0x0504'0000,
  command_specifier_invalid = 0x0504'0001,
  block_size_invalid = 0x0504'0002,
  sequence_number_invalid = 0x0504'0003,
  crc_error = 0x0504'0004,
  out_of_memory = 0x0504'0005,
  unsupported_access = 0x0601'0000,
  write_only = 0x0601'0001,
  read_only = 0x0601'0002,
  object_does_not_exist = 0x0602'0000,
  cannot_be_mapped = 0x0604'0041,
  mapping_too_long = 0x0604'0042,
  parameter_incompatible = 0x0604'0043,
  internal_incompatible = 0x0604'0047,
  hardware_error = 0x0606'0000,
  length_mismatch = 0x0607'0010,
  length_too_high = 0x0607'0012,
  length_too_low = 0x0607'0013,
  subindex_does_not_exist = 0x0609'0011,
  value_invalid = 0x0609'0030,
  value_too_high = 0x0609'0031,
  value_too_low = 0x0609'0032,
  maximum_below_minimum = 0x0609'0036,
  resource_not_available = 0x060A'0023,
  general_error = 0x0800'0000,
  cannot_transfer = 0x0800'0020,
  local_control = 0x0800'0021,
  device_state = 0x0800'0022,
  no_object_dictionary = 0x0800'0023,
  no_data_available = 0x0800'0024,
};

/// Words for an abort code; an unknown one gets the general sentence with the placeholder {0} for its number.
/// real-time safe.
const text::Entry& abort_text(AbortCode code) noexcept;

/// The eight data bytes of every SDO frame.
using SdoBytes = std::array<std::uint8_t, 8>;

enum class SdoCommand : std::uint8_t {
  invalid,
  download_initiate,
  download_segment,
  upload_initiate,
  upload_segment,
  block_download,
  block_upload,
  abort,
};

/// An SDO frame taken apart, of either direction.
struct SdoFrame {
  SdoCommand command = SdoCommand::invalid;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  bool toggle = false;
  bool expedited = false;       ///< initiate: the data is in this frame
  bool size_indicated = false;  ///< initiate: `size` (expedited) or `total` (segmented) was given
  bool last = false;            ///< segment: no more follow
  std::uint8_t size = 0;        ///< bytes of `data` in use; expedited without a given size: 4
  std::uint32_t total = 0;      ///< segmented initiate: announced length in bytes
  std::array<std::uint8_t, 7> data{};
  AbortCode abort = AbortCode::none;
};

/// Frames of the client. Source: CiA 301, 7.2.4.3. All are real-time safe.
namespace sdo_request {
/// 1-4 bytes; more are cut off.
SdoBytes download_expedited(std::uint16_t index, std::uint8_t subindex,
                            std::span<const std::uint8_t> data) noexcept;
SdoBytes download_segmented(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept;
/// 1-7 bytes.
SdoBytes download_segment(bool toggle, std::span<const std::uint8_t> data, bool last) noexcept;
SdoBytes upload(std::uint16_t index, std::uint8_t subindex) noexcept;
SdoBytes upload_segment(bool toggle) noexcept;
}  // namespace sdo_request

/// Frames of the server. All are real-time safe.
namespace sdo_response {
SdoBytes download(std::uint16_t index, std::uint8_t subindex) noexcept;
SdoBytes download_segment(bool toggle) noexcept;
SdoBytes upload_expedited(std::uint16_t index, std::uint8_t subindex,
                          std::span<const std::uint8_t> data) noexcept;
SdoBytes upload_segmented(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept;
SdoBytes upload_segment(bool toggle, std::span<const std::uint8_t> data, bool last) noexcept;
}  // namespace sdo_response

/// Either side may break a transfer off. real-time safe.
SdoBytes sdo_abort(std::uint16_t index, std::uint8_t subindex, AbortCode code) noexcept;

/// Takes a frame of the client (identifier 600h + node) or of the server (580h + node) apart. Anything but 8
/// bytes or with an undefined command specifier is `invalid`. real-time safe.
SdoFrame parse_sdo_request(std::span<const std::uint8_t> bytes) noexcept;
SdoFrame parse_sdo_response(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace servogate::canopen
