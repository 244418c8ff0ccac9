// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/outputs.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kNoRecord{"replay.no-record", "cannot replay {0}: {1}", "не удаётся повторить {0}: {1}"};
const text::Entry kDamaged{"replay.damaged",
                           "{0} is damaged at byte {1}: the {2} cycles before were replayed",
                           "{0}: запись повреждена с байта {1}; повторено циклов до этого места: {2}"};
const text::Entry kChanged{"replay.changed",
                           "{0} has changed since the record was made; the replay may differ",
                           "{0} изменён после записи; повтор может отличаться"};
const text::Entry kSame{"replay.same", "{0} cycles replayed, the trace is equal byte by byte",
                        "повторено циклов: {0}, трасса совпадает побайтно"};
const text::Entry kReplayed{"replay.done", "{0} cycles replayed", "повторено циклов: {0}"};
const text::Entry kNoTrace{"replay.no-trace", "cannot read {0}: {1}", "не читается {0}: {1}"};
const text::Entry kDiffers{"replay.differs", "line {0} of the trace differs", "строка {0} трассы отличается"};

/// First line in which two files differ, 0: none.
long first_difference(const std::string& a, const std::string& b) {
  std::ifstream fa(a, std::ios::binary), fb(b, std::ios::binary);
  std::string la, lb;
  for (long line = 1;; ++line) {
    const bool ga = static_cast<bool>(std::getline(fa, la)), gb = static_cast<bool>(std::getline(fb, lb));
    if (ga != gb || (ga && la != lb) || fa.eof() != fb.eof()) return line;
    if (!ga) return 0;
  }
}

/// True when the cycle had seen more changes of the process than have been made so far.
bool due(Control& control, const ProgramChange& change, const cycle::CycleInputs& inputs) {
  constexpr std::size_t kEach = cycle::ProcessInCycle::kCrossingsEach;
  const std::size_t last = static_cast<std::size_t>(change.process) * kEach + kEach - 1;
  return control.process(change.process).changes() < inputs.visible[last];
}

/// What was loaded was loaded when nothing of the program before was left to be read.
bool carry_out(Control& control, const ProgramChange& change) {
  while (control.process(change.process).feeder().reads() && control.read_ahead()) {
  }
  return control.change(change);
}

/// Makes ready what the requests of the next cycle change of the PLC.
void prepare_logic(Control& control, const std::vector<plc::LogicChange>& changes,
                   const cycle::CycleInputs& inputs) {
  for (int i = 0; i < inputs.request_count; ++i) {
    const image::Request& request = inputs.requests[static_cast<std::size_t>(i)];
    if (request.kind != image::RequestKind::logic || control.logic() == nullptr) continue;
    for (const plc::LogicChange& change : changes)
      if (change.number == request.index)
        control.prepare(change, change.kind == plc::LogicChange::Kind::load
                                    ? control.compile(change.files, {})
                                    : plc::CompileResult{});
  }
}

/// Reads ahead until everything is published that the cycle saw at this point of the record, or nothing more
/// can be: what a reader had still published while its program was already given up has no meaning.
void catch_up(Control& control, const cycle::CycleInputs& inputs) {
  const int processes = control.machine().control.processes;
  for (;;) {
    const bool more = control.read_ahead();
    bool enough = true;
    for (int p = 0; p < processes; ++p) {
      std::array<std::uint64_t, cycle::ProcessInCycle::kCrossingsEach> filled{};
      control.process(p).published(filled);
      for (std::size_t i = 0; i < filled.size(); ++i)
        enough = enough && filled[i] >= inputs.visible[static_cast<std::size_t>(p) * filled.size() + i];
    }
    if (enough || !more) return;
  }
}

/// The record, and the trace that it is compared with, can be read: kDone, or the exit code after saying why.
int open_inputs(const ReplayOptions& options, RecordReader& record) {
  std::string error;
  if (!record.open(options.record, error)) {
    complain(kNoRecord, {options.record, error});
    return kWrongUse;
  }
  const std::string why = options.against.empty() ? "" : files::why_unreadable(options.against);
  if (why.empty()) return kDone;
  complain(kNoTrace, {options.against, why});
  return kWrongUse;
}

/// The machine of the record as the run found it; nullptr: it cannot be composed, which has been said.
std::unique_ptr<RunningMachine> compose(const machine::LoadResult& loaded, RecordReader& record) {
  const RecordHeader& header = record.header();
  if (report::identify(header.machine).sha256 != header.machine_sha256) complain(kChanged, {header.machine});
  auto state = std::make_unique<HeldState>();
  state->state = header.state;
  std::vector<text::Finding> findings;
  auto machine = RunningMachine::compose(loaded, std::move(state),
                                         {.time_scale = header.time_scale, .source = &record}, findings);
  return print_findings(findings) > 0 ? nullptr : std::move(machine);
}

/// Repeats every cycle of the record.
void repeat(RunningMachine& machine, RecordReader& record) {
  Control& control = machine.control();
  const std::vector<ProgramChange> changes = record.changes(machine.machine());
  std::size_t changed = 0;
  while (const cycle::CycleInputs* next = record.next()) {
    while (changed < changes.size() && due(control, changes[changed], *next))
      if (!carry_out(control, changes[changed++])) break;
    prepare_logic(control, record.logic_changes(), *next);
    catch_up(control, *next);
    if (!machine.cycle()) break;
  }
}

/// Says what came of it, and gives the exit code.
int judge(const ReplayOptions& options, const RecordReader& record, std::int64_t cycles, long difference) {
  if (options.json)
    print_exact(nlohmann::ordered_json{
        {"schema", 1}, {"cycles", cycles}, {"damaged", record.damaged()}, {"first_difference", difference}}
                    .dump());
  if (record.damaged()) {
    // How far a trace that ends here agrees says nothing new.
    complain(kDamaged, {options.record, std::to_string(record.damaged_at()), std::to_string(cycles)});
    return kWrongUse;
  }
  if (difference != 0) {
    complain(kDiffers, {std::to_string(difference)});
    return kAlarm;
  }
  if (!options.json)
    tell(text::render(options.against.empty() ? kReplayed : kSame,
                      std::vector<std::string>{std::to_string(cycles)}, text::user_language()));
  return kDone;
}

}  // namespace

int replay(const ReplayOptions& options) {
  RecordReader record;
  if (const int code = open_inputs(options, record); code != kDone) return code;
  const machine::LoadResult loaded = machine::load(record.header().machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  if (const int code = check_outputs(
          {{"--trace", options.trace}}, "", loaded,
          {{text::both("the record", "запись"), options.record}, {"--against", options.against}});
      code != kDone)
    return code;
  const auto machine = compose(loaded, record);
  if (machine == nullptr) return kWrongUse;
  std::string error, trace = options.trace;
  if (trace.empty() && !options.against.empty()) trace = files::nameless_file(options.against, error);
  if (!error.empty()) {
    complain(kCannotWrite, {text::both("the replay's trace", "трассу повтора"), error});
    return kInfrastructure;
  }
  machine->watch({trace, {}, {}});
  repeat(*machine, record);
  for (const RunningMachine::Lost& lost : machine->close_files()) {
    tell("servogate: " + trace + ": " + lost.why);
    return kInfrastructure;
  }
  const long difference = options.against.empty() ? 0 : first_difference(options.against, trace);
  return judge(options, record, machine->control().cycle().count(), difference);
}

}  // namespace servogate::gateway::command
