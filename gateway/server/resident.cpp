// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/resident.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace servogate::gateway {

namespace {

constexpr int kBlockPatience = 10'000;  ///< commands of a typed block that are looked at before it runs

}  // namespace

Resident::Resident(Control& control, machine::MachineState state, std::string state_path, double speed)
    : control_(control), state_(std::move(state)), state_path_(std::move(state_path)), speed_(speed) {
  ProgramFile none;
  none.dialect = control.machine().control.dialect;
  none.model = program_model(control.machine());
  none.loader = program_loader({});
  file_ = std::make_shared<const ProgramFile>(std::move(none));
  arm(ProgramChange::Kind::program);
}

bool Resident::ask(image::Request request, image::Answer& answer, int patience_ms) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(patience_ms);
  request.id = next_id_++;
  while (control_.cycle().take_answer(answer)) {
  }  // of those that nobody waited for
  if (!control_.cycle().post(request)) return false;
  while (Clock::now() < end) {
    while (control_.cycle().take_answer(answer))
      if (answer.id == request.id) {
        catch_up();
        return true;
      }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  return false;
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

void Resident::tell(image::Request request) {
  image::Answer unread;
  while (control_.cycle().take_answer(unread)) {
  }
  request.id = next_id_++;
  control_.cycle().post(request);
}

/// False: a program is being read just now, nothing was changed.
bool Resident::arm(ProgramChange::Kind kind) {
  prove_again();
  if (refused_.empty()) return control_.change({kind, 0, file_, state_.tables, {}});
  // Whoever starts, a start button too, must not find it.
  auto none = std::make_shared<ProgramFile>(*file_);
  none->path.clear();
  none->text.clear();
  return control_.change({kind, 0, std::move(none), state_.tables, {}});
}

/// What was proven of the loaded program holds for its tables only.
void Resident::prove_again() {
  if (state_.tables == proven_) return;
  proven_ = state_.tables;
  refused_.clear();
  if (file_->path.empty()) return;
  for (text::Finding& f : prove(*file_).report.findings)
    if (f.severity == text::Severity::error) refused_.push_back(std::move(f));
}

ProgramCheck Resident::prove(const ProgramFile& file) {
  return prove_program(control_.machine(), file, state_.tables, {position(), false},
                       channel::Forecast::Depth::drivable);
}

Resident::Load Resident::load(const std::string& path, const std::string& dialect,
                              std::vector<text::Finding>& findings) {
  auto file = std::make_shared<ProgramFile>();
  if (!open_program(control_.machine(), path, dialect, *file, findings)) return Load::not_opened;
  take_tables();
  const ProgramCheck check = prove(*file);
  findings.insert(findings.end(), check.report.findings.begin(), check.report.findings.end());
  for (const text::Finding& f : findings)
    if (f.severity == text::Severity::error) return Load::has_errors;
  std::shared_ptr<const ProgramFile> before = std::exchange(file_, file);
  std::vector<text::Finding> refused_before = std::exchange(refused_, {});
  proven_ = state_.tables;
  if (arm(ProgramChange::Kind::program)) {
    blocks_ = check.report.blocks;
    lines_ = static_cast<int>(std::count(file->text.begin(), file->text.end(), '\n')) +
             (file->text.empty() || file->text.back() == '\n' ? 0 : 1);
    return Load::done;
  }
  file_ = std::move(before);  // a program began meanwhile
  refused_ = std::move(refused_before);
  return Load::busy;
}

void Resident::take_tables() {
  {
    const std::scoped_lock lock(control_.reading());
    const program::Tables* tables = control_.process(0).feeder().tables();
    if (tables == nullptr || control_.process(0).feeder().reads()) return;
    state_.tables = *tables;
  }
  arm(ProgramChange::Kind::tables);
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

void Resident::forget_modes() {
  take_tables();
  control_.change({ProgramChange::Kind::modes, 0, {}, {}, {}});
}

Resident::Zeroed Resident::zero(int axis, double value) {
  take_tables();
  const program::Position at = position();
  std::optional<program::Interpreter> manual;
  {
    const std::scoped_lock lock(control_.reading());
    manual = control_.process(0).manual_interpreter(at);
  }
  const machine::AxisConfig& a = control_.machine().axes[static_cast<std::size_t>(axis)];
  manual->preset(axis, a.diameter ? value / 2.0 : value);
  state_.tables = manual->tables();
  arm(ProgramChange::Kind::tables);
  const int origin = manual->origin(axis);
  return {origin, state_.tables.origins[origin][a.letter]};
}

std::string Resident::save() {
  if (state_path_.empty()) return {};
  {
    const std::scoped_lock lock(control_.reading());
    if (const program::Tables* tables = control_.process(0).feeder().tables(); tables != nullptr)
      state_.tables = *tables;
  }
  const image::ProcessImage& now = image();
  if (now.axis_count == 0) return {};  // no cycle yet: nothing was learned
  cycle::References references;
  control_.cycle().read(references);
  for (std::size_t a = 0; a < control_.machine().axes.size(); ++a) {
    machine::HomingRecord& record = state_.homing[control_.machine().axes[a].letter];
    record.valid = now.axes[a].homed;
    record.offset_counts = references[a];
  }
  state_.tool_in_spindle = now.processes[0].tool;
  std::string error;
  return machine::StateDirectory(state_path_).save_all(state_, error) ? std::string() : error;
}

std::uint32_t Resident::homed() {
  const image::ProcessImage& now = image();
  std::uint32_t bits = 0;
  for (int a = 0; a < now.axis_count; ++a)
    if (now.axes[static_cast<std::size_t>(a)].homed) bits |= 1u << a;
  return bits;
}

std::string Resident::look_after() {
  const std::uint32_t now = homed();
  const bool found = (now & ~homed_seen_) != 0;
  homed_seen_ = now;
  const bool busy_now = busy();
  const bool ended = busy_seen_ && !busy_now;
  busy_seen_ = busy_now;
  if (ended) take_tables();
  const bool changed = image().axis_count > 0 && image_.processes[0].tool != state_.tool_in_spindle;
  return found || ended || changed ? save() : std::string();
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
