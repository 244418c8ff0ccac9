// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/message_pack.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <string_view>

namespace servogate::usercan {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Format bytes. Source: MessagePack specification, "Formats".
constexpr std::uint8_t kNil = 0xC0, kFalse = 0xC2, kTrue = 0xC3, kBin8 = 0xC4, kBin32 = 0xC6, kExt8 = 0xC7,
                       kExt32 = 0xC9, kFloat32 = 0xCA, kFloat64 = 0xCB, kUint8 = 0xCC, kUint32 = 0xCE,
                       kUint64 = 0xCF, kInt8 = 0xD0, kInt64 = 0xD3, kFixExt1 = 0xD4, kFixExt16 = 0xD8,
                       kStr8 = 0xD9, kStr32 = 0xDB, kArray16 = 0xDC, kArray32 = 0xDD, kMap16 = 0xDE,
                       kMap32 = 0xDF, kFixMap = 0x80, kFixStr = 0xA0;
constexpr int kDeepest = 4;

class Writer {
 public:
  explicit Writer(std::span<std::uint8_t, kMaxPacket> out) noexcept : out_(out) {}
  void byte(std::uint8_t b) noexcept {
    if (size_ < out_.size()) out_[size_++] = b;
  }
  void big_endian(std::uint64_t value, int bytes) noexcept {
    for (int i = bytes - 1; i >= 0; --i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void text(std::string_view t) noexcept {
    byte(static_cast<std::uint8_t>(kFixStr | t.size()));
    for (const char c : t) byte(static_cast<std::uint8_t>(c));
  }
  void flag(std::string_view key, bool value) noexcept {
    text(key);
    byte(value ? kTrue : kFalse);
  }
  void number(std::string_view key, std::uint32_t value) noexcept {
    text(key);
    if (value < 0x80) return byte(static_cast<std::uint8_t>(value));
    byte(kUint32);
    big_endian(value, 4);
  }
  std::size_t size() const noexcept { return size_; }

 private:
  std::span<std::uint8_t, kMaxPacket> out_;
  std::size_t size_ = 0;
};

/// One value of a message, as far as a frame needs it.
struct Value {
  enum class Kind : std::uint8_t { nothing, number, real, bytes, map } kind = Kind::nothing;
  std::uint64_t number = 0;
  Bytes bytes;
};

class Reader {
 public:
  explicit Reader(Bytes bytes) noexcept : rest_(bytes) {}

  /// Elements of the map that begins here; nullopt: no map begins here.
  std::optional<std::size_t> map() noexcept {
    const Value v = value(0, true);
    return v.kind == Value::Kind::map && good_ ? std::optional(static_cast<std::size_t>(v.number))
                                               : std::nullopt;
  }
  Value value() noexcept { return value(0, false); }
  bool good() const noexcept { return good_; }

 private:
  std::uint64_t big_endian(std::size_t bytes) noexcept {
    std::uint64_t v = 0;
    for (const std::uint8_t b : take(bytes)) v = v << 8 | b;
    return v;
  }
  Bytes take(std::uint64_t bytes) noexcept {
    if (bytes > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const Bytes taken = rest_.first(static_cast<std::size_t>(bytes));
    rest_ = rest_.subspan(static_cast<std::size_t>(bytes));
    return taken;
  }
  Value skip(std::uint64_t values, int depth) noexcept {
    if (depth == kDeepest) good_ = false;
    for (std::uint64_t i = 0; i < values && good_; ++i) value(depth + 1, false);
    return {};
  }
  static Value number(std::uint64_t n) noexcept { return {Value::Kind::number, n, {}}; }
  Value sized(Bytes b) noexcept { return {Value::Kind::bytes, 0, b}; }
  Value map_of(std::uint64_t pairs, int depth, bool enter) noexcept {
    if (enter) return {Value::Kind::map, pairs, {}};
    return skip(2 * pairs, depth);
  }

  Value value(int depth, bool enter) noexcept {
    const Bytes head = take(1);
    if (head.empty()) return {};
    const std::uint8_t f = head[0];
    if (f < 0x80) return number(f);
    if (f < 0x90) return map_of(f & 0xFu, depth, enter);
    if (f < 0xA0) return skip(f & 0xFu, depth);
    if (f < 0xC0) return sized(take(f & 0x1Fu));
    if (f >= 0xE0) return number(static_cast<std::uint64_t>(static_cast<std::int8_t>(f)));
    if (f == kNil || f == kFalse || f == kTrue) return number(f == kTrue ? 1 : 0);
    if (f >= kBin8 && f <= kBin32) return sized(take(big_endian(std::size_t{1} << (f - kBin8))));
    if (f >= kStr8 && f <= kStr32) return sized(take(big_endian(std::size_t{1} << (f - kStr8))));
    if (f >= kUint8 && f <= kUint64) return number(big_endian(std::size_t{1} << (f - kUint8)));
    if (f >= kInt8 && f <= kInt64) return number(big_endian(std::size_t{1} << (f - kInt8)));
    if (f == kFloat32 || f == kFloat64) return {Value::Kind::real, big_endian(f == kFloat32 ? 4 : 8), {}};
    if (f >= kExt8 && f <= kExt32) return sized(take(big_endian(std::size_t{1} << (f - kExt8)) + 1));
    if (f >= kFixExt1 && f <= kFixExt16) return sized(take((std::size_t{1} << (f - kFixExt1)) + 1));
    if (f == kArray16 || f == kArray32) return skip(big_endian(f == kArray16 ? 2 : 4), depth);
    if (f == kMap16 || f == kMap32) return map_of(big_endian(f == kMap16 ? 2 : 4), depth, enter);
    good_ = false;
    return {};
  }

  Bytes rest_;
  bool good_ = true;
};

}  // namespace

std::size_t pack(const image::CanFrame& frame, double timestamp_s,
                 std::span<std::uint8_t, kMaxPacket> out) noexcept {
  Writer w(out);
  w.byte(kFixMap | 11);
  w.text("timestamp");
  w.byte(kFloat64);
  w.big_endian(std::bit_cast<std::uint64_t>(timestamp_s), 8);
  w.number("arbitration_id", frame.id);
  w.flag("is_extended_id", frame.extended);
  w.flag("is_remote_frame", frame.remote);
  w.flag("is_error_frame", frame.error);
  w.text("channel");
  w.byte(kNil);
  w.number("dlc", frame.length);
  w.text("data");
  const std::uint8_t size = frame.remote ? std::uint8_t{0} : std::min<std::uint8_t>(frame.length, 64);
  w.byte(kBin8);
  w.byte(size);
  for (std::size_t i = 0; i < size; ++i) w.byte(frame.data[i]);
  w.flag("is_fd", frame.fd);
  w.flag("bitrate_switch", frame.fd && (frame.fd_flags & image::kBitRateSwitch) != 0);
  w.flag("error_state_indicator", frame.fd && (frame.fd_flags & image::kErrorStateIndicator) != 0);
  return w.size();
}

bool unpack(std::span<const std::uint8_t> bytes, image::CanFrame& frame) noexcept {
  frame = {};
  Reader reader(bytes);
  const auto pairs = reader.map();
  if (!pairs) return false;
  bool identified = false;
  for (std::size_t i = 0; i < *pairs && reader.good(); ++i) {
    const Value key = reader.value();
    const Value v = reader.value();
    const std::string_view name(reinterpret_cast<const char*>(key.bytes.data()), key.bytes.size());
    const bool on = v.number != 0;
    if (name == "arbitration_id" && v.kind == Value::Kind::number) {
      frame.id = static_cast<std::uint32_t>(v.number);
      identified = v.number <= 0x1FFF'FFFF;
    }
    if (name == "is_extended_id") frame.extended = on;
    if (name == "is_remote_frame") frame.remote = on;
    if (name == "is_error_frame") frame.error = on;
    if (name == "is_fd") frame.fd = on;
    if (name == "bitrate_switch" && on) frame.fd_flags |= image::kBitRateSwitch;
    if (name == "error_state_indicator" && on) frame.fd_flags |= image::kErrorStateIndicator;
    if (name == "dlc") frame.length = static_cast<std::uint8_t>(std::min<std::uint64_t>(v.number, 64));
    if (name == "data") {
      if (v.bytes.size() > frame.data.size()) return false;
      std::copy(v.bytes.begin(), v.bytes.end(), frame.data.begin());
    }
  }
  if (!frame.fd) frame.fd_flags = 0;
  return identified && reader.good() && (frame.fd || frame.length <= 8);
}

}  // namespace servogate::usercan
