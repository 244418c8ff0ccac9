// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/code/generator.hpp"

namespace servogate::plc::code {

using vm::Code;

// The operand of a place's own cell, before references, steps and bits.
Generator::Operand Generator::base(const ir::Place& p) {
  const ir::Unit& u = program_.units[static_cast<std::size_t>(current_)];
  const bool reference = p.root == ir::Root::reference || p.root == ir::Root::pointer;
  const std::uint32_t cell = p.cell + (reference ? 0 : p.offset);
  switch (p.root) {
    case ir::Root::fixed:
    case ir::Root::pointer:
      return cell;
    case ir::Root::shared:
      return program_.places[p.cell].address + p.offset;
    default:
      return u.fixed_base >= 0 ? static_cast<std::uint32_t>(u.fixed_base) + cell : vm::kInstanceFlag | cell;
  }
}

// The cell with the address that a reference holds; a copy where a subscript behind it calls a function.
Generator::Operand Generator::followed(const ir::Place& p) {
  Operand cell = value(*p.pointer);
  if (std::any_of(p.steps.begin(), p.steps.end(), [](const ir::Step& s) { return calls(*s.index); })) {
    const Operand kept = temporary(4);
    emit(Code::move_w4, kept, cell);
    cell = kept;
  }
  emit(Code::check_reference, cell);
  return cell;
}

Generator::Target Generator::target(const ir::Place& p) {
  Target t;
  t.where = p.pointer ? followed(p) : base(p);
  t.bit = p.bit;
  if (p.root == ir::Root::shared) {
    const ir::SharedPlace& s = program_.places[p.cell];
    if (s.raw && s.place.format == image::Format::bl) t.bit = s.place.bit();
  }
  if (p.root == ir::Root::reference || p.root == ir::Root::pointer || p.pointer) {
    t.indirect = true;
    t.offset = p.offset;
  }
  for (const ir::Step& s : p.steps) {
    const Operand index = value(*s.index);
    const Operand cell = temporary(4);
    if (s.limits) {
      const Target limits = target(s.limits->place);
      emit(Code::extra, 0, limits.where);
      emit(Code::index_open, cell, t.where, index, static_cast<std::uint16_t>(limits.offset));
      t.where = cell;
      t.indirect = true;
      continue;
    }
    const Code first = t.indirect ? Code::index_add_i8 : Code::index_at_i8;
    emit(vm::code_for(first, cell_of(*s.index->type)), cell, t.where, index, bounds(s.low, s.high, s.stride));
    t.where = cell;
    t.indirect = true;
  }
  return t;
}

// A cell that holds the target's address, its offset included.
Generator::Operand Generator::reference(const ir::Place& p) {
  const Target t = target(p);
  if (t.indirect && t.offset == 0) return t.where;
  const Operand cell = temporary(4);
  if (t.indirect)
    emit(Code::add_u32, cell, t.where, constant_integer(t.offset, Cell::u32));
  else
    emit(Code::address, cell, t.where);
  return cell;
}

void Generator::bind(Operand cell, const ir::Place& p) {
  const Target t = target(p);
  if (!t.indirect)
    emit(Code::address, cell, t.where);
  else if (t.offset == 0)
    emit(Code::move_w4, cell, t.where);
  else
    emit(Code::add_u32, cell, t.where, constant_integer(t.offset, Cell::u32));
}

Generator::Operand Generator::load(const Target& t, const Type& type, std::optional<Operand> into) {
  const Cell cell = cell_of(type);
  if (t.bit >= 0) {
    Operand byte = t.where;
    if (t.indirect) {
      byte = temporary(1);
      emit(Code::load_w1, byte, t.where, t.offset);
    }
    const Operand out = into ? *into : temporary(1);
    emit(Code::load_bit, out, byte, 0, static_cast<std::uint16_t>(t.bit));
    return out;
  }
  if (!t.indirect) {
    if (!into) return t.where;
    copy(type, *into, t.where);
    return *into;
  }
  if (!is_text(type.kind) && cell != Cell::blob) {
    const Operand out = into ? *into : temporary(type.size);
    emit(vm::code_for_width(Code::load_w1, type.size), out, t.where, t.offset);
    return out;
  }
  Operand address = t.where;
  if (t.offset != 0) {
    address = temporary(4);
    emit(Code::add_u32, address, t.where, constant_integer(t.offset, Cell::u32));
  }
  const Operand out = into && cell == Cell::blob ? *into : temporary(type.size);
  emit(Code::load_bytes, out, address, type.size);
  if (into && out != *into) copy(type, *into, out);
  return into ? *into : out;
}

void Generator::store(const Target& t, const Type& type, Operand from) {
  if (t.bit >= 0) {
    if (!t.indirect) {
      emit(Code::store_bit, t.where, from, 0, static_cast<std::uint16_t>(t.bit));
      return;
    }
    const Operand byte = temporary(1);
    emit(Code::load_w1, byte, t.where, t.offset);
    emit(Code::store_bit, byte, from, 0, static_cast<std::uint16_t>(t.bit));
    emit(Code::store_w1, t.where, byte, t.offset);
    return;
  }
  if (!t.indirect) {
    copy(type, t.where, from);
    return;
  }
  const bool text = is_text(type.kind);
  if (!text && cell_of(type) != Cell::blob) {
    emit(vm::code_for_width(Code::store_w1, type.size), t.where, from, t.offset);
    return;
  }
  Operand address = t.where;
  if (t.offset != 0) {
    address = temporary(4);
    emit(Code::add_u32, address, t.where, constant_integer(t.offset, Cell::u32));
  }
  Operand source = from;
  if (text) {  // cut to the capacity of the target first
    source = temporary(type.size);
    move_text(type.kind, source, from, type.capacity());
  }
  emit(Code::store_bytes, address, source, type.size);
}

void Generator::move_text(Kind kind, Operand to, Operand from, std::uint32_t capacity) {
  emit(kind == Kind::wide_string ? Code::move_wide_text : Code::move_text, to, from, 0,
       static_cast<std::uint16_t>(capacity));
}

void Generator::copy(const Type& type, Operand to, Operand from) {
  if (to == from) return;
  switch (cell_of(type)) {
    case Cell::text:
    case Cell::wide_text:
      return move_text(type.kind, to, from, type.capacity());
    case Cell::blob:
      emit(Code::move_bytes, to, from, type.size);
      return;
    default:
      emit(vm::code_for_width(Code::move_w1, type.size), to, from);
  }
}

}  // namespace servogate::plc::code
