// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "firmware_if/text/in_both.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/canopen/bus/sole_master.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/force_setting.hpp"
#include "gateway/command/machine_start.hpp"
#include "gateway/command/outputs.hpp"
#include "gateway/command/program_option.hpp"
#include "gateway/command/run_faults.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/compose/program/program_check.hpp"
#include "gateway/control/compose/program/program_file.hpp"
#include "gateway/control/run/forces/run_forces.hpp"
#include "gateway/control/run/operator_script.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/run/words/ready_words.hpp"
#include "gateway/control/run/words/stop_words.hpp"
#include "gateway/control/run/words/wait_words.hpp"
#include "gateway/control/server/socket/run_server.hpp"
#include "gateway/control/server/socket/socket_path.hpp"
#include "kernel/program/check/check.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kRefused{"run.refused", "the control refuses: {0}", "управление отказывает: {0}"};
const text::Entry kNotReady{"run.not-ready", "these axes did not become ready: {0}",
                            "эти оси не пришли в готовность: {0}"};
const text::Entry kNotHomed{"run.not-homed", "homing ended before these axes had their zero: {0}",
                            "выход в ноль закончился раньше, чем эти оси нашли ноль: {0}"};
const text::Entry kNotAnnounced{"run.not-announced",
                                "other tools cannot see that this run uses its buses: no socket {0}: {1}",
                                "инструменты не увидят, что этот прогон держит шины: нет сокета {0}: {1}"};
const text::Entry kAlarmLine{"run.alarm", "alarm {0}: {1}", "авария {0}: {1}"};
const text::Entry kConsequence{"run.consequence", "  from it alarm {0}: {1}", "  из-за неё авария {0}: {1}"};
const text::Entry kMessage{"run.message", "message of the program: {0}", "сообщение программы: {0}"};
const text::Entry kWaits{"run.waits", "{0} ({1} s so far)", "{0} (уже {1} с)"};
const text::Entry kNoOperator{"run.no-operator",
                              "`servogate run` has no operator: use `servogate up` for such programs.",
                              "У `servogate run` нет оператора: для таких программ есть `servogate up`."};
const text::Entry kGaveUp{"run.gave-up",
                          "{0}. Nothing has moved for {1} s of machine time: the run was stopped (--patience "
                          "sets how long it waits)",
                          "{0}. За {1} с машинного времени ничего не сдвинулось: прогон остановлен (сколько "
                          "ждать, задаёт --patience)"};
const text::Entry kDone1{"run.done", "done: {0} blocks in {1} s of machine time",
                         "готово: кадров {0}, машинное время {1} с"};
const text::Entry kProgress{"run.progress", "{0} of about {1} blocks, {2} s",
                            "кадров {0} примерно из {1}, {2} с"};
const text::Entry kProgressLeft{"run.progress-left", ", about {0} s left", ", осталось около {0} с"};
const text::Entry kStoppedEarly{"run.stopped-early",
                                "stopped by the operator before the first block; the drives are off",
                                "остановлено оператором до первого кадра; приводы выключены"};
const text::Entry kPressFirst{"run.press-first",
                              "nothing moves yet: the start button '{0}' switches the drives on and homes; "
                              "pressed again it starts the program",
                              "пока ничего не движется: кнопка пуска «{0}» включает приводы и выводит оси в "
                              "ноль; второе нажатие запускает "
                              "программу"};
const text::Entry kPressSecond{"run.press-second", "ready: the start button '{0}' starts the program",
                               "готово: кнопка пуска «{0}» запускает программу"};
const text::Entry kMissing{"run.missing", "  {0}\n    {1}", "  {0}\n    {1}"};
const text::Entry kWritten{"run.written", "written: {0}", "записано: {0}"};
const text::Entry kBroken{"run.broken-off", "broken off: {0} of about {1} blocks in {2} s of machine time",
                          "прервано: кадров {0} примерно из {1}, машинное время {2} с"};

