// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/request/request_form.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;

/// Zero characters end a name for the system: another file would be read than the one that was said.
bool has_zero(const json& v) {
  return v.is_string() && v.get_ref<const std::string&>().find('\0') != std::string::npos;
}
bool is_text(const json& v) { return v.is_string() && !has_zero(v); }
bool is_number(const json& v) { return v.is_number(); }
bool is_switch(const json& v) { return v.is_boolean(); }
bool is_list(const json& v) { return v.is_array() && std::all_of(v.begin(), v.end(), is_text); }
bool is_language(const json& v) { return v == "en" || v == "ru"; }
bool is_played(const json& v) { return v.is_number() || v.is_boolean() || v.is_string(); }

struct Type {
  bool (*is)(const json& value);
  std::string_view english, russian;
};
constexpr Type kText{is_text, "a string", "строка"};
constexpr Type kNumber{is_number, "a number", "число"};
constexpr Type kSwitch{is_switch, "true or false", "true или false"};
constexpr Type kList{is_list, "a list of strings", "список строк"};
constexpr Type kLanguage{is_language, "'en' or 'ru'", "'en' или 'ru'"};
constexpr Type kPlayed{is_played, "a number, true, false or a string", "число, true, false или строка"};

/// The first row that fits tells the type of a field; `command` empty: the same in all others.
constexpr struct {
  std::string_view command, key;
  const Type& type;
} kFields[] = {{"", "cmd", kText},          {"", "asker", kText},          {"", "language", kLanguage},
               {"", "axis", kText},         {"", "axes", kList},           {"", "unit", kText},
               {"input", "value", kPlayed}, {"plc_force", "value", kText}, {"", "value", kNumber},
               {"", "block", kText},        {"", "program", kText},        {"", "dialect", kText},
               {"", "point", kText},        {"", "name", kText},           {"", "names", kList},
               {"", "body", kText},         {"", "times", kSwitch},        {"", "stay", kSwitch},
               {"", "files", kList},        {"", "online", kSwitch},       {"", "while_running", kSwitch},
               {"", "bus", kText},          {"", "node", kNumber},         {"", "index", kNumber},
               {"", "subindex", kNumber},   {"", "scans", kNumber},
               {"", "count", kNumber}};

/// Without which a request says nothing.
constexpr struct {
  std::string_view command, key;
} kNeeded[] = {{"jog", "axis"},     {"jog_continuous", "axis"}, {"zero", "axis"},
               {"load", "program"}, {"mdi", "block"},           {"input", "point"}};

std::string what_stands(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case json::value_t::string:
      return has_zero(value) ? text::both("a string with a zero character", "строка с нулевым символом")
                             : text::both("a string", "строка");
    case json::value_t::array:
      return text::both("a list", "список");
    case json::value_t::object:
      return text::both("an object", "объект");
    default:
      return text::both("a number", "число");
  }
}

void wrong_type(std::string_view key, const Type& type, const std::string& stands, FormProblem& problem) {
  problem.entry = &says::kWrongType;
  problem.arguments = {std::string(key), text::both(type.english, type.russian), stands};
}

}  // namespace

text::Language language_of(const json& request) {
  const auto found = request.find("language");
  if (found != request.end() && *found == "ru") return text::Language::russian;
  if (found != request.end() && *found == "en") return text::Language::english;
  return text::user_language();
}

std::optional<json> read_request(std::string_view line, FormProblem& problem) {
  if (line.find_first_not_of(" \t") == std::string_view::npos) {
    problem = {&says::kNoObject, {text::both("an empty line", "пустая строка")}};
    return std::nullopt;
  }
  bool deep = false;
  std::set<std::string> keys;
  std::string repeated;
  const auto look = [&](int depth, json::parse_event_t event, json& parsed) {
    deep = deep || depth > kDeepestRequest;
    if (event == json::parse_event_t::key && depth == 1 && !keys.insert(parsed).second) repeated = parsed;
    return !deep;
  };
  json request = json::parse(line, look, false);
  if (deep) {
    problem = {&says::kNested, {std::to_string(kDeepestRequest)}};
    return std::nullopt;
  }
  if (request.is_discarded()) {
    problem = {&says::kBadLine, {std::string(line.substr(0, 80))}};
    return std::nullopt;
  }
  if (!request.is_object()) {
    problem = {&says::kNoObject, {what_stands(request)}};
    return std::nullopt;
  }
  problem.language = language_of(request);
  if (!repeated.empty()) {
    problem.entry = &says::kRepeated;
    problem.arguments = {repeated};
    return std::nullopt;
  }
  if (!request.contains("cmd")) {
    wrong_type("cmd", kText, text::both("missing", "поля нет"), problem);
    return std::nullopt;
  }
  const std::string command = request["cmd"].is_string() ? request["cmd"].get<std::string>() : std::string();
  for (auto field = std::begin(kFields); field != std::end(kFields); ++field) {
    const auto found = request.find(field->key);
    if (found == request.end() || (!field->command.empty() && field->command != command)) continue;
    const auto first = std::find_if(std::begin(kFields), std::end(kFields), [&](const auto& row) {
      return row.key == field->key && (row.command.empty() || row.command == command);
    });
    if (first != field || field->type.is(*found)) continue;
    const bool other_word = &field->type == &kLanguage && found->is_string();
    wrong_type(field->key, field->type,
               other_word ? "'" + found->get<std::string>().substr(0, 20) + "'" : what_stands(*found),
               problem);
    return std::nullopt;
  }
  for (const auto& needed : kNeeded)
    if (needed.command == command && !request.contains(needed.key)) {
      wrong_type(needed.key, kText, text::both("missing", "поля нет"), problem);
      return std::nullopt;
    }
  return request;
}

}  // namespace servogate::gateway
