// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/socketcand_text.hpp"

#include <algorithm>
#include <charconv>

namespace servogate::usercan {
namespace {

template <typename T>
bool number(std::string_view word, int base, T& value) noexcept {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  return error == std::errc{} && end == word.data() + word.size() && !word.empty();
}

bool identifier(std::string_view word, image::CanFrame& frame) noexcept {
  constexpr std::size_t kWhole = 8, kBase = 3;
  if (word.size() > kWhole || !number(word, 16, frame.id) || frame.id > 0x1FFF'FFFF) return false;
  frame.extended = word.size() > kBase;
  if (!frame.extended) return frame.id <= 0x7FF;
  return word.size() == kWhole || word.front() != '0';
}

void add_identifier(Element& e, const image::CanFrame& frame) noexcept {
  e.add_hex(frame.id, frame.extended ? 8 : 3);
}

}  // namespace

std::string_view Words::next() noexcept {
  const std::size_t begin = rest_.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return rest_ = {};
  const std::size_t end = std::min(rest_.find_first_of(" \t\r\n", begin), rest_.size());
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_ = rest_.substr(end);
  return word;
}

std::optional<std::string_view> find_element(std::string_view bytes, std::size_t& taken) noexcept {
  const std::size_t end = bytes.find('>');
  taken = 0;
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t begin = bytes.substr(0, end).rfind('<');
  taken = end + 1;
  if (begin == std::string_view::npos) return std::string_view{};
  return bytes.substr(begin + 1, end - begin - 1);
}

bool read_send(Words words, bool remote, image::CanFrame& frame) noexcept {
  frame = {};
  frame.remote = remote;
  if (!identifier(words.next(), frame)) return false;
  if (!number(words.next(), 16, frame.length) || frame.length > 8) return false;
  for (int i = 0; i < frame.length && !remote; ++i)
    if (!number(words.next(), 16, frame.data[static_cast<std::size_t>(i)])) return false;
  return words.next().empty();
}

bool read_frame(Words words, bool remote, image::CanFrame& frame) noexcept {
  frame = {};
  frame.remote = remote;
  if (!identifier(words.next(), frame)) return false;
  const std::string_view time = words.next();
  const std::size_t point = std::min(time.find('.'), time.size());
  std::int64_t seconds = 0, micro = 0;
  if (!number(time.substr(0, point), 10, seconds)) return false;
  if (point < time.size()) {
    const std::string_view fraction = time.substr(point + 1);
    if (!number(fraction, 10, micro) || fraction.size() > 6) return false;
    for (std::size_t i = fraction.size(); i < 6; ++i) micro *= 10;
  }
  frame.timestamp_ns = seconds * image::kSecond + micro * image::kMicrosecond;
  if (remote) return number(words.next(), 16, frame.length) && frame.length <= 8;
  // Bytes in one word or several: both are seen in the wild.
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word.size() % 2 != 0) return false;
    for (; !word.empty(); word = word.substr(2))
      if (frame.length == 8 || !number(word.substr(0, 2), 16, frame.data[frame.length++])) return false;
  }
  return true;
}

LockstepWake lockstep_wake(std::string_view word) noexcept {
  return word == "frames" ? LockstepWake::frames : word == "wish" ? LockstepWake::wish : LockstepWake::any;
}

std::optional<std::int64_t> read_number(std::string_view word) noexcept {
  std::int64_t value = 0;
  return number(word, 10, value) ? std::optional(value) : std::nullopt;
}

void Element::add(std::string_view text) noexcept {
  const std::size_t room = std::min(text.size(), text_.size() - size_);
  std::copy_n(text.begin(), room, text_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += room;
}

void Element::add_number(std::int64_t value, int digits) noexcept {
  std::array<char, 24> text;
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  for (auto size = end - text.data(); size < digits; ++size) add("0");
  add({text.data(), static_cast<std::size_t>(end - text.data())});
}

void Element::add_hex(std::uint64_t value, int digits) noexcept {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) add(kDigits.substr(value >> shift & 0xF, 1));
}

Element send_element(const image::CanFrame& frame) noexcept {
  Element e;
  e.add(frame.remote ? "< remote " : "< send ");
  add_identifier(e, frame);
  e.add(" ");
  e.add_hex(frame.length, 1);
  for (std::size_t i = 0; i < frame.length && i < 8 && !frame.remote; ++i) {
    e.add(" ");
    e.add_hex(frame.data[i], 2);
  }
  e.add(" >");
  return e;
}

Element frame_element(const image::CanFrame& frame, image::Nanoseconds time) noexcept {
  Element e;
  e.add(frame.remote ? " < remote " : " < frame ");
  add_identifier(e, frame);
  e.add(" ");
  e.add_number(time / image::kSecond);
  e.add(".");
  e.add_number(time % image::kSecond / image::kMicrosecond, 6);
  e.add(" ");
  if (frame.remote) e.add_hex(frame.length, 1);
  for (std::size_t i = 0; i < frame.length && i < 8 && !frame.remote; ++i) e.add_hex(frame.data[i], 2);
  e.add(" >");
  return e;
}

}  // namespace servogate::usercan
