// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/client/confirm.hpp"
#include "gateway/command/client/connection.hpp"
#include "gateway/command/client/jog.hpp"
#include "gateway/command/client/request.hpp"
#include "gateway/command/client/show.hpp"
#include "gateway/command/client/tables.hpp"
#include "gateway/command/client/touch.hpp"
#include "gateway/command/client/wait.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kOn{"client.on", "the drives are on, the brakes open",
                      "приводы включены, тормоза отпущены"};
const text::Entry kOff{"client.off", "the drives are off", "приводы выключены"};
const text::Entry kBack{"client.back", "the axes are back on the path: `servogate resume` goes on",
                        "оси снова на контуре: `servogate resume` продолжит программу"};
const text::Entry kNotBack{"client.not-back",
                           "the way back ended before the path: `servogate return` goes on with it",
                           "возврат прерван до контура: `servogate return` продолжит его"};
const text::Entry kRetraced{
    "client.retraced",
    "the axes stand {0} mm back on the path: `servogate retrace` goes further, `servogate return` forward",
    "оси отведены по контуру назад на {0} мм: `servogate retrace` — дальше, `servogate return` — вперёд"};
const text::Entry kNotRetraced{
    "client.not-retraced",
    "the axes stand where the program was held: behind them is the begin of the program or an M, S or T "
    "function, over which no way leads back",
    "оси стоят там, где программа приостановлена: позади начало программы или функция M, S или T, за которую "
    "пути назад нет"};
const text::Entry kNoAlarms{"client.no-alarms", "no alarm is active", "активных аварий нет"};
const text::Entry kNotKept{"client.history-not-kept", "the history is not written to the disk: {0}",
                           "история не записывается на диск: {0}"};
const text::Entry kGoThere{"client.go-there", "go there and start? (y/n)", "подойти и начать? (y/n)"};
const text::Entry kAsked{"client.stopped",
                         "stopped by the operator; the control carries on with what it was asked to do "
                         "(`servogate status` shows it)",
                         "остановлено оператором; запрошенное у управления продолжается: его покажет "
                         "`servogate status`"};

std::string of(const json& object, const char* key) { return object.value(key, std::string()); }

std::string say(const text::Entry& entry) { return text::render(entry, {}, text::user_language()); }

/// The control ends its connections when state and record are written and the axes and drives are at rest.
void wait_until_closed(SocketClient& connection) {
  constexpr int kLongestEnd_ms = 60'000;
  std::string line;
  while (connection.receive(line, kLongestEnd_ms)) {
  }
}

/// "2026-11-23 20:15:07.250Z  alarm 1001: ..."
void print_history(const json& reply) {
  for (const json& e : reply.value("events", json::array())) {
    std::string time = of(e, "time");
    if (const std::size_t t = time.find('T'); t != std::string::npos) time[t] = ' ';
    if (!print_line(time + "  " + of(e, "text"))) return;
  }
  if (const auto problem = reply.find("problem"); problem != reply.end() && problem->is_string())
    complain(kNotKept, {problem->get<std::string>()});
}

/// A client and what its command waits for.
struct Manner {
  bool power, jog, back, retrace, waits;
};

Manner manner_of(const ClientOptions& options, const json& request) {
  Manner m{options.command == "power", options.command == "jog", options.command == "return",
           options.command == "retrace", false};
  m.waits = options.wait || request["cmd"] == "jog_continuous" ||
            ((m.power || m.jog || m.back || m.retrace) && !options.no_wait);
  return m;
}

/// An axis was jogged away from a held program.
bool away(const json& status) {
  const json axes = status.value("axes", json::array());
  return std::any_of(axes.begin(), axes.end(), [](const json& a) { return a.value("beside", 0.0) != 0.0; });
}

