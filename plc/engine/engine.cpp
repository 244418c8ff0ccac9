// SPDX-License-Identifier: Apache-2.0
#include "plc/engine/engine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "plc/engine/scan_watch.hpp"
#include "plc/engine/transfer.hpp"
#include "plc/terms/texts.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/machine.hpp"

namespace servogate::plc {

namespace {

/// The way of one place between packet and memory, as short as a scan wants it.
struct Move {
  enum class Kind : std::uint8_t { bit, raw_bit, bytes1, bytes2, bytes4, bytes8, text } kind;
  image::Packet packet;
  std::uint8_t detail;  ///< number of the bit, or of the characters
  std::uint32_t byte;
  std::uint32_t address;
};

/// The same of a bit that is taken in.
struct BitIn {
  std::uint32_t address;
  std::uint16_t byte;
  image::Packet packet;
  std::uint8_t bit;
};
static_assert(image::kPacketKMaxSize <= 0xFFFF && image::kPacketASize <= 0xFFFF);

}  // namespace

struct Engine::State {
  struct TaskState {
    image::Nanoseconds next = std::numeric_limits<image::Nanoseconds>::min();
    bool last = false;
  };
  std::vector<std::uint8_t> memory;
  std::vector<BitIn> bits_in;  ///< most places are bits: a list of their own, as short as a scan wants it
  std::vector<Move> taken_in, put_back;  ///< the others; all that is written, in its order
  std::vector<Forcing> forces;
  std::vector<Times> task_times;
  const image::Clock* clock = nullptr;
  Times* blocks = nullptr;
  ScanWatch own_watch;
  ScanWatch* watch = &own_watch;
  struct Copy {
    std::uint32_t from, to, size;
  };
  std::vector<Copy> retained;            ///< memory to snapshot, neighbours together
  std::vector<std::uint8_t> given_back;  ///< restored bytes of places, which the first scan would take anew
  std::vector<Copy> given_back_places;
  std::vector<TaskState> tasks;
  ScanResult fault;
  bool first = true;
  void apply_forces() noexcept;
};

namespace {

Move move_of(const Image::Shared& s) {
  using Kind = Move::Kind;
  const image::Place& p = s.place;
  switch (p.format) {
    case image::Format::bl:
      return {s.raw ? Kind::raw_bit : Kind::bit, p.packet, p.bit(), p.byte(), s.address};
    case image::Format::ch:
      return {Kind::text, p.packet, p.length, p.byte(), s.address};
    default:
      break;
  }
  const std::uint32_t size = image::format_size(p.format);
  const Kind kind = size == 1   ? Kind::bytes1
                    : size == 2 ? Kind::bytes2
                    : size == 4 ? Kind::bytes4
                                : Kind::bytes8;
  return {kind, p.packet, 0, p.byte(), s.address};
}

inline void take_in(const Move& m, const std::uint8_t* from, std::uint8_t* at) noexcept {
  using Kind = Move::Kind;
  switch (m.kind) {
    case Kind::bit:
      *at = static_cast<std::uint8_t>((*from >> m.detail) & 1);
      return;
    case Kind::raw_bit:
    case Kind::bytes1:
      *at = *from;
      return;
    case Kind::bytes2:
      std::memcpy(at, from, 2);
      return;
    case Kind::bytes4:
      std::memcpy(at, from, 4);
      return;
    case Kind::bytes8:
      std::memcpy(at, from, 8);
      return;
    case Kind::text: {
      std::size_t n = m.detail;
      while (n > 0 && (from[n - 1] == ' ' || from[n - 1] == 0)) --n;
      *at = static_cast<std::uint8_t>(n);
      std::memcpy(at + 1, from, n);
      return;
    }
  }
}

void set_bit(std::uint8_t* byte, int bit, bool on) noexcept {
  const auto mask = static_cast<std::uint8_t>(1u << bit);
  *byte = static_cast<std::uint8_t>(on ? (*byte | mask) : (*byte & ~mask));
}

inline void put_back(const Move& m, std::uint8_t* to, const std::uint8_t* at) noexcept {
  using Kind = Move::Kind;
  switch (m.kind) {
    case Kind::bit:
      return set_bit(to, m.detail, *at != 0);
    case Kind::raw_bit:
      return set_bit(to, m.detail, ((*at >> m.detail) & 1) != 0);
    case Kind::bytes1:
      *to = *at;
      return;
    case Kind::bytes2:
      std::memcpy(to, at, 2);
      return;
    case Kind::bytes4:
      std::memcpy(to, at, 4);
      return;
    case Kind::bytes8:
      std::memcpy(to, at, 8);
      return;
    case Kind::text: {
      const std::size_t n = std::min(*at, m.detail);
      std::memcpy(to, at + 1, n);
      std::memset(to + n, ' ', m.detail - n);
      return;
    }
  }
}

void drop(const Image::Shared& s, image::Packets& packets) noexcept {
  std::uint8_t* to = packets.data(s.place.packet) + s.place.byte();
  if (s.place.format == image::Format::bl)
    *to = static_cast<std::uint8_t>(*to & ~(1u << s.place.bit()));
  else
    std::memset(to, s.place.format == image::Format::ch ? ' ' : 0, s.place.bytes());
}

std::array<std::uint8_t*, 3> packets_of(image::Packets& packets) noexcept {
  return {packets.data(image::Packet::a), packets.data(image::Packet::k), packets.data(image::Packet::v)};
}

}  // namespace

void Engine::State::apply_forces() noexcept {
  for (const Forcing& f : forces)
    if (f.handle.bit >= 0)
      set_bit(memory.data() + f.handle.address, f.handle.bit, f.bytes[0] != 0);
    else
      std::memcpy(memory.data() + f.handle.address, f.bytes.data(), f.size);
}

Engine::Engine(std::shared_ptr<const Image> image)
    : image_(std::move(image)), state_(std::make_unique<State>()) {
  state_->forces.reserve(kMaxForces);
  state_->task_times.resize(image_->tasks.size());
  for (const Image::Shared& place : image_->places) {
    const Move move = move_of(place);
    if (move.kind == Move::Kind::bit)
      state_->bits_in.push_back(
          {move.address, static_cast<std::uint16_t>(move.byte), move.packet, move.detail});
    else
      state_->taken_in.push_back(move);
    if (place.written) state_->put_back.push_back(move);
  }
  for (const Image::RetainedCell& c : image_->retained) {
    auto& copies = state_->retained;
    if (!copies.empty() && copies.back().from + copies.back().size == c.address &&
        copies.back().to + copies.back().size == c.offset)
      copies.back().size += c.type->size;
    else
      copies.push_back({c.address, c.offset, c.type->size});
  }
  restart();
}
Engine::~Engine() = default;

void Engine::restart() {
  state_->memory = image_->memory;
  state_->tasks.assign(image_->tasks.size(), {});
  state_->fault = {};
  state_->first = true;
  state_->given_back.clear();
  state_->given_back_places.clear();
}

// What the program sees of the packets, the first values of its places, and what is forced.
void Engine::take_inputs(image::Packets& packets) noexcept {
  State& s = *state_;
  std::uint8_t* const mem = s.memory.data();
  const std::array<std::uint8_t*, 3> packet = packets_of(packets);
  for (const BitIn& b : s.bits_in)
    mem[b.address] = (packet[static_cast<std::size_t>(b.packet)][b.byte] >> b.bit) & 1;
  for (const Move& m : s.taken_in)
    take_in(m, packet[static_cast<std::size_t>(m.packet)] + m.byte, mem + m.address);
  if (s.first)
    for (const Image::Shared& p : image_->places)
      if (p.initialised) {
        if (p.raw && p.place.format == image::Format::bl)
          set_bit(mem + p.address, p.place.bit(), p.initial[0] != 0);
        else
          std::memcpy(mem + p.address, p.initial.data(), p.initial.size());
      }
  for (const State::Copy& c : s.given_back_places)
    std::memcpy(mem + c.to, s.given_back.data() + c.from, c.size);
  s.given_back_places.clear();
  s.first = false;
  s.apply_forces();
}

void Engine::give_outputs(image::Packets& packets) noexcept {
  State& s = *state_;
  s.apply_forces();
  const std::array<std::uint8_t*, 3> packet = packets_of(packets);
  const std::uint8_t* const mem = s.memory.data();
  for (const Move& m : s.put_back) {
    std::uint8_t* const to = packet[static_cast<std::size_t>(m.packet)] + m.byte;
    // A branch of their own for bits is shorter than the choice among all kinds.
    if (m.kind == Move::Kind::bit)
      set_bit(to, m.detail, mem[m.address] != 0);
    else
      put_back(m, to, mem + m.address);
  }
}

void Engine::drop_outputs(image::Packets& packets) noexcept {
  for (const Image::Shared& p : image_->places)
    if (p.written) drop(p, packets);
}

// Whether a task runs in this scan; an interval then begins anew (IEC 61131-3, 6.8.2).
bool Engine::due(std::size_t index, image::Nanoseconds t_ns) noexcept {
  const Image::Task& task = image_->tasks[index];
  State::TaskState& state = state_->tasks[index];
  bool edge = false;
  if (task.single >= 0) {
    const bool level = state_->memory[static_cast<std::size_t>(task.single)] != 0;
    edge = level && !state.last;
    state.last = level;
    if (!edge && (task.interval == 0 || level)) return false;
  }
  if (!edge && task.interval > 0 && t_ns < state.next) return false;
  if (task.interval > 0) {
    // On its own grid; a grid finer than the cycle runs once a cycle.
    if (state.next == std::numeric_limits<image::Nanoseconds>::min()) state.next = t_ns;
    state.next += ((t_ns - state.next) / task.interval + 1) * task.interval;
  }
  return true;
}

// By priority; a fault ends the scan and is named with its task and line.
ScanResult Engine::run_tasks(image::Nanoseconds t_ns) noexcept {
  State& s = *state_;
  const Image& im = *image_;
  vm::Machine machine;
  machine.memory = s.memory.data();
  machine.image = &im;
  machine.now_ns = t_ns;
  machine.budget = im.budget;
  machine.clock = s.clock;
  machine.blocks = s.clock != nullptr ? s.blocks : nullptr;
  machine.scan = s.watch->begin();
  machine.ended = &s.watch->ended();
  ScanResult result;
  for (std::size_t i = 0; i < im.tasks.size() && result.fault == Fault::none; ++i) {
    if (!due(i, t_ns)) continue;
    const Image::Task& task = im.tasks[i];
    machine.budget -= task.length;
    const image::Nanoseconds began = s.clock != nullptr ? s.clock->now_ns() : 0;
    machine.at = task.entry;
    result.fault = machine.budget < 0 ? Fault::budget
                   : machine.ended->load(std::memory_order_relaxed) == machine.scan
                       ? Fault::overrun
                       : vm::execute(machine, task.entry);
    if (s.clock != nullptr) s.task_times[i].add(s.clock->now_ns() - began);
    if (result.fault == Fault::none) continue;
    result.task = static_cast<std::int16_t>(i);
    result.file = static_cast<std::int16_t>(im.lines[machine.at] >> 24);
    result.line = static_cast<std::int32_t>(im.lines[machine.at] & 0xFFFFFF);
  }
  s.watch->close();
  result.instructions = im.budget - machine.budget;
  return result;
}

ScanResult Engine::scan(image::Packets& packets, image::Nanoseconds t_ns) noexcept {
  State& s = *state_;
  if (s.fault.fault == Fault::none && (packets.size(image::Packet::k) < image_->k_bytes ||
                                       packets.size(image::Packet::v) < image_->v_bytes)) {
    s.fault = {};
    s.fault.fault = Fault::packet_size;
  }
  if (s.fault.fault == Fault::packet_size) return s.fault;
  if (s.fault.fault != Fault::none) {
    drop_outputs(packets);
    return s.fault;
  }
  take_inputs(packets);
  const ScanResult result = run_tasks(t_ns);
  if (result.fault == Fault::none) {
    give_outputs(packets);
  } else {
    s.fault = result;
    drop_outputs(packets);
  }
  return result;
}

ScanResult Engine::fault() const noexcept { return state_->fault; }

text::Finding Engine::describe(const ScanResult& r) const {
  static const text::Entry* const entries[] = {nullptr,
                                               &texts::kFaultBudget,
                                               &texts::kFaultDivision,
                                               &texts::kFaultIndex,
                                               &texts::kFaultSubrange,
                                               &texts::kFaultConversion,
                                               &texts::kFaultSelector,
                                               &texts::kFaultText,
                                               &texts::kFaultReference,
                                               &texts::kFaultOverrun,
                                               &texts::kFaultPackets};
  text::Finding f;
  f.file = file_name(r.file);
  f.line = r.line;
  f.column = r.line > 0 ? 1 : 0;
  f.entry = entries[static_cast<int>(r.fault)];
  f.arguments = {std::string(task_name(r.task)), std::to_string(image_->budget)};
  return f;
}

std::string_view Engine::task_name(int task) const noexcept {
  return task >= 0 && static_cast<std::size_t>(task) < image_->tasks.size()
             ? std::string_view(image_->tasks[static_cast<std::size_t>(task)].name)
             : std::string_view();
}
std::string_view Engine::file_name(int file) const noexcept {
  return file >= 0 && static_cast<std::size_t>(file) < image_->files.size()
             ? std::string_view(image_->files[static_cast<std::size_t>(file)])
             : std::string_view();
}

std::optional<Handle> Engine::find(std::string_view name) const { return find_variable(*image_, name); }
std::string Engine::name_of(const Handle& h) const { return variable_name(*image_, h); }

std::string Engine::type_name(const Handle& h) const { return h.bit >= 0 ? "BOOL" : h.type->name; }

std::string Engine::read(const Handle& h) const { return value_text(*image_, *h.type, data(h), h.bit); }

double Engine::number(const Handle& h) const noexcept {
  const std::uint8_t* at = state_->memory.data() + h.address;
  return h.bit >= 0 ? (*at >> h.bit) & 1 : to_number(*h.type, at);
}

const std::uint8_t* Engine::data(const Handle& h) const noexcept { return state_->memory.data() + h.address; }

static_assert(sizeof(Forcing::bytes) >= kMaxElementarySize);

namespace {
// Puts bytes of a value into a variable, and into the packet where it mirrors a place.
void assign(const Image& image, std::vector<std::uint8_t>& memory, image::Packets& packets, const Handle& h,
            const std::uint8_t* bytes) noexcept {
  std::uint8_t* at = memory.data() + h.address;
  const Image::Shared* s = h.place >= 0 ? &image.places[static_cast<std::size_t>(h.place)] : nullptr;
  if (s != nullptr)
    take_in(move_of(*s), packets.data(s->place.packet) + s->place.byte(), memory.data() + s->address);
  if (h.bit >= 0)
    set_bit(at, h.bit, bytes[0] != 0);
  else
    std::memcpy(at, bytes, value_size(*h.type, bytes));
  if (s != nullptr)
    put_back(move_of(*s), packets.data(s->place.packet) + s->place.byte(), memory.data() + s->address);
}
}  // namespace

bool Engine::write(image::Packets& packets, const Handle& h, std::string_view text) {
  std::array<std::uint8_t, kMaxElementarySize> bytes{};
  if (!parse_value(*h.type, text, bytes.data())) return false;
  assign(*image_, state_->memory, packets, h, bytes.data());
  return true;
}

bool Engine::set_number(image::Packets& packets, const Handle& h, double value) noexcept {
  std::array<std::uint8_t, 8> bytes{};
  if (!from_number(*h.type, value, bytes.data())) return false;
  assign(*image_, state_->memory, packets, h, bytes.data());
  return true;
}

std::optional<Forcing> Engine::prepare_force(const Handle& h, std::string_view text) const {
  Forcing f;
  f.handle = h;
  if (!parse_value(*h.type, text, f.bytes.data())) return std::nullopt;
  f.size = value_size(*h.type, f.bytes.data());
  return f;
}

bool Engine::apply(const Forcing& forcing) noexcept {
  release_now(forcing.handle);
  if (state_->forces.size() >= kMaxForces) return false;
  state_->forces.push_back(forcing);  // reserved
  return true;
}

void Engine::release_now(const Handle& h) noexcept {
  std::vector<Forcing>& forces = state_->forces;
  for (std::size_t i = 0; i < forces.size(); ++i)
    if (forces[i].handle.address == h.address && forces[i].handle.bit == h.bit) {
      for (; i + 1 < forces.size(); ++i) forces[i] = forces[i + 1];
      forces.pop_back();
      return;
    }
}
void Engine::release_all_now() noexcept { state_->forces.clear(); }

bool Engine::force(const Handle& h, std::string_view text) {
  const auto forcing = prepare_force(h, text);
  return forcing && apply(*forcing);
}
void Engine::release(const Handle& h) { release_now(h); }
void Engine::release_all() { release_all_now(); }

std::vector<std::pair<std::string, std::string>> Engine::forced() const {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Forcing& f : state_->forces)
    out.emplace_back(name_of(f.handle), f.handle.type->kind == Kind::boolean
                                            ? f.bytes[0] != 0 ? "TRUE" : "FALSE"
                                            : to_literal(*f.handle.type, f.bytes.data()));
  return out;
}

