// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "gateway/cli/messages.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/server/socket_client.hpp"
#include "gateway/server/socket_path.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kNoControl{
    "client.no-control",
    "no control is running (no socket in {0}); start one with `servogate up MACHINE.toml`",
    "управление не запущено (нет сокета в {0}); запуск: `servogate up MACHINE.toml`"};
const text::Entry kManyControls{"client.many-controls",
                                "several controls are running; choose one with --socket: {0}",
                                "запущено несколько управлений; выберите одно через --socket: {0}"};
const text::Entry kNoConnection{"client.no-connection", "cannot reach the control at {0}: {1}",
                                "нет связи с управлением {0}: {1}"};
const text::Entry kConnectionLost{"client.connection-lost", "the control at {0} closed the connection",
                                  "управление {0} закрыло соединение"};
const text::Entry kNoAlarms{"client.no-alarms", "no alarm is active", "активных аварий нет"};
const text::Entry kBadNumber{"client.bad-number", "'{0}' is not {1}", "«{0}» — не {1}"};
const text::Entry kArguments{"client.arguments", "`{0}` takes: {1}", "`{0}` принимает: {1}"};

std::atomic<bool> ended{false};
void on_end(int) { ended = true; }

bool parse_number(std::string_view text, double& value, std::string_view& rest) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return error == std::errc{};
}

/// The request of a command line; null: wrong use, already said.
json request_of(const ClientOptions& options) {
  const std::vector<std::string>& a = options.arguments;
  const std::string& c = options.command;
  json r{{"cmd", c},
         {"asker", "command_line"},
         {"language", text::user_language() == text::Language::russian ? "ru" : "en"}};
  const auto wrong = [&](const char* takes) {
    complain(kArguments, {c, takes});
    return json();
  };
  const auto not_a = [&](const std::string& what, std::string_view english, std::string_view russian) {
    complain(kBadNumber, {what, text::both(english, russian)});
    return json();
  };
  std::string_view rest;
  double value = 0.0;
  if (c == "home") {
    r["axes"] = a;
  } else if (c == "jog") {
    if (a.size() != 2) return wrong("AXIS +1mm | AXIS -0.5deg | AXIS + | AXIS -");
    r["axis"] = a[0];
    if (a[1] == "+" || a[1] == "-") {
      r["cmd"] = "jog_continuous";
      r["value"] = a[1] == "+" ? 1 : -1;
    } else {
      if (!parse_number(a[1], value, rest))
        return not_a(a[1], "a distance such as +1mm or -0.5deg", "перемещение вида +1mm или -0.5deg");
      r["value"] = value;
      if (!rest.empty()) r["unit"] = rest;
    }
  } else if (c == "zero") {
    if (a.empty() || a.size() > 2) return wrong("AXIS [VALUE]");
    if (a.size() == 2 && !parse_number(a[1], value, rest)) return not_a(a[1], "a number", "число");
    r["axis"] = a[0];
    r["value"] = value;
    if (!rest.empty()) r["unit"] = rest;
  } else if (c == "mdi") {
    if (a.empty()) return wrong("\"BLOCK\"");
    std::string block = a[0];
    for (std::size_t i = 1; i < a.size(); ++i) block += " " + a[i];
    r["block"] = block;
  } else if (c == "load") {
    if (a.size() != 1) return wrong("PROGRAM");
    r["program"] = std::filesystem::absolute(a[0]).string();
  } else if (c == "override") {
    if (a.size() != 1 || !parse_number(a[0], value, rest) || (!rest.empty() && rest != "%"))
      return wrong("PCT (0 to 150)");
    r["value"] = value;
  } else if (c == "power") {
    if (a.size() != 1 || (a[0] != "on" && a[0] != "off")) return wrong("on | off");
    r["value"] = a[0] == "on" ? 1 : 0;
  } else if (c == "input") {
    if (a.size() != 2) return wrong("POINT on | off | auto | NUMBER");
    r["point"] = a[0];
    if (a[1] == "on" || a[1] == "off")
      r["value"] = a[1] == "on";
    else if (a[1] == "auto")
      r["value"] = "auto";
    else if (parse_number(a[1], value, rest) && rest.empty())
      r["value"] = value;
    else
      return wrong("POINT on | off | auto | NUMBER");
  }
  return r;
}

