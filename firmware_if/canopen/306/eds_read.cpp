// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <set>

#include "firmware_if/canopen/306/eds_entry.hpp"
#include "firmware_if/canopen/306/eds_text.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kUnsigned8 = 0x05;
constexpr std::int64_t kMostSubs = 254;

constexpr bool hex_digit(char c) noexcept {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}
bool starts_with_word(std::string_view text, std::string_view word) noexcept {
  return text.size() >= word.size() && same_word(text.substr(0, word.size()), word);
}

/// What the name of a section means: "1018", "1018sub1", "1003Name", with a module's prefix before it.
struct SectionName {
  enum class Part : std::uint8_t { none, object, sub, names, values, denotations } part = Part::none;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::string canonical;
};

std::string hex4(std::uint16_t index) {
  char buffer[8];
  std::snprintf(buffer, sizeof buffer, "%04X", index);
  return buffer;
}

SectionName::Part part_of(std::string_view tail, std::uint8_t& subindex) {
  using Part = SectionName::Part;
  while (!tail.empty() && tail.front() == ' ') tail.remove_prefix(1);
  if (tail.empty()) return Part::object;
  if (same_word(tail, "Name")) return Part::names;
  if (same_word(tail, "Value")) return Part::values;
  if (same_word(tail, "Denotation")) return Part::denotations;
  if (!starts_with_word(tail, "sub")) return Part::none;
  tail.remove_prefix(3);
  while (!tail.empty() && tail.front() == ' ') tail.remove_prefix(1);
  const auto [end, error] = std::from_chars(tail.data(), tail.data() + tail.size(), subindex, 16);
  return error == std::errc{} && end == tail.data() + tail.size() ? Part::sub : Part::none;
}

SectionName classify_section(std::string_view name) {
  SectionName found;
  if (starts_with_word(name, "0x")) name.remove_prefix(2);
  if (name.size() < 4 || !std::all_of(name.begin(), name.begin() + 4, hex_digit)) return found;
  std::from_chars(name.data(), name.data() + 4, found.index, 16);
  found.part = part_of(name.substr(4), found.subindex);
  found.canonical = hex4(found.index);
  if (found.part == SectionName::Part::sub) {
    char buffer[16];
    std::snprintf(buffer, sizeof buffer, "%04Xsub%X", found.index, found.subindex);
    found.canonical = buffer;
  }
  return found;
}

// "DEAD" may be a word as well as an index.
bool describes_object(const IniSection& section) {
  return section.entry("ParameterName") || section.entry("ObjectType") || section.entry("DataType") ||
         section.entry("SubNumber");
}

// What stays of an entry that turns out to hold others.
EdsEntry container(const EdsEntry& entry, EdsObjectType type) {
  EdsEntry e;
  e.name = entry.name;
  e.denotation = entry.denotation;
  e.flags = entry.flags;
  e.type = type;
  e.data_type = 0;
  return e;
}

// Sub-index 0 of an array.
EdsEntry counter(std::int64_t count) {
  EdsEntry e;
  e.name = "NrOfObjects";
  e.data_type = kUnsigned8;
  e.access = EdsAccess::ro;
  const EdsNumber number{count, false};
  e.default_value = EdsValue{eds_number_text(number), number};
  return e;
}

Eds::Fields fields_of(const IniSection& section) {
  Eds::Fields fields;
  for (const IniEntry& e : section.entries) fields.emplace_back(e.key, e.value);
  return fields;
}

class EdsReader {
 public:
  explicit EdsReader(EdsFindings& findings) : findings_(findings) {}

  Eds read(std::string_view bytes) {
    sections_ = read_ini(bytes, findings_);
    read_objects(eds_.objects, "");
    for (const IniSection& s : sections_) read_information(s);
    read_modules();
    connect_modules();
    check_lists();
    if (eds_.objects.empty()) findings_.error(eds_text::kNoObjects, 1);
    return std::move(eds_);
  }

 private:
  using Objects = std::map<std::uint16_t, EdsObject>;

  /// The sections whose names begin with `prefix`, first the objects, then what stands below them.
  void read_objects(Objects& objects, std::string_view prefix) {
    for (const bool top : {true, false}) {
      for (const IniSection& s : sections_) {
        if (!starts_with_word(s.name, prefix)) continue;
        const SectionName name = classify_section(std::string_view(s.name).substr(prefix.size()));
        if (name.part == SectionName::Part::none || (name.part == SectionName::Part::object) != top) continue;
        if (top)
          read_object(objects, s, name);
        else
          read_below(objects, s, name);
      }
    }
    if (prefix.empty()) check_counts();
  }

  void read_object(Objects& objects, const IniSection& s, const SectionName& name) {
    if (!describes_object(s)) return;
    EdsObject& object = objects[name.index];
    if (prefixless(s) && !same_word(s.name, name.canonical))
      findings_.warn(eds_text::kSectionName, s.line, {s.name, name.canonical});
    const EdsFieldReader fields(s, findings_);
    object.entry = fields.entry(true);
    expand_compact(object, s, fields);
  }

