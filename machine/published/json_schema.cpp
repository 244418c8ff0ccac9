// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "machine/keys/json.hpp"
#include "machine/keys/sections.hpp"
#include "machine/load.hpp"
#include "machine/published/published.hpp"

namespace servogate::machine {

namespace {

Json object_of(const Section& section);

Json of_type(const char* type) { return Json::object({{"type", type}}); }

void set_bounds(const Key& key, const char* type, Json& out) {
  out["type"] = type;
  if (std::isfinite(key.rule.min))
    out[key.rule.above_min ? "exclusiveMinimum" : "minimum"] = json_number(key.rule.min);
  if (std::isfinite(key.rule.max)) out["maximum"] = json_number(key.rule.max);
}

/// A number in the key's unit, or a string of a number and one of the spellings.
void set_quantity(const Key& key, const char* type, Json& out) {
  if (key.rule.unit == Unit::none) return set_bounds(key, type, out);
  std::string units;
  for (const char c : unit_spellings(key.rule.unit, AxisUnits::either)) units += c == ',' ? '|' : c;
  for (std::size_t at = units.find("| "); at != std::string::npos; at = units.find("| "))
    units.erase(at + 1, 1);
  Json plain;
  set_bounds(key, type, plain);
  const std::string pattern = "^ *[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)? *(" + units + ") *$";
  out["anyOf"] = {plain, {{"type", "string"}, {"pattern", pattern}}};
}

void set_list(Json items, Json& out) {
  out["type"] = "array";
  out["items"] = std::move(items);
}

void set_pair(Json items, Json& out) {
  out["type"] = "array";
  out["minItems"] = 2;
  out["maxItems"] = 2;
  out["items"] = std::move(items);
}

void set_type(const Key& key, Json& out) {
  Json inner;
  switch (key.kind) {
    case KeyKind::boolean:
      out["type"] = "boolean";
      return;
    case KeyKind::integer:
    case KeyKind::long_integer:
      return set_quantity(key, "integer", out);
    case KeyKind::number:
      return set_quantity(key, "number", out);
    case KeyKind::text:
      out["type"] = "string";
      if (key.rule.required) out["minLength"] = 1;
      return;
    case KeyKind::choice:
      for (const std::string_view choice : key.choices) out["enum"].push_back(std::string(choice));
      return;
    case KeyKind::place:
      out["type"] = "string";
      out["pattern"] = "^(SA|SK|SYVAR)[0-9]*(\\.(BL|BY|IN|LI|RE|LR|[0-9]*CH))?$";
      return;
    case KeyKind::texts:
      return set_list(of_type("string"), out);
    case KeyKind::numbers:
      out["type"] = "object";
      out["additionalProperties"] = of_type("number");
      return;
    case KeyKind::ratio:
      set_bounds(key, "integer", inner);
      return set_pair(std::move(inner), out);
    case KeyKind::pairs:
      set_pair(of_type("number"), inner);
      return set_list(std::move(inner), out);
    case KeyKind::table:
      out.update(object_of(key.child()));
      return;
    case KeyKind::tables:
      return set_list(object_of(key.child()), out);
  }
}

/// null: none that a file could have.
Json default_of(const Key& key, void* defaults) {
  if (key.rule.required || key.rule.computed) return {};
  void* member = key.member(defaults);
  switch (key.kind) {
    case KeyKind::boolean:
      return *static_cast<bool*>(member);
    case KeyKind::integer:
      return *static_cast<int*>(member);
    case KeyKind::long_integer:
      return *static_cast<std::int64_t*>(member);
    case KeyKind::number:
      return json_number(*static_cast<double*>(member));
    case KeyKind::text:
      return static_cast<std::string*>(member)->empty() ? Json() : Json(*static_cast<std::string*>(member));
    case KeyKind::choice:
      return std::string(key.choices[*static_cast<std::uint8_t*>(member)]);
    default:
      return {};
  }
}

Json object_of(const Section& section) {
  Json out{{"type", "object"}, {"additionalProperties", false}};
  for (const Key& key : section.keys)
    if (key.rule.required) out["required"].push_back(std::string(key.name));
  Json properties = Json::object();
  for (const Key& key : section.keys) {
    Json property = Json::object({{"description", std::string(key.english)}});
    if (Json value = default_of(key, section.defaults()); !value.is_null()) property["default"] = value;
    set_type(key, property);
    properties[std::string(key.name)] = std::move(property);
  }
  out["properties"] = std::move(properties);
  return out;
}

}  // namespace

std::string schema_of(const Section& section, const std::string& title) {
  Json out{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  out.update(object_of(section));
  return written(out, 1) + "\n";
}

std::string json_schema() {
  return schema_of(section_of<MachineConfig>(), "servogate machine file, schema 1");
}

}  // namespace servogate::machine
