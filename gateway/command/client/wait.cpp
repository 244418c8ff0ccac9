// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/wait.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/run/standstill.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

const text::Entry kHeld{"client.held",
                        "held on the path: `servogate resume` goes on, `servogate reset` ends the program",
                        "остановлено на контуре: `servogate resume` продолжает, `servogate reset` завершает "
                        "программу"};
const text::Entry kNotOn{"client.not-on", "not switched on within {0} s: {1}{2}",
                         "не включились за {0} с: {1}{2}"};
const text::Entry kNotOff{"client.not-off", "not switched off within {0} s: {1}",
                          "не выключились за {0} с: {1}"};
const text::Entry kNoCycle{"client.no-cycle", "the control answers, but its cycle is not running",
                           "управление отвечает, но его цикл не работает"};

const text::Entry kHomingEnded{
    "client.homing-ended",
    "homing was stopped by someone else (reset, stop or hold): run `servogate home` again",
    "выход в ноль остановлен кем-то другим (reset, stop или hold): повторите `servogate "
    "home`"};
const text::Entry kOffByOperator{"client.stopped-off", "stopped by the operator: the drives are off",
                                 "остановлено оператором: приводы выключены"};
const text::Entry kControlEnds{
    "client.control-ends",
    "the control is shutting down (`servogate down` or a signal): what was in progress has been stopped",
    "управление завершается (`servogate down` или сигнал): то, что выполнялось, остановлено"};
const text::Entry kUnreachable{
    "client.unreachable",
    "no answer from the drive of {0}: it may still be on; only cutting its supply (emergency stop) is "
    "certain",
    "привод {0} не отвечает: возможно, он включён; наверняка — только снять питание (аварийный останов)"};

const text::Entry kStopsAt{"client.programmed-stop", "{0}\n    {1}", "{0}\n    {1}"};
const text::Entry kWaitsFor{"client.waits-for", "{0}; still waiting\n    {1}",
                            "{0}; ожидание продолжается\n    {1}"};

constexpr auto kLook = std::chrono::milliseconds(50);
constexpr double kPowerPatience_s = 15.0;  ///< of machine time: boot of a drive, brakes
constexpr double kEndPatience_s = 2.0;     ///< of a program whose drives are off
constexpr double kSettling_s = 1.0;        ///< at most, of an axis that has jogged
constexpr double kAlarmPatience_s = 2.0;   ///< the same while an alarm is active
constexpr double kSilentWait_s = 2.0;      ///< a longer wait of the program for somebody is said
constexpr std::chrono::seconds kCyclePatience{10};

std::string of(const json& object, const char* key) { return object.value(key, std::string()); }

/// A wait of the program and who has to do what, on standard error.
void tell(const text::Entry& entry, const json& wait) {
  gateway::tell(text::render(entry, std::vector<std::string>{of(wait, "text"), of(wait, "remedy")},
                             text::user_language()));
}

/// What was asked for, as far as waiting has to tell it apart.
enum class Kind { power_on, power_off, home, jog, step, functions, program };

Kind kind_of(const json& request) {
  const std::string command = request["cmd"];
  if (command == "power") return request["value"] == 0 ? Kind::power_off : Kind::power_on;
  if (command == "home") return Kind::home;
  if (command.starts_with("jog") || command == "return" || command == "retrace") return Kind::jog;
  if (command == "functions") return Kind::functions;
  return command == "step" ? Kind::step : Kind::program;
}

/// Waiting for one request. The exit code is known once under_way() is false.
class Wait {
 public:
  Wait(SocketClient& client, const json& request)
      : client_(client), request_(request), kind_(kind_of(request)) {
    // What ended a continuous jog has done its work.
    if (request["cmd"] == "jog_continuous") interrupts_done_ = signals_seen();
  }
  int run(json& status);

