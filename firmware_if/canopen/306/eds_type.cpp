// SPDX-License-Identifier: Apache-2.0
// Data types by their numbers in CiA 301, 7.4.7, and the small questions to a data sheet.
#include <algorithm>
#include <array>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {
namespace {

struct Type {
  std::int8_t bits;  ///< 0: no number
  bool is_signed;
};
constexpr std::array<Type, 0x1C> kTypes{{
    {-1, false}, {1, false},  {8, true},   {16, true},  {32, true},  {8, false},  {16, false},
    {32, false}, {32, false}, {0, false},  {0, false},  {0, false},  {0, false},  {0, false},
    {-1, false}, {0, false},  {24, true},  {64, false}, {40, true},  {48, true},  {56, true},
    {64, true},  {24, false}, {-1, false}, {40, false}, {48, false}, {56, false}, {64, false},
}};

constexpr std::string_view kAccess[] = {"ro", "wo", "rw", "rwr", "rww", "const"};

constexpr std::uint16_t kDomain = 0x0F;

// What an ObjectDictionary can hold, one to one by number: every data type of CiA 301 that is one value.
constexpr bool dictionary_has(std::uint16_t type) noexcept {
  return type < kTypes.size() && kTypes[type].bits >= 0;
}

/// Memory for strings and domains that a device may be given later, as much as a data sheet of a real device
/// asks for. Beyond it (a sheet of nonsense) there is room for the defaults.
class Rooms {
 public:
  std::uint32_t take(std::uint16_t data_type) noexcept {
    constexpr std::uint32_t kString = 1024, kLongDomain = 65'536;
    const std::uint32_t wanted = data_type == kDomain ? kLongDomain : kString;
    if (wanted > left_) return 0;
    left_ -= wanted;
    return wanted;
  }

 private:
  std::uint32_t left_ = 32u << 20;
};

Access access_of(EdsAccess access) noexcept {
  switch (access) {
    case EdsAccess::ro:
      return Access::ro;
    case EdsAccess::wo:
      return Access::wo;
    case EdsAccess::constant:
      return Access::constant;
    default:
      return Access::rw;
  }
}

Mappable mappable_of(const EdsEntry& e) noexcept {
  if (!e.pdo_mapping) return Mappable::no;
  switch (e.access) {
    case EdsAccess::ro:
    case EdsAccess::rwr:
    case EdsAccess::constant:
      return Mappable::tpdo;
    case EdsAccess::wo:
    case EdsAccess::rww:
      return Mappable::rpdo;
    default:
      return Mappable::both;
  }
}

/// TIME_OF_DAY and TIME_DIFFERENCE: their bytes in the order of the wire.
std::int64_t octets_number(std::string_view octets) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < octets.size() && i < 8; ++i)
    value |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(octets[i])) << 8 * i;
  return static_cast<std::int64_t>(value);
}

void add_row(std::vector<ObjectSpec>& rows, std::uint16_t index, std::uint8_t subindex, const EdsEntry& e,
             NodeId node, Rooms& rooms) {
  if (!dictionary_has(e.data_type)) return;
  ObjectSpec row;
  row.index = index;
  row.subindex = subindex;
  row.type = static_cast<DataType>(e.data_type);
  row.access = access_of(e.access);
  row.mappable = mappable_of(e);
  if (const EdsValue* value = e.value()) {
    if (value->number)
      row.value = value->number->at(node);
    else if (size_of(row.type) > 0)
      row.value = octets_number(value->octets);
    else
      row.text = row.type == DataType::visible_string ? value->text : value->octets;
  }
  if (size_of(row.type) == 0) row.room = rooms.take(e.data_type);
  if (e.low_limit && e.low_limit->number) row.low = e.low_limit->number->at(node);
  if (e.high_limit && e.high_limit->number) row.high = e.high_limit->number->at(node);
  rows.push_back(row);
}

}  // namespace

int eds_type_bits(std::uint16_t data_type) noexcept {
  return data_type < kTypes.size() && kTypes[data_type].bits > 0 ? kTypes[data_type].bits : 0;
}
bool eds_type_signed(std::uint16_t data_type) noexcept {
  return data_type < kTypes.size() && kTypes[data_type].is_signed;
}
// 20h-25Fh: structures of the standard, of the manufacturer and of the profile.
bool eds_type_known(std::uint16_t data_type) noexcept {
  return data_type < kTypes.size() ? kTypes[data_type].bits >= 0 : data_type >= 0x20 && data_type < 0x260;
}
std::string_view eds_access_word(EdsAccess access) noexcept { return kAccess[static_cast<int>(access)]; }

bool EdsResult::ok() const noexcept {
  return !eds.objects.empty() && std::none_of(findings.begin(), findings.end(), [](const text::Finding& f) {
    return f.severity == text::Severity::error;
  });
}

const EdsEntry* Eds::find(std::uint16_t index, std::uint8_t subindex) const noexcept {
  const auto object = objects.find(index);
  if (object == objects.end()) return nullptr;
  if (object->second.subs.empty()) return subindex == 0 ? &object->second.entry : nullptr;
  const auto sub = object->second.subs.find(subindex);
  return sub == object->second.subs.end() ? nullptr : &sub->second;
}
EdsEntry* Eds::find(std::uint16_t index, std::uint8_t subindex) noexcept {
  return const_cast<EdsEntry*>(static_cast<const Eds*>(this)->find(index, subindex));
}
std::string_view Eds::device(std::string_view key) const noexcept {
  for (const auto& [name, value] : device_info)
    if (same_word(name, key)) return value;
  return {};
}

std::vector<ObjectSpec> object_specs(const Eds& eds, NodeId node) {
  std::vector<ObjectSpec> rows;
  Rooms rooms;
  for (const auto& [index, object] : eds.objects) {
    if (object.subs.empty()) add_row(rows, index, 0, object.entry, node, rooms);
    for (const auto& [subindex, entry] : object.subs) add_row(rows, index, subindex, entry, node, rooms);
  }
  return rows;
}

}  // namespace servogate::canopen
