// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/tables.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "firmware_if/text/decimal_comma.hpp"
#include "firmware_if/text/system_words.hpp"
#include "firmware_if/text/units.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/control/server/protocol/request_words.hpp"
#include "machine/tables/exchange.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

const text::Entry kActions{
    "client.table-actions",
    "`{0}` takes: list | set N VALUE... | here N AXIS... | clear N | undo | import FILE | "
    "export FILE",
    "`{0}` принимает: list | set N ЗНАЧЕНИЕ... | here N ОСЬ... | clear N | undo | import "
    "ФАЙЛ | export ФАЙЛ"};
const text::Entry kBadWord{"client.bad-table-word", "'{0}' is no value; written as X100, Z-12.5 or length=85",
                           "«{0}» — не величина; пишется X100, Z-12.5 или length=85"};
const text::Entry kNoRows{"client.no-rows", "the table of {0} is empty", "таблица пуста: {0}"};
const text::Entry kRow{"client.table-row", "{0} {1}: {2}", "{0} {1}: {2}"};
const text::Entry kWritten{"client.table-written", "{0} is written", "файл {0} записан"};
const text::Entry kNotWritten{"client.table-not-written", "{0} cannot be written: {1}",
                              "файл {0} не записывается: {1}"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

/// "X-12.5", "length=85", "name=face mill" into the values of a row; false: it was said.
bool read_word(const std::string& word, json& request) {
  std::size_t name = 0;
  while (name < word.size() &&
         (std::isalpha(static_cast<unsigned char>(word[name])) != 0 || word[name] == '_'))
    ++name;
  const bool equals = name < word.size() && word[name] == '=';
  std::string_view rest = std::string_view(word).substr(name + (equals ? 1 : 0));
  const std::string key = word.substr(0, name);
  if (equals && key == "name") {
    request["name"] = std::string(rest);
    return true;
  }
  if (const std::string point = text::with_decimal_point(std::string(rest)); !point.empty()) {
    complain(kComma, {word, key + (equals ? "=" : "") + point});
    return false;
  }
  if (rest.starts_with('+')) rest.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(rest.data() + rest.size() - end));
  if (key.empty() || rest.empty() || error != std::errc{} ||
      !(unit.empty() || unit == "mm" || unit == "in") || !std::isfinite(value)) {
    complain(kBadWord, {word});
    return false;
  }
  request["values"][key] = value;
  if (unit == "in") request["inches"].push_back(key);
  return true;
}

std::string joined(const json& values, const json& axes, const std::string& before) {
  std::string out;
  for (const auto& [letter, value] : values.items()) {
    std::string unit = "mm";
    bool diameter = false;
    for (const json& a : axes)
      if (a.value("letter", "") == letter) {
        unit = a.value("unit", "mm");
        diameter = a.value("diameter", false);
      }
    out += (out.empty() ? "" : ", ") + before + letter + " " + text::number(value.get<double>(), 4) + " " +
           text::unit_words(unit) + (diameter ? text::both(" (diameter)", " (диаметр)") : "");
  }
  return out;
}

std::string tool_words(const json& row, const json& axes) {
  std::string out = row.value("name", "");
  const auto add = [&](const std::string& more) {
    if (!more.empty()) out += (out.empty() ? "" : ", ") + more;
  };
  const std::string mm = " " + text::unit_words("mm");
  add(joined(row["length"], axes, text::both("length ", "вылет ")));
  if (const double r = row.value("radius", 0.0); r != 0.0)
    add(text::both("radius ", "радиус ") + text::number(r, 4) + mm);
  add(joined(row["wear"], axes, text::both("wear ", "износ ")));
  if (const double r = row.value("radius_wear", 0.0); r != 0.0)
    add(text::both("wear of the radius ", "износ радиуса ") + text::number(r, 4) + mm);
  add(joined(row["wear_limit"], axes, text::both("wear at most ", "износ не более ")));
  if (const double r = row.value("radius_wear_limit", 0.0); r != 0.0)
    add(text::both("wear of the radius at most ", "износ радиуса не более ") + text::number(r, 4) + mm);
  if (const int q = row.value("quadrant", 0); q != 0)
    add(text::both("quadrant ", "квадрант ") + std::to_string(q));
  add(machine::life_words(row.value("life_min", 0.0), row.value("used_min", 0.0), row.value("alternate", 0)));
  return out;
}

}  // namespace

