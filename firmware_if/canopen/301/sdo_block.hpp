// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/sdo_codec.hpp"

namespace servogate::canopen {

/// Most segments of one sub-block. Source: CiA 301, 7.2.4.3.9.
inline constexpr std::uint8_t kMaxBlockSize = 127;
inline constexpr std::uint32_t kSegmentData = 7;  ///< bytes of data in a segment

/// CRC-16 of block transfer: x^16 + x^12 + x^5 + 1, most significant bit first, start value 0, so that
/// "123456789" gives 31C3h. `crc` is what the bytes before gave. Source: CiA 301, 7.2.4.3.16. real-time safe.
std::uint16_t sdo_crc(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0) noexcept;

/// What a frame of a block transfer means; which of them can come depends on direction and phase, since the
/// segments use the bits of the command specifier for their number.
enum class BlockCommand : std::uint8_t { invalid, initiate, end, confirm, start };

/// A frame of a block transfer, other than a segment, taken apart.
struct BlockFrame {
  BlockCommand command = BlockCommand::invalid;
  std::uint16_t index = 0;  ///< initiate
  std::uint8_t subindex = 0;
  bool crc_supported = false;         ///< initiate
  bool size_indicated = false;        ///< initiate of the side that has the data
  std::uint32_t total = 0;            ///< bytes, where indicated
  std::uint8_t block_size = 0;        ///< initiate of the side that takes the data, confirm
  std::uint8_t switch_threshold = 0;  ///< upload initiate of the client: pst
  std::uint8_t sequence = 0;          ///< confirm: last segment that came in order
  std::uint8_t unused = 0;            ///< end: bytes of the last segment that carry no data, 0-7
  std::uint16_t crc = 0;              ///< end
};

/// Frames of block transfer. Source: CiA 301, 7.2.4.3.9-15. All are real-time safe.
namespace sdo_block {
/// Client: "I will write `total` bytes."
SdoBytes download_initiate(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept;
/// Server: "write, `block_size` segments at a time."
SdoBytes download_accept(std::uint16_t index, std::uint8_t subindex, std::uint8_t block_size) noexcept;
/// Client: "I want to read; if it is `threshold` bytes or less, without blocks" (0: always in blocks).
SdoBytes upload_initiate(std::uint16_t index, std::uint8_t subindex, std::uint8_t block_size,
                         std::uint8_t threshold) noexcept;
/// Server: "it is `total` bytes."
SdoBytes upload_accept(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept;
/// Client: "begin."
SdoBytes upload_start() noexcept;
/// Either: segment `sequence` (1-127) of a sub-block, at most seven bytes; `last` of the whole transfer.
SdoBytes segment(std::uint8_t sequence, std::span<const std::uint8_t> data, bool last) noexcept;
/// Whoever takes the data: everything up to `sequence` has come; the next sub-block has `block_size`
/// segments.
SdoBytes confirm(std::uint8_t sequence, std::uint8_t block_size) noexcept;
/// Whoever has the data: that was all, `unused` bytes of the last segment are no data.
SdoBytes end(std::uint8_t unused, std::uint16_t crc) noexcept;
/// Whoever takes the data: it is complete.
SdoBytes end_confirm() noexcept;

/// A frame of the other end. `download`: direction of the transfer; `from_client`: who sent it. real-time
/// safe.
BlockFrame parse(std::span<const std::uint8_t> bytes, bool download, bool from_client) noexcept;
}  // namespace sdo_block

/// Number and last-flag of a segment; 0: an abort (80h) or no segment at all.
constexpr std::uint8_t segment_sequence(std::uint8_t command) noexcept { return command & 0x7F; }
constexpr bool segment_last(std::uint8_t command) noexcept { return command & 0x80; }

}  // namespace servogate::canopen
