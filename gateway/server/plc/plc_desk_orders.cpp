// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/plc/plc_desk.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>

#include "firmware_if/text/system_words.hpp"
#include "gateway/compose/plc/force_plan.hpp"
#include "gateway/files/read_file.hpp"
#include "gateway/machine/consequences.hpp"
#include "gateway/report/report.hpp"
#include "gateway/server/desk/refusal.hpp"
#include "gateway/server/plc/plc_answers.hpp"
#include "gateway/server/resident.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;
using plc_answers::kNoVariable;
using plc_answers::refused;
using plc_answers::told;
using text::Entry;

const Entry kNoPlc{"plc.none", "this machine has no PLC program", "у этого станка нет программы ПЛК"};
const Entry kNoFiles{"plc.no-files", "cannot read {0}", "не читается {0}"};
const Entry kNotCompiled{"plc.errors", "the PLC program was not changed: it has errors",
                         "программа ПЛК не заменена: в ней есть ошибки"};
const Entry kChanged{"plc.changed", "the PLC runs {0}: {1} values kept, {2} variables begin anew",
                     "ПЛК выполняет {0}: сохранено значений {1}, начато заново переменных {2}"};
const Entry kSetAside{
    "plc.set-aside",
    "warning: {0} has no such retained variables; their values are kept aside until a program has them: {1}",
    "предупреждение: в {0} нет таких сохраняемых переменных; их значения отложены для программы, где они "
    "есть: {1}"};
const Entry kTakenBack{"plc.taken-back", "their values from before are back: {0}",
                       "возвращены прежние значения: {0}"};
const Entry kLost{"plc.retained-lost",
                  "warning: retained variables begin anew, for their types have changed: {0}",
                  "предупреждение: сохраняемые переменные начаты заново, их типы изменились: {0}"};
const Entry kLoadLater{
    "plc.load-later",
    "Load it when the program has ended and all axes rest; or with --online --while-running, once you have "
    "made sure that the machine may go on with the new logic in the middle of its motion.",
    "Загрузите её, когда программа закончится и все оси остановятся; или с --online --while-running, "
    "убедившись, что станок может продолжать движение с новой логикой."};
const Entry kNotLogged{"plc.not-logged", "the change of the PLC could not be written to the change log: {0}",
                       "замена программы ПЛК не записана в журнал: {0}"};
const Entry kNoValue{"plc.no-value", "'{0}' is no value for '{1}'", "«{0}» не является значением для «{1}»"};
const Entry kForced{"plc.forced", "{0} is forced to {1}", "{0} удерживается на {1}"};
const Entry kReleased{"plc.released", "{0} is let go", "{0} освобождена"};
const Entry kNotForced{"plc.not-forced", "'{0}' is not forced", "«{0}» не удерживается"};
const Entry kNothingForced{"plc.nothing-forced", "nothing is forced", "ничего не удерживается"};
const Entry kAllReleased{"plc.all-released", "everything is let go", "всё освобождено"};
const Entry kHeld{"plc.held-now", "the PLC is held; its outputs are off until it is let go",
                  "ПЛК удерживается; его выходы отключены, пока он не отпущен"};
const Entry kStepped{"plc.stepped", "{0} scans done", "выполнено сканов: {0}"};
const Entry kGoes{"plc.goes",
                  "the PLC runs freely again; `servogate reset` before the drives are switched on",
                  "ПЛК снова работает; перед включением приводов выполните `servogate reset`"};
const Entry kNotHolder{"plc.not-holder", "the PLC is not held by this client",
                       "этот клиент не удерживает ПЛК"};

std::string joined(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& s : list) out += (out.empty() ? "" : ", ") + s;
  return out;
}

}  // namespace

json PlcDesk::ask(image::Request request, const Caller& who) {
  request.asker = who.asker;
  request.client = who.hand().client;
  image::Answer answer;
  if (resident_.ask(request, answer, resident_.requests().stops()) != RequestDesk::Outcome::answered)
    return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
  if (answer.refusal == 0) return {{"ok", true}};
  return refusal_json(answer, resident_.control().machine(), who.language);
}

