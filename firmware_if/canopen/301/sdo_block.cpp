// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_block.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint8_t kDownload = 0xC0, kUpload = 0xA0;  // command specifier of the client; the server swaps

constexpr std::array<std::uint16_t, 256> make_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned crc = i << 8;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1;
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}
constexpr auto kTable = make_table();

SdoBytes initiate(unsigned command, std::uint16_t index, std::uint8_t subindex,
                  std::uint32_t value) noexcept {
  SdoBytes bytes{static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(index),
                 static_cast<std::uint8_t>(index >> 8), subindex};
  store_le(value, std::span(bytes).subspan(4));
  return bytes;
}

}  // namespace

std::uint16_t sdo_crc(std::span<const std::uint8_t> bytes, std::uint16_t crc) noexcept {
  for (const std::uint8_t byte : bytes)
    crc = static_cast<std::uint16_t>(crc << 8 ^ kTable[static_cast<std::uint8_t>(crc >> 8 ^ byte)]);
  return crc;
}

namespace sdo_block {

SdoBytes download_initiate(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept {
  return initiate(kDownload | 0x06, index, subindex, total);
}
SdoBytes download_accept(std::uint16_t index, std::uint8_t subindex, std::uint8_t block_size) noexcept {
  return initiate(kUpload | 0x04, index, subindex, block_size);
}
SdoBytes upload_initiate(std::uint16_t index, std::uint8_t subindex, std::uint8_t block_size,
                         std::uint8_t threshold) noexcept {
  return initiate(kUpload | 0x04, index, subindex, block_size | static_cast<std::uint32_t>(threshold) << 8);
}
SdoBytes upload_accept(std::uint16_t index, std::uint8_t subindex, std::uint32_t total) noexcept {
  return initiate(kDownload | 0x06, index, subindex, total);
}
SdoBytes upload_start() noexcept { return {kUpload | 0x03}; }
SdoBytes segment(std::uint8_t sequence, std::span<const std::uint8_t> data, bool last) noexcept {
  SdoBytes bytes{static_cast<std::uint8_t>(sequence | (last ? 0x80 : 0))};
  std::copy_n(data.begin(), std::min<std::size_t>(data.size(), kSegmentData), bytes.begin() + 1);
  return bytes;
}
SdoBytes confirm(std::uint8_t sequence, std::uint8_t block_size) noexcept {
  return {kUpload | 0x02, sequence, block_size};
}
SdoBytes end(std::uint8_t unused, std::uint16_t crc) noexcept {
  return {static_cast<std::uint8_t>(kDownload | unused << 2 | 0x01), static_cast<std::uint8_t>(crc),
          static_cast<std::uint8_t>(crc >> 8)};
}
SdoBytes end_confirm() noexcept { return {kUpload | 0x01}; }

// The side with the data speaks with specifier 6 (initiate, end), the side that takes it with 5; only the
// client's upload request, start and the server's download answers are of the latter.
BlockFrame parse(std::span<const std::uint8_t> bytes, bool download, bool from_client) noexcept {
  BlockFrame f;
  if (bytes.size() != 8) return f;
  const bool has_data = download == from_client;
  if ((bytes[0] & 0xE0) != (has_data ? kDownload : kUpload)) return f;
  const unsigned sub = has_data ? bytes[0] & 0x01u : bytes[0] & 0x03u;
  if (has_data && sub == 1) {
    f.command = BlockCommand::end;
    f.unused = static_cast<std::uint8_t>(bytes[0] >> 2 & 7);
    f.crc = static_cast<std::uint16_t>(load_le(bytes.subspan(1, 2)));
  } else if (sub == 0) {
    f.command = BlockCommand::initiate;
    f.index = static_cast<std::uint16_t>(load_le(bytes.subspan(1, 2)));
    f.subindex = bytes[3];
    f.crc_supported = bytes[0] & 0x04;
    f.size_indicated = has_data && (bytes[0] & 0x02);
    if (f.size_indicated) f.total = static_cast<std::uint32_t>(load_le(bytes.subspan(4, 4)));
    if (!has_data) f.block_size = bytes[4];
    if (!has_data && from_client) f.switch_threshold = bytes[5];
  } else if (sub == 1) {
    f.command = BlockCommand::end;
  } else if (sub == 2) {
    f.command = BlockCommand::confirm;
    f.sequence = bytes[1];
    f.block_size = bytes[2];
  } else if (from_client) {
    f.command = BlockCommand::start;
  }
  return f;
}

}  // namespace sdo_block
}  // namespace servogate::canopen
