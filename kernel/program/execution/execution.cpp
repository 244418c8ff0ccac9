// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/execution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servogate::program {
namespace {

/// Blocks without a command after which a program counts as endless.
constexpr long long kEndless = 1'000'000;
/// Blocks of pure polling after which a fresh snapshot is asked for.
constexpr long long kPolling = 1'000;
/// Blocks without a command after which a call comes back, so that nobody waits long for a program that
/// calculates.
constexpr int kPatience = 20'000;

std::vector<std::string> letters_of(const MachineModel& machine) {
  std::vector<std::string> letters;
  for (const auto& axis : machine.axes) letters.push_back(axis.letter);
  return letters;
}

double variable_of(const MachineModel& machine, const char* name, double otherwise) {
  const auto at = machine.variables.find(name);
  return at == machine.variables.end() ? otherwise : at->second;
}

int parameters_of(const ParameterSet& set, const MachineModel& machine) {
  if (set.count_max == 0) return set.count;
  const std::string name(set.letter);
  return static_cast<int>(
      std::clamp<double>(variable_of(machine, name.c_str(), set.count), set.count_min, set.count_max));
}

}  // namespace

Execution::Execution(const Dialect& dialect, MachineModel machine, Tables tables, std::string file_name,
                     std::string text, ProgramLoader loader, const Position& start, int process)
    : dialect_(&dialect), axes_(letters_of(machine)), loader_(std::move(loader)), process_(process) {
  if (machine.axes.size() > image::kMaxAxes) machine.axes.resize(image::kMaxAxes);
  machine_ = std::make_shared<const MachineModel>(std::move(machine));
  sources_.push_back(std::make_shared<const Source>(dialect, file_name, std::move(text)));
  files_.push_back(std::move(file_name));
  resolution_ = variable_of(*machine_, "RESOLUTION", 0.0001);
  resolution_ = resolution_ > 0.0 ? std::round(1.0 / resolution_) : 0.0;
  state_.parameters = Parameters(dialect.parameters, parameters_of(dialect.parameters, *machine_));
  state_.tables = std::make_shared<const Tables>(std::move(tables));
  state_.machine = start;
  state_.frame = Frame(axis_count());
  learn_machine();
  begin_flow();
  reset();
  apply_power_on();
}

