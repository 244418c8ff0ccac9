// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/plcopen/reader.hpp"
#include "plc/syntax/parser.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::plcopen {

using syntax::ExpressionKind;
using syntax::ExpressionPtr;
using syntax::TypeReference;
using syntax::Variable;

ExpressionPtr Reader::expression(const pugi::xml_attribute& a, const pugi::xml_node& n) {
  return syntax::parse_expression(a.value(), where(n), report_);
}

void Reader::variables(const pugi::xml_node& list, syntax::Section section, std::vector<Variable>& out) {
  for (const pugi::xml_node& n : list.children()) {
    if (local_name(n) != "variable") continue;
    Variable v;
    v.section = section;
    v.location = v.address_location = where(n);
    v.name = attribute(n, "name");
    v.constant = list.attribute("constant").as_bool();
    v.retain = list.attribute("retain").as_bool();
    v.non_retain = list.attribute("nonretain").as_bool();
    v.address = key_of(n.attribute("address").value());
    v.type = std::make_shared<TypeReference>(type_of(n, 0));
    if (const pugi::xml_node value = child(n, "initialValue")) v.initial = initial(value);
    out.push_back(std::move(v));
  }
}

namespace {
// "Res.Main.valve[2].coil": names, and subscripts as "[2]"; what is none finds no variable.
std::vector<std::string> path_parts(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(".[],", at), text.size());
    const bool subscript = at > 0 && (text[at - 1] == '[' || text[at - 1] == ',');
    std::string part(text.substr(at, end - at));
    std::erase(part, ' ');
    const std::size_t digits = part.starts_with('-') ? 1 : 0;
    const bool number = part.size() > digits && part.find_first_not_of("0123456789", digits) == part.npos;
    if (subscript)
      out.push_back(number ? "[" + part + "]" : part + "]");
    else if (!part.empty() || at == 0 || text[at - 1] != ']')
      out.push_back(part);
    at = end + 1;
  }
  return out;
}
}  // namespace

// A variable of VAR_CONFIG or VAR_ACCESS, which has an alias.
void Reader::path(const pugi::xml_node& n, syntax::Configuration& c) {
  syntax::PathDeclaration p;
  p.location = p.path_location = p.address_location = where(n);
  p.path = path_parts(attribute(n, "instancePathAndName"));
  if (local_name(n) == "accessVariable") p.name = attribute(n, "alias");
  p.type = type_of(n, 0);
  p.address = n.attribute("address").value();
  if (const pugi::xml_node value = child(n, "initialValue")) p.initial = initial(value);
  c.paths.push_back(std::move(p));
}

// The type of a variable.
TypeReference Reader::type_of(const pugi::xml_node& variable, int depth) {
  if (const pugi::xml_node t = child(variable, "type")) return type(t, depth);
  report_.error(where(variable), texts::kXmlMissing, {std::string(variable.name()), "type"});
  TypeReference none;
  none.location = where(variable);
  none.name = "BOOL";
  return none;
}

TypeReference Reader::type(const pugi::xml_node& holder, int depth) {
  TypeReference t;
  pugi::xml_node n;
  for (const pugi::xml_node& c : holder.children())
    if (!n && c.type() == pugi::node_element) n = c;
  t.location = where(n ? n : holder);
  const std::string_view name = local_name(n);
  t.name = name;
  if (!n || depth > kMaxTypeNesting) {
    report_.error(t.location, texts::kExpected,
                  {text::both("a type", "тип"), n ? "'" + t.name + "'" : text::both("nothing", "ничего")});
    t.name = "BOOL";
  } else if (name == "derived") {
    t.name = attribute(n, "name");
  } else if (name == "string" || name == "wstring") {
    t.name = name == "string" ? "STRING" : "WSTRING";
    if (const pugi::xml_attribute length = n.attribute("length"); length && *length.value() != '\0')
      t.length = expression(length, n);
  } else if (name == "array") {
    array(n, t, depth);
  } else if (name == "enum") {
    enumeration(n, t);
  } else if (name == "struct") {
    structure(n, t, depth);
  } else if (name == "subrangeSigned" || name == "subrangeUnsigned") {
    t = type(child(n, "baseType"), depth + 1);
    const pugi::xml_node range = child(n, "range");
    t.low = expression(range.attribute("lower"), n);
    t.high = expression(range.attribute("upper"), n);
  } else if (name == "pointer") {
    const pugi::xml_node base = child(n, "baseType");
    t.name = base ? "REF_TO" : "BOOL";
    if (base)
      t.element = std::make_unique<TypeReference>(type(base, depth + 1));
    else
      report_.error(t.location, texts::kXmlMissing, {"pointer", "baseType"});
  }
  return t;
}

void Reader::array(const pugi::xml_node& n, TypeReference& t, int depth) {
  t.name = "ARRAY";
  for (const pugi::xml_node& d : n.children())
    if (local_name(d) == "dimension") {
      ExpressionPtr low = expression(d.attribute("lower"), d);
      t.ranges.emplace_back(std::move(low), expression(d.attribute("upper"), d));
    }
  if (t.ranges.empty()) report_.error(t.location, texts::kXmlMissing, {"array", "dimension"});
  t.element = std::make_unique<TypeReference>(type(child(n, "baseType"), depth + 1));
}

void Reader::enumeration(const pugi::xml_node& n, TypeReference& t) {
  t.name.clear();
  for (const pugi::xml_node& v : child(n, "values").children()) {
    if (local_name(v) != "value") continue;
    t.value_locations.push_back(where(v));
    std::string name = attribute(v, "name");
    const pugi::xml_attribute value = v.attribute("value");
    t.values.emplace_back(std::move(name), value ? expression(value, v) : nullptr);
  }
  if (!t.values.empty()) return;
  report_.error(t.location, texts::kXmlMissing, {"enum", "value"});
  t.name = "BOOL";
}

void Reader::structure(const pugi::xml_node& n, TypeReference& t, int depth) {
  t.name = "STRUCT";
  for (const pugi::xml_node& m : n.children()) {
    if (local_name(m) != "variable") continue;
    Variable v;
    v.location = where(m);
    v.name = attribute(m, "name");
    v.type = std::make_shared<TypeReference>(type_of(m, depth + 1));
    if (const pugi::xml_node value = child(m, "initialValue")) v.initial = initial(value);
    t.members.push_back(std::move(v));
  }
}

ExpressionPtr Reader::initial(const pugi::xml_node& value, int depth) {
  auto out = std::make_unique<syntax::Expression>();
  out->location = where(value);
  if (depth > kMaxTypeNesting) return out;
  for (const pugi::xml_node& n : value.children()) {
    const std::string_view name = local_name(n);
    if (name == "simpleValue")
      return syntax::parse_expression(n.attribute("value").value(), where(n), report_, true);
    if (name == "arrayValue") {
      out->kind = ExpressionKind::list;
      for (const pugi::xml_node& v : n.children()) {
        if (local_name(v) != "value") continue;
        out->repeats.push_back(std::max<std::int64_t>(1, v.attribute("repetitionValue").as_llong(1)));
        out->operands.push_back(initial(v, depth + 1));
      }
    } else if (name == "structValue") {
      out->kind = ExpressionKind::record;
      for (const pugi::xml_node& v : n.children()) {
        if (local_name(v) != "value") continue;
        syntax::Argument a;
        a.location = where(v);
        a.name = attribute(v, "member");
        a.value = initial(v, depth + 1);
        out->arguments.push_back(std::move(a));
      }
    }
  }
  return out;
}

}  // namespace servogate::plc::plcopen
