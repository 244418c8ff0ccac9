// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware_if/canopen/301/cob_id.hpp"

namespace servogate::canopen {

/// A number of an EDS, which may depend on the node-ID: `value`, plus the node-ID where `plus_node`.
struct EdsNumber {
  std::int64_t value = 0;  ///< an UNSIGNED64 beyond 2^63 - 1 by its bits
  bool plus_node = false;
  bool operator==(const EdsNumber&) const = default;
  constexpr std::int64_t at(NodeId node) const noexcept { return value + (plus_node ? node : 0); }
};

/// What was odd about a number and yet understood.
enum class NumberOddity : std::uint8_t {
  none,
  leading_zeros,  ///< 0010: read as decimal, where CiA 306 has octal
  hex_suffix,     ///< 1A00h
  node_id_sign,   ///< NODEID without $
  boolean_word,   ///< TRUE, yes
  trailing_text,  ///< "5 ms": what follows the number was left out
};
struct ParsedNumber {
  EdsNumber number;
  NumberOddity oddity = NumberOddity::none;
};

/// Reads decimal, 0x hexadecimal, $NODEID and sums of the two in any order and case, with blanks anywhere.
/// nullopt: no number in it. Source: CiA 306-1, 4.5 "Number formats" and "$NODEID".
std::optional<ParsedNumber> parse_eds_number(std::string_view text);

/// "0x1A00", "$NODEID+0x180"; negative numbers in decimal.
std::string eds_number_text(const EdsNumber& number);

}  // namespace servogate::canopen
