// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/running_machine.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "firmware_if/text/in_both.hpp"
#include "gateway/control/compose/simulated/played_input.hpp"
#include "gateway/control/run/paced_loop.hpp"
#include "gateway/control/run/realtime_loop.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::gateway {

namespace {

/// In virtual time each so-many-th cycle is measured: as good a statistic, and the stopwatch costs little.
constexpr int kMeasuredCycles = 8;
constexpr image::Nanoseconds kPublished =
    5 * image::kMillisecond;  ///< of real time: a reader looks every 10 ms
constexpr auto kLook = std::chrono::milliseconds(10);
constexpr int kFirstLooks = 200;

const text::Entry kNotTriggered{"capture.not-triggered", "{0} was not written: the trigger did not come",
                                "файл {0} не записан: событие не наступило"};
const text::Entry kVirtualNeedsMock{
    "cli.virtual-needs-mock", "'{0}' is a real bus: virtual time is for mock buses only; use --realtime",
    "«{0}» — настоящая шина: виртуальное время только для имитаций; нужен --realtime"};

}  // namespace

std::unique_ptr<HeldState> HeldState::hold(const std::string& folder, const std::vector<std::string>& axes,
                                           drivers::Notice& taken, std::vector<text::Finding>& findings) {
  auto held = std::make_unique<HeldState>();
  if (folder.empty()) return held;
  held->folder = folder;
  if (const std::string why = held->lock.take(folder); !why.empty()) {
    taken = {&machine::kStateTaken, {folder, why}};
    return nullptr;
  }
  machine::StateDirectory::Loaded kept = machine::StateDirectory(folder, axes).load();
  held->state = std::move(kept.state);
  held->fell_back = kept.fell_back();
  findings.insert(findings.end(), kept.findings.begin(), kept.findings.end());
  const bool good = std::ranges::none_of(
      kept.findings, [](const text::Finding& f) { return f.severity == text::Severity::error; });
  return good ? std::move(held) : nullptr;
}

ClockKind clock_of(const machine::MachineConfig& machine, ClockKind asked, drivers::Notice& refusal) {
  if (asked == ClockKind::unset)
    asked = machine.virtual_time() && machine.nothing_real() ? ClockKind::virtual_time : ClockKind::realtime;
  if (asked != ClockKind::virtual_time) return asked;
  for (const machine::BusConfig& bus : machine.buses)
    if (!bus.mock() && !bus.lockstep()) {
      refusal = {&kVirtualNeedsMock, {bus.url}};
      return ClockKind::unset;
    }
  for (const machine::StationConfig& station : machine.stations)
    if (!station.mock()) {
      refusal = {&kVirtualNeedsMock, {station.url}};
      return ClockKind::unset;
    }
  return asked;
}

std::unique_ptr<RunningMachine> RunningMachine::compose(const machine::LoadResult& loaded,
                                                        std::unique_ptr<HeldState> state,
                                                        const RunSettings& settings,
                                                        std::vector<text::Finding>& findings) {
  if (state == nullptr) state = std::make_unique<HeldState>();
  std::unique_ptr<Control> control = Control::compose(loaded, findings, settings.source);
  if (control == nullptr) return nullptr;
  control->cycle().set_time_scale(settings.pace > 0.0 ? settings.pace : settings.time_scale);
  control->restore_references(state->state);
  control->restore_tool(state->state);
  const auto not_restored = control->restore_retained(state->state);
  findings.insert(findings.end(), not_restored.begin(), not_restored.end());
  return std::unique_ptr<RunningMachine>(new RunningMachine(std::move(state), settings, std::move(control)));
}

