// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/resident/resident.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "gateway/control/history/request_words.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

constexpr int kAnswerPatience_ms = 2000;
constexpr int kBlockPatience = 10'000;  ///< commands of a typed block that are looked at before it runs

}  // namespace

Resident::Resident(Control& control, machine::MachineState state, std::string state_path, double speed)
    : control_(control),
      state_(std::move(state)),
      state_path_(std::move(state_path)),
      speed_(speed),
      requests_(control.cycle()) {
  ProgramFile none;
  none.dialect = control.machine().control.dialect;
  none.model = program_model(control.machine());
  none.loader = program_loader({});
  file_ = std::make_shared<const ProgramFile>(std::move(none));
  arm(ProgramChange::Kind::program);
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
  while (image().now.number == before && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::microseconds(500));
}

bool Resident::busy() {
  const image::ProcessState state = image().processes[0].state;
  return state == image::ProcessState::running || state == image::ProcessState::held ||
         state == image::ProcessState::waiting;
}

bool Resident::stopping() const { return control_.process(0).stopping(); }

bool Resident::typed() { return busy() && image_.processes[0].typed; }

bool Resident::steps() { return busy() && image_.processes[0].mode == image::Mode::step; }

/// False: a program is being read just now, nothing was changed.
bool Resident::arm(ProgramChange::Kind kind) {
  own_tables_ = false;
  if (refused_.empty()) return control_.change({kind, 0, file_, state_.tables, {}});
  // Whoever starts, a start button too, must not find it.
  auto none = std::make_shared<ProgramFile>(*file_);
  none->path.clear();
  none->text.clear();
  return control_.change({kind, 0, std::move(none), state_.tables, {}});
}

std::optional<Resident::Proof> Resident::renew_tables() {
  // What was proven of the loaded program holds for its tables only.
  if (!file_->path.empty() && !(state_.tables == proven_)) return Proof{file_, state_.tables, position(), {}};
  arm(ProgramChange::Kind::tables);
  return std::nullopt;
}

void Resident::prove(Proof& proof, const std::stop_token& stop) const {
  ProgramCheck check = prove_program(control_.machine(), *proof.file, proof.tables, {proof.at, false},
                                     channel::Forecast::Depth::drivable, stop);
  for (text::Finding& f : check.report.findings)
    if (f.severity == text::Severity::error) proof.errors.push_back(std::move(f));
}

void Resident::proven(const Proof& proof) {
  if (proof.file != file_) return;  // another program was loaded meanwhile
  proven_ = proof.tables;
  refused_ = proof.errors;
  if (state_.tables == proven_) arm(ProgramChange::Kind::tables);
}

Resident::Load Resident::begin_load(std::string path, std::string dialect) {
  Load load;
  load.path = std::move(path);
  load.dialect = std::move(dialect);
  load.tables = state_.tables;
  load.at = position();
  return load;
}

void Resident::read_and_prove(Load& load, const std::stop_token& stop) const {
  load.opened = open_program(control_.machine(), load.path, load.dialect, *load.file, load.findings);
  if (!load.opened) return;
  ProgramCheck check = prove_program(control_.machine(), *load.file, load.tables, {load.at, false},
                                     channel::Forecast::Depth::drivable, stop);
  load.findings.insert(load.findings.end(), check.report.findings.begin(), check.report.findings.end());
  load.blocks = check.report.blocks;
  const std::string& text = load.file->text;
  load.lines = static_cast<int>(std::count(text.begin(), text.end(), '\n')) +
               (text.empty() || text.back() == '\n' ? 0 : 1);
}

Resident::Load::End Resident::finish(Load& load) {
  if (!load.opened) return Load::End::not_opened;
  read_tables();
  if (!(state_.tables == load.tables)) return Load::End::other_tables;
  for (const text::Finding& f : load.findings)
    if (f.severity == text::Severity::error) return Load::End::has_errors;
  std::shared_ptr<const ProgramFile> before = std::exchange(file_, load.file);
  std::vector<text::Finding> refused_before = std::exchange(refused_, {});
  const program::Tables proven_before = std::exchange(proven_, state_.tables);
  if (arm(ProgramChange::Kind::program)) {
    blocks_ = load.blocks;
    lines_ = load.lines;
    return Load::End::done;
  }
  file_ = std::move(before);  // a program began meanwhile
  refused_ = std::move(refused_before);
  proven_ = proven_before;
  return Load::End::busy;
}