constexpr double kPatience_s = 60.0;       ///< of machine time, where --patience says nothing
constexpr double kSilentWait_s = 5.0;      ///< a longer wait is said
constexpr double kProgressPause_s = 0.25;  ///< of wall-clock time, on a terminal
constexpr double kLogPause_s = 10.0;       ///< and in a file or pipe
constexpr double kHomingSpare_s = 60.0;    ///< beyond the `timeout` of all axes, for what stands between them
constexpr int kFollowedCycles = 256;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

int code_of(OperatorScript::Outcome outcome) {
  return outcome == OperatorScript::Outcome::finished  ? kDone
         : outcome == OperatorScript::Outcome::stopped ? kStopped
                                                       : kAlarm;
}

/// One run from the command line: everything between "machine loaded" and the exit code.
class Run {
 public:
  Run(const RunOptions& options, const machine::LoadResult& loaded) : options_(options), loaded_(loaded) {}

  int prepare();
  int execute(const std::vector<std::string>& command_line);
  /// Trace, report and page are written.
  bool reported() const { return reported_; }

 private:
  bool waits_for_start() const { return !loaded_.machine.nothing_real() && !options_.start_now; }
  bool realtime() const { return options_.clock != ClockKind::virtual_time; }
  OperatorScript::Wishes wishes() const;
  int give_up(int code);
  void announce();
  bool loop(OperatorScript& script);
  void take_answers(OperatorScript& script);
  void prompt(const OperatorScript& script);
  void note_missing(const OperatorScript& script);
  std::vector<MissingCondition> missing_in_both() const;
  double patience() const;
  void follow(const image::ProcessImage& image);
  void progress(const image::ProcessImage& image);
  void end_progress();
  int finish(const OperatorScript& script, Session& session, const std::vector<std::string>& command_line);
  std::optional<report::ErrorEntry> not_begun(const OperatorScript& script) const;
  void explain(const OperatorScript& script, const report::Report& report);

  const RunOptions& options_;
  const machine::LoadResult& loaded_;
  std::shared_ptr<ProgramFile> program_ = std::make_shared<ProgramFile>();
  std::unique_ptr<HeldState> state_;  ///< until the machine has it
  SoleMaster sole_master_;
  std::vector<text::Finding> wrong_;  ///< errors of the program: nothing moves
  std::unique_ptr<RunningMachine> machine_;
  Control* control_ = nullptr;  ///< machine_'s
  std::unique_ptr<RunServer> server_;
  std::unique_ptr<RunForces> forces_;
  std::unique_ptr<RunFaults> faults_;
  double first_block_s_ = 0.0;  ///< machine time when the first blocks were found done
  std::int64_t estimate_blocks_ = 0;
  Clock::time_point begin_;
  double wall_s_ = 0.0;
  double last_progress_ = 0.0;
  bool line_open_ = false;                 ///< a progress line stands on the terminal
  std::int32_t message_said_ = 0;          ///< newest message of the program that was printed
  image::Nanoseconds wait_said_ = -1;      ///< beginning of the wait that was printed
  std::vector<MissingCondition> missing_;  ///< for the drives to be on, when the script gave up on them
  bool missing_noted_ = false;
  OperatorScript::Stage prompted_ = OperatorScript::Stage::done;  ///< what the operator was last asked for
  bool infrastructure_ = false;
  bool reported_ = false;
};

