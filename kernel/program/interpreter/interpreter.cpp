// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/interpreter/interpreter.hpp"

#include <iterator>
#include <utility>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/interpreter/findings.hpp"
#include "kernel/program/languages/languages.hpp"

namespace servogate::program {
namespace {

/// A program of no block in place of one whose language this build does not read.
const Dialect& dialect_or_first(const Dialect* dialect) {
  return dialect != nullptr ? *dialect : *all_dialects().front();
}

}  // namespace

struct Interpreter::Impl {
  bool known;
  std::string dialect;
  Execution run;
  std::vector<Command> first = {};  ///< before those of the program, the last one foremost
  std::optional<text::Finding> refused = {};
  Position position{};  ///< as told last
};

Interpreter::Interpreter(std::string_view dialect, MachineModel machine, Tables tables, std::string file_name,
                         ProgramText text, ProgramLoader loader, const Position& start, int process) {
  const Dialect* found = find_dialect(dialect);
  impl_ = std::make_unique<Impl>(
      Impl{found != nullptr, std::string(dialect),
           Execution(dialect_or_first(found), std::move(machine), std::move(tables), std::move(file_name),
                     std::move(text), std::move(loader), start, process)});
}
Interpreter::Interpreter(const Interpreter& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
Interpreter& Interpreter::operator=(const Interpreter& other) {
  if (this != &other) impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}
Interpreter::Interpreter(Interpreter&&) noexcept = default;
Interpreter& Interpreter::operator=(Interpreter&&) noexcept = default;
Interpreter::~Interpreter() = default;

Step Interpreter::next(const image::Packets& packets, bool synchronised) {
  if (!impl_->known)
    return Error{
        {text::Severity::error, files().front(), 1, 1, &entry(Fault::dialect_unknown), {impl_->dialect}}};
  if (impl_->refused) return Error{*impl_->refused};
  if (impl_->first.empty()) return impl_->run.next(packets, synchronised);
  Command command = std::move(impl_->first.back());
  impl_->first.pop_back();
  return command;
}

bool Interpreter::pass_over_error() { return impl_->known && impl_->run.pass_over_error(); }

std::vector<text::Finding> Interpreter::findings() const {
  if (!impl_->known) return {};
  return find_all(impl_->run);
}

std::vector<SettingFault> Interpreter::setting_faults() const {
  return impl_->known ? impl_->run.setting_faults() : std::vector<SettingFault>{};
}
const std::vector<text::Finding>& Interpreter::warnings() const { return impl_->run.warnings(); }
const MachineModel& Interpreter::machine() const { return impl_->run.machine(); }
const std::vector<std::string>& Interpreter::files() const { return impl_->run.flow().names(); }
const std::string& Interpreter::path(int file) const { return impl_->run.flow().path(file); }
int Interpreter::column(int file, int line, int axis) const {
  return impl_->run.flow().column_at(file, line, axis);
}
const Position& Interpreter::position() const {
  impl_->position = impl_->run.contour().position(impl_->run.state().frames.machine);
  return impl_->position;
}
const Tables& Interpreter::tables() const { return *impl_->run.state().frames.tables; }
int Interpreter::block_count() const { return impl_->run.flow().main_source().blocks(); }
long long Interpreter::executed() const { return impl_->run.state().executed; }
bool Interpreter::machine_read() const { return impl_->run.machine_read(); }
void Interpreter::look_at(const Position& to_go) { impl_->run.look_at(to_go); }
void Interpreter::probed(const Position& at) { impl_->run.probed(at); }
void Interpreter::mdi(std::string_view block) { impl_->run.mdi(block); }
void Interpreter::reposition(const Position& at) { impl_->run.reposition(at); }
void Interpreter::adopt(Tables tables) { impl_->run.frames().adopt(std::move(tables)); }
void Interpreter::preset(int axis, double value) { impl_->run.frames().preset(axis, value); }
void Interpreter::set_switches(const OperatorSwitches& switches) {
  State& state = impl_->run.state();
  state.skip_levels |= switches.skip_levels;
  state.motion.dry_run = state.motion.dry_run || switches.dry_run;
}
void Interpreter::set_spindle_axis(bool on) { impl_->run.set_spindle_axis(on); }
int Interpreter::origin(int axis) const {
  return impl_->run.state().frames.origin[static_cast<std::size_t>(axis)];
}

double Interpreter::tool_length(int axis) const { return frame().length(axis); }

const Frame& Interpreter::frame() const { return impl_->run.state().frames.frame; }

bool Interpreter::feed_per_revolution() const {
  return impl_->run.state().modes.feed == Function::feed_revolution;
}

bool Interpreter::cutting_speed() const {
  return impl_->run.state().modes.spindle == Function::surface_speed;
}

int Interpreter::depth_axis() const { return impl_->run.state().frames.normal; }

void Interpreter::begin_with(std::vector<Command> commands, std::optional<text::Finding> refused) {
  impl_->first.assign(std::make_move_iterator(commands.rbegin()), std::make_move_iterator(commands.rend()));
  impl_->refused = std::move(refused);
}

int Interpreter::corrector() const { return impl_->run.state().frames.corrector; }

}  // namespace servogate::program
