// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/device_sheet.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/known_object.hpp"
#include "firmware_if/canopen/inspect/moving_objects.hpp"

namespace servogate::canopen {

namespace {

constexpr std::uint16_t kUnsigned8 = 0x05, kDomain = 0x0F;
constexpr std::uint32_t kBitRates[] = {10, 20, 50, 125, 250, 500, 800, 1000};  ///< kbit/s, CiA 306-1

/// The serial number is one device's own, and no default of its kind.
bool serial_number(std::uint16_t index, std::uint8_t subindex) {
  return index == object::kIdentity && subindex == 4;
}

/// What a device had when it was read is no default: commands, errors, what only lives.
bool only_lives(std::uint16_t index, std::uint8_t subindex) {
  if (index == object::kErrorRegister || index == object::kPredefinedErrorField || can_move(index) ||
      serial_number(index, subindex))
    return true;
  const auto known = known_object(index, subindex);
  return known && !known->writable && known->mappable;
}

std::string name_of(std::uint16_t index, const Eds* eds) {
  if (eds != nullptr)
    if (const auto found = eds->objects.find(index);
        found != eds->objects.end() && !found->second.entry.name.empty())
      return found->second.entry.name;
  const std::string_view name = object_name(index);
  return name.empty() ? "Object " + address_text(index, 0).substr(0, 5) : std::string(name);
}

std::string sub_name(std::uint16_t index, std::uint8_t subindex, const Eds* eds) {
  if (eds != nullptr)
    if (const EdsEntry* e = eds->find(index, subindex); e != nullptr && !e->name.empty()) return e->name;
  return subindex == 0 ? "Highest sub-index supported" : name_of(index, eds) + " " + std::to_string(subindex);
}

/// Puts an entry at its place.
EdsEntry& place(Eds& sheet, std::uint16_t index, std::uint8_t subindex, bool record, EdsEntry entry,
                const Eds* names) {
  EdsObject& whole = sheet.objects[index];
  entry.type = entry.data_type == kDomain ? EdsObjectType::domain : EdsObjectType::variable;
  entry.name = record ? sub_name(index, subindex, names) : name_of(index, names);
  if (!record) return whole.entry = std::move(entry);
  whole.entry.name = name_of(index, names);
  whole.entry.type = known_container(index);
  whole.entry.data_type = 0;
  if (names != nullptr)
    if (const auto found = names->objects.find(index); found != names->objects.end()) {
      const EdsObjectType type = found->second.entry.type;
      if (type == EdsObjectType::array || type == EdsObjectType::record) whole.entry.type = type;
    }
  return whole.subs[subindex] = std::move(entry);
}

/// A value as a data sheet has it. nullopt: it cannot hold it.
std::optional<EdsValue> value_of(std::span<const std::uint8_t> bytes, std::uint16_t data_type) {
  auto text = eds_value_text(bytes, data_type);
  if (!text) return std::nullopt;
  EdsValue value{std::move(*text), std::nullopt};
  if (eds_type_bits(data_type) > 0 && !eds_type_real(data_type))
    if (const auto parsed = parse_eds_number(value.text)) value.number = parsed->number;
  return value;
}

/// Values stand as those of one device until the ones that follow from its node-ID are known.
void values_to_defaults(Eds& sheet, NodeId node) {
  sheet.commissioning = EdsCommissioning{};
  sheet.commissioning->node = node;
  follow_node(sheet);
  sheet.commissioning.reset();
  const auto move = [](EdsEntry& e) {
    if (e.parameter_value && !e.parameter_value->text.empty()) e.default_value = std::move(e.parameter_value);
    e.parameter_value.reset();
    e.denotation.clear();
  };
  for (auto& [index, object] : sheet.objects) {
    move(object.entry);
    for (auto& [subindex, entry] : object.subs) move(entry);
  }
}

std::string number_text(const Eds& sheet, std::uint8_t subindex) {
  const EdsEntry* e = sheet.find(object::kIdentity, subindex);
  return e != nullptr && e->default_value ? e->default_value->text : "0";
}

int count(const Eds& sheet, std::uint16_t first) {
  const auto from = sheet.objects.lower_bound(first),
             to = sheet.objects.lower_bound(static_cast<std::uint16_t>(first + 0x200));
  return static_cast<int>(std::distance(from, to));
}

void describe_file(Eds& sheet, const SheetOrigin& origin, const std::string& description) {
  sheet.file_info = {{"FileName", origin.file},
                     {"FileVersion", "1"},
                     {"FileRevision", "1"},
                     {"EDSVersion", "4.0"},
                     {"Description", description},
                     {"CreationTime", origin.time},
                     {"CreationDate", origin.date},
                     {"CreatedBy", origin.command},
                     {"ModificationTime", origin.time},
                     {"ModificationDate", origin.date},
                     {"ModifiedBy", origin.command}};
}

/// `all`: the device runs at every bit rate, and has layer setting services.
void describe_device(Eds& sheet, const SheetOrigin& origin, bool all) {
  const EdsEntry* name = sheet.find(object::kDeviceName, 0);
  Eds::Fields& f = sheet.device_info;
  f = {{"VendorName", ""},
       {"VendorNumber", number_text(sheet, 1)},
       {"ProductName", name != nullptr && name->default_value ? name->default_value->text : ""},
       {"ProductNumber", number_text(sheet, 2)},
       {"RevisionNumber", number_text(sheet, 3)},
       {"OrderCode", ""}};
  for (const std::uint32_t rate : kBitRates)
    f.emplace_back("BaudRate_" + std::to_string(rate), all || rate * 1000 == origin.bit_rate ? "1" : "0");
  f.insert(f.end(), {{"SimpleBootUpMaster", "0"},
                     {"SimpleBootUpSlave", "1"},
                     {"Granularity", "8"},
                     {"DynamicChannelsSupported", "0"},
                     {"GroupMessaging", "0"},
                     {"NrOfRXPDO", std::to_string(count(sheet, object::kRpdoParameter))},
                     {"NrOfTXPDO", std::to_string(count(sheet, object::kTpdoParameter))},
                     {"LSS_Supported", all ? "1" : "0"}});
  sheet.dummy_usage.clear();
  for (int type = 1; type <= 7; ++type)
    sheet.dummy_usage.emplace_back("Dummy000" + std::to_string(type), all ? "1" : "0");
}

/// [Comments] in lines that every reader takes.
class Comments {
 public:
  void line(std::string text) { lines_.push_back(std::move(text)); }
  void places(const std::vector<std::string>& places) {
    constexpr std::size_t kInALine = 12;
    for (std::size_t i = 0; i < places.size(); i += kInALine) {
      std::string text = " ";
      for (std::size_t k = i; k < std::min(places.size(), i + kInALine); ++k) text += " " + places[k];
      lines_.push_back(text.substr(2));
    }
  }
  Eds::Fields fields() const {
    Eds::Fields out{{"Lines", std::to_string(lines_.size())}};
    for (std::size_t i = 0; i < lines_.size(); ++i)
      out.emplace_back("Line" + std::to_string(i + 1), lines_[i]);
    return out;
  }