  bool prefixless(const IniSection& s) const {
    return !s.name.empty() && (s.name[0] != 'M' && s.name[0] != 'm');
  }

  void expand_compact(EdsObject& object, const IniSection& s, const EdsFieldReader& fields) {
    std::int64_t count = fields.integer("CompactSubObj", 0);
    if (count <= 0) return;
    if (count > kMostSubs) {
      findings_.warn(eds_text::kCompact, s.entry("CompactSubObj")->line, {s.name, std::to_string(count)});
      count = kMostSubs;
    }
    // The fields of the object are those of every sub-index.
    IniSection plain = s;
    std::erase_if(plain.entries, [](const IniEntry& e) {
      return same_word(e.key, "ObjectType") || same_word(e.key, "SubNumber");
    });
    const EdsEntry each = EdsFieldReader(plain, findings_).entry(false);
    if (object.entry.type != EdsObjectType::record) object.entry.type = EdsObjectType::array;
    object.entry = container(object.entry, object.entry.type);
    object.subs[0] = counter(count);
    for (std::int64_t i = 1; i <= count; ++i) {
      EdsEntry& sub = object.subs[static_cast<std::uint8_t>(i)];
      sub = each;
      sub.name = object.entry.name + std::to_string(i);
    }
  }

  void read_below(Objects& objects, const IniSection& s, const SectionName& name) {
    auto place = objects.find(name.index);
    if (name.part != SectionName::Part::sub) {
      if (place != objects.end()) read_list(place->second, s, name.part);
      return;
    }
    if (!describes_object(s)) return;
    if (place == objects.end()) {
      findings_.warn(eds_text::kOrphan, s.line, {s.name, hex4(name.index)});
      place = objects.emplace(name.index, EdsObject{}).first;
      place->second.entry = container({}, EdsObjectType::record);
    } else if (prefixless(s) && !same_word(s.name, name.canonical)) {
      findings_.warn(eds_text::kSectionName, s.line, {s.name, name.canonical});
    }
    make_container(place->second.entry, s);
    place->second.subs[name.subindex] =
        EdsFieldReader(s, findings_).entry(false, name.subindex == 0 ? kUnsigned8 : std::uint16_t{0});
  }

  // An object with sub-indices is a record, whatever it calls itself.
  void make_container(EdsEntry& entry, const IniSection& s) {
    if (entry.type == EdsObjectType::array || entry.type == EdsObjectType::record ||
        entry.type == EdsObjectType::defstruct)
      return;
    findings_.warn(eds_text::kObjectType, s.line,
                   {s.name, eds_number_text({static_cast<int>(entry.type), false}), "0x9"});
    entry = container(entry, EdsObjectType::record);
  }

  // [1003Name], [1003Value], [1003Denotation] of compact objects: NrOfEntries and sub-index=text.
  void read_list(EdsObject& object, const IniSection& s, SectionName::Part part) {
    const EdsFieldReader fields(s, findings_);
    for (const IniEntry& e : s.entries) {
      const auto number = parse_eds_number(e.key);
      if (!number || number->number.value < 0 || number->number.value > kMostSubs) continue;
      const auto sub = object.subs.find(static_cast<std::uint8_t>(number->number.value));
      if (sub == object.subs.end()) continue;
      if (part == SectionName::Part::names) sub->second.name = e.value;
      if (part == SectionName::Part::denotations) sub->second.denotation = e.value;
      if (part == SectionName::Part::values)
        if (auto value = fields.parameter(e.key, sub->second)) sub->second.parameter_value = value;
    }
  }

  void check_counts() {
    for (const IniSection& s : sections_) {
      const SectionName name = classify_section(s.name);
      const IniEntry* count = s.entry("SubNumber");
      if (name.part != SectionName::Part::object || !count || s.entry("CompactSubObj")) continue;
      const auto found = eds_.objects.find(name.index);
      if (found == eds_.objects.end()) continue;
      const std::int64_t said = EdsFieldReader(s, findings_).integer("SubNumber", 0);
      if (said != static_cast<std::int64_t>(found->second.subs.size()))
        findings_.warn(eds_text::kSubNumber, count->line,
                       {s.name, count->value, std::to_string(found->second.subs.size())});
    }
  }

  void read_information(const IniSection& s) {
    if (same_word(s.name, "FileInfo")) eds_.file_info = fields_of(s);
    if (same_word(s.name, "DeviceInfo")) eds_.device_info = fields_of(s);
    if (same_word(s.name, "DummyUsage")) eds_.dummy_usage = fields_of(s);
    if (same_word(s.name, "Comments")) eds_.comments = fields_of(s);
    if (same_word(s.name, "DeviceComissioning") || same_word(s.name, "DeviceCommissioning"))
      read_commissioning(s);
    if (same_word(s.name, "ConnectedModules")) {
      for (const IniEntry& e : s.entries) {
        const auto value = parse_eds_number(e.value);
        if (!same_word(e.key, "NrOfEntries") && value && value->number.value > 0 &&
            value->number.value < 0xFFFF && eds_.connected_modules.size() < kMostSubs)
          eds_.connected_modules.push_back(static_cast<int>(value->number.value));
      }
    }
  }