std::string of(const json& object, const char* key) { return object.value(key, std::string()); }

void print_status(const json& s) {
  std::printf("%s: %s, %s%s, %.3f s\n", of(s, "machine").c_str(), of(s, "mode").c_str(),
              of(s, "state").c_str(), s.value("homing", false) ? ", homing" : "", s.value("time_s", 0.0));
  if (const std::string program = of(s, "program"); !program.empty())
    std::printf("program %s, line %d of %d\n", program.c_str(), s.value("line", 0), s.value("blocks", 0));
  std::printf("feed %.0f mm/min, override %.0f %%, tool %d\n", s.value("feed_mm_min", 0.0),
              s.value("override_pct", 0.0), s.value("tool", 0));
  for (const json& a : s.value("axes", json::array()))
    std::printf("  %-3s %12.4f %s%s  %s%s%s%s\n", of(a, "letter").c_str(), a.value("position", 0.0),
                of(a, "unit").c_str(), a.value("diameter", false) ? " (diameter)" : "",
                of(a, "drive").c_str(), a.value("homed", false) ? ", homed" : ", not homed",
                a.value("moving", false) ? ", moving" : "",
                a.value("on_limit", 0) != 0 ? ", on the hard limit" : "");
  for (const json& sp : s.value("spindles", json::array()))
    std::printf("  spindle %.0f rpm (commanded %.0f)  %s\n", sp.value("actual_rpm", 0.0),
                sp.value("command_rpm", 0.0), of(sp, "drive").c_str());
}

void print_alarms(const json& alarms) {
  for (const json& a : alarms)
    std::printf("%s %d %s: %s\n    %s\n", a.value("first", false) ? "*" : " ", a.value("number", 0),
                of(a, "id").c_str(), of(a, "text").c_str(), of(a, "remedy").c_str());
}

json ask(SocketClient& client, const json& request) {
  std::string answer;
  if (!client.exchange(request.dump(-1, ' ', false, json::error_handler_t::replace), answer)) return {};
  json reply = json::parse(answer, nullptr, false);
  return reply.is_object() ? reply : json();
}

/// Keeps a continuous jog alive until Enter, Ctrl-C, the end of standard input, or its own end.
json hold_jog(SocketClient& client, const json& request, const json& begun) {
  const int pause_ms = std::max(1, static_cast<int>(begun.value("keep_alive_ms", 30.0)));
  while (!ended) {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    if (poll(&in, 1, pause_ms) > 0) break;
    json reply = ask(client, {{"cmd", "keep_alive"}, {"language", request["language"]}});
    if (!reply.value("moving", false)) return reply;
  }
  return ask(client, {{"cmd", "jog_stop"}, {"axis", request["axis"]}, {"language", request["language"]}});
}

/// True when what `request` began is still under way; otherwise `code` is its exit code.
bool under_way(const json& request, const json& status, int& code) {
  const std::string command = request["cmd"], state = of(status, "state");
  const bool alarm = !status.value("alarms", json::array()).empty();
  const json axes = status.value("axes", json::array());
  const auto any = [&](auto&& is) { return std::any_of(axes.begin(), axes.end(), is); };
  code = alarm ? kAlarm : kDone;
  if (command == "home") {
    if (status.value("homing", false)) return true;
    const json named = request.value("axes", json::array());
    const bool open = any([&](const json& a) {
      return !a.value("homed", false) &&
             (named.empty() || std::find(named.begin(), named.end(), a["letter"]) != named.end());
    });
    if (open && !alarm) code = kStopped;
    return false;
  }
  if (command == "power") {
    if (request["value"] == 0) return any([](const json& a) { return a.value("enabled", false); });
    return !alarm && any([](const json& a) { return !a.value("enabled", false); });
  }
  if (command == "jog") return any([](const json& a) { return a.value("moving", false); });
  if (state == "running" || state == "waiting") return true;
  if (state == "held") return command != "step";
  if (state == "stopped_by_alarm") code = kAlarm;
  if (state == "idle" && !alarm) code = kStopped;
  return false;
}