int Run::prepare() {
  const machine::MachineConfig& m = loaded_.machine;
  int refused = kDone;
  state_ = hold_state(options_.state, m, refused);
  if (state_ == nullptr) return refused;
  if (!options_.tables.empty() || options_.state.empty()) {
    std::vector<text::Finding> of_tables;
    state_->state.tables = program_tables(m, options_.tables, of_tables);
    if (print_findings(of_tables) > 0) return kWrongUse;
  }
  if (!options_.program.empty()) {
    if (const int code = open_program_or_say(m, options_.program, options_.dialect, *program_); code != kDone)
      return code;
    const ProgramFile& p = *program_;
    const ProgramCheck check =
        prove_program(m, p, state_->state.tables, start_after_homing(m), channel::Forecast::Depth::drivable);
    print_findings(check.report.findings);
    std::copy_if(check.report.findings.begin(), check.report.findings.end(), std::back_inserter(wrong_),
                 [](const text::Finding& f) { return f.severity == text::Severity::error; });
    estimate_blocks_ = check.report.executed;
  }
  if (const int code = sole_master_.claim(loaded_); code != kDone) return code;
  std::vector<text::Finding> findings;
  machine_ = RunningMachine::compose(loaded_, std::move(state_),
                                     {.clock = options_.clock,
                                      .record = options_.record,
                                      .can_log = options_.can_log,
                                      .announce = to_standard_error()},
                                     findings);
  const int errors = print_findings(findings);
  if (machine_ == nullptr)
    return errors > 0 && !Control::infrastructure(findings) ? kWrongUse : kInfrastructure;
  control_ = &machine_->control();
  drivers::Notice why;
  if (options_.capture.asked() && !machine_->capture(options_.capture, why)) {
    complain(*why.entry, why.arguments);
    return kWrongUse;
  }
  const auto forces = force_settings(options_.forces);
  forces_ = std::make_unique<RunForces>(*control_);
  if (!forces || print_findings(forces_->plan(*forces)) > 0) return kWrongUse;
  faults_ = std::make_unique<RunFaults>(*machine_);
  if (!faults_->plan(options_.faults, options_.script)) return kWrongUse;
  if (!options_.program.empty())
    control_->change({ProgramChange::Kind::program, 0, program_, machine_->learned().tables, {}});
  return kDone;
}

/// At a real machine people open doors and press buttons whenever they like: there only the option sets an
/// end.
double Run::patience() const {
  return options_.patience_s.value_or(loaded_.machine.nothing_real() ? kPatience_s : 0.0);
}

OperatorScript::Wishes Run::wishes() const {
  OperatorScript::Wishes w;
  w.program = !options_.program.empty();
  w.override_ratio = options_.override_percent / 100.0;
  w.wait_for_start = waits_for_start();
  if (const machine::PointConfig* button =
          loaded_.machine.point(loaded_.machine.run.start_point, &w.start_source))
    w.start_place = button->place;
  w.patience_s = patience();
  w.fault = [this] { return fault_stands(machine_->alarms()); };
  w.homing_patience_s = kHomingSpare_s;
  w.letters = loaded_.machine.letters();
  w.letters.resize(loaded_.machine.program_axes());
  for (const machine::AxisConfig& a : loaded_.machine.axes) {
    w.needs_homing.push_back(a.home.method != machine::HomingMethod::none);
    w.homing_patience_s += a.home.timeout;
  }
  return w;
}

/// Nothing has moved: what is written then (write_outputs_of_no_run) finds its files free.
int Run::give_up(int code) {
  machine_->close_files();
  return code;
}

int Run::execute(const std::vector<std::string>& command_line) {
  Session& session = machine_->watch({options_.trace, options_.report, options_.html});
  OperatorScript script(wishes(), [this](const image::Request& r) { return machine_->post(r); });
  if (!wrong_.empty()) return finish(script, session, command_line);
  if (const int code = SoleMaster::listen(*control_); code != kDone) return give_up(code);
  count_signals();
  if (realtime()) refuse_suspension();
  announce();
  begin_ = Clock::now();
  if (!loop(script)) return give_up(kInfrastructure);
  wall_s_ = seconds_since(begin_);
  server_.reset();
  return finish(script, session, command_line);
}

/// Who holds buses that others can reach says so, and lets them read through it.
void Run::announce() {
  if (!RunServer::needed(loaded_.machine)) return;
  const std::string path = run_socket(loaded_.machine.name);
  server_ = std::make_unique<RunServer>(*control_, path);
  const std::string problem = server_->bind();
  if (problem.empty()) return server_->start();
  complain(kNotAnnounced, {path, problem});
  server_.reset();
}

