// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/request_form.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "gateway/control/server/protocol/texts.hpp"

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
bool is_values(const json& v) {
  return v.is_object() && std::all_of(v.begin(), v.end(), [](const json& e) { return e.is_number(); });
}
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
constexpr Type kValues{is_values, "an object of numbers", "объект из чисел"};
constexpr Type kLanguage{is_language, "'en' or 'ru'", "'en' или 'ru'"};
constexpr Type kPlayed{is_played, "a number, true, false or a string", "число, true, false или строка"};

/// The first row that fits tells the type of a field; `command` empty: the same in all others.
constexpr struct {
  std::string_view command, key;
  const Type& type;
} kFields[] = {{"", "cmd", kText},
               {"", "asker", kText},
               {"", "language", kLanguage},
               {"", "axis", kText},
               {"", "axes", kList},
               {"", "unit", kText},
               {"input", "value", kPlayed},
               {"plc_force", "value", kText},
               {"", "value", kNumber},
               {"", "block", kText},
               {"", "program", kText},
               {"", "dialect", kText},
               {"", "point", kText},
               {"", "name", kText},
               {"", "names", kList},
               {"", "body", kText},
               {"touch", "times", kNumber},
               {"", "times", kSwitch},
               {"", "by", kNumber},
               {"", "slow", kNumber},
               {"", "back", kNumber},
               {"", "stay", kSwitch},
               {"", "files", kList},
               {"", "online", kSwitch},
               {"", "while_running", kSwitch},
               {"", "bus", kText},
               {"", "node", kNumber},
               {"", "index", kNumber},
               {"", "subindex", kNumber},
               {"", "scans", kNumber},
               {"", "count", kNumber},
               {"", "process", kNumber},
               {"", "table", kText},
               {"", "number", kNumber},
               {"", "values", kValues},
               {"", "inches", kList},
               {"", "line", kNumber},
               {"", "feed", kNumber},
               {"", "confirm", kSwitch},
               {"", "plan", kSwitch},
               {"", "file", kText},
               {"", "form", kText}};

/// Without which a request says nothing.
constexpr struct {
  std::string_view command, key;
} kNeeded[] = {{"jog", "axis"},     {"jog_continuous", "axis"}, {"zero", "axis"},
               {"load", "program"}, {"mdi", "block"},           {"touch", "axis"},
               {"input", "point"},  {"assign", "axis"},         {"table_import", "file"}};

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

/// Language that a request asks for by `language`; without it the control's own.
text::Language language_of(const json& request) {
  const auto found = request.find("language");
  if (found != request.end() && *found == "ru") return text::Language::russian;
  if (found != request.end() && *found == "en") return text::Language::english;
  return text::user_language();
}

