// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/dispatch.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware_if/text/units.hpp"
#include "gateway/compose/simulated/played_input.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/run/words/jog_words.hpp"
#include "gateway/server/bus_reading.hpp"
#include "gateway/server/request/request_form.hpp"
#include "gateway/server/status.hpp"
#include "gateway/server/texts.hpp"

namespace servogate::gateway {

namespace {

using image::RequestKind;
using nlohmann::json;

constexpr double kKeepAlive_ms = 30.0;  ///< of the wall clock, between two keep-alives of a jog
constexpr std::chrono::milliseconds kSilence{100};

constexpr std::size_t kFindingsSaid = 10;  ///< of a bad program; all of them stand in the answer's "findings"

constexpr struct {
  std::string_view name;
  image::Asker asker;
} kAskers[] = {{"command_line", image::Asker::command_line},
               {"page", image::Asker::page},
               {"pendant", image::Asker::pendant},
               {"scenario", image::Asker::scenario},
               {"modbus", image::Asker::modbus},
               {"bench", image::Asker::bench}};

/// Commands that are one request each, and what is said when it was accepted.
constexpr struct {
  std::string_view name;
  RequestKind kind;
  const text::Entry* said;
} kRequests[] = {{"stop", RequestKind::stop, &says::kStopped},
                 {"quick_stop", RequestKind::quick_stop, &says::kStopped}};

std::string signed_number(double value) { return (value > 0.0 ? "+" : "") + text::number(value, 4); }

class Dispatch {
 public:
  Dispatch(Resident& resident, const json& request, Connection& connection)
      : resident_(resident), request_(request), connection_(connection) {}

  Reply run();

 private:
  using Handler = Reply (Dispatch::*)();
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
  std::vector<std::string> as_people_write(image::Answer& answer) const;
  /// Index of the axis that `name` says; -1: `refusal_` holds the answer.
  int axis(const json& name);
  /// A number of the request; false: `refusal_` holds the answer.
  bool number(const char* key, double& value, bool needed);
  bool unit_is_own(int axis);
  bool read_head();

  Reply status() { return {status_json(resident_, language_)}; }
  Reply buses() { return {held_buses_json(machine(), resident_.image(), false)}; }
  Reply alarms() { return {alarms_json(resident_, language_)}; }
  Reply power();
  Reply home();
  Reply jog();
  Reply jog_continuous();
  Reply keep_alive();
  Reply jog_ended(const HeldJog& jog, image::JogEnd end, bool others) const;
  Reply jog_stop();
  Reply zero();
  Reply override_feed();
  Reply load();
  std::string with_findings(const text::Entry& entry, const std::string& program,
                            const std::vector<text::Finding>& findings) const;
  /// What the gate would say: a program is under way.
  Reply busy() const {
    const auto why = resident_.stopping() ? cycle::Refusal::program_stopping : cycle::Refusal::program_runs;
    return fail(cycle::refusal_texts()[static_cast<std::size_t>(why)], {}, kAlarm);
  }
  Reply start() { return begin(false); }
  Reply step() { return begin(true); }
  Reply begin(bool step);
  Reply mdi();
  Reply hold();
  Reply resume();
  Reply reset();
  Reply input();
  Reply sdo_read() { return gateway::sdo_read(resident_.control(), request_, language_); }
  /// The answer to "not powered", with each condition that is missing.
  void add_missing(json& answer);
  /// What the request plays on a point; false: `refusal_` holds the answer.
  Reply down() {
    resident_.set_ending();  // nothing begins behind the answer
    Reply reply = good(says::kDown);
    reply.down = true;
    return reply;
  }

  const machine::MachineConfig& machine() const { return resident_.control().machine(); }
  const machine::AxisConfig& axis_config(int index) const {
    return machine().axes[static_cast<std::size_t>(index)];
  }