void Run::take_answers(OperatorScript& script) {
  image::Answer answer;
  while (machine_->take(answer))
    if (!forces_->take(answer)) script.take(answer);
  for (static int seen = 0; seen < signals_seen(); ++seen) script.interrupt();
  prompt(script);
}

/// At a real machine a person starts: what pressing the button does next.
void Run::prompt(const OperatorScript& script) {
  if (!waits_for_start() || script.stage() == prompted_) return;
  const std::string& button = loaded_.machine.run.start_point;
  if (script.stage() == OperatorScript::Stage::button) tell(say(kPressFirst, {button}));
  if (script.stage() == OperatorScript::Stage::start) tell(say(kPressSecond, {button}));
  prompted_ = script.stage();
}

/// As it was in the cycle in which the script gave up, before it switches off what is on.
void Run::note_missing(const OperatorScript& script) {
  if (missing_noted_ || script.outcome() == OperatorScript::Outcome::under_way) return;
  missing_noted_ = true;
  const bool refused = script.outcome() == OperatorScript::Outcome::refused;
  if (refused || (script.outcome() == OperatorScript::Outcome::alarm && !script.waiting_for().empty()))
    missing_ = missing_in_both();
}

std::vector<MissingCondition> Run::missing_in_both() const {
  const auto in = [&](text::Language language) {
    return missing_for_power(*control_, machine_->image(), machine_->alarms(), language);
  };
  std::vector<MissingCondition> out = in(text::Language::english);
  const std::vector<MissingCondition> russian = in(text::Language::russian);
  for (std::size_t n = 0; n < out.size(); ++n) {
    out[n].text = text::both(out[n].text, russian[n].text);
    out[n].remedy = text::both(out[n].remedy, russian[n].remedy);
  }
  return out;
}

bool Run::loop(OperatorScript& script) {
  if (!begin(*machine_, options_.quiet)) return false;
  // Virtual time is looked at now and then only: a look costs more than a cycle.
  const int each = machine_->moves_by_itself() ? 1 : kFollowedCycles;
  for (int n = 1; !script.done(); ++n) {
    faults_->poll(machine_->image().now.t_ns);
    machine_->step();
    take_answers(script);
    forces_->poll();
    if (forces_->done()) script.poll(machine_->image());
    note_missing(script);
    if (n % each == 0) follow(machine_->image());
  }
  machine_->stop();
  return true;
}

/// What a person wants to know while it runs: the program's messages, what it waits for, how far it is.
void Run::follow(const image::ProcessImage& image) {
  if (options_.quiet) return;
  const image::ProcessStatus& p = image.processes[0];
  for (; message_said_ < p.message; ++message_said_)
    if (const auto words = control_->process(0).texts().message(message_said_ + 1); words) {
      end_progress();
      tell(say(kMessage, {*words}));
    }
  const auto wait = wait_words(*control_, image, 0, text::user_language());
  if (wait && needs_somebody(p.wait.reason) && wait->for_s >= kSilentWait_s &&
      wait_said_ != p.wait.since_ns) {
    wait_said_ = p.wait.since_ns;
    end_progress();
    tell(say(kWaits, {wait->text, text::number(wait->for_s, 1)}));
  }
  progress(image);
}

void Run::progress(const image::ProcessImage& image) {
  if (begin_ == Clock::time_point{}) return;
  const double wall = seconds_since(begin_);
  const bool terminal = isatty(2) != 0;
  if (estimate_blocks_ == 0 || wall - last_progress_ < (terminal ? kProgressPause_s : kLogPause_s)) return;
  last_progress_ = wall;
  const std::int64_t done = image.processes[0].blocks_done;
  const double now = image.now.seconds();
  if (first_block_s_ == 0.0 && done > 0) first_block_s_ = now;
  const std::string of = std::to_string(estimate_blocks_);
  std::string line = say(kProgress, {std::to_string(done), of, text::number(now, 1)});
  // As the blocks so far; the path is planned only as it is driven.
  if (done > 0 && now > first_block_s_) {
    const double left = static_cast<double>(std::max(estimate_blocks_ - done, std::int64_t{0}));
    line += say(kProgressLeft, {text::number((now - first_block_s_) * left / static_cast<double>(done), 0)});
  }
  std::fprintf(stderr, terminal ? "\r%s   " : "%s\n", line.c_str());
  line_open_ = terminal;
}