void Resident::read_tables() {
  if (own_tables_) return;
  const std::scoped_lock lock(control_.reading());
  const program::Tables* tables = control_.process(0).feeder().tables();
  if (tables != nullptr && !control_.process(0).feeder().reads()) state_.tables = *tables;
}

std::optional<Resident::Proof> Resident::take_tables() {
  if (!own_tables_) {
    const std::scoped_lock lock(control_.reading());
    const program::Tables* tables = control_.process(0).feeder().tables();
    if (tables == nullptr || control_.process(0).feeder().reads()) return std::nullopt;
    state_.tables = *tables;
  }
  return renew_tables();
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

std::vector<text::Finding> Resident::check_block(const std::string& block) {
  const program::Position at = position();
  std::optional<program::Interpreter> trial;
  {
    const std::scoped_lock lock(control_.reading());
    trial = control_.process(0).manual_interpreter(at);
  }
  trial->mdi(block);
  std::optional<text::Finding> failed;
  for (int n = 0; n < kBlockPatience; ++n) {
    const program::Step step = trial->next(image_.packets, true);
    if (const auto* error = std::get_if<program::Error>(&step)) failed = error->finding;
    const auto* command = std::get_if<program::Command>(&step);
    if (command == nullptr || std::holds_alternative<program::End>(command->what)) break;
  }
  std::vector<text::Finding> findings = trial->warnings();
  if (failed) findings.push_back(*failed);
  return findings;
}

void Resident::set_manual_block(const std::string& block) {
  if (!block.empty()) manual_block_ = block;
  control_.change({ProgramChange::Kind::block, 0, {}, {}, block});
}

void Resident::forget_modes() { control_.change({ProgramChange::Kind::modes, 0, {}, {}, {}}); }

Zeroed Resident::zero(int axis, double value) {
  read_tables();
  const program::Position at = position();
  std::optional<program::Interpreter> manual;
  {
    const std::scoped_lock lock(control_.reading());
    manual = control_.process(0).manual_interpreter(at);
  }
  const machine::AxisConfig& a = control_.machine().axes[static_cast<std::size_t>(axis)];
  manual->preset(axis, a.diameter ? value / 2.0 : value);
  state_.tables = manual->tables();
  own_tables_ = true;
  const int origin = manual->origin(axis);
  return {origin, state_.tables.origins[origin][a.letter]};
}

std::optional<machine::MachineState> Resident::to_save() {
  if (state_path_.empty()) return std::nullopt;
  if (!own_tables_) {
    const std::scoped_lock lock(control_.reading());
    if (const program::Tables* tables = control_.process(0).feeder().tables(); tables != nullptr)
      state_.tables = *tables;
  }
  const image::ProcessImage& now = image();
  if (now.axis_count == 0) return std::nullopt;  // no cycle yet: nothing was learned
  cycle::References references;
  control_.cycle().read(references);
  for (std::size_t a = 0; a < control_.machine().axes.size(); ++a) {
    machine::HomingRecord& record = state_.homing[control_.machine().axes[a].letter];
    record.valid = now.axes[a].homed;
    record.offset_counts = references[a];
  }
  state_.tool_in_spindle = now.processes[0].tool;
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
  const bool busy_now = busy();
  const bool ended = busy_seen_ && !busy_now;
  busy_seen_ = busy_now;
  if (ended)
    if (auto proof = take_tables()) works.push_back(prove_later(std::move(*proof)));
  const bool tool = image().axis_count > 0 && image_.processes[0].tool != state_.tool_in_spindle;
  unsaved_ = unsaved_ || ended || tool;
  if (unsaved_ && !saving_ && !state_path_.empty()) works.push_back(save_later());
  return works;
}

Work Resident::prove_later(Proof proof) {
  const auto proven = std::make_shared<Proof>(std::move(proof));
  Work work;
  work.what = "check", work.name = program();
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