  Resident& resident_;
  const json& request_;
  Connection& connection_;
  image::Asker asker_ = image::Asker::command_line;
  text::Language language_ = text::user_language();
  Reply refusal_;
};

const Dispatch::Row Dispatch::kRows[] = {{"status", &Dispatch::status},
                                         {"buses", &Dispatch::buses},
                                         {"alarms", &Dispatch::alarms},
                                         {"power", &Dispatch::power},
                                         {"home", &Dispatch::home},
                                         {"jog", &Dispatch::jog},
                                         {"jog_continuous", &Dispatch::jog_continuous},
                                         {"keep_alive", &Dispatch::keep_alive},
                                         {"jog_stop", &Dispatch::jog_stop},
                                         {"zero", &Dispatch::zero},
                                         {"override", &Dispatch::override_feed},
                                         {"load", &Dispatch::load},
                                         {"start", &Dispatch::start},
                                         {"step", &Dispatch::step},
                                         {"mdi", &Dispatch::mdi},
                                         {"hold", &Dispatch::hold},
                                         {"resume", &Dispatch::resume},
                                         {"reset", &Dispatch::reset},
                                         {"acknowledge", &Dispatch::reset},
                                         {"input", &Dispatch::input},
                                         {"sdo_read", &Dispatch::sdo_read},
                                         {"down", &Dispatch::down}};

/// What a control still does for its clients while it comes to its end.
bool looks_or_stops(std::string_view command) {
  static constexpr std::string_view kWords[] = {"status",   "buses",    "alarms",     "down",
                                                "hold",     "stop",     "quick_stop", "jog_stop",
                                                "sdo_read", "plc_list", "plc_watch",  "plc_go"};
  return std::find(std::begin(kWords), std::end(kWords), command) != std::end(kWords);
}

Reply Dispatch::run() {
  if (!read_head()) return refusal_;
  const std::string command = request_.value("cmd", "");
  if (resident_.ending() && !looks_or_stops(command)) return fail(says::kEnding, {}, kAlarm);
  for (const auto& row : kRequests)
    if (row.name == command) return ask(row.kind) ? good(*row.said) : refusal_;
  for (const Row& row : kRows)
    if (row.name == command) return (this->*row.handler)();
  if (command.starts_with("plc_"))
    return {text_of(
        resident_.plc().carry_out(request_, {asker_, connection_.number, connection_.user, language_}))};
  return fail(says::kUnknown, {command}, kWrongUse);
}

bool Dispatch::read_head() {
  language_ = language_of(request_);
  const std::string name = request_.value("asker", "command_line");
  std::string known;
  for (const auto& row : kAskers) {
    if (row.name == name) {
      asker_ = row.asker;
      return true;
    }
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  refusal_ = fail(says::kUnknownAsker, {name, known}, kWrongUse);
  return false;
}

bool Dispatch::ask(RequestKind kind, int axis, double value, std::optional<image::Mode> mode) {
  image::Request r;
  r.asker = asker_;
  r.kind = kind;
  r.axis = static_cast<std::int8_t>(axis);
  r.value = value;
  r.client = static_cast<std::uint32_t>(connection_.number);
  if (mode) r.mode = static_cast<std::int8_t>(*mode);
  image::Answer answer;
  if (!resident_.ask(r, answer)) {
    refusal_ = fail(says::kNoAnswer, {}, kInfrastructure);
    return false;
  }
  if (answer.refusal == 0) return true;
  const std::vector<std::string> units = as_people_write(answer);
  json refused{{"ok", false},
               {"code", cycle::refusal_texts()[answer.refusal].id},
               {"text", cycle::render(answer, machine().letters(), language_, units)},
               {"exit", kAlarm}};
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

/// The cycle knows radii only; of a diameter axis people see the diameter, and are told so. Gives the units
/// of the axes.
std::vector<std::string> Dispatch::as_people_write(image::Answer& answer) const {
  std::vector<std::string> units = machine().unit_words();
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  const bool of_radius = refusal == cycle::Refusal::jog_range || refusal == cycle::Refusal::at_soft_limit;
  const bool of_place = of_radius || refusal == cycle::Refusal::zero_range;
  if (!of_place || answer.axis < 0 || !axis_config(answer.axis).diameter) return units;
  units[static_cast<std::size_t>(answer.axis)] += text::both(" in diameter", " по диаметру");
  if (of_radius) answer.value *= 2.0, answer.limit *= 2.0;
  return units;
}

int Dispatch::axis(const json& name) {
  const std::string letter = name.is_string() ? name.get<std::string>() : "";
  const int index = machine().axis_index(letter);
  if (index >= 0) return index;
  std::string list;
  for (const std::string& l : machine().letters()) list += (list.empty() ? "" : ", ") + l;
  refusal_ = fail(says::kNoAxis, {letter, list}, kWrongUse);
  return -1;
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

Reply Dispatch::power() {
  double value = 0.0;
  if (!number("value", value, true)) return refusal_;
  if (value != 0.0 && value != 1.0) return fail(says::kNotSwitch, {"value"}, kWrongUse);
  if (!ask(RequestKind::power, -1, value)) return refusal_;
  return good(value != 0.0 ? says::kPowerOn : says::kPowerOff);
}

Reply Dispatch::home() {
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

Reply Dispatch::jog() {
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

Reply Dispatch::jog_continuous() {
  double value = 0.0;
  const int index = axis(request_.value("axis", json()));
  if (index < 0 || !number("value", value, true)) return refusal_;
  if (!ask(RequestKind::jog_continuous, index, value, image::Mode::manual)) return refusal_;
  std::erase_if(connection_.jogs, [index](const HeldJog& j) { return j.axis == index; });
  const image::Hand hand{asker_, static_cast<std::uint32_t>(connection_.number)};
  connection_.jogs.push_back({index, hand, false, std::chrono::steady_clock::now()});
  return good(says::kJogs, {axis_config(index).letter, value > 0.0 ? "+" : "-"},
              {{"keep_alive_ms", kKeepAlive_ms}});
}

/// How the jog of this client ended; nullopt: it goes on.
std::optional<image::JogEnd> end_of(const HeldJog& jog, const image::AxisImage& a) {
  if (jog.silent) return image::JogEnd::silent;
  const bool jogs = a.owner == image::AxisOwner::manual && a.hand == jog.hand;
  if (a.hand == jog.hand && a.jog_end != image::JogEnd::none) return a.jog_end;
  return jogs ? std::nullopt : std::optional(image::JogEnd::none);
}

Reply Dispatch::jog_ended(const HeldJog& jog, image::JogEnd end, bool others) const {
  const std::string letter = axis_config(jog.axis).letter;
  return {text_of({{"ok", true},
                   {"exit", kDone},
                   {"moving", others},
                   {"axis", letter},
                   {"reason", jog_end_name(end)},
                   {"code", jog_end_code(end)},
                   {"text", jog_end_words(end, letter, language_)}})};
}

/// Those of this connection only: the dead-man of a jog is its own client's.
Reply Dispatch::keep_alive() {
  int index = -1;
  if (request_.contains("axis") && (index = axis(request_["axis"])) < 0) return refusal_;
  const auto meant = [index](const HeldJog& j) { return index < 0 || j.axis == index; };
  std::vector<HeldJog>& jogs = connection_.jogs;
  if (std::none_of(jogs.begin(), jogs.end(), meant)) return fail(says::kNoJog, {}, kWrongUse);
  const image::ProcessImage& image = resident_.image();
  std::optional<Reply> ended;
  for (std::size_t i = jogs.size(); i-- > 0;) {
    if (!meant(jogs[i])) continue;
    const auto end = end_of(jogs[i], image.axes[static_cast<std::size_t>(jogs[i].axis)]);
    if (!end) {
      jogs[i].heard = std::chrono::steady_clock::now();
      resident_.tell({.asker = jogs[i].hand.asker,
                      .kind = RequestKind::keep_alive,
                      .axis = static_cast<std::int8_t>(jogs[i].axis),
                      .client = jogs[i].hand.client});
    } else if (!ended) {  // one an answer
      const HeldJog jog = jogs[i];
      jogs.erase(jogs.begin() + static_cast<std::ptrdiff_t>(i));
      ended = jog_ended(jog, *end, !jogs.empty());
    }
  }
  return ended ? *ended : Reply{text_of({{"ok", true}, {"exit", kDone}, {"moving", true}})};
}

Reply Dispatch::jog_stop() {
  int index = -1;
  if (request_.contains("axis") && (index = axis(request_["axis"])) < 0) return refusal_;
  std::erase_if(connection_.jogs, [index](const HeldJog& j) { return index < 0 || j.axis == index; });
  return ask(RequestKind::jog_stop, index) ? good(says::kStopped) : refusal_;
}

Reply Dispatch::zero() {
  double value = 0.0;
  const int index = axis(request_.value("axis", json()));
  if (index < 0 || !unit_is_own(index) || !number("value", value, false)) return refusal_;
  if (!ask(RequestKind::zero, index, value)) return refusal_;
  const Resident::Zeroed zeroed = resident_.zero(index, value);
  if (const std::string problem = resident_.save(); !problem.empty())
    return fail(says::kNotSaved, {problem}, kInfrastructure);
  const machine::AxisConfig& a = axis_config(index);
  return good(a.diameter ? says::kZeroDiameter : says::kZero,
              {a.letter, text::number(value, 4), text::unit_words(a.unit()), std::to_string(zeroed.origin),
               text::number(zeroed.place, 4)},
              {{"origin", zeroed.origin}, {"place", zeroed.place}});
}

Reply Dispatch::override_feed() {
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

Reply Dispatch::load() {
  if (resident_.busy()) return busy();
  std::vector<text::Finding> findings;
  const std::string program = request_.value("program", "");
  const Resident::Load loaded = resident_.load(program, request_.value("dialect", ""), findings);
  if (loaded == Resident::Load::busy) return busy();
  json more{{"findings", json::parse(machine::to_json(findings), nullptr, false)}};
  if (loaded == Resident::Load::done)
    return good(says::kLoaded, {program, std::to_string(resident_.blocks()), std::to_string(findings.size())},
                more);
  const std::string words = with_findings(says::kNotLoaded, program, findings);
  const int exit = loaded == Resident::Load::not_opened ? kWrongUse : kAlarm;
  more.update({{"ok", false}, {"exit", exit}, {"code", says::kNotLoaded.id}, {"text", words}});
  return {text_of(more)};
}

Reply Dispatch::begin(bool step) {
  std::optional<image::Mode> mode;
  const bool typed = resident_.typed();
  if (!typed && !resident_.busy()) {
    if (resident_.program().empty())
      return fail(cycle::refusal_texts()[static_cast<std::size_t>(cycle::Refusal::no_program)], {}, kAlarm);
    resident_.take_tables();
    if (const auto& wrong = resident_.refused(); !wrong.empty())
      return {text_of({{"ok", false},
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

Reply Dispatch::mdi() {
  const std::string block = request_.value("block", "");
  if (block.find_first_not_of(" \t") == std::string::npos) return fail(says::kBlockEmpty, {}, kWrongUse);
  if (block.find_first_of("\r\n") != std::string::npos) return fail(says::kBlocksSeveral, {}, kWrongUse);
  if (resident_.busy()) return busy();
  resident_.take_tables();
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

Reply Dispatch::resume() {
  const bool typed = resident_.typed();
  if (!ask(RequestKind::resume)) return refusal_;
  return typed ? good(says::kTypedGoesOn, {resident_.manual_block()}) : good(says::kResumed);
}

Reply Dispatch::hold() {
  const bool busy = resident_.busy();
  const image::ProcessImage& image = resident_.image();
  const auto by_hand = [](const image::AxisImage& a) {
    return a.moving && (a.owner == image::AxisOwner::manual || a.owner == image::AxisOwner::homing);
  };
  const bool jogs =
      image.homing || std::any_of(image.axes.begin(), image.axes.begin() + image.axis_count, by_hand);
  if (!ask(RequestKind::hold)) return refusal_;
  return good(busy ? says::kHeld : jogs ? says::kManualStopped : says::kNothingHeld);
}

Reply Dispatch::reset() {
  const bool whole = request_.value("cmd", "") == "reset";
  if (!ask(whole ? RequestKind::reset : RequestKind::acknowledge)) return refusal_;
  if (whole && !resident_.busy()) resident_.forget_modes();
  const std::string left = alarms_in_words(resident_, language_);
  return left.empty() ? good(says::kReset) : good(says::kResetLeft, {left});
}

Reply Dispatch::input() {
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

Reply dispatch(Resident& resident, std::string_view line, Connection& connection) {
  FormProblem problem;
  const std::optional<json> request = read_request(line, problem);
  if (!request) return refuse(*problem.entry, problem.arguments, kWrongUse, problem.language);
  try {
    return Dispatch(resident, *request, connection).run();
  } catch (const json::exception&) {  // no request, whatever it is, ends a control
    return refuse(says::kBadLine, {std::string(line.substr(0, 80))}, kWrongUse, problem.language);
  }
}

namespace {

void stop_jog(Resident& resident, const HeldJog& jog) {
  resident.tell({.asker = jog.hand.asker,
                 .kind = RequestKind::jog_stop,
                 .axis = static_cast<std::int8_t>(jog.axis),
                 .client = jog.hand.client,
                 .value = 1.0});
}

}  // namespace

void end_connection(Resident& resident, Connection& connection) {
  for (const HeldJog& jog : connection.jogs) stop_jog(resident, jog);
  connection.jogs.clear();
  resident.plc().release_of(connection.number);
}

void watch_jogs(Resident& resident, Connection& connection) {
  if (resident.speed() == 1.0) return;
  for (HeldJog& jog : connection.jogs) {
    if (jog.silent || std::chrono::steady_clock::now() - jog.heard < kSilence) continue;
    jog.silent = true;
    stop_jog(resident, jog);
  }
}

}  // namespace servogate::gateway