void Run::end_progress() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

int Run::finish(const OperatorScript& script, Session& session,
                const std::vector<std::string>& command_line) {
  const auto written = [this](const std::string& path, const std::string& error) {
    if (error.empty()) return;
    // Where the writer names its file, too, only the system's words are left to be said.
    const bool named = error.starts_with(path + ": ");
    complain(kCannotWrite, {path, named ? error.substr(error.rfind(": ") + 2) : error});
    infrastructure_ = true;
  };
  reported_ = true;
  follow(control_->cycle().image());
  end_progress();
  for (const RunningMachine::Lost& lost : machine_->close_files()) written(lost.path, lost.why);
  report::Report report = session.make_report(wall_s_, machine_->overruns());
  report.finished = script.outcome() == OperatorScript::Outcome::finished;
  report.blocks_expected = estimate_blocks_;
  report.stopped = script.outcome() == OperatorScript::Outcome::stopped;
  report.findings = wrong_;
  if (script.outcome() == OperatorScript::Outcome::waited) {
    const auto words = [&](text::Language language) {
      return wait_words(*control_, control_->cycle().image(), 0, script.given_up(), language);
    };
    const WaitWords w = words(text::Language::english), russian = words(text::Language::russian);
    const image::WaitReason reason = script.given_up().reason;
    const bool for_operator =
        reason == image::WaitReason::program_stop || reason == image::WaitReason::optional_stop;
    report.wait = {std::string(w.reason),
                   text::both(w.text, russian.text),
                   for_operator ? text::in_both(kNoOperator, {}) : text::both(w.remedy, russian.remedy),
                   w.file,
                   w.line,
                   patience()};
  }
  report.error = not_begun(script);
  report.forces = forces_->active();
  report::Provenance& p = report.provenance;
  fill_provenance(p, options_, loaded_.machine, command_line);
  p.dialect = program_->dialect;
  if (!options_.report.empty())
    written(options_.report, report::write_file(options_.report, report::to_json(report)));
  if (!options_.html.empty()) {
    report::HtmlOptions html;
    html.program_name = std::filesystem::path(options_.program).filename().string();
    html.title = loaded_.machine.name + (html.program_name.empty() ? "" : " · " + html.program_name);
    html.program_text = std::string(program_->text.view());
    html.language = text::user_language();
    written(options_.html,
            report::write_file(options_.html, report::to_html(report, *session.picture(), html)));
  }
  if (options_.json) print(report::to_json(report));
  explain(script, report);
  if (wrong_.empty())
    if (const std::string why = machine_->keep(); !why.empty()) {
      complain(kCannotWrite, {options_.state, why});
      infrastructure_ = true;
    }
  return unless_frames_lost(infrastructure_ ? kInfrastructure : code_of(script.outcome()), *control_);
}

/// Why nothing was begun although cycles ran: what the gate says, or which axes did not become ready; then
/// what is missing.
std::optional<report::ErrorEntry> Run::not_begun(const OperatorScript& script) const {
  report::ErrorEntry error;
  if (script.outcome() == OperatorScript::Outcome::refused) {
    const auto why = [&](text::Language language) {
      return cycle::render(script.refusal(), loaded_.machine.letters(), language,
                           loaded_.machine.unit_words());
    };
    error = {
        std::string(kRefused.id),
        text::in_both(kRefused, {text::both(why(text::Language::english), why(text::Language::russian))})};
  } else if (script.outcome() == OperatorScript::Outcome::alarm && !script.waiting_for().empty()) {
    std::string axes;
    for (const std::string& a : script.waiting_for()) axes += (axes.empty() ? "" : ", ") + a;
    const bool homing = script.came_to() == OperatorScript::Stage::homing;
    const text::Entry& entry = homing ? kNotHomed : kNotReady;
    error = {std::string(entry.id), text::in_both(entry, {axes})};
  } else {
    return std::nullopt;
  }
  for (const MissingCondition& m : missing_)
    if (m.reason != "alarm") error.text += "\n" + text::in_both(kMissing, {m.text, m.remedy});
  return error;
}

