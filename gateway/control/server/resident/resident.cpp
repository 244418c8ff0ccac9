// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/resident/resident.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "gateway/control/history/request_words.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

namespace {

constexpr int kAnswerPatience_ms = 2000;
constexpr int kBlockPatience = 10'000;  ///< commands of a typed block that are looked at before it runs

int lines_of(std::string_view text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n')) +
         (text.empty() || text.back() == '\n' ? 0 : 1);
}

}  // namespace

Resident::Resident(Control& control, machine::MachineState state, std::string state_path, double speed)
    : control_(control),
      state_(std::move(state)),
      state_path_(std::move(state_path)),
      speed_(speed),
      requests_(control.cycle()) {
  seats_.resize(static_cast<std::size_t>(control.machine().control.processes));
  for (int p = 0; p < processes(); ++p) {
    seat(p).file = no_program(p);
    arm(p, ProgramChange::Kind::program);
  }
}

std::shared_ptr<const ProgramFile> Resident::no_program(int process) const {
  auto none = std::make_shared<ProgramFile>();
  none->process = process;
  none->dialect = control_.machine().control.dialect;
  none->model = program_model(control_.machine(), process);
  none->loader = program_loader({});
  return none;
}

RequestDesk::Outcome Resident::ask(const image::Request& request, image::Answer& answer, const Asked& asked) {
  const RequestDesk::Outcome outcome = requests_.ask(request, answer, asked, kAnswerPatience_ms);
  if (outcome == RequestDesk::Outcome::answered) catch_up();
  return outcome;
}

/// Waits for the next whole image, which holds what the answered request did: whoever asks for the status
/// then must not be told of the time before.
void Resident::catch_up() {
  constexpr std::chrono::seconds kPatience{1};  // a cycle that answers goes on, however long it is
  const auto end = std::chrono::steady_clock::now() + kPatience;
  const std::int64_t before = image().now.number;
  while (image().now.number == before && (requests_.stepped() || std::chrono::steady_clock::now() < end))
    if (!requests_.pause()) return;
}

bool Resident::busy(int process) {
  const image::ProcessState state = image().processes[static_cast<std::size_t>(process)].state;
  return state == image::ProcessState::running || state == image::ProcessState::held ||
         state == image::ProcessState::waiting;
}

bool Resident::busy() {
  bool any = false;
  for (int p = 0; p < processes(); ++p) any = busy(p) || any;
  return any;
}

bool Resident::stopping(int process) const { return control_.process(process).stopping(); }

bool Resident::typed(int process) {
  return busy(process) && image_.processes[static_cast<std::size_t>(process)].typed;
}

bool Resident::rests(int process) {
  const image::ProcessState state = image().processes[static_cast<std::size_t>(process)].state;
  return state == image::ProcessState::held || state == image::ProcessState::waiting;
}

bool Resident::steps(int process) {
  return busy(process) && image_.processes[static_cast<std::size_t>(process)].mode == image::Mode::step;
}

/// False: a program is being read just now, nothing was changed.
bool Resident::arm(int process, ProgramChange::Kind kind) {
  Seat& s = seat(process);
  std::shared_ptr<const ProgramFile> file = s.file;
  if (!s.refused.empty()) {
    // Whoever starts, a start button too, must not find it.
    auto none = std::make_shared<ProgramFile>(*s.file);
    none->path.clear();
    none->text = {};
    file = std::move(none);
  }
  if (!control_.change({kind, process, std::move(file), state_.tables, {}})) return false;
  s.given = state_.tables;
  return true;
}

/// What was proven of a loaded program holds for its tables and axes only.
std::optional<Resident::Proof> Resident::renew(int process) {
  Proof proof{state_.tables, {}};
  for (int p = 0; p < processes(); ++p) {
    Seat& s = seat(p);
    const bool asked = process < 0 || p == process;
    if (!s.file->path.empty() && s.proven != state_.tables)
      proof.programs.push_back({p, s.file, start_of(p), {}});
    else if (asked || s.given != state_.tables)
      arm(p, ProgramChange::Kind::tables);
  }
  return proof.programs.empty() ? std::nullopt : std::optional(std::move(proof));
}

