// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/recorded_object.hpp"

#include <bit>
#include <limits>

#include "firmware_if/canopen/inspect/known_object.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/command/canopen/sdo_request.hpp"

namespace servogate::gateway::command {
namespace {

const text::Entry kNoType{"bench.record-type",
                          "{0} has no known type of 1 to 64 bits: name a data sheet with --eds",
                          "у {0} нет известного типа в 1–64 бита: укажите файл описания через --eds"};
const text::Entry kNotMapped{"bench.record-map", "{0} cannot be mapped into a PDO",
                             "{0} нельзя отобразить в PDO"};
const text::Entry kTooMany{"bench.record-room", "{0} does not fit any more: TPDO 3 and 4 have 8 bytes each",
                           "{0} уже не помещается: в TPDO 3 и 4 по 8 байтов"};

bool put(std::array<canopen::PdoMapping, 2>& mappings, const canopen::MappingEntry& entry) {
  return mappings[0].add(entry) || mappings[1].add(entry);
}

double number_of(const RecordedObject& object, std::uint64_t raw) {
  if (object.is_real && object.entry.bits == 32)
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (object.is_real) return std::bit_cast<double>(raw);
  if (object.is_signed) return static_cast<double>(canopen::sign_extend(raw, object.entry.bits));
  return static_cast<double>(raw);
}

}  // namespace

std::optional<std::vector<RecordedObject>> recorded_objects(const std::vector<std::string>& words,
                                                            const canopen::ObjectCatalogue& catalogue) {
  std::vector<RecordedObject> out;
  std::array<canopen::PdoMapping, 2> mappings;
  for (const std::string& word : words) {
    const auto at = object_of_word(word, catalogue);
    if (!at) return std::nullopt;
    const std::string name = catalogue.name(at->index, at->subindex);
    RecordedObject o;
    o.name = canopen::address_text(at->index, at->subindex) + (name.empty() ? "" : " " + name);
    const canopen::ValueType* type = catalogue.type(at->index, at->subindex);
    const int bits = type != nullptr ? canopen::eds_type_bits(type->data_type) : 0;
    if (bits < 1 || bits > 64) {
      complain(kNoType, {o.name});
      return std::nullopt;
    }
    const auto known = canopen::known_object(at->index, at->subindex);
    if (known && !known->mappable) {
      complain(kNotMapped, {o.name});
      return std::nullopt;
    }
    o.entry = {at->index, at->subindex, static_cast<std::uint8_t>(bits)};
    o.is_signed = canopen::eds_type_signed(type->data_type);
    o.is_real = canopen::eds_type_real(type->data_type);
    if (!put(mappings, o.entry)) {
      complain(kTooMany, {o.name});
      return std::nullopt;
    }
    out.push_back(std::move(o));
  }
  return out;
}

ObjectRecorder::ObjectRecorder(canopen::NodeId node, std::vector<RecordedObject> objects)
    : node_(node),
      objects_(std::move(objects)),
      now_(objects_.size(), std::numeric_limits<double>::quiet_NaN()) {
  for (const RecordedObject& o : objects_) put(mappings_, o.entry);
}

void ObjectRecorder::on_frame(const image::CanFrame& frame) {
  if (objects_.empty() || frame.extended || frame.remote || frame.error) return;
  for (int pdo = 0; pdo < 2; ++pdo) {
    const canopen::PdoMapping& map = mapping(pdo);
    // CiA 301, 7.3.5: TPDO 1 of a node is 180h and its node-ID, each further one 100h more.
    if (map.count == 0 || frame.id != 0x180u + 0x100u * static_cast<unsigned>(kFirstPdo + pdo) + node_)
      continue;
    std::array<std::uint64_t, canopen::kMaxMappedObjects> raw{};
    if (!canopen::unpack(map, std::span(frame.data).first(std::min<std::size_t>(8, frame.length)), raw))
      continue;
    for (std::size_t i = 0; i < map.count; ++i)
      for (std::size_t k = 0; k < objects_.size(); ++k)
        if (objects_[k].entry == map.entries[i]) now_[k] = number_of(objects_[k], raw[i]);
  }
}

void ObjectRecorder::end_cycle() { values_.insert(values_.end(), now_.begin(), now_.end()); }

}  // namespace servogate::gateway::command
