// SPDX-License-Identifier: Apache-2.0
#include "machine/device.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/406/objects.hpp"
#include "firmware_if/canopen/master/drive/drive_fields.hpp"
#include "machine/check/boot_objects.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/findings.hpp"
#include "machine/keys/reader.hpp"
#include "machine/keys/sections.hpp"
#include "machine/loading/inverter_device.hpp"
#include "machine/loading/mode_names.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::machine {

namespace {

/// A whole number of the given base from the front of `text`.
template <typename Number>
bool take(std::string_view& text, int base, Number& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out, base);
  if (error != std::errc{} || end == text.data()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

class DeviceCheck {
 public:
  DeviceCheck(DeviceConfig& device, Reading& reading) : d_(device), reading_(reading) {}

  void all() {
    objects();
    pdos("rpdo", d_.rpdos);
    pdos("tpdo", d_.tpdos);
    modbus();
    homing_methods();
    ip_record();
    if (!d_.places.contains("kind")) return;  // unknown kind: said by the reader
    if (d_.terminals()) terminals();
    if (d_.kind == DeviceKind::inverter) check_inverter_device(d_, reading_);
    if (d_.kind == DeviceKind::pendant) check_pendant_device(d_, reading_);
    write_only();
    if (!d_.drive()) return;
    modes();
    if (d_.behaviour.sdo_only) return sdo_only();
    mapped_for_nothing();
    word("RPDO", d_.rpdos, 0x6040, "controlword");
    word("TPDO", d_.tpdos, 0x6041, "statusword");
  }

 private:
  Where at(const std::string& path) const { return find_place(d_.places, path); }

  void objects() {
    check_boot_objects(
        d_.objects, &d_, [this](const std::string& name) { return at("objects." + name); }, reading_);
  }

  void pdos(const std::string& key, std::vector<PdoConfig>& list) {
    std::map<int, int> numbers;
    for (std::size_t i = 0; i < list.size(); ++i) {
      PdoConfig& pdo = list[i];
      const std::string path = key + "." + std::to_string(i);
      transmission(key, path, pdo);
      if (key == "tpdo" && pdo.event > 0.0 && pdo.inhibit > pdo.event)
        reading_.error(at(path + ".inhibit"), finding::kInhibitAboveEvent,
                       {std::to_string(pdo.number), milliseconds(pdo.inhibit), milliseconds(pdo.event)});
      const auto [it, fresh] = numbers.try_emplace(pdo.number, at(path + ".number").line);
      if (!fresh)
        reading_.error(at(path + ".number"), finding::kPdoTwice,
                       {key, std::to_string(pdo.number), std::to_string(it->second)});
      mapping(key, path, pdo);
    }
  }

  /// Reserved are 241 to 251; only a TPDO can be asked for, and so often as `event` says.
  void transmission(const std::string& key, const std::string& path, const PdoConfig& pdo) {
    const std::string type = std::to_string(pdo.transmission);
    if (pdo.remote() && key == "rpdo")
      reading_.error(at(path + ".transmission"), finding::kPdoRemoteRpdo, {type});
    else if (pdo.remote() && pdo.event <= 0.0)
      reading_.error(at(path + ".transmission"), finding::kPdoRemotePeriod,
                     {std::to_string(pdo.number), type});
    else if (pdo.transmission > 240 && pdo.transmission < 254 && !pdo.remote())
      reading_.error(at(path + ".transmission"), finding::kPdoTransmission, {type});
  }

  void mapping(const std::string& key, const std::string& path, PdoConfig& pdo) {
    int bits = 0;
    for (std::size_t k = 0; k < pdo.object_texts.size(); ++k) {
      const auto object = parse_object(pdo.object_texts[k]);
      if (!object || object->bits == 0 || object->bits > 64) {
        reading_.error(at(path + ".objects." + std::to_string(k)), finding::kBadObject,
                       {pdo.object_texts[k], "6040:00/16"});
        continue;
      }
      // What is cut off would be another position.
      const canopen::ObjectInfo* standard = d_.drive() ? canopen::find_object(object->index) : nullptr;
      if (standard != nullptr && object->subindex == 0 && object->bits < standard->bits)
        reading_.error(at(path + ".objects." + std::to_string(k)), finding::kPdoWidth,
                       {pdo.object_texts[k], std::string(standard->name), std::to_string(standard->bits)});
      bits += object->bits;
      pdo.objects.push_back(*object);
    }
    if (bits > 64)
      reading_.error(at(path + ".objects"), finding::kPdoSize,
                     {key, std::to_string(pdo.number), std::to_string(bits)});
  }

  /// The loss of a module is seen by its process data, and what its outputs do then comes from their points.
  void terminals() {
    for (std::size_t i = 0; i < d_.tpdos.size(); ++i) {
      const PdoConfig& pdo = d_.tpdos[i];
      if ((pdo.transmission < 1 || pdo.transmission > 240) && pdo.event <= 0.0)
        reading_.error(at("tpdo." + std::to_string(i) + ".transmission"), finding::kPdoNeverComes,
                       {std::to_string(pdo.number), std::to_string(pdo.transmission)});
    }
    if (d_.kind != DeviceKind::canopen_io) return;
    namespace io = canopen::io;
    static constexpr std::uint16_t kOurs[] = {
        canopen::object::kErrorBehaviour, io::kPolarityOutput8,         io::kErrorModeOutput8,
        io::kErrorValueOutput8,           io::kErrorModeAnalogueOutput, io::kErrorValueAnalogueOutput};
    for (const auto& [text, value] : d_.objects)
      if (const auto object = parse_object(text);
          object && std::find(std::begin(kOurs), std::end(kOurs), object->index) != std::end(kOurs))
        reading_.error(at("objects." + text), finding::kObjectOfPoints, {text});
  }

  void homing_methods() {
    for (std::size_t i = 0; i < d_.behaviour.homing_methods.size(); ++i) {
      const std::string& text = d_.behaviour.homing_methods[i];
      std::string_view rest = text;
      int number = 0;
      if (!take(rest, 10, number) || !rest.empty() || number < -128 || number > 127 || number == 0)
        reading_.error(at("behaviour.homing_methods." + std::to_string(i)), finding::kHomingNumber, {text});
    }
  }

  /// Where ip is the mode for positions, every entry of its record is in an RPDO, the position among them.
  void ip_record() {
    const auto& record = d_.behaviour.ip_record;
    for (std::size_t i = 0; i < record.size(); ++i) {
      const Where where = at("behaviour.ip_record." + std::to_string(i));
      if (record[i] != "position" && record[i] != "velocity")
        reading_.error(where, finding::kUnknownChoice,
                       {"behaviour.ip_record", record[i], "position, velocity"});
      else if (d_.behaviour.position_mode == PositionMode::ip &&
               !maps(d_.rpdos, 0x60C1, static_cast<int>(i) + 1))
        reading_.error(where, finding::kIpRecord, {"60C1:0" + std::to_string(i + 1) + "/32", record[i]});
    }
    if (std::find(record.begin(), record.end(), "position") == record.end())
      reading_.error(at("behaviour.ip_record"), finding::kIpNoPosition, {});
  }

  static bool maps(const std::vector<PdoConfig>& pdos, std::uint16_t index, int subindex) {
    for (const PdoConfig& pdo : pdos)
      for (const PdoObject& o : pdo.objects)
        if (o.index == index && o.subindex == subindex) return true;
    return false;
  }

  void modbus() {
    const ModbusMap& m = d_.modbus;
    const struct {
      const char* key;
      int address, items;
    } kinds[] = {{"modbus.di_address", m.di_address, m.di_items()},
                 {"modbus.dq_address", m.dq_address, m.dq_count},
                 {"modbus.ai_address", m.ai_address, m.ai_count},
                 {"modbus.aq_address", m.aq_address, m.aq_count}};
    for (const auto& k : kinds)
      if (k.address + k.items > 0x10000)
        reading_.error(at(k.key), finding::kModbusBehindEnd,
                       {k.key, std::to_string(k.items), std::to_string(k.address)});
    const bool apart =
        m.di_address + m.di_items() <= m.ai_address || m.ai_address + m.ai_count <= m.di_address;
    if (m.di_as_registers && m.di_count > 0 && m.ai_count > 0 && !apart)
      reading_.error(at("modbus.di_as_registers"), finding::kModbusOverlap,
                     {std::to_string(m.di_address), std::to_string(m.di_address + m.di_items() - 1),
                      std::to_string(m.ai_address), std::to_string(m.ai_address + m.ai_count - 1)});
  }

  void word(const std::string& what, const std::vector<PdoConfig>& list, std::uint16_t index,
            const std::string& name) {
    for (const PdoConfig& pdo : list)
      for (const PdoObject& o : pdo.objects)
        if (o.index == index) return;
    char hex[8];
    std::snprintf(hex, sizeof hex, "%04Xh", index);
    reading_.error(at(what == "RPDO" ? "rpdo" : "tpdo"), finding::kPdoNoWord, {what, hex, name});
  }

  void modes();

  void sdo_only() {
    for (const auto& [key, list] : {std::pair("rpdo", &d_.rpdos), std::pair("tpdo", &d_.tpdos)})
      if (!list->empty()) reading_.error(at(key), finding::kSdoOnlyPdo, {key});
    const BehaviourConfig& b = d_.behaviour;
    const bool spindle = d_.kind == DeviceKind::spindle;
    if (spindle ? b.speed_mode == SpeedMode::csv : b.position_mode != PositionMode::pp)
      reading_.error(at("behaviour.sdo_only"), finding::kSdoOnlyMode,
                     {spindle ? "speed_mode" : "position_mode", spindle ? "pv, vl" : "pp"});
    if (b.brake_bit >= 0) reading_.error(at("behaviour.brake_bit"), finding::kSdoOnlyBrake, {});
  }

  bool has_setting(const PdoObject& o) const {
    return std::any_of(d_.objects.begin(), d_.objects.end(), [&o](const auto& setting) {
      const auto object = parse_object(setting.first);
      return object && object->index == o.index && object->subindex == o.subindex;
    });
  }

  /// What the drive is sent and nobody gives would be 0: a torque limit of 0, for one. What it sends and
  /// nobody takes loads the bus.
  void mapped_for_nothing() {
    const canopen::DriveProfile profile = drive_profile(d_, NodeConfig{}, 0);
    const auto each = [&](const std::string& key, const std::vector<PdoConfig>& list, const auto& found) {
      for (std::size_t i = 0; i < list.size(); ++i)
        for (std::size_t k = 0; k < list[i].objects.size(); ++k)
          if (list[i].objects[k].index >= 0x20 && list[i].objects.size() == list[i].object_texts.size())
            found(list[i].objects[k], list[i],
                  at(key + "." + std::to_string(i) + ".objects." + std::to_string(k)), k);
    };
    each("rpdo", d_.rpdos, [&](const PdoObject& o, const PdoConfig& pdo, const Where& where, std::size_t k) {
      if (!canopen::written_in_cycle(profile, o.index, o.subindex) && !has_setting(o))
        reading_.error(where, finding::kNobodyWrites, {pdo.object_texts[k], std::to_string(pdo.number)});
    });
    if (d_.behaviour.fixed_pdo_map) return;  // the drive sends it whether it is wanted or not
    each("tpdo", d_.tpdos, [&](const PdoObject& o, const PdoConfig& pdo, const Where& where, std::size_t k) {
      if (!canopen::read_in_cycle(o.index, o.subindex))
        reading_.warning(where, finding::kNobodyReads, {pdo.object_texts[k], std::to_string(pdo.number)});
    });
  }

  void write_only() {
    for (std::size_t i = 0; i < d_.write_only.size(); ++i)
      if (!parse_object(d_.write_only[i]))
        reading_.error(at("write_only." + std::to_string(i)), finding::kBadObject,
                       {d_.write_only[i], "60C4:06/8"});
  }

  DeviceConfig& d_;
  Reading& reading_;
};

void DeviceCheck::modes() {
  for (std::size_t i = 0; i < d_.behaviour.modes.size(); ++i)
    if (mode_of(d_.behaviour.modes[i]) == canopen::OperationMode::none)
      reading_.error(at("behaviour.modes." + std::to_string(i)), finding::kUnknownChoice,
                     {"behaviour.modes", d_.behaviour.modes[i], "pp, vl, pv, tq, hm, ip, csp, csv, cst"});
}

}  // namespace

bool has_homing_method(const DeviceConfig& device, int method) {
  const auto& listed = device.behaviour.homing_methods;
  if (!listed.empty()) return std::find(listed.begin(), listed.end(), std::to_string(method)) != listed.end();
  return (method >= 1 && method <= 14) || (method >= 17 && method <= 30) || (method >= 33 && method <= 37);
}

int PdoConfig::bytes() const {
  int bits = 0;
  for (const PdoObject& o : objects) bits += o.bits;
  return (bits + 7) / 8;
}

Where DeviceConfig::where(std::string_view path) const { return find_place(places, path); }

std::string_view DeviceConfig::error_text(std::uint16_t code, text::Language language) const {
  for (const DeviceError& e : errors)
    if (e.code == code) return language == text::Language::russian ? e.russian : e.english;
  return {};
}

bool DeviceResult::ok() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

std::optional<PdoObject> parse_object(std::string_view text) {
  PdoObject out;
  if (text.size() < 4 || !take(text, 16, out.index)) return std::nullopt;
  if (text.starts_with(':')) {
    text.remove_prefix(1);
    if (!take(text, 16, out.subindex)) return std::nullopt;
  }
  if (text.starts_with('/')) {
    text.remove_prefix(1);
    if (!take(text, 10, out.bits) || out.bits == 0) return std::nullopt;
  }
  if (!text.empty()) return std::nullopt;
  return out;
}

DeviceResult parse_device(std::string_view text, const std::string& file) {
  DeviceResult out;
  Reading reading;
  reading.file = file;
  out.device.file = file;
  if (read_file_text(text, section_of<DeviceConfig>(), &out.device, reading)) {
    if (reading.unread.contains("kind")) reading.places.erase("kind");
    out.device.places = std::move(reading.places);
    DeviceCheck(out.device, reading).all();
  }
  sort_findings(reading.findings);
  out.findings = std::move(reading.findings);
  return out;
}

DeviceResult load_device(const std::string& path) {
  std::string reason;
  if (const auto text = files::read_file(path, files::kMostOfSettings, reason))
    return parse_device(*text, path);
  DeviceResult out;
  out.findings.push_back({text::Severity::error, path, 1, 1, &finding::kFileMissing, {reason}});
  return out;
}

}  // namespace servogate::machine
