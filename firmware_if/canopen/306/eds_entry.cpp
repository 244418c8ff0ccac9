// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/306/eds_entry.hpp"

#include <bit>
#include <charconv>

#include "firmware_if/canopen/306/eds_text.hpp"
#include "firmware_if/canopen/306/value_text.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kUnsigned32 = 0x07, kBoolean = 0x01, kReal32 = 0x08, kTimeOfDay = 0x0C,
                        kTimeDifference = 0x0D, kFirstStructure = 0x20;
constexpr std::size_t kTimeBytes = 6;  ///< milliseconds and days; CiA 301, 7.1.6.5 and 7.1.6.6

const text::Entry* oddity_text(NumberOddity oddity) noexcept {
  switch (oddity) {
    case NumberOddity::leading_zeros:
      return &eds_text::kLeadingZeros;
    case NumberOddity::hex_suffix:
      return &eds_text::kHexSuffix;
    case NumberOddity::node_id_sign:
      return &eds_text::kNodeIdSign;
    case NumberOddity::boolean_word:
      return &eds_text::kBooleanWord;
    case NumberOddity::trailing_text:
      return &eds_text::kTrailingText;
    default:
      return nullptr;
  }
}

std::string hex(std::uint64_t value) { return eds_number_text({static_cast<std::int64_t>(value), false}); }

struct Word {
  std::string_view word;
  EdsAccess access;
};
constexpr Word kAccessWords[] = {{"ro", EdsAccess::ro},
                                 {"wo", EdsAccess::wo},
                                 {"rw", EdsAccess::rw},
                                 {"rwr", EdsAccess::rwr},
                                 {"rww", EdsAccess::rww},
                                 {"const", EdsAccess::constant},
                                 // as vendors write it besides
                                 {"r", EdsAccess::ro},
                                 {"w", EdsAccess::wo},
                                 {"read", EdsAccess::ro},
                                 {"write", EdsAccess::wo},
                                 {"constant", EdsAccess::constant},
                                 {"readonly", EdsAccess::ro},
                                 {"r/w", EdsAccess::rw},
                                 {"read-write", EdsAccess::rw}};
constexpr std::size_t kStandardWords = 6;

}  // namespace

std::optional<EdsNumber> EdsFieldReader::number(std::string_view key) const {
  const IniEntry* field = section_.entry(key);
  if (!field || field->value.empty()) return std::nullopt;
  const auto parsed = parse_eds_number(field->value);
  if (!parsed) {
    findings_.warn(eds_text::kNotANumber, field->line, {field->key, field->value});
    return std::nullopt;
  }
  if (const text::Entry* odd = oddity_text(parsed->oddity))
    findings_.warn(*odd, field->line, {field->key, field->value, std::to_string(parsed->number.value)});
  return parsed->number;
}

std::int64_t EdsFieldReader::integer(std::string_view key, std::int64_t otherwise) const {
  const auto found = number(key);
  return found ? found->value : otherwise;
}

bool EdsFieldReader::boolean(std::string_view key) const {
  const std::int64_t value = integer(key, 0);
  if (value != 0 && value != 1)
    findings_.warn(eds_text::kNotBoolean, section_.entry(key)->line,
                   {std::string(key), std::string(section_.find(key))});
  return value != 0;
}

EdsObjectType EdsFieldReader::object_type() const {
  const bool many = section_.entry("SubNumber") && !section_.entry("DataType");
  const auto guess = many ? EdsObjectType::record : EdsObjectType::variable;
  const auto found = number("ObjectType");
  if (!found) return guess;
  switch (found->value) {
    case 0:
    case 2:
    case 5:
    case 6:
    case 7:
    case 8:
    case 9:
      return static_cast<EdsObjectType>(found->value);
    default:
      findings_.warn(eds_text::kObjectType, section_.entry("ObjectType")->line,
                     {section_.name, hex(static_cast<std::uint64_t>(found->value)),
                      hex(static_cast<std::uint64_t>(guess))});
      return guess;
  }
}

std::uint16_t EdsFieldReader::data_type(std::uint16_t inherited) const {
  const auto found = number("DataType");
  if (!found) {
    if (inherited != 0) return inherited;
    findings_.warn(eds_text::kNoDataType, section_.line, {section_.name});
    return kUnsigned32;
  }
  const auto type = static_cast<std::uint16_t>(found->value);
  if (found->value == type && eds_type_known(type)) {
    if (type >= kFirstStructure)
      findings_.warn(eds_text::kStructureType, section_.entry("DataType")->line, {section_.name, hex(type)});
    return type;
  }
  findings_.warn(eds_text::kDataType, section_.entry("DataType")->line,
                 {section_.name, hex(static_cast<std::uint64_t>(found->value))});
  return kUnsigned32;
}

EdsAccess EdsFieldReader::access() const {
  const IniEntry* field = section_.entry("AccessType");
  const std::string_view word = field ? std::string_view(field->value) : std::string_view{};
  EdsAccess found = EdsAccess::rw;
  for (std::size_t i = 0; i < std::size(kAccessWords); ++i) {
    if (!same_word(kAccessWords[i].word, word)) continue;
    found = kAccessWords[i].access;
    if (i < kStandardWords) return found;
    break;
  }
  findings_.warn(eds_text::kAccess, field ? field->line : section_.line,
                 {section_.name, std::string(word), std::string(eds_access_word(found))});
  return found;
}

