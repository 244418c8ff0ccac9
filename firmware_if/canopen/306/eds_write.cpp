// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {
namespace {

std::string hex4(std::uint16_t index) {
  char buffer[8];
  std::snprintf(buffer, sizeof buffer, "%04X", index);
  return buffer;
}
template <class T>
std::string hex(T value) {
  return eds_number_text({static_cast<std::int64_t>(value), false});
}

constexpr bool mandatory(std::uint16_t index) noexcept {
  return index == 0x1000 || index == 0x1001 || index == 0x1018;
}
constexpr bool manufacturer(std::uint16_t index) noexcept { return index >= 0x2000 && index < 0x6000; }

class Writer {
 public:
  explicit Writer(bool dcf) : dcf_(dcf) {}

  std::string write(const Eds& eds) {
    fields("FileInfo", eds.file_info);
    fields("DeviceInfo", eds.device_info);
    if (dcf_) commissioning(eds.commissioning.value_or(EdsCommissioning{}));
    if (!eds.dummy_usage.empty()) fields("DummyUsage", eds.dummy_usage);
    if (!eds.comments.empty()) fields("Comments", eds.comments);
    list("MandatoryObjects", eds, [](std::uint16_t i) { return mandatory(i); });
    list("OptionalObjects", eds, [](std::uint16_t i) { return !mandatory(i) && !manufacturer(i); });
    list("ManufacturerObjects", eds, [](std::uint16_t i) { return manufacturer(i); });
    for (const auto& [index, object] : eds.objects) write_object(hex4(index), object);
    modules(eds);
    return std::move(out_);
  }

 private:
  void section(const std::string& name) { out_ += (out_.empty() ? "[" : "\r\n[") + name + "]\r\n"; }
  void field(std::string_view key, std::string_view value) {
    out_.append(key).append("=").append(value).append("\r\n");
  }
  void fields(const std::string& name, const Eds::Fields& all) {
    section(name);
    for (const auto& [key, value] : all) field(key, value);
  }

  void commissioning(const EdsCommissioning& c) {
    section("DeviceComissioning");
    field("NodeID", hex(c.node));
    field("NodeName", c.node_name);
    field("Baudrate", std::to_string(c.kbit_s));
    field("NetNumber", std::to_string(c.network));
    field("NetworkName", c.network_name);
    field("CANopenManager", c.manager ? "1" : "0");
    field("LSS_SerialNumber", hex(c.lss_serial));
  }

  template <class Belongs>
  void list(const std::string& name, const Eds& eds, Belongs belongs) {
    std::string entries;
    int count = 0;
    for (const auto& [index, object] : eds.objects)
      if (belongs(index)) entries += std::to_string(++count) + "=0x" + hex4(index) + "\r\n";
    section(name);
    field("SupportedObjects", std::to_string(count));
    out_ += entries;
  }

  void value(std::string_view key, const std::optional<EdsValue>& v) {
    if (v) field(key, v->text);
  }
  void entry(const std::string& name, const EdsEntry& e, const EdsObject* whole) {
    section(name);
    field("ParameterName", e.name);
    field("ObjectType", hex(static_cast<int>(e.type)));
    if (whole && !whole->subs.empty()) field("SubNumber", hex(whole->subs.size()));
    if (e.flags != 0) field("ObjFlags", hex(e.flags));
    if (dcf_ && !e.denotation.empty()) field("Denotation", e.denotation);
    if (e.data_type == 0) return;
    field("DataType", "0x" + hex4(e.data_type));
    field("AccessType", eds_access_word(e.access));
    value("DefaultValue", e.default_value);
    value("LowLimit", e.low_limit);
    value("HighLimit", e.high_limit);
    field("PDOMapping", e.pdo_mapping ? "1" : "0");
    if (dcf_) value("ParameterValue", e.parameter_value);
  }
  void write_object(const std::string& name, const EdsObject& object) {
    entry(name, object.entry, &object);
    for (const auto& [subindex, sub] : object.subs) {
      char buffer[8];
      std::snprintf(buffer, sizeof buffer, "sub%X", subindex);
      entry(name + buffer, sub, nullptr);
    }
  }

  void modules(const Eds& eds) {
    if (eds.modules.empty()) return;
    section("SupportedModules");
    field("NrOfEntries", std::to_string(eds.modules.size()));
    for (const auto& [number, module] : eds.modules) write_module("M" + std::to_string(number), module);
    if (!dcf_) return;
    section("ConnectedModules");
    field("NrOfEntries", std::to_string(eds.connected_modules.size()));
    int slot = 0;
    for (const int number : eds.connected_modules) field(std::to_string(++slot), std::to_string(number));
  }
  void write_module(const std::string& prefix, const EdsModule& module) {
    section(prefix + "ModuleInfo");
    field("ProductName", module.name);
    indices(prefix + "FixedObjects", module.fixed);
    for (const auto& [index, object] : module.fixed) write_object(prefix + "FixedObj" + hex4(index), object);
    indices(prefix + "SubExtends", module.extensions);
    for (const auto& [index, extension] : module.extensions) {
      entry(prefix + "SubExt" + hex4(index), extension.entry, nullptr);
      field("Count", std::to_string(extension.count));
      field("ObjExtend", "0");
    }
  }
  template <class Map>
  void indices(const std::string& name, const Map& map) {
    section(name);
    field("NrOfEntries", std::to_string(map.size()));
    int count = 0;
    for (const auto& [index, content] : map) field(std::to_string(++count), "0x" + hex4(index));
  }

  bool dcf_;
  std::string out_;
};

}  // namespace

std::string write_eds(const Eds& eds) { return Writer(false).write(eds); }
std::string write_dcf(const Eds& eds) { return Writer(true).write(eds); }

}  // namespace servogate::canopen