RunningMachine::RunningMachine(std::unique_ptr<HeldState> state, const RunSettings& settings,
                               std::unique_ptr<Control> control)
    : state_(std::move(state)),
      settings_(settings),
      control_(std::move(control)),
      journal_(state_->folder, machine().control.processes),
      keeper_(*control_, state_->folder, state_->state.retained_generation, settings.announce) {
  if (state_->fell_back) {
    image::AlarmRecord r;
    r.number = cycle::alarm::kStateFellBack;
    control_->cycle().notices().add(r);
  }
  if (!settings_.record.empty())
    record_ = begin_record(settings_.record, machine().file, learned(), *control_);
  if (!settings_.can_log.empty()) can_log_ = std::make_unique<CanLog>(settings_.can_log, *control_);
  if (settings_.clock == ClockKind::virtual_time) {
    control_->cycle().measure_every(kMeasuredCycles);
    control_->read_with(settings_.worker ? settings_.worker() : round_worker());
  }
  if (settings_.source == nullptr) control_->world().close_operator_points();
  if (!moves_by_itself()) return;
  const auto cycles = static_cast<int>(kPublished / control_->cycle().period_ns());
  control_->cycle().publish_every(paced() ? 1 : std::max(1, cycles));
  image_ = std::make_unique<image::ProcessImage>();
}

RunningMachine::~RunningMachine() = default;

Session& RunningMachine::watch(const Outputs& outputs) {
  trace_ = outputs.trace;
  session_ = std::make_unique<Session>(*control_, outputs, settings_.clock != ClockKind::virtual_time);
  return *session_;
}

bool RunningMachine::capture(const CaptureRequest& request, drivers::Notice& why) {
  capture_ = MachineCapture::open(*control_, request, why);
  return capture_ != nullptr;
}

void RunningMachine::keep_black_box(const std::string& folder) {
  black_box_ = MachineCapture::black_box(*control_, folder);
}

bool RunningMachine::begin(std::vector<drivers::Notice>& refusals) {
  if (settings_.clock != ClockKind::virtual_time) return begin_realtime(refusals);
  if (paced())
    paced_loop_ =
        std::make_unique<PacedLoop>(settings_.pace, control_->cycle(), [this] { return move_world(); });
  return true;
}

bool RunningMachine::begin_realtime(std::vector<drivers::Notice>& refusals) {
  const machine::MachineConfig& m = machine();
  const cycle::RealtimeSettings settings{m.realtime.priority, m.realtime.cpu,
                                         settings_.clock == ClockKind::realtime_best_effort};
  realtime_loop_ = std::make_unique<RealtimeLoop>(
      *control_, settings, [this](Control&, image::Nanoseconds late_ns) noexcept { after_cycle(late_ns); });
  const bool started = realtime_loop_->start();
  realtime_loop_->add_refusals(started, refusals);
  return started;
}

void RunningMachine::stop() {
  paced_loop_.reset();
  if (realtime_loop_ != nullptr) realtime_loop_->stop();
  control_->take_leave();
}

std::vector<RunningMachine::Lost> RunningMachine::close_files() {
  std::vector<Lost> lost;
  const auto note = [&lost](const std::string& path, std::string why) {
    if (!why.empty()) lost.push_back({path, std::move(why)});
  };
  if (session_ != nullptr) note(trace_, session_->close());
  if (record_ != nullptr) note(settings_.record, record_->close());
  if (can_log_ != nullptr) note(settings_.can_log, can_log_->close());
  for (const auto& capture : {capture_.get(), black_box_.get()})
    if (capture != nullptr) note(capture->path(), capture->close());
  if (capture_ != nullptr && !captured() && settings_.announce)
    settings_.announce(kNotTriggered, {capture_->path()});
  return lost;
}

std::string RunningMachine::keep() {
  if (state_->folder.empty()) return {};
  machine::MachineState& state = state_->state;
  const program::Tables given = state.tables;
  for (int p = 0; p < machine().control.processes; ++p) {
    const program::Tables before = control_->given_tables(p).value_or(given);
    const auto lock = control_->stop_reading();
    if (const program::Tables* tables = control_->process(p).feeder().tables(); tables != nullptr)
      program::carry_over(before, *tables, state.tables);
  }
  const image::ProcessImage& now = control_->cycle().image();
  const auto axes = control_->cycle().axes();
  for (std::size_t a = 0; a < axes.size(); ++a) {
    machine::HomingRecord& record = state.homing[machine().axes[a].letter];
    record.valid = now.axes[a].homed;
    record.offset_counts = axes[a].reference_counts();
  }
  state.tool_in_spindle = now.processes[static_cast<std::size_t>(machine().tool_process())].tool;
  std::string error;
  if (!machine::StateDirectory(state_->folder).save_all(state, error)) return error;
  return keep_retained();
}