/// An object each of whose known fields has its type; `cmd` is there. nullopt: `problem` says what is wrong.
std::optional<json> read_object(std::string_view line, FormProblem& problem) {
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

constexpr struct {
  std::string_view name;
  image::Asker asker;
} kAskers[] = {{"command_line", image::Asker::command_line},
               {"page", image::Asker::page},
               {"pendant", image::Asker::pendant},
               {"scenario", image::Asker::scenario},
               {"modbus", image::Asker::modbus},
               {"bench", image::Asker::bench}};

/// False: nobody of that name may ask here.
bool read_asker(const json& request, image::Asker& asker, FormProblem& problem) {
  const std::string name = request.value("asker", "command_line");
  std::string known;
  for (const auto& row : kAskers) {
    if (row.name == name) {
      asker = row.asker;
      return true;
    }
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  problem.entry = &says::kUnknownAsker;
  problem.arguments = {name, known};
  return false;
}

/// The fields of a command, whose types have been looked at.
class Fields {
 public:
  Fields(const json& request, FormProblem& problem) : request_(request), problem_(problem) {}
  std::string text(const char* key) const { return request_.value(key, ""); }
  std::optional<double> number_if(const char* key) {
    if (!request_.contains(key)) return std::nullopt;
    return number(key, 0.0);
  }
  std::optional<std::string> text_if(const char* key) const {
    return request_.contains(key) ? std::optional(text(key)) : std::nullopt;
  }
  std::vector<std::string> list(const char* key) const {
    return request_.value(key, std::vector<std::string>{});
  }
  bool is_set(const char* key) const { return request_.value(key, false); }
  double number(const char* key, double otherwise) const { return request_.value(key, otherwise); }
  /// One without which the command says nothing.
  double needed(const char* key) {
    if (!request_.contains(key)) refuse(says::kNoNumber, key);
    return number(key, 0.0);
  }
  bool switched(const char* key) {
    const double value = needed(key);
    if (request_.contains(key) && value != 0.0 && value != 1.0) refuse(says::kNotSwitch, key);
    return value != 0.0;
  }
  /// A whole number from 0 to `most`; -1: it is none.
  int whole(const char* key, std::int64_t most) const {
    const auto found = request_.find(key);
    if (found == request_.end() || !found->is_number_integer()) return -1;
    const bool large = found->is_number_unsigned() && found->get<std::uint64_t>() > 0x7FFFFFFF;
    const auto value = large ? -1 : found->get<std::int64_t>();
    return value >= 0 && value <= most ? static_cast<int>(value) : -1;
  }
  /// From 0, of the field that counts from 1; whether the machine has it is the desk's matter.
  int process(int otherwise) {
    if (!request_.contains("process")) return otherwise;
    const int number = whole("process", image::kMaxProcesses);
    if (number < 1) {
      problem_.entry = &says::kNotProcess;
      problem_.arguments = {std::to_string(image::kMaxProcesses)};
    }
    return number - 1;
  }
  /// A whole number, where it is said; -1: it is none.
  std::optional<int> counted(const char* key) const {
    return request_.contains(key) ? std::optional(whole(key, 100'000'000)) : std::nullopt;
  }
  std::optional<ask::Table> table() {
    const std::string name = text("table");
    if (name == "origin") return ask::Table::origin;
    if (name == "tool") return ask::Table::tool;
    problem_.entry = &says::kNotTable;
    problem_.arguments = {name};
    return std::nullopt;
  }
  std::map<std::string, double> values() const {
    return request_.value("values", std::map<std::string, double>{});
  }
  ask::TableSet table_row(bool here) {
    return {table(), whole("number", 0xFFFF), values(), text_if("name"), here, list("inches")};
  }
  std::variant<std::monostate, bool, double> played(const char* key) {
    const json value = request_.value(key, json());
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number()) return value.get<double>();
    if (value != "auto") refuse(says::kNoNumber, key);
    return {};
  }

 private:
  void refuse(const text::Entry& entry, const char* key) {
    problem_.entry = &entry;
    problem_.arguments = {key};
  }
  const json& request_;
  FormProblem& problem_;
};

using ask::Command;
constexpr struct {
  std::string_view name;
  Command (*read)(Fields& f);
} kCommands[] = {
    {"status", [](Fields&) -> Command { return ask::Status{}; }},
    {"buses", [](Fields&) -> Command { return ask::Buses{}; }},
    {"alarms", [](Fields&) -> Command { return ask::Alarms{}; }},
    {"history", [](Fields& f) -> Command { return ask::History{f.number("count", 100.0)}; }},
    {"sdo_read",
     [](Fields& f) -> Command {
       return ask::SdoRead{f.text("bus"), f.whole("node", 0xFFFF), f.whole("index", 0xFFFF),
                           f.whole("subindex", 0xFF)};
     }},
    {"power", [](Fields& f) -> Command { return ask::Power{f.switched("value")}; }},
    {"home", [](Fields& f) -> Command { return ask::Home{f.list("axes")}; }},
    {"jog",
     [](Fields& f) -> Command {
       return ask::Jog{f.text("axis"), f.needed("value"), f.text("unit")};
     }},
    {"jog_continuous",
     [](Fields& f) -> Command {
       return ask::JogContinuous{f.text("axis"), f.needed("value")};
     }},
    {"zero",
     [](Fields& f) -> Command {
       return ask::Zero{f.text("axis"), f.number("value", 0.0), f.text("unit")};
     }},
    {"override",
     [](Fields& f) -> Command {
       return ask::Override{f.needed("value"), f.process(0)};
     }},
    {"path_wheel",
     [](Fields& f) -> Command {
       using What = ask::PathWheel::What;
       return ask::PathWheel{f.process(0), f.switched("value") ? What::choose : What::leave, 0.0};
     }},
    {"load",
     [](Fields& f) -> Command {
       return ask::Load{f.text("program"), f.text("dialect"), f.process(0)};
     }},
    {"start", [](Fields& f) -> Command { return ask::Start{f.process(0)}; }},
    {"restart",
     [](Fields& f) -> Command {
       ask::Restart r{f.process(0), f.counted("line"), f.counted("number")};
       r.feed_mm_min = f.number("feed", r.feed_mm_min);
       r.confirm = f.is_set("confirm");
       r.plan = f.is_set("plan");
       return r;
     }},
    {"step", [](Fields& f) -> Command { return ask::Step{f.process(0)}; }},
    {"mdi",
     [](Fields& f) -> Command {
       return ask::Mdi{f.text("block"), f.process(0)};
     }},
    {"touch",
     [](Fields& f) -> Command {
       ask::Touch t;
       t.axis = f.text("axis");
       t.by = f.needed("by");
       t.feed_mm_min = f.number("feed", t.feed_mm_min);
       t.slow_mm_min = f.number("slow", t.slow_mm_min);
       t.back = f.number("back", t.back);
       t.times = f.number("times", t.times);
       t.plan = f.is_set("plan");
       return t;
     }},
    {"resume", [](Fields& f) -> Command { return ask::Resume{f.process(0)}; }},
    {"return",
     [](Fields& f) -> Command {
       return ask::Return{f.process(0), f.number_if("feed")};
     }},
    {"retrace",
     [](Fields& f) -> Command {
       return ask::Retrace{f.process(0), f.number_if("mm"), f.number_if("blocks"), f.number_if("feed")};
     }},
    {"assign",
     [](Fields& f) -> Command {
       return ask::Assign{f.text("axis"), f.process(0)};
     }},
    {"tables", [](Fields&) -> Command { return ask::Tables{}; }},
    {"table_set", [](Fields& f) -> Command { return f.table_row(false); }},
    {"table_here", [](Fields& f) -> Command { return f.table_row(true); }},
    {"table_clear",
     [](Fields& f) -> Command {
       return ask::TableClear{f.table(), f.whole("number", 0xFFFF)};
     }},
    {"table_undo", [](Fields&) -> Command { return ask::TableUndo{}; }},
    {"table_import",
     [](Fields& f) -> Command {
       return ask::TableImport{f.table(), f.text("file")};
     }},
    {"table_export",
     [](Fields& f) -> Command {
       return ask::TableExport{f.table(), f.text("form") == "linuxcnc"};
     }},
    {"reset", [](Fields&) -> Command { return ask::Reset{}; }},
    {"acknowledge", [](Fields&) -> Command { return ask::Acknowledge{}; }},
    {"input",
     [](Fields& f) -> Command {
       return ask::Input{f.text("point"), f.played("value")};
     }},
    {"stop", [](Fields&) -> Command { return ask::Stop{}; }},
    {"quick_stop", [](Fields&) -> Command { return ask::QuickStop{}; }},
    {"hold", [](Fields& f) -> Command { return ask::Hold{f.process(-1)}; }},
    {"jog_stop", [](Fields& f) -> Command { return ask::JogStop{f.text_if("axis")}; }},
    {"keep_alive", [](Fields& f) -> Command { return ask::KeepAlive{f.text_if("axis")}; }},
    {"down", [](Fields&) -> Command { return ask::Down{}; }},
    {"plc_load",
     [](Fields& f) -> Command {
       return ask::PlcLoad{f.list("files"), f.is_set("online"), f.is_set("while_running")};
     }},
    {"plc_force",
     [](Fields& f) -> Command {
       return ask::PlcForce{f.text("name"), f.text("value"), f.is_set("stay")};
     }},
    {"plc_release", [](Fields& f) -> Command { return ask::PlcRelease{f.text("name")}; }},
    {"plc_hold", [](Fields&) -> Command { return ask::PlcHold{}; }},
    {"plc_step", [](Fields& f) -> Command { return ask::PlcStep{f.number("scans", 1.0)}; }},
    {"plc_go", [](Fields&) -> Command { return ask::PlcGo{}; }},
    {"plc_watch",
     [](Fields& f) -> Command {
       return ask::PlcWatch{f.list("names"), f.is_set("times"), f.text_if("body")};
     }},
    {"plc_list", [](Fields&) -> Command { return ask::PlcList{}; }},
};

}  // namespace

std::optional<ReadRequest> read_request(std::string_view line, FormProblem& problem) {
  const std::optional<json> object = read_object(line, problem);
  ReadRequest request;
  if (!object || !read_asker(*object, request.asker, problem)) return std::nullopt;
  request.language = problem.language;
  const std::string name = request.name = object->value("cmd", "");
  const auto row =
      std::find_if(std::begin(kCommands), std::end(kCommands), [&](const auto& r) { return r.name == name; });
  if (row == std::end(kCommands)) {
    problem.entry = &says::kUnknown;
    problem.arguments = {name};
    return std::nullopt;
  }
  Fields fields(*object, problem);
  request.command = row->read(fields);
  if (problem.entry != nullptr) return std::nullopt;
  return request;
}

}  // namespace servogate::gateway