bool is_table_command(const ClientOptions& options) {
  return options.command == "origin" || options.command == "tool";
}

json table_request(const ClientOptions& options, json request) {
  const std::vector<std::string>& a = options.arguments;
  const std::string& action = a[0];
  const auto wrong = [&] {
    complain(kActions, {options.command});
    return json();
  };
  request["table"] = options.command;
  if (action == "list" || action == "undo") {
    if (a.size() != 1) return wrong();
    request["cmd"] = action == "list" ? "tables" : "table_undo";
    return request;
  }
  if (action == "import" || action == "export") {
    if (a.size() != 2) return wrong();
    request["cmd"] = "table_" + action;
    if (action == "import")
      request["file"] = std::filesystem::absolute(a[1]).string();
    else
      request["form"] = machine::names_linuxcnc(a[1]) ? "linuxcnc" : "csv";
    return request;
  }
  const bool clear = action == "clear";
  if (!clear && action != "set" && action != "here") return wrong();
  if (clear ? a.size() != 2 : a.size() < 2) return wrong();
  int number = -1;
  const auto [end, error] = std::from_chars(a[1].data(), a[1].data() + a[1].size(), number);
  if (error != std::errc{} || end != a[1].data() + a[1].size() || number < 0) {
    complain(kBadNumber, {a[1], text::both("a number of a row", "номер строки")});
    return {};
  }
  request["cmd"] = "table_" + action;
  request["number"] = number;
  for (std::size_t i = 2; i < a.size(); ++i)
    if (!read_word(a[i], request)) return {};
  return request;
}

std::string table_row_words(const std::string& table, int number, const json& reply) {
  const bool origins = table == "origin";
  for (const json& row : reply.value(origins ? "origins" : "tools", json::array()))
    if (row.value("number", -1) == number)
      return text::render(
          kRow,
          std::vector<std::string>{
              origins ? text::both("origin", "начало") : text::both("tool", "инструмент"),
              std::to_string(number),
              origins ? joined(row["values"], reply["axes"], "") : tool_words(row, reply["axes"])},
          text::user_language());
  return {};
}

void print_table(const ClientOptions& options, const json& reply) {
  const bool origins = options.command == "origin";
  const json rows = reply.value(origins ? "origins" : "tools", json::array());
  const std::string what = origins ? text::both("origin", "начало") : text::both("tool", "инструмент");
  if (rows.empty())
    print_line(say(kNoRows,
                   {origins ? text::both("origins", "начала отсчёта") : text::both("tools", "инструмент")}));
  for (const json& row : rows) {
    std::string words = origins ? joined(row["values"], reply["axes"], "") : tool_words(row, reply["axes"]);
    if (words.empty()) words = text::both("nothing set", "ничего не задано");
    print_line(say(kRow, {what, std::to_string(row.value("number", 0)), words}));
  }
}

int write_export(const ClientOptions& options, const json& reply) {
  const std::string& path = options.arguments[1];
  const std::string content = reply.value("content", "");
  if (path == "-") {
    print_exact(content);
    return kDone;
  }
  std::FILE* file = std::fopen(path.c_str(), "wb");
  const bool good = file != nullptr && std::fwrite(content.data(), 1, content.size(), file) == content.size();
  const int error = errno;
  const bool closed = file == nullptr || std::fclose(file) == 0;
  if (!good || !closed) {
    complain(kNotWritten, {path, text::words_of(error)});
    return kWrongUse;
  }
  print_line(say(kWritten, {path}));
  return kDone;
}

}  // namespace servogate::gateway::command