 private:
  std::vector<std::string> lines_;
};

std::string ranges_text(const std::vector<IndexRange>& ranges) {
  std::string text;
  for (const IndexRange& r : ranges)
    text += (text.empty() ? "" : ", ") + address_text(r.first, 0).substr(0, 5) + "-" +
            address_text(r.last, 0).substr(0, 5);
  return text;
}

void say_what_is_known(DeviceSheet& sheet, const SheetOrigin& origin, bool of_sheet) {
  Comments comments;
  comments.line("Read by SDO from node " + std::to_string(origin.node) + ".");
  if (of_sheet) {
    comments.line("Objects, types, access and defaults are those of a data sheet that was given.");
    comments.line("Objects that the device says it does not have are left out.");
    comments.line("Where that sheet has no DefaultValue, it is the value at the time of reading.");
  } else {
    comments.line("DefaultValue is the value at the time of reading, which need not be the factory default.");
    comments.line(
        "Known: type, access and PDO mapping of objects of CiA 301 and CiA 402, as the standards have them.");
  }
  if (!origin.ranges.empty())
    comments.line("Indices that were asked for: " + ranges_text(origin.ranges) + ".");
  if (!sheet.guessed.empty()) {
    comments.line(
        "Guessed: the type, from the length of the value; access rw and no PDO mapping, without a trial. "
        "Of:");
    comments.places(sheet.guessed);
  }
  if (!sheet.left_out.empty()) {
    comments.line("There, but not described here, as they cannot be read and their type is not known:");
    comments.places(sheet.left_out);
  }
  if (!sheet.no_value.empty()) {
    comments.line("Without a DefaultValue, as no line can hold it:");
    comments.places(sheet.no_value);
  }
  comments.line("Commands, live values, errors and the serial number have no DefaultValue from the reading.");
  comments.line("Not tried: other bit rates than the present one, dummy mapping, granularity, LSS.");
  sheet.eds.comments = comments.fields();
}

bool missing(const SdoOutcome& outcome) {
  return outcome.abort == AbortCode::object_does_not_exist ||
         outcome.abort == AbortCode::subindex_does_not_exist;
}

/// What was read becomes the value of an entry that shall have one.
void take_reading(EdsEntry& e, const ReadObject& o, DeviceSheet& sheet) {
  if (!o.outcome.ok() || only_lives(o.index, o.subindex)) return;
  e.parameter_value = value_of(o.outcome.data, e.data_type);
  if (!e.parameter_value && !o.outcome.data.empty())
    sheet.no_value.push_back(address_text(o.index, o.subindex));
}

void add_found(DeviceSheet& sheet, const ReadObject& o) {
  const std::string where = address_text(o.index, o.subindex);
  const auto known = known_object(o.index, o.subindex);
  const ValueType* type = known ? type_numbered(known->data_type) : nullptr;
  EdsEntry e;
  if (type != nullptr && (!o.outcome.ok() || may_be(o.outcome.data, *type))) {
    e.data_type = known->data_type;
    e.access = !known->readable ? EdsAccess::wo : known->writable ? EdsAccess::rw : EdsAccess::ro;
    e.pdo_mapping = known->mappable;
  } else if (o.outcome.ok()) {
    const bool head = o.record && o.subindex == 0 && o.outcome.data.size() == 1;
    e.data_type = head ? kUnsigned8 : guess_type(o.outcome.data)->data_type;
    e.access = head ? EdsAccess::ro : EdsAccess::rw;
    sheet.guessed.push_back(where);
  } else {
    sheet.left_out.push_back(where);
    return;
  }
  take_reading(place(sheet.eds, o.index, o.subindex, o.record, std::move(e), nullptr), o, sheet);
  ++sheet.entries;
}

void remove(Eds& sheet, std::uint16_t index, std::uint8_t subindex) {
  const auto found = sheet.objects.find(index);
  if (found == sheet.objects.end()) return;
  found->second.subs.erase(subindex);
  if (found->second.subs.empty()) sheet.objects.erase(found);
}

void take_sheet(DeviceSheet& out, const std::vector<ReadObject>& objects, const Eds& eds) {
  out.eds.objects = eds.objects;
  for (auto& [index, object] : out.eds.objects) {
    object.entry.parameter_value.reset();
    for (auto& [subindex, entry] : object.subs) entry.parameter_value.reset();
  }
  for (const ReadObject& o : objects) {
    if (missing(o.outcome)) {
      remove(out.eds, o.index, o.subindex);
    } else if (EdsEntry* e = out.eds.find(o.index, o.subindex)) {
      if (!e->default_value) take_reading(*e, o, out);
    } else {
      add_found(out, o);
    }
  }
  out.entries = 0;
  for (const auto& [index, object] : out.eds.objects)
    out.entries += object.subs.empty() ? 1 : static_cast<int>(object.subs.size());
}

EdsAccess access_of(const ObjectSpec& row) {
  switch (row.access) {
    case Access::ro:
      return EdsAccess::ro;
    case Access::wo:
      return EdsAccess::wo;
    case Access::constant:
      return EdsAccess::constant;
    case Access::rw:
      break;
  }
  return row.mappable == Mappable::tpdo   ? EdsAccess::rwr
         : row.mappable == Mappable::rpdo ? EdsAccess::rww
                                          : EdsAccess::rw;
}

std::vector<std::uint8_t> bytes_of(const ObjectSpec& row, std::int64_t number) {
  if (size_of(row.type) == 0) return {row.text.begin(), row.text.end()};
  std::vector<std::uint8_t> out(size_of(row.type));
  store_le(static_cast<std::uint64_t>(number), out);
  return out;
}

/// The lower or upper limit of a row, where it is narrower than that of the type.
std::optional<EdsValue> limit_of(const ObjectSpec& row, bool upper) {
  const std::int64_t limit = upper ? row.high : row.low;
  const auto type = static_cast<std::uint16_t>(row.type);
  const int bits = eds_type_bits(type);
  const std::int64_t none =
      upper ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
  if (limit == none || bits < 8) return std::nullopt;
  if (!eds_type_real(type) && bits < 64) {
    const std::int64_t top = std::int64_t{1} << (eds_type_signed(type) ? bits - 1 : bits);
    const std::int64_t bottom = eds_type_signed(type) ? -top : 0;
    if (upper ? limit >= top - 1 : limit <= bottom) return std::nullopt;
  }
  return value_of(bytes_of(row, limit), type);
}

/// Most sub-indices of an index whose sub-index 0 counts what is in use; 0: of others.
int most_places(std::uint16_t index) {
  if (index == object::kPredefinedErrorField) return 254;
  const bool map = (index >= object::kRpdoMapping && index < object::kRpdoMapping + 0x200) ||
                   (index >= object::kTpdoMapping && index < object::kTpdoMapping + 0x200);
  return map ? static_cast<int>(kMaxMappedObjects) : 0;
}

}  // namespace

void read_unused_places(SdoAccess& access, NodeId node, std::vector<ReadObject>& objects,
                        const std::function<bool()>& over) {
  std::vector<ReadObject> more;
  for (ReadObject& head : objects) {
    if (head.subindex != 0 || !head.outcome.ok() || head.outcome.data.size() != 1) continue;
    const int most = most_places(head.index);
    for (int sub = head.outcome.data[0] + 1; sub <= most && !over(); ++sub) {
      ReadObject one{head.index, static_cast<std::uint8_t>(sub), {}, true};
      one.outcome = access.read(node, one.index, one.subindex);
      if (!one.outcome.answered() || missing(one.outcome)) break;
      head.record = true;
      more.push_back(std::move(one));
    }
  }
  std::move(more.begin(), more.end(), std::back_inserter(objects));
}

DeviceSheet sheet_of_device(const std::vector<ReadObject>& objects, const Eds* eds,
                            const SheetOrigin& origin) {
  DeviceSheet sheet;
  if (eds != nullptr) {
    take_sheet(sheet, objects, *eds);
  } else {
    for (const ReadObject& o : objects)
      if (!missing(o.outcome)) add_found(sheet, o);
  }
  values_to_defaults(sheet.eds, origin.node);
  describe_file(sheet.eds, origin,
                eds != nullptr ? "Objects of a data sheet that a device has" : "What was found in a device");
  describe_device(sheet.eds, origin, false);
  if (eds != nullptr) {
    if (!eds->device_info.empty()) sheet.eds.device_info = eds->device_info;
    if (!eds->dummy_usage.empty()) sheet.eds.dummy_usage = eds->dummy_usage;
    sheet.eds.modules = eds->modules;
  }
  say_what_is_known(sheet, origin, eds != nullptr);
  return sheet;
}

DeviceSheet sheet_of_rows(std::span<const ObjectSpec> rows, std::span<const ObjectSpec> hidden,
                          const Eds* eds, const SheetOrigin& origin) {
  DeviceSheet sheet;
  std::set<std::pair<std::uint16_t, std::uint8_t>> unseen;
  for (const ObjectSpec& row : hidden) unseen.emplace(row.index, row.subindex);
  std::set<std::uint16_t> records;
  for (const ObjectSpec& row : rows)
    if (row.subindex > 0 && !unseen.contains({row.index, row.subindex})) records.insert(row.index);
  for (const ObjectSpec& row : rows) {
    if (unseen.contains({row.index, row.subindex})) continue;
    EdsEntry e;
    e.data_type = static_cast<std::uint16_t>(row.type);
    e.access = access_of(row);
    e.pdo_mapping = row.mappable != Mappable::no;
    e.low_limit = limit_of(row, false);
    e.high_limit = limit_of(row, true);
    const auto bytes = bytes_of(row, row.value);
    if (!serial_number(row.index, row.subindex)) e.parameter_value = value_of(bytes, e.data_type);
    if (!e.parameter_value && !bytes.empty() && !serial_number(row.index, row.subindex))
      sheet.no_value.push_back(address_text(row.index, row.subindex));
    place(sheet.eds, row.index, row.subindex, records.contains(row.index), std::move(e), eds);
  }
  for (const auto& [index, object] : sheet.eds.objects)
    sheet.entries += object.subs.empty() ? 1 : static_cast<int>(object.subs.size());
  values_to_defaults(sheet.eds, origin.node);
  describe_file(sheet.eds, origin, "A simulated device");
  describe_device(sheet.eds, origin, true);
  Comments comments;
  comments.line("Written by the simulation of this device: every type, access, limit and default is known.");
  sheet.eds.comments = comments.fields();
  return sheet;
}

}  // namespace servogate::canopen
