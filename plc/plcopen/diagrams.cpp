// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <map>

#include "plc/plcopen/reader.hpp"
#include "plc/syntax/parser.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::plcopen {

using ladder::Element;
using ladder::ElementKind;
using ladder::Pin;

namespace {

struct Named {
  std::string_view name;
  ElementKind kind;
};
constexpr Named kElements[] = {
    {"leftPowerRail", ElementKind::rail}, {"contact", ElementKind::contact},
    {"coil", ElementKind::coil},          {"block", ElementKind::block},
    {"inVariable", ElementKind::source},  {"outVariable", ElementKind::sink},
    {"inOutVariable", ElementKind::sink}, {"label", ElementKind::label},
    {"jump", ElementKind::jump},          {"return", ElementKind::leave},
    {"connector", ElementKind::link},     {"continuation", ElementKind::continued},
};
// Drawn, but without meaning; and what belongs to SFC.
constexpr std::string_view kSilent[] = {"rightPowerRail", "comment", "vendorElement",
                                        "error",          "addData", "documentation"};

int edge_of(const pugi::xml_node& n, const char* attribute = "edge") {
  const std::string_view edge = n.attribute(attribute).value();
  return edge == "rising" ? 1 : edge == "falling" ? -1 : 0;
}
ladder::Storage storage_of(const pugi::xml_node& n, const char* attribute = "storage") {
  const std::string_view storage = n.attribute(attribute).value();
  return storage == "set"     ? ladder::Storage::set
         : storage == "reset" ? ladder::Storage::reset
                              : ladder::Storage::none;
}

/// The number of an element, which editors take from all of 64 bits, without blanks and zeros before it.
std::string number_of(const pugi::xml_attribute& a) {
  std::string_view digits = a.value();
  while (!digits.empty() && (std::isspace(static_cast<unsigned char>(digits.front())) != 0 ||
                             (digits.front() == '0' && digits.size() > 1)))
    digits.remove_prefix(1);
  while (!digits.empty() && std::isspace(static_cast<unsigned char>(digits.back())) != 0)
    digits.remove_suffix(1);
  return std::string(digits);
}

}  // namespace

void Reader::diagram(const pugi::xml_node& n, syntax::Unit& u) {
  std::vector<Element> elements;
  std::vector<pugi::xml_node> nodes;
  for (const pugi::xml_node& c : n.children()) {
    if (c.type() != pugi::node_element) continue;
    const std::string_view name = local_name(c);
    if (std::find(std::begin(kSilent), std::end(kSilent), name) != std::end(kSilent)) continue;
    const auto* known = std::find_if(std::begin(kElements), std::end(kElements),
                                     [&](const Named& k) { return k.name == name; });
    if (known == std::end(kElements)) {
      report_.error(where(c), texts::kUnsupported, {"<" + std::string(name) + ">"});
      continue;
    }
    Element e;
    e.kind = known->kind;
    e.location = where(c);
    const pugi::xml_node position = child(c, "position");
    e.x = position.attribute("x").as_double();
    e.y = position.attribute("y").as_double();
    e.order = c.attribute("executionOrderId").as_int();
    element(c, e);
    if (name == "inOutVariable") in_out(c, e);
    elements.push_back(std::move(e));
    nodes.push_back(c);
  }
  connect(elements, nodes);
  ladder::lower(std::move(elements), u, report_);
}

void Reader::element(const pugi::xml_node& n, Element& e) {
  e.inverted = n.attribute("negated").as_bool();
  e.edge = edge_of(n);
  e.storage = storage_of(n);
  if (e.kind == ElementKind::source && e.storage != ladder::Storage::none) not_here(n, "storage");
  switch (e.kind) {
    case ElementKind::rail:
      return;
    case ElementKind::block:
      return block(n, e);
    case ElementKind::label:
    case ElementKind::jump:
      e.name = attribute(n, "label");
      break;
    case ElementKind::link:
    case ElementKind::continued:
      e.name = attribute(n, "name");
      break;
    case ElementKind::leave:
      break;
    default:
      operand(n, e);
  }
  const bool takes =
      e.kind != ElementKind::source && e.kind != ElementKind::label && e.kind != ElementKind::continued;
  if (!takes) return;
  e.inputs.emplace_back();
  wires(child(n, "connectionPointIn"), e.inputs[0]);
}