std::optional<Resident::Proof> Resident::renew_tables() { return renew(-1); }

std::optional<Resident::Proof> Resident::renew_axes() {
  for (Seat& s : seats_) s.proven.reset();
  return renew(-1);
}

void Resident::prove(Proof& proof, const std::stop_token& stop) const {
  for (Proof::Program& p : proof.programs) {
    ProgramCheck check = prove_program(control_.machine(), *p.file, proof.tables, p.start,
                                       channel::Forecast::Depth::drivable, stop);
    for (text::Finding& f : check.report.findings)
      if (f.severity == text::Severity::error) p.errors.push_back(std::move(f));
  }
}

void Resident::proven(const Proof& proof) {
  for (const Proof::Program& p : proof.programs) {
    Seat& s = seat(p.process);
    if (p.file != s.file || p.start.axes != start_of(p.process).axes) continue;  // changed meanwhile
    s.proven = proof.tables;
    s.refused = p.errors;
    if (state_.tables == proof.tables) arm(p.process, ProgramChange::Kind::tables);
  }
}

Resident::Load Resident::begin_load(int process, std::string path, std::string dialect) {
  Load load;
  load.process = load.file->process = process;
  load.path = std::move(path);
  load.dialect = std::move(dialect);
  load.tables = state_.tables;
  load.start = start_of(process);
  return load;
}

void Resident::read_and_prove(Load& load, const std::stop_token& stop) const {
  load.opened = open_program(control_.machine(), load.path, load.dialect, *load.file, load.findings);
  if (!load.opened) return;
  ProgramCheck check = prove_program(control_.machine(), *load.file, load.tables, load.start,
                                     channel::Forecast::Depth::drivable, stop);
  load.findings.insert(load.findings.end(), check.report.findings.begin(), check.report.findings.end());
  load.blocks = check.report.blocks;
  load.lines = lines_of(load.file->text.view());
}

Resident::Load::End Resident::finish(Load& load) {
  if (!load.opened) return Load::End::not_opened;
  read_tables();
  if (!(state_.tables == load.tables) || load.start.axes != start_of(load.process).axes)
    return Load::End::other_tables;
  for (const text::Finding& f : load.findings)
    if (f.severity == text::Severity::error) return Load::End::has_errors;
  Seat& s = seat(load.process);
  const Seat before = s;
  s.file = load.file;
  s.refused.clear();
  s.proven = state_.tables;
  if (arm(load.process, ProgramChange::Kind::program)) {
    s.blocks = load.blocks;
    s.lines = load.lines;
    if (journal_ != nullptr) journal_->loaded(load.process, s.file->path, s.file->dialect);
    return Load::End::done;
  }
  s = before;  // a program began meanwhile
  return Load::End::busy;
}

/// False: its program has not begun, or is still being read and is not to be looked at (`also_read`) yet.
bool Resident::read_tables_of(int process, bool also_read) {
  adopt_given(process);
  const auto lock = control_.stop_reading();
  const channel::Feeder& feeder = control_.process(process).feeder();
  const program::Tables* tables = feeder.tables();
  if (tables == nullptr || (feeder.reads() && !also_read)) return false;
  Seat& s = seat(process);
  program::carry_over(s.given, *tables, state_.tables);
  s.given = *tables;
  return true;
}

/// What the tools have cut since it was counted last.
void Resident::count_cutting() {
  for (int p = 0; p < processes(); ++p)
    for (const auto& [row, seconds] : control_.process(p).cutting().read()) {
      double& counted = seat(p).cut_s[row];
      const double more = seconds - std::exchange(counted, seconds);
      if (const auto tool = state_.tables.correctors.find(row); tool != state_.tables.correctors.end())
        tool->second.used_min += more / 60.0;
    }
}

void Resident::read_tables() {
  count_cutting();
  for (int p = 0; p < processes(); ++p) read_tables_of(p, false);
}

