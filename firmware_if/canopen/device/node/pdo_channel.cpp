// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/pdo_channel.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

std::uint64_t mask(std::uint32_t bits) noexcept {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}
std::uint16_t nth(std::uint16_t base, int number) noexcept {
  return static_cast<std::uint16_t>(base + number);
}

constexpr std::uint8_t kRemoteSynchronous = 252;
constexpr std::uint32_t kExtended = 0x2000'0000u;
constexpr std::uint32_t kAllButValid = 0x3FFF'FFFFu;

// 241-251 are reserved, and so are for an RPDO the two types that only a remote request can make. Source: CiA
// 301, tables "Description of RPDO/TPDO transmission types".
constexpr bool reserved_type(std::uint32_t type, bool transmit) noexcept {
  return type > 240 && type < (transmit ? kRemoteSynchronous : 254u);
}

AbortCode check_communication(const ObjectDictionary& od, std::uint16_t index, std::uint8_t subindex,
                              std::uint32_t value) noexcept {
  const auto old = static_cast<std::uint32_t>(od.get(index, 1));
  const bool valid = !(old & cob::kInvalid);
  switch (subindex) {
    case 1: {
      if (value & kExtended || (value & 0x1FFF'F800u)) return AbortCode::value_invalid;
      const bool becomes_valid = !(value & cob::kInvalid);
      if (valid && becomes_valid && ((old ^ value) & kAllButValid)) return AbortCode::value_invalid;
      return becomes_valid && restricted_cob_id(value & 0x7FF) ? AbortCode::value_invalid : AbortCode::none;
    }
    case 2:
      return reserved_type(value, index >= object::kTpdoParameter) ? AbortCode::value_invalid
                                                                   : AbortCode::none;
    case 3:
    case 6:
      return valid ? AbortCode::value_invalid : AbortCode::none;
    default:
      return AbortCode::none;
  }
}

constexpr std::uint32_t bits_of(DataType type) noexcept {
  return type == DataType::boolean ? 1u : 8u * size_of(type);
}

// A dummy entry names a data type by its number. Source: CiA 301, 7.4.7.1.
AbortCode check_dummy(MappingEntry entry, bool receive) noexcept {
  if (!receive) return AbortCode::cannot_be_mapped;
  if (entry.subindex != 0 || entry.index > 0x0007 || entry.index == 0)
    return AbortCode::object_does_not_exist;
  return bits_of(static_cast<DataType>(entry.index)) == entry.bits ? AbortCode::none
                                                                   : AbortCode::length_mismatch;
}

AbortCode check_entry(const ObjectDictionary& od, std::uint32_t word, bool receive) noexcept {
  const MappingEntry entry = MappingEntry::from_word(word);
  if (word != 0 && entry.dummy()) return check_dummy(entry, receive);
  if (!od.index_visible(entry.index)) return AbortCode::object_does_not_exist;
  const auto slot = od.find_visible(entry.index, entry.subindex);
  if (slot == ObjectDictionary::kNone) return AbortCode::subindex_does_not_exist;
  const ObjectSpec& spec = od.spec(slot);
  const Mappable wanted = receive ? Mappable::rpdo : Mappable::tpdo;
  if (spec.mappable != Mappable::both && spec.mappable != wanted) return AbortCode::cannot_be_mapped;
  return bits_of(spec.type) == entry.bits ? AbortCode::none : AbortCode::length_mismatch;
}

AbortCode check_mapping(const ObjectDictionary& od, std::uint16_t index, std::uint8_t subindex,
                        std::uint32_t value, bool receive) noexcept {
  const auto parameter = static_cast<std::uint16_t>(index - 0x200);
  if (!(static_cast<std::uint32_t>(od.get(parameter, 1)) & cob::kInvalid))
    return AbortCode::unsupported_access;
  if (subindex > 0) {
    if (od.get(index, 0) != 0) return AbortCode::unsupported_access;
    return value == 0 ? AbortCode::none : check_entry(od, value, receive);
  }
  if (value > kPdoEntries) return AbortCode::mapping_too_long;
  std::uint32_t bits = 0;
  for (std::uint8_t i = 1; i <= value; ++i) {
    const auto word = static_cast<std::uint32_t>(od.get(index, i));
    if (const AbortCode code = check_entry(od, word, receive); code != AbortCode::none) return code;
    bits += MappingEntry::from_word(word).bits;
  }
  return bits > 64 ? AbortCode::mapping_too_long : AbortCode::none;
}

}  // namespace

AbortCode check_pdo_parameter(const ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t subindex,
                              std::uint32_t value) noexcept {
  const bool mapping = index & 0x0200;
  const bool receive = index < object::kTpdoParameter;
  return mapping ? check_mapping(dictionary, index, subindex, value, receive)
                 : check_communication(dictionary, index, subindex, value);
}

AbortCode check_pdo_map_access(const ObjectDictionary& dictionary, MapAccess access, std::uint16_t index,
                               std::uint8_t subindex, std::uint32_t value) noexcept {
  const bool mapping = index & 0x0200;
  if (!mapping || access == MapAccess::variable) return AbortCode::none;
  if (access == MapAccess::fixed) return AbortCode::read_only;
  const auto slot = dictionary.find(index, subindex);
  const auto own = static_cast<std::uint32_t>(dictionary.spec(slot).value);
  return value == own || (subindex == 0 && value == 0) ? AbortCode::none : AbortCode::cannot_be_mapped;
}

void MappedObjects::load(const ObjectDictionary& dictionary, std::uint16_t mapping_index) noexcept {
  count_ = 0;
  std::uint32_t offset = 0;
  const auto count = std::min<std::int64_t>(dictionary.get(mapping_index, 0), kPdoEntries);
  for (std::uint8_t i = 1; i <= count; ++i) {
    const auto entry = MappingEntry::from_word(static_cast<std::uint32_t>(dictionary.get(mapping_index, i)));
    Field& f = fields_[count_++];
    f.slot = entry.dummy() ? ObjectDictionary::kNone : dictionary.find(entry.index, entry.subindex);
    f.offset = static_cast<std::uint8_t>(offset);
    f.bits = entry.bits;
    f.is_signed = f.slot != ObjectDictionary::kNone && is_signed(dictionary.spec(f.slot).type);
    offset += entry.bits;
  }
  bytes_ = static_cast<std::uint8_t>((offset + 7) / 8);
}

void ReceivePdo::configure(const ObjectDictionary& dictionary, int number) noexcept {
  const std::uint16_t parameter = nth(object::kRpdoParameter, number);
  const auto cob_id = static_cast<std::uint32_t>(dictionary.get(parameter, 1));
  objects_.load(dictionary, nth(object::kRpdoMapping, number));
  valid_ = !(cob_id & cob::kInvalid) && objects_.bytes() > 0;
  id_ = cob_id & 0x7FF;
  type_ = static_cast<std::uint8_t>(dictionary.get(parameter, 2));
  timeout_ = dictionary.get(parameter, 5) * image::kMillisecond;
  start();
}

ReceivePdo::Result ReceivePdo::accept(const image::CanFrame& frame, image::Nanoseconds now) noexcept {
  was_short_ = frame.length < objects_.bytes();
  if (was_short_) return Result::too_short;
  overdue_ = false;
  if (timeout_ > 0) deadline_ = now + timeout_;
  content_ = load_le(std::span(frame.data).first(8));
  pending_ = true;
  return synchronous() ? Result::kept : Result::apply_now;
}

void ReceivePdo::apply(ObjectDictionary& dictionary, PdoSink& sink) noexcept {
  pending_ = false;
  for (const MappedObjects::Field& f : objects_) {
    if (f.slot == ObjectDictionary::kNone) continue;
    const std::uint64_t raw = content_ >> f.offset & mask(f.bits);
    const std::int64_t value = f.is_signed ? sign_extend(raw, f.bits) : static_cast<std::int64_t>(raw);
    if (dictionary.check_range(f.slot, value) != AbortCode::none) continue;
    dictionary.set_value(f.slot, value);
    sink.pdo_wrote(f.slot);
  }
}

void TransmitPdo::configure(const ObjectDictionary& dictionary, int number, image::Nanoseconds now) noexcept {
  const std::uint16_t parameter = nth(object::kTpdoParameter, number);
  const auto cob_id = static_cast<std::uint32_t>(dictionary.get(parameter, 1));
  objects_.load(dictionary, nth(object::kTpdoMapping, number));
  valid_ = !(cob_id & cob::kInvalid) && objects_.bytes() > 0;
  remote_allowed_ = !(cob_id & cob::kNoRemote);
  id_ = cob_id & 0x7FF;
  type_ = static_cast<std::uint8_t>(dictionary.get(parameter, 2));
  inhibit_ = dictionary.get(parameter, 3) * 100 * image::kMicrosecond;
  event_timer_ = dictionary.get(parameter, 5) * image::kMillisecond;
  sync_start_ = static_cast<std::uint8_t>(dictionary.get(parameter, 6));
  start(now);
}

void TransmitPdo::start(image::Nanoseconds now) noexcept {
  syncs_ = 0;
  waiting_for_start_ = sync_start_ != 0;
  sent_once_ = stored_once_ = false;
  last_sent_ = now;
}

std::uint64_t TransmitPdo::sample(const ObjectDictionary& dictionary) const noexcept {
  std::uint64_t content = 0;
  for (const MappedObjects::Field& f : objects_)
    if (f.slot != ObjectDictionary::kNone)
      content |= (static_cast<std::uint64_t>(dictionary.value(f.slot)) & mask(f.bits)) << f.offset;
  return content;
}

bool TransmitPdo::due_at_sync(const ObjectDictionary& dictionary, std::uint8_t counter) noexcept {
  if (!valid_) return false;
  if (type_ == kRemoteSynchronous) {
    stored_ = sample(dictionary);
    stored_once_ = true;
  }
  if (type_ > 240) return false;
  if (type_ == 0) return !sent_once_ || sample(dictionary) != last_content_;
  if (waiting_for_start_ && counter != 0) {
    // The SYNC whose counter is the start value counts as the first one. Source: CiA 301, 7.5.2.37,
    // sub-index 6.
    if (counter != sync_start_) return false;
    waiting_for_start_ = false;
    syncs_ = static_cast<std::uint8_t>(type_ - 1);
  }
  if (++syncs_ < type_) return false;
  syncs_ = 0;
  return true;
}

bool TransmitPdo::due_by_event(const ObjectDictionary& dictionary, PdoEvents& events,
                               image::Nanoseconds now) noexcept {
  if (!event_driven()) return false;
  if (!sent_once_) return true;
  if (now - last_sent_ < inhibit_) return false;
  if (event_timer_ > 0 && now - last_sent_ >= event_timer_) return true;
  if (sample(dictionary) == last_content_) return false;
  return std::any_of(objects_.begin(), objects_.end(), [&](const MappedObjects::Field& f) {
    if (f.slot == ObjectDictionary::kNone) return false;
    const std::uint64_t raw = last_content_ >> f.offset & mask(f.bits);
    const std::int64_t sent = f.is_signed ? sign_extend(raw, f.bits) : static_cast<std::int64_t>(raw);
    return events.is_event(f.slot, sent, dictionary.value(f.slot));
  });
}

void TransmitPdo::send(const ObjectDictionary& dictionary, image::CanBus& bus,
                       image::Nanoseconds now) noexcept {
  image::CanFrame frame;
  frame.id = id_;
  frame.length = objects_.bytes();
  last_content_ = type_ == kRemoteSynchronous ? stored_ : sample(dictionary);
  store_le(last_content_, std::span(frame.data).first(8));
  last_sent_ = now;
  sent_once_ = true;
  bus.send(frame);
}

}  // namespace servogate::canopen
