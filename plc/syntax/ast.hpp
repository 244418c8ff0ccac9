// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "plc/types/type.hpp"

/// The tree of a source file: the one form that every front end (ST, IL, ladder, PLCopen XML) delivers.
namespace servogate::plc::syntax {

struct Location {
  std::int16_t file = 0;
  std::int32_t line = 0;
  std::int32_t column = 0;
};

/// A literal as written. `kind` untyped_* where the text names no type. A magnitude is kept apart from its
/// sign so that the whole range of ULINT and LINT can be written.
struct Literal {
  Kind kind = Kind::untyped_int;
  std::uint64_t magnitude = 0;
  bool negative = false;
  double real = 0.0;
  std::string text;     ///< of '...'
  std::u16string wide;  ///< of "..."
};

enum class Operator : std::uint8_t {
  none,
  negate,
  not_,
  plus,
  power,
  mul,
  div,
  mod,
  add,
  sub,
  lt,
  gt,
  le,
  ge,
  eq,
  ne,
  and_,
  xor_,
  or_,
};

struct Expression;
using ExpressionPtr = std::unique_ptr<Expression>;

/// An actual parameter: `a`, `IN := a`, `Q => a`, `NOT Q => a`.
struct Argument {
  std::string name;
  Location location;
  bool output = false;
  bool inverted = false;
  bool drawn = false;  ///< the pin of a function in a drawing: its output of that name, or else its result
  ExpressionPtr value;
};

enum class ExpressionKind : std::uint8_t {
  bad,  ///< a syntax error was reported here
  literal,
  typed,  ///< `name#...`: literal or enumeration value in `operands[0]` or `text`
  name,
  direct,       ///< %IX0.0
  member,       ///< operands[0] . name
  bit,          ///< operands[0] . literal (bit access)
  index,        ///< operands[0] [ operands[1..] ]
  dereference,  ///< operands[0] ^
  call,         ///< name or operands[0] ( arguments )
  unary,
  binary,
  held,    ///< the value that the statement hold number `literal.magnitude` kept
  list,    ///< [ ... ] with `repeats`
  record,  ///< ( a := ..., b := ... ) in `arguments`
};

struct Expression {
  ExpressionKind kind = ExpressionKind::bad;
  Location location;
  Operator op = Operator::none;
  std::string name;
  Literal literal;
  std::vector<ExpressionPtr> operands;
  std::vector<std::int64_t> repeats;  ///< of a list, parallel to operands
  std::vector<Argument> arguments;
  ExpressionPtr enable;           ///< of a call: EN := ...
  ExpressionPtr enabled;          ///< of a call: ENO => ...
  bool enabled_inverted = false;  ///< NOT ENO => ...
};

/// The same tree once more.
ExpressionPtr copy(const Expression& e);

enum class StatementKind : std::uint8_t {
  assign,
  call,
  if_,
  case_,
  for_,
  while_,
  repeat,
  exit,
  continue_,
  return_,
  hold,   ///< keeps `value` as number `number` until the body ends (the current result of IL, power in a
          ///< ladder)
  label,  ///< `name`; only in the outermost block of a body
  jump,   ///< to label `name`
  set,    ///< target := TRUE when `value`; where the target is a block, `alternative` instead
  reset,
  empty,
};

struct Statement;
using StatementPtr = std::unique_ptr<Statement>;
using Block = std::vector<StatementPtr>;

/// One or more labels of a CASE: a value, or a range when `high` is set.
struct Label {
  ExpressionPtr low, high;
};
struct Branch {
  ExpressionPtr condition;    ///< IF and ELSIF
  std::vector<Label> labels;  ///< CASE
  Block body;
};

struct Statement {
  StatementKind kind = StatementKind::empty;
  Location location;
  ExpressionPtr target;  ///< of an assignment; the control variable of FOR; the selector of CASE
  ExpressionPtr value;   ///< right side, call, condition, FOR start
  ExpressionPtr to, by;
  std::string name;
  std::uint64_t number = 0;
  StatementPtr alternative;
  std::vector<Branch> branches;
  Block body;  ///< of a loop; ELSE of IF and CASE
  bool has_else = false;
  bool attempt = false;  ///< assign: ?=
};

/// What stands after the colon of a declaration.
struct TypeReference {
  Location location;
  std::string name;  ///< elementary, user type, or ARRAY, STRING, STRUCT, REF_TO
  std::vector<std::pair<ExpressionPtr, ExpressionPtr>> ranges;  ///< of an array; two nulls: *
  std::unique_ptr<TypeReference> element;                       ///< of an array; what REF_TO leads to
  ExpressionPtr length;                                         ///< of a string
  ExpressionPtr low, high;                                      ///< of a subrange
  std::vector<std::pair<std::string, ExpressionPtr>> values;    ///< of an enumeration
  std::vector<Location> value_locations;
  std::vector<struct Variable> members;  ///< of a structure
};

enum class Section : std::uint8_t { local, temp, input, output, in_out, external, global };

struct Variable {
  std::string name;
  Location location;
  Section section = Section::local;
  std::string resource = {};  ///< of a global variable
  bool retain = false;
  bool non_retain = false;
  bool constant = false;
  int edge = 0;         ///< +1 R_EDGE, -1 F_EDGE
  std::string address;  ///< AT: as written, "%QX0.0" or "SA128"
  Location address_location;
  std::shared_ptr<TypeReference> type;  ///< shared by `a, b : INT`
  std::shared_ptr<Expression> initial;
};

enum class UnitKind : std::uint8_t { program, function, function_block };

struct Unit {
  UnitKind kind = UnitKind::program;
  std::string name;
  Location location;
  std::unique_ptr<TypeReference> result;  ///< of a function
  std::vector<Variable> variables;
  Block body;
  std::string ladder;  ///< a body between LADDER and END_LADDER as written, not read yet
  Location ladder_location;
};

struct TypeDeclaration {
  std::string name;
  Location location;
  TypeReference type;
  ExpressionPtr initial;
};

struct Task {
  std::string name;
  std::string resource;  ///< empty: of none
  Location location;
  ExpressionPtr interval, priority, single;
};
/// `fb WITH task` behind a program: the task runs that instance of a function block.
struct BlockTask {
  std::string name, task;
  Location location, task_location;
};
struct ProgramInstance {
  std::string name;
  std::string resource;  ///< empty: of none
  Location location;
  std::string task, type;
  bool retain = false;  ///< all its variables
  Location task_location, type_location;
  std::vector<Argument> arguments;
  std::vector<BlockTask> blocks;
};
/// A line of VAR_ACCESS (`name` set) or VAR_CONFIG: the path of a variable as its parts, names and
/// subscripts ("[3]").
struct PathDeclaration {
  std::string name;
  std::vector<std::string> path;
  Location location, path_location, address_location;
  TypeReference type;
  std::string address;  ///< AT, of VAR_CONFIG
  ExpressionPtr initial;
};
struct Configuration {
  std::string name;
  Location location;
  std::vector<Task> tasks;
  std::vector<ProgramInstance> programs;
  std::vector<std::string> resources;
  std::vector<PathDeclaration> paths;
};

/// All files of a compilation together.
struct Source {
  std::vector<Unit> units;
  std::vector<TypeDeclaration> types;
  std::vector<Variable> globals;
  std::set<std::string> global_lists;  ///< keys of names that may lead a global variable: GVL.speed
  std::vector<Configuration> configurations;
  std::size_t body_errors = 0;  ///< syntax errors inside bodies, where the declarations are whole
};

}  // namespace servogate::plc::syntax
