// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plc/types/type.hpp"

/// The tree of a source file: the one form that every front end (ST now; IL and LD map onto it) delivers.
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
  std::string text;
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
  ExpressionPtr value;
};

enum class ExpressionKind : std::uint8_t {
  bad,  ///< a syntax error was reported here
  literal,
  typed,  ///< `name#...`: literal or enumeration value in `operands[0]` or `text`
  name,
  direct,  ///< %IX0.0
  member,  ///< operands[0] . name
  bit,     ///< operands[0] . literal (bit access)
  index,   ///< operands[0] [ operands[1..] ]
  call,    ///< name or operands[0] ( arguments )
  unary,
  binary,
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
};

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
  std::vector<Branch> branches;
  Block body;  ///< of a loop; ELSE of IF and CASE
  bool has_else = false;
};

/// What stands after the colon of a declaration.
struct TypeReference {
  Location location;
  std::string name;  ///< elementary, user type, or ARRAY, STRING, STRUCT
  std::vector<std::pair<ExpressionPtr, ExpressionPtr>> ranges;  ///< of an array
  std::unique_ptr<TypeReference> element;
  ExpressionPtr length;                                       ///< of a string
  ExpressionPtr low, high;                                    ///< of a subrange
  std::vector<std::pair<std::string, ExpressionPtr>> values;  ///< of an enumeration
  std::vector<Location> value_locations;
  std::vector<struct Variable> members;  ///< of a structure
};

enum class Section : std::uint8_t { local, temp, input, output, in_out, external, global };

struct Variable {
  std::string name;
  Location location;
  Section section = Section::local;
  bool retain = false;
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
};

struct TypeDeclaration {
  std::string name;
  Location location;
  TypeReference type;
  ExpressionPtr initial;
};

struct Task {
  std::string name;
  Location location;
  ExpressionPtr interval, priority, single;
};
struct ProgramInstance {
  std::string name;
  Location location;
  std::string task, type;
  Location task_location, type_location;
  std::vector<Argument> arguments;
};
struct Configuration {
  std::string name;
  Location location;
  std::vector<Task> tasks;
  std::vector<ProgramInstance> programs;
};

/// All files of a compilation together.
struct Source {
  std::vector<Unit> units;
  std::vector<TypeDeclaration> types;
  std::vector<Variable> globals;
  std::vector<Configuration> configurations;
};

}  // namespace servogate::plc::syntax
