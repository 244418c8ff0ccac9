// SPDX-License-Identifier: Apache-2.0
#include "drivers/candump/candump_line.hpp"

#include <charconv>
#include <cstdio>

namespace servogate::candump {
namespace {

constexpr std::uint32_t kErrorFlag = 0x2000'0000, kExtendedMask = 0x1FFF'FFFF;

template <typename T>
bool number(std::string_view text, int base, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return !text.empty() && error == std::errc{} && end == text.data() + text.size();
}

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = std::min(rest.find_first_not_of(" \t\r"), rest.size());
  const std::size_t end = std::min(rest.find_first_of(" \t\r", begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest = rest.substr(end);
  return word;
}

/// "(seconds.fraction)"
bool read_time(std::string_view word, image::Nanoseconds& time) {
  if (word.size() < 3 || word.front() != '(' || word.back() != ')') return false;
  word = word.substr(1, word.size() - 2);
  const std::size_t point = std::min(word.find('.'), word.size());
  std::int64_t seconds = 0, fraction = 0;
  if (!number(word.substr(0, point), 10, seconds) || seconds < 0 || seconds > 9'000'000'000) return false;
  if (point < word.size()) {
    const std::string_view digits = word.substr(point + 1);
    if (digits.size() > 9 || digits.front() == '-' || !number(digits, 10, fraction)) return false;
    for (std::size_t i = digits.size(); i < 9; ++i) fraction *= 10;
  }
  time = seconds * image::kSecond + fraction;
  return true;
}

bool read_identifier(std::string_view digits, image::CanFrame& frame) {
  std::uint32_t id = 0;
  if ((digits.size() != 3 && digits.size() != 8) || !number(digits, 16, id)) return false;
  frame.error = digits.size() == 8 && (id & kErrorFlag) != 0;
  frame.extended = digits.size() == 8 && !frame.error;
  frame.id = id & (digits.size() == 8 ? kExtendedMask : 0x7FFu);
  return digits.size() == 8 ? (id & ~(kErrorFlag | kExtendedMask)) == 0 : id <= 0x7FF;
}

bool read_data(std::string_view data, image::CanFrame& frame) {
  if (!frame.fd && data.starts_with('R')) {
    frame.remote = true;
    return data.size() == 1 || (number(data.substr(1), 16, frame.length) && frame.length <= 8);
  }
  const std::size_t most = frame.fd ? 64 : 8;
  for (; data.size() >= 2; data = data.substr(2)) {
    if (data.front() == '.') data = data.substr(1);
    if (frame.length == most || !number(data.substr(0, 2), 16, frame.data[frame.length++])) return false;
  }
  return data.empty();
}

}  // namespace

std::string format(const image::CanFrame& f, image::Nanoseconds time, std::string_view bus) {
  char text[64];
  const std::uint32_t id = f.error ? f.id | kErrorFlag : f.id;
  std::snprintf(text, sizeof text, "(%010lld.%06lld) ", static_cast<long long>(time / image::kSecond),
                static_cast<long long>(time % image::kSecond / image::kMicrosecond));
  std::string line = text;
  line += bus;
  std::snprintf(text, sizeof text, f.extended || f.error ? " %08X#" : " %03X#", id);
  line += text;
  if (f.fd) line += {'#', "0123456789ABCDEF"[f.fd_flags & 0xF]};
  if (f.remote) line += f.length > 0 ? "R" + std::to_string(f.length) : "R";
  for (std::size_t i = 0; i < f.length && i < f.data.size() && !f.remote; ++i) {
    std::snprintf(text, sizeof text, "%02X", f.data[i]);
    line += text;
  }
  return line;
}

std::optional<Line> parse(std::string_view text) {
  Line line;
  if (!read_time(next_word(text), line.time)) return std::nullopt;
  line.bus = next_word(text);
  std::string_view frame = next_word(text);
  const std::size_t hash = frame.find('#');
  if (hash == std::string_view::npos || !read_identifier(frame.substr(0, hash), line.frame))
    return std::nullopt;
  frame = frame.substr(hash + 1);
  if (frame.starts_with('#')) {
    line.frame.fd = true;
    if (frame.size() < 2 || !number(frame.substr(1, 1), 16, line.frame.fd_flags)) return std::nullopt;
    line.frame.fd_flags &= image::kBitRateSwitch | image::kErrorStateIndicator;
    frame = frame.substr(2);
  }
  if (!read_data(frame, line.frame)) return std::nullopt;
  line.frame.timestamp_ns = line.time;
  return line;
}

}  // namespace servogate::candump
