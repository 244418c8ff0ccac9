// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/dispatch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware_if/text/units.hpp"
#include "gateway/control/compose/simulated/played_input.hpp"
#include "gateway/control/server/desk/dispatch/bus_reading.hpp"
#include "gateway/control/server/desk/dispatch/status.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/protocol/refusal.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

namespace {

using image::RequestKind;

constexpr double kKeepAlive_ms = 30.0;  ///< of the wall clock, between two keep-alives of a jog

constexpr std::size_t kFindingsSaid = 10;  ///< of a bad program; all of them stand in the answer's "findings"

std::string signed_number(double value) { return (value > 0.0 ? "+" : "") + text::number(value, 4); }

/// Proves the loaded program with other tables, and goes on with `then`.
Work prove_and(Resident& resident, Resident::Proof proof, Finish then) {
  auto proven = std::make_shared<Resident::Proof>(std::move(proof));
  Work work;
  work.what = "check", work.name = proven->programs.front().file->path;
  work.run = [&resident, proven, then = std::move(then)](const std::stop_token& stop) -> Finish {
    resident.prove(*proven, stop);
    return [&resident, proven, then]() -> Outcome {
      resident.proven(*proven);
      return then();
    };
  };
  return work;
}

/// Writes what has been learned, then answers.
Work save_and(Resident& resident, Reply done, text::Language language) {
  const auto problem = std::make_shared<std::string>();
  Work work;
  work.what = "save", work.bench = Work::Bench::files;
  work.run = [&resident, saved = resident.to_save(), problem, done = std::move(done),
              language](const std::stop_token&) -> Finish {
    *problem = resident.write(saved);
    return [problem, done, language]() -> Outcome {
      return problem->empty() ? done : refuse(says::kNotSaved, {*problem}, kInfrastructure, language);
    };
  };
  return work;
}

class Dispatch {
 public:
  Dispatch(Resident& resident, PlcDesk& plc, const Question& question)
      : resident_(resident), plc_(plc), question_(question), language_(question.caller.language) {}

  Outcome run();
  Outcome loaded(Resident::Load& load, const ask::Load& wanted);

 private:
  /// An accepted request.
  template <typename Content = std::monostate>
  Reply good(const text::Entry& entry, const std::vector<std::string>& arguments = {},
             Content content = {}) const {
    return accept(entry, arguments, language_, std::move(content));
  }
  Reply fail(const text::Entry& entry, const std::vector<std::string>& arguments, int exit) const {
    return refuse(entry, arguments, exit, language_);
  }

  /// Puts a request to the gate. True: accepted; otherwise `refusal_` holds the answer.
  /// `mode`: the mode that belongs to it; a refused request leaves the process in the one it was in.
  /// `process`: -1: that of the axis, the first where there is none.
  bool ask(image::Request request);
  bool ask(RequestKind kind, int axis = -1, double value = 0.0, std::optional<image::Mode> mode = {},
           int process = -1);
  /// Index of an axis; -1: `refusal_` holds the answer.
  int axis(const std::string& letter);
  /// The machine has it; false: `refusal_` holds the answer.
  bool process_known(int process);
  int process_of(int axis) { return resident_.image().axes[static_cast<std::size_t>(axis)].process; }
  bool unit_is_own(int axis, const std::string& said);
  /// The same request once more, behind the proof of the loaded program with the tables as they are now.
  Outcome behind(Resident::Proof proof);

  // One for each kind of question.
  Outcome take(const ask::Status&) { return looked(status_report(resident_, plc_, language_)); }
  Outcome take(const ask::Buses&) { return looked(held_buses(machine(), resident_.image(), false)); }
  Outcome take(const ask::Alarms&) { return looked(alarm_report(resident_, language_)); }
  Outcome take(const ask::History& wanted) {
    const double most = history::EventLog::kRemembered;
    const auto count = static_cast<std::size_t>(std::clamp(wanted.count, 0.0, most));
    return looked(history_report(resident_.history(), count, language_));
  }
  Outcome take(const ask::SdoRead& wanted) { return sdo_read(resident_.control(), wanted, language_); }
  Outcome take(const ask::Power&);
  Outcome take(const ask::Home&);
  Outcome take(const ask::Jog&);
  Outcome take(const ask::JogContinuous&);
  Outcome take(const ask::Zero&);
  Outcome take(const ask::Override&);
  Outcome take(const ask::Load&);
  Outcome take(const ask::Start& wanted) { return begin(false, wanted.process); }
  Outcome take(const ask::Step& wanted) { return begin(true, wanted.process); }
  Outcome take(const ask::Mdi&);
  Outcome take(const ask::Resume&);
  Outcome take(const ask::Assign&);
  Outcome take(const ask::Reset&) { return reset(true); }
  Outcome take(const ask::Acknowledge&) { return reset(false); }
  Outcome take(const ask::Input&);
  Outcome take(const ask::SetPlace&);

