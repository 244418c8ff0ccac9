// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/data_sheet.hpp"

#include "firmware_if/canopen/402/objects.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kCannotRead{"eds.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};

}  // namespace

std::optional<canopen::Eds> read_data_sheet(const std::string& path) {
  std::string why;
  const auto bytes = files::read_file(path, files::kMostOfSource, why);
  if (!bytes) {
    complain(kCannotRead, {path, why});
    return std::nullopt;
  }
  canopen::EdsResult result = canopen::read_eds(*bytes, path);
  print_findings(result.findings);
  if (!result.ok()) return std::nullopt;
  return std::move(result.eds);
}

std::string ObjectCatalogue::name(std::uint16_t index, std::uint8_t subindex) const {
  if (eds_ != nullptr) {
    if (const canopen::EdsEntry* entry = eds_->find(index, subindex)) {
      const auto& object = eds_->objects.at(index);
      if (object.subs.empty() || object.entry.name.empty() || entry->name.empty() ||
          object.entry.name == entry->name)
        return entry->name.empty() ? object.entry.name : entry->name;
      return object.entry.name + ": " + entry->name;
    }
  }
  return std::string(canopen::object_name(index));
}

const ValueType* ObjectCatalogue::type(std::uint16_t index, std::uint8_t subindex) const {
  if (eds_ != nullptr)
    if (const canopen::EdsEntry* entry = eds_->find(index, subindex)) return type_numbered(entry->data_type);
  if (const auto known = known_object(index, subindex)) return type_numbered(known->data_type);
  return nullptr;
}

}  // namespace servogate::gateway::command
