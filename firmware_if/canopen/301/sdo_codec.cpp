// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_codec.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {
namespace {

// Command specifiers stand in bits 7-5 of byte 0; the same number means different things per direction.
SdoBytes with_object(std::uint8_t command, std::uint16_t index, std::uint8_t subindex,
                     std::uint32_t value) noexcept {
  SdoBytes bytes{command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), subindex};
  store_le(value, std::span(bytes).subspan(4));
  return bytes;
}

std::uint32_t up_to_four(std::span<const std::uint8_t> data) noexcept {
  return static_cast<std::uint32_t>(load_le(data.first(std::min<std::size_t>(data.size(), 4))));
}

SdoBytes expedited(std::uint8_t specifier, std::uint16_t index, std::uint8_t subindex,
                   std::span<const std::uint8_t> data) noexcept {
  const auto unused = static_cast<unsigned>(4 - std::clamp<std::size_t>(data.size(), 1, 4));
  return with_object(static_cast<std::uint8_t>(specifier | unused << 2 | 0x03), index, subindex,
                     up_to_four(data));
}

SdoBytes segment(std::uint8_t specifier, bool toggle, std::span<const std::uint8_t> data,
                 bool last) noexcept {
  SdoBytes bytes{};
  const std::size_t size = std::min<std::size_t>(data.size(), 7);
  bytes[0] = static_cast<std::uint8_t>(specifier | (toggle ? 0x10u : 0u) |
                                       static_cast<unsigned>(7 - size) << 1 | (last ? 1u : 0u));
  std::copy_n(data.begin(), size, bytes.begin() + 1);
  return bytes;
}

void read_object(std::span<const std::uint8_t> bytes, SdoFrame& frame) noexcept {
  frame.index = static_cast<std::uint16_t>(load_le(bytes.subspan(1, 2)));
  frame.subindex = bytes[3];
}

void read_initiate(std::span<const std::uint8_t> bytes, SdoFrame& frame) noexcept {
  frame.expedited = bytes[0] & 0x02;
  frame.size_indicated = bytes[0] & 0x01;
  if (frame.expedited) {
    frame.size = static_cast<std::uint8_t>(frame.size_indicated ? 4 - ((bytes[0] >> 2) & 3) : 4);
    std::copy_n(bytes.begin() + 4, frame.size, frame.data.begin());
  } else if (frame.size_indicated) {
    frame.total = static_cast<std::uint32_t>(load_le(bytes.subspan(4, 4)));
  }
}

void read_segment(std::span<const std::uint8_t> bytes, SdoFrame& frame) noexcept {
  frame.size = static_cast<std::uint8_t>(7 - ((bytes[0] >> 1) & 7));
  frame.last = bytes[0] & 0x01;
  std::copy_n(bytes.begin() + 1, frame.size, frame.data.begin());
}

// The command of each specifier 0-7, by direction.
using C = SdoCommand;
constexpr C kOfRequest[8] = {
    C::download_segment, C::download_initiate, C::upload_initiate, C::upload_segment, C::abort,
    C::block_upload,     C::block_download,    C::invalid};
constexpr C kOfResponse[8] = {
    C::upload_segment, C::download_segment, C::upload_initiate, C::download_initiate,
    C::abort,          C::block_download,   C::block_upload,    C::invalid};

SdoFrame parse(std::span<const std::uint8_t> bytes, const C (&commands)[8], C with_data_initiate,
               C with_data_segment) noexcept {
  SdoFrame frame;
  if (bytes.size() != 8) return frame;
  frame.command = commands[bytes[0] >> 5];
  if (frame.command == C::download_segment || frame.command == C::upload_segment)
    frame.toggle = bytes[0] & 0x10;
  if (frame.command == with_data_segment) {
    read_segment(bytes, frame);
  } else if (frame.command == C::abort) {
    read_object(bytes, frame);
    frame.abort = static_cast<AbortCode>(load_le(bytes.subspan(4, 4)));
  } else if (frame.command == C::download_initiate || frame.command == C::upload_initiate) {
    read_object(bytes, frame);
    if (frame.command == with_data_initiate) read_initiate(bytes, frame);
  }
  return frame;
}

}  // namespace

namespace sdo_request {
SdoBytes download_expedited(std::uint16_t index, std::uint8_t subindex,
                            std::span<const std::uint8_t> data) noexcept {
  return expedited(0x20, index, subindex, data);
}
SdoBytes download_segmented(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept {
  return with_object(0x21, index, subindex, total);
}
SdoBytes download_segment(bool toggle, std::span<const std::uint8_t> data, bool last) noexcept {
  return segment(0x00, toggle, data, last);
}
SdoBytes upload(std::uint16_t index, std::uint8_t subindex) noexcept {
  return with_object(0x40, index, subindex, 0);
}
SdoBytes upload_segment(bool toggle) noexcept { return {static_cast<std::uint8_t>(toggle ? 0x70 : 0x60)}; }
}  // namespace sdo_request

namespace sdo_response {
SdoBytes download(std::uint16_t index, std::uint8_t subindex) noexcept {
  return with_object(0x60, index, subindex, 0);
}
SdoBytes download_segment(bool toggle) noexcept { return {static_cast<std::uint8_t>(toggle ? 0x30 : 0x20)}; }
SdoBytes upload_expedited(std::uint16_t index, std::uint8_t subindex,
                          std::span<const std::uint8_t> data) noexcept {
  return expedited(0x40, index, subindex, data);
}
SdoBytes upload_segmented(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept {
  return with_object(0x41, index, subindex, total);
}
SdoBytes upload_segment(bool toggle, std::span<const std::uint8_t> data, bool last) noexcept {
  return segment(0x00, toggle, data, last);
}
}  // namespace sdo_response

SdoBytes sdo_abort(std::uint16_t index, std::uint8_t subindex, AbortCode code) noexcept {
  return with_object(0x80, index, subindex, static_cast<std::uint32_t>(code));
}

SdoFrame parse_sdo_request(std::span<const std::uint8_t> bytes) noexcept {
  return parse(bytes, kOfRequest, C::download_initiate, C::download_segment);
}
SdoFrame parse_sdo_response(std::span<const std::uint8_t> bytes) noexcept {
  return parse(bytes, kOfResponse, C::upload_initiate, C::upload_segment);
}

}  // namespace servogate::canopen