/// What a command without --json leaves on its streams.
void show(const ClientOptions& options, const json& request, const Manner& manner, int code,
          const json& reply) {
  if (manner.jog && manner.waits) {
    if (reply.value("ok", false))
      print_line(of(reply, "text"));
    else
      print_refusal(reply);
    if (!reply.contains("status")) return;
    if (options.wait) print_status(reply["status"]);
    if (options.wait || code == kAlarm) print_alarms(reply["status"]["alarms"]);
  } else if (!reply.value("ok", false)) {
    print_refusal(reply);
  } else if (manner.power && manner.waits && !options.wait) {
    const bool off = request["value"] == 0;
    if (code == kDone) print_line(say(off ? kOff : kOn));
    // What became of a program that ran until now.
    if (off)
      for (const json& p : reply.value("processes", json::array()))
        if (const json stop = p.value("stop", json()); stop.is_object())
          print_line(of(stop, "text") + "\n    " + of(stop, "remedy"));
    print_alarms(reply["alarms"]);
  } else if (manner.back && manner.waits) {
    if (code == kDone)
      print_line(say(kBack));
    else
      complain(kNotBack, {});
    print_alarms(reply["alarms"]);
  } else if (manner.retrace && manner.waits) {
    const json back = of_process(reply, request).value("retraced_mm", json());
    if (back.is_number())
      print_line(text::render(kRetraced, std::vector<std::string>{text::number(back.get<double>(), 3)},
                              text::user_language()));
    else
      complain(kNotRetraced, {});
    print_alarms(reply["alarms"]);
  } else if (options.command == "status" || manner.waits) {
    print_status(reply);
    print_alarms(reply["alarms"]);
  } else if (request["cmd"] == "restart") {
    print_line(of(reply, "text"));
  } else if (request["cmd"] == "tables") {
    print_table(options, reply);
  } else if (options.command == "alarms" && options.history) {
    print_history(reply);
  } else if (options.command == "alarms") {
    if (reply["alarms"].empty()) print_line(say(kNoAlarms));
    print_alarms(reply["alarms"]);
    for (const json& wait : reply.value("waits", json::array())) print_wait(wait, "");
  } else {
    print_line(of(reply, "text"));
  }
}

/// Shows what a start in the middle would do and asks whether to do it; nullopt: yes, else the exit code.
std::optional<int> ask_person(SocketClient& connection, json request, bool as_json) {
  request["plan"] = true;
  const json plan = ask(connection, request);
  const int code = plan.value("exit", kInfrastructure);
  if (as_json) {  // a program asks with --yes, and sees the plan without it
    print_exact(plan.dump(1, ' ', false, json::error_handler_t::replace));
    return code;
  }
  if (code != kDone) {
    print_refusal(plan);
    return code;
  }
  print_restart(plan);
  return confirmed(kGoThere);
}

/// Shows the status until somebody has had enough.
int watch(SocketClient& connection, const json& request, const ClientOptions& options,
          const std::string& path) {
  constexpr std::chrono::milliseconds kPeriod{200};
  const bool screen = !options.json && ::isatty(STDOUT_FILENO) != 0;
  count_signals();
  for (bool read = true; read && signals_seen() == 0; std::this_thread::sleep_for(kPeriod)) {
    json reply = ask(connection, request);
    if (reply.is_null()) return connection_lost(path);
    if (options.json) {
      read = print_line(reply.dump(-1, ' ', false, json::error_handler_t::replace));
      continue;
    }
    if (screen) print_exact("\x1b[H\x1b[2J");
    print_status(reply);
    print_alarms(reply["alarms"]);
    if (!screen) read = print_line("");
  }
  return kDone;
}

}  // namespace

int client(const ClientOptions& options) {
  if (options.command == "touch") return touch(options);
  const json request = request_of(options);
  if (request.is_null()) return kWrongUse;
  std::string path;
  SocketClient connection;
  if (const int found = connect_to_control(options.socket, connection, path); found != kDone) return found;
  if (options.watch) return watch(connection, request, options, path);
  const Manner manner = manner_of(options, request);
  if (manner.waits)
    count_signals();
  else
    say_when_stopped(kAsked);
  json reply;
  if (request["cmd"] == "restart" && !options.yes) {
    if (const std::optional<int> code = ask_person(connection, request, options.json)) return *code;
  }
  reply = ask(connection, request);
  if (reply.is_null()) return connection_lost(path);
  int code = reply.value("exit", kInfrastructure);
  if (code == kDone && manner.waits) {
    if (!options.json) tell(of(reply, "text"));
    json waited = request;
    if (reply.value("beside", false)) waited["cmd"] = "functions";
    code = manner.jog ? follow_jog(connection, request, reply) : wait_for_end(connection, waited, reply);
    if (manner.back && code == kDone && away(reply)) code = kStopped;
    if (!reply.is_null()) reply["exit"] = code;
  }
  if (code == kDone && !options.json && request["cmd"] == "table_export") return write_export(options, reply);
  if (code == kDone && request["cmd"] == "down") wait_until_closed(connection);
  if (reply.is_null()) return connection_lost(path);
  if (options.json)
    print_exact(reply.dump(1, ' ', false, json::error_handler_t::replace));
  else
    show(options, request, manner, code, reply);
  return code;
}

}  // namespace servogate::gateway::command
