// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/object_value.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/306/eds.hpp"
#include "firmware_if/canopen/device/communication_objects.hpp"
#include "firmware_if/canopen/device/drive/drive_objects.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::gateway::command {

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

std::string text_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t b : bytes) {
    if (b == 0) break;
    if (b < 0x80)
      text += static_cast<char>(b);
    else  // Latin-1, as in data sheets
      (text += static_cast<char>(0xC0 | b >> 6)) += static_cast<char>(0x80 | (b & 0x3F));
  }
  return text;
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
  canopen::store_le(value, out);
  return out;
}

std::optional<std::vector<std::uint8_t>> encode_integer(std::string_view text, std::uint16_t type) {
  const auto number = integer(text);
  if (!number) return std::nullopt;
  const auto bits = static_cast<unsigned>(canopen::eds_type_bits(type));
  const bool is_signed = canopen::eds_type_signed(type);
  const std::uint64_t half = std::uint64_t{1} << (bits - 1);
  const std::uint64_t most = is_signed ? half - 1 : half + (half - 1);
  if (number->magnitude > (number->negative ? (is_signed ? half : 0) : most)) return std::nullopt;
  const std::uint64_t value = number->negative ? 0 - number->magnitude : number->magnitude;
  return little_endian(value, std::max(1U, bits / 8));
}

std::optional<std::vector<std::uint8_t>> encode_real(std::string_view text, bool wide) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (wide) return little_endian(std::bit_cast<std::uint64_t>(value), 8);
  return little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
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

bool is_text(std::uint16_t type) { return type == kText; }
bool is_bytes(std::uint16_t type) { return type == kOctets || type == kDomain || type == 0; }

double real_of(std::span<const std::uint8_t> bytes) {
  const std::uint64_t raw = canopen::load_le(bytes);
  return bytes.size() == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)))
                           : std::bit_cast<double>(raw);
}

/// The bytes are a number of this type.
bool fits(std::span<const std::uint8_t> bytes, const ValueType& type) {
  const auto bits = static_cast<std::size_t>(canopen::eds_type_bits(type.data_type));
  return bits > 0 && bytes.size() == std::max<std::size_t>(1, bits / 8);
}

std::int64_t signed_of(std::span<const std::uint8_t> bytes) {
  return canopen::sign_extend(canopen::load_le(bytes), static_cast<std::uint32_t>(8 * bytes.size()));
}

const std::vector<canopen::ObjectSpec>& standard_rows() {
  static const std::vector<canopen::ObjectSpec> rows = [] {
    std::vector<canopen::ObjectSpec> all = canopen::communication_objects(1, {});
    const auto drive = canopen::drive_objects({});
    all.insert(all.end(), drive.begin(), drive.end());
    return all;
  }();
  return rows;
}

/// Ranges in which every object is built like its first: SDO and PDO parameters.
std::uint16_t first_of_its_kind(std::uint16_t index) {
  for (const std::uint16_t first : {0x1400, 0x1600, 0x1800, 0x1A00})
    if (index >= first && index < first + 0x200) return first;
  if (index >= 0x1200 && index < 0x1280) return 0x1200;
  // The second to eighth axis of a drive. Source: CiA 402-1, "Multiple axes".
  if (index >= 0x6800 && index < 0xA000) return static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  return index;
}

}  // namespace

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
  if (data_type == 0x0B) data_type = kText;  // UNICODE_STRING is shown by its bytes otherwise
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
  if (is_text(type.data_type)) return std::vector<std::uint8_t>(text.begin(), text.end());
  if (is_bytes(type.data_type)) return encode_bytes(text);
  if (canopen::eds_type_real(type.data_type)) return encode_real(text, type.data_type == kReal64);
  if (type.data_type == kBoolean) {
    if (text == "true" || text == "TRUE") text = "1";
    if (text == "false" || text == "FALSE") text = "0";
    if (text != "0" && text != "1") return std::nullopt;
    return little_endian(text == "1" ? 1 : 0, 1);
  }
  return encode_integer(text, type.data_type);
}

std::string hex_text(std::span<const std::uint8_t> bytes, const char* between) {
  std::string text;
  char two[3];
  for (const std::uint8_t b : bytes) {
    std::snprintf(two, sizeof two, "%02X", b);
    text += (text.empty() ? "" : between) + std::string(two);
  }
  return text;
}

bool may_be(std::span<const std::uint8_t> bytes, const ValueType& type) {
  return canopen::eds_type_bits(type.data_type) == 0 || fits(bytes, type);
}

std::string show_value(std::span<const std::uint8_t> bytes, const ValueType* type) {
  if (type != nullptr && is_text(type->data_type)) return "\"" + text_of(bytes) + "\"";
  if (type == nullptr || is_bytes(type->data_type) || !fits(bytes, *type)) return hex_text(bytes, " ");
  if (canopen::eds_type_real(type->data_type)) return text::number(real_of(bytes), 9);
  char hexadecimal_digits[24];
  std::snprintf(hexadecimal_digits, sizeof hexadecimal_digits, "%0*llXh", static_cast<int>(2 * bytes.size()),
                static_cast<unsigned long long>(canopen::load_le(bytes)));
  const std::string number = canopen::eds_type_signed(type->data_type)
                                 ? std::to_string(signed_of(bytes))
                                 : std::to_string(canopen::load_le(bytes));
  return number + " (" + hexadecimal_digits + ")";
}

nlohmann::json json_value(std::span<const std::uint8_t> bytes, const ValueType* type) {
  if (type != nullptr && is_text(type->data_type)) return text_of(bytes);
  if (type == nullptr || is_bytes(type->data_type)) return hex_text(bytes);
  if (!fits(bytes, *type)) return nullptr;
  if (canopen::eds_type_real(type->data_type)) {
    const double value = real_of(bytes);
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  }
  if (type->data_type == kBoolean) return bytes[0] != 0;
  if (canopen::eds_type_signed(type->data_type)) return signed_of(bytes);
  return canopen::load_le(bytes);
}

std::string eds_value_text(std::span<const std::uint8_t> bytes, std::uint16_t data_type) {
  const ValueType* type = type_numbered(data_type);
  if (type != nullptr && is_text(data_type)) return text_of(bytes);
  if (type == nullptr || is_bytes(data_type) || !fits(bytes, *type)) return hex_text(bytes);
  if (canopen::eds_type_real(data_type)) return text::number(real_of(bytes), 9);
  if (canopen::eds_type_signed(data_type)) return std::to_string(signed_of(bytes));
  char digits[24];
  std::snprintf(digits, sizeof digits, "0x%0*llX", static_cast<int>(2 * bytes.size()),
                static_cast<unsigned long long>(canopen::load_le(bytes)));
  return digits;
}

std::optional<KnownObject> known_object(std::uint16_t index, std::uint8_t subindex) {
  // 2000h-5FFFh belong to the manufacturer, also where our own simulated drive has something there.
  if (index >= 0x2000 && index < 0x6000) return std::nullopt;
  const std::uint16_t kind = first_of_its_kind(index);
  const auto& rows = standard_rows();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const canopen::ObjectSpec& s) {
    return s.index == kind && s.subindex == subindex;
  });
  if (found == rows.end()) return std::nullopt;
  KnownObject known;
  known.data_type = static_cast<std::uint16_t>(found->type);
  known.writable = found->access == canopen::Access::rw || found->access == canopen::Access::wo;
  known.readable = found->access != canopen::Access::wo;
  known.mappable = found->mappable != canopen::Mappable::no;
  return known;
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

}  // namespace servogate::gateway::command
