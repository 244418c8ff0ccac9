// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

namespace {

constexpr std::size_t kFindingsSaid = 10;  ///< of a bad program; all of them stand in the answer's "findings"

}  // namespace

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

Outcome Dispatch::behind(Resident::Proof proof) {
  Resident& resident = resident_;
  return prove_and(resident, std::move(proof), [&resident, &plc = plc_, question = question_] {
    return dispatch(resident, plc, question);
  });
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

std::optional<Outcome> Dispatch::not_ready(int process) {
  const std::string program = resident_.program(process);
  if (program.empty())
    return fail(cycle::refusal_texts()[static_cast<std::size_t>(cycle::Refusal::no_program)], {}, kAlarm);
  if (auto proof = resident_.take_tables(process)) return behind(std::move(*proof));
  const auto& wrong = resident_.refused(process);
  if (wrong.empty()) return std::nullopt;
  Reply refused = fail(says::kNotStarted, {program}, kAlarm);
  refused.text = with_findings(says::kNotStarted, program, wrong);
  return refused;
}

Outcome Dispatch::begin(bool step, int process) {
  if (!process_known(process)) return refusal_;
  std::optional<image::Mode> mode;
  const bool typed = resident_.typed(process);
  const std::string program = resident_.program(process);
  if (!typed && !resident_.busy(process)) {
    if (auto why = not_ready(process)) return std::move(*why);
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
  if (resident_.rests(process)) return functions(wanted);
  if (resident_.busy(process)) return busy(process);
  if (auto proof = resident_.take_tables(process)) return behind(std::move(*proof));
  const Resident::TriedBlock tried = resident_.try_block(process, block);
  const std::vector<text::Finding>& findings = tried.findings;
  if (tried.failed()) return fail(says::kBlockWrong, {findings.back().str(language_)}, kAlarm);
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

}  // namespace servogate::gateway
