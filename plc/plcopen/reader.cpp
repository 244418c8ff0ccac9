// SPDX-License-Identifier: Apache-2.0
#include "plc/plcopen/reader.hpp"

#include <algorithm>
#include <cctype>

#include "plc/plcopen/plcopen.hpp"
#include "plc/syntax/parser.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::plcopen {

using syntax::Section;
using syntax::Unit;
using syntax::UnitKind;

Lines::Lines(std::string_view text, int file) : text_(text), file_(static_cast<std::int16_t>(file)) {
  begins_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') begins_.push_back(i + 1);
}

Location Lines::at(std::ptrdiff_t offset) const {
  const auto n = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, offset));
  const auto line = std::upper_bound(begins_.begin(), begins_.end(), n) - begins_.begin();
  const std::size_t begin = begins_[static_cast<std::size_t>(line - 1)];
  int column = 1;
  for (std::size_t i = begin; i < n && i < text_.size(); ++i)
    column += (static_cast<unsigned char>(text_[i]) & 0xC0) != 0x80;
  return {file_, static_cast<std::int32_t>(line), column};
}

std::string_view local_name(const pugi::xml_node& n) {
  const std::string_view name = n.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child(const pugi::xml_node& n, std::string_view name) {
  for (const pugi::xml_node& c : n.children())
    if (local_name(c) == name) return c;
  return {};
}

Reader::Reader(std::string_view text, int file, syntax::Source& source, syntax::Report& report)
    : text_(text), lines_(text, file), source_(source), report_(report) {}

namespace {
// The nodes of one name in the order of the file, wherever an editor put them (CODESYS: below addData). What
// `stop` names is not looked into.
void collect(const pugi::xml_node& n, std::string_view name, std::string_view stop, int depth,
             std::vector<pugi::xml_node>& out) {
  constexpr int kDeepest = 100;
  if (depth > kDeepest) return;
  for (const pugi::xml_node& c : n.children()) {
    if (local_name(c) == name)
      out.push_back(c);
    else if (local_name(c) != stop)
      collect(c, name, stop, depth + 1, out);
  }
}
}  // namespace

void Reader::run() {
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(text_.data(), text_.size(), pugi::parse_default | pugi::parse_ws_pcdata_single);
  if (!result) {
    report_.error(lines_.at(result.offset), texts::kXml, {result.description()});
    return;
  }
  const pugi::xml_node project = document.document_element();
  if (local_name(project) != "project") {
    report_.error(where(project), texts::kExpected, {"<project>", "'" + std::string(project.name()) + "'"});
    return;
  }
  std::vector<pugi::xml_node> found;
  const auto each = [&](std::string_view name, std::string_view stop, auto&& read) {
    found.clear();
    collect(project, name, stop, 0, found);
    for (const pugi::xml_node& n : found) read(n);
  };
  each("dataType", "pou", [&](const pugi::xml_node& n) { data_type(n); });
  each("globalVars", "pou", [&](const pugi::xml_node& n) {
    variables(n, Section::global, source_.globals);
    if (const pugi::xml_attribute list = n.attribute("name"))
      source_.global_lists.insert(key_of(list.value()));
  });
  each("pou", "pou", [&](const pugi::xml_node& n) { pou(n); });
  each("configuration", "pou", [&](const pugi::xml_node& n) { configuration(n); });
}

std::string Reader::attribute(const pugi::xml_node& n, const char* name) {
  const pugi::xml_attribute a = n.attribute(name);
  if (!a) report_.error(where(n), texts::kXmlMissing, {std::string(n.name()), name});
  return a.value();
}

std::string Reader::text_of(const pugi::xml_node& n, Location& begin) const {
  std::string out;
  struct Collector : pugi::xml_tree_walker {
    std::string* text = nullptr;
    std::ptrdiff_t first = -1;
    bool for_each(pugi::xml_node& node) override {
      if (node.type() != pugi::node_pcdata && node.type() != pugi::node_cdata) return true;
      const std::string_view value = node.value();
      if (text->empty() && value.find_first_not_of(" \t\r\n") == std::string_view::npos) return true;
      if (first < 0) first = node.offset_debug();
      *text += value;
      return true;
    }
  } walker;
  walker.text = &out;
  pugi::xml_node node = n;
  node.traverse(walker);
  begin = walker.first < 0 ? where(n) : lines_.at(walker.first);
  return out;
}

void Reader::data_type(const pugi::xml_node& n) {
  syntax::TypeDeclaration d;
  d.location = where(n);
  d.name = attribute(n, "name");
  d.type = type(child(n, "baseType"));
  if (const pugi::xml_node value = child(n, "initialValue")) d.initial = initial(value);
  source_.types.push_back(std::move(d));
}

void Reader::pou(const pugi::xml_node& n) {
  Unit u;
  u.location = where(n);
  u.name = attribute(n, "name");
  const std::string kind = attribute(n, "pouType");
  if (kind == "function")
    u.kind = UnitKind::function;
  else if (kind == "functionBlock")
    u.kind = UnitKind::function_block;
  else if (kind != "program")
    report_.error(u.location, texts::kExpected,
                  {text::both("program, function or functionBlock", "program, function или functionBlock"),
                   "'" + kind + "'"});
  constexpr std::pair<std::string_view, Section> kSections[] = {
      {"localVars", Section::local},   {"tempVars", Section::temp},    {"inputVars", Section::input},
      {"outputVars", Section::output}, {"inOutVars", Section::in_out}, {"externalVars", Section::external}};
  for (const pugi::xml_node& part : child(n, "interface").children()) {
    if (local_name(part) == "returnType" && u.kind == UnitKind::function)
      u.result = std::make_unique<syntax::TypeReference>(type(part));
    for (const auto& [name, section] : kSections)
      if (local_name(part) == name) variables(part, section, u.variables);
  }
  for (const char* part : {"actions", "transitions"})
    if (const pugi::xml_node list = child(n, part); list && list.first_child())
      report_.error(where(list), texts::kUnsupported, {part});
  const std::size_t errors = report_.errors();
  if (const pugi::xml_node b = child(n, "body"))
    body(b, u);
  else
    report_.error(u.location, texts::kXmlMissing, {"pou", "body"});
  source_.body_errors += report_.errors() - errors;
  source_.units.push_back(std::move(u));
}

void Reader::body(const pugi::xml_node& n, Unit& u) {
  for (const pugi::xml_node& language : n.children()) {
    const std::string_view name = local_name(language);
    if (name == "ST" || name == "IL") {
      Location begin;
      const std::string text = text_of(language, begin);
      u.body = syntax::parse_body(text, begin, name == "IL", u.variables, report_);
      return;
    }
    if (name == "LD" || name == "FBD") return diagram(language, u);
    if (name == "SFC") {
      report_.error(where(language), texts::kUnsupported, {"SFC"});
      return;
    }
  }
  report_.error(where(n), texts::kExpected,
                {text::both("<ST>, <IL>, <LD> or <FBD>", "<ST>, <IL>, <LD> или <FBD>"),
                 text::both("nothing", "ничего")});
}

void Reader::configuration(const pugi::xml_node& n) {
  syntax::Configuration c;
  c.location = where(n);
  c.name = attribute(n, "name");
  for (const pugi::xml_node& part : n.children())
    if (local_name(part) == "resource") resource(part, c);
  for (const pugi::xml_node& list : n.children())
    if (local_name(list) == "configVars" || local_name(list) == "accessVars")
      for (const pugi::xml_node& part : list.children())
        if (local_name(part) == "configVariable" || local_name(part) == "accessVariable") path(part, c);
  if (!c.programs.empty()) source_.configurations.push_back(std::move(c));
}

void Reader::resource(const pugi::xml_node& n, syntax::Configuration& c) {
  c.resources.push_back(attribute(n, "name"));
  for (const pugi::xml_node& part : n.children()) {
    if (local_name(part) == "task") task(part, c);
    if (local_name(part) == "pouInstance") instance(part, "", c);
  }
}

namespace {
// CODESYS writes intervals as ISO 8601 durations: PT0.02S.
std::string iec_time(const std::string& text) {
  if (!text.starts_with("PT") && !text.starts_with("P0")) return text;
  std::string out = "T#";
  for (std::size_t i = text.find('T') + 1; i < text.size(); ++i)
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
  return out;
}
}  // namespace

void Reader::task(const pugi::xml_node& n, syntax::Configuration& c) {
  syntax::Task t;
  t.location = where(n);
  t.name = attribute(n, "name");
  t.resource = c.resources.back();
  if (const std::string interval = iec_time(n.attribute("interval").value()); !interval.empty())
    t.interval = syntax::parse_expression(interval, t.location, report_);
  if (const std::string priority = n.attribute("priority").value(); !priority.empty())
    t.priority = syntax::parse_expression(priority, t.location, report_);
  if (const std::string single = n.attribute("single").value(); !single.empty())
    t.single = syntax::parse_expression(single, t.location, report_);
  const std::string name = t.name;
  c.tasks.push_back(std::move(t));
  for (const pugi::xml_node& part : n.children())
    if (local_name(part) == "pouInstance") instance(part, name, c);
}

void Reader::instance(const pugi::xml_node& n, const std::string& task, syntax::Configuration& c) {
  syntax::ProgramInstance p;
  p.location = p.task_location = p.type_location = where(n);
  p.name = attribute(n, "name");
  p.resource = c.resources.back();
  p.type = n.attribute("typeName").value();
  if (p.type.empty()) p.type = p.name;
  p.task = task;
  c.programs.push_back(std::move(p));
}

bool is_xml(std::string_view text) {
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  while (at < text.size() && (text[at] == ' ' || text[at] == '\n' || text[at] == '\r' || text[at] == '\t'))
    ++at;
  return at < text.size() && text[at] == '<';
}

void parse(std::string_view text, int file, syntax::Source& source, syntax::Report& report) {
  Reader(text, file, source, report).run();
}

}  // namespace servogate::plc::plcopen
