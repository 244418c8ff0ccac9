// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/execution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/program/execution/own_codes.hpp"

namespace servogate::program {
namespace {

/// Blocks without a command after which a program counts as endless.
constexpr long long kEndless = 1'000'000;
/// Blocks of pure polling after which a fresh snapshot is asked for.
constexpr long long kPolling = 1'000;
/// Blocks without a command after which a call comes back, so that nobody waits long for a program that
/// calculates.
constexpr int kPatience = 20'000;

int parameters_of(const ParameterSet& set, const MachineModel& machine) {
  if (set.count_max == 0) return set.count;
  const std::string name(set.letter);
  return static_cast<int>(
      std::clamp<double>(machine.variable(name.c_str(), set.count), set.count_min, set.count_max));
}

std::vector<std::string> letters_of(const MachineModel& machine) {
  std::vector<std::string> letters;
  for (const auto& axis : machine.axes) letters.push_back(axis.letter);
  return letters;
}

/// What the language adds to the machine: virtual axes behind its own, and which axis counts positions.
MachineModel completed(const Dialect& language, MachineModel model) {
  if (model.axes.size() > image::kMaxAxes) model.axes.resize(image::kMaxAxes);
  for (MachineModel::Axis& axis : model.axes)
    if (!language.index_variable.empty() && axis.rotary)
      axis.index_positions =
          static_cast<int>(model.variable((std::string(language.index_variable) + axis.letter).c_str(), 0.0));
  const AxisLetters letters(letters_of(model));
  for (const char letter : language.virtual_axes) {
    if (letters.find(letter) >= 0 || model.axes.size() == image::kMaxAxes) continue;
    MachineModel::Axis axis;
    axis.letter = letter;
    axis.is_virtual = true;
    model.axes.push_back(axis);
  }
  return model;
}

const Dialect& first_language(const Dialect& language, const MachineModel& machine) {
  return language.begins == nullptr ? language : language.begins(machine);
}

}  // namespace

ExecutionData::ExecutionData(const Dialect& language_, MachineModel model, Tables tables,
                             std::string file_name, ProgramText text, ProgramLoader loader,
                             const Position& start, int process_)
    : machine(std::make_shared<const MachineModel>(completed(language_, std::move(model)))),
      extended(with_own_codes(first_language(language_, *machine), *machine)),
      dialect(extended ? extended.get() : &first_language(language_, *machine)),
      axes(letters_of(*machine)),
      language(&first_language(language_, *machine)),
      process(process_) {
  files.loader = std::move(loader);
  files.language = language;
  files.sources.push_back(std::make_shared<const Source>(*language, file_name, std::move(text)));
  files.names.push_back(std::move(file_name));
  state.parameters = Parameters(dialect->parameters, parameters_of(dialect->parameters, *machine));
  state.frames.tables = std::make_shared<const Tables>(std::move(tables));
  state.frames.machine = start;
  state.frames.frame = Frame(machine->axis_count());
  state.virtual_axes = no_virtual_axes(*machine);
  state.flow.line = files.sources.front()->start();
}

Execution::Execution(const Dialect& dialect, MachineModel machine, Tables tables, std::string file_name,
                     ProgramText text, ProgramLoader loader, const Position& start, int process)
    : data_(dialect, std::move(machine), std::move(tables), std::move(file_name), std::move(text),
            std::move(loader), start, process) {
  set_spindle_axis(false);
  reset();
  apply_power_on();
}

/// Origin, mirror, rotation, scale, field and modes as after power-on; tool lengths and parameters stay.
void Execution::reset() {
  state_.motion.arc_feed = machine_.arc_feed;
  frames_.reset();
  state_.modes.corner = dialect_.corner;
  motion_.end_profile();
  contour_.settle();
  state_.profile = ProfileState{};
  state_.spline = SplineState{};
  state_.motion.cycle = Cycle{};
  end_virtual_axes(machine_, state_.virtual_axes, state_.frames.machine);
  BlockWords none;
  const bool arranges = dialect_.arrange != nullptr;
  if (arranges) state_.own = {};
  for (const GRule& rule : dialect_.g) {
    if (!rule.at_power_on) continue;
    take_g(none, rule);
    if (arranges && rule.take != nullptr) rule.take(*this, none, Word{});
  }
  frames_.changed();
}

/// What a program has to begin ends with it, and where somebody else moves the axes.
void Execution::end_contour_modes() {
  state_.profile = ProfileState{};
  state_.spline = SplineState{};
  state_.modes.compensation = Function::compensation_off;
  state_.modes.profile = Function::profile_off;
  if (state_.modes.motion == Function::spline) state_.modes.motion = Function::rapid;
  end_virtual_axes(machine_, state_.virtual_axes, state_.frames.machine);
}

void Execution::reposition(const Position& at) {
  contour_.drop();
  end_contour_modes();
  frames_.reposition(at);
  motion_.end_profile();
}

/// An axis that is not there, or that follows others.
void Execution::refuse_barred(int axis, int column) const {
  if ((state_.virtual_axes.barred >> axis & 1u) == 0) return;
  fail(machine_.is_virtual(axis) ? Fault::axis_missing : Fault::axis_follows, column,
       {machine_.axes[static_cast<std::size_t>(axis)].letter});
}

// --- values ---

double Execution::parameter(int index, int column) const { return state_.parameters.get(index, column); }

double Execution::place(const image::Place& place, int column) const {
  data_.snapshot_used = data_.machine_read = true;
  return data_.view.number(place, column);
}

double Execution::evaluate(std::size_t& pos) const {
  return program::evaluate(dialect_.expressions, block_.line.substr(0, block_.end), pos, this);
}

// --- packets ---

namespace {

void check_owner(const MachineModel& machine, const image::Place& place, int column) {
  for (const auto& guarded : machine.protected_places)
    if (guarded.place.overlaps(place))
      fail(Fault::place_protected, column, {image::to_string(place), guarded.owner});
}

}  // namespace

bool Execution::takes_effect_at_once(const image::Place& place) const {
  return place.packet == image::Packet::v ? block_.sync != Sync::request : block_.sync == Sync::cancel;
}

/// A curve is given as a whole: nothing has a place between its points.
void Execution::refuse_in_spline(int column) const {
  if (state_.spline.phase == SplineState::Phase::points) fail(Fault::contour_waits, column);
}

void Execution::write(const image::Place& place, double value, int column) {
  check_owner(machine_, place, column);
  const double stored = data_.view.storable(place, value, column);
  const bool at_once = takes_effect_at_once(place);
  if (at_once || must_wait()) data_.view.remember(place, stored, {});
  if (!at_once) refuse_in_spline(column);
  if (!at_once) motion_.end_profile();
  emit(WritePlace{place, stored, {}, !at_once});
}

void Execution::write(const image::Place& place, std::string_view characters, int column) {
  check_owner(machine_, place, column);
  data_.view.check_inside(place, column);
  if (characters.size() > place.length)
    fail(Fault::text_too_long, column,
         {std::to_string(characters.size()), image::to_string(place), std::to_string(place.length)});
  const bool at_once = takes_effect_at_once(place);
  std::string padded(characters);
  padded.resize(place.length, ' ');
  if (at_once || must_wait()) data_.view.remember(place, 0.0, padded);
  if (!at_once) refuse_in_spline(column);
  if (!at_once) motion_.end_profile();
  emit(WritePlace{place, 0.0, std::move(padded), !at_once});
}

// --- the run ---

Step Execution::next(const image::Packets& packets, bool synchronised) {
  if (!data_.queue.empty()) return data_.queue.take();
  if (data_.last) return *data_.last;
  data_.view.look_at(packets, synchronised);
  data_.snapshot_used = data_.want_fresh = false;
  try {
    if (data_.power_on_error) throw ProgramError(*data_.power_on_error);
    if (state_.flow.line == Source::kNone)
      fail(Fault::start_missing, 1, {std::string(1, dialect_.lexis.tape)});
    if (auto step = advance(synchronised)) return std::move(*step);
  } catch (const ProgramError& error) {
    return stop_with(error);
  }
  data_.since_command = 0;
  return data_.queue.take();
}

void Execution::probed(const Position& at) {
  ProbingState& probing = state_.probing;
  if (probing.take == nullptr) return;
  probing.touches.push_back(at);
  if (probing.touches.size() < probing.expected) return;
  void (*const take)(Execution&) = probing.take;
  try {
    take(*this);
  } catch (const ProgramError& error) {
    stop_with(error);
  }
  state_.probing = {};
}

Step Execution::stop_with(const ProgramError& error) {
  data_.queue.clear();
  data_.last = Error{finding(error)};
  state_.profile = ProfileState{};
  state_.spline = SplineState{};
  if (state_.contour.held || data_.contour_before)
    contour_.rescue(data_.contour_before ? ContourState(*data_.contour_before) : state_.contour);
  data_.contour_before.reset();
  data_.queue.clear();
  if (data_.before_mdi) state_ = *data_.before_mdi;
  return *data_.last;
}

bool Execution::pass_over_error() {
  const bool endless = data_.since_command > kEndless;
  if (!data_.last || !std::holds_alternative<Error>(*data_.last) || data_.power_on_error ||
      data_.before_mdi || endless)
    return false;
  if (state_.flow.line == Source::kNone) return false;
  data_.last.reset();
  if (state_.flow.line == data_.line && data_.line < flow_.source().lines()) ++state_.flow.line;
  return true;
}

text::Finding Execution::finding(const ProgramError& error) const {
  text::Finding f;
  f.file = flow_.path(state_.flow.file);
  f.line = data_.power_on_error ? 1 : error.line > 0 ? error.line : flow_.line_number();
  f.column = error.column > 0 ? error.column : data_.power_on_error ? 1 : column_of(block_, -1);
  f.entry = dialect_.own(error.entry);
  f.arguments = error.arguments;
  return f;
}

/// Executes blocks until one has given a command; a value instead when something else has to come first.
std::optional<Step> Execution::advance(bool synchronised) {
  for (int blocks = 0; data_.queue.empty(); ++blocks) {
    if (blocks == kPatience) return NeedsSync{flow_.line_number()};
    if (data_.want_fresh || (data_.snapshot_used && data_.since_command > kPolling)) {
      if (data_.snapshot_used) data_.since_command = 0;
      return NeedsSync{flow_.line_number()};
    }
    if (flow_.leave_part_or_file()) continue;
    if (state_.flow.line >= flow_.source().lines()) {
      finish(false);
      continue;
    }
    data_.line = state_.flow.line;
    if (auto step = read_ahead(synchronised)) return step;
  }
  return std::nullopt;
}

/// One block. A value when it has to wait for the end of motion.
std::optional<Step> Execution::read_ahead(bool synchronised) {
  if (data_.contour_before) data_.contour_before.reset();
  if (dialect_.speaks != nullptr) follow_language();
  block_.levels_left_out = state_.skip_levels;
  read_block(dialect_, data_.axes, flow_.source().line(data_.line), block_);
  const bool left_out = block_.skip && (state_.skip_levels >> block_.skip_level & 1u) != 0;
  if (block_.kind == BlockKind::empty || left_out) {
    ++state_.flow.line;
    return std::nullopt;
  }
  if (!synchronised && (state_.flow.barrier || data_.view.full() || must_wait()))
    return NeedsSync{flow_.line_number()};
  if (must_wait()) {
    if (state_.contour.held || state_.profile.open || state_.spline.phase == SplineState::Phase::points)
      fail(Fault::contour_waits, static_cast<int>(block_.body) + 1);
    motion_.end_profile();
  }
  state_.flow.barrier = false;
  ++state_.flow.line;
  ++state_.executed;
  if (++data_.since_command > kEndless) fail(Fault::endless, 0, {std::to_string(kEndless)});
  if (contour_.engaged()) data_.contour_before = state_.contour;
  execute();
  if (state_.virtual_axes.kind != VirtualAxes::Kind::none)
    Followers(machine_, frames_, state_.frames, state_.virtual_axes, flow_.line_number(),
              static_cast<int>(block_.body) + 1)
        .lead(data_.queue.commands);
  return std::nullopt;
}

/// True when the block is to be read only after the motion before it has ended.
bool Execution::must_wait() const {
  if (block_.sync != Sync::standard) return block_.sync == Sync::request;
  return block_.kind == BlockKind::own_form && dialect_.own_form_waits != nullptr &&
         dialect_.own_form_waits(block_);
}

void Execution::execute() {
  state_.flow.went_back = false;
  if (block_.kind == BlockKind::words)
    run_words();
  else if (block_.kind == BlockKind::own_form)
    dialect_.own_form(*this);
  if (state_.flow.went_back && data_.snapshot_used) data_.want_fresh = true;
}

void Execution::finish(bool rewind) {
  if (state_.profile.open || state_.spline.phase != SplineState::Phase::none) fail(Fault::contour_open, 0);
  contour_.settle();
  end_contour_modes();
  emit(End{rewind});
  set_spindle_axis(false);
  data_.last = Step(data_.queue.commands.back());
  if (!rewind) return;
  reset();
  apply_power_on();
}

void Execution::mdi(std::string_view block) {
  data_.queue.clear();
  data_.last.reset();
  data_.before_mdi = state_;
  data_.warnings = {};
  state_.motion.feed_at.told = state_.motion.speed_at.told = false;
  flow_.enter_text("MDI", block);
}

}  // namespace servogate::program