void Execution::reset() {
  for (int a = 0; a < axis_count(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    state_.frame.set_scale(a, 1.0);
    state_.frame.set_mirrored(a, false);
    state_.frame.set_offset(a, 0.0);
    state_.origin[i] = 0;
    state_.field_min[i] = -1e300;
    state_.field_max[i] = 1e300;
    const auto zero = state_.tables->origins.find(0);
    double origin = 0.0;
    if (zero != state_.tables->origins.end())
      if (const auto at = zero->second.find(machine_->axes[i].letter); at != zero->second.end())
        origin = at->second;
    state_.frame.set_origin(a, origin);
  }
  state_.frame.set_rotation(0.0);
  state_.modes.corner = dialect_->corner;
  select_plane(dialect_->plane, false);
  state_.profile_open = false;
  state_.cycle = Cycle{};
  BlockWords none;
  for (const GRule& rule : dialect_->g)
    if (rule.at_power_on) take_g(none, rule);
  frame_changed();
}

void Execution::reposition(const Position& at) {
  state_.machine = at;
  state_.profile_open = false;
  frame_changed();
}

void Execution::adopt(Tables tables) {
  const auto entry = [](const Tables& in, int number, const std::string& letter) {
    const auto row = in.origins.find(number);
    if (row == in.origins.end()) return 0.0;
    const auto at = row->second.find(letter);
    return at == row->second.end() ? 0.0 : at->second;
  };
  for (int a = 0; a < axis_count(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    const std::string& letter = machine_->axes[i].letter;
    const int number = state_.origin[i];
    const double moved = entry(tables, number, letter) - entry(*state_.tables, number, letter);
    state_.frame.set_origin(a, state_.frame.origin(a) + moved);
  }
  state_.tables = std::make_shared<const Tables>(std::move(tables));
  frame_changed();
}

void Execution::preset(int axis, double value) {
  const auto i = static_cast<std::size_t>(axis);
  Position wanted = state_.programmed;
  wanted[i] = value;
  const double moved = state_.machine[i] - state_.frame.to_machine(wanted, axis);
  Tables tables = *state_.tables;
  tables.origins[state_.origin[i]][machine_->axes[i].letter] += moved;
  adopt(std::move(tables));
}

void Execution::frame_changed() {
  for (int a = 0; a < axis_count(); ++a)
    state_.programmed[static_cast<std::size_t>(a)] = state_.frame.to_programmed(state_.machine, a);
}

void Execution::set_plane(int axis1, int axis2, int normal) {
  state_.modes.axis1 = axis1;
  state_.modes.axis2 = axis2;
  state_.modes.normal = normal;
  state_.frame.set_plane(axis1, axis2);
  if (state_.frame.rotation() != 0.0) frame_changed();
}

// --- values ---

double Execution::parameter(int index, int column) const { return state_.parameters.get(index, column); }

double Execution::place(const image::Place& place, int column) const {
  snapshot_used_ = machine_read_ = true;
  return view_.number(place, column);
}

double Execution::evaluate(std::size_t& pos) const {
  return program::evaluate(dialect_->expressions, block_.line.substr(0, block_.end), pos, this);
}

double Execution::resolve(const Value& value) const {
  if (value.parameter < 0) return value.number;
  const double number = state_.parameters.get(value.parameter, value.column);
  return value.negative ? -number : number;
}

int Execution::whole(const Value& value, std::string_view word) const {
  const double number = resolve(value);
  if (!(number >= 0.0 && number <= 1e9) || number != std::floor(number))
    fail(Fault::whole_number, value.column, {std::string(word), text::number(number)});
  return static_cast<int>(number);
}

double Execution::unit_factor(int axis) const noexcept {
  return state_.modes.unit == Function::inch && !rotary(axis) ? 25.4 : 1.0;
}

void Execution::refuse_range(std::string_view word, const Value& value, double number, const char* least,
                             const char* most) const {
  std::string named(word);
  if (value.parameter >= 0)
    named += (value.negative ? " = -" : " = ") + dialect_->parameters.name_of(value.parameter) + " = ";
  fail(Fault::out_of_range, value.column, {std::move(named), text::number(number), least, most});
}

double Execution::length(int axis, const Value& value, bool halve) const {
  double number = resolve(value);
  const MachineModel::Axis& a = machine_->axes[static_cast<std::size_t>(axis)];
  if (!(std::abs(number) <= 99999.9999)) refuse_range(a.letter, value, number, "-99999.9999", "99999.9999");
  const double steps = a.rotary ? resolution_ * 10.0 : resolution_;
  if (steps != 0.0) number = std::nearbyint(number * steps) / steps;
  number *= unit_factor(axis);
  return halve && a.diameter && state_.modes.across == Function::diameter ? number / 2.0 : number;
}

// --- packets ---

namespace {

void check_owner(const MachineModel& machine, const image::Place& place, int column) {
  for (const auto& guarded : machine.protected_places)
    if (guarded.place.overlaps(place))
      fail(Fault::place_protected, column, {image::to_string(place), guarded.owner});
}

}  // namespace

void Execution::write(const image::Place& place, double value, int column) {
  check_owner(*machine_, place, column);
  const double stored = view_.storable(place, value, column);
  const bool at_once =
      place.packet == image::Packet::v ? block_.sync != Sync::request : block_.sync == Sync::cancel;
  if (at_once || must_wait()) view_.remember(place, stored, {});
  if (!at_once) end_profile();
  emit(WritePlace{place, stored, {}, !at_once});
}

void Execution::write(const image::Place& place, std::string_view characters, int column) {
  check_owner(*machine_, place, column);
  view_.check_inside(place, column);
  if (characters.size() > place.length)
    fail(Fault::text_too_long, column,
         {std::to_string(characters.size()), image::to_string(place), std::to_string(place.length)});
  const bool at_once =
      place.packet == image::Packet::v ? block_.sync != Sync::request : block_.sync == Sync::cancel;
  std::string padded(characters);
  padded.resize(place.length, ' ');
  if (at_once || must_wait()) view_.remember(place, 0.0, padded);
  if (!at_once) end_profile();
  emit(WritePlace{place, 0.0, std::move(padded), !at_once});
}

// --- the run ---

Step Execution::take() {
  Step step(std::in_place_type<Command>, std::move(queue_[head_++]));
  if (head_ == queue_.size()) {
    queue_.clear();
    head_ = 0;
  }
  return step;
}

Step Execution::next(const image::Packets& packets, bool synchronised) {
  if (head_ < queue_.size()) return take();
  if (last_) return *last_;
  view_.look_at(packets, synchronised);
  snapshot_used_ = want_fresh_ = false;
  try {
    if (power_on_error_) throw ProgramError(*power_on_error_);
    if (state_.flow.line == Source::kNone)
      fail(Fault::start_missing, 1, {std::string(1, dialect_->lexis.tape)});
    if (auto step = advance(synchronised)) return std::move(*step);
  } catch (const ProgramError& error) {
    return stop_with(error);
  }
  since_command_ = 0;
  return take();
}

Step Execution::stop_with(const ProgramError& error) {
  queue_.clear();
  head_ = 0;
  last_ = Error{finding(error)};
  if (mdi_) {
    State restored = before_mdi_;
    std::swap(state_, restored);
  }
  return *last_;
}

bool Execution::pass_over_error() {
  const bool endless = since_command_ > kEndless;
  if (!last_ || !std::holds_alternative<Error>(*last_) || power_on_error_ || mdi_ || endless) return false;
  if (state_.flow.line == Source::kNone) return false;
  last_.reset();
  if (state_.flow.line == line_ && line_ < source().lines()) ++state_.flow.line;
  return true;
}

text::Finding Execution::finding(const ProgramError& error) const {
  text::Finding f;
  f.file = path(state_.flow.file);
  f.line = power_on_error_ ? 1 : line_number();
  f.column = error.column > 0 ? error.column : power_on_error_ ? 1 : column_of(-1);
  f.entry = dialect_->own(error.entry);
  f.arguments = error.arguments;
  return f;
}

int Execution::column_at(int file, int line, int axis) const {
  Block block;
  const Source& source = *sources_[static_cast<std::size_t>(file)];
  if (line < 1 || static_cast<std::uint32_t>(line) > source.lines()) return 1;
  try {
    read_block(*dialect_, axes_, source.line(static_cast<std::uint32_t>(line) - 1), block);
  } catch (const ProgramError& error) {
    return error.column;
  }
  return program::column_of(block, axis);
}

/// Executes blocks until one has given a command; a value instead when something else has to come first.
std::optional<Step> Execution::advance(bool synchronised) {
  for (int blocks = 0; queue_.empty(); ++blocks) {
    if (blocks == kPatience) return NeedsSync{line_number()};
    if (want_fresh_ || (snapshot_used_ && since_command_ > kPolling)) {
      if (snapshot_used_) since_command_ = 0;
      return NeedsSync{line_number()};
    }
    if (leave_part_or_file()) continue;
    if (state_.flow.line >= source().lines()) {
      finish(false);
      continue;
    }
    line_ = state_.flow.line;
    if (auto step = read_ahead(synchronised)) return step;
  }
  return std::nullopt;
}

/// One block. A value when it has to wait for the end of motion.
std::optional<Step> Execution::read_ahead(bool synchronised) {
  read_block(*dialect_, axes_, source().line(line_), block_);
  const bool left_out = block_.skip && (state_.skip_levels >> block_.skip_level & 1u) != 0;
  if (block_.kind == BlockKind::empty || left_out) {
    ++state_.flow.line;
    return std::nullopt;
  }
  if (!synchronised && (state_.flow.barrier || view_.full() || must_wait())) return NeedsSync{line_number()};
  if (must_wait()) end_profile();
  state_.flow.barrier = false;
  ++state_.flow.line;
  ++state_.executed;
  if (++since_command_ > kEndless) fail(Fault::endless, 0, {std::to_string(kEndless)});
  execute();
  return std::nullopt;
}

/// True when the block is to be read only after the motion before it has ended.
bool Execution::must_wait() const {
  if (block_.sync != Sync::standard) return block_.sync == Sync::request;
  return block_.kind == BlockKind::own_form && dialect_->own_form_waits != nullptr &&
         dialect_->own_form_waits(block_);
}

void Execution::execute() {
  if (block_.kind == BlockKind::words) return run_words();
  if (block_.kind == BlockKind::own_form) dialect_->own_form(*this);
}

void Execution::finish(bool rewind) {
  emit(End{rewind});
  last_ = Step(queue_.back());
  if (!rewind) return;
  reset();
  apply_power_on();
}

void Execution::mdi(std::string_view block) {
  mdi_ = false;
  queue_.clear();
  head_ = 0;
  last_.reset();
  before_mdi_ = state_;
  mdi_ = true;
  warnings_.clear();
  standing_told_ = false;
  state_.feed_at.told = state_.speed_at.told = false;
  state_.flow = Flow{};
  const auto at = std::find(files_.begin() + 1, files_.end(), "MDI");
  state_.flow.file = static_cast<int>(at - files_.begin());
  if (at == files_.end()) {
    files_.emplace_back("MDI");
    sources_.emplace_back();
  }
  sources_[static_cast<std::size_t>(state_.flow.file)] =
      std::make_shared<const Source>(*dialect_, "MDI", std::string(block));
}

}  // namespace servogate::program
