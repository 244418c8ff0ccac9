// SPDX-License-Identifier: Apache-2.0
#include "plc/types/direct_place.hpp"

#include <charconv>

#include "plc/types/type.hpp"

namespace servogate::plc {

using image::Format;
using image::Packet;

std::optional<image::Place> direct_place(std::string_view text) {
  const std::string key = key_of(text);
  if (key.size() < 3 || key[0] != '%') return std::nullopt;
  const char area = key[1];
  if (area != 'I' && area != 'Q' && area != 'M') return std::nullopt;
  std::size_t at = 2;
  char size = 'X';
  if (key[at] >= 'A') size = key[at++];
  const Format format = size == 'X'   ? Format::bl
                        : size == 'B' ? Format::by
                        : size == 'W' ? Format::in
                        : size == 'D' ? Format::li
                                      : Format::lr;
  if (std::string_view("XBWDL").find(size) == std::string_view::npos) return std::nullopt;
  std::uint32_t number = 0, bit = 0;
  const char* end = key.data() + key.size();
  auto [next, error] = std::from_chars(key.data() + at, end, number);
  if (error != std::errc{} || number > 100'000) return std::nullopt;
  if (size == 'X' && next == end) {  // %QX75 and %Q75: the bit of that number (IEC 61131-3:2013, table 16)
    bit = number % 8;
    number /= 8;
  } else if (size == 'X') {
    if (*next != '.') return std::nullopt;
    const auto [last, bit_error] = std::from_chars(next + 1, end, bit);
    if (bit_error != std::errc{} || bit > 7) return std::nullopt;
    next = last;
  }
  if (next != end) return std::nullopt;
  image::Place p{area == 'M' ? Packet::k : Packet::a, format, size == 'X' ? number * 8 + bit : number, 1};
  if (area == 'Q') p.index += size == 'X' ? kOutputBase * 8 : kOutputBase / image::format_size(format);
  return p;
}

}  // namespace servogate::plc
