// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

/// Graphical bodies, ladder and function block diagram, as one graph, and from there to statements.
namespace servogate::plc::ladder {

using syntax::Location;

enum class ElementKind : std::uint8_t {
  rail,      ///< the left one: always TRUE
  contact,   ///< `operand` is what it reads
  coil,      ///< `operand` is what it writes
  block,     ///< `instance` of a function block (and `name`, the type it is drawn as), or the function `name`
  action,    ///< `statement`, done under power; power goes on
  source,    ///< the value of `operand`
  sink,      ///< writes `operand`
  label,     ///< `name`
  jump,      ///< to `name`
  leave,     ///< RETURN
  link,      ///< hands its input on (connector)
  continued  ///< the other end of the connector `name`
};

enum class Storage : std::uint8_t { none, set, reset };

/// Where an input comes from: the output `pin` of element `element`.
struct Wire {
  int element = -1;
  std::string pin;
  std::string number = {};  ///< of the element in its file, while that is being read
};

/// An input or output. An input without a wire may have its value written at it.
struct Pin {
  std::string name;
  Location location;
  bool inverted = false;
  int edge = 0;  ///< +1 rising, -1 falling
  bool in_out = false;
  std::vector<Wire> wires;
  syntax::ExpressionPtr value;
};

struct Element {
  ElementKind kind = ElementKind::rail;
  Location location;
  syntax::ExpressionPtr operand;
  syntax::StatementPtr statement;
  std::string name, instance;
  bool inverted = false;
  int edge = 0;
  Storage storage = Storage::none;
  bool read_inverted = false;  ///< sink: as its variable is read behind it
  int read_edge = 0;
  std::vector<Pin> inputs;                ///< contact, coil, sink, jump, leave, link, action: one
  std::vector<Pin> outputs;               ///< of a block, as drawn
  std::vector<syntax::Argument> written;  ///< of a block: arguments in words
  double x = 0, y = 0;
  int order = 0;  ///< execution order given by its author, 0: none
};

/// Turns a drawing into the body of `unit`. Elements that hang together are one rung; rungs run from top to
/// bottom, inside one what an element needs runs before it, else top to bottom and left to right. Each
/// element runs once a call. Edges keep their last state in hidden variables of the unit. A loop reads the
/// block's output of the last call. Reports what is not connected or cannot be.
void lower(std::vector<Element> elements, syntax::Unit& unit, syntax::Report& report);

}  // namespace servogate::plc::ladder