  template <typename Content>
  static Reply looked(Content content) {
    Reply reply;
    reply.content = std::move(content);
    return reply;
  }
  std::string with_findings(const text::Entry& entry, const std::string& program,
                            const std::vector<text::Finding>& findings) const;
  /// What the gate would say: a program is under way.
  Reply busy(int process) const {
    const auto why =
        resident_.stopping(process) ? cycle::Refusal::program_stopping : cycle::Refusal::program_runs;
    return fail(cycle::refusal_texts()[static_cast<std::size_t>(why)], {}, kAlarm);
  }
  Outcome begin(bool step, int process);
  Outcome reset(bool whole);
  /// To the answer "not powered": each condition that is missing.
  void add_missing(Reply& answer);
  const machine::MachineConfig& machine() const { return resident_.control().machine(); }
  const machine::AxisConfig& axis_config(int index) const {
    return machine().axes[static_cast<std::size_t>(index)];
  }

  Resident& resident_;
  PlcDesk& plc_;
  const Question& question_;
  text::Language language_;
  Reply refusal_;
};

Outcome Dispatch::run() {
  const ask::Command& command = question_.command;
  if (resident_.ending() && !ask::only_looks(command)) return fail(says::kEnding, {}, kAlarm);
  if (ask::of_plc(command)) return plc_.carry_out(command, question_.caller);
  return std::visit(
      [this](const auto& wanted) -> Outcome {
        if constexpr (requires { this->take(wanted); })
          return take(wanted);
        else
          return fail(says::kUnknown, {}, kWrongUse);  // urgent ones do not come here
      },
      command);
}

bool Dispatch::ask(RequestKind kind, int axis, double value, std::optional<image::Mode> mode, int process) {
  image::Request r;
  r.kind = kind;
  r.axis = static_cast<std::int8_t>(axis);
  r.process = static_cast<std::int8_t>(process >= 0 ? process : axis >= 0 ? process_of(axis) : 0);
  r.value = value;
  if (mode) r.mode = static_cast<std::int8_t>(*mode);
  return ask(r);
}

bool Dispatch::ask(image::Request r) {
  r.asker = question_.caller.asker;
  r.client = question_.caller.hand().client;
  image::Answer answer;
  switch (resident_.ask(r, answer, question_.asked())) {
    case RequestDesk::Outcome::silent:
      refusal_ = fail(says::kWithdrawn, {}, kInfrastructure);
      return false;
    case RequestDesk::Outcome::taken:
      refusal_ = fail(says::kLeftToCycle, {}, kInfrastructure);
      return false;
    case RequestDesk::Outcome::overtaken:
      refusal_ = fail(says::kOvertaken, {}, kAlarm);
      return false;
    case RequestDesk::Outcome::answered:
      break;
  }
  if (answer.refusal == 0) return true;
  refusal_ = refused_by_gate(answer, machine(), language_);
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  if (refusal == cycle::Refusal::not_powered || refusal == cycle::Refusal::emergency_stop)
    add_missing(refusal_);
  return false;
}

void Dispatch::add_missing(Reply& answer) {
  answer.missing = missing_now(resident_, language_);
  // The control has not looked at them yet, or they came on since the gate refused.
  if (answer.missing->empty()) answer.text += "\n  " + text::render(says::kComesOn, {}, language_);
  for (const MissingCondition& m : *answer.missing) answer.text += "\n  " + m.text + "\n    " + m.remedy;
}

int Dispatch::axis(const std::string& letter) {
  FormProblem problem;
  const int index = axis_of(machine(), letter, problem);
  if (index < 0) refusal_ = fail(*problem.entry, problem.arguments, kWrongUse);
  return index;
}

bool Dispatch::process_known(int process) {
  if (process >= 0 && process < resident_.processes()) return true;
  image::Answer answer;
  answer.refusal = static_cast<std::uint16_t>(cycle::Refusal::no_such_process);
  answer.value = process;
  refusal_ = refused_by_gate(answer, machine(), language_);
  return false;
}

bool Dispatch::unit_is_own(int axis, const std::string& said) {
  const machine::AxisConfig& a = axis_config(axis);
  if (said.empty() || said == a.unit()) return true;
  refusal_ = fail(says::kNotUnit, {said, a.letter, text::unit_words(a.unit())}, kWrongUse);
  return false;
}

Outcome Dispatch::take(const ask::Power&) {
  return ask(RequestKind::power, -1, 1.0) ? good(says::kPowerOn) : refusal_;  // off is urgent
}

Outcome Dispatch::take(const ask::Home& wanted) {
  std::uint32_t mask = 0;
  int process = -1;
  std::string names;
  for (const std::string& letter : wanted.axes) {
    const int index = axis(letter);
    if (index < 0) return refusal_;
    const std::uint32_t bit = 1u << index;
    if ((mask & bit) != 0) continue;
    mask |= bit;
    if (process < 0) process = process_of(index);
    names += (names.empty() ? "" : ", ") + axis_config(index).letter;
  }
  if (!ask(RequestKind::home, -1, mask, image::Mode::home, process)) return refusal_;
  return mask == 0 ? good(says::kHomingAll) : good(says::kHoming, {names});
}

Outcome Dispatch::take(const ask::Jog& wanted) {
  const double value = wanted.value;
  const int index = axis(wanted.axis);
  if (index < 0 || !unit_is_own(index, wanted.unit)) return refusal_;
  const machine::AxisConfig& a = axis_config(index);
  const double distance = a.diameter ? value / 2.0 : value;
  if (distance == 0.0) return fail(says::kNoDistance, {a.letter}, kWrongUse);
  const image::AxisImage& before = resident_.image().axes[static_cast<std::size_t>(index)];
  const double target = before.command + before.distance_to_go + distance;
  if (!ask(RequestKind::jog_increment, index, distance, image::Mode::manual)) return refusal_;
  const bool homed = resident_.image().axes[static_cast<std::size_t>(index)].homed;
  const double limit = std::clamp(target, a.travel_min, a.travel_max);
  if (homed && !a.endless() && std::abs(limit - target) > 1e-9)
    return good(says::kJogClipped,
                {a.letter, text::number(limit * (a.diameter ? 2.0 : 1.0), 4), text::unit_words(a.unit())});
  if (a.diameter) return good(says::kJogDiameter, {a.letter, signed_number(value), signed_number(distance)});
  return good(says::kJog, {a.letter, signed_number(value), text::unit_words(a.unit())});
}

Outcome Dispatch::take(const ask::JogContinuous& wanted) {
  const int index = axis(wanted.axis);
  if (index < 0 || !ask(RequestKind::jog_continuous, index, wanted.value, image::Mode::manual))
    return refusal_;
  return good(says::kJogs, {axis_config(index).letter, wanted.value > 0.0 ? "+" : "-"},
              JogBegun{index, question_.caller.hand(), kKeepAlive_ms});
}

Outcome Dispatch::behind(Resident::Proof proof) {
  Resident& resident = resident_;
  return prove_and(resident, std::move(proof), [&resident, &plc = plc_, question = question_] {
    return dispatch(resident, plc, question);
  });
}

Outcome Dispatch::take(const ask::Zero& wanted) {
  const double value = wanted.value;
  const int index = axis(wanted.axis);
  if (index < 0 || !unit_is_own(index, wanted.unit)) return refusal_;
  if (!ask(RequestKind::zero, index, value)) return refusal_;
  const Zeroed zeroed = resident_.zero(index, value);
  const machine::AxisConfig& a = axis_config(index);
  const Reply done = good(a.diameter ? says::kZeroDiameter : says::kZero,
                          {a.letter, text::number(value, 4), text::unit_words(a.unit()),
                           std::to_string(zeroed.origin), text::number(zeroed.place, 4)},
                          zeroed);
  // Nobody is told before the loaded program goes by it, and it lies on the disk.
  Resident& resident = resident_;
  const Finish save = [&resident, done, language = language_] { return save_and(resident, done, language); };
  if (auto proof = resident.renew_tables()) return prove_and(resident, std::move(*proof), save);
  return save();
}

Outcome Dispatch::take(const ask::Override& wanted) {
  if (!ask(RequestKind::override_feed, -1, wanted.percent / 100.0, {}, wanted.process)) return refusal_;
  return good(says::kOverride, {text::number(wanted.percent, 1)});
}

/// A sentence about a program, and what is wrong with it below.
std::string Dispatch::with_findings(const text::Entry& entry, const std::string& program,
                                    const std::vector<text::Finding>& findings) const {
  std::string words = text::render(entry, std::vector<std::string>{program}, language_);
  for (std::size_t i = 0; i < findings.size() && i < kFindingsSaid; ++i)
    words += "\n" + findings[i].str(language_);
  if (findings.size() > kFindingsSaid)
    words += "\n" + text::render(says::kMoreFindings,
                                 std::vector<std::string>{std::to_string(findings.size() - kFindingsSaid)},
                                 language_);
  return words;
}

Outcome Dispatch::take(const ask::Load& wanted) {
  const std::string& program = wanted.program;
  if (!process_known(wanted.process)) return refusal_;
  if (resident_.busy(wanted.process)) {  // first of all what no waiting would mend
    const std::string why = files::why_unreadable(program);
    return why.empty() ? busy(wanted.process) : fail(says::kNotReadable, {program, why}, kWrongUse);
  }
  resident_.read_tables();
  const auto load =
      std::make_shared<Resident::Load>(resident_.begin_load(wanted.process, program, wanted.dialect));
  Resident& resident = resident_;
  Work work;
  work.what = "load", work.name = load->path;
  work.run = [&resident, &plc = plc_, load, question = question_](const std::stop_token& stop) -> Finish {
    resident.read_and_prove(*load, stop);
    return [&resident, &plc, load, question]() -> Outcome {
      return Dispatch(resident, plc, question).loaded(*load, std::get<ask::Load>(question.command));
    };
  };
  return work;
}

Outcome Dispatch::loaded(Resident::Load& load, const ask::Load& wanted) {
  using End = Resident::Load::End;
  const End end = resident_.busy(load.process) ? End::busy : resident_.finish(load);
  if (end == End::busy) return busy(load.process);
  if (end == End::other_tables) return take(wanted);  // the machine has changed them meanwhile
  FoundIn found{load.findings};
  if (end == End::done)
    return good(
        says::kLoaded,
        {load.path, std::to_string(resident_.blocks(load.process)), std::to_string(load.findings.size())},
        std::move(found));
  Reply refused = fail(says::kNotLoaded, {load.path}, end == End::not_opened ? kWrongUse : kAlarm);
  refused.text = with_findings(says::kNotLoaded, load.path, load.findings);
  refused.content = std::move(found);
  return refused;
}

Outcome Dispatch::begin(bool step, int process) {
  if (!process_known(process)) return refusal_;
  std::optional<image::Mode> mode;
  const bool typed = resident_.typed(process);
  const std::string program = resident_.program(process);
  if (!typed && !resident_.busy(process)) {
    if (program.empty())
      return fail(cycle::refusal_texts()[static_cast<std::size_t>(cycle::Refusal::no_program)], {}, kAlarm);
    if (auto proof = resident_.take_tables(process)) return behind(std::move(*proof));
    if (const auto& wrong = resident_.refused(process); !wrong.empty()) {
      Reply refused = fail(says::kNotStarted, {program}, kAlarm);
      refused.text = with_findings(says::kNotStarted, program, wrong);
      return refused;
    }
    mode = step ? image::Mode::step : image::Mode::automatic;
  } else if (!typed && !step && resident_.steps(process)) {
    mode = image::Mode::automatic;
  }
  // A wait that began before belongs to the block before.
  const Begun asked{resident_.image().now.seconds()};
  if (!ask(step ? RequestKind::step : RequestKind::start, -1, 0.0, mode, process)) return refusal_;
  if (typed) return good(says::kTypedGoesOn, {resident_.manual_block(process)}, asked);
  return step ? good(says::kStepped, {}, asked) : good(says::kStarted, {program}, asked);
}

Outcome Dispatch::take(const ask::Mdi& wanted) {
  const std::string& block = wanted.block;
  if (block.find_first_not_of(" \t") == std::string::npos) return fail(says::kBlockEmpty, {}, kWrongUse);
  if (block.find_first_of("\r\n") != std::string::npos) return fail(says::kBlocksSeveral, {}, kWrongUse);
  const int process = wanted.process;
  if (!process_known(process)) return refusal_;
  if (resident_.busy(process)) return busy(process);
  if (auto proof = resident_.take_tables(process)) return behind(std::move(*proof));
  const std::vector<text::Finding> findings = resident_.check_block(process, block);
  if (!findings.empty() && findings.back().severity == text::Severity::error)
    return fail(says::kBlockWrong, {findings.back().str(language_)}, kAlarm);
  resident_.set_manual_block(process, block);
  if (ask(RequestKind::start, -1, 0.0, image::Mode::mdi, process)) {
    std::string words;
    for (const text::Finding& f : findings) words += "\n" + f.str(language_);
    return good(says::kBlockRuns, {words}, FoundIn{findings});
  }
  resident_.set_manual_block(process, {});  // a start button must not find it later
  return refusal_;
}

Outcome Dispatch::take(const ask::Resume& wanted) {
  if (!process_known(wanted.process)) return refusal_;
  const bool typed = resident_.typed(wanted.process);
  if (!ask(RequestKind::resume, -1, 0.0, {}, wanted.process)) return refusal_;
  return typed ? good(says::kTypedGoesOn, {resident_.manual_block(wanted.process)}) : good(says::kResumed);
}

/// What was proven of loaded programs holds for the axes that they had.
Outcome Dispatch::take(const ask::Assign& wanted) {
  const int index = axis(wanted.axis);
  if (index < 0 || !process_known(wanted.process)) return refusal_;
  if (!ask(RequestKind::assign, index, 0.0, {}, wanted.process)) return refusal_;
  const Reply done = good(says::kAssigned, {axis_config(index).letter, std::to_string(wanted.process + 1)});
  auto proof = resident_.renew_axes();
  if (!proof) return done;
  return prove_and(resident_, std::move(*proof), [done]() -> Outcome { return done; });
}

Outcome Dispatch::reset(bool whole) {
  if (!ask(whole ? RequestKind::reset : RequestKind::acknowledge)) return refusal_;
  const std::string left = alarms_in_words(resident_, language_);
  const Reply done = left.empty() ? good(says::kReset) : good(says::kResetLeft, {left});
  if (!whole || resident_.busy()) return done;
  resident_.read_tables();
  auto proof = resident_.renew_tables();
  resident_.forget_modes();
  if (!proof) return done;
  return prove_and(resident_, std::move(*proof), [done]() -> Outcome { return done; });
}

Outcome Dispatch::take(const ask::Input& wanted) {
  const PlayedInput played = play_input(machine(), resident_.control().world(), wanted.point, wanted.value);
  if (played.outcome == PlayedInput::Outcome::done) return good(*played.entry, played.arguments);
  return fail(*played.entry, played.arguments,
              played.outcome == PlayedInput::Outcome::wrong ? kWrongUse : kAlarm);
}

Outcome Dispatch::take(const ask::SetPlace& wanted) {
  const auto place = image::parse_place(wanted.place);
  if (!place || place->packet != image::Packet::k) return fail(says::kNoPlace, {wanted.place}, kWrongUse);
  image::Request r;
  r.kind = RequestKind::set_place;
  r.packet = static_cast<std::uint8_t>(place->packet);
  r.format = static_cast<std::uint8_t>(place->format);
  r.index = place->index;
  r.length = static_cast<std::uint8_t>(place->length);
  r.value = wanted.value;
  return ask(r) ? good(says::kPlaceSet, {wanted.place, text::number(wanted.value)}) : refusal_;
}

}  // namespace

Outcome dispatch(Resident& resident, PlcDesk& plc, const Question& question) {
  return Dispatch(resident, plc, question).run();
}

}  // namespace servogate::gateway
