// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"
#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kHead{"plc-watch.head", "cycle {0}, {1} s", "цикл {0}, {1} с"};
const text::Entry kForced{"plc-watch.forced", "  (forced)", "  (удерживается)"};
const text::Entry kTimes{"plc-watch.times", "us: last, average, most, count",
                         "мкс: последнее, среднее, наибольшее, число"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments = {}) {
  return text::render(entry, arguments, text::user_language());
}

std::string shown(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "TRUE" : "FALSE";
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

bool is_forced(const json& answer, const std::string& name) {
  const json forced = answer.value("forced", json::array());
  return std::any_of(forced.begin(), forced.end(), [&](const json& f) {
    const std::string full = f.value("name", "");
    return full == name || full.ends_with("." + name);
  });
}

void print_lines(const json& answer) {
  print_line(answer.value("file", "") + " (" + answer.value("body", "") + ")");
  for (const json& line : answer["lines"]) {
    std::string values;
    for (const json& v : line["values"]) {
      const std::string name = v.value("name", "");
      values += (values.empty() ? "  | " : ", ") + name + " = " + shown(v["value"]) +
                (is_forced(answer, name) ? say(kForced) : "");
    }
    print_formatted("%5d  %-60s%s\n", line.value("line", 0), line.value("text", "").c_str(), values.c_str());
  }
}

void print_times(const json& rows, const char* indent) {
  for (const json& r : rows)
    print_formatted("%s%-24s %10.3f %10.3f %10.3f %10lld\n", indent, r.value("name", "").c_str(),
                    r.value("last_us", 0.0), r.value("average_us", 0.0), r.value("most_us", 0.0),
                    static_cast<long long>(r.value("count", std::int64_t{0})));
}

void print_sample(const json& answer) {
  print_line(say(kHead, {std::to_string(answer.value("cycle", std::int64_t{0})),
                         text::number(answer.value("time_s", 0.0), 3)}));
  if (answer.contains("lines")) return print_lines(answer);
  for (const json& v : answer.value("values", json::array())) {
    const std::string name = v.value("name", "");
    print_line("  " + name + " = " + shown(v["value"]) + (is_forced(answer, name) ? say(kForced) : ""));
  }
  if (!answer.contains("tasks")) return;
  print_line(say(kTimes));
  print_times(answer["tasks"], "  ");
  print_times(answer["blocks"], "    ");
}

}  // namespace

int plc_watch(const PlcWatchOptions& options) {
  ControlClient control;
  if (const int code = control.connect(options.socket); code != kDone) return code;
  count_signals();
  json request{{"names", options.names}, {"times", options.times}};
  if (options.names.empty() && !options.times) request["body"] = options.body;
  for (int n = 0; (options.samples == 0 || n < options.samples) && signals_seen() == 0; ++n) {
    if (n > 0) std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(options.every_ms));
    if (signals_seen() > 0) break;
    const json answer = control.ask("plc_watch", request);
    const int code = ControlClient::tell(answer, options.json);
    if (code != kDone) return code;
    if (!options.json) print_sample(answer);
  }
  return kDone;
}

}  // namespace servogate::gateway::command