// A signed number may be written by its bits (0xFFFFFFFF for -1), as hexadecimal ones are.
bool EdsFieldReader::fits(EdsNumber& number, std::uint16_t data_type, const IniEntry& field) const {
  if (data_type == kBoolean && !number.plus_node) {
    if (number.value != 0 && number.value != 1)
      findings_.warn(eds_text::kNotBoolean, field.line, {field.key, field.value});
    number.value = number.value != 0;
    return true;
  }
  const int bits = eds_type_bits(data_type);
  if (bits == 64 || number.plus_node) return true;
  const std::int64_t top = std::int64_t{1} << bits;
  const bool is_signed = eds_type_signed(data_type);
  if (is_signed && number.value >= top / 2 && number.value < top) number.value -= top;
  return is_signed ? number.value >= -(top / 2) && number.value < top / 2
                   : number.value >= 0 && number.value < top;
}

// The number of a REAL is its bits.
std::optional<EdsValue> EdsFieldReader::real(const IniEntry& field) const {
  double value = 0.0;
  const char* begin = field.value.data();
  const char* end = begin + field.value.size();
  const auto [stop, error] = std::from_chars(begin + (*begin == '+'), end, value);
  if (error != std::errc{} || stop != end) {
    findings_.warn(eds_text::kNotANumber, field.line, {field.key, field.value});
    return std::nullopt;
  }
  return EdsValue{field.value, EdsNumber{std::bit_cast<std::int64_t>(value), false}};
}

// Bytes are written by their hexadecimal digits. What is none of them stays as a text without a meaning.
EdsValue EdsFieldReader::text_or_bytes(const IniEntry& field, std::uint16_t data_type,
                                       bool to_be_written) const {
  EdsValue found{field.value, std::nullopt};
  const ValueType* type = type_numbered(data_type);
  if (type != nullptr && is_text(*type)) return found;
  const text::Entry* wrong = &eds_text::kNoBytesOfType;
  if (type != nullptr) {
    const auto bytes = encode_value(field.value, *type);
    const bool time = data_type == kTimeOfDay || data_type == kTimeDifference;
    if (bytes && (!time || bytes->size() == kTimeBytes)) {
      found.octets.assign(bytes->begin(), bytes->end());
      return found;
    }
    wrong = bytes ? &eds_text::kNotSixBytes : &eds_text::kNotBytes;
  }
  const std::vector<std::string> arguments{section_.name, field.key, field.value, hex(data_type)};
  if (to_be_written)
    findings_.error(*wrong, field.line, arguments);
  else if (type != nullptr)  // of a structure data_type() has said it
    findings_.warn(*wrong, field.line, arguments);
  return found;
}

std::optional<EdsValue> EdsFieldReader::parameter(std::string_view key, const EdsEntry& e) const {
  const IniEntry* field = section_.entry(key);
  if (field == nullptr) return std::nullopt;
  if (field->value.empty()) return eds_type_string(e.data_type) ? std::optional(EdsValue{}) : std::nullopt;
  if (eds_type_real(e.data_type) || eds_type_bits(e.data_type) > 0) return value(key, e.data_type);
  // A value that is the default anyway is not written (configuration_of).
  const bool other = !e.default_value || e.default_value->text != field->value;
  return text_or_bytes(*field, e.data_type, other && eds_writable(e.access) && (e.flags & 1) == 0);
}

std::optional<EdsValue> EdsFieldReader::value(std::string_view key, std::uint16_t data_type) const {
  const IniEntry* field = section_.entry(key);
  if (!field || field->value.empty()) return std::nullopt;
  if (eds_type_real(data_type)) {
    auto found = real(*field);
    if (found && data_type == kReal32)
      found->number->value =
          std::bit_cast<std::uint32_t>(static_cast<float>(std::bit_cast<double>(found->number->value)));
    return found;
  }
  if (eds_type_bits(data_type) == 0) return text_or_bytes(*field, data_type, false);
  auto found = number(key);
  if (!found) return std::nullopt;
  if (!fits(*found, data_type, *field)) {
    findings_.warn(eds_text::kOutOfType, field->line, {section_.name, field->key, field->value});
    return std::nullopt;
  }
  return EdsValue{eds_number_text(*found), found};
}

void EdsFieldReader::drop_wrong_limits(EdsEntry& e) const {
  if (!e.low_limit || !e.high_limit || !e.low_limit->number || !e.high_limit->number) return;
  if (eds_type_real(e.data_type)) return;
  const EdsNumber low = *e.low_limit->number, high = *e.high_limit->number;
  if (low.plus_node != high.plus_node || eds_type_bits(e.data_type) == 64 || low.value <= high.value) return;
  findings_.warn(eds_text::kLimits, section_.entry("LowLimit")->line, {section_.name});
  e.low_limit.reset();
  e.high_limit.reset();
}

EdsEntry EdsFieldReader::entry(bool top, std::uint16_t inherited_type) const {
  EdsEntry e;
  e.name = text("ParameterName");
  e.denotation = text("Denotation");
  if (e.name.empty()) findings_.warn(eds_text::kNoName, section_.line, {section_.name});
  e.type = object_type();
  e.flags = static_cast<std::uint32_t>(integer("ObjFlags", 0));
  const bool whole = e.type == EdsObjectType::array || e.type == EdsObjectType::record ||
                     e.type == EdsObjectType::defstruct || e.type == EdsObjectType::null;
  if (top && whole) {
    e.data_type = 0;
    return e;
  }
  e.data_type = e.type == EdsObjectType::domain ? std::uint16_t{0x0F} : data_type(inherited_type);
  e.access = access();
  e.pdo_mapping = boolean("PDOMapping");
  e.default_value = value("DefaultValue", e.data_type);
  e.parameter_value = parameter("ParameterValue", e);
  e.low_limit = value("LowLimit", e.data_type);
  e.high_limit = value("HighLimit", e.data_type);
  drop_wrong_limits(e);
  return e;
}

}  // namespace servogate::canopen
