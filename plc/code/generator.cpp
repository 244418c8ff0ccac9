// SPDX-License-Identifier: Apache-2.0
#include "plc/code/generator.hpp"

#include <algorithm>
#include <cstring>

#include "plc/code/references.hpp"
#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::code {

using vm::Code;

Generator::Generator(ir::Program program, const Options& options, syntax::Report& report)
    : program_(std::move(program)), options_(options), report_(report), image_(std::make_shared<Image>()) {
  image_->types = program_.types;
  image_->files = program_.files;
  image_->budget = options.instruction_budget;
  image_->memory = program_.memory;
  units_.resize(program_.units.size());
}

std::shared_ptr<const Image> Generator::run() {
  for (const ir::Task& t : program_.tasks) {
    unit(t.unit);
    const Unit& u = units_[static_cast<std::size_t>(t.unit)];
    Image::Task task;
    task.name = t.name;
    task.interval = t.interval;
    task.entry = u.entry;
    task.length = u.length;
    if (t.has_single)
      task.single = t.single.root == ir::Root::shared ? program_.places[t.single.cell].address
                                                      : t.single.cell + t.single.offset;
    image_->tasks.push_back(std::move(task));
  }
  link();
  tables();
  image_->references = references(program_);
  return report_.failed() ? nullptr : image_;
}

Generator::Operand Generator::temporary(std::uint32_t size) {
  const std::uint32_t align = size >= 8 ? 8 : size >= 4 ? 4 : size;
  top_ = (top_ + align - 1) / align * align;
  const Operand out = kTemporaryMark | top_;
  top_ += size;
  most_ = std::max(most_, top_);
  return out;
}

Generator::Operand Generator::constant_bytes(const std::uint8_t* bytes, std::uint32_t size) {
  const std::string key(reinterpret_cast<const char*>(bytes), size);
  const auto known = constants_.find(key);
  if (known != constants_.end()) return kConstantMark | known->second;
  constant_memory_.resize((constant_memory_.size() + 7) / 8 * 8);
  const auto at = static_cast<std::uint32_t>(constant_memory_.size());
  constant_memory_.insert(constant_memory_.end(), bytes, bytes + size);
  constants_[key] = at;
  return kConstantMark | at;
}

Generator::Operand Generator::constant_integer(std::int64_t v, Cell cell) {
  std::uint8_t bytes[8];
  std::memcpy(bytes, &v, sizeof v);
  return constant_bytes(bytes, cell_size(cell));
}

std::size_t Generator::emit(Code code, Operand a, Operand b, Operand c, std::uint16_t aux) {
  report_.go_on();
  if (here() >= options_.most_instructions) {
    report_.error({static_cast<std::int16_t>(line_ >> 24), static_cast<int>(line_ & 0xFFFFFF), 1},
                  texts::kCodeSize, {std::to_string(options_.most_instructions)});
    throw syntax::Cancelled{};
  }
  image_->code.push_back({static_cast<std::uint16_t>(static_cast<int>(code) * 2), aux, a, b, c});
  image_->lines.push_back(line_);
  return image_->code.size() - 1;
}

std::uint16_t Generator::bounds(std::int64_t low, std::int64_t high, std::uint32_t stride) {
  auto& all = image_->bounds;
  const auto [at, fresh] = bounds_.try_emplace(
      {low, high, stride}, static_cast<std::uint16_t>(std::min<std::size_t>(all.size(), 65534)));
  if (fresh && all.size() >= 65535)
    report_.error({}, texts::kTooLarge, {"ARRAY", std::to_string(all.size()), "65535"});
  else if (fresh)
    all.push_back({low, high, stride});
  return at->second;
}

void Generator::callees(const ir::Place& p, std::vector<int>& out) {
  for (const ir::Step& s : p.steps) callees(*s.index, out);
  if (p.pointer) callees(*p.pointer, out);
}