void Engine::prepare_transfer(const Transfer& t) {
  std::size_t bytes = 0;
  for (const Transfer::PlaceMove& m : t.places) bytes += m.size;
  state_->given_back.resize(state_->given_back.size() + bytes);  // behind what was restored
  state_->given_back_places.reserve(state_->given_back_places.size() + t.places.size());
}

void Engine::take_over(const Engine& before, const Transfer& t) noexcept {
  State& s = *state_;
  const std::uint8_t* from = before.state_->memory.data();
  for (const Transfer::Move& m : t.moves) std::memcpy(s.memory.data() + m.to, from + m.from, m.size);
  std::size_t bytes = 0;
  for (const Transfer::PlaceMove& m : t.places) bytes += m.size;
  auto at = static_cast<std::uint32_t>(s.given_back.size() - bytes);
  for (const Transfer::PlaceMove& m : t.places) {
    std::memcpy(s.given_back.data() + at, from + m.from, m.size);
    s.given_back_places.push_back({at, image_->places[m.place].address, m.size});  // reserved
    at += m.size;
  }
  if (!t.running) return;
  for (const auto& [old, now] : t.tasks) s.tasks[now] = before.state_->tasks[old];
  s.first = false;
}

void Engine::measure(const image::Clock* clock) noexcept { state_->clock = clock; }
void Engine::watch(ScanWatch* watch) noexcept {
  state_->watch = watch != nullptr ? watch : &state_->own_watch;
}
void Engine::profile(Times* blocks) noexcept { state_->blocks = blocks; }
std::span<const Times> Engine::task_times() const noexcept { return state_->task_times; }

