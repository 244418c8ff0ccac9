// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_catalogue.hpp"

#include <cctype>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/known_object.hpp"

namespace servogate::canopen {
namespace {

/// Letters and digits alone, in lower case; other bytes (Cyrillic) as they are.
std::string bare(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (static_cast<unsigned char>(c) >= 0x80 || std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

struct Named {
  std::string name;
  ObjectAddress at;
};

std::vector<Named> names_of(const Eds* eds) {
  std::vector<Named> out;
  if (eds != nullptr) {
    for (const auto& [index, object] : eds->objects) {
      out.push_back({object.entry.name, {index, 0}});
      for (const auto& [subindex, entry] : object.subs)
        out.push_back({object.entry.name + ": " + entry.name, {index, subindex}});
    }
    return out;
  }
  for (const ObjectInfo& o : standard_objects()) out.push_back({std::string(o.name), {o.index, 0}});
  return out;
}

}  // namespace

std::optional<ObjectAddress> ObjectCatalogue::address(std::string_view word,
                                                      std::vector<std::string>* similar) const {
  if (const auto at = parse_address(word)) return at;
  std::uint8_t subindex = 0;
  if (const std::size_t colon = word.rfind(':'); colon != std::string_view::npos)
    if (const auto sub = parse_address(word.substr(colon + 1)); sub && sub->index <= 0xFF) {
      subindex = static_cast<std::uint8_t>(sub->index);
      word = word.substr(0, colon);
    }
  const std::string wanted = bare(word);
  if (wanted.size() < 2) return std::nullopt;
  std::vector<Named> begun;
  for (Named& n : names_of(eds_)) {
    const std::string name = bare(n.name);
    const bool whole = name == wanted || name == wanted + "value";
    if (whole && (subindex == 0 || n.at.subindex == 0))
      return ObjectAddress{n.at.index, subindex != 0 ? subindex : n.at.subindex};
    if (name.starts_with(wanted) || (similar != nullptr && name.find(wanted) != std::string::npos))
      begun.push_back(std::move(n));
  }
  std::optional<ObjectAddress> found;
  bool several = false;
  for (const Named& n : begun) {
    if (!bare(n.name).starts_with(wanted) || n.at.subindex != 0) continue;
    several = several || (found && found->index != n.at.index);
    found = n.at;
  }
  if (found && !several) return ObjectAddress{found->index, subindex};
  constexpr std::size_t kMostNamed = 8;
  if (similar != nullptr)
    for (std::size_t i = 0; i < begun.size() && i < kMostNamed; ++i) similar->push_back(begun[i].name);
  return std::nullopt;
}

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
