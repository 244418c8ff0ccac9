// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/client/connection.hpp"
#include "gateway/command/client/request.hpp"
#include "gateway/command/client/wait.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kOn{"client.on", "the drives are on, the brakes open",
                      "приводы включены, тормоза отпущены"};
const text::Entry kOff{"client.off", "the drives are off", "приводы выключены"};
const text::Entry kNoAlarms{"client.no-alarms", "no alarm is active", "активных аварий нет"};
const text::Entry kProgram{"client.program", "program {0}: {1} blocks", "программа {0}: кадров {1}"};
const text::Entry kProgramLine{"client.program-line", "program {0}, line {1} of {2}, {3} blocks done",
                               "программа {0}, строка {1} из {2}, выполнено кадров: {3}"};
const text::Entry kSubprogramLine{"client.subprogram-line",
                                  "program {0}, line {1} of {2} (subprogram), {3} blocks done",
                                  "программа {0}, строка {1} в {2} (подпрограмма), выполнено кадров: {3}"};
const text::Entry kForced{"client.forced", "forced: {0} = {1} (by {2})", "удерживается: {0} = {1} ({2})"};
const text::Entry kForcedStays{"client.forced-stays", "forced: {0} = {1} (by {2}, stays)",
                               "удерживается: {0} = {1} ({2}, постоянно)"};
const text::Entry kMessage{"client.message", "message: {0}", "сообщение: {0}"};
const text::Entry kWaits{"client.waits", "{0} ({1} s so far)", "{0} (уже {1} с)"};
const text::Entry kProcess{"client.process", "process {0}: ", "процесс {0}: "};

std::string of(const json& object, const char* key) { return object.value(key, std::string()); }

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

void print_program(const json& s) {
  const std::string program = of(s, "program"), file = of(s, "file");
  if (program.empty()) return;
  const int line = s.value("line", 0);
  const std::string blocks = std::to_string(s.value("blocks", 0));
  const std::string done = std::to_string(s.value("blocks_done", std::int64_t{0}));
  if (line == 0)
    print_line(say(kProgram, {program, blocks}));
  else if (!file.empty() && file != program)
    print_line(say(kSubprogramLine, {program, std::to_string(line), file, done}));
  else
    print_line(say(kProgramLine, {program, std::to_string(line), std::to_string(s.value("lines", 0)), done}));
}

void print_wait(const json& wait, const std::string& before) {
  if (!wait.is_object()) return;
  print_line(before + say(kWaits, {of(wait, "text"), text::number(wait.value("for_s", 0.0), 1)}));
  if (const std::string remedy = of(wait, "remedy"); !remedy.empty()) print_line("    " + remedy);
}

/// What the programs have said and what they wait for.
void print_processes(const json& s) {
  const json processes = s.value("processes", json::array());
  for (const json& p : processes) {
    const std::string before =
        processes.size() > 1 ? say(kProcess, {std::to_string(p.value("process", 0))}) : std::string();
    if (const std::string message = of(p, "message"); !message.empty())
      print_line(before + say(kMessage, {message}));
    print_wait(p.value("wait", json()), before);
  }
}

void print_forced(const json& forced) {
  for (const json& f : forced)
    print_line(say(f.value("stays", false) ? kForcedStays : kForced,
                   {of(f, "name"), of(f, "value"), of(f, "user")}));
}

void print_status(const json& s) {
  print_formatted("%s: %s, %s%s, %.3f s\n", of(s, "machine").c_str(), of(s, "mode").c_str(),
                  of(s, "state").c_str(), s.value("homing", false) ? ", homing" : "", s.value("time_s", 0.0));
  print_program(s);
  print_processes(s);
  print_formatted("feed %.0f mm/min, override %.0f %%, tool %d\n", s.value("feed_mm_min", 0.0),
                  s.value("override_pct", 0.0), s.value("tool", 0));
  for (const json& a : s.value("axes", json::array()))
    print_formatted("  %-3s %12.4f %s%s  %s%s%s%s\n", of(a, "letter").c_str(), a.value("position", 0.0),
                    of(a, "unit").c_str(), a.value("diameter", false) ? " (diameter)" : "",
                    of(a, "drive").c_str(), a.value("homed", false) ? ", homed" : ", not homed",
                    a.value("moving", false) ? ", moving" : "",
                    a.value("on_limit", 0) != 0 ? ", on the hard limit" : "");
  for (const json& sp : s.value("spindles", json::array()))
    print_formatted("  spindle %.0f rpm (commanded %.0f)  %s\n", sp.value("actual_rpm", 0.0),
                    sp.value("command_rpm", 0.0), of(sp, "drive").c_str());
  print_forced(s.value("forced", json::array()));
}

/// Each first fault with its remedy, what followed from it indented below it.
void print_alarms(const json& alarms) {
  for (const json& a : alarms) {
    const bool first = a.value("first", false);
    print_formatted("%s%d %s: %s\n%s%s\n", first ? "* " : "      ", a.value("number", 0), of(a, "id").c_str(),
                    of(a, "text").c_str(), first ? "    " : "        ", of(a, "remedy").c_str());
  }
}

}  // namespace

int client(const ClientOptions& options) {
  const json request = request_of(options);
  if (request.is_null()) return kWrongUse;
  std::string path;
  SocketClient connection;
  if (const int found = connect_to_control(options.socket, connection, path); found != kDone) return found;
  const bool power = options.command == "power", continuous = request["cmd"] == "jog_continuous";
  const bool waits = options.wait || (power && !options.no_wait);
  if (continuous || waits) watch_operator();
  json reply = ask(connection, request);
  int code = reply.value("exit", kInfrastructure);
  if (code == kDone && (continuous || waits)) {
    if (!options.json) std::fprintf(stderr, "%s\n", of(reply, "text").c_str());
    if (continuous) {
      reply = hold_jog(connection, request, reply);
      code = reply.value("exit", kInfrastructure);
    } else {
      code = wait_for_end(connection, request, reply);
      if (!reply.is_null()) reply["exit"] = code;
    }
  }
  if (reply.is_null()) {
    return connection_lost(path);
  }
  if (options.json) {
    print_line(reply.dump(1, ' ', false, json::error_handler_t::replace));
  } else if (!reply.value("ok", false)) {
    std::fprintf(stderr, "servogate: %s [%s]\n", of(reply, "text").c_str(), of(reply, "code").c_str());
  } else if (power && waits && !options.wait) {
    if (code == kDone) print_line(say(request["value"] == 0 ? kOff : kOn, {}));
    print_alarms(reply["alarms"]);
  } else if (options.command == "status" || (waits && !continuous)) {
    print_status(reply);
    print_alarms(reply["alarms"]);
  } else if (options.command == "alarms") {
    if (reply["alarms"].empty()) print_line(say(kNoAlarms, {}));
    print_alarms(reply["alarms"]);
    for (const json& wait : reply.value("waits", json::array())) print_wait(wait, "");
  } else {
    print_line(of(reply, "text"));
  }
  return code;
}

}  // namespace servogate::gateway::command