void Generator::callees(const ir::Expr& e, std::vector<int>& out) {
  if (e.kind == ir::ExprKind::call) out.push_back(e.unit);
  for (const ir::ExprPtr& a : e.args) callees(*a, out);
  callees(e.place, out);
  for (const ir::Parameter& p : e.parameters) {
    if (p.value) callees(*p.value, out);
    callees(p.place, out);
  }
}

void Generator::callees(const ir::Block& b, std::vector<int>& out) {
  for (const ir::Stmt& s : b) {
    if (s.unit >= 0) out.push_back(s.unit);
    callees(s.place, out);
    callees(s.other, out);
    for (const ir::ExprPtr* e : {&s.value, &s.to, &s.by})
      if (*e) callees(**e, out);
    for (const ir::Branch& branch : s.branches) {
      if (branch.condition) callees(*branch.condition, out);
      callees(branch.body, out);
    }
    callees(s.body, out);
  }
}

// Callees first, so that their entries are known. There is no recursion.
void Generator::unit(int index) {
  Unit& out = units_[static_cast<std::size_t>(index)];
  if (out.done) return;
  const ir::Unit& u = program_.units[static_cast<std::size_t>(index)];
  std::vector<int> below;
  callees(u.body, below);
  for (const int c : below) {
    unit(c);
    out.depth = std::max(out.depth, units_[static_cast<std::size_t>(c)].depth + 1);
  }
  if (out.depth >= vm::kMaxCallDepth) {
    out.done = true;  // once, not for every way that leads here, nor for what calls it
    if (out.depth == vm::kMaxCallDepth)
      report_.error(u.at, texts::kTooDeep, {std::to_string(vm::kMaxCallDepth)});
    return;
  }
  current_ = index;
  top_ = most_ = 0;
  returns_.clear();
  labels_.clear();
  forward_.clear();
  out.entry = static_cast<std::uint32_t>(here());
  line_ = line_mark(u.at);
  resets(u);
  block(u.body);
  for (const std::size_t r : returns_) land(r);
  emit(Code::ret);
  out.length = static_cast<std::uint32_t>(here()) - out.entry;
  auto& memory = image_->memory;
  memory.resize((memory.size() + 7) / 8 * 8);
  const auto base = static_cast<std::uint32_t>(memory.size());
  memory.resize(memory.size() + most_);
  for (std::size_t i = out.entry; i < here(); ++i)
    for (std::uint32_t* operand : {&image_->code[i].a, &image_->code[i].b, &image_->code[i].c})
      if ((*operand & kTemporaryMark) != 0 && (*operand & vm::kInstanceFlag) == 0)
        *operand = base + (*operand & kAddressBits);
  out.done = true;
}

void Generator::resets(const ir::Unit& u) {
  for (std::size_t i = 0; i < u.resets.size();) {
    const std::uint32_t from = u.resets[i].offset;
    std::uint32_t end = from + u.resets[i].size;
    for (++i; i < u.resets.size() && u.resets[i].offset <= (end + 7) / 8 * 8 && u.resets[i].offset >= end;
         ++i) {
      // The gap between is padding, or an input: only join over padding.
      const auto& fields = u.frame->fields;
      const auto next = std::lower_bound(fields.begin(), fields.end(), end,
                                         [](const Field& f, std::uint32_t at) { return f.offset < at; });
      if (next != fields.end() && next->offset < u.resets[i].offset) break;
      end = u.resets[i].offset + u.resets[i].size;
    }
    std::vector<std::uint8_t> bytes(end - from);
    const std::vector<std::uint8_t>& image = u.frame->image;
    for (std::uint32_t b = from; b < end && b < image.size(); ++b) bytes[b - from] = image[b];
    const Operand to =
        u.fixed_base >= 0 ? static_cast<std::uint32_t>(u.fixed_base) + from : vm::kInstanceFlag | from;
    const std::uint32_t size = end - from;
    const Operand source = constant_bytes(bytes.data(), size);
    if (size == 1 || size == 2 || size == 4 || size == 8)
      emit(code_for_width(Code::move_w1, size), to, source);
    else
      emit(Code::move_bytes, to, source, size);
  }
}

