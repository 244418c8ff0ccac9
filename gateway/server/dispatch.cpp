// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/dispatch.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware_if/text/units.hpp"
#include "gateway/compose/simulated/played_input.hpp"
#include "gateway/files/read_file.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/server/bus_reading.hpp"
#include "gateway/server/desk/refusal.hpp"
#include "gateway/server/request/request_form.hpp"
#include "gateway/server/status.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

namespace {

using image::RequestKind;
using nlohmann::json;

constexpr double kKeepAlive_ms = 30.0;  ///< of the wall clock, between two keep-alives of a jog

constexpr double kHistory = 100.0;         ///< events, where a client does not say how many
constexpr std::size_t kFindingsSaid = 10;  ///< of a bad program; all of them stand in the answer's "findings"

std::string signed_number(double value) { return (value > 0.0 ? "+" : "") + text::number(value, 4); }

/// Proves the loaded program with other tables, and goes on with `then`.
Work prove_and(Resident& resident, Resident::Proof proof, Finish then) {
  auto proven = std::make_shared<Resident::Proof>(std::move(proof));
  Work work;
  work.what = "check", work.name = resident.program();
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
  Dispatch(Resident& resident, const Line& line)
      : resident_(resident),
        line_(line),
        request_(line.request),
        asker_(line.caller.asker),
        language_(line.caller.language) {}

  Outcome run();

 private:
  using Handler = Outcome (Dispatch::*)();
  struct Row {
    std::string_view name;
    Handler handler;
  };
  static const Row kRows[];

  /// An accepted request; `more` is added to the answer.
  Reply good(const text::Entry& entry, const std::vector<std::string>& arguments = {},
             json more = json::object()) const {
    return accept(entry, arguments, language_, std::move(more));
  }
  Reply fail(const text::Entry& entry, const std::vector<std::string>& arguments, int exit) const {
    return refuse(entry, arguments, exit, language_);
  }

  /// Puts a request to the gate. True: accepted; otherwise `refusal_` holds the answer.
  /// `mode`: the mode that belongs to it; a refused request leaves the machine in the one it was in.
  bool ask(RequestKind kind, int axis = -1, double value = 0.0, std::optional<image::Mode> mode = {});
  /// Index of the axis that `name` says; -1: `refusal_` holds the answer.
  int axis(const json& name);
  /// A number of the request; false: `refusal_` holds the answer.
  bool number(const char* key, double& value, bool needed);
  bool unit_is_own(int axis);
  /// The same request once more, behind the proof of the loaded program with the tables as they are now.
  Outcome behind(Resident::Proof proof);

  Outcome status() { return Reply{status_json(resident_, language_)}; }
  Outcome buses() { return Reply{held_buses_json(machine(), resident_.image(), false)}; }
  Outcome alarms() { return Reply{alarms_json(resident_, language_)}; }
  Outcome history();
  Outcome power();
  Outcome home();
  Outcome jog();
  Outcome jog_continuous();
  Outcome zero();
  Outcome override_feed();
  Outcome load();
  Outcome loaded(Resident::Load& load);
  std::string with_findings(const text::Entry& entry, const std::string& program,
                            const std::vector<text::Finding>& findings) const;
  /// What the gate would say: a program is under way.
  Reply busy() const {
    const auto why = resident_.stopping() ? cycle::Refusal::program_stopping : cycle::Refusal::program_runs;
    return fail(cycle::refusal_texts()[static_cast<std::size_t>(why)], {}, kAlarm);
  }
  Outcome start() { return begin(false); }
  Outcome step() { return begin(true); }
  Outcome begin(bool step);
  Outcome mdi();
  Outcome resume();
  Outcome reset();
  Outcome input();
  Outcome sdo_read() { return gateway::sdo_read(resident_.control(), request_, language_); }
  /// The answer to "not powered", with each condition that is missing.
  void add_missing(json& answer);
  const machine::MachineConfig& machine() const { return resident_.control().machine(); }
  const machine::AxisConfig& axis_config(int index) const {
    return machine().axes[static_cast<std::size_t>(index)];
  }

  Resident& resident_;
  const Line& line_;
  const json& request_;
  image::Asker asker_;
  text::Language language_;
  Reply refusal_;
};

const Dispatch::Row Dispatch::kRows[] = {
    {"status", &Dispatch::status},     {"buses", &Dispatch::buses},
    {"alarms", &Dispatch::alarms},     {"history", &Dispatch::history},
    {"power", &Dispatch::power},       {"home", &Dispatch::home},
    {"jog", &Dispatch::jog},           {"jog_continuous", &Dispatch::jog_continuous},
    {"zero", &Dispatch::zero},         {"override", &Dispatch::override_feed},
    {"load", &Dispatch::load},         {"start", &Dispatch::start},
    {"step", &Dispatch::step},         {"mdi", &Dispatch::mdi},
    {"resume", &Dispatch::resume},     {"reset", &Dispatch::reset},
    {"acknowledge", &Dispatch::reset}, {"input", &Dispatch::input},
    {"sdo_read", &Dispatch::sdo_read}};

/// What a control still does for its clients while it comes to its end; stops have a road of their own.
bool only_looks(std::string_view command) {
  static constexpr std::string_view kWords[] = {"status",   "buses",    "alarms",    "history",
                                                "sdo_read", "plc_list", "plc_watch", "plc_go"};
  return std::find(std::begin(kWords), std::end(kWords), command) != std::end(kWords);
}

Outcome Dispatch::run() {
  const std::string command = request_.value("cmd", "");
  if (resident_.ending() && !only_looks(command)) return fail(says::kEnding, {}, kAlarm);
  for (const Row& row : kRows)
    if (row.name == command) return (this->*row.handler)();
  if (command.starts_with("plc_")) return resident_.plc().carry_out(request_, line_.caller);
  return fail(says::kUnknown, {command}, kWrongUse);
}

Outcome Dispatch::history() {
  double count = kHistory;
  if (!number("count", count, false)) return refusal_;
  const double most = history::EventLog::kRemembered;
  return Reply{
      history_json(resident_.history(), static_cast<std::size_t>(std::clamp(count, 0.0, most)), language_)};
}

bool Dispatch::ask(RequestKind kind, int axis, double value, std::optional<image::Mode> mode) {
  image::Request r;
  r.asker = asker_;
  r.kind = kind;
  r.axis = static_cast<std::int8_t>(axis);
  r.value = value;
  r.client = line_.caller.hand().client;
  if (mode) r.mode = static_cast<std::int8_t>(*mode);
  image::Answer answer;
  switch (resident_.ask(r, answer, line_.asked_at)) {
    case RequestDesk::Outcome::silent:
      refusal_ = fail(says::kNoAnswer, {}, kInfrastructure);
      return false;
    case RequestDesk::Outcome::overtaken:
      refusal_ = fail(says::kOvertaken, {}, kAlarm);
      return false;
    case RequestDesk::Outcome::answered:
      break;
  }
  if (answer.refusal == 0) return true;
  json refused = refusal_json(answer, machine(), language_);
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  if (refusal == cycle::Refusal::not_powered || refusal == cycle::Refusal::emergency_stop)
    add_missing(refused);
  refusal_ = {text_of(refused)};
  return false;
}

void Dispatch::add_missing(json& answer) {
  answer["missing"] = missing_json(resident_, language_);
  std::string words = answer["text"];
  // The control has not looked at them yet, or they came on since the gate refused.
  if (answer["missing"].empty()) words += "\n  " + text::render(says::kComesOn, {}, language_);
  for (const json& m : answer["missing"])
    words += "\n  " + m["text"].get<std::string>() + "\n    " + m["remedy"].get<std::string>();
  answer["text"] = words;
}

int Dispatch::axis(const json& name) {
  FormProblem problem;
  const int index = axis_of(machine(), name, problem);
  if (index < 0) refusal_ = fail(*problem.entry, problem.arguments, kWrongUse);
  return index;
}

bool Dispatch::number(const char* key, double& value, bool needed) {
  if (request_.contains(key) && request_[key].is_number()) {
    value = request_[key].get<double>();
    return true;
  }
  if (!request_.contains(key) && !needed) return true;
  refusal_ = fail(says::kNoNumber, {key}, kWrongUse);
  return false;
}

bool Dispatch::unit_is_own(int axis) {
  const machine::AxisConfig& a = axis_config(axis);
  const std::string said = request_.value("unit", "");
  if (said.empty() || said == a.unit()) return true;
  refusal_ = fail(says::kNotUnit, {said, a.letter, text::unit_words(a.unit())}, kWrongUse);
  return false;
}

Outcome Dispatch::power() {
  double value = 0.0;
  if (!number("value", value, true)) return refusal_;
  if (value != 0.0 && value != 1.0) return fail(says::kNotSwitch, {"value"}, kWrongUse);
  return ask(RequestKind::power, -1, value) ? good(says::kPowerOn) : refusal_;
}

Outcome Dispatch::home() {
  const json axes = request_.value("axes", json::array());
  std::uint32_t mask = 0;
  std::string names;
  for (const json& name : axes) {
    const int index = axis(name);
    if (index < 0) return refusal_;
    const std::uint32_t bit = 1u << index;
    if ((mask & bit) != 0) continue;
    mask |= bit;
    names += (names.empty() ? "" : ", ") + axis_config(index).letter;
  }
  if (!ask(RequestKind::home, -1, mask, image::Mode::home)) return refusal_;
  return mask == 0 ? good(says::kHomingAll) : good(says::kHoming, {names});
}

Outcome Dispatch::jog() {
  double value = 0.0;
  const int index = axis(request_.value("axis", json()));
  if (index < 0 || !unit_is_own(index) || !number("value", value, true)) return refusal_;
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

Outcome Dispatch::jog_continuous() {
  double value = 0.0;
  const int index = axis(request_.value("axis", json()));
  if (index < 0 || !number("value", value, true)) return refusal_;
  if (!ask(RequestKind::jog_continuous, index, value, image::Mode::manual)) return refusal_;
  Reply reply = good(says::kJogs, {axis_config(index).letter, value > 0.0 ? "+" : "-"},
                     {{"keep_alive_ms", kKeepAlive_ms}});
  reply.jog = HeldJog{index, line_.caller.hand(), std::chrono::steady_clock::now(), {}, false};
  return reply;
}

Outcome Dispatch::behind(Resident::Proof proof) {
  Resident& resident = resident_;
  return prove_and(resident, std::move(proof),
                   [&resident, line = line_] { return dispatch(resident, line); });
}

Outcome Dispatch::zero() {
  double value = 0.0;
  const int index = axis(request_.value("axis", json()));
  if (index < 0 || !unit_is_own(index) || !number("value", value, false)) return refusal_;
  if (!ask(RequestKind::zero, index, value)) return refusal_;
  const Resident::Zeroed zeroed = resident_.zero(index, value);
  const machine::AxisConfig& a = axis_config(index);
  const Reply done = good(a.diameter ? says::kZeroDiameter : says::kZero,
                          {a.letter, text::number(value, 4), text::unit_words(a.unit()),
                           std::to_string(zeroed.origin), text::number(zeroed.place, 4)},
                          {{"origin", zeroed.origin}, {"place", zeroed.place}});
  // Nobody is told before the loaded program goes by it, and it lies on the disk.
  Resident& resident = resident_;
  const Finish save = [&resident, done, language = language_] { return save_and(resident, done, language); };
  if (auto proof = resident.renew_tables()) return prove_and(resident, std::move(*proof), save);
  return save();
}

Outcome Dispatch::override_feed() {
  double value = 0.0;
  if (!number("value", value, true) || !ask(RequestKind::override_feed, -1, value / 100.0)) return refusal_;
  return good(says::kOverride, {text::number(value, 1)});
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

Outcome Dispatch::load() {
  const std::string program = request_.value("program", "");
  if (resident_.busy()) {  // first of all what no waiting would mend
    const std::string why = files::why_unreadable(program);
    return why.empty() ? busy() : fail(says::kNotReadable, {program, why}, kWrongUse);
  }
  resident_.read_tables();
  const auto load =
      std::make_shared<Resident::Load>(resident_.begin_load(program, request_.value("dialect", "")));
  Resident& resident = resident_;
  Work work;
  work.what = "load", work.name = load->path;
  work.run = [&resident, load, line = line_](const std::stop_token& stop) -> Finish {
    resident.read_and_prove(*load, stop);
    return [&resident, load, line]() -> Outcome { return Dispatch(resident, line).loaded(*load); };
  };
  return work;
}

Outcome Dispatch::loaded(Resident::Load& load) {
  using End = Resident::Load::End;
  const End end = resident_.busy() ? End::busy : resident_.finish(load);
  if (end == End::busy) return busy();
  if (end == End::other_tables) return this->load();  // the machine has changed them meanwhile
  json more{{"findings", json::parse(machine::to_json(load.findings), nullptr, false)}};
  if (end == End::done)
    return good(says::kLoaded,
                {load.path, std::to_string(resident_.blocks()), std::to_string(load.findings.size())}, more);
  const std::string words = with_findings(says::kNotLoaded, load.path, load.findings);
  const int exit = end == End::not_opened ? kWrongUse : kAlarm;
  more.update({{"ok", false}, {"exit", exit}, {"code", says::kNotLoaded.id}, {"text", words}});
  return Reply{text_of(more)};
}

Outcome Dispatch::begin(bool step) {
  std::optional<image::Mode> mode;
  const bool typed = resident_.typed();
  if (!typed && !resident_.busy()) {
    if (resident_.program().empty())
      return fail(cycle::refusal_texts()[static_cast<std::size_t>(cycle::Refusal::no_program)], {}, kAlarm);
    if (auto proof = resident_.take_tables()) return behind(std::move(*proof));
    if (const auto& wrong = resident_.refused(); !wrong.empty())
      return Reply{text_of({{"ok", false},
                            {"code", says::kNotStarted.id},
                            {"text", with_findings(says::kNotStarted, resident_.program(), wrong)},
                            {"exit", kAlarm}})};
    mode = step ? image::Mode::step : image::Mode::automatic;
  } else if (!typed && !step && resident_.steps()) {
    mode = image::Mode::automatic;
  }
  // A wait that began before belongs to the block before.
  const json asked{{"asked_s", resident_.image().now.seconds()}};
  if (!ask(step ? RequestKind::step : RequestKind::start, -1, 0.0, mode)) return refusal_;
  if (typed) return good(says::kTypedGoesOn, {resident_.manual_block()}, asked);
  return step ? good(says::kStepped, {}, asked) : good(says::kStarted, {resident_.program()}, asked);
}

Outcome Dispatch::mdi() {
  const std::string block = request_.value("block", "");
  if (block.find_first_not_of(" \t") == std::string::npos) return fail(says::kBlockEmpty, {}, kWrongUse);
  if (block.find_first_of("\r\n") != std::string::npos) return fail(says::kBlocksSeveral, {}, kWrongUse);
  if (resident_.busy()) return busy();
  if (auto proof = resident_.take_tables()) return behind(std::move(*proof));
  const std::vector<text::Finding> findings = resident_.check_block(block);
  if (!findings.empty() && findings.back().severity == text::Severity::error)
    return fail(says::kBlockWrong, {findings.back().str(language_)}, kAlarm);
  resident_.set_manual_block(block);
  if (ask(RequestKind::start, -1, 0.0, image::Mode::mdi)) {
    std::string words;
    for (const text::Finding& f : findings) words += "\n" + f.str(language_);
    return good(says::kBlockRuns, {words},
                {{"findings", json::parse(machine::to_json(findings), nullptr, false)}});
  }
  resident_.set_manual_block({});  // a start button must not find it later
  return refusal_;
}

Outcome Dispatch::resume() {
  const bool typed = resident_.typed();
  if (!ask(RequestKind::resume)) return refusal_;
  return typed ? good(says::kTypedGoesOn, {resident_.manual_block()}) : good(says::kResumed);
}

Outcome Dispatch::reset() {
  const bool whole = request_.value("cmd", "") == "reset";
  if (!ask(whole ? RequestKind::reset : RequestKind::acknowledge)) return refusal_;
  const std::string left = alarms_in_words(resident_, language_);
  const Reply done = left.empty() ? good(says::kReset) : good(says::kResetLeft, {left});
  if (!whole || resident_.busy()) return done;
  auto proof = resident_.take_tables();
  resident_.forget_modes();
  if (!proof) return done;
  return prove_and(resident_, std::move(*proof), [done]() -> Outcome { return done; });
}

Outcome Dispatch::input() {
  const json value = request_.value("value", json());
  InputWish wish;
  if (value.is_boolean())
    wish = value.get<bool>();
  else if (value.is_number())
    wish = value.get<double>();
  else if (value != "auto")
    return fail(says::kNoNumber, {"value"}, kWrongUse);
  const PlayedInput played =
      play_input(machine(), resident_.control().world(), request_.value("point", ""), wish);
  if (played.outcome == PlayedInput::Outcome::done) return good(*played.entry, played.arguments);
  return fail(*played.entry, played.arguments,
              played.outcome == PlayedInput::Outcome::wrong ? kWrongUse : kAlarm);
}

}  // namespace

Outcome dispatch(Resident& resident, const Line& line) {
  try {
    return Dispatch(resident, line).run();
  } catch (const json::exception&) {  // no request, whatever it is, ends a control
    return refuse(says::kBadLine, {text_of(line.request).substr(0, 80)}, kWrongUse, line.caller.language);
  }
}

}  // namespace servogate::gateway
