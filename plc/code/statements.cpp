// SPDX-License-Identifier: Apache-2.0
#include "plc/code/generator.hpp"

namespace servogate::plc::code {

using ir::StmtKind;
using vm::Code;

void Generator::block(const ir::Block& b) {
  for (const ir::Stmt& s : b) {
    const std::uint32_t mark = top_;
    line_ = line_mark(s.at);
    statement(s);
    top_ = mark;
  }
}

void Generator::statement(const ir::Stmt& s) {
  switch (s.kind) {
    case StmtKind::assign:
      return assign(s);
    case StmtKind::bind:
      return bind_statement(s);
    case StmtKind::invoke:
      return invoke(s);
    case StmtKind::evaluate:
      value(*s.value);
      return;
    case StmtKind::if_:
      return if_statement(s);
    case StmtKind::case_:
      return case_statement(s);
    case StmtKind::while_:
      return while_statement(s);
    case StmtKind::repeat:
      return repeat_statement(s);
    case StmtKind::for_:
      return for_statement(s);
    case StmtKind::exit:
      if (!loops_.empty()) loops_.back().exits.push_back(emit(Code::jump));
      return;
    case StmtKind::continue_:
      if (!loops_.empty()) loops_.back().continues.push_back(emit(Code::jump));
      return;
    case StmtKind::return_:
      returns_.push_back(emit(Code::jump));
      return;
    case StmtKind::label:
      return label(s.label);
    case StmtKind::jump:
      return jump(s.label);
  }
}

void Generator::assign(const ir::Stmt& s) {
  const Type& type = *s.place.type;
  if (s.check_range) {
    const Operand v = stable(*s.value, calls(s.place));
    emit(vm::code_for(Code::check_i8, cell_of(type)), v, 0, 0, bounds(type.limits.low, type.limits.high, 0));
    store(target(s.place), type, v);
    return;
  }
  const bool direct =
      !s.place.computed() && s.place.root != ir::Root::reference && s.place.root != ir::Root::pointer;
  const Target t = direct ? target(s.place) : Target{};
  const bool scalar = !is_text(type.kind) && cell_of(type) != Cell::blob;
  if (direct && t.bit < 0 && scalar) {
    value(*s.value, t.where);
    return;
  }
  const Operand v = stable(*s.value, calls(s.place));
  store(direct ? t : target(s.place), type, v);
}

void Generator::bind_statement(const ir::Stmt& s) {
  const Target cell = target(s.place);
  if (!cell.indirect) return bind(cell.where, s.other);
  const Operand address = temporary(4);
  bind(address, s.other);
  emit(Code::store_w4, cell.where, address, cell.offset);
}

void Generator::invoke(const ir::Stmt& s) {
  const Unit& callee = units_[static_cast<std::size_t>(s.unit)];
  const Target t = target(s.place);
  if (!t.indirect)
    emit(Code::call, callee.entry, t.where, callee.length);
  else
    emit(Code::call_at, callee.entry, reference(s.place), callee.length);
}

void Generator::if_statement(const ir::Stmt& s) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i < s.branches.size(); ++i) {
    const std::uint32_t mark = top_;
    line_ = line_mark(s.branches[i].condition->at);
    const Operand c = value(*s.branches[i].condition);
    const std::size_t skip = emit(Code::jump_false, c);
    top_ = mark;
    block(s.branches[i].body);
    const bool last = i + 1 == s.branches.size() && s.body.empty();
    if (!last) ends.push_back(emit(Code::jump));
    land(skip);
  }
  block(s.body);
  for (const std::size_t e : ends) land(e);
}