void Generator::link() {
  auto& memory = image_->memory;
  memory.resize((memory.size() + 7) / 8 * 8);
  const auto base = static_cast<std::uint32_t>(memory.size());
  memory.insert(memory.end(), constant_memory_.begin(), constant_memory_.end());
  memory.resize(memory.size() + 16);  // wide loads near the end stay inside
  for (vm::Instruction& i : image_->code) {
    bool instance = false;
    for (std::uint32_t* operand : {&i.a, &i.b, &i.c}) {
      if ((*operand & vm::kInstanceFlag) != 0)
        instance = true;
      else if ((*operand & kConstantMark) != 0)
        *operand = base + (*operand & kAddressBits);
    }
    if (instance) i.op |= 1;
  }
  if (memory.size() > kAddressBits)
    report_.error({}, texts::kTooLarge, {"PROGRAM", std::to_string(memory.size()), "536870911"});
}

void Generator::tables() {
  for (const ir::SharedPlace& s : program_.places) {
    Image::Shared out;
    out.name = s.name;
    out.place = s.place;
    out.type = s.type;
    out.address = s.address;
    out.raw = s.raw;
    out.written = s.written;
    out.initialised = s.initialised;
    if (s.initialised) {
      out.initial.resize(s.type->size);
      sema::store_constant(*s.type, s.initial, out.initial.data());
    }
    const std::uint32_t end = s.place.byte() + s.place.bytes();
    if (s.place.packet == image::Packet::k) image_->k_bytes = std::max(image_->k_bytes, end);
    if (s.place.packet == image::Packet::v) image_->v_bytes = std::max(image_->v_bytes, end);
    image_->places.push_back(std::move(out));
  }
  image_->globals = program_.globals;
  for (ir::Global& g : image_->globals)
    if (g.place >= 0) g.address = program_.places[static_cast<std::size_t>(g.place)].address;
  image_->programs = program_.programs;
  units();
  for (const ir::Global& g : image_->globals)
    if (g.retain && g.place < 0) retained_cells(g.name, *g.type, g.address, true);
  for (const ir::Global& p : image_->programs) retained_cells(p.name, *p.type, p.address, p.retain);
  for (std::size_t i = 0; i < program_.places.size(); ++i)
    if (const ir::SharedPlace& s = program_.places[i]; s.retain && s.written && !s.raw)
      retained_cell(s.name, *s.type, s.address, static_cast<std::int32_t>(i));
}

void Generator::units() {
  const auto library = static_cast<int>(program_.files.size()) - 1;
  for (std::size_t i = 0; i < program_.units.size(); ++i) {
    const ir::Unit& u = program_.units[i];
    image_->units.push_back(
        {u.name, u.kind, u.frame, u.fixed_base, units_[i].entry, units_[i].done, u.at.file >= library});
  }
}

void Generator::retained_cells(const std::string& name, const Type& type, std::uint32_t address, bool all) {
  if (type.kind == Kind::structure || type.kind == Kind::block) {
    for (const Field& f : type.fields)
      if (!f.reference && !f.constant)
        retained_cells(name + "." + f.name, *f.type, address + f.offset, (all && !f.non_retain) || f.retain);
  } else if (type.kind == Kind::array) {
    if (!all && type.base->kind != Kind::block) return;
    for (std::int64_t i = type.range.low; i <= type.range.high; ++i)
      retained_cells(name + "[" + std::to_string(i) + "]", *type.base,
                     address + static_cast<std::uint32_t>(i - type.range.low) * type.base->size, all);
  } else if (all && type.kind != Kind::reference) {
    retained_cell(name, type, address, -1);
  }
}

void Generator::retained_cell(const std::string& name, const Type& type, std::uint32_t address,
                              std::int32_t place) {
  report_.go_on();
  image_->retained.push_back({name, &type, address, image_->retain_bytes, place});
  image_->retain_bytes += type.size;
}

}  // namespace servogate::plc::code