std::optional<Resident::Proof> Resident::take_tables(int process) {
  count_cutting();
  bool read = false;
  for (int p = 0; p < processes(); ++p) read = read_tables_of(p, false) || read;
  return read || seat(process).given != state_.tables ? renew(process) : std::nullopt;
}

/// Where its axes stand, and which they are.
Start Resident::start_of(int process) {
  Start start{position(), false, 0u};
  for (int a = 0; a < image_.axis_count; ++a)
    if (image_.axes[static_cast<std::size_t>(a)].process == process) *start.axes |= std::uint32_t{1} << a;
  if (image_.axis_count == 0) start.axes.reset();  // no cycle yet: as the machine file has them
  return start;
}

program::Position Resident::position() {
  const image::ProcessImage& now = image();
  program::Position at{};
  for (int a = 0; a < now.axis_count; ++a) {
    const auto i = static_cast<std::size_t>(a);
    at[i] = now.axes[i].command;
  }
  return at;
}

/// The first spindle of the process is its rotary axis.
bool Resident::spindle_is_axis(int process) const {
  const machine::SpindleConfig* spindle = control_.machine().spindle_of_process(process);
  if (spindle == nullptr) return false;
  return image_.spindles[static_cast<std::size_t>(spindle - control_.machine().spindles.data())].is_axis;
}

Resident::TriedBlock Resident::try_block(int process, const std::string& block) {
  const program::Position at = position();
  std::optional<program::Interpreter> trial;
  {
    const auto lock = control_.stop_reading();
    trial = control_.process(process).manual_interpreter(at);
  }
  trial->set_spindle_axis(spindle_is_axis(process));
  trial->mdi(block);
  TriedBlock tried;
  std::optional<text::Finding> failed;
  for (int n = 0; n < kBlockPatience; ++n) {
    const program::Step step = trial->next(image_.packets, true);
    if (const auto* error = std::get_if<program::Error>(&step)) failed = error->finding;
    const auto* command = std::get_if<program::Command>(&step);
    if (command == nullptr || std::holds_alternative<program::End>(command->what)) break;
    tried.commands.push_back(*command);
  }
  tried.findings = trial->warnings();
  if (failed) tried.findings.push_back(*failed);
  return tried;
}

/// An interpreter is made for it only when MDI may have changed.
Resident::Coordinates Resident::coordinates(int process) {
  Seat& s = seat(process);
  const bool runs = busy(process);
  const image::ProcessStatus status = image_.processes[static_cast<std::size_t>(process)];
  const std::uint64_t now =
      1 + (control_.process(process).changes() << 33 | std::uint64_t{status.run} << 1 | (runs ? 1u : 0u));
  if (now != s.read_at && !(runs && status.typed)) {
    const program::Position at = position();
    const auto lock = control_.stop_reading();
    const program::Interpreter manual = control_.process(process).manual_interpreter(at);
    s.manual.frame = manual.frame();
    s.manual.corrector = manual.corrector();
    for (std::size_t a = 0; a < control_.machine().program_axes(); ++a)
      s.manual.origin[a] = manual.origin(static_cast<int>(a));
    s.read_at = now;
  }
  Coordinates in_force = s.manual;
  if (!runs) return in_force;
  if (const auto frame = control_.process(process).texts().frame(status.run, status.blocks_done))
    in_force.frame = *frame;
  return in_force;
}

std::string Resident::line_of(int process, const std::string& file, int line) {
  Seat& s = seat(process);
  std::string_view text = s.file->text.view();
  if (file != s.file->path) {
    if (file != s.shown_file) {
      std::string ignored;
      s.shown_file = file;
      s.shown_text = files::read_file(file, files::kMostOfProgram, ignored).value_or(std::string());
    }
    text = s.shown_text;
  }
  std::size_t at = 0;
  for (int n = 1; n < line && at != std::string::npos; ++n) {
    at = text.find('\n', at);
    if (at != std::string::npos) ++at;
  }
  if (line < 1 || at == std::string::npos || at >= text.size()) return {};
  std::string block(text.substr(at, text.find('\n', at) - at));
  if (!block.empty() && block.back() == '\r') block.pop_back();
  return block;
}

