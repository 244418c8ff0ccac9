// SPDX-License-Identifier: Apache-2.0
// The slave's side of its own objects: what SDO reads and writes of 1000h-1FFFh mean.
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"
#include "firmware_if/canopen/device/node/slave.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint32_t kSave = 0x65766173, kLoad = 0x64616F6C;  // "save", "load"
constexpr std::uint16_t kFirstApplication = 0x2000;
constexpr ObjectDictionary::Range kParts[] = {
    {0x1000, 0xFFFF}, {0x1000, 0x1FFF}, {kFirstApplication, 0xFFFF}};

constexpr bool pdo_parameter(std::uint16_t index) noexcept { return index >= 0x1400 && index < 0x1C00; }

}  // namespace

AbortCode Slave::read(std::uint16_t index, std::uint8_t subindex, std::span<std::uint8_t> bytes,
                      std::size_t& size) noexcept {
  const auto slot = dictionary_.find_visible(index, subindex);
  if (slot == ObjectDictionary::kNone)
    return dictionary_.index_visible(index) ? AbortCode::subindex_does_not_exist
                                            : AbortCode::object_does_not_exist;
  if (dictionary_.spec(slot).access == Access::wo) return AbortCode::write_only;
  if (index == object::kPredefinedErrorField && subindex > dictionary_.get(index, 0))
    return AbortCode::no_data_available;
  if (index >= kFirstApplication) profile_.refresh();
  size = dictionary_.encode(slot, bytes);
  return AbortCode::none;
}

std::span<std::uint8_t> Slave::room(std::uint16_t index, std::uint8_t subindex) noexcept {
  if (programs_ && index == object::kProgramData) return programs_->room();
  const auto slot = dictionary_.find_visible(index, subindex);
  return slot == ObjectDictionary::kNone ? std::span<std::uint8_t>{} : dictionary_.staging(slot);
}

std::span<const std::uint8_t> Slave::content(std::uint16_t index, std::uint8_t subindex) noexcept {
  const auto slot = dictionary_.find_visible(index, subindex);
  if (slot == ObjectDictionary::kNone) return {};
  const std::string_view text = dictionary_.text(slot);
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

AbortCode Slave::may_write(std::uint16_t index, std::uint8_t subindex, std::size_t& size) noexcept {
  const auto slot = dictionary_.find_visible(index, subindex);
  if (slot == ObjectDictionary::kNone)
    return dictionary_.index_visible(index) ? AbortCode::subindex_does_not_exist
                                            : AbortCode::object_does_not_exist;
  const ObjectSpec& spec = dictionary_.spec(slot);
  size = size_of(spec.type);
  if (programs_ && index == object::kProgramData && subindex > 0) return programs_->check_download();
  const bool writable = spec.access == Access::rw || spec.access == Access::wo;
  return writable ? AbortCode::none : AbortCode::read_only;
}

AbortCode Slave::write(std::uint16_t index, std::uint8_t subindex,
                       std::span<const std::uint8_t> bytes) noexcept {
  const auto slot = dictionary_.find_visible(index, subindex);
  if (slot == ObjectDictionary::kNone) return AbortCode::object_does_not_exist;
  if (programs_ && index == object::kProgramData && subindex > 0) {
    if (const AbortCode code = programs_->check_download(); code != AbortCode::none) return code;
    programs_->written(bytes.size(), now_);
    return AbortCode::none;
  }
  std::int64_t value = 0;
  if (const AbortCode code = dictionary_.decode(slot, bytes, value); code != AbortCode::none) return code;
  const bool communication = index < kFirstApplication;
  const AbortCode code =
      communication ? check_communication_write(index, subindex, value) : profile_.before_write(slot, value);
  if (code != AbortCode::none) return code;
  if (index == object::kStoreParameters || index == object::kRestoreParameters) {
    store_or_restore(index, subindex);
    return AbortCode::none;
  }
  if (size_of(dictionary_.spec(slot).type) == 0)
    dictionary_.set_text(slot, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  else
    dictionary_.set_value(slot, value);
  if (communication)
    communication_written(index, subindex, value);
  else
    profile_.after_write(slot);
  return AbortCode::none;
}

AbortCode Slave::check_communication_write(std::uint16_t index, std::uint8_t subindex,
                                           std::int64_t value) const noexcept {
  const auto word = static_cast<std::uint32_t>(value);
  if (pdo_parameter(index)) {
    const AbortCode code = check_pdo_map_access(dictionary_, map_access_, index, subindex, word);
    return code != AbortCode::none ? code : check_pdo_parameter(dictionary_, index, subindex, word);
  }
  switch (index) {
    case object::kProgramControl:
      return programs_ ? programs_->check_control(value) : AbortCode::none;
    case object::kPredefinedErrorField:
      return value == 0 ? AbortCode::none : AbortCode::value_invalid;
    case object::kCobIdSync:  // a consumer only, 11-bit identifiers
      return word & ~0x8000'07FFu || restricted_cob_id(word & 0x7FF) ? AbortCode::value_invalid
                                                                     : AbortCode::none;
    case object::kCobIdTime:  // a consumer only, 11-bit identifiers; not used without bit 31
      return word & ~0x8000'07FFu || (word & cob::kInvalid && restricted_cob_id(word & 0x7FF))
                 ? AbortCode::value_invalid
                 : AbortCode::none;
    case object::kCobIdEmcy: {
      const auto old = static_cast<std::uint32_t>(dictionary_.get(index));
      const bool stays_valid = !(old & cob::kInvalid) && !(word & cob::kInvalid);
      const bool may_be_used = word & cob::kInvalid || !restricted_cob_id(word & 0x7FF);
      return word & 0x7FFF'F800u || (stays_valid && old != word) || !may_be_used ? AbortCode::value_invalid
                                                                                 : AbortCode::none;
    }
    case object::kStoreParameters:
      return word == kSave ? AbortCode::none : AbortCode::cannot_transfer;
    case object::kRestoreParameters:
      return word == kLoad ? AbortCode::none : AbortCode::cannot_transfer;
    case object::kConsumerHeartbeatTime:
      return monitor_.check_consumer(subindex, word);
    case object::kSyncCounterOverflow:
      if (value == 1) return AbortCode::value_invalid;
      return dictionary_.get(object::kCommunicationCyclePeriod) ? AbortCode::device_state : AbortCode::none;
    default:
      return AbortCode::none;
  }
}

void Slave::communication_written(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept {
  if (pdo_parameter(index)) return configure_pdo(index);
  switch (index) {
    case object::kProgramControl:
      // Without its program the device drives nothing.
      if (programs_ && programs_->running()) profile_.on_abort_connection(0);
      restart_due_ = programs_ && programs_->control(value, now_);
      return;
    case object::kCobIdSync:
    case object::kCobIdTime:
      return set_filter();
    case object::kPredefinedErrorField:
      return emcy_.clear_history();
    case object::kConsumerHeartbeatTime:
      return monitor_.consumer_changed(subindex);
    case object::kProducerHeartbeatTime:
      return monitor_.producer_changed(now_);
    default:
      return;
  }
}

void Slave::store_or_restore(std::uint16_t index, std::uint8_t subindex) noexcept {
  const ObjectDictionary::Range part = kParts[subindex - 1];
  if (index != object::kStoreParameters) return dictionary_.forget(part);
  dictionary_.store(part);
  // Its count without its entries would be errors that never were.
  dictionary_.forget({object::kPredefinedErrorField, object::kPredefinedErrorField});
  profile_.on_store();
}

}  // namespace servogate::canopen