void Reader::not_here(const pugi::xml_node& n, const char* attribute) {
  report_.error(where(n), texts::kUnsupported,
                {std::string(attribute) + "=\"" + n.attribute(attribute).value() + "\""});
}

// Written at its left side, read at its right one.
void Reader::in_out(const pugi::xml_node& n, Element& e) {
  if (storage_of(n, "storageOut") != ladder::Storage::none) not_here(n, "storageOut");
  e.read_inverted = n.attribute("negatedOut").as_bool();
  e.read_edge = edge_of(n, "edgeOut");
  e.inverted = n.attribute("negatedIn").as_bool();
  e.edge = edge_of(n, "edgeIn");
  e.storage = storage_of(n, "storageIn");
  if (!e.inputs[0].wires.empty()) return;
  e.kind = ElementKind::source;
  e.inputs.clear();
  e.inverted = e.read_inverted;
  e.edge = e.read_edge;
}

// <variable> of a contact or coil, <expression> of a variable.
void Reader::operand(const pugi::xml_node& n, Element& e) {
  pugi::xml_node text = child(n, "variable");
  if (!text) text = child(n, "expression");
  Location begin;
  const std::string written = text_of(text ? text : n, begin);
  if (written.empty()) {
    report_.error(e.location, texts::kXmlMissing, {std::string(n.name()), "variable"});
    e.operand = std::make_unique<syntax::Expression>();
    return;
  }
  e.operand = syntax::parse_expression(written, begin, report_);
}

// Wires keep the number of their element in the file until all are known.
void Reader::wires(const pugi::xml_node& point, Pin& pin) {
  pin.location = where(point);
  for (const pugi::xml_node& c : point.children()) {
    if (local_name(c) == "expression") {
      Location begin;
      const std::string written = text_of(c, begin);
      if (!written.empty()) pin.value = syntax::parse_expression(written, begin, report_);
    }
    if (local_name(c) != "connection") continue;
    pin.wires.push_back({-1, c.attribute("formalParameter").value(), number_of(c.attribute("refLocalId"))});
  }
}

Pin Reader::block_pin(const pugi::xml_node& variable) {
  Pin p;
  p.name = attribute(variable, "formalParameter");
  p.inverted = variable.attribute("negated").as_bool();
  p.edge = edge_of(variable);
  if (storage_of(variable) != ladder::Storage::none) not_here(variable, "storage");
  return p;
}

void Reader::block(const pugi::xml_node& n, Element& e) {
  e.name = attribute(n, "typeName");
  e.instance = n.attribute("instanceName").value();
  e.inverted = false;
  for (const char* list : {"inputVariables", "inOutVariables"})
    for (const pugi::xml_node& v : child(n, list).children()) {
      if (local_name(v) != "variable") continue;
      Pin p = block_pin(v);
      p.in_out = std::string_view(list) == "inOutVariables";
      wires(child(v, "connectionPointIn"), p);
      e.inputs.push_back(std::move(p));
    }
  for (const pugi::xml_node& v : child(n, "outputVariables").children()) {
    if (local_name(v) != "variable") continue;
    e.outputs.push_back(block_pin(v));
    // A variable written at the pin itself.
    const pugi::xml_node point = child(v, "connectionPointOut");
    Location begin;
    const pugi::xml_node text = child(point, "expression");
    const std::string written = text ? text_of(text, begin) : std::string();
    if (written.empty()) continue;
    if (e.outputs.back().edge != 0) not_here(v, "edge");
    syntax::Argument a;
    a.name = e.outputs.back().name;
    a.location = begin;
    a.output = a.drawn = true;
    a.inverted = e.outputs.back().inverted;
    a.value = syntax::parse_expression(written, begin, report_);
    e.written.push_back(std::move(a));
  }
}

void Reader::connect(std::vector<Element>& elements, const std::vector<pugi::xml_node>& nodes) {
  std::map<std::string, int> by_number;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string number = number_of(nodes[i].attribute("localId"));
    if (!by_number.emplace(number, static_cast<int>(i)).second)
      report_.error(where(nodes[i]), texts::kXmlTwice, {number});
  }
  for (Element& e : elements)
    for (Pin& p : e.inputs)
      for (ladder::Wire& w : p.wires) {
        const auto at = by_number.find(w.number);
        if (at == by_number.end()) report_.error(p.location, texts::kXmlNoElement, {w.number});
        w.element = at == by_number.end() ? -1 : at->second;
      }
}

}  // namespace servogate::plc::plcopen