json PlcDesk::change(const LogicChange& change, double value, const Caller& who) {
  image::Request request;
  request.kind = image::RequestKind::logic;
  request.index = change.number;
  request.value = value;
  json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) resident_.control().logic()->withdraw(change.number);
  resident_.control().logic()->settle();
  return answer;
}

Outcome PlcDesk::carry_out(const json& request, const Caller& who) {
  using Handler = json (PlcDesk::*)(const json&, const Caller&);
  static constexpr struct {
    std::string_view command;
    Handler handler;
  } kRows[] = {{"plc_force", &PlcDesk::force}, {"plc_release", &PlcDesk::release},
               {"plc_hold", &PlcDesk::hold},   {"plc_step", &PlcDesk::step},
               {"plc_go", &PlcDesk::go},       {"plc_watch", &PlcDesk::watch},
               {"plc_list", &PlcDesk::list}};
  if (resident_.control().logic() == nullptr)
    return Reply{text_of(refused(kNoPlc, {}, kAlarm, who.language))};
  resident_.control().logic()->settle();
  const std::string command = request.value("cmd", "");
  if (command == "plc_load") return load(request, who);
  for (const auto& row : kRows)
    if (row.command == command) return Reply{text_of((this->*row.handler)(request, who))};
  return refuse(says::kUnknown, {command}, kWrongUse, who.language);
}

/// A program of the PLC on its way from its files into the cycle.
struct PlcDesk::Load {
  LogicChange change;
  std::vector<std::string> names;
  bool while_running = false;
  std::string unreadable;  ///< what cannot be read, and why
  plc::CompileResult compiled;
};

/// Reading and compiling happen beside the desk.
Outcome PlcDesk::load(const json& request, const Caller& who) {
  const Control& control = resident_.control();
  const auto load = std::make_shared<Load>();
  load->names = request.value("files", std::vector<std::string>{});
  if (load->names.empty())
    for (const std::string& source : control.machine().plc.sources)
      load->names.push_back(control.machine().resolve(source));
  load->change.kind = LogicChange::Kind::load;
  load->change.online = request.value("online", false);
  load->while_running = request.value("while_running", false);
  Work work;
  work.what = "plc_load", work.name = joined(load->names);
  work.run = [this, &control, load, who](const std::stop_token& stop) -> Finish {
    for (const std::string& name : load->names) {
      std::string reason;
      auto content = files::read_file(name, files::kMostOfSource, reason);
      if (!content) load->unreadable = name + ": " + reason;
      if (!content) break;
      load->change.files.push_back({name, std::move(*content)});
    }
    if (load->unreadable.empty()) load->compiled = control.compile(load->change.files, stop);
    if (stop.stop_requested()) throw Cancelled{};
    return [this, load, who]() -> Outcome { return Reply{text_of(loaded(*load, who))}; };
  };
  return work;
}