void Resident::set_manual_block(int process, const std::string& block) {
  if (!block.empty()) seat(process).manual_block = block;
  control_.change({ProgramChange::Kind::block, process, {}, {}, block});
}

void Resident::set_touch(int process, const std::string& axis, const channel::TouchOrder& order) {
  seat(process).manual_block = "touch " + axis;
  control_.change({ProgramChange::Kind::touch, process, {}, {}, channel::to_text(order)});
}

void Resident::forget_modes() {
  for (int p = 0; p < processes(); ++p)
    if (!busy(p)) control_.change({ProgramChange::Kind::modes, p, {}, {}, {}});
}

/// The interpreter of MDI in which an axis reads `value` where it stands.
program::Interpreter Resident::reading(int axis, double value, double& length) {
  read_tables();
  const program::Position at = position();
  const int process = image_.axes[static_cast<std::size_t>(axis)].process;
  std::optional<program::Interpreter> manual;
  {
    const auto lock = control_.stop_reading();
    manual = control_.process(process).manual_interpreter(at);
  }
  manual->adopt(state_.tables);
  const auto entry = [&] {
    const auto& origins = manual->tables().origins;
    const auto row = origins.find(manual->origin(axis));
    if (row == origins.end()) return 0.0;
    const auto found = row->second.find(control_.machine().axes[static_cast<std::size_t>(axis)].letter);
    return found == row->second.end() ? 0.0 : found->second;
  };
  const double before = entry();
  manual->preset(axis,
                 control_.machine().axes[static_cast<std::size_t>(axis)].diameter ? value / 2.0 : value);
  length = manual->tool_length(axis) + entry() - before;
  return std::move(*manual);
}

Zeroed Resident::zero(int axis, double value) {
  double length = 0.0;
  const program::Interpreter manual = reading(axis, value, length);
  change_tables(manual.tables());
  const int origin = manual.origin(axis);
  return {origin,
          state_.tables.origins[origin][control_.machine().axes[static_cast<std::size_t>(axis)].letter]};
}

Resident::Touched Resident::touch(int axis, double value) {
  Touched touched;
  const program::Interpreter manual = reading(axis, value, touched.length);
  const std::string& letter = control_.machine().axes[static_cast<std::size_t>(axis)].letter;
  touched.origin = manual.tables().origins.at(manual.origin(axis)).at(letter);
  return touched;
}

const program::Tables& Resident::tables() {
  read_tables();
  return state_.tables;
}

void Resident::change_tables(program::Tables changed) {
  constexpr std::size_t kUndoSteps = 50;
  past_tables_.push_back(std::exchange(state_.tables, std::move(changed)));
  if (past_tables_.size() > kUndoSteps) past_tables_.erase(past_tables_.begin());
}

bool Resident::undo_tables() {
  if (past_tables_.empty()) return false;
  read_tables();
  state_.tables = std::move(past_tables_.back());
  past_tables_.pop_back();
  return true;
}

std::optional<machine::MachineState> Resident::to_save() {
  if (state_path_.empty()) return std::nullopt;
  count_cutting();
  for (int p = 0; p < processes(); ++p) read_tables_of(p, true);
  const image::ProcessImage& now = image();
  if (now.axis_count == 0) return std::nullopt;  // no cycle yet: nothing was learned
  cycle::References references;
  control_.cycle().read(references);
  for (std::size_t a = 0; a < control_.machine().axes.size(); ++a) {
    machine::HomingRecord& record = state_.homing[control_.machine().axes[a].letter];
    record.valid = now.axes[a].homed;
    record.offset_counts = references[a];
  }
  state_.tool_in_spindle = now.processes[static_cast<std::size_t>(control_.machine().tool_process())].tool;
  return state_;
}

std::string Resident::write(const std::optional<machine::MachineState>& state) const {
  std::string error;
  if (!state || machine::StateDirectory(state_path_).save_all(*state, error)) return {};
  return error;
}

