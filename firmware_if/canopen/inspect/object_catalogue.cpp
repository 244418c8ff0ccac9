// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_catalogue.hpp"

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/known_object.hpp"

namespace servogate::canopen {

std::string ObjectCatalogue::name(std::uint16_t index, std::uint8_t subindex) const {
  if (eds_ != nullptr) {
    if (const EdsEntry* entry = eds_->find(index, subindex)) {
      const auto& object = eds_->objects.at(index);
      if (object.subs.empty() || object.entry.name.empty() || entry->name.empty() ||
          object.entry.name == entry->name)
        return entry->name.empty() ? object.entry.name : entry->name;
      return object.entry.name + ": " + entry->name;
    }
  }
  return std::string(object_name(index));
}

const ValueType* ObjectCatalogue::type(std::uint16_t index, std::uint8_t subindex) const {
  if (eds_ != nullptr)
    if (const EdsEntry* entry = eds_->find(index, subindex)) return type_numbered(entry->data_type);
  if (const auto known = known_object(index, subindex)) return type_numbered(known->data_type);
  return nullptr;
}

}  // namespace servogate::canopen