 private:
  bool under_way(const json& status);
  bool homing_under_way(const json& status);
  bool jog_under_way(const json& status);
  bool program_under_way(const json& status);
  bool functions_under_way(const json& status) const;
  bool rests(const json& status) const;
  void say_what_is_missing(const json& status);
  void name_unreachable(const json& status);
  bool too_late(const json& status);
  bool cycle_stands(const json& status);
  /// A program that the drives are taken from ends as soon as its path is at rest.
  static bool busy(const json& status) {
    const std::string state = of(status, "state");
    return state == "running" || state == "held" || state == "waiting";
  }
  static bool stopped_by_plc(const json& status) {
    const json stop = status.value("stop", json());
    return stop.is_object() && of(stop, "cause") == "enable_withdrawn";
  }
  void interrupt();
  json simple(const char* command) const { return {{"cmd", command}, {"language", request_["language"]}}; }
  /// Of those that the PLC moves nobody here waits for anything.
  template <typename Is>
  static bool any_axis(const json& status, Is&& is) {
    const json axes = status.value("axes", json::array());
    return std::any_of(axes.begin(), axes.end(),
                       [&](const json& a) { return !a.value("auxiliary", false) && is(a); });
  }
  static bool turning(const json& status) {
    const json spindles = status.value("spindles", json::array());
    return std::any_of(spindles.begin(), spindles.end(),
                       [](const json& s) { return s.value("rests", json()) == json(false); });
  }
  static bool on(const json& axis) { return axis.value("enabled", false); }
  static bool moving(const json& axis) { return axis.value("moving", false); }
  /// It may still be driven: ramping down, or held until its brake has closed.
  static bool powered(const json& axis) {
    const std::string drive = of(axis, "drive");
    return on(axis) || moving(axis) || drive == "operation_enabled" || drive == "quick_stop_active";
  }
  double in_wait_s(const json& status) const { return status.value("time_s", 0.0) - begun_s_; }
  /// A warning keeps nothing from being done.
  static bool alarm(const json& status) {
    const json alarms = status.value("alarms", json::array());
    return std::any_of(alarms.begin(), alarms.end(),
                       [](const json& a) { return !a.value("warning", false); });
  }

  SocketClient& client_;
  const json& request_;
  Kind kind_;
  int code_ = kDone;
  int interrupts_done_ = 0;
  double asked_s_ = 0.0;   ///< machine time before the request was carried out
  double begun_s_ = -1.0;  ///< machine time of the first status
  double seen_s_ = -1.0;
  double said_s_ = -1.0;          ///< beginning of the wait that was said
  double stands_since_s_ = -1.0;  ///< of a jog
  std::chrono::steady_clock::time_point moved_on_ = std::chrono::steady_clock::now();
};

bool Wait::homing_under_way(const json& status) {
  if (status.value("homing", false)) return true;
  // An axis that had its reference before keeps it when its homing is broken off.
  const bool open = !status.value("homing_left", json::array()).empty();
  if (!open || alarm(status) || interrupts_done_ > 0) return false;
  // 1101 ... 1110 say by themselves why an axis has no reference.
  const json alarms = status.value("alarms", json::array());
  const bool broken = std::any_of(alarms.begin(), alarms.end(), [](const json& a) {
    const int number = a.value("number", 0);
    return number > 1100 && number < 1200;
  });
  code_ = broken ? kAlarm : kStopped;
  if (!broken && !status.value("ending", false)) complain(kHomingEnded, {});
  return false;
}

/// Until the axes stand, and then until they have settled, as long as that takes an axis.
bool Wait::jog_under_way(const json& status) {
  if (any_axis(status, moving) || status.value("retracing", false)) {
    stands_since_s_ = -1.0;
    return true;
  }
  const double now_s = status.value("time_s", 0.0);
  if (stands_since_s_ < 0.0) stands_since_s_ = now_s;
  const bool settles =
      any_axis(status, [](const json& a) { return on(a) && !a.value("in_position", false); });
  return settles && !alarm(status) && now_s - stands_since_s_ < kSettling_s;
}