std::size_t Engine::retain_bytes() const noexcept { return image_->retain_bytes; }

bool Engine::snapshot_retained(std::span<std::uint8_t> out) const noexcept {
  if (out.size() < image_->retain_bytes) return false;
  for (const State::Copy& c : state_->retained)
    std::memcpy(out.data() + c.to, state_->memory.data() + c.from, c.size);
  return true;
}

std::vector<Retained> Engine::retained(std::span<const std::uint8_t> snapshot) const {
  std::vector<Retained> out;
  if (snapshot.size() < image_->retain_bytes) return out;
  for (const Image::RetainedCell& c : image_->retained)
    out.push_back({c.name, c.type->name, to_literal(*c.type, snapshot.data() + c.offset)});
  return out;
}

std::vector<Retained> Engine::retained() const {
  std::vector<std::uint8_t> snapshot(image_->retain_bytes);
  snapshot_retained(snapshot);
  return retained(snapshot);
}

std::size_t Engine::restore(std::span<const Retained> values) {
  std::size_t taken = 0;
  for (const Retained& v : values)
    for (const Image::RetainedCell& c : image_->retained) {
      if (!same_name(c.name, v.name) || c.type->name != v.type) continue;
      std::vector<std::uint8_t> bytes(c.type->size);
      if (!parse_value(*c.type, v.value, bytes.data())) break;
      std::memcpy(state_->memory.data() + c.address, bytes.data(), bytes.size());
      if (c.place >= 0) {
        const auto at = static_cast<std::uint32_t>(state_->given_back.size());
        state_->given_back.insert(state_->given_back.end(), bytes.begin(), bytes.end());
        state_->given_back_places.push_back({at, c.address, c.type->size});
      }
      ++taken;
      break;
    }
  return taken;
}

}  // namespace servogate::plc
