// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gateway/machine/keys/json.hpp"
#include "gateway/machine/keys/sections.hpp"
#include "gateway/machine/load.hpp"
#include "gateway/machine/published/published.hpp"

namespace servogate::machine {

namespace {

class SchemaWriter {
 public:
  std::string document(const Section& section, const std::string& title) {
    out_ =
        "{\n  \"$schema\": \"http://json-schema.org/draft-07/schema#\",\n  \"title\": " + json_string(title) +
        ",\n";
    body(section, 1);
    return out_ + "\n}\n";
  }

 private:
  void indent(int depth) { out_.append(static_cast<std::size_t>(depth) * 2, ' '); }

  /// "type", "properties", "required" and "additionalProperties" of an object, without its braces.
  void body(const Section& section, int depth) {
    indent(depth);
    out_ += "\"type\": \"object\",\n";
    indent(depth);
    out_ += "\"additionalProperties\": false,\n";
    required(section, depth);
    indent(depth);
    out_ += "\"properties\": {\n";
    for (std::size_t i = 0; i < section.keys.size(); ++i) {
      property(section.keys[i], section.defaults(), depth + 1);
      out_ += i + 1 == section.keys.size() ? "\n" : ",\n";
    }
    indent(depth);
    out_ += "}";
  }

  void required(const Section& section, int depth) {
    std::string names;
    for (const Key& key : section.keys)
      if (key.rule.required) names += (names.empty() ? "" : ", ") + json_string(key.name);
    if (names.empty()) return;
    indent(depth);
    out_ += "\"required\": [" + names + "],\n";
  }

  void property(const Key& key, void* defaults, int depth) {
    indent(depth);
    out_ += json_string(key.name) + ": {\"description\": " + json_string(key.english);
    if (const std::string value = default_value(key, defaults); !value.empty())
      out_ += ", \"default\": " + value;
    out_ += ", ";
    type(key, depth);
    out_ += "}";
  }

  void type(const Key& key, int depth) {
    switch (key.kind) {
      case KeyKind::boolean:
        out_ += "\"type\": \"boolean\"";
        return;
      case KeyKind::integer:
      case KeyKind::long_integer:
        quantity(key, "integer");
        return;
      case KeyKind::number:
        quantity(key, "number");
        return;
      case KeyKind::text:
        out_ += key.rule.required ? "\"type\": \"string\", \"minLength\": 1" : "\"type\": \"string\"";
        return;
      case KeyKind::choice:
        choice(key);
        return;
      case KeyKind::place:
        out_ +=
            "\"type\": \"string\", \"pattern\": "
            "\"^(SA|SK|SYVAR)[0-9]*(\\\\.(BL|BY|IN|LI|RE|LR|[0-9]*CH))?$\"";
        return;
      case KeyKind::texts:
        out_ += "\"type\": \"array\", \"items\": {\"type\": \"string\"}";
        return;
      case KeyKind::numbers:
        out_ += "\"type\": \"object\", \"additionalProperties\": {\"type\": \"number\"}";
        return;
      case KeyKind::ratio:
        out_ += "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": {" +
                bounds(key, "integer") + "}";
        return;
      case KeyKind::pairs:
        out_ +=
            "\"type\": \"array\", \"items\": {\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, "
            "\"items\": {\"type\": \"number\"}}";
        return;
      case KeyKind::table:
        out_ += "\n";
        body(key.child(), depth + 1);
        return;
      case KeyKind::tables:
        out_ += "\"type\": \"array\", \"items\": {\n";
        body(key.child(), depth + 1);
        out_ += "}";
        return;
    }
  }

  static std::string bounds(const Key& key, const std::string& type) {
    std::string out = "\"type\": \"" + type + "\"";
    if (std::isfinite(key.rule.min))
      out += std::string(key.rule.above_min ? ", \"exclusiveMinimum\": " : ", \"minimum\": ") +
             json_number(key.rule.min);
    if (std::isfinite(key.rule.max)) out += ", \"maximum\": " + json_number(key.rule.max);
    return out;
  }

  /// A number in the key's unit, or a string of a number and one of the spellings.
  void quantity(const Key& key, const std::string& type) {
    if (key.rule.unit == Unit::none) {
      out_ += bounds(key, type);
      return;
    }
    std::string units;
    for (const char c : unit_spellings(key.rule.unit, AxisUnits::either)) {
      if (c == ',')
        units += '|';
      else
        units += c;
    }
    for (std::size_t at = units.find("| "); at != std::string::npos; at = units.find("| "))
      units.erase(at + 1, 1);
    const std::string pattern = "^ *[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)? *(" + units + ") *$";
    out_ += "\"anyOf\": [{" + bounds(key, type) +
            "}, {\"type\": \"string\", \"pattern\": " + json_string(pattern) + "}]";
  }

  void choice(const Key& key) {
    out_ += "\"enum\": [";
    for (std::size_t i = 0; i < key.choices.size(); ++i)
      out_ += (i == 0 ? "" : ", ") + json_string(key.choices[i]);
    out_ += "]";
  }

  static std::string default_value(const Key& key, void* defaults) {
    if (key.rule.required || key.rule.computed) return {};
    void* member = key.member(defaults);
    switch (key.kind) {
      case KeyKind::boolean:
        return *static_cast<bool*>(member) ? "true" : "false";
      case KeyKind::integer:
        return std::to_string(*static_cast<int*>(member));
      case KeyKind::long_integer:
        return std::to_string(*static_cast<std::int64_t*>(member));
      case KeyKind::number:
        return std::isfinite(*static_cast<double*>(member)) ? json_number(*static_cast<double*>(member)) : "";
      case KeyKind::text:
        return static_cast<std::string*>(member)->empty() ? ""
                                                          : json_string(*static_cast<std::string*>(member));
      case KeyKind::choice:
        return json_string(key.choices[*static_cast<std::uint8_t*>(member)]);
      default:
        return {};
    }
  }

  std::string out_;
};

}  // namespace

std::string schema_of(const Section& section, const std::string& title) {
  return SchemaWriter().document(section, title);
}

std::string json_schema() {
  return schema_of(section_of<MachineConfig>(), "servogate machine file, schema 1");
}

}  // namespace servogate::machine
