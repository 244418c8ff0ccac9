// SPDX-License-Identifier: Apache-2.0
#include "drivers/slcan/line.hpp"

#include <charconv>
#include <iterator>
#include <utility>

namespace servogate::slcan {
namespace {

constexpr std::uint32_t kRates[] = {10'000,  20'000,  50'000,  100'000,  125'000,
                                    250'000, 500'000, 800'000, 1'000'000};
constexpr std::size_t kStandardDigits = 3, kExtendedDigits = 8;
constexpr std::uint32_t kLargestStandard = 0x7FF, kLargestExtended = 0x1FFF'FFFF;

char digit(std::uint32_t value) noexcept { return "0123456789ABCDEF"[value & 0xF]; }

/// A number of hexadecimal digits and nothing else.
std::optional<std::uint32_t> number(std::string_view text) noexcept {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Behind the data a time stamp of four digits may stand.
bool read_frame(std::string_view line, image::CanFrame& f) noexcept {
  const char kind = line.front();
  f.extended = kind == 'T' || kind == 'R';
  f.remote = kind == 'r' || kind == 'R';
  const std::size_t digits = f.extended ? kExtendedDigits : kStandardDigits;
  if (line.size() < 1 + digits + 1) return false;
  const auto id = number(line.substr(1, digits));
  const auto length = number(line.substr(1 + digits, 1));
  if (!id || !length || *id > (f.extended ? kLargestExtended : kLargestStandard) || *length > 8) return false;
  f.id = *id;
  f.length = static_cast<std::uint8_t>(*length);
  const std::string_view data = line.substr(1 + digits + 1);
  const std::size_t bytes = f.remote ? 0 : f.length;
  if (data.size() != 2 * bytes && data.size() != 2 * bytes + 4) return false;
  for (std::size_t i = 0; i < bytes; ++i) {
    const auto byte = number(data.substr(2 * i, 2));
    if (!byte) return false;
    f.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

Answer answer_of(std::string_view line) noexcept {
  Answer a;
  if (line.empty()) {
    a.kind = Answer::Kind::done;
    return a;
  }
  switch (line.front()) {
    case 'z':
    case 'Z':
      if (line.size() == 1) a.kind = Answer::Kind::sent;
      break;
    case 't':
    case 'T':
    case 'r':
    case 'R':
      if (read_frame(line, a.frame)) a.kind = Answer::Kind::frame;
      break;
    case 'F':
      if (const auto flags = number(line.substr(1)); flags && line.size() == 3) {
        a.kind = Answer::Kind::flags;
        a.flags = static_cast<std::uint8_t>(*flags);
      }
      break;
    default:
      break;
  }
  return a;
}

}  // namespace

std::size_t encode(const image::CanFrame& frame, std::span<char> out) noexcept {
  if (frame.error || frame.fd || frame.length > 8 || out.size() < kLongestFrame) return 0;
  std::size_t n = 0;
  const char kind = frame.remote ? 'r' : 't';
  out[n++] = frame.extended ? static_cast<char>(kind - 'a' + 'A') : kind;
  for (std::size_t left = frame.extended ? kExtendedDigits : kStandardDigits; left-- > 0;)
    out[n++] = digit(frame.id >> (4 * left));
  out[n++] = digit(frame.length);
  for (std::size_t i = 0; i < frame.length && !frame.remote; ++i) {
    out[n++] = digit(frame.data[i] >> 4);
    out[n++] = digit(frame.data[i]);
  }
  out[n++] = kEnd;
  return n;
}

std::optional<char> rate_digit(std::uint32_t bit_rate) noexcept {
  for (std::size_t i = 0; i < std::size(kRates); ++i)
    if (kRates[i] == bit_rate) return static_cast<char>('0' + i);
  return std::nullopt;
}

std::optional<Answer> Reader::put(char c) noexcept {
  if (c != kEnd && c != kRefused) {
    if (length_ <= line_.size()) ++length_;  // one more than there is room for: too long
    if (length_ <= line_.size()) line_[length_ - 1] = c;
    return std::nullopt;
  }
  const std::size_t length = std::exchange(length_, 0);
  if (c == kRefused) {
    Answer a;
    a.kind = Answer::Kind::refused;
    return a;
  }
  return length > line_.size() ? Answer{} : answer_of({line_.data(), length});
}

}  // namespace servogate::slcan