  void read_commissioning(const IniSection& s) {
    const EdsFieldReader fields(s, findings_);
    EdsCommissioning c;
    const std::int64_t node = fields.integer("NodeID", 0);
    c.node = node >= 0 && node <= kMaxNode ? static_cast<NodeId>(node) : NodeId{0};
    c.node_name = fields.text("NodeName");
    c.network_name = fields.text("NetworkName");
    c.network = static_cast<std::uint32_t>(fields.integer("NetNumber", 0));
    c.kbit_s = static_cast<std::uint32_t>(fields.integer("Baudrate", 0));
    c.manager = fields.boolean("CANopenManager");
    c.lss_serial = static_cast<std::uint32_t>(fields.integer("LSS_SerialNumber", 0));
    eds_.commissioning = c;
  }

  // [M1ModuleInfo], [M1FixedObj6000], [M1SubExt6000].
  void read_modules() {
    for (const IniSection& s : sections_) {
      if (s.name.empty() || (s.name[0] != 'M' && s.name[0] != 'm')) continue;
      int number = 0;
      const char* end = s.name.data() + s.name.size();
      const auto [stop, error] = std::from_chars(s.name.data() + 1, end, number);
      if (error != std::errc{} || number < 1) continue;
      const std::string_view rest(stop, end);
      const EdsFieldReader fields(s, findings_);
      if (same_word(rest, "ModuleInfo")) eds_.modules[number].name = fields.text("ProductName");
      if (starts_with_word(rest, "SubExt") && !same_word(rest, "SubExtends")) {
        const SectionName name = classify_section(rest.substr(6));
        if (name.part != SectionName::Part::object) continue;
        auto& extension = eds_.modules[number].extensions[name.index];
        extension.entry = fields.entry(false);
        extension.count =
            static_cast<std::uint8_t>(std::clamp<std::int64_t>(fields.integer("Count", 1), 1, kMostSubs));
      }
    }
    for (auto& [number, module] : eds_.modules)
      read_objects(module.fixed, "M" + std::to_string(number) + "FixedObj");
  }

  void connect_modules() {
    for (const int number : eds_.connected_modules) {
      const auto found = eds_.modules.find(number);
      if (found == eds_.modules.end()) {
        findings_.warn(eds_text::kModule, 1, {std::to_string(number)});
        continue;
      }
      for (const auto& [index, object] : found->second.fixed) eds_.objects.try_emplace(index, object);
      for (const auto& [index, extension] : found->second.extensions) extend(index, extension);
    }
  }

  // A DCF that was written with its modules in place lists their entries already.
  void extend(std::uint16_t index, const EdsModule::Extension& extension) {
    EdsObject& object = eds_.objects[index];
    if (object.subs.empty()) {
      object.entry = container(extension.entry, EdsObjectType::array);
    }
    int& done = extended_[index];
    for (int i = 0; i < extension.count && done < kMostSubs; ++i) {
      const auto place = static_cast<std::uint8_t>(++done);
      object.subs.try_emplace(place, extension.entry);
    }
    object.subs[0] = counter(object.subs.rbegin()->first);
  }

  void check_lists() {
    std::set<std::uint16_t> listed;
    bool any = false;
    for (const IniSection& s : sections_) {
      if (!same_word(s.name, "MandatoryObjects") && !same_word(s.name, "OptionalObjects") &&
          !same_word(s.name, "ManufacturerObjects"))
        continue;
      any = true;
      std::size_t entries = 0;
      for (const IniEntry& e : s.entries) {
        if (same_word(e.key, "SupportedObjects")) continue;
        const auto index = parse_eds_number(e.value);
        if (!index) continue;
        ++entries;
        listed.insert(static_cast<std::uint16_t>(index->number.value));
        if (!eds_.objects.contains(static_cast<std::uint16_t>(index->number.value)))
          findings_.warn(eds_text::kNoSection, e.line, {e.value, s.name});
      }
      const std::int64_t said = EdsFieldReader(s, findings_).integer("SupportedObjects", 0);
      if (said != static_cast<std::int64_t>(entries))
        findings_.warn(eds_text::kListCount, s.line, {s.name, std::to_string(said), std::to_string(entries)});
    }
    if (!any) return;
    for (const IniSection& s : sections_) {
      const SectionName name = classify_section(s.name);
      if (name.part == SectionName::Part::object && describes_object(s) && !listed.contains(name.index))
        findings_.warn(eds_text::kNotListed, s.line, {s.name});
    }
  }

  EdsFindings& findings_;
  std::vector<IniSection> sections_;
  Eds eds_;
  std::map<std::uint16_t, int> extended_;
};

}  // namespace

EdsResult read_eds(std::string_view bytes, std::string_view file) {
  EdsFindings findings{std::string(file)};
  EdsResult result;
  result.eds = EdsReader(findings).read(bytes);
  result.findings = findings.take();
  return result;
}

}  // namespace servogate::canopen
