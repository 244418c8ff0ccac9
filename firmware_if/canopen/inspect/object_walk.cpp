// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_walk.hpp"

#include <algorithm>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/known_object.hpp"
#include "firmware_if/canopen/inspect/moving_objects.hpp"

namespace servogate::canopen {

namespace {

constexpr std::uint16_t kDomain = 0x0F;
/// An area is left after so many indices in a row that do not exist.
constexpr int kGap = 8;

/// SDO and PDO parameters are numbered from the front, so that their areas end early.
constexpr bool numbered(std::uint16_t index) { return index >= 0x1200 && index < 0x1C00; }

/// Mapping records count the entries in use; those beyond exist for whoever maps anew. CiA 301, 7.5.2.36.
constexpr bool mapping(std::uint16_t index) {
  return (index >= 0x1600 && index < 0x1800) || (index >= 0x1A00 && index < 0x1C00);
}
constexpr int kMostMapped = 64;

bool missing(const SdoOutcome& outcome) {
  return outcome.abort == AbortCode::object_does_not_exist ||
         outcome.abort == AbortCode::subindex_does_not_exist;
}

/// Sub-indices 1 ... of an index whose sub-index 0 was read.
void walk_subs(SdoAccess& access, NodeId node, ReadObject head, std::vector<ReadObject>& out,
               const std::function<bool()>& over) {
  const bool counts = head.outcome.ok() && head.outcome.data.size() == 1 && head.outcome.data[0] > 0;
  // The standards know their variables; some devices answer any sub-index of one.
  const bool variable = known_object(head.index, 0) && !known_object(head.index, 1);
  const int used = counts ? head.outcome.data[0] : 0;
  const int most = variable ? 0 : !head.outcome.ok() ? 254 : mapping(head.index) ? kMostMapped : used;
  std::vector<ReadObject> subs;
  for (int sub = 1; sub <= most && !over(); ++sub) {
    ReadObject one{head.index, static_cast<std::uint8_t>(sub), {}, true};
    one.outcome = access.read(node, one.index, one.subindex);
    if (!one.outcome.answered()) break;
    const bool none = missing(one.outcome);
    if (!none) subs.push_back(std::move(one));
    // A number of one byte that is no count: the first sub-index is missing. An array may have holes.
    if (none && sub == 1 && head.index != object::kPredefinedErrorField) break;
    if (none && sub > used && mapping(head.index)) break;
  }
  head.record = !subs.empty() || head.index == object::kPredefinedErrorField;  // an empty history, too
  if (!missing(head.outcome) || head.record) out.push_back(std::move(head));
  std::move(subs.begin(), subs.end(), std::back_inserter(out));
}

void walk_range(SdoAccess& access, NodeId node, IndexRange range, std::vector<ReadObject>& out,
                const std::function<bool()>& over) {
  int gap = 0;
  for (int index = range.first; index <= range.last && !over(); ++index) {
    ReadObject head{static_cast<std::uint16_t>(index), 0, {}, false};
    head.outcome = access.read(node, head.index, 0);
    if (!head.outcome.answered()) return;
    if (head.outcome.abort == AbortCode::object_does_not_exist) {
      if (numbered(head.index) && ++gap >= kGap) return;
      continue;
    }
    gap = 0;
    walk_subs(access, node, std::move(head), out, over);
  }
}

bool to_be_read(const EdsEntry& e) {
  return e.access != EdsAccess::wo && e.data_type != 0 && e.data_type != kDomain && (e.flags & 2) == 0;
}

template <class Take>
void each_entry(const Eds& eds, Take take) {
  for (const auto& [index, object] : eds.objects) {
    if (object.subs.empty()) take(index, std::uint8_t{0}, object.entry, false);
    for (const auto& [subindex, entry] : object.subs) take(index, subindex, entry, true);
  }
}

EdsEntry entry_of(const ReadObject& o, std::string name) {
  EdsEntry e;
  e.name = std::move(name);
  const auto known = known_object(o.index, o.subindex);
  e.data_type = known ? known->data_type : guess_type(o.outcome.data)->data_type;
  e.access = known && !known->writable ? EdsAccess::ro : EdsAccess::rw;
  e.pdo_mapping = known && known->mappable;
  return e;
}

bool take_value(EdsEntry& e, const ReadObject& o) {
  auto text = eds_value_text(o.outcome.data, e.data_type);
  e.parameter_value.reset();
  if (text) e.parameter_value = EdsValue{std::move(*text), std::nullopt};
  return e.parameter_value.has_value();
}

Eds sheet_of(const std::vector<ReadObject>& objects) {
  Eds eds;
  const auto number = [&](std::uint8_t subindex) {
    for (const ReadObject& o : objects)
      if (o.index == object::kIdentity && o.subindex == subindex && o.outcome.ok())
        return eds_value_text(o.outcome.data, 0x07).value_or("0");
    return std::string("0");
  };
  eds.file_info = {
      {"FileVersion", "1"}, {"FileRevision", "1"}, {"EDSVersion", "4.0"}, {"CreatedBy", "servogate od"}};
  eds.device_info = {
      {"VendorNumber", number(1)}, {"ProductNumber", number(2)}, {"RevisionNumber", number(3)}};
  for (const ReadObject& o : objects) {
    if (!o.outcome.ok()) continue;
    std::string name(object_name(o.index));
    if (name.empty()) name = "Object " + address_text(o.index, 0).substr(0, 5);
    EdsObject& whole = eds.objects[o.index];
    if (!o.record) {
      whole.entry = entry_of(o, name);
      continue;
    }
    whole.entry.name = name;
    whole.entry.type = known_container(o.index);
    whole.entry.data_type = 0;
    const std::string sub =
        o.subindex == 0 ? "Highest sub-index supported" : name + " " + std::to_string(o.subindex);
    whole.subs[o.subindex] = entry_of(o, sub);
  }
  return eds;
}

/// A parameter, as opposed to a live value, a command or a service behind an object.
bool is_parameter(std::uint16_t index, const EdsEntry& e) {
  if (index == object::kPredefinedErrorField || index == object::kStoreParameters ||
      index == object::kRestoreParameters || can_move(index) || (e.flags & 1) != 0)
    return false;
  if (index == object::kDeviceType || index == object::kIdentity) return true;
  return e.access != EdsAccess::ro && to_be_read(e);
}

/// The bytes that a value of a file means; nullopt: it says none that could be compared.
std::optional<std::vector<std::uint8_t>> bytes_of(const EdsEntry& e, NodeId node) {
  const EdsValue* value = e.value();
  const ValueType* type = type_numbered(e.data_type);
  if (value == nullptr || type == nullptr) return std::nullopt;
  const int bits = eds_type_bits(e.data_type);
  if (value->number && bits > 0) {
    std::vector<std::uint8_t> out(static_cast<std::size_t>(std::max(1, bits / 8)));
    store_le(static_cast<std::uint64_t>(value->number->at(node)), out);
    return out;
  }
  if (value->text.empty() && type->name != "str") return std::nullopt;
  return encode_value(value->text, *type);
}

bool equal(const std::vector<std::uint8_t>& wanted, std::vector<std::uint8_t> got, const ValueType& type) {
  // A device may end its text with zeros.
  while (type.name == "str" && !got.empty() && got.back() == 0) got.pop_back();
  return wanted == got;
}

}  // namespace

std::vector<IndexRange> standard_areas() {
  return {{0x1000, 0x10FF}, {0x1200, 0x127F}, {0x1280, 0x12FF}, {0x1400, 0x15FF}, {0x1600, 0x17FF},
          {0x1800, 0x19FF}, {0x1A00, 0x1BFF}, {0x1F50, 0x1F9F}, {0x6000, 0x67FF}};
}

std::vector<ReadObject> read_listed(SdoAccess& access, NodeId node, const Eds& eds,
                                    const std::function<bool()>& over) {
  std::vector<ReadObject> out;
  bool silent = false;
  each_entry(eds, [&](std::uint16_t index, std::uint8_t subindex, const EdsEntry& e, bool record) {
    if (silent || over() || !to_be_read(e)) return;
    out.push_back({index, subindex, access.read(node, index, subindex), record});
    silent = !out.back().outcome.answered();
  });
  return out;
}

std::vector<ReadObject> walk(SdoAccess& access, NodeId node, const std::vector<IndexRange>& ranges,
                             const std::function<bool()>& over) {
  std::vector<ReadObject> out;
  for (const IndexRange& range : ranges) walk_range(access, node, range, out, over);
  return out;
}

Eds saved_configuration(const std::vector<ReadObject>& objects, const Eds* eds, NodeId node,
                        std::uint32_t bit_rate, std::vector<std::string>& not_saved) {
  Eds dcf = eds != nullptr ? *eds : sheet_of(objects);
  for (const ReadObject& o : objects)
    if (EdsEntry* e = dcf.find(o.index, o.subindex); e != nullptr && o.outcome.ok())
      if (!take_value(*e, o)) not_saved.push_back(address_text(o.index, o.subindex));
  EdsCommissioning commissioning = dcf.commissioning.value_or(EdsCommissioning{});
  commissioning.node = node;
  for (const ReadObject& o : objects)  // the serial number by which LSS finds it (CiA 306-1, 6.2)
    if (o.index == object::kIdentity && o.subindex == 4 && o.outcome.data.size() == 4)
      commissioning.lss_serial = static_cast<std::uint32_t>(load_le(o.outcome.data));
  commissioning.kbit_s = bit_rate / 1000;
  dcf.commissioning = commissioning;
  return dcf;
}

std::vector<Parameter> parameters_of(const Eds& file, NodeId node) {
  std::vector<Parameter> out;
  each_entry(file, [&](std::uint16_t index, std::uint8_t subindex, const EdsEntry& e, bool) {
    if (!is_parameter(index, e)) return;
    if (auto wanted = bytes_of(e, node))
      out.push_back({index, subindex, std::move(*wanted), type_numbered(e.data_type),
                     eds_writable(e.access) && index != object::kDeviceType && index != object::kIdentity});
  });
  return out;
}

std::vector<Difference> differences(SdoAccess& access, NodeId node, const Eds& file, int& compared,
                                    const std::function<bool()>& over) {
  std::vector<Difference> out;
  compared = 0;
  for (const Parameter& p : parameters_of(file, node)) {
    if (over()) break;
    ++compared;
    SdoOutcome outcome = access.read(node, p.index, p.subindex);
    if (outcome.ok() && equal(p.wanted, outcome.data, *p.type)) continue;
    const bool silent = !outcome.answered();
    out.push_back({p.index, p.subindex, show_value(p.wanted, p.type), std::move(outcome), p.type});
    if (silent) break;
  }
  return out;
}

}  // namespace servogate::canopen