void Generator::case_statement(const ir::Stmt& s) {
  const Cell cell = cell_of(*s.value->type);
  const Operand selector = value(*s.value);
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i < s.branches.size(); ++i) {
    const ir::Branch& b = s.branches[i];
    std::vector<std::size_t> hits;
    for (const ir::Range& r : b.ranges) {
      const std::uint32_t mark = top_;
      const Operand test = temporary(1);
      if (r.low == r.high) {
        emit(vm::code_for(Code::eq_i8, cell), test, selector, constant_integer(r.low, cell));
        hits.push_back(emit(Code::jump_true, test));
      } else {
        emit(vm::code_for(Code::le_i8, cell), test, constant_integer(r.low, cell), selector);
        const std::size_t below = emit(Code::jump_false, test);
        emit(vm::code_for(Code::le_i8, cell), test, selector, constant_integer(r.high, cell));
        hits.push_back(emit(Code::jump_true, test));
        land(below);
      }
      top_ = mark;
    }
    const std::size_t miss = emit(Code::jump);
    for (const std::size_t h : hits) land(h);
    block(b.body);
    const bool last = i + 1 == s.branches.size() && s.body.empty();
    if (!last) ends.push_back(emit(Code::jump));
    land(miss);
  }
  block(s.body);
  for (const std::size_t e : ends) land(e);
}

void Generator::finish_loop(std::size_t continue_at) {
  const Loop loop = std::move(loops_.back());
  loops_.pop_back();
  for (const std::size_t c : loop.continues) {
    image_->code[c].c = static_cast<std::uint32_t>(continue_at);
    if (continue_at <= c)
      image_->code[c].op = static_cast<std::uint16_t>(static_cast<int>(Code::jump_back) * 2);
  }
  for (const std::size_t e : loop.exits) land(e);
}

void Generator::label(std::int32_t number) {
  labels_[number] = here();
  for (const std::size_t j : forward_[number]) land(j);
  forward_[number].clear();
}

void Generator::jump(std::int32_t number) {
  const auto back = labels_.find(number);
  if (back == labels_.end()) {
    forward_[number].push_back(emit(Code::jump));
    return;
  }
  emit(Code::jump_back, 0, 0, static_cast<Operand>(back->second));
}

void Generator::while_statement(const ir::Stmt& s) {
  const std::size_t begin = here();
  const std::uint32_t line = line_;
  loops_.emplace_back();
  const Operand c = value(*s.value);
  const std::size_t end = emit(Code::jump_false, c);
  block(s.body);
  line_ = line;
  emit(Code::jump_back, 0, 0, static_cast<Operand>(begin));
  land(end);
  finish_loop(begin);
}

void Generator::repeat_statement(const ir::Stmt& s) {
  const std::size_t begin = here();
  const std::uint32_t line = line_;
  loops_.emplace_back();
  block(s.body);
  line_ = line;
  const std::size_t test = here();
  const Operand c = value(*s.value);
  emit(Code::repeat_until, c, 0, static_cast<Operand>(begin));
  finish_loop(test);
}

void Generator::for_statement(const ir::Stmt& s) {
  const std::uint32_t line = line_;
  const Operand counter = temporary(24);
  value(*s.value, counter);
  value(*s.to, counter + 8);
  value(*s.by, counter + 16);
  const bool direct = s.place.root != ir::Root::reference && s.place.root != ir::Root::pointer &&
                      !s.place.computed() && target(s.place).bit < 0;
  const Operand control = direct ? base(s.place) : temporary(8);
  const Cell cell = cell_of(*s.place.type);
  const auto show = [&] {
    if (!direct) store(target(s.place), *s.place.type, control);
  };
  loops_.emplace_back();
  const std::size_t check = emit(Code::for_check, counter, control, 0, static_cast<std::uint16_t>(cell));
  const std::size_t begin = here();
  if (s.check_range) {
    const Dimension& limits = s.place.type->limits;
    emit(vm::code_for(Code::check_i8, cell), control, 0, 0, bounds(limits.low, limits.high, 0));
  }
  show();
  block(s.body);
  line_ = line;
  const std::size_t next =
      emit(Code::for_next, counter, control, static_cast<Operand>(begin), static_cast<std::uint16_t>(cell));
  land(check);
  show();
  finish_loop(next);
}

}  // namespace servogate::plc::code
