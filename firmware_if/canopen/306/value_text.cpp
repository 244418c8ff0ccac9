// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/306/value_text.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdio>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/306/ini.hpp"
#include "firmware_if/text/hex.hpp"

namespace servogate::canopen {

namespace {

constexpr std::uint16_t kBoolean = 0x01, kText = 0x09, kOctets = 0x0A, kDomain = 0x0F, kReal32 = 0x08,
                        kReal64 = 0x11;

constexpr ValueType kTypes[] = {
    {"bool", kBoolean},  {"i8", 0x02},  {"i16", 0x03},    {"i32", 0x04},  {"u8", 0x05},
    {"u16", 0x06},       {"u32", 0x07}, {"f32", kReal32}, {"str", kText}, {"hex", kOctets},
    {"domain", kDomain}, {"i24", 0x10}, {"f64", kReal64}, {"i40", 0x12},  {"i48", 0x13},
    {"i56", 0x14},       {"i64", 0x15}, {"u24", 0x16},    {"u40", 0x18},  {"u48", 0x19},
    {"u56", 0x1A},       {"u64", 0x1B},
};

std::optional<unsigned> hexadecimal(std::string_view text) {
  if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  if (text.ends_with('h') || text.ends_with('H')) text.remove_suffix(1);
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

bool printable(std::span<const std::uint8_t> bytes) {
  // A device may end its text with zeros.
  while (!bytes.empty() && bytes.back() == 0) bytes = bytes.first(bytes.size() - 1);
  return !bytes.empty() &&
         std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b >= 0x20 && b != 0x7F; });
}

struct Integer {
  bool negative = false;
  std::uint64_t magnitude = 0;
};
std::optional<Integer> integer(std::string_view text) {
  Integer out;
  if (text.starts_with('-') || text.starts_with('+')) {
    out.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.ends_with('h') || text.ends_with('H')) {
    base = 16;
    text.remove_suffix(1);
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.magnitude, base);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return out;
}

std::vector<std::uint8_t> little_endian(std::uint64_t value, std::size_t bytes) {
  std::vector<std::uint8_t> out(bytes);
  store_le(value, out);
  return out;
}

std::optional<std::vector<std::uint8_t>> encode_integer(std::string_view text, std::uint16_t type) {
  const auto number = integer(text);
  if (!number) return std::nullopt;
  const auto bits = static_cast<unsigned>(eds_type_bits(type));
  const bool is_signed = eds_type_signed(type);
  const std::uint64_t half = std::uint64_t{1} << (bits - 1);
  const std::uint64_t most = is_signed ? half - 1 : half + (half - 1);
  if (number->magnitude > (number->negative ? (is_signed ? half : 0) : most)) return std::nullopt;
  const std::uint64_t value = number->negative ? 0 - number->magnitude : number->magnitude;
  return little_endian(value, std::max(1U, bits / 8));
}

std::optional<std::vector<std::uint8_t>> encode_real(std::string_view text, bool wide) {
  const char* last = text.data() + text.size();
  if (wide) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc{} || end != last) return std::nullopt;
    return little_endian(std::bit_cast<std::uint64_t>(value), 8);
  }
  float value = 0.0F;
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc{} || end != last) return std::nullopt;
  return little_endian(std::bit_cast<std::uint32_t>(value), 4);
}

std::optional<std::vector<std::uint8_t>> encode_bytes(std::string_view text) {
  std::vector<std::uint8_t> out;
  int high = -1;
  for (const char c : text) {
    if (c == ' ' || c == ':' || c == '.') continue;
    const auto nibble = hexadecimal(std::string_view(&c, 1));
    if (!nibble || c == 'h' || c == 'H') return std::nullopt;
    if (high < 0) {
      high = static_cast<int>(*nibble);
    } else {
      out.push_back(static_cast<std::uint8_t>(high << 4 | static_cast<int>(*nibble)));
      high = -1;
    }
  }
  if (high >= 0) return std::nullopt;
  return out;
}

/// The bytes are a number of this type.
bool fits(std::span<const std::uint8_t> bytes, const ValueType& type) {
  const auto bits = static_cast<std::size_t>(eds_type_bits(type.data_type));
  return bits > 0 && bytes.size() == std::max<std::size_t>(1, bits / 8);
}

/// A line "key=value" of a data sheet gives it back unchanged.
bool fits_a_line(std::string_view text) {
  const auto plain = [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F; };
  if (text.empty()) return true;
  return valid_utf8(text) && std::all_of(text.begin(), text.end(), plain) && text.front() != ' ' &&
         text.back() != ' ' && !(text.size() >= 2 && text.front() == '"' && text.back() == '"');
}

/// The fewest digits that are read back as the same number.
template <class Real>
std::string shortest(Real value) {
  char digits[40];
  const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
  return {digits, end};
}

}  // namespace

bool is_text(const ValueType& type) { return type.data_type == kText; }
bool is_bytes(const ValueType& type) {
  return type.data_type == kOctets || type.data_type == kDomain || type.data_type == 0;
}

double real_of(std::span<const std::uint8_t> bytes) {
  const std::uint64_t raw = load_le(bytes);
  return bytes.size() == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)))
                           : std::bit_cast<double>(raw);
}

std::int64_t signed_of(std::span<const std::uint8_t> bytes) {
  return sign_extend(load_le(bytes), static_cast<std::uint32_t>(8 * bytes.size()));
}

