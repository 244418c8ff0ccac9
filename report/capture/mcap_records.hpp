// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

/// The container format of MCAP files, as far as captures use it. Numbers are little-endian; a record is its
/// kind (1 byte), the length of its content (8 bytes) and the content. Source: MCAP Format Specification
/// (mcap.dev/spec), "Records".
namespace servogate::report::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Kind : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Name of the metadata record that says where a capture comes from, with the period of its rows.
inline constexpr std::string_view kOrigin = "servogate";
inline constexpr std::string_view kPeriod = "period_ns";
/// Topics that are no group of channels: frames of a bus, and what there is to know.
inline constexpr std::string_view kFrames = "/can/", kNotes = "/notes";

/// Content of a record as it grows.
class Content {
 public:
  template <typename T>
  Content& number(T value) {
    for (std::size_t n = 0; n < sizeof(T); ++n)
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * n) & 0xFF);
    return *this;
  }
  /// With its length, 4 bytes.
  Content& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  Content& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  const std::string& bytes() const noexcept { return bytes_; }
  void clear() noexcept { bytes_.clear(); }

 private:
  std::string bytes_;
};

inline void append(std::string& out, Kind kind, std::string_view content) {
  Content head;
  head.number(static_cast<std::uint8_t>(kind)).number(static_cast<std::uint64_t>(content.size()));
  out += head.bytes();
  out += content;
}

}  // namespace servogate::report::mcap