/// What was asked for has come to its end, and the program waits for the operator: behind the block that was
/// asked for, not the one before it, or at a stop that it programs.
bool Wait::rests(const json& status) const {
  const json wait = status.value("wait", json());
  if (!wait.is_object() || wait.value("since_s", 0.0) <= asked_s_) return false;
  const std::string reason = of(wait, "reason");
  if (reason == "block_end") return kind_ == Kind::step;
  if (reason != "program_stop" && reason != "optional_stop") return false;
  tell(kStopsAt, wait);
  return true;
}

/// Once for each wait: that nothing happens because somebody else has to act first.
void Wait::say_what_is_missing(const json& status) {
  if (kind_ == Kind::jog || kind_ == Kind::functions) return;  // beside a program that waits
  const json wait = status.value("wait", json());
  if (interrupts_done_ > 0 || !wait.is_object() || of(wait, "remedy").empty()) return;
  const double since_s = wait.value("since_s", 0.0);
  if (since_s == said_s_ || wait.value("for_s", 0.0) < kSilentWait_s) return;
  said_s_ = since_s;
  tell(kWaitsFor, wait);
}

bool Wait::program_under_way(const json& status) {
  const std::string state = of(status, "state");
  if (state == "running") return true;
  if (interrupts_done_ > 0 && state != "ended" && !state.starts_with("stopped"))
    return any_axis(status, moving);  // held, or ended by the second interrupt
  if (state == "waiting") return !rests(status);
  if (state == "held") return kind_ != Kind::step;
  if (state == "stopped_by_alarm") code_ = kAlarm;
  if ((state == "idle" || state == "stopped") && !alarm(status))
    code_ = stopped_by_plc(status) ? kAlarm : kStopped;
  return false;
}

/// Until the held program waits for nobody but the operator again.
bool Wait::functions_under_way(const json& status) const {
  const std::string state = of(status, "state");
  if (interrupts_done_ > 0 || (state != "held" && state != "waiting")) return false;
  const std::string reason = of(status.value("wait", json::object()), "reason");
  return reason.empty() || reason.ends_with("_acknowledge");
}

/// A drive that does not answer may be on.
void Wait::name_unreachable(const json& status) {
  std::string letters;
  for (const json& a : status.value("axes", json::array()))
    if (of(a, "drive") == "offline") letters += (letters.empty() ? "" : ", ") + of(a, "letter");
  // null: its drive does not answer.
  for (const json& s : status.value("spindles", json::array()))
    if (s.value("rests", json()).is_null())
      letters += (letters.empty() ? "" : ", ") + text::both("the spindle", "шпинделя");
  if (letters.empty()) return;
  code_ = kAlarm;
  complain(kUnreachable, {letters});
}

bool Wait::under_way(const json& status) {
  code_ = alarm(status) ? kAlarm : kDone;
  switch (kind_) {
    case Kind::power_on: {
      const bool off = any_axis(status, [](const json& a) { return !on(a); });
      if (!off) code_ = kDone;  // a warning that is active did not keep them off
      if (off && status.value("ending", false)) {
        code_ = kStopped;
        return false;
      }
      return off && !(alarm(status) && in_wait_s(status) > kAlarmPatience_s);
    }
    case Kind::power_off:
      code_ = kDone;
      if (any_axis(status, powered) || turning(status)) return true;
      if (busy(status) && in_wait_s(status) < kEndPatience_s) return true;
      name_unreachable(status);
      return false;
    case Kind::home:
      return homing_under_way(status);
    case Kind::jog:
      return jog_under_way(status);
    case Kind::functions:
      return functions_under_way(status);
    case Kind::step:
    case Kind::program:
      return program_under_way(status);
  }
  return false;
}

