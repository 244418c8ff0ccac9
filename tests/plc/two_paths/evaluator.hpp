// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include <map>

#include "plc/engine/engine.hpp"
#include "plc/ir/ir.hpp"

namespace servogate::plc {

/// Walks the typed representation directly: the second, slow and simple way to run a program, against which
/// the machine is compared. Numbers, arrays, structures, calls and blocks; no strings, no packet places.
class Evaluator {
 public:
  explicit Evaluator(ir::Program program) : program_(std::move(program)), memory(program_.memory) {}

  /// One scan; the fault that ended it, or none.
  Fault scan();
  const ir::Program& program() const { return program_; }

 private:
  struct Value {
    std::int64_t i = 0;
    double r = 0.0;
    std::vector<std::uint8_t> bytes;  ///< of arrays and structures
  };
  struct Address {
    std::uint32_t at = 0;
    int bit = -1;
  };
  enum class Flow { next, exit, continue_, return_, jump };

  Value evaluate(const ir::Expr& e, std::uint32_t self);
  Value binary(const ir::Expr& e, std::uint32_t self);
  Value unary(const ir::Expr& e, std::uint32_t self);
  Value convert(const ir::Expr& e, std::uint32_t self);
  Value native(const ir::Expr& e, std::uint32_t self);
  Value call(const ir::Expr& e, std::uint32_t self);
  Address address(const ir::Place& p, std::uint32_t self);
  Value load(const Address& a, const Type& t) const;
  void store(const Address& a, const Type& t, const Value& v);
  Flow block(const ir::Block& b, std::uint32_t self);
  Flow statement(const ir::Stmt& s, std::uint32_t self);
  Flow loop(const ir::Stmt& s, std::uint32_t self);
  void run(int unit, std::uint32_t self);

  ir::Program program_;
  std::int64_t steps_ = 0;
  std::map<std::int64_t, Value> kept_;
  std::int32_t target_ = -1;  ///< label of a jump under way

 public:
  std::vector<std::uint8_t> memory;
};

}  // namespace servogate::plc