json PlcDesk::loaded(Load& load, const Caller& who) {
  if (!load.unreadable.empty()) return refused(kNoFiles, {load.unreadable}, kWrongUse, who.language);
  Control& control = resident_.control();
  LogicChange& change = load.change;
  const std::vector<std::string>& names = load.names;
  change.number = control.next_logic_change();
  const PlcLogic::Plan plan = control.prepare(change, std::move(load.compiled));
  json more{{"findings", json::parse(machine::to_json(plan.findings), nullptr, false)}};
  if (!plan.possible) {
    json answer = refused(kNotCompiled, {}, kAlarm, who.language);
    std::string words = answer["text"];
    for (const text::Finding& f : plan.findings) words += "\n" + f.str(who.language) + "\n" + f.excerpt();
    while (words.ends_with('\n')) words.pop_back();
    answer["text"] = words;
    answer.update(more);
    return answer;
  }
  json answer = this->change(change, load.while_running ? 1.0 : 0.0, who);
  if (!answer["ok"].get<bool>()) {
    if (!change.online || !load.while_running)
      answer["text"] = answer["text"].get<std::string>() + "\n" +
                       text::render(kLoadLater, std::vector<std::string>{}, who.language);
    return answer;
  }
  for (const std::string& name : plan.forces_lost)
    std::erase_if(forces_, [&](const Force& f) { return f.places.empty() && plc::same_name(f.name, name); });
  answer = told(kChanged, {joined(names), std::to_string(plan.kept), std::to_string(plan.fresh.size())},
                who.language);
  const std::string sources = joined(names);
  const auto add = [&](const Entry& entry, const std::vector<std::string>& variables, bool named) {
    if (variables.empty()) return;
    std::vector<std::string> arguments;
    if (named) arguments.push_back(sources);
    arguments.push_back(joined(variables));
    answer["text"] = answer["text"].get<std::string>() + "\n" + text::render(entry, arguments, who.language);
  };
  add(kTakenBack, plan.taken_back, false);
  add(kSetAside, plan.set_aside, true);
  add(kLost, plan.lost, false);
  more.update({{"set_aside", plan.set_aside}, {"taken_back", plan.taken_back}, {"lost", plan.lost}});
  more.update({{"files", names},
               {"online", change.online},
               {"kept", plan.kept},
               {"fresh", plan.fresh},
               {"given_up", plan.given_up},
               {"forces_lost", plan.forces_lost}});
  answer.update(more);
  if (const std::string problem = log(change, answer, who); !problem.empty())
    answer["text"] = answer["text"].get<std::string>() + "\n" +
                     text::render(kNotLogged, std::vector<std::string>{problem}, who.language);
  return answer;
}

/// One JSON object a line in plc-changes.jsonl of the state directory; empty: done, or there is none.
std::string PlcDesk::log(const LogicChange& change, const json& told, const Caller& who) {
  if (resident_.state_path().empty()) return {};
  char when[32] = "";
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", &utc);
  json files = json::array();
  for (const plc::SourceFile& f : change.files)
    files.push_back({{"path", f.name}, {"sha256", report::sha256(f.text)}});
  const json entry{{"schema", 1},
                   {"when", when},
                   {"user", who.user},
                   {"cycle", resident_.image().now.number},
                   {"online", change.online},
                   {"files", files},
                   {"kept", told["kept"]},
                   {"fresh", told["fresh"]},
                   {"given_up", told["given_up"]},
                   {"set_aside", told["set_aside"]},
                   {"taken_back", told["taken_back"]}};
  std::error_code code;
  std::filesystem::create_directories(resident_.state_path(), code);
  const std::string path = (std::filesystem::path(resident_.state_path()) / "plc-changes.jsonl").string();
  const std::string line = entry.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const bool good = fd >= 0 && ::write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                    ::fsync(fd) == 0;
  const int problem = errno;
  if (fd >= 0) ::close(fd);
  return good ? std::string() : path + ": " + text::words_of(problem);
}

/// All of them or none.
json PlcDesk::force_places(std::vector<image::Request> requests, const Caller& who) {
  for (std::size_t n = 0; n < requests.size(); ++n) {
    json answer = ask(requests[n], who);
    if (answer["ok"].get<bool>()) continue;
    while (n-- > 0) {
      requests[n].kind = image::RequestKind::release_force;
      requests[n].value = 0.0;
      ask(requests[n], who);
    }
    return answer;
  }
  return {{"ok", true}};
}