/// Drives that do not come or go are named with their states.
bool Wait::too_late(const json& status) {
  if (kind_ != Kind::power_on && kind_ != Kind::power_off) return false;
  const bool runs_down = kind_ == Kind::power_off && turning(status);
  const double patience_s = runs_down ? kSpindlePatience_s : kPowerPatience_s;
  if (in_wait_s(status) < patience_s) return false;
  std::string late;
  if (runs_down) late = text::both("spindle", "шпиндель");
  for (const json& a : status.value("axes", json::array()))
    if (kind_ == Kind::power_on ? !on(a) : powered(a))
      late += (late.empty() ? "" : ", ") + of(a, "letter") + " (" + of(a, "drive") + ")";
  std::string missing;
  if (kind_ == Kind::power_on)
    for (const json& m : status.value("missing", json::array()))
      missing += "\n  " + of(m, "text") + "\n    " + of(m, "remedy");
  complain(kind_ == Kind::power_on ? kNotOn : kNotOff, {text::number(patience_s, 0), late, missing});
  return true;
}

bool Wait::cycle_stands(const json& status) {
  const double now_s = status.value("time_s", 0.0);
  const auto now = std::chrono::steady_clock::now();
  if (now_s != seen_s_) moved_on_ = now;
  seen_s_ = now_s;
  if (begun_s_ < 0.0) begun_s_ = now_s;
  if (now - moved_on_ < kCyclePatience) return false;
  complain(kNoCycle, {});
  return true;
}

void Wait::interrupt() {
  ++interrupts_done_;
  switch (kind_) {
    case Kind::power_on: {
      json off = simple("power");
      off["value"] = 0;
      ask(client_, off);
      kind_ = Kind::power_off;
      break;
    }
    case Kind::power_off:
    case Kind::functions:
      break;
    case Kind::home:
      ask(client_, simple("stop"));
      break;
    case Kind::jog: {
      // A program beside which it jogs stays held; ways along its path are the process' own.
      const std::string command = request_["cmd"];
      json order = simple(command == "return" || command == "retrace" ? "hold" : "jog_stop");
      if (request_.contains("process") && order["cmd"] == "hold") order["process"] = request_["process"];
      ask(client_, order);
      break;
    }
    case Kind::step:
    case Kind::program: {
      json order = simple(interrupts_done_ == 1 ? "hold" : "stop");
      if (interrupts_done_ == 1 && request_.contains("process")) order["process"] = request_["process"];
      ask(client_, order);
      break;
    }
  }
}

int Wait::run(json& status) {
  asked_s_ = status.value("asked_s", 0.0);
  const json question = simple("status");
  for (json before;; before = std::move(status), std::this_thread::sleep_for(kLook)) {
    status = ask(client_, question);
    if (status.is_null() && before.is_object() && before.value("ending", false)) {
      status = before;  // it has put everything away, and with it what was waited for
      complain(kControlEnds, {});
      return kStopped;
    }
    if (status.is_null() || cycle_stands(status)) return kInfrastructure;
    if (signals_seen() > interrupts_done_) {
      interrupt();
      continue;
    }
    const json own = of_process(status, request_);
    if (!under_way(own)) break;
    if (too_late(own)) return kAlarm;
    say_what_is_missing(own);
  }
  if (code_ == kStopped && status.value("ending", false)) complain(kControlEnds, {});
  const std::string state = of(of_process(status, request_), "state");
  const bool own_end = kind_ == Kind::program && (state == "ended" || state == "stopped_by_alarm");
  if (interrupts_done_ == 0 || own_end) return code_;
  if (state == "held") complain(kHeld, {});
  if (kind_ == Kind::power_off) complain(kOffByOperator, {});
  return kStopped;
}

}  // namespace

json of_process(const json& status, const json& request) {
  const auto process = static_cast<std::size_t>(request.value("process", 1));
  const json processes = status.value("processes", json::array());
  if (process < 2 || process > processes.size()) return status;
  json own = status;
  own.update(processes[process - 1]);
  return own;
}

json ask(SocketClient& client, const json& request) {
  std::string answer;
  if (!client.exchange(request.dump(-1, ' ', false, json::error_handler_t::replace), answer)) return {};
  json reply = json::parse(answer, nullptr, false);
  return reply.is_object() ? reply : json();
}

int wait_for_end(SocketClient& client, const json& request, json& status) {
  return Wait(client, request).run(status);
}

}  // namespace servogate::gateway::command
