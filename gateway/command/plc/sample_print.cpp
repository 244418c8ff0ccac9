// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/plc/sample_print.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/standard_output.hpp"

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

std::string mark(const json& value) { return value.contains("forced") ? say(kForced) : std::string(); }

void print_lines(const json& answer) {
  print_line(answer.value("file", "") + " (" + answer.value("body", "") + ")");
  for (const json& line : answer["lines"]) {
    std::string values;
    for (const json& v : line["values"]) {
      const std::string name = v.value("name", "");
      values += (values.empty() ? "  | " : ", ") + name + " = " + shown(v["value"]) + mark(v);
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

}  // namespace

void print_sample(const json& answer) {
  print_line(say(kHead, {std::to_string(answer.value("cycle", std::int64_t{0})),
                         text::number(answer.value("time_s", 0.0), 3)}));
  if (answer.contains("lines")) return print_lines(answer);
  for (const json& v : answer.value("values", json::array())) {
    const std::string name = v.value("name", "");
    print_line("  " + name + " = " + shown(v["value"]) + mark(v));
  }
  if (!answer.contains("tasks")) return;
  print_line(say(kTimes));
  print_times(answer["tasks"], "  ");
  print_times(answer["blocks"], "    ");
}

}  // namespace servogate::gateway::command
