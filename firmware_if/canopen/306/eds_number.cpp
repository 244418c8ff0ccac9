// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/306/eds_number.hpp"

#include <charconv>
#include <cstdio>

namespace servogate::canopen {
namespace {

constexpr bool digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
constexpr bool hex_digit(char c) noexcept { return digit(c) || (lower(c) >= 'a' && lower(c) <= 'f'); }

/// Takes terms off the front of a text.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}
  NumberOddity oddity() const noexcept { return oddity_; }

  void blanks() noexcept {
    while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\t')) rest_.remove_prefix(1);
  }
  bool empty() const noexcept { return rest_.empty(); }
  bool word(std::string_view expected) noexcept {
    if (rest_.size() < expected.size()) return false;
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (lower(rest_[i]) != expected[i]) return false;
    rest_.remove_prefix(expected.size());
    return true;
  }
  bool node_id() noexcept {
    if (word("$nodeid")) return true;
    if (!word("nodeid") && !word("$node_id")) return false;
    note(NumberOddity::node_id_sign);
    return true;
  }
  bool boolean(std::int64_t& value) noexcept {
    for (const std::string_view yes : {"true", "yes"})
      if (word(yes)) return value = 1, note(NumberOddity::boolean_word), true;
    for (const std::string_view no : {"false", "no"})
      if (word(no)) return value = 0, note(NumberOddity::boolean_word), true;
    return false;
  }
  bool number(std::int64_t& value) noexcept {
    const bool negative = word("-");
    blanks();
    std::uint64_t magnitude = 0;
    if (!(word("0x") ? digits(16, magnitude) : hex_with_suffix(magnitude) || decimal(magnitude)))
      return false;
    value = static_cast<std::int64_t>(negative ? 0 - magnitude : magnitude);
    return true;
  }
  void note(NumberOddity oddity) noexcept {
    if (oddity_ == NumberOddity::none) oddity_ = oddity;
  }

 private:
  bool digits(int base, std::uint64_t& value) noexcept {
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value, base);
    if (error != std::errc{}) return false;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return true;
  }
  bool hex_with_suffix(std::uint64_t& value) noexcept {
    std::size_t n = 0;
    while (n < rest_.size() && hex_digit(rest_[n])) ++n;
    if (n == 0 || n >= rest_.size() || lower(rest_[n]) != 'h') return false;
    if (!digits(16, value)) return false;
    rest_.remove_prefix(1);
    note(NumberOddity::hex_suffix);
    return true;
  }
  bool decimal(std::uint64_t& value) noexcept {
    if (rest_.size() > 1 && rest_[0] == '0' && digit(rest_[1])) note(NumberOddity::leading_zeros);
    return digits(10, value);
  }

  std::string_view rest_;
  NumberOddity oddity_ = NumberOddity::none;
};

}  // namespace

std::optional<ParsedNumber> parse_eds_number(std::string_view text) {
  Reader reader(text);
  ParsedNumber result;
  bool any = false;
  for (bool more = true; more;) {
    reader.blanks();
    if (any) reader.word("+"), reader.blanks();
    std::int64_t value = 0;
    if (!result.number.plus_node && reader.node_id()) {
      result.number.plus_node = true;
    } else if (reader.number(value) || (!any && reader.boolean(value))) {
      result.number.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(result.number.value) +
                                                      static_cast<std::uint64_t>(value));
    } else {
      more = false;
    }
    any |= more;
  }
  if (!any) return std::nullopt;
  if (!reader.empty()) reader.note(NumberOddity::trailing_text);
  result.oddity = reader.oddity();
  return result;
}

std::string eds_number_text(const EdsNumber& number) {
  char buffer[40];
  if (number.value < 0)
    std::snprintf(buffer, sizeof buffer, "%lld", static_cast<long long>(number.value));
  else
    std::snprintf(buffer, sizeof buffer, "0x%llX", static_cast<unsigned long long>(number.value));
  return number.plus_node ? std::string("$NODEID+") + buffer : buffer;
}

}  // namespace servogate::canopen