std::string text_of(std::span<const std::uint8_t> bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  std::string as_it_is(bytes.begin(), end), text;
  if (valid_utf8(as_it_is)) return as_it_is;
  for (const char c : as_it_is) {
    const auto b = static_cast<unsigned char>(c);
    if (b < 0x80)
      text += c;
    else
      (text += static_cast<char>(0xC0 | b >> 6)) += static_cast<char>(0x80 | (b & 0x3F));
  }
  return text;
}

std::optional<ObjectAddress> parse_address(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto index = hexadecimal(text.substr(0, colon));
  const auto subindex =
      colon == std::string_view::npos ? std::optional<unsigned>(0) : hexadecimal(text.substr(colon + 1));
  if (!index || !subindex || *index > 0xFFFF || *subindex > 0xFF) return std::nullopt;
  return ObjectAddress{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*subindex)};
}

std::string address_text(std::uint16_t index, std::uint8_t subindex) {
  char text[16];
  std::snprintf(text, sizeof text, "%04Xh:%02X", index, subindex);
  return text;
}

const ValueType* type_named(std::string_view word) {
  const auto found =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& t) { return t.name == word; });
  return found == std::end(kTypes) ? nullptr : found;
}

const ValueType* type_numbered(std::uint16_t data_type) {
  // UNICODE_STRING, TIME_OF_DAY, TIME_DIFFERENCE
  if (data_type >= 0x0B && data_type <= 0x0D) data_type = kOctets;
  const auto found = std::find_if(std::begin(kTypes), std::end(kTypes),
                                  [&](const auto& t) { return t.data_type == data_type; });
  return found == std::end(kTypes) ? nullptr : found;
}

std::string type_words() {
  std::string words;
  for (const ValueType& t : kTypes) words += (words.empty() ? "" : ", ") + std::string(t.name);
  return words;
}

std::optional<std::vector<std::uint8_t>> encode_value(std::string_view text, const ValueType& type) {
  if (is_text(type)) return std::vector<std::uint8_t>(text.begin(), text.end());
  if (is_bytes(type)) return encode_bytes(text);
  if (eds_type_real(type.data_type)) return encode_real(text, type.data_type == kReal64);
  if (type.data_type == kBoolean) {
    if (text == "true" || text == "TRUE") text = "1";
    if (text == "false" || text == "FALSE") text = "0";
    if (text != "0" && text != "1") return std::nullopt;
    return little_endian(text == "1" ? 1 : 0, 1);
  }
  return encode_integer(text, type.data_type);
}

std::string hex_text(std::span<const std::uint8_t> bytes, const char* between) {
  return text::hex_bytes(bytes, between);
}

bool may_be(std::span<const std::uint8_t> bytes, const ValueType& type) {
  return eds_type_bits(type.data_type) == 0 || fits(bytes, type);
}

std::string show_value(std::span<const std::uint8_t> bytes, const ValueType* type) {
  if (type != nullptr && is_text(*type)) return "\"" + text_of(bytes) + "\"";
  if (type == nullptr || is_bytes(*type) || !fits(bytes, *type)) return hex_text(bytes, " ");
  if (eds_type_real(type->data_type))
    return bytes.size() == 4 ? shortest(static_cast<float>(real_of(bytes))) : shortest(real_of(bytes));
  char hexadecimal_digits[24];
  std::snprintf(hexadecimal_digits, sizeof hexadecimal_digits, "%0*llXh", static_cast<int>(2 * bytes.size()),
                static_cast<unsigned long long>(load_le(bytes)));
  const std::string number =
      eds_type_signed(type->data_type) ? std::to_string(signed_of(bytes)) : std::to_string(load_le(bytes));
  return number + " (" + hexadecimal_digits + ")";
}

std::optional<std::string> eds_value_text(std::span<const std::uint8_t> bytes, std::uint16_t data_type) {
  const ValueType* type = type_numbered(data_type);
  if (type != nullptr && is_text(*type)) {
    while (!bytes.empty() && bytes.back() == 0) bytes = bytes.first(bytes.size() - 1);
    std::string text(bytes.begin(), bytes.end());
    return fits_a_line(text) ? std::optional(std::move(text)) : std::nullopt;
  }
  if (bytes.empty()) return eds_type_string(data_type) ? std::optional(std::string()) : std::nullopt;
  if (type == nullptr || is_bytes(*type) || !fits(bytes, *type)) return hex_text(bytes);
  if (eds_type_real(data_type))
    return bytes.size() == 4 ? shortest(static_cast<float>(real_of(bytes))) : shortest(real_of(bytes));
  if (eds_type_signed(data_type)) return std::to_string(signed_of(bytes));
  char digits[24];
  std::snprintf(digits, sizeof digits, "0x%0*llX", static_cast<int>(2 * bytes.size()),
                static_cast<unsigned long long>(load_le(bytes)));
  return digits;
}

const ValueType* guess_type(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > 4 && printable(bytes)) return type_named("str");
  switch (bytes.size()) {
    case 1:
      return type_named("u8");
    case 2:
      return type_named("u16");
    case 4:
      return type_named("u32");
    case 8:
      return type_named("u64");
    default:
      return printable(bytes) ? type_named("str") : type_named("hex");
  }
}

}  // namespace servogate::canopen
