// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "plc/ir/ir.hpp"
#include "plc/syntax/report.hpp"
#include "plc/terms/options.hpp"
#include "plc/vm/image.hpp"
#include "plc/vm/machine.hpp"

namespace servogate::plc::code {

/// Turns the typed representation into instructions. One object, one image.
class Generator {
 public:
  Generator(ir::Program program, const Options& options, syntax::Report& report);
  std::shared_ptr<const Image> run();

 private:
  /// An address of the machine, still with marks for temporaries and constants.
  using Operand = std::uint32_t;
  struct Unit {
    bool done = false;
    std::uint32_t entry = 0;
    std::uint32_t length = 0;
    int depth = 0;
  };
  struct Loop {
    std::vector<std::size_t> exits, continues;
  };

  // generator.cpp: units, tasks, tables.
  void unit(int index);
  void callees(const ir::Block& b, std::vector<int>& out);
  void callees(const ir::Expr& e, std::vector<int>& out);
  void callees(const ir::Place& p, std::vector<int>& out);
  void resets(const ir::Unit& u);
  void link();
  void tables();
  void units();
  void retained_cells(const std::string& name, const Type& type, std::uint32_t address, bool all);
  void retained_cell(const std::string& name, const Type& type, std::uint32_t address, std::int32_t place);
  Operand fixed(std::uint32_t address) const { return address; }
  Operand temporary(std::uint32_t size);
  Operand constant_bytes(const std::uint8_t* bytes, std::uint32_t size);
  Operand constant_integer(std::int64_t v, Cell cell);
  std::size_t emit(vm::Code code, Operand a = 0, Operand b = 0, Operand c = 0, std::uint16_t aux = 0);
  std::uint16_t bounds(std::int64_t low, std::int64_t high, std::uint32_t stride);
  std::size_t here() const { return image_->code.size(); }
  void land(std::size_t jump) { image_->code[jump].c = static_cast<std::uint32_t>(here()); }

  // places.cpp
  struct Target {
    Operand where = 0;
    bool indirect = false;     ///< `where` is a cell that holds the address
    std::uint32_t offset = 0;  ///< added to that address
    int bit = -1;
  };
  Target target(const ir::Place& p);
  Operand base(const ir::Place& p);
  Operand followed(const ir::Place& p);
  Operand load(const Target& t, const Type& type, std::optional<Operand> into);
  void store(const Target& t, const Type& type, Operand value);
  Operand reference(const ir::Place& p);
  void bind(Operand cell, const ir::Place& p);
  void copy(const Type& type, Operand to, Operand from);
  void move_text(Kind kind, Operand to, Operand from, std::uint32_t capacity);

  // expressions.cpp
  Operand value(const ir::Expr& e, std::optional<Operand> into = std::nullopt);
  Operand value_of(const ir::Expr& e, std::optional<Operand> into);
  static std::uint32_t line_mark(const ir::Location& at) {
    return static_cast<std::uint32_t>(at.file) << 24 | static_cast<std::uint32_t>(at.line & 0xFFFFFF);
  }
  Operand constant(const ir::Expr& e);
  Operand binary(const ir::Expr& e, std::optional<Operand> into);
  Operand text_binary(const ir::Expr& e, std::optional<Operand> into);
  Operand short_circuit(const ir::Expr& e, std::optional<Operand> into);
  Operand unary(const ir::Expr& e, std::optional<Operand> into);
  void invert(const Type& type, Operand to, Operand from);
  Operand converted(const ir::Expr& e, std::optional<Operand> into);
  Operand native(const ir::Expr& e, std::optional<Operand> into);
  Operand choose(const ir::Expr& e, std::optional<Operand> into);
  Operand let(const ir::Expr& e, std::optional<Operand> into);
  Operand call(const ir::Expr& e, std::optional<Operand> into);
  std::vector<Operand> argument_values(const ir::Expr& e);
  void pass(const ir::Expr& e, std::uint32_t frame, const std::vector<Operand>& values);
  void give(const ir::Parameter& p, Operand from);
  Operand stable(const ir::Expr& e, bool keep);
  Operand destination(const ir::Expr& e, std::optional<Operand> into);
  static bool calls(const ir::Expr& e);
  static bool calls(const ir::Place& p);
  static bool cheap(const ir::Expr& e, int depth = 0);

  // statements.cpp
  void block(const ir::Block& b);
  void statement(const ir::Stmt& s);
  void assign(const ir::Stmt& s);
  void bind_statement(const ir::Stmt& s);
  void invoke(const ir::Stmt& s);
  void if_statement(const ir::Stmt& s);
  void case_statement(const ir::Stmt& s);
  void while_statement(const ir::Stmt& s);
  void repeat_statement(const ir::Stmt& s);
  void for_statement(const ir::Stmt& s);
  void finish_loop(std::size_t continue_at);
  void label(std::int32_t number);
  void jump(std::int32_t number);

  ir::Program program_;
  const Options& options_;
  syntax::Report& report_;
  std::shared_ptr<Image> image_;
  std::vector<Unit> units_;
  std::vector<Loop> loops_;
  std::vector<std::size_t> returns_;
  std::map<std::int32_t, std::size_t> labels_;                ///< of the current unit: where they stand
  std::map<std::int32_t, std::vector<std::size_t>> forward_;  ///< jumps to labels not yet met
  int current_ = -1;
  std::uint32_t line_ = 0;
  std::uint32_t top_ = 0, most_ = 0;      ///< temporaries of the current unit
  std::map<std::int64_t, Operand> kept_;  ///< where the values of let stand
  std::map<std::string, std::uint32_t> constants_;
  std::map<std::tuple<std::int64_t, std::int64_t, std::uint32_t>, std::uint16_t> bounds_;
  std::vector<std::uint8_t> constant_memory_;
};

/// Marks of operands that are not final yet.
inline constexpr std::uint32_t kTemporaryMark = 0x4000'0000u;
inline constexpr std::uint32_t kConstantMark = 0x2000'0000u;
inline constexpr std::uint32_t kAddressBits = 0x1FFF'FFFFu;

}  // namespace servogate::plc::code
