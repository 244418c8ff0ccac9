// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/touch.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/units.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/client/confirm.hpp"
#include "gateway/command/client/connection.hpp"
#include "gateway/command/client/show.hpp"
#include "gateway/command/client/tables.hpp"
#include "gateway/command/client/wait.hpp"
#include "gateway/command/signals.hpp"
#include "report/touches.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

const text::Entry kWords{"touch.words",
                         "'{0}': touch [tool N | origin N] AXIS[VALUE] by=MM, with feed=, slow=, back=, "
                         "times= and radius= as you like",
                         "«{0}»: touch [tool N | origin N] ОСЬ[ЗНАЧЕНИЕ] by=ММ, при желании feed=, slow=, "
                         "back=, times= и radius="};
const text::Entry kGoThere{"touch.go", "measure so? (y/n)", "измерить так? (y/n)"};
const text::Entry kNotMeasured{"touch.not-measured",
                               "the measurement did not come to its end: nothing is written",
                               "измерение не завершено: ничего не записано"};
const text::Entry kMoved{"touch.moved", "{0} was at {1} mm and is at {2} mm: it was moved meanwhile; {3}",
                         "{0} стояла на {1} мм, а стоит на {2} мм: её тем временем переместили; {3}"};
const text::Entry kNotBegun{"touch.not-begun", "nothing is measured", "измерение не начато"};
const text::Entry kMeasureAgain{"touch.again", "the row of the table is wrong: measure again",
                                "строка таблицы неверна: измерьте снова"};
const text::Entry kFound{"touch.found", "{0} is touched at {1} mm (machine coordinates)",
                         "{0}: касание на {1} мм (в координатах станка)"};
const text::Entry kRepeats{"touch.repeats", "{0} touches: spread {1} µm, standard deviation {2} µm",
                           "касаний: {0}, размах {1} мкм, среднее квадратичное отклонение {2} мкм"};
const text::Entry kBefore{"touch.before", "before: {0}", "было: {0}"};
const text::Entry kAfter{"touch.after", "after: {0}", "стало: {0}"};
const text::Entry kNothing{"touch.nothing", "nothing set", "ничего не задано"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments = {}) {
  return text::render(entry, arguments, text::user_language());
}

/// What the words ask for.
struct Wanted {
  std::string table;  ///< "tool", "origin"; empty: it only measures
  int number = -1;
  std::string axis;
  double value = 0.0;   ///< that the touched place reads, in the origin in force
  double radius = 0.0;  ///< of the probe's ball, mm
  json request;
};

/// A number, in mm or inches; false: none.
bool read_length(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (error != std::errc{} || !std::isfinite(value) || !(unit.empty() || unit == "mm" || unit == "in"))
    return false;
  if (unit == "in") value *= 25.4;
  return true;
}

/// Z, Z12.5
bool read_axis(const std::string& word, Wanted& wanted) {
  std::size_t letters = 0;
  while (letters < word.size() && std::isalpha(static_cast<unsigned char>(word[letters])) != 0) ++letters;
  if (letters == 0 || !wanted.axis.empty()) return false;
  if (letters < word.size() && (wanted.table.empty() || !read_length(word.substr(letters), wanted.value)))
    return false;
  wanted.axis = word.substr(0, letters);
  std::transform(wanted.axis.begin(), wanted.axis.end(), wanted.axis.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return true;
}

bool read_word(const std::string& word, Wanted& wanted) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return read_axis(word, wanted);
  const std::string key = word.substr(0, equals);
  double value = 0.0;
  if (!read_length(word.substr(equals + 1), value)) return false;
  if (key == "radius" && value >= 0.0) {
    wanted.radius = value;
    return true;
  }
  constexpr const char* kKeys[] = {"by", "feed", "slow", "back", "times"};
  if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys)) return false;
  wanted.request[key] = value;
  return true;
}

std::optional<Wanted> read(const ClientOptions& options) {
  Wanted wanted;
  wanted.request = {{"cmd", "touch"},
                    {"asker", "command_line"},
                    {"language", text::user_language() == text::Language::russian ? "ru" : "en"}};
  const std::vector<std::string>& a = options.arguments;
  const auto wrong = [&](const std::string& word) {
    complain(kWords, {word});
    return std::nullopt;
  };
  std::size_t n = 0;
  if (!a.empty() && (a[0] == "tool" || a[0] == "origin")) {
    wanted.table = a[0];
    const char* const last = a.size() > 1 ? a[1].data() + a[1].size() : nullptr;
    if (a.size() < 2 || std::from_chars(a[1].data(), last, wanted.number).ptr != last || wanted.number < 0)
      return wrong(a.size() < 2 ? a[0] : a[1]);
    n = 2;
  }
  for (; n < a.size(); ++n)
    if (!read_word(a[n], wanted)) return wrong(a[n]);
  if (wanted.axis.empty() || !wanted.request.contains("by"))
    return wrong(wanted.axis.empty() ? "AXIS" : "by");
  wanted.request["axis"] = wanted.axis;
  return wanted;
}

/// Shows what would be done, and asks; nullopt: yes.
std::optional<int> ask_person(SocketClient& connection, json request) {
  request["plan"] = true;
  const json plan = ask(connection, request);
  if (plan.value("exit", kInfrastructure) != kDone) {
    print_refusal(plan);
    return plan.value("exit", kInfrastructure);
  }
  print_line(plan.value("text", ""));
  return confirmed(kGoThere);
}

