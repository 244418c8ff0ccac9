// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/plc/plc_desk.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gateway/control/run/standstill.hpp"
#include "gateway/control/server/desk/plc/change_log.hpp"
#include "gateway/control/server/desk/plc/plc_answers.hpp"
#include "gateway/control/server/protocol/refusal.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "machine/files/read_file.hpp"
#include "plc/logic/force_plan.hpp"

namespace servogate::gateway {

namespace {

using plc_answers::kNoVariable;
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
const Entry kStaysForced{"plc.stays-forced", "{0} stays forced: {1}", "{0} остаётся удержанным: {1}"};
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

Reply PlcDesk::ask(image::Request request, const Caller& who) {
  request.asker = who.asker;
  request.client = who.hand().client;
  image::Answer answer;
  switch (resident_.ask(request, answer, {resident_.requests().stops(), who.since, who.gone})) {
    case RequestDesk::Outcome::silent:
      return refuse(says::kWithdrawn, {}, kInfrastructure, who.language);
    case RequestDesk::Outcome::taken:
      return refuse(says::kLeftToCycle, {}, kInfrastructure, who.language);
    case RequestDesk::Outcome::overtaken:
      return refuse(says::kOvertaken, {}, kAlarm, who.language);
    case RequestDesk::Outcome::answered:
      break;
  }
  if (answer.refusal == 0) return {};
  return refused_by_gate(answer, resident_.control().machine(), who.language);
}

Reply PlcDesk::change(const plc::LogicChange& change, double value, const Caller& who) {
  image::Request request;
  request.kind = image::RequestKind::logic;
  request.index = change.number;
  request.value = value;
  Reply answer = ask(request, who);
  if (!answer.ok) resident_.control().logic()->withdraw(change.number);
  resident_.control().logic()->settle();
  return answer;
}

Outcome PlcDesk::carry_out(const ask::Command& command, const Caller& who) {
  if (resident_.control().logic() == nullptr) return refuse(kNoPlc, {}, kAlarm, who.language);
  resident_.control().logic()->settle();
  return std::visit(
      [&](const auto& wanted) -> Outcome {
        if constexpr (requires { this->take(wanted, who); })
          return take(wanted, who);
        else
          return refuse(says::kUnknown, {}, kWrongUse, who.language);  // of_plc() keeps it away
      },
      command);
}

/// A program of the PLC on its way from its files into the cycle.
struct PlcDesk::Load {
  plc::LogicChange change;
  std::vector<std::string> names;
  bool while_running = false;
  std::string unreadable;  ///< what cannot be read, and why
  plc::CompileResult compiled;
};

/// Reading and compiling happen beside the desk.
Outcome PlcDesk::take(const ask::PlcLoad& wanted, const Caller& who) {
  const Control& control = resident_.control();
  const auto load = std::make_shared<Load>();
  load->names = wanted.files;
  if (load->names.empty())
    for (const std::string& source : control.machine().plc.sources)
      load->names.push_back(control.machine().resolve(source));
  load->change.kind = plc::LogicChange::Kind::load;
  load->change.online = wanted.online;
  load->while_running = wanted.while_running;
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
    return [this, load, who]() -> Outcome {
      Caller now = who;
      now.since = std::chrono::steady_clock::now();  // while it was worked for it did not lie
      return loaded(*load, now);
    };
  };
  return work;
}

Reply PlcDesk::loaded(Load& load, const Caller& who) {
  if (!load.unreadable.empty()) return refuse(kNoFiles, {load.unreadable}, kWrongUse, who.language);
  Control& control = resident_.control();
  plc::LogicChange& change = load.change;
  change.number = control.next_logic_change();
  const plc::Logic::Plan plan = control.prepare(change, std::move(load.compiled));
  if (!plan.possible) {
    Reply answer = refuse(kNotCompiled, {}, kAlarm, who.language);
    for (const text::Finding& f : plan.findings)
      answer.text += "\n" + f.str(who.language) + "\n" + f.excerpt();
    while (answer.text.ends_with('\n')) answer.text.pop_back();
    PlcLoaded found;
    found.findings = plan.findings;
    answer.content = std::move(found);
    return answer;
  }
  Reply refused = this->change(change, load.while_running ? 1.0 : 0.0, who);
  if (!refused.ok) {
    if (!change.online || !load.while_running)
      refused.text += "\n" + text::render(kLoadLater, std::vector<std::string>{}, who.language);
    return refused;
  }
  for (const std::string& name : plan.forces_lost)
    std::erase_if(forces_, [&](const Force& f) { return f.places.empty() && plc::same_name(f.name, name); });
  const PlcLoaded told{plan.findings, true,          load.names,       change.online,  plan.kept,
                       plan.fresh,    plan.given_up, plan.forces_lost, plan.set_aside, plan.taken_back,
                       plan.lost};
  const std::string sources = joined(load.names);
  Reply answer = accept(kChanged, {sources, std::to_string(plan.kept), std::to_string(plan.fresh.size())},
                        who.language, told);
  const auto add = [&](const Entry& entry, const std::vector<std::string>& variables, bool named) {
    if (variables.empty()) return;
    std::vector<std::string> arguments;
    if (named) arguments.push_back(sources);
    arguments.push_back(joined(variables));
    answer.text += "\n" + text::render(entry, arguments, who.language);
  };
  add(kTakenBack, plan.taken_back, false);
  add(kSetAside, plan.set_aside, true);
  add(kLost, plan.lost, false);
  const std::string problem =
      log_change(resident_.state_path(), change, told, who, resident_.image().now.number);
  if (!problem.empty())
    answer.text += "\n" + text::render(kNotLogged, std::vector<std::string>{problem}, who.language);
  return answer;
}

/// All of them or none.
Reply PlcDesk::force_places(std::vector<image::Request> requests, const Caller& who) {
  for (std::size_t n = 0; n < requests.size(); ++n) {
    Reply answer = ask(requests[n], who);
    if (answer.ok) continue;
    while (n-- > 0) {
      requests[n].kind = image::RequestKind::release_force;
      requests[n].value = 0.0;
      ask(requests[n], who);
    }
    return answer;
  }
  return {};
}

Outcome PlcDesk::take(const ask::PlcForce& wanted, const Caller& who) {
  Force f;
  f.name = wanted.name;
  f.value = wanted.value;
  f.user = who.user;
  f.owner = wanted.stay ? 0 : who.connection;
  Control& control = resident_.control();
  plc::ForcePlan plan =
      plc::plan_force(control.symbols(), &control.logic()->program()->engine, f.name, f.value);
  if (plan.kind == plc::ForcePlan::Kind::unknown)
    return refuse(kNoVariable, {f.name}, kWrongUse, who.language);
  if (plan.kind == plc::ForcePlan::Kind::no_value)
    return refuse(kNoValue, {f.value, f.name}, kWrongUse, who.language);
  Reply answer;
  if (plan.kind == plc::ForcePlan::Kind::places) {
    f.places = std::move(plan.requests);
    answer = force_places(f.places, who);
    for (image::Request& place : f.places) {
      place.kind = image::RequestKind::release_force;
      place.value = 0.0;
    }
  } else {
    plc::LogicChange change;
    change.kind = plc::LogicChange::Kind::force;
    change.name = f.name;
    change.value = f.value;
    change.number = control.next_logic_change();
    if (!control.prepare(change).possible)
      return refuse(kNoValue, {f.value, f.name}, kWrongUse, who.language);
    answer = this->change(change, 1.0, who);
  }
  if (!answer.ok) return answer;
  std::erase_if(forces_, [&](const Force& other) { return plc::same_name(other.name, f.name); });
  forces_.push_back(f);
  return accept(kForced, {f.name, f.value}, who.language);
}

Reply PlcDesk::let_go(const Force& force, const Caller& who) {
  for (const image::Request& r : force.places)
    if (Reply refused = ask(r, who); !refused.ok) return refused;
  if (!force.places.empty()) return {};
  plc::LogicChange change;
  change.kind = plc::LogicChange::Kind::release;
  change.name = force.name;
  change.number = resident_.control().next_logic_change();
  return resident_.control().prepare(change).possible ? this->change(change, 1.0, who) : Reply{};
}

Outcome PlcDesk::take(const ask::PlcRelease& wanted, const Caller& who) {
  const std::string& name = wanted.name;
  const bool all = name.empty();
  if (all && forces_.empty()) return accept(kNothingForced, {}, who.language);
  bool found = false;
  for (std::size_t i = forces_.size(); i-- > 0;) {
    if (!all && !plc::same_name(forces_[i].name, name)) continue;
    found = true;
    if (Reply refused = let_go(forces_[i], who); !refused.ok) {
      refused.text =
          text::render(kStaysForced, std::vector<std::string>{forces_[i].name, refused.text}, who.language);
      return refused;
    }
    forces_.erase(forces_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (!found) return refuse(kNotForced, {name}, kWrongUse, who.language);
  return all ? accept(kAllReleased, {}, who.language) : accept(kReleased, {name}, who.language);
}

Outcome PlcDesk::take(const ask::PlcHold&, const Caller& who) {
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  request.value = 1.0;
  Reply answer = ask(request, who);
  if (!answer.ok) return answer;
  held_by_ = who.connection;
  holder_ = who.user;
  return accept(kHeld, {}, who.language);
}

Outcome PlcDesk::take(const ask::PlcStep& asked, const Caller& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refuse(kNotHolder, {}, kAlarm, who.language);
  image::Request scans;
  scans.kind = image::RequestKind::logic_scan;
  scans.value = 2.0;
  const double wanted = asked.scans;
  const bool whole = wanted >= 1.0 && wanted <= 1e9 && wanted == std::floor(wanted);
  scans.index = whole ? static_cast<std::uint32_t>(wanted) : 0;  // which the gate refuses
  Reply answer = ask(scans, who);
  if (!answer.ok) return answer;
  return accept(kStepped, {std::to_string(scans.index)}, who.language);
}

Outcome PlcDesk::take(const ask::PlcGo&, const Caller& who) {
  if (held_by_ == 0 || held_by_ != who.connection) return refuse(kNotHolder, {}, kAlarm, who.language);
  image::Request request;
  request.kind = image::RequestKind::logic_scan;
  Reply answer = ask(request, who);
  if (!answer.ok) return answer;
  held_by_ = 0;
  holder_.clear();
  return accept(kGoes, {}, who.language);
}

void PlcDesk::release_of(std::uint64_t connection) {
  if (connection != 0 && held_by_ == connection) {
    Caller gone;
    gone.connection = connection;
    take(ask::PlcGo{}, gone);
  }
  for (Force& f : forces_) f.left = f.left || (connection != 0 && f.owner == connection);
  let_go_left();
}

void PlcDesk::let_go_left() {
  std::erase_if(forces_, [this](const Force& f) { return f.left && let_go(f, {}).ok; });
}

/// Asked only where it may be granted: each request is kept in the history.
void PlcDesk::look_after() {
  const bool any = std::any_of(forces_.begin(), forces_.end(), [](const Force& f) { return f.left; });
  if (any && !resident_.busy() && nothing_moves(resident_.image())) let_go_left();
}

std::vector<ForcedValue> PlcDesk::forced() const {
  std::vector<ForcedValue> out;
  for (const Force& f : forces_) out.push_back({f.name, f.value, f.user, f.owner == 0});
  return out;
}

}  // namespace servogate::gateway
