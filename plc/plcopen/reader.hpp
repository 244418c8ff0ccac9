// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "plc/ladder/network.hpp"
#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

namespace servogate::plc::plcopen {

using syntax::Location;

/// Where the bytes of the file stand.
class Lines {
 public:
  Lines(std::string_view text, int file);
  Location at(std::ptrdiff_t offset) const;

 private:
  std::string_view text_;
  std::int16_t file_;
  std::vector<std::size_t> begins_;
};

/// One file on its way into the tree.
class Reader {
 public:
  Reader(std::string_view text, int file, syntax::Source& source, syntax::Report& report);
  void run();

 private:
  // reader.cpp: the outline.
  void data_type(const pugi::xml_node& n);
  void pou(const pugi::xml_node& n);
  void body(const pugi::xml_node& n, syntax::Unit& u);
  void configuration(const pugi::xml_node& n);
  void resource(const pugi::xml_node& n, syntax::Configuration& c);
  void task(const pugi::xml_node& n, syntax::Configuration& c);
  void instance(const pugi::xml_node& n, const std::string& task, syntax::Configuration& c);

  // declarations.cpp: variables and types.
  void variables(const pugi::xml_node& list, syntax::Section section, std::vector<syntax::Variable>& out);
  void path(const pugi::xml_node& n, syntax::Configuration& c);
  syntax::TypeReference type_of(const pugi::xml_node& variable, int depth);
  syntax::TypeReference type(const pugi::xml_node& n, int depth = 0);
  void array(const pugi::xml_node& n, syntax::TypeReference& t, int depth);
  void enumeration(const pugi::xml_node& n, syntax::TypeReference& t);
  void structure(const pugi::xml_node& n, syntax::TypeReference& t, int depth);
  syntax::ExpressionPtr initial(const pugi::xml_node& value, int depth = 0);
  syntax::ExpressionPtr expression(const pugi::xml_attribute& a, const pugi::xml_node& n);

  // diagrams.cpp: LD and FBD.
  void diagram(const pugi::xml_node& n, syntax::Unit& u);
  void element(const pugi::xml_node& n, ladder::Element& e);
  void block(const pugi::xml_node& n, ladder::Element& e);
  void wires(const pugi::xml_node& point, ladder::Pin& pin);
  ladder::Pin block_pin(const pugi::xml_node& variable);
  void not_here(const pugi::xml_node& n, const char* attribute);
  void in_out(const pugi::xml_node& n, ladder::Element& e);
  void operand(const pugi::xml_node& n, ladder::Element& e);
  void connect(std::vector<ladder::Element>& elements, const std::vector<pugi::xml_node>& nodes);

  Location where(const pugi::xml_node& n) const { return lines_.at(n.offset_debug()); }
  std::string attribute(const pugi::xml_node& n, const char* name);
  /// All text below a node and where it begins.
  std::string text_of(const pugi::xml_node& n, Location& begin) const;

  std::string_view text_;
  Lines lines_;
  syntax::Source& source_;
  syntax::Report& report_;
};

/// The name of an element without its namespace.
std::string_view local_name(const pugi::xml_node& n);
/// The first child of that local name.
pugi::xml_node child(const pugi::xml_node& n, std::string_view name);

inline constexpr int kMaxTypeNesting = 50;

}  // namespace servogate::plc::plcopen