/// Places as people see them, with what they say together: mm.
struct Measured : report::Repeatability {
  std::vector<double> places;
};

Measured measured_from(const json& status) {
  Measured m;
  const json touched = status.value("touched", json());
  if (!touched.is_object()) return m;
  m.places = touched.value("places", std::vector<double>{});
  static_cast<report::Repeatability&>(m) = report::repeatability(m.places);
  return m;
}

json axis_of(const json& status, const std::string& letter) {
  for (const json& a : status.value("axes", json::array()))
    if (a.value("letter", "") == letter) return a;
  return json::object();
}

constexpr double kSamePlace = 0.01;  // mm

/// Says that the axis does not stand where it was; true: it does.
bool stands_still(const std::string& letter, const json& before, const json& now, const text::Entry& so) {
  const double was = axis_of(before, letter).value("command", 0.0),
               is = axis_of(now, letter).value("command", 0.0);
  if (std::abs(is - was) <= kSamePlace) return true;
  complain(kMoved, {letter, text::number(was, 4), text::number(is, 4), text::both(so.english, so.russian)});
  return false;
}

/// Where the axis stands now reads what the touched place is to read, and the way between them.
json row_request(const Wanted& wanted, const Measured& m, const json& axis) {
  const double across = axis.value("diameter", false) ? 2.0 : 1.0;
  const double sign = wanted.request["by"].get<double>() < 0.0 ? -1.0 : 1.0;
  const double place = m.mean + sign * wanted.radius * across;
  json r{{"cmd", "table_here"},
         {"asker", "command_line"},
         {"language", wanted.request["language"]},
         {"table", wanted.table},
         {"number", wanted.number}};
  r["values"][wanted.axis] = wanted.value + axis.value("command", 0.0) - place;
  return r;
}

/// A refusal or an alarm; nothing was written.
int give_up(const json& status, int code) {
  complain(kNotMeasured, {});
  if (status.is_object()) print_alarms(status.value("alarms", json::array()));
  return code != kDone ? code : kAlarm;
}

int show(const ClientOptions& options, const Wanted& wanted, const Measured& m, const std::string& before,
         const json& written) {
  const bool good = wanted.table.empty() || written.value("exit", kInfrastructure) == kDone;
  if (options.json) {
    const json out{{"ok", good},
                   {"exit", good ? kDone : written.value("exit", kInfrastructure)},
                   {"axis", wanted.axis},
                   {"places", m.places},
                   {"mean", m.mean},
                   {"spread_mm", m.spread},
                   {"deviation_mm", m.deviation},
                   {"before", before},
                   {"after", written.is_object() ? written.value("text", "") : ""}};
    print_exact(out.dump(1, ' ', false, json::error_handler_t::replace));
    return out["exit"];
  }
  print_line(say(kFound, {wanted.axis, text::number(m.mean, 4)}));
  if (m.places.size() > 1)
    print_line(say(kRepeats, {std::to_string(m.places.size()), text::number(m.spread * 1e3, 2),
                              text::number(m.deviation * 1e3, 2)}));
  if (wanted.table.empty()) return kDone;
  if (!good) {
    print_refusal(written);
    return written.value("exit", kInfrastructure);
  }
  print_line(say(kBefore, {before.empty() ? say(kNothing) : before}));
  print_line(say(kAfter, {written.value("text", "")}));
  return kDone;
}

}  // namespace

int touch(const ClientOptions& options) {
  std::optional<Wanted> wanted = read(options);
  if (!wanted) return kWrongUse;
  std::string path;
  SocketClient connection;
  if (const int found = connect_to_control(options.socket, connection, path); found != kDone) return found;
  count_signals();
  const json language = wanted->request["language"];
  const json first = ask(connection, {{"cmd", "status"}, {"language", language}});
  if (first.is_null()) return connection_lost(path);
  if (const json process = axis_of(first, wanted->axis).value("process", json()); process.is_number())
    wanted->request["process"] = process;
  if (!options.yes) {
    if (const std::optional<int> code = ask_person(connection, wanted->request)) return *code;
    const json now = ask(connection, {{"cmd", "status"}, {"language", language}});
    if (now.is_null()) return connection_lost(path);
    if (!stands_still(wanted->axis, first, now, kNotBegun)) return kStopped;
  }
  json status = ask(connection, wanted->request);
  if (status.is_null()) return connection_lost(path);
  if (status.value("exit", kInfrastructure) != kDone) {
    print_refusal(status);
    return status.value("exit", kInfrastructure);
  }
  if (!options.json) tell(status.value("text", ""));
  const int code = wait_for_end(connection, wanted->request, status);
  if (status.is_null()) return connection_lost(path);
  const Measured m = measured_from(of_process(status, wanted->request));
  if (code != kDone || m.places.empty()) return give_up(status, code);
  std::string before;
  json written;
  if (!wanted->table.empty()) {
    const json tables = ask(connection, {{"cmd", "tables"}, {"language", language}});
    before = tables.is_object() ? table_row_words(wanted->table, wanted->number, tables) : std::string();
    written = ask(connection, row_request(*wanted, m, axis_of(status, wanted->axis)));
    if (written.is_null()) return connection_lost(path);
    const json now = ask(connection, {{"cmd", "status"}, {"language", language}});
    if (now.is_null()) return connection_lost(path);
    if (!stands_still(wanted->axis, status, now, kMeasureAgain)) return kStopped;
  }
  return show(options, *wanted, m, before, written);
}

}  // namespace servogate::gateway::command
