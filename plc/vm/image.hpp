// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plc/ir/ir.hpp"
#include "plc/vm/opcodes.hpp"

namespace servogate::plc {

/// A compiled program: code, initial memory, and what is needed to find and show variables. Immutable and
/// shared between engines.
struct Image {
  struct Bounds {
    std::int64_t low = 0, high = 0;
    std::uint32_t stride = 0;
    bool operator==(const Bounds&) const = default;
  };
  struct Task {
    std::string name;
    image::Nanoseconds interval = 0;
    std::uint32_t entry = 0;
    std::uint32_t length = 0;  ///< instructions of its body, charged at its start
    std::int64_t single = -1;  ///< address of the BOOL whose rising edge starts it
  };
  struct Shared {
    std::string name;
    image::Place place;
    const Type* type = nullptr;
    std::uint32_t address = 0;
    bool raw = false;
    bool written = false;
    bool initialised = false;
    std::vector<std::uint8_t> initial;
  };
  struct Range {
    std::uint32_t address = 0, size = 0;
  };
  /// A retained variable of elementary type.
  struct RetainedCell {
    std::string name;
    const Type* type = nullptr;
    std::uint32_t address = 0;
    std::uint32_t offset = 0;  ///< in a snapshot
    std::int32_t place = -1;   ///< index of the packet place it mirrors, -1: none
  };

  /// A body that runs: program, function or function block.
  struct Unit {
    std::string name;
    syntax::UnitKind kind = syntax::UnitKind::program;
    const Type* frame = nullptr;
    std::int64_t fixed_base = -1;  ///< address of the only instance, -1: several
    std::uint32_t entry = 0;       ///< its first instruction
    bool reached = false;          ///< some task runs it
    bool from_library = false;     ///< a standard block or function
  };
  /// A variable at a place of the source where it is read or written.
  struct Reference {
    enum class Base : std::uint8_t { fixed, unit, place };
    std::string name;  ///< of a function block: as `Block.member`
    const Type* type = nullptr;
    std::int32_t unit = -1;  ///< index of units, of the body in which it stands
    Base base = Base::fixed;
    std::uint32_t cell = 0;  ///< address, offset in the unit's own memory, or index of places
    std::int32_t file = 0, line = 0, column = 0;
    bool write = false;
    bool bound = false;  ///< the cell holds the address: VAR_IN_OUT, AT %Q*
  };

  std::shared_ptr<const TypeTable> types;
  std::vector<vm::Instruction> code;
  std::vector<std::uint32_t> lines;  ///< parallel to code: file number << 24 | line
  std::vector<Bounds> bounds;
  std::vector<std::uint8_t> memory;
  std::vector<Task> tasks;
  std::vector<Shared> places;
  std::vector<ir::Global> globals;
  std::vector<ir::Global> programs;
  std::vector<RetainedCell> retained;
  std::vector<Unit> units;
  std::vector<Reference> references;  ///< in the order of the source
  std::uint32_t retain_bytes = 0;
  std::vector<std::string> files;
  std::int64_t budget = 0;
  std::uint32_t k_bytes = 0, v_bytes = 0;  ///< least sizes of the packets
};

}  // namespace servogate::plc