std::uint32_t Resident::homed() {
  const image::ProcessImage& now = image();
  std::uint32_t bits = 0;
  for (int a = 0; a < now.axis_count; ++a)
    if (now.axes[static_cast<std::size_t>(a)].homed) bits |= 1u << a;
  return bits;
}

void Resident::keep_history(history::EventLog& log) {
  history_ = &log;
  requests_.set_witness([this, now = std::make_shared<image::ProcessImage>()](const image::Request& request,
                                                                              const image::Answer& answer) {
    control_.cycle().read(*now);
    history_->note(history::request_event(request, answer, control_.machine(),
                                          static_cast<double>(now->now.t_ns) * 1e-9));
  });
}

std::vector<Work> Resident::look_after() {
  requests_.look_after();
  if (history_ != nullptr)
    for (history::Event& e : watch_.look(image(), alarms())) history_->note(std::move(e));
  std::vector<Work> works;
  const std::uint32_t now = homed();
  unsaved_ = unsaved_ || (now & ~homed_seen_) != 0;
  homed_seen_ = now;
  for (int p = 0; p < processes(); ++p) adopt(p);
  bool ended = false;
  for (int p = 0; p < processes(); ++p) {
    const bool busy_now = busy(p);
    const bool ends = std::exchange(seat(p).busy_seen, busy_now) && !busy_now;
    ended = ended || ends;
    if (!ends) continue;
    if (auto proof = take_tables(p)) works.push_back(prove_later(std::move(*proof)));
  }
  const auto with_tool = static_cast<std::size_t>(control_.machine().tool_process());
  const bool tool = image().axis_count > 0 && image_.processes[with_tool].tool != state_.tool_in_spindle;
  unsaved_ = unsaved_ || ended || tool;
  if (unsaved_ && !saving_ && !state_path_.empty()) works.push_back(save_later());
  return works;
}

/// True: another process' program has loaded one into this one.
bool Resident::adopt_given(int process) {
  Seat& s = seat(process);
  const std::shared_ptr<const ProgramFile> given = control_.take_given(process);
  if (given == nullptr) return false;
  s.file = given;
  s.refused.clear();
  s.proven.reset();
  s.given = control_.given_tables(process).value_or(state_.tables);
  s.blocks = 0;
  s.lines = lines_of(given->text.view());
  if (journal_ != nullptr) journal_->loaded(process, s.file->path, s.file->dialect);
  return true;
}

/// What programs have loaded into each other's processes, and unloaded.
void Resident::adopt(int process) {
  Seat& s = seat(process);
  if (adopt_given(process)) return;
  if (control_.unloaded(process) && !busy(process)) {
    read_tables_of(process, true);
    s.file = no_program(process);
    s.refused.clear();
    s.proven.reset();
    s.blocks = s.lines = 0;
    arm(process, ProgramChange::Kind::program);
  }
}

Work Resident::prove_later(Proof proof) {
  const auto proven = std::make_shared<Proof>(std::move(proof));
  Work work;
  work.what = "check", work.name = proven->programs.front().file->path;
  work.run = [this, proven](const std::stop_token& stop) -> Finish {
    prove(*proven, stop);
    return [this, proven]() -> Outcome {
      this->proven(*proven);
      return Reply{};
    };
  };
  return work;
}

Work Resident::save_later() {
  unsaved_ = false;
  saving_ = true;
  Work work;
  work.what = "save", work.bench = Work::Bench::files;
  work.run = [this, saved = to_save()](const std::stop_token&) -> Finish {
    return [this, problem = write(saved)]() -> Outcome {
      saving_ = false;
      if (!problem.empty() && announce_) announce_(says::kNotSaved, {problem});
      return Reply{};
    };
  };
  return work;
}

const image::ProcessImage& Resident::image() {
  control_.cycle().read(image_);
  return image_;
}

const cycle::AlarmSnapshot& Resident::alarms() {
  control_.cycle().read(alarms_);
  return alarms_;
}

}  // namespace servogate::gateway
