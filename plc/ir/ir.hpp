// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"
#include "plc/syntax/ast.hpp"
#include "plc/types/type.hpp"

/// The typed representation between analysis and code: names are places, conversions are explicit, standard
/// functions are operations. Code generation and the reference evaluator of the tests both start here.
namespace servogate::plc::ir {

using syntax::Location;

enum class Op : std::uint8_t {
  add,
  sub,
  mul,
  div,
  mod,
  eq,
  ne,
  lt,
  le,
  gt,
  ge,
  and_,
  or_,
  xor_,
  min,
  max,
  neg,
  not_,
  abs,
};

/// Operations that are rare enough to be functions of the machine. The cell of the result, or of the first
/// operand, chooses the variant.
enum class Native : std::uint8_t {
  sqrt,
  ln,
  log,
  exp,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  atan2,
  power,
  shl,
  shr,
  rol,
  ror,
  length,
  left,
  right,
  mid,
  concat,
  insert,
  remove,
  replace,
  find,
  now,         ///< virtual time of the scan, TIME
  day_part,    ///< midnight of a date and time
  clock_part,  ///< time since that midnight
  to_text,     ///< number, time or character of args[0] as a string
  from_text,   ///< the reverse
  to_bcd,
  from_bcd,
  turn_bytes,    ///< the first byte becomes the last
  select_fault,  ///< never returns a value: Fault::selector
};

/// Value of a constant. Integers, BOOL, times and enumerations in `i` (unsigned ones by their bits), reals in
/// `r`, a STRING in `s`, a WSTRING in `w`.
struct Constant {
  std::int64_t i = 0;
  double r = 0.0;
  std::string s = {};
  std::u16string w = {};
};

struct Expr;
using ExprPtr = std::unique_ptr<Expr>;

/// Adds (index - low) * stride to an address, after a check against low..high.
struct Step {
  ExprPtr index;
  std::int64_t low = 0, high = 0;
  std::uint32_t stride = 0;
  ExprPtr limits = nullptr;  ///< of an ARRAY[*]: load of the Limits that hold instead; `index` is LINT then

  Step copy() const;
};

/// One dimension of an array as it lies in memory for an ARRAY[*]; the dimensions of one follow one another.
struct Limits {
  std::int64_t low = 0, high = 0, stride = 0;
};

enum class Root : std::uint8_t {
  fixed,      ///< `cell` is an address
  instance,   ///< `cell` counts from the running unit's own memory
  reference,  ///< the variable's address stands at `cell` of the own memory (VAR_IN_OUT)
  shared,     ///< `cell` is an index of Program::places
  pointer,    ///< the variable's address stands at the fixed address `cell`
  target,     ///< `pointer` is a reference to the variable
};

/// Where a value lives.
struct Place {
  Root root = Root::fixed;
  std::uint32_t cell = 0;
  std::uint32_t offset = 0;
  std::vector<Step> steps;
  std::int8_t bit = -1;  ///< access to one bit of it; `type` is then BOOL
  const Type* type = nullptr;
  ExprPtr pointer = nullptr;  ///< a dereference; NULL is a fault

  /// Finding it takes more than an address: subscripts, a reference.
  bool computed() const { return !steps.empty() || pointer != nullptr; }
  Place copy() const;
};

enum class ExprKind : std::uint8_t {
  constant,
  load,
  address,  ///< REF of `place`
  unary,
  binary,
  convert,
  truncate,
  reinterpret,
  call,
  native,
  choose,
  let,  ///< args[0] is computed and kept as number `value.i`, then args[1] is the value
  kept  ///< what the let of number `value.i` around it keeps
};

/// A parameter of a function call: value (input) or place (output: copied after the call; others: bound).
struct Parameter {
  std::uint32_t offset = 0;  ///< in the function's memory
  const Type* type = nullptr;
  syntax::Section section = syntax::Section::input;
  ExprPtr value;
  Place place;
  bool inverted = false;  ///< output: NOT of it is copied
};

struct Expr {
  ExprKind kind = ExprKind::constant;
  const Type* type = nullptr;
  Location at;
  Op op = Op::add;
  Native native = Native::now;
  Constant value;
  Place place;
  std::vector<ExprPtr> args;  ///< choose: condition, then, else
  std::int32_t unit = -1;     ///< of a call
  std::uint32_t result = 0;   ///< offset of the result in the function's memory
  std::vector<Parameter> parameters;

  ExprPtr copy() const;
};

enum class StmtKind : std::uint8_t {
  assign,
  bind,
  invoke,
  evaluate,
  if_,
  case_,
  while_,
  repeat,
  for_,
  exit,
  continue_,
  return_,
  label,  ///< number `label`; only in the outermost block of a body
  jump
};

struct Stmt;
using Block = std::vector<Stmt>;
struct Range {
  std::int64_t low = 0, high = 0;
};
struct Branch {
  ExprPtr condition;
  std::vector<Range> ranges;
  Block body;
};

struct Stmt {
  StmtKind kind = StmtKind::assign;
  Location at;
  Place place;         ///< target; instance of invoke; the reference cell of bind; variable of FOR
  Place other;         ///< what bind binds
  bool reads = false;  ///< bind: what is bound is only read
  ExprPtr value;       ///< right side; condition; selector; start of FOR
  ExprPtr to, by;
  std::vector<Branch> branches;
  Block body;  ///< of a loop; the ELSE part
  std::int32_t unit = -1;
  std::int32_t label = -1;
  bool check_range = false;  ///< assign, FOR: the value must lie in the subrange of the place
};

/// A body: PROGRAM, FUNCTION, FUNCTION_BLOCK or a task. Its own memory is `frame`.
struct Unit {
  syntax::UnitKind kind = syntax::UnitKind::program;
  std::string name;
  Location at;
  const Type* frame = nullptr;
  std::int64_t fixed_base = -1;  ///< address of the only instance, -1: several
  struct Reset {
    std::uint32_t offset, size;
  };
  std::vector<Reset> resets;  ///< parts of the frame that take their initial value at every call
  Block body;
};

/// A packet place that the program uses.
struct SharedPlace {
  std::string name;
  image::Place place;
  const Type* type = nullptr;
  std::uint32_t address = 0;
  bool written = false;
  bool initialised = false;
  bool retain = false;
  Constant initial;
  bool raw = false;          ///< laid out as in the packet, because places share memory
  bool referenced = false;   ///< bound to a VAR_IN_OUT: needs a byte of its own
  bool configured = false;   ///< given to an instance by VAR_CONFIG: likewise
  std::uint32_t extent = 0;  ///< so many bytes from here on lie in memory as in the packet: an AXIS_REF
  Location at;
};

struct Task {
  std::string name;
  image::Nanoseconds interval = 0;  ///< 0: every cycle
  std::int32_t priority = 0;
  bool has_single = false;
  Place single;
  std::int32_t unit = -1;
};

/// A variable that can be found by name from outside.
struct Global {
  std::string name;
  const Type* type = nullptr;
  std::uint32_t address = 0;
  std::int32_t place = -1;
  bool retain = false;
  bool constant = false;
};

struct Program {
  std::shared_ptr<TypeTable> types;
  std::vector<Unit> units;
  std::vector<SharedPlace> places;
  std::vector<Task> tasks;
  std::vector<Global> globals;       ///< VAR_GLOBAL and places
  std::vector<Global> programs;      ///< instances of programs
  std::vector<std::uint8_t> memory;  ///< initial values
  std::vector<std::string> files;
};

}  // namespace servogate::plc::ir