json PlcDesk::force(const json& request, const Caller& who) {
  Force f;
  f.name = request.value("name", "");
  f.value = request.value("value", "");
  f.user = who.user;
  f.owner = request.value("stay", false) ? 0 : who.connection;
  Control& control = resident_.control();
  ForcePlan plan = plan_force(control.machine(), &control.logic()->program()->engine, f.name, f.value);
  if (plan.kind == ForcePlan::Kind::unknown) return refused(kNoVariable, {f.name}, kWrongUse, who.language);
  if (plan.kind == ForcePlan::Kind::no_value)
    return refused(kNoValue, {f.value, f.name}, kWrongUse, who.language);
  json answer;
  if (plan.kind == ForcePlan::Kind::places) {
    f.places = std::move(plan.requests);
    answer = force_places(f.places, who);
    for (image::Request& place : f.places) {
      place.kind = image::RequestKind::release_force;
      place.value = 0.0;
    }
  } else {
    LogicChange change;
    change.kind = LogicChange::Kind::force;
    change.name = f.name;
    change.value = f.value;
    change.number = control.next_logic_change();
    if (!control.prepare(change).possible)
      return refused(kNoValue, {f.value, f.name}, kWrongUse, who.language);
    answer = this->change(change, 1.0, who);
  }
  if (!answer["ok"].get<bool>()) return answer;
  std::erase_if(forces_, [&](const Force& other) { return plc::same_name(other.name, f.name); });
  forces_.push_back(f);
  return told(kForced, {f.name, f.value}, who.language);
}

bool PlcDesk::let_go(const Force& force, const Caller& who) {
  if (!force.places.empty())
    return std::all_of(force.places.begin(), force.places.end(),
                       [&](const image::Request& r) { return ask(r, who)["ok"].get<bool>(); });
  LogicChange change;
  change.kind = LogicChange::Kind::release;
  change.name = force.name;
  change.number = resident_.control().next_logic_change();
  return !resident_.control().prepare(change).possible || this->change(change, 1.0, who)["ok"].get<bool>();
}

json PlcDesk::release(const json& request, const Caller& who) {
  const std::string name = request.value("name", "");
  const bool all = name.empty();
  if (all && forces_.empty()) return told(kNothingForced, {}, who.language);
  bool found = false;
  for (std::size_t i = forces_.size(); i-- > 0;) {
    if (!all && !plc::same_name(forces_[i].name, name)) continue;
    found = true;
    if (!let_go(forces_[i], who)) return refused(says::kNoAnswer, {}, kInfrastructure, who.language);
    forces_.erase(forces_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (!found) return refused(kNotForced, {name}, kWrongUse, who.language);
  return all ? told(kAllReleased, {}, who.language) : told(kReleased, {name}, who.language);
}

json PlcDesk::hold(const json&, const Caller& who) {
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  request.value = 1.0;
  const json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) return answer;
  held_by_ = who.connection;
  holder_ = who.user;
  return told(kHeld, {}, who.language);
}

json PlcDesk::step(const json& request, const Caller& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refused(kNotHolder, {}, kAlarm, who.language);
  image::Request scans;
  scans.kind = image::RequestKind::logic_scan;
  scans.value = 2.0;
  const double wanted = request.value("scans", 1.0);
  const bool whole = wanted >= 1.0 && wanted <= 1e9 && wanted == std::floor(wanted);
  scans.index = whole ? static_cast<std::uint32_t>(wanted) : 0;  // which the gate refuses
  const json answer = ask(scans, who);
  if (!answer["ok"].get<bool>()) return answer;
  return told(kStepped, {std::to_string(scans.index)}, who.language);
}

json PlcDesk::go(const json&, const Caller& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refused(kNotHolder, {}, kAlarm, who.language);
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  const json answer = ask(request, who);
  if (!answer["ok"].get<bool>()) return answer;
  held_by_ = 0;
  holder_.clear();
  return told(kGoes, {}, who.language);
}

void PlcDesk::release_of(std::uint64_t connection) {
  if (connection != 0 && held_by_ == connection) {
    Caller gone;
    gone.connection = connection;
    go({}, gone);
  }
  for (std::size_t i = forces_.size(); i-- > 0;)
    if (forces_[i].owner == connection && connection != 0) {
      let_go(forces_[i], {});
      forces_.erase(forces_.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

json PlcDesk::forced() const {
  json out = json::array();
  for (const Force& f : forces_)
    out.push_back({{"name", f.name}, {"value", f.value}, {"user", f.user}, {"stays", f.owner == 0}});
  return out;
}

}  // namespace servogate::gateway