void RunningMachine::wait_for_room() {
  if (session_ != nullptr) session_->wait_for_room();
  if (record_ != nullptr) record_->wait_for_room();
  if (can_log_ != nullptr) can_log_->wait_for_room();
  for (const auto& capture : {capture_.get(), black_box_.get()})
    if (capture != nullptr) capture->wait_for_room();
}

bool RunningMachine::cycle() {
  wait_for_room();
  return move_on(0);
}

bool RunningMachine::move_on(image::Nanoseconds late_ns) {
  if (late_ns > control_->cycle().period_ns()) {  // as the real-time loop counts them
    late_cycles_.fetch_add(1, std::memory_order_relaxed);
    control_->cycle().note_overrun(late_ns, false);
  }
  if (!control_->cycle().step()) return false;
  after_cycle(late_ns);
  return true;
}

/// real-time safe.
void RunningMachine::after_cycle(image::Nanoseconds late_ns) noexcept {
  journal_.note(control_->cycle().image());
  if (session_ != nullptr) session_->after_cycle(late_ns);
  if (capture_ != nullptr) capture_->after_cycle();
  if (black_box_ != nullptr) black_box_->after_cycle();
  if (record_ == nullptr || record_broken_ || !record_->broken()) return;
  record_broken_ = true;
  image::AlarmRecord r;
  r.number = cycle::alarm::kRecordBroken;
  control_->cycle().notices().add(r);
}

bool RunningMachine::move_world() {
  wait_for_room();  // what passes on the wires is logged, too
  const image::Nanoseconds late_ns = control_->advance_world();
  control_->read_for_cycle();
  return move_on(late_ns);
}

bool RunningMachine::step() {
  if (!moves_by_itself()) return move_world();
  // Nothing is published before the first cycles: that is no machine whose axes are all ready.
  for (int n = 0; n == 0 || (image_->axis_count == 0 && n < kFirstLooks); ++n) {
    std::this_thread::sleep_for(kLook);
    control_->cycle().read(*image_);
  }
  return true;
}

const image::ProcessImage& RunningMachine::image() const {
  return moves_by_itself() ? *image_ : control_->cycle().image();
}

const cycle::AlarmSnapshot& RunningMachine::alarms() {
  if (moves_by_itself())
    control_->cycle().read(alarms_);
  else
    control_->cycle().alarms().snapshot(alarms_);
  return alarms_;
}

image::Nanoseconds RunningMachine::cycle_duration_ns() const {
  return control_->cycle().measured() ? control_->cycle().duration_ns() : -1;
}

bool RunningMachine::load(const std::string& program, std::vector<text::Finding>& findings, int process) {
  auto file = std::make_shared<ProgramFile>();
  file->process = process;
  if (!open_program(machine(), program, {}, *file, findings)) return false;
  const ProgramCheck check = prove_program(machine(), *file, learned().tables, start_after_homing(machine()),
                                           channel::Forecast::Depth::drivable);
  findings.insert(findings.end(), check.report.findings.begin(), check.report.findings.end());
  for (const text::Finding& f : check.report.findings)
    if (f.severity == text::Severity::error) return false;
  return control_->change({ProgramChange::Kind::program, process, std::move(file), learned().tables, {}});
}

bool RunningMachine::play(const std::string& point, std::optional<double> value, std::string& why) {
  const InputWish wish = value ? InputWish(*value) : InputWish();
  const PlayedInput played = play_input(machine(), control_->world(), point, wish);
  if (played.outcome == PlayedInput::Outcome::done) return true;
  why = text::in_both(*played.entry, played.arguments);
  return false;
}

std::string RunningMachine::report() const {
  return session_ != nullptr ? report::to_json(session_->make_report(0.0, overruns())) : std::string();
}

std::int64_t RunningMachine::overruns() const noexcept {
  return realtime_loop_ != nullptr ? realtime_loop_->overruns()
                                   : late_cycles_.load(std::memory_order_relaxed);
}

}  // namespace servogate::gateway