void Run::explain(const OperatorScript& script, const report::Report& report) {
  for (const report::AlarmEntry& a : report.alarms)
    tell(say(a.consequence ? kConsequence : kAlarmLine, {std::to_string(a.record.number), a.text}) + "\n" +
         (a.consequence ? "    " : "  ") + text::in_language(a.remedy));
  if (report.wait) {
    complain(kGaveUp, {report.wait->text, text::number(report.wait->for_s, 1)});
    tell("  " + text::in_language(report.wait->remedy));
  }
  if (report.error) {
    const std::string words = text::in_language(report.error->text);
    const std::size_t end = std::min(words.find('\n'), words.size());
    tell("servogate: " + words.substr(0, end) + " [" + report.error->code + "]" + words.substr(end));
  }
  if (const auto stop = stop_words(*control_, control_->cycle().image(), 0, text::user_language()); stop)
    tell(stop->text + "\n  " + stop->remedy);
  if (script.outcome() == OperatorScript::Outcome::stopped && report.blocks == 0)
    tell(say(kStoppedEarly, {}));
  if (options_.quiet) return;
  const std::string blocks = std::to_string(report.blocks), time = text::number(report.time_s, 3);
  if (script.outcome() == OperatorScript::Outcome::finished)
    tell(say(kDone1, {blocks, time}));
  else if (report.blocks > 0)
    tell(say(kBroken, {blocks, std::to_string(estimate_blocks_), time}));
  std::string files;
  for (const std::string* path : {&options_.html, &options_.report, &options_.trace, &options_.record,
                                  &options_.can_log, &options_.capture.file})
    if (!path->empty() && (path != &options_.capture.file || machine_->captured()))
      files += (files.empty() ? "" : ", ") + *path;
  if (!files.empty() && !infrastructure_) tell(say(kWritten, {files}));
}

/// What has to be right before a control is composed: kDone, or the exit code after saying why.
int refuse_early(RunOptions& options, const machine::LoadResult& loaded) {
  if (const int code = check_dialect(options.dialect); code != kDone) return code;
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  if (!settle_clock(loaded.machine, options.clock)) return kWrongUse;
  if (options.start_now && !loaded.machine.run.allow_start_now && !loaded.machine.nothing_real()) {
    complain(kStartNowForbidden, {});
    return kWrongUse;
  }
  if (!loaded.machine.nothing_real() && !options.start_now && loaded.machine.run.start_point.empty()) {
    complain(kNoStartButton, {});
    return kWrongUse;
  }
  return kDone;
}

}  // namespace

int run(const RunOptions& given, const std::vector<std::string>& command_line) {
  RunOptions options = given;
  const machine::LoadResult loaded = machine::load(options.machine);
  if (const int code =
          check_outputs({{"--trace", options.trace},
                         {"--report", options.report},
                         {"--html", options.html},
                         {"--record", options.record},
                         {"--capture", options.capture.file}},
                        options.state, loaded,
                        {{text::both("the part program", "управляющую программу"), options.program}});
      code != kDone)
    return code;
  int code = refuse_early(options, loaded);
  if (code == kDone) code = check_can_log(options.can_log, loaded);
  Run run(options, loaded);
  if (code == kDone) code = run.prepare();
  if (code == kDone) code = run.execute(command_line);
  if (!run.reported()) write_outputs_of_no_run(options, loaded, command_line);
  return code;
}

}  // namespace servogate::gateway::command