/// Waits for the end of what was begun; Ctrl-C stops it.
int wait_for_end(SocketClient& client, const json& request, json& status) {
  int code = kDone;
  const json question{{"cmd", "status"}, {"language", request["language"]}};
  for (bool stopped = false;; std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
    status = ask(client, question);
    if (status.is_null()) return kInfrastructure;
    if (!under_way(request, status, code)) return stopped ? kStopped : code;
    if (ended && !stopped) {
      stopped = true;
      ask(client, {{"cmd", "stop"}});
    }
  }
}

int find_socket(const ClientOptions& options, std::string& path) {
  if (!options.socket.empty()) {
    path = options.socket;
    return kDone;
  }
  if (const char* named = std::getenv("SERVOGATE_SOCKET"); named != nullptr && *named != '\0') {
    path = named;
    return kDone;
  }
  const std::vector<std::string> found = known_sockets();
  if (found.empty()) {
    complain(kNoControl, {socket_folder()});
    return kInfrastructure;
  }
  if (found.size() > 1) {
    std::string list;
    for (const std::string& f : found) list += (list.empty() ? "" : ", ") + f;
    complain(kManyControls, {list});
    return kWrongUse;
  }
  path = found.front();
  return kDone;
}

}  // namespace

int client(const ClientOptions& options) {
  json request = request_of(options);
  if (request.is_null()) return kWrongUse;
  std::string path;
  if (const int code = find_socket(options, path); code != kDone) return code;
  SocketClient connection;
  if (const std::string problem = connection.connect(path); !problem.empty()) {
    complain(kNoConnection, {path, problem});
    return kInfrastructure;
  }
  const bool continuous = request["cmd"] == "jog_continuous";
  if (continuous || options.wait) {
    std::signal(SIGINT, on_end);
    std::signal(SIGTERM, on_end);
  }
  json reply = ask(connection, request);
  int code = reply.value("exit", kInfrastructure);
  if (code == kDone && continuous) {
    if (!options.json) std::fprintf(stderr, "%s\n", of(reply, "text").c_str());
    reply = hold_jog(connection, request, reply);
    code = reply.value("exit", kInfrastructure);
  } else if (code == kDone && options.wait) {
    if (!options.json) std::fprintf(stderr, "%s\n", of(reply, "text").c_str());
    code = wait_for_end(connection, request, reply);
    if (!reply.is_null()) reply["exit"] = code;
  }
  if (reply.is_null()) {
    complain(kConnectionLost, {path});
    return kInfrastructure;
  }
  if (options.json) {
    std::printf("%s\n", reply.dump(1).c_str());
  } else if (!reply.value("ok", false)) {
    std::fprintf(stderr, "servogate: %s [%s]\n", of(reply, "text").c_str(), of(reply, "code").c_str());
  } else if (options.command == "status") {
    print_status(reply);
    print_alarms(reply["alarms"]);
  } else if (options.command == "alarms") {
    if (reply["alarms"].empty())
      std::printf("%s\n", text::render(kNoAlarms, {}, text::user_language()).c_str());
    print_alarms(reply["alarms"]);
  } else if (options.wait) {
    print_status(reply);
    print_alarms(reply["alarms"]);
  } else {
    std::printf("%s\n", of(reply, "text").c_str());
  }
  return code;
}

}  // namespace servogate::gateway::command
